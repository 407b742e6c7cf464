//! `nisp stream`: an answer for every frame of a camera or row of a record, as they come.

mod clouds;
mod input;
mod latest;
mod line;
mod records;

use std::process::ExitCode;

use crate::interrupt;
use crate::program::Program;
use nisp_equations::Binding;

use crate::args::stream::StreamOptions;

/// Follows a stream until it ends or the user asks to stop.
pub(crate) fn stream(program: &Program, options: &StreamOptions) -> Result<ExitCode, String> {
    let entry = program.entry(&options.equation)?;
    match entry.binding {
        Binding::Own(_) => Err(format!("`{}` is not measured in rows or clouds; use `nisp solve`", entry.name)),
        Binding::Cloud(_) if options.from.data.is_some() || options.lag.is_some() || !options.column.is_empty() => {
            Err(format!(
                "--data, --lag and --column are about rows, and `{}` is seen as clouds: leave them out",
                entry.name
            ))
        }
        Binding::Cloud(_) => {
            interrupt::listen(program.name)?;
            clouds::follow(&entry, options)
        }
        Binding::Series(_) | Binding::Tables(_) => {
            interrupt::listen(program.name)?;
            records::follow(&entry, options)
        }
    }
}
