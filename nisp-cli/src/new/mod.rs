//! `nisp new`: a folder with a small equation that already solves.

use std::path::Path;
use std::process::ExitCode;

use nisp_data::OutDir;

/// What stands for the equation's name in the texts.
const NAME: &str = "NAME";

/// Writes the folder.
pub(crate) fn new(name: &str) -> Result<ExitCode, String> {
    let begins = name.chars().next().is_some_and(|first| first.is_ascii_alphabetic());
    if !begins || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Err(format!(
            "`{name}` is no name for an equation; use letters, digits and underscores, a letter first"
        ));
    }
    if Path::new(name).exists() {
        return Err(format!("{name} is there already; choose another name"));
    }
    // Names of files live as long as the program, which ends here.
    let equation: &str = format!("{name}.{}", nisp_cli::TEXT).leak();
    let named = |text: &str| text.replace(NAME, name).into_bytes();
    let files = [
        (equation, named(include_str!("equation.pde"))),
        ("README.md", named(include_str!("README.md"))),
        ("data.csv", include_bytes!("data.csv").to_vec()),
        ("truth.csv", include_bytes!("truth.csv").to_vec()),
    ];
    let folder = OutDir::create(name).map_err(|error| error.to_string())?;
    folder.write(&files).map_err(|error| error.to_string())?;
    let text = format!(
        "{name}: {equation}, data.csv, truth.csv, README.md\nnext: nisp solve {name}/{equation} --data {name}/data.csv\n"
    );
    nisp_cli::terminal::print(&text)?;
    Ok(ExitCode::SUCCESS)
}
