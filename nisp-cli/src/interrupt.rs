//! Ctrl-C and SIGTERM: once to stop at the best state, twice to stop at once.

use std::sync::atomic::{AtomicBool, Ordering};

/// What a shell reports of a process that SIGINT ended.
const KILLED: i32 = 130;

static ASKED: AtomicBool = AtomicBool::new(false);

/// Begins to listen.
pub(crate) fn listen() -> Result<(), String> {
    let heard = ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::Relaxed) {
            std::process::exit(KILLED);
        }
        eprintln!("\nnisp: stopping at the best state so far; once more to stop at once");
    });
    heard.map_err(|error| format!("cannot listen for Ctrl-C: {error}"))
}

/// An error where the user has asked to stop: what was cut short is no measurement.
pub(crate) fn check() -> Result<(), String> {
    if asked() { Err("interrupted; nothing was written".into()) } else { Ok(()) }
}

/// Whether the user has asked to stop.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
