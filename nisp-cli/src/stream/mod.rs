//! `nisp stream`: an answer for every frame, as they come.

mod clouds;
mod input;
mod latest;
mod line;
mod options;

use std::process::ExitCode;

use nisp_cli::interrupt;
use nisp_equations::Binding;

pub(crate) use options::{SEE_HELP, StreamOptions, TEACH};

/// Follows a stream until it ends or the user asks to stop.
pub(crate) fn stream(options: &StreamOptions) -> Result<ExitCode, String> {
    let entry = nisp_cli::entry(&options.equation)?;
    let Binding::Cloud(_) = entry.binding else {
        return Err(format!("`{}` is not seen as clouds; `nisp stream` follows membrane and bubble", entry.name));
    };
    interrupt::listen(crate::NAME)?;
    clouds::follow(&entry, options)
}
