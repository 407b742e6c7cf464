//! What the command line takes.

use std::path::PathBuf;

use clap::{Args as Group, Parser, Subcommand};

/// Recover unknown sources from noisy measurements and a known governing equation.
#[derive(Parser)]
#[command(version, after_help = "Begin with: nisp solve pendulum")]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Show the equations that can be solved.
    List,
    /// Show a scene's equations, units, channels and what is skipped.
    Explain {
        /// Name of the equation (see `nisp list`).
        equation: String,
        /// One of its scenes.
        #[arg(long)]
        scene: Option<String>,
    },
    /// Recover a source; without options, from the repository's own example.
    #[command(after_help = "Exit codes: 0 solved, 2 bad input, 3 not converged.")]
    Solve(Box<Options>),
}

/// How and from what to solve.
#[derive(Group)]
pub(crate) struct Options {
    /// Name of the equation (see `nisp list`).
    pub(crate) equation: String,
    /// One of its scenes.
    #[arg(long)]
    pub(crate) scene: Option<String>,
    /// CSV of measurements, with a time column `t`.
    #[arg(long, value_name = "FILE")]
    pub(crate) data: Option<PathBuf>,
    /// Header that holds a quantity, for instance q=q_m_sigma0.01.
    #[arg(long, value_name = "NAME=HEADER", value_parser = pair)]
    pub(crate) column: Vec<(String, String)>,
    /// CSV of the truth, used to score and for nothing else.
    #[arg(long, value_name = "FILE")]
    pub(crate) truth: Option<PathBuf>,
    /// A parameter in its declared unit.
    #[arg(long, value_name = "NAME=VALUE", value_parser = value)]
    pub(crate) set: Vec<(String, f64)>,
    /// Seed of the initial weights.
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Element type.
    #[arg(long, default_value = "f64", value_parser = ["f32", "f64"])]
    pub(crate) precision: String,
    /// Method of minimisation.
    #[arg(long, default_value = "auto", value_parser = ["auto", "adam", "lbfgs", "broyden", "lm", "evidence"])]
    pub(crate) optimizer: String,
    /// Hidden units of a layer.
    #[arg(long, default_value_t = 16)]
    pub(crate) width: usize,
    /// Layers.
    #[arg(long, default_value_t = 2)]
    pub(crate) layers: usize,
    /// Threads; 0 for one per processor.
    #[arg(long, default_value_t = 0)]
    pub(crate) threads: usize,
    /// Wall time.
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0)]
    pub(crate) budget: f64,
    /// Steps at most.
    #[arg(long, value_name = "N")]
    pub(crate) iterations: Option<u64>,
    /// Folder for results.
    #[arg(long, value_name = "DIR", default_value = "nisp-out")]
    pub(crate) out: PathBuf,
    /// One JSON object on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,
}

fn pair(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=HEADER, for instance q=q_m_sigma0.01")?;
    Ok((name.trim().into(), value.trim().into()))
}

fn value(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, for instance m0=0.005")?;
    let value = value.trim().parse().map_err(|_| format!("`{value}` is no number"))?;
    Ok((name.trim().into(), value))
}
