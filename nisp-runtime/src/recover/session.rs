//! Answers to data that keep coming: each from the last one, as long as that leads anywhere.

use std::time::Instant;

use super::choice::Attempt;
use super::course::Course;
use super::settings::Carrier;
use super::{
    Monitor, Optimizer, RecoverError, Settings, Solution, checkpoint, limits, on_lattice, prepared, recover, threads,
};
use crate::local::{Live, Local};
use crate::problem::{Bound, Problem};
use crate::solve::driver::{Status, Warning, WarningKind};
use crate::verdict::Check;

/// A problem whose data change, with its last answer.
///
/// Local functions go on from that answer where nothing but clouds and given parameters has changed: units, scales, the lattice
/// and the pattern of the equations stay, and a few steps are taken. What the verdict does not accept is sought again from
/// nothing, unless the last answer that was sought so was not accepted for the same reason. What did not converge is not gone on from:
/// the next answer follows the last one that did. Other carriers solve every problem from nothing.
pub struct Session {
    problem: Problem,
    settings: Settings,
    pool: rayon::ThreadPool,
    kept: Option<Kept>,
    solution: Option<Solution>,
}

/// What an answer of local functions leaves for the next.
struct Kept {
    bound: Bound,
    live: Live,
    local: Local,
    settings: Settings,
    /// What is kept of the last problem that was solved from its start.
    fingerprint: u64,
    /// What the data leave open there.
    open: Vec<Warning>,
    /// How that answer ended, and the checks that it did not pass.
    status: Status,
    faults: Vec<Fault>,
}

/// A check, the group and the term that did not pass it.
type Fault = (&'static str, &'static str, &'static str);

impl Session {
    /// A session with a problem and no answer yet. The budget of the settings is that of an answer sought from nothing.
    ///
    /// # Errors
    /// Threads that cannot be started.
    pub fn new(problem: Problem, settings: Settings) -> Result<Self, RecoverError> {
        let pool = threads(&settings)?;
        Ok(Self { problem, settings, pool, kept: None, solution: None })
    }

    /// The problem, for new data.
    pub fn problem(&mut self) -> &mut Problem {
        &mut self.problem
    }

    /// The last answer.
    pub fn solution(&mut self) -> Option<&mut Solution> {
        self.solution.as_mut()
    }

    /// Answers the problem as it is now. `monitor` sees every step of an answer that is sought from nothing, and may stop it.
    ///
    /// # Errors
    /// As [`recover`].
    pub fn update(&mut self, monitor: &mut Monitor<'_>) -> Result<&mut Solution, RecoverError> {
        let solution = match self.follow()? {
            Some(solution) => solution,
            None => self.seek(monitor)?,
        };
        Ok(self.solution.insert(solution))
    }

    /// The answer from the last one; nothing where there is none, or where that led astray.
    fn follow(&mut self) -> Result<Option<Solution>, RecoverError> {
        let start = Instant::now();
        let Some(kept) = &mut self.kept else { return Ok(None) };
        let Some(bound) = kept.bound.renewed(&self.problem)? else { return Ok(None) };
        let place = kept.live.place();
        let solution = self.pool.install(|| kept.follow(bound, start));
        match solution.as_ref().map(|solution| solution.status) {
            Some(Status::Converged) => (kept.status, kept.faults) = (Status::Converged, Vec::new()),
            Some(Status::NotConverged) | None => kept.live.go_back(place),
            Some(_) => {}
        }
        Ok(solution.filter(|solution| !kept.is_astray(solution)))
    }

    /// The answer from nothing.
    fn seek(&mut self, monitor: &mut Monitor<'_>) -> Result<Solution, RecoverError> {
        let Carrier::Local(local) = self.settings.carrier else {
            return recover(&self.problem, &self.settings, monitor);
        };
        let start = Instant::now();
        let (bound, settings) = prepared(&self.problem, &self.settings)?;
        let fingerprint = checkpoint::fingerprint(&self.problem, &settings);
        let course = Course::new(fingerprint, limits(&settings), start, None, monitor);
        let (solution, live) = self.pool.install(|| {
            let (solved, live) = on_lattice::sought(&bound, &local, course)?;
            let attempt = attempt(local, &settings, SOUGHT);
            let solution = Solution::new(bound.clone(), solved, (&settings, start), &attempt, fingerprint);
            Ok::<_, RecoverError>((solution, live))
        })?;
        let open = solution.warnings.iter().filter(|warning| warning.kind == WarningKind::Undetermined);
        let (open, status, faults) = (open.cloned().collect(), solution.status, faults(&solution));
        match &mut self.kept {
            Some(kept) if status == Status::NotConverged => (kept.status, kept.faults) = (status, faults),
            _ => self.kept = Some(Kept { bound, live, local, settings, fingerprint, open, status, faults }),
        }
        Ok(solution)
    }
}

/// Why local functions carry an answer.
const FOLLOWED: &str = "it goes on from the answer before";
const SOUGHT: &str = "there was no answer to go on from";

fn attempt(local: Local, settings: &Settings, why: &str) -> Attempt {
    Attempt { carrier: Box::new(local), seed: settings.seed, why: why.into(), share: 1.0 }
}

impl Kept {
    /// The answer to a problem of the same points, from the last one. Steps that lead to numbers that are not finite lead nowhere.
    fn follow(&mut self, bound: Bound, start: Instant) -> Option<Solution> {
        let found = self.live.update(bound.clone()).ok()?;
        let solved = on_lattice::solved(found, self.open.clone(), Optimizer::Marquardt);
        let attempt = attempt(self.local, &self.settings, FOLLOWED);
        Some(Solution::new(bound, solved, (&self.settings, start), &attempt, self.fingerprint))
    }

    /// True where an answer has a fault that the one sought from nothing did not have.
    fn is_astray(&self, solution: &Solution) -> bool {
        let is_new = |fault: &_| !self.faults.contains(fault);
        let is_lost = solution.status == Status::NotConverged && self.status != Status::NotConverged;
        is_lost || faults(solution).iter().any(is_new)
    }
}

/// The checks that an answer does not pass. That of what is given is one for the whole problem, and names what would gain most.
fn faults(solution: &Solution) -> Vec<Fault> {
    let fault = |check: &Check| match check.check {
        given @ "given" => (given, "", ""),
        own => (own, check.group, check.term),
    };
    solution.verdict.failed().map(fault).collect()
}
