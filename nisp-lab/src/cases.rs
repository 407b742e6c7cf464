//! Which simulated cases to solve, and how.

use nisp_cli::options::{count, seconds, seed};

/// Options of every study of simulated cases.
#[derive(clap::Args)]
pub(crate) struct Cases {
    /// One JSON object instead of a table.
    #[arg(long)]
    pub(crate) json: bool,
    /// Only cases whose name contains this.
    #[arg(long, value_name = "NAME")]
    pub(crate) only: Option<String>,
    /// Seed of the noise and of the initial weights.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = seed, allow_negative_numbers = true)]
    pub(crate) seed: u64,
    /// Wall time of a case.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, value_parser = seconds)]
    pub(crate) budget: f64,
    /// Threads [default: one per processor].
    #[arg(long, value_name = "N", value_parser = count)]
    pub(crate) threads: Option<usize>,
}

impl Cases {
    /// How many threads to solve with.
    pub(crate) fn threads(&self) -> usize {
        self.threads.unwrap_or_else(nisp_cli::processors)
    }
}
