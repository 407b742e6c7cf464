//! What the command line takes.

pub(crate) mod stream;
mod words;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args as Group, CommandFactory, FromArgMatches, Parser, Subcommand};
use nisp_data::cloud::LengthUnit;

use crate::config;
use crate::help::{EVAL_SEE_HELP, EVAL_TEACH, SEE_HELP, TEACH};
use crate::options::{activations, count, one_line, optimizers, pair, precisions, seconds, seed, show, size, value};
use crate::program::Program;
use stream::StreamOptions;
pub(crate) use words::Grid;
use words::{data_parser, grid, points};

/// Recover unknown sources from noisy measurements and a known governing equation.
#[derive(Parser)]
#[command(version)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Subcommand)]
pub(crate) enum Command {
    /// Show the equations that can be solved.
    List,
    /// Say what was understood of an equation and of its data, before anything is solved.
    Check {
        /// Equation: a text file (heat.pde) or one that is shipped (see `nisp list`).
        #[arg(value_name = "SCENE")]
        equation: String,
        /// One of its scenes.
        #[arg(long, value_name = "NAME")]
        scene: Option<String>,
        /// Tables as for `nisp solve`. Repeatable.
        #[arg(long, value_name = "[GROUP=]FILE", value_parser = data_parser())]
        data: Vec<(Option<String>, PathBuf)>,
        /// Header of the column that holds a quantity. Repeatable.
        #[arg(long, value_name = "NAME=HEADER", value_parser = pair)]
        column: Vec<(String, String)>,
        /// Show the conditions as LaTeX too.
        #[arg(long)]
        latex: bool,
    },
    /// Write a folder with a small equation of your own that already solves: its text, data and a README.
    New {
        /// Name of the equation and of the folder: letters, digits and underscores.
        name: String,
        /// A crate in Rust instead of a text file: the equation is compiled, and the program has this command line.
        #[arg(long)]
        rust: bool,
    },
    /// Show a scene's equations, units, channels, what a point costs and what is skipped.
    Explain {
        /// Equation: a text file (heat.pde) or one that is shipped (see `nisp list`).
        #[arg(value_name = "SCENE")]
        equation: String,
        /// One of its scenes.
        #[arg(long, value_name = "NAME")]
        scene: Option<String>,
        /// Hidden units of a layer.
        #[arg(long, value_name = "N", default_value_t = 16, value_parser = size, allow_negative_numbers = true)]
        width: usize,
        /// Layers.
        #[arg(long, value_name = "N", default_value_t = 2, value_parser = size, allow_negative_numbers = true)]
        layers: usize,
    },
    /// Learn a sensor's pose, size and stiffness from frames that nothing touches, and what the theory leaves.
    Calibrate(Frames),
    /// Recover a source; without options, from the repository's own noisy example.
    #[command(args_override_self = true, after_help = SEE_HELP)]
    Solve(Box<Options>),
    /// Answer frame after frame of a camera, or row after row of a record, as they come: one JSON object a line.
    #[command(after_help = stream::SEE_HELP, after_long_help = stream::TEACH)]
    Stream(Box<StreamOptions>),
    /// Read values, derivatives and declared expressions from a saved answer, without its data.
    #[command(after_help = EVAL_SEE_HELP, after_long_help = EVAL_TEACH)]
    Eval(EvalOptions),
}

/// What to read from an answer, and where.
#[derive(Group)]
pub(crate) struct EvalOptions {
    /// The answer: answer.nisp in the folder of its results.
    #[arg(value_name = "ANSWER")]
    pub(crate) answer: PathBuf,
    #[command(flatten)]
    pub(crate) place: Place,
    /// Expressions with commas between them, for instance 'w, d(w, x, 2), M_x' [default: fields and sources].
    #[arg(long, value_name = "EXPRESSIONS")]
    pub(crate) of: Option<String>,
    /// Header of the column of --at that holds a coordinate, for instance t=when. Repeatable.
    #[arg(long, value_name = "NAME=HEADER", value_parser = pair, requires = "at")]
    pub(crate) column: Vec<(String, String)>,
    /// CSV to write, instead of standard output.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// One JSON object on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Frames to calibrate from.
#[derive(Group)]
pub(crate) struct Frames {
    /// Equation of the sensor: bubble.
    #[arg(value_name = "SCENE")]
    pub(crate) equation: String,
    /// Point cloud of the sensor with nothing touching it. Repeatable; all at the same pressure.
    #[arg(long, value_name = "FILE", required = true)]
    pub(crate) reference: Vec<PathBuf>,
    /// What is known, in declared units: gauge pressure p, semi-axes a and b in metres, thickness t. Repeatable.
    #[arg(long, value_name = "NAME=VALUE", value_parser = value)]
    pub(crate) set: Vec<(String, f64)>,
    /// Unit of the clouds' coordinates: m, cm, mm, um or in [default: m].
    #[arg(long, value_name = "UNIT")]
    pub(crate) unit: Option<LengthUnit>,
    /// TOML of the camera that took depth images: fx, fy, cx, cy, and where it is.
    #[arg(long, value_name = "FILE")]
    pub(crate) camera: Option<PathBuf>,
    /// Wall time for each law of the material.
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) budget: f64,
    /// Folder for calibration.toml and a picture of the deviation; made if it is not there.
    #[arg(long, value_name = "DIR", default_value = "nisp-calibration")]
    pub(crate) out: PathBuf,
    /// One JSON object on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,
}

