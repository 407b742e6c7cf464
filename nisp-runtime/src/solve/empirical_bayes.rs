//! Levenberg-Marquardt with the weights of its priors, and noise that is not known, chosen from the data.

use super::curvature::Curvature;
use super::evidence::{self, Belief, Evidence};
use super::fault::Fault;
use super::marquardt::Marquardt;
use super::method::{FAULTS_IN_A_ROW, Method, Step, Verdict};
use super::objective::LeastSquares;
use super::prior::WeightPrior;
use super::state::State;

/// When the weights are chosen anew.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EmpiricalBayesSettings {
    /// Accepted steps before the first time: far from a minimum the curvature says little.
    pub warm_up: u64,
    /// Accepted steps between two times.
    pub every: u64,
    /// Relative change of precisions and sigmas below which they are left alone; a few per cent have no consequences,
    /// and every change begins the judgement of convergence anew.
    pub tolerance: f64,
    /// What is believed of the precisions beforehand.
    pub belief: Belief,
}

impl Default for EmpiricalBayesSettings {
    fn default() -> Self {
        Self { warm_up: 15, every: 4, tolerance: 0.05, belief: Belief { precision: 1.0, count: 0.0 } }
    }
}

/// Largest factor on a precision, and on the square of a sigma, at one time: MacKay's update overshoots while the
/// minimum still moves.
const LARGEST_CHANGE: f64 = 10.0;

/// [`Marquardt`] that maximises the evidence on its way.
pub struct EmpiricalBayes {
    inner: Marquardt,
    settings: EmpiricalBayesSettings,
    accepted: u64,
    since: u64,
    /// Times in a row that the curvature could not be had.
    faults: u64,
    evidence: Option<Evidence>,
    /// Scales that were given to blocks, by number of the block; kept so that a checkpoint has them.
    sigmas: Vec<(usize, f64)>,
    /// The objective does not know them yet.
    restored: bool,
}

impl EmpiricalBayes {
    /// Starts at `theta`; the precisions of `prior` are first guesses.
    pub fn new(theta: Vec<f64>, prior: WeightPrior, settings: EmpiricalBayesSettings) -> Self {
        Self {
            inner: Marquardt::new(theta, prior),
            settings,
            accepted: 0,
            since: 0,
            faults: 0,
            evidence: None,
            sigmas: Vec::new(),
            restored: false,
        }
    }

    /// The weight prior with its present precisions.
    pub fn prior(&self) -> &WeightPrior {
        self.inner.prior()
    }

    /// The evidence when it was last evaluated.
    pub fn evidence(&self) -> Option<&Evidence> {
        self.evidence.as_ref()
    }

    fn give_sigmas<O: LeastSquares + ?Sized>(&mut self, objective: &mut O) {
        let blocks = objective.blocks().len();
        for (index, sigma) in self.sigmas.iter().filter(|(index, _)| *index < blocks) {
            objective.set_sigma(*index, *sigma);
        }
        self.restored = false;
    }

    /// Chooses precisions and sigmas anew; true where they changed.
    fn choose<O: LeastSquares + ?Sized>(&mut self, objective: &mut O) -> Result<bool, Fault> {
        self.since = 0;
        let theta = Method::<f64, O>::theta(&self.inner);
        let mut prior = self.inner.prior().clone();
        let curvature = Curvature::at(objective, theta, &prior)?;
        let found = evidence::evidence(&curvature, &prior, theta, objective.blocks());
        let mut change: f64 = 0.0;
        let mut limited = |old: f64, new: f64, most: f64| {
            let factor = (new / old).clamp(1.0 / most, most);
            change = change.max(factor.ln().abs());
            old * factor
        };
        for (index, group) in found.groups.iter().enumerate() {
            let old = prior.groups()[index].precision;
            // A flat prior has no scale to update.
            if let Some(new) = group.precision(self.settings.belief).filter(|_| old > 0.0) {
                prior.set_precision(index, limited(old, new, LARGEST_CHANGE));
            }
        }
        let mut sigmas = Vec::new();
        let clean: Vec<Option<f64>> = (found.blocks.iter().enumerate())
            .map(|(index, block)| objective.clean_sigma(theta, index, block.effective))
            .collect();
        for (index, block) in objective.blocks().iter().enumerate() {
            let new = clean[index].unwrap_or(found.blocks[index].sigma);
            if evidence::is_free(block) && new > 0.0 && new.is_finite() {
                sigmas.push((index, limited(block.sigma, new, LARGEST_CHANGE.sqrt())));
            }
        }
        self.evidence = Some(found);
        if change <= self.settings.tolerance {
            return Ok(false);
        }
        self.sigmas = sigmas;
        self.give_sigmas(objective);
        self.inner.set_prior(prior);
        Ok(true)
    }
}

impl<O: LeastSquares + ?Sized> Method<f64, O> for EmpiricalBayes {
    fn name(&self) -> &'static str {
        "lm-evidence"
    }

    fn theta(&self) -> &[f64] {
        Method::<f64, O>::theta(&self.inner)
    }

    fn step(&mut self, objective: &mut O) -> Result<Step, Fault> {
        if self.restored {
            self.give_sigmas(objective);
        }
        let mut step = self.inner.step(objective)?;
        if matches!(step.verdict, Verdict::Moved | Verdict::Changed) {
            self.accepted += 1;
            self.since += 1;
        }
        let due = self.accepted >= self.settings.warm_up && self.since >= self.settings.every;
        let still = step.decrement.is_some_and(|decrement| decrement < 1e-4 * step.loss) && self.since > 0;
        if due || still || step.verdict == Verdict::Exhausted {
            match self.choose(objective) {
                Ok(changed) => {
                    self.faults = 0;
                    if changed {
                        step.verdict = Verdict::Changed;
                    }
                }
                // The step itself was good, and the weights can wait.
                Err(_) if self.faults + 1 < FAULTS_IN_A_ROW => self.faults += 1,
                Err(fault) => return Err(fault),
            }
        }
        Ok(step)
    }

    fn prior(&self) -> Option<&WeightPrior> {
        Some(self.inner.prior())
    }

    fn save(&self) -> State {
        let mut state = Method::<f64, O>::save(&self.inner);
        state.method = "lm-evidence".into();
        let flat: Vec<f64> = self.sigmas.iter().flat_map(|(index, sigma)| [*index as f64, *sigma]).collect();
        state
            .with("sigmas", &flat)
            .with_counter("accepted", self.accepted)
            .with_counter("since", self.since)
            .with_counter("waiting", self.faults)
    }

    fn restore(&mut self, state: &State) -> Result<(), Fault> {
        state.check_method("lm-evidence")?;
        let (accepted, since) = (state.counter("accepted")?, state.counter("since")?);
        let faults = state.counter("waiting")?;
        let (sigmas, rest) = state.vector("sigmas")?.as_chunks::<2>();
        if !rest.is_empty() || sigmas.iter().any(|[_, sigma]| *sigma <= 0.0) {
            return Err(Fault::state("sigmas"));
        }
        let inner = State { method: "lm".into(), ..state.clone() };
        Method::<f64, O>::restore(&mut self.inner, &inner)?;
        (self.accepted, self.since, self.faults) = (accepted, since, faults);
        self.sigmas = sigmas.iter().map(|[index, sigma]| (*index as usize, *sigma)).collect();
        self.restored = true;
        Ok(())
    }
}
