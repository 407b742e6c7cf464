//! Mean absolute error of the source by every rival, over fresh noisy copies of the repository's truths:
//! `cargo run --release -p nisp-equations --example rivals`.

use std::error::Error;
use std::path::Path;

use nisp_equations::{Request, catalogue, yardsticks};

/// Seed of the first copy's noise; settings were chosen on the copies in `data`, which have others.
const SEED: u64 = 2026;

fn main() -> Result<(), Box<dyn Error>> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for entry in catalogue() {
        let Some(series) = entry.series() else { continue };
        for noise in [0.0, 0.01, 0.03] {
            let samples = series.copies(&entry, &Request::default(), &repository, noise, SEED, series.truths.len())?;
            println!("{}, runs: {}, noise {noise}, mean |error of the source|", entry.name, samples.len());
            for yardstick in yardsticks(&samples) {
                println!("  {:24} {:.2e}  ({:.2} s a run)", yardstick.name, yardstick.error, yardstick.seconds);
            }
        }
    }
    Ok(())
}
