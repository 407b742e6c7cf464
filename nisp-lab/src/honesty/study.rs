//! Runs one case: measures, spoils, solves, and compares what was said with what is true.

use std::path::Path;
use std::time::{Duration, Instant};

use nisp::solve::driver::{Flow, Status};
use nisp::{Check, Settings, Solution, recover};
use nisp_cli::interrupt;

use super::corruption::Corruption;
use super::experiment::{Case, Physics, Ready, Stated, Subject, Truth};
use super::judge::{Judgement, Off, Unknown, judge};
use super::{bodies, equations, forward, series};
use crate::random::Random;

/// How cases are run.
pub(super) struct Run {
    pub(super) seed: u64,
    pub(super) budget: f64,
    pub(super) threads: usize,
}

/// What came of a case.
pub(super) struct Row {
    pub(super) equation: &'static str,
    pub(super) corruption: String,
    /// False where another source explains the same data exactly.
    pub(super) can_be_told: bool,
    /// The status, or `refused`.
    pub(super) said: &'static str,
    /// The exit code of `nisp solve`.
    pub(super) exit: u8,
    /// All checks of the verdict.
    pub(super) checks: Vec<Check>,
    /// Why it was refused.
    pub(super) refusal: Option<String>,
    pub(super) unknowns: Vec<(&'static str, Off)>,
    /// Conditions that the answer does not meet.
    pub(super) unmet: Vec<String>,
    pub(super) judgement: Judgement,
    pub(super) seconds: f64,
}

/// All equations with their cases.
pub(super) fn subjects(repository: &Path) -> Vec<Subject> {
    let mut subjects = series::subjects(repository);
    subjects.extend(bodies::subjects(repository));
    subjects.extend(equations::subjects());
    subjects.extend(forward::subjects());
    subjects
}

/// Runs a case.
pub(super) fn run(subject: &Subject, case: &Case, how: &Run) -> Result<Row, String> {
    let start = Instant::now();
    let corruption = case.corruption;
    let physics = match corruption {
        Corruption::Physics => Physics::Other,
        Corruption::Stated(scene) => Physics::Stated(scene),
        _ => Physics::Scene,
    };
    let experiment = (subject.make)(physics)?;
    let mut random = Random::new(how.seed);
    let samples = corruption.measure(&experiment.samples, experiment.noise, &mut random);
    let told: Vec<_> = match corruption {
        Corruption::Parameter(name, value) => vec![(name, value)],
        _ => Vec::new(),
    };
    let solved = (experiment.bind)(&samples, &told).and_then(|ready| {
        let settings = settings(&ready, corruption, how.budget * subject.patience, how);
        let go_on = &mut |_: nisp::Report<'_>| if interrupt::asked() { Flow::Stop } else { Flow::Continue };
        let solution = recover(&ready.problem, &settings, go_on).map_err(|error| error.to_string())?;
        Ok((ready, solution))
    });
    let sound = corruption.is_sound();
    let mut row = Row {
        equation: subject.name,
        corruption: corruption.to_string(),
        can_be_told: case.can_be_told,
        said: "refused",
        exit: 2,
        checks: Vec::new(),
        refusal: None,
        unknowns: Vec::new(),
        unmet: Vec::new(),
        judgement: Judgement { lie: None, false_alarm: sound },
        seconds: 0.0,
    };
    match solved {
        Ok((ready, mut solution)) => {
            row.said = said(solution.status);
            let unfinished = matches!(solution.status, Status::NotConverged | Status::Interrupted);
            row.exit = if unfinished || !solution.is_sound() { 3 } else { 0 };
            row.checks.clone_from(&solution.verdict.checks);
            row.unmet = unmet(&solution, &ready.stated);
            let unknowns = unknowns(&mut solution, &ready.truth);
            row.judgement = judge(solution.status == Status::Converged, &unknowns, &row.unmet, sound);
            row.unknowns = unknowns.into_iter().map(|(unknown, off)| (unknown.name, off)).collect();
        }
        Err(why) => row.refusal = Some(why),
    }
    row.seconds = start.elapsed().as_secs_f64();
    Ok(row)
}

/// The word of `nisp solve --json`.
fn said(status: Status) -> &'static str {
    match status {
        Status::Converged => "converged",
        Status::Budget => "budget",
        Status::NotConverged | Status::Interrupted => "not_converged",
        Status::Inconsistent => "inconsistent",
    }
}

fn settings(ready: &Ready, corruption: Corruption, budget: f64, how: &Run) -> Settings {
    let iterations = match corruption {
        Corruption::Early(steps) => Some(steps),
        _ => None,
    };
    Settings {
        carrier: ready.carrier,
        seed: how.seed,
        budget: Some(Duration::from_secs_f64(budget)),
        threads: how.threads,
        iterations,
        ..Settings::default()
    }
}

/// What the answer says of all that the truth knows.
fn unknowns(solution: &mut Solution, truth: &Truth) -> Vec<(Unknown, Off)> {
    let estimates = if truth.heads.is_empty() { Vec::new() } else { solution.evaluate_with_errors(&truth.points) };
    let heads = truth.heads.iter().filter_map(|(name, truth_of)| {
        let found = estimates.iter().find(|estimate| estimate.name == *name)?;
        let (values, deviations) = (found.values.clone(), found.deviations.clone());
        Some(Unknown { name, values, deviations, truth: truth_of.clone(), size: truth.size, limit: truth.limit })
    });
    let mut all: Vec<Unknown> = heads.collect();
    let learned = if truth.scalars.is_empty() { Vec::new() } else { solution.learned() };
    all.extend(truth.scalars.iter().filter_map(|&(name, value)| {
        let found = learned.iter().find(|learned| learned.name == name)?;
        let deviations = found.deviation.map(|deviation| vec![deviation]);
        Some(Unknown {
            name,
            values: vec![found.value],
            deviations,
            truth: vec![value],
            size: truth.size,
            limit: truth.limit,
        })
    }));
    let with_off = |unknown: Unknown| {
        let off = unknown.off();
        (unknown, off)
    };
    all.into_iter().map(with_off).collect()
}

/// Share of what a quantity is that a condition on it may be off by.
const UNMET: f64 = 0.05;

/// Conditions that the answer does not meet, beside their own value and what the quantity is elsewhere.
fn unmet(solution: &Solution, stated: &[Stated]) -> Vec<String> {
    let value = |stated: &Stated| {
        let found = solution.evaluate(&stated.at).into_iter().find(|estimate| estimate.name == stated.head);
        found.map_or(f64::NAN, |found| found.values[0])
    };
    let missed = stated.iter().filter_map(|stated| {
        let found = value(stated);
        let size = stated.value.abs().max(stated.size);
        let is_met = (found - stated.value).abs() <= UNMET * size;
        (!is_met).then(|| format!("{} is {found:.3e} where {:.3e} is stated", stated.head, stated.value))
    });
    missed.collect()
}
