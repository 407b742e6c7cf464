//! `--config FILE`: options from a TOML file, turned into the flags they stand for, ahead of those of the command line.

use std::ffi::OsString;
use std::path::Path;

use nisp_data::input::read_text;
use toml::{Table, Value};

/// Options whose values are paths.
const PATHS: [&str; 7] = ["data", "sample", "calibration", "at", "truth", "out", "resume"];

/// The flags that a file stands for.
///
/// # Errors
/// A file that cannot be read or is no TOML, or a value of a kind that no option has.
pub(crate) fn flags(path: &Path) -> Result<Vec<OsString>, String> {
    let text = read_text(path).map_err(|error| format!("--config {error}"))?;
    let table: Table = text.parse().map_err(|error: toml::de::Error| {
        let before = error.span().map_or(0, |span| span.start);
        let line = 1 + text[..before.min(text.len())].matches('\n').count();
        format!("{}: line {line}: {}", path.display(), error.message().replace('\n', " "))
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut flags = Vec::new();
    for (key, value) in &table {
        let refuse = |what: &str| Err(format!("{}: `{key}` {what}", path.display()));
        match value {
            _ if key == "config" => return refuse("cannot stand in a configuration; name one file only"),
            Value::Table(pairs) if matches!(key.as_str(), "column" | "set" | "points") => {
                for (name, value) in pairs {
                    let Some(value) = plain(value) else { return refuse("takes NAME = VALUE pairs") };
                    flags.push(format!("--{key}={name}={value}").into());
                }
            }
            Value::Table(files) if key == "data" => {
                for (group, file) in files {
                    let Some(file) = plain(file) else { return refuse("takes GROUP = FILE pairs") };
                    let mut flag = OsString::from(format!("--data={group}="));
                    flag.push(folder.join(file));
                    flags.push(flag);
                }
            }
            Value::Boolean(false) => {}
            Value::Boolean(true) => flags.push(format!("--{key}").into()),
            Value::Array(_) if key == "data" => return refuse("is one file, or a table [data] of GROUP = FILE pairs"),
            _ => {
                let Some(text) = plain(value) else { return refuse("is no text and no number") };
                let mut flag = OsString::from(format!("--{key}="));
                if PATHS.contains(&key.as_str()) {
                    flag.push(folder.join(text))
                } else {
                    flag.push(text)
                }
                flags.push(flag);
            }
        }
    }
    Ok(flags)
}

fn plain(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Integer(number) => Some(number.to_string()),
        Value::Float(number) => Some(number.to_string()),
        _ => None,
    }
}
