//! The `nisp` command as a library: [`Program`] is the whole command line, for the equations that are shipped or for a user's own;
//! the modules are what `nisp-lab` shares with it: words, signals, kinds of options, and how an answer is compared with a truth.

mod args;
mod calibrate;
mod check;
mod checkpoint;
mod config;
mod eval;
mod explain;
mod help;
mod inputs;
pub mod interrupt;
mod list;
mod new;
pub mod options;
mod program;
mod report;
mod results;
mod rivals;
mod run;
pub mod score;
mod solve;
mod stream;
pub mod terminal;

pub use program::{Program, TEXT};

/// As many threads as the machine runs at once.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