/// How and from what to solve.
#[derive(Group)]
pub(crate) struct Options {
    /// Equation to solve: a text file (heat.pde) or one that is shipped (see `nisp list`).
    #[arg(value_name = "SCENE")]
    pub(crate) equation: String,
    /// One of the equation's scenes [default: its first].
    #[arg(long, value_name = "NAME")]
    pub(crate) scene: Option<String>,
    /// CSV of measurements, or a point cloud [default: a shipped equation's example]. GROUP=FILE is for one group.
    #[arg(long, value_name = "[GROUP=]FILE", value_parser = data_parser(), help_heading = DATA)]
    pub(crate) data: Vec<(Option<String>, PathBuf)>,
    /// TOML of a sample: its parameters, and the names of its point clouds.
    #[arg(long, value_name = "FILE", help_heading = DATA)]
    pub(crate) sample: Option<PathBuf>,
    /// Which of the sample's clouds, counted from 0 [default: 0].
    #[arg(long, value_name = "K", allow_negative_numbers = true, help_heading = DATA)]
    pub(crate) cloud: Option<usize>,
    /// Of a bubble: calibration.toml of `nisp calibrate`, for the sensor that saw the cloud.
    #[arg(long, value_name = "FILE", help_heading = DATA)]
    pub(crate) calibration: Option<PathBuf>,
    /// Of a text file: table of the points at which the answer is wanted [default: where it was measured, or a grid].
    #[arg(long, value_name = "FILE", conflicts_with = "grid", help_heading = DATA)]
    pub(crate) at: Option<PathBuf>,
    /// Of a text file: points of the answer along each coordinate, for instance 200x100.
    #[arg(long, value_name = "NxM", value_parser = grid, help_heading = DATA)]
    pub(crate) grid: Option<Grid>,
    /// Unit of the cloud's coordinates: m, cm, mm, um or in [default: m].
    #[arg(long, value_name = "UNIT", help_heading = DATA)]
    pub(crate) unit: Option<LengthUnit>,
    /// TOML of the camera that took a depth image (PNG of 16 bit, or NPY): fx, fy, cx, cy, and where it is.
    #[arg(long, value_name = "FILE", help_heading = DATA)]
    pub(crate) camera: Option<PathBuf>,
    /// Header of the column that holds a quantity, for instance q=pos, or 'q=pos [mm]' if it says no unit. Repeatable.
    #[arg(long, value_name = "NAME=HEADER", value_parser = pair, help_heading = DATA)]
    pub(crate) column: Vec<(String, String)>,
    /// About how many points a group in a domain shall have, for instance inside=4000. Repeatable.
    #[arg(long, value_name = "GROUP=N", value_parser = points, help_heading = DATA)]
    pub(crate) points: Vec<(String, usize)>,
    /// Leave out measured values that are far off: Welsch's loss instead of the square.
    #[arg(long, help_heading = DATA)]
    pub(crate) robust: bool,
    /// CSV of the truth, used to score the answer and for nothing else.
    #[arg(long, value_name = "FILE", help_heading = DATA)]
    pub(crate) truth: Option<PathBuf>,
    /// A parameter's value in its declared unit, for instance m0=0.05. Repeatable.
    #[arg(long, value_name = "NAME=VALUE", value_parser = value, help_heading = DATA)]
    pub(crate) set: Vec<(String, f64)>,
    /// TOML file of options; those on the command line win.
    #[arg(long, value_name = "FILE", help_heading = DATA)]
    pub(crate) config: Option<PathBuf>,
    /// Seed of the initial weights.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = seed, allow_negative_numbers = true,
          help_heading = METHOD)]
    pub(crate) seed: u64,
    /// Element type of the network; auto is f32 as long as that helps, with methods that work in it, and then f64.
    #[arg(long, value_name = "NAME", default_value = "auto", value_parser = precisions(), help_heading = METHOD)]
    pub(crate) precision: String,
    /// What carries state and source; auto looks at scene and data. --optimizer and --activation mean a network.
    #[arg(long, value_name = "NAME", default_value = "auto", value_parser = ["auto", "network", "splines"],
          help_heading = METHOD)]
    pub(crate) carrier: String,
    /// Method of minimisation; auto chooses by noise and size, and for wide networks by a short trial.
    #[arg(long, value_name = "NAME", default_value = "auto", value_parser = optimizers(), help_heading = METHOD)]
    pub(crate) optimizer: String,
    /// Hidden units of a layer.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = size, allow_negative_numbers = true,
          help_heading = METHOD)]
    pub(crate) width: usize,
    /// Layers.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = size, allow_negative_numbers = true,
          help_heading = METHOD)]
    pub(crate) layers: usize,
    /// What the units of a network do: tanh, or sine for fields that oscillate [default: tanh].
    #[arg(long, value_name = "NAME", value_parser = activations(), help_heading = METHOD)]
    pub(crate) activation: Option<String>,
    /// Train a network on a third of the equations' points, those where they are most off, drawn anew every N steps.
    #[arg(long, value_name = "N", value_parser = count, allow_negative_numbers = true, help_heading = METHOD)]
    pub(crate) resample: Option<usize>,
    /// Threads [default: one per processor]. The answer does not depend on them.
    #[arg(long, value_name = "N", value_parser = count, allow_negative_numbers = true, help_heading = METHOD)]
    pub(crate) threads: Option<usize>,
    /// Wall time; the best state so far is the answer [default: 10; for point clouds 30].
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_negative_numbers = true, help_heading = METHOD)]
    pub(crate) budget: Option<f64>,
    /// Steps at most [default: as many as the budget allows].
    #[arg(long, value_name = "N", value_parser = count, allow_negative_numbers = true, help_heading = METHOD)]
    pub(crate) iterations: Option<usize>,
    /// Folder for results; made if it is not there.
    #[arg(long, value_name = "DIR", default_value = "nisp-out", help_heading = RESULTS)]
    pub(crate) out: PathBuf,
    /// Show the errors of classical methods too, where a truth is given and they know the equation.
    #[arg(long, help_heading = RESULTS)]
    pub(crate) rivals: bool,
    /// Keep checkpoint.nisp there: every few seconds and at the end.
    #[arg(long, help_heading = RESULTS)]
    pub(crate) checkpoint: bool,
    /// Folder whose checkpoint.nisp to go on from, with the same scene, data and method.
    #[arg(long, value_name = "DIR", help_heading = RESULTS)]
    pub(crate) resume: Option<PathBuf>,
    /// One JSON object on standard output, and nothing else there.
    #[arg(long, help_heading = RESULTS)]
    pub(crate) json: bool,
}

