//! Answers as lines of JSON.

use std::io::{ErrorKind, Write, stdout};

use serde_json::{Value, json};

/// What every line says of its record.
pub(super) struct Head<'a> {
    /// What the record is called.
    pub(super) frame: &'a str,
    /// When it came, in seconds from the stream's beginning.
    pub(super) t: f64,
    /// Records left out so far.
    pub(super) dropped: u64,
    /// Milliseconds from when it was there.
    pub(super) latency_ms: f64,
}

/// A line: an answer's own members, or what is wrong with the record.
pub(super) fn line(head: &Head<'_>, answer: Result<Value, String>) -> Value {
    let mut line = answer.unwrap_or_else(|error| json!({ "status": "error", "error": error }));
    line["frame"] = head.frame.into();
    line["t"] = head.t.into();
    line["dropped"] = head.dropped.into();
    line["latency_ms"] = head.latency_ms.into();
    line
}

/// Writes a line. False where nobody reads any more.
///
/// # Errors
/// Standard output takes no more for another reason.
pub(super) fn print(line: &Value) -> Result<bool, String> {
    let mut out = stdout().lock();
    match writeln!(out, "{line}").and_then(|()| out.flush()) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        Err(error) => Err(format!("standard output: {error}")),
    }
}
