//! Words to standard output and standard error. Both may be closed or full, which is no reason to stop or to panic.

use std::io::{ErrorKind, IsTerminal, Write};
use std::process::ExitCode;

/// Exit code: bad input; nothing was written.
pub const BAD_INPUT: u8 = 2;
/// Exit code: not converged, or interrupted.
pub const NOT_CONVERGED: u8 = 3;
/// Exit code: what was asked for could not be written where it was to be.
pub const NOT_WRITTEN: u8 = 4;

/// Writes to standard output; whoever closed it early wanted no more.
///
/// # Errors
/// Standard output takes no more for another reason: the disk behind it is full, say.
pub fn print(text: &str) -> Result<(), String> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(format!("standard output: {error}")),
        _ => Ok(()),
    }
}

/// Writes to standard error, if it takes anything.
pub fn note(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// A line that is overwritten by the next, on a terminal only.
pub fn progress(text: &str) {
    if std::io::stderr().is_terminal() {
        note(&format!("\r{text}\x1b[K"));
    }
}

/// Ends a program: with its own code, or with the message of what was wrong with its input.
pub fn end(program: &str, result: Result<ExitCode, String>) -> ExitCode {
    result.unwrap_or_else(|message| {
        note(&format!("{program}: {message}\n"));
        ExitCode::from(BAD_INPUT)
    })
}