const DATA: &str = "Data";
const METHOD: &str = "Method";
const RESULTS: &str = "Results";

/// Where an answer is read.
#[derive(Group)]
#[group(required = true, multiple = false)]
pub(crate) struct Place {
    /// Table of the points, with a column for each coordinate.
    #[arg(long, value_name = "FILE")]
    pub(crate) at: Option<PathBuf>,
    /// Points along each coordinate over the domain, for instance 200x100.
    #[arg(long, value_name = "NxM", value_parser = grid)]
    pub(crate) grid: Option<Grid>,
}

/// What a command line turned out to be.
pub(crate) enum Parsed {
    Asked(Args),
    /// Help or version, which is all that was wanted.
    Shown(ExitCode),
}

/// Reads a program's command line, and the configuration that it names.
pub(crate) fn parse(program: &Program, words: Vec<OsString>) -> Result<Parsed, String> {
    let first = program.equations.first().map_or("heat.pde", |entry| entry.name);
    let command = Args::command()
        .name(program.name)
        .after_help(format!("Begin with `{0} solve {first}`; `{0} solve --help` has examples.", program.name))
        .mut_subcommand("solve", |solve| solve.after_long_help(format!("Examples:\n{}\n\n{TEACH}", program.examples)));
    let read = |words: &mut dyn Iterator<Item = OsString>| {
        command.clone().try_get_matches_from(words).and_then(|found| Args::from_arg_matches(&found))
    };
    let args = match read(&mut words.iter().cloned()) {
        Ok(args) => args,
        Err(error) => return show(&error).map(Parsed::Shown),
    };
    let Command::Solve(options) = &args.command else { return Ok(Parsed::Asked(args)) };
    let Some(path) = &options.config else { return Ok(Parsed::Asked(args)) };
    let flags = config::flags(path)?;
    // The file alone first, so that a fault of it is said to be one.
    let alone = words[..2].iter().cloned().chain([options.equation.clone().into()]).chain(flags.clone());
    if let Err(error) = read(&mut alone.into_iter()) {
        return Err(format!("{}: {}", path.display(), one_line(&error)));
    }
    let mut both = words[..2].iter().cloned().chain(flags).chain(words[2..].iter().cloned());
    read(&mut both).map(Parsed::Asked).or_else(|error| show(&error).map(Parsed::Shown))
}
