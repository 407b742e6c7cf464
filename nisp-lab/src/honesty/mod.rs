//! `nisp-lab honesty`: whether what is said of an answer is true, on data that are right and on data that are spoiled.
//!
//! Data are simulated, so that the truth is known. Every case is solved as the command line would solve it. What was said is then
//! compared with what is true: a wrong answer that was called right is a lie, a right answer from right data that was not called
//! right is a false alarm.

mod bodies;
mod corruption;
mod equations;
mod experiment;
mod forward;
mod judge;
mod report;
mod samples;
mod series;
mod study;

use std::path::PathBuf;
use std::process::ExitCode;

use nisp_cli::interrupt;
use nisp_cli::terminal::{print, progress};

use crate::cases::Cases;
use report::{HEAD, counts, json, line};
use study::{Run, run, subjects};

/// Which cases to run, and how.
#[derive(clap::Args)]
pub(crate) struct Options {
    #[command(flatten)]
    cases: Cases,
    /// The repository, whose samples and truths are read.
    #[arg(long, value_name = "DIR", default_value = ".")]
    repository: PathBuf,
}

/// Runs the cases and prints what came of them.
pub(crate) fn honesty(options: &Options) -> Result<ExitCode, String> {
    interrupt::listen(crate::NAME)?;
    let threads = options.cases.threads();
    let how = Run { seed: options.cases.seed, budget: options.cases.budget, threads };
    let mut rows = Vec::new();
    let say = |text: &str| if options.cases.json { Ok(()) } else { print(text) };
    say(HEAD)?;
    for subject in subjects(&options.repository) {
        for case in &subject.cases {
            let name = format!("{}: {}", subject.name, case.corruption);
            if options.cases.only.as_ref().is_some_and(|only| !name.contains(only)) {
                continue;
            }
            progress(&name);
            let row = run(&subject, case, &how)?;
            interrupt::check()?;
            say(&line(&row))?;
            rows.push(row);
        }
    }
    progress("");
    if rows.is_empty() {
        return Err("no case has such a name".into());
    }
    print(&if options.cases.json { json(&rows) } else { counts(&rows) })?;
    Ok(ExitCode::SUCCESS)
}
