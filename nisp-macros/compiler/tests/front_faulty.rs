//! Faulty programs, each with what the front end must say about it below the line at fault:
//!
//! ```text
//!     let a = q + t;
//! //              ^error{units differ ...}
//! ```
//!
//! The carets underline the tokens; a newline of the message is written as ` | `. `BLESS=1 cargo test` writes what the
//! front end says now into the files, to be read before it is believed.

use nisp_compiler::error::{Errors, Place};
use nisp_compiler::model::check;
use nisp_compiler::syntax::parse;

const FILES: [&str; 7] = ["syntax", "declarations", "domains", "units", "shapes", "terms", "scenes"];

#[test]
fn every_mistake_is_reported_once_where_it_is() {
    let mut programs = 0;
    for file in FILES {
        let path = format!("{}/tests/fixtures/{file}.txt", env!("CARGO_MANIFEST_DIR"));
        let expected = std::fs::read_to_string(&path).unwrap();
        let found: String = expected.split_inclusive("\n\n").map(annotated).collect();
        programs += expected.matches("\nmod ").count();
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(&path, found).unwrap();
        } else {
            let line = expected.lines().zip(found.lines()).position(|(a, b)| a != b).unwrap_or(0);
            let show = |text: &str| text.lines().skip(line.saturating_sub(3)).take(8).collect::<Vec<_>>().join("\n");
            assert!(
                found == expected,
                "{file}.txt:{}\nexpected:\n{}\nfound:\n{}",
                line + 1,
                show(&expected),
                show(&found)
            );
        }
    }
    assert!(programs >= 60, "only {programs} programs");
}

/// The program with the front end's present messages in it.
fn annotated(program: &str) -> String {
    let lines: Vec<&str> = program.lines().filter(|line| !is_mark(line)).collect();
    let source = lines.join("\n");
    let mut marks: Vec<(usize, String)> = Vec::new();
    let mut errors = Errors::new();
    let module = parse(source.parse().unwrap(), &mut errors);
    let model = module.and_then(|module| check(&module, &[], &mut errors));
    assert_eq!(model.is_some(), errors.is_empty(), "a model comes with no errors, or errors with no model:\n{source}");
    for fault in errors.faults() {
        marks.push(mark(fault.place, "error", &fault.message));
    }
    for (message, span) in model.iter().flat_map(|model| &model.warnings) {
        marks.push(mark(Place::from(*span), "warning", message));
    }
    let mut text = String::new();
    for (index, line) in lines.iter().enumerate() {
        text.push_str(&format!("{line}\n"));
        for (_, mark) in marks.iter().filter(|(at, _)| *at == index + 1) {
            text.push_str(&format!("{mark}\n"));
        }
    }
    text
}

fn is_mark(line: &str) -> bool {
    line.starts_with("//") && (line.contains("^error{") || line.contains("^warning{"))
}

fn mark(place: Place, severity: &str, message: &str) -> (usize, String) {
    let (start, end) = (place.start.start(), place.end.end());
    let width = if start.line == end.line { end.column.saturating_sub(start.column).max(1) } else { 1 };
    let indent = start.column.saturating_sub(2);
    let message = message.replace('\n', " | ");
    (start.line, format!("//{}{}{severity}{{{message}}}", " ".repeat(indent), "^".repeat(width)))
}
