//! The pages of the language show equations that compile.

/// Fenced blocks of a page, with the line on which each begins.
fn blocks(page: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut open: Option<(usize, String)> = None;
    for (at, line) in page.lines().enumerate() {
        match (&mut open, line) {
            (None, "```pde") => open = Some((at + 1, String::new())),
            (Some(_), "```") => found.extend(open.take()),
            (Some((_, text)), line) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, _) => {}
        }
    }
    found
}

#[test]
fn every_example_of_the_language_compiles() {
    let page = include_str!("../../docs/language.md");
    let blocks = blocks(page);
    assert!(blocks.len() >= 15, "only {} examples", blocks.len());
    for (line, text) in blocks {
        let equation = nisp_interpreter::read(&text, "example").unwrap_or_else(|m| panic!("line {line}: {m}"));
        assert!(!equation.scenes.is_empty(), "line {line}: no scene");
        let all: Vec<String> = equation.warnings.iter().map(ToString::to_string).collect();
        assert!(all.is_empty(), "line {line}: {}", all.join("\n"));
    }
}

/// Every word that begins a declaration is shown.
#[test]
fn every_declaration_has_an_example() {
    let text: String = blocks(include_str!("../../docs/language.md")).into_iter().map(|(_, text)| text).collect();
    let words = [
        "units:",
        "coordinates:",
        "fields:",
        "sources:",
        "parameters:",
        "constants:",
        "columns:",
        "domains:",
        "let ",
        "hard ",
        "observe ",
        "scene ",
        "learn ",
        "without ",
        "only ",
        "weight ",
        "pairs ",
        "integral(",
        "chamfer ",
        "_|_",
        " in ",
        "boundary of",
        "start of",
        "with huber",
        "within ",
        "plus",
        "minus",
        "times",
    ];
    let missing: Vec<&str> = words.into_iter().filter(|word| !text.contains(word)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
