//! What the programs `nisp` and `nisp-lab` share: their words, their signals, the kinds of their options, and how an answer is
//! compared with a truth.

use std::path::Path;

pub mod interrupt;
pub mod options;
pub mod score;
pub mod terminal;

/// The equation of a name: of a text file, or one that is shipped. What a text's compiler warns of goes to standard error.
///
/// # Errors
/// There is none, and what to type instead; or everything that is wrong with the text.
pub fn entry(name: &str) -> Result<nisp_equations::Entry, String> {
    let path = Path::new(name);
    if path.extension().is_some_and(|extension| extension == TEXT) {
        return text_entry(path);
    }
    let entries = nisp_equations::catalogue();
    let names = entries.each_ref().map(|entry| entry.name);
    entries.into_iter().find(|entry| entry.name == name).ok_or_else(|| {
        let near = nisp_data::nearest_name(name, names);
        let hint = near.map_or_else(String::new, |near| format!(", did you mean `{near}`?"));
        format!(
            "there is no `{name}`{hint}; `nisp list` shows what there is: {}; or name a text file, NAME.{TEXT}",
            names.join(", ")
        )
    })
}

/// Extension of equations in text files.
pub const TEXT: &str = "pde";

/// The equation in a text file.
fn text_entry(path: &Path) -> Result<nisp_equations::Entry, String> {
    let text = nisp_data::input::read_text(path).map_err(|error| error.to_string())?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let place = |mistake: &nisp_interpreter::Mistake| match mistake.line {
        0 => format!("{}: {mistake}", path.display()),
        line => format!("{}:{line}:{}: {mistake}", path.display(), mistake.column),
    };
    let equation = nisp_interpreter::read(&text, &stem).map_err(|mistakes| {
        let found: Vec<String> = mistakes.0.iter().map(place).collect();
        found.join("\n")
    })?;
    for warning in &equation.warnings {
        terminal::note(&format!("{}\n", place(warning)));
    }
    let first = equation.scenes.first().ok_or_else(|| format!("{}: there is no scene in it", path.display()))?;
    Ok(nisp_equations::Entry {
        name: first.schema.module,
        about: first.schema.docs,
        scenes: equation.scenes,
        data: "",
        binding: nisp_equations::Binding::Tables,
    })
}

/// As many threads as the machine runs at once.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
