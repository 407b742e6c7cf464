//! `nisp list`: what can be solved.

use std::process::ExitCode;

use crate::program::Program;

/// Prints every equation with its scenes.
pub(crate) fn list(program: &Program) -> Result<ExitCode, String> {
    let mut text = String::new();
    for entry in &program.equations {
        text += &format!("{:10} {}\n", entry.name, entry.about);
        let schemas: Vec<_> = entry.scenes.iter().map(|scene| scene.schema).collect();
        let widest = schemas.iter().map(|schema| schema.name.len()).max().unwrap_or(0);
        for schema in schemas {
            let about = schema.docs.lines().next().unwrap_or_default();
            text += &format!("{:10} --scene {:widest$}  {about}\n", "", schema.name);
        }
    }
    crate::terminal::print(&text)?;
    Ok(ExitCode::SUCCESS)
}
