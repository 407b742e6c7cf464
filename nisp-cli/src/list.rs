//! `nisp list`: what can be solved.

use std::process::ExitCode;

/// Prints every equation with its scenes.
pub(crate) fn list() -> Result<ExitCode, String> {
    let mut text = String::new();
    for entry in nisp_equations::catalogue() {
        text += &format!("{:12} {}\n", entry.name, entry.about);
        for scene in entry.scenes {
            let schema = scene().schema;
            let about = schema.docs.lines().next().unwrap_or_default();
            text += &format!("{:12} --scene {:10} {about}\n", "", schema.name);
        }
    }
    crate::print(&text)?;
    Ok(ExitCode::SUCCESS)
}
