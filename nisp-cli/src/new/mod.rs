//! `nisp new`: a folder with a small equation that already solves, as a text file or as a crate in Rust.

use std::path::Path;
use std::process::ExitCode;

use nisp_data::{DataError, OutDir};

use crate::program::TEXT;
use crate::terminal::print;

/// What stands for the equation's name in the texts.
const NAME: &str = "NAME";

const EQUATION: &str = include_str!("equation.pde");

/// Writes the folder.
pub(crate) fn new(name: &str, rust: bool) -> Result<ExitCode, String> {
    let begins = name.chars().next().is_some_and(|first| first.is_ascii_alphabetic());
    if !begins || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Err(format!(
            "`{name}` is no name for an equation; use letters, digits and underscores, a letter first"
        ));
    }
    if nisp_interpreter::read(&EQUATION.replace(NAME, name), name).is_err() {
        return Err(format!("`{name}` is a word of Rust and can name no equation; choose another name"));
    }
    if Path::new(name).exists() {
        return Err(format!("{name} is there already; choose another name"));
    }
    let written = if rust { in_rust(name) } else { as_text(name) };
    print(&written.map_err(|error| error.to_string())?)?;
    Ok(ExitCode::SUCCESS)
}

/// An equation in a text file; what was written, and what to do next.
fn as_text(name: &str) -> Result<String, DataError> {
    // Names of files live as long as the program, which ends here.
    let equation: &str = format!("{name}.{TEXT}").leak();
    let readme = include_str!("text/README.md");
    write(name, &[(equation, EQUATION.replace(NAME, name)), ("README.md", readme.replace(NAME, name))])?;
    Ok(format!(
        "{name}: {equation}, data.csv, truth.csv, README.md\nnext: nisp solve {name}/{equation} --data {name}/data.csv\n"
    ))
}

/// A crate whose program has the whole command line.
fn in_rust(name: &str) -> Result<String, DataError> {
    let indented: Vec<String> =
        EQUATION.lines().map(|line| if line.is_empty() { String::new() } else { format!("    {line}") }).collect();
    let main = include_str!("rust/main.rs.txt").replace("EQUATION", &indented.join("\n")).replace(NAME, name);
    let manifest = include_str!("rust/Cargo.toml.txt").replace(NAME, name);
    let readme = include_str!("rust/README.md").replace(NAME, name);
    OutDir::create(Path::new(name).join("src"))?.write(&[("main.rs", main.into_bytes())])?;
    write(name, &[("Cargo.toml", located(&manifest)), ("README.md", readme)])?;
    Ok(format!(
        "{name}: Cargo.toml, src/main.rs, data.csv, truth.csv, README.md\n\
         next: cd {name}, then cargo run --release -- solve {name} --data data.csv\n"
    ))
}

/// The files, and the data that both kinds have.
fn write(folder: &str, files: &[(&'static str, String)]) -> Result<(), DataError> {
    let data = [("data.csv", include_bytes!("data.csv").to_vec()), ("truth.csv", include_bytes!("truth.csv").to_vec())];
    let files = files.iter().map(|(name, text)| (*name, text.clone().into_bytes())).chain(data);
    OutDir::create(folder)?.write(&files.collect::<Vec<_>>())
}

/// A manifest that says where the crates are: in the checkout that this program was built from, if it is still there, or in the
/// registry.
fn located(manifest: &str) -> String {
    const CHECKOUT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
    match Path::new(CHECKOUT).canonicalize() {
        Ok(checkout) if checkout.join("Cargo.toml").exists() => {
            let quoted = |path: &Path| format!("path = {:?}", path.display().to_string());
            manifest
                .replace("LOCATION/nisp-cli", &quoted(&checkout.join("nisp-cli")))
                .replace("LOCATION", &quoted(&checkout))
        }
        _ => {
            let version = concat!("version = \"", env!("CARGO_PKG_VERSION"), "\"");
            manifest.replace("LOCATION/nisp-cli", version).replace("LOCATION", version)
        }
    }
}
