//! `nisp-lab records`: records over one coordinate, simulated, with the source unknown.

mod draws;
mod drive;
mod families;
mod study;

use std::process::ExitCode;

use nisp_cli::interrupt;
use nisp_cli::terminal::{print, progress};
use serde_json::json;

use crate::cases::Cases;
use families::families;
use study::{Method, Row, run};

/// Which records, and how they are solved.
#[derive(clap::Args)]
pub(crate) struct Options {
    #[command(flatten)]
    cases: Cases,
    /// Records of every family and noise.
    #[arg(long, value_name = "N", default_value_t = 3)]
    runs: u64,
    /// Rows of a record [default: drawn between 16 and 2000].
    #[arg(long, value_name = "N")]
    rows: Option<usize>,
    /// Noise, in spreads of every column, or for pendulums in metres and radians.
    #[arg(long, value_name = "SIGMA", num_args = 1.., default_values_t = [1e-3, 1e-2, 3e-2, 1e-1])]
    noise: Vec<f64>,
    /// What carries the answer.
    #[arg(long, value_enum, default_value_t = Method::Splines)]
    carrier: Method,
    /// A line for every record.
    #[arg(long)]
    each: bool,
}

/// Runs the records and prints what came of them.
pub(crate) fn records(options: &Options) -> Result<ExitCode, String> {
    interrupt::listen(crate::NAME)?;
    let mut all: Vec<Row> = Vec::new();
    let say = |text: &str| if options.cases.json { Ok(()) } else { print(text) };
    say(study::HEAD)?;
    for family in families() {
        if options.cases.only.as_ref().is_some_and(|only| !family.name.contains(only)) {
            continue;
        }
        for &noise in &options.noise {
            progress(family.name);
            let mut rows = Vec::new();
            for seed in options.cases.seed..options.cases.seed + options.runs {
                rows.push(run(&family, noise, seed, options.rows, options.carrier, &options.cases)?);
                interrupt::check()?;
                if options.each {
                    say(&rows[rows.len() - 1].line())?;
                }
            }
            progress("");
            say(&study::line(family.name, &noise.to_string(), &rows))?;
            all.extend(rows);
        }
    }
    if all.is_empty() {
        return Err("no family has such a name".into());
    }
    say(&study::line("all", "", &all))?;
    if options.cases.json {
        print(&format!("{}\n", json!({ "rows": all.iter().map(Row::object).collect::<Vec<_>>() })))?;
    }
    Ok(ExitCode::SUCCESS)
}
