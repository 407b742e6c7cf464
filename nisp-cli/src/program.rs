//! A program with the whole command line: its name, and the equations that it knows beside those in text files.

use std::path::Path;

use nisp::SceneRef;
use nisp_equations::{Binding, Entry};

use crate::terminal::note;

/// Extension of equations in text files.
pub const TEXT: &str = "pde";

/// A program and its equations.
pub struct Program {
    /// Its name, in its messages.
    pub(crate) name: &'static str,
    /// Its equations.
    pub(crate) equations: Vec<Entry>,
    /// Command lines that its help shows.
    pub(crate) examples: String,
}

impl Program {
    /// The program `nisp`, with the equations that are shipped.
    #[cfg(feature = "shipped")]
    pub fn shipped() -> Self {
        Self { name: "nisp", equations: nisp_equations::catalogue().into(), examples: crate::help::EXAMPLES.into() }
    }

    /// A program of a user's own, with the scenes of each of its equations.
    pub fn own(name: &'static str, equations: impl IntoIterator<Item = Vec<SceneRef>>) -> Self {
        let equations: Vec<Entry> = equations.into_iter().filter_map(Entry::own).collect();
        let examples = equations.iter().map(|entry| format!("  {name} solve {} --data FILE", entry.name));
        Self { name, examples: examples.collect::<Vec<_>>().join("\n"), equations }
    }

    /// The equation of a name: of a text file, or one of the program's own. What a text's compiler warns of goes to
    /// standard error.
    ///
    /// # Errors
    /// There is none, and what to type instead; or everything that is wrong with the text.
    pub fn entry(&self, name: &str) -> Result<Entry, String> {
        let path = Path::new(name);
        if path.extension().is_some_and(|extension| extension == TEXT) {
            return text_entry(path);
        }
        let names = || self.equations.iter().map(|entry| entry.name);
        self.equations.iter().find(|entry| entry.name == name).cloned().ok_or_else(|| {
            if path.is_file() {
                return format!("`{name}` is a file; an equation's text has a name that ends in .{TEXT}");
            }
            let near = nisp_data::nearest_name(name, names());
            let hint = near.map_or_else(String::new, |near| format!(", did you mean `{near}`?"));
            format!(
                "there is no `{name}`{hint}; `{} list` shows what there is: {}; or name a text file, NAME.{TEXT}",
                self.name,
                names().collect::<Vec<_>>().join(", ")
            )
        })
    }
}

/// The equation in a text file.
fn text_entry(path: &Path) -> Result<Entry, String> {
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
        note(&format!("{}\n", place(warning)));
    }
    // As long-lived as the scenes that were read.
    let folder: &Path = Box::leak(path.parent().unwrap_or(Path::new("")).into());
    let entry = Entry::own(equation.scenes).map(|entry| Entry { binding: Binding::Tables(folder), ..entry });
    entry.ok_or_else(|| format!("{}: there is no scene in it", path.display()))
}
