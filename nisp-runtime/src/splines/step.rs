//! Gauss-Newton steps, while the evidence finds how noisy the data and how rough the sources are.

use super::iterate::{Phase, State};
use super::rows::Counted;
use super::solver::Solver;
use super::told::Along;
use super::triangle::covariance::Covariance;
use crate::schema;
use crate::solve::fault::Fault;
use crate::tolerance;
use crate::weighed::{Tally, renew};

/// How far equations may be off in the end, beside the sum of the magnitudes of their terms.
pub(super) const TOLERANCE: f64 = 1e-6;
/// How far they may be off for the sizes of noise and sources to be looked for.
const STRAYED: f64 = 1e-3;
/// Logarithm of the evidence that a larger source may cost and still be possible, and how many numbers must be told of a source
/// for the evidence to know its size.
const DOUBT: f64 = 2.0;
const TELLING: f64 = 2.0;
/// Largest change of a learned parameter in a step.
const FARTHEST: f64 = 1.0;
/// A step is halved so often until it leads downhill, and so often until equations have a value where it leads.
const HALVINGS: u32 = 8;
const MOST_HALVINGS: u32 = 40;

/// What a step found.
pub(super) struct Found {
    pub(super) next: State,
    /// Half the sum of squares of all rows before the step.
    pub(super) loss: f64,
    /// Largest change of a coefficient or parameter.
    pub(super) change: f64,
    /// Largest change of a learned scalar's parameter that the whole step would make.
    pub(super) ahead: f64,
    /// Logarithm of the evidence, up to a constant.
    pub(super) evidence: f64,
    pub(super) covariance: Covariance,
    /// Rows that say how large the noise is, where rows alone may say it.
    pub(super) noisy: Option<f64>,
    /// By head, how many numbers rows other than its prior say of a source.
    told: Vec<f64>,
}

/// An iterate, the step about it, and variances.
type Doubted = (State, Found, Vec<f64>);

impl Solver<'_> {
    /// One step.
    pub(super) fn step(&mut self, state: &State, phase: Phase) -> Result<Option<Found>, Fault> {
        self.size(state);
        let (rows, before) = self.rows(state, phase)?;
        if self.triangle.band() == self.band(state) {
            self.triangle.clear();
        } else {
            self.triangle = self.empty(state);
        }
        self.triangle.add_all(rows.walk());
        let pull = self.pull(state, phase)?;
        if let Some(pull) = &pull {
            self.triangle.draw(&pull.slopes);
        }
        let Some((step, shared)) = self.triangle.solve() else { return Ok(None) };
        let covariance = self.triangle.covariance();
        let (is_equation, is_between) = (self.equations(state), self.shared_with_between(state));
        let mut tallies = vec![Tally::default(); state.classes.len() + 1];
        let (mut loss, mut strayed, mut asked) = (0.0, 0.0, 0.0);
        let mut walk = rows.walk();
        while let Some(Counted { row, class, count }) = walk.step() {
            let tally = &mut tallies[class];
            let along: f64 = row.slopes.iter().zip(&step[row.first..]).map(|(a, x)| a * x).sum();
            let beside: f64 = row.shared.iter().zip(&shared).map(|(a, x)| a * x).sum();
            tally.squares += (row.value + along + beside).powi(2);
            tally.count += count as f64;
            // Equations are so much stricter than anything else that each settles an unknown, but where they are more.
            if is_equation[class] {
                (strayed, asked) = (strayed + row.value.powi(2), asked + count as f64);
            }
            if !is_equation[class] || is_between[class] {
                tally.used += covariance.of(row.first, row.slopes, row.shared).max(0.0);
            }
            loss += 0.5 * row.value.powi(2);
        }
        self.clean(state, phase, &mut tallies);
        let worth = self.count_priors(state, &mut tallies, phase);
        let noisy =
            state.classes.iter().zip(&tallies).filter_map(|(class, tally)| class.told_by(tally)).reduce(f64::min);
        let squares: f64 = tallies.iter().map(|tally| tally.squares).sum();
        let lacking = pull.as_ref().map_or(0.0, |pull| self.lacking(pull, state, &tallies, worth));
        let sizes = self.log_sizes(state, &tallies, |_| true);
        let evidence = -0.5 * squares - sizes + worth + lacking - self.triangle.log_determinant();
        let (step, shared) = self.within_bounds(state, &rows, (step, shared));
        let (scalars, lines) = shared.split_at(state.learned.len());
        let mut share = scalars.iter().fold(1.0, |share: f64, x| share.min(FARTHEST / x.abs().max(1e-300)));
        let mut next = state.clone();
        let slopes = pull.map_or_else(Vec::new, |pull| pull.slopes);
        let drawn: f64 = slopes.iter().zip(&shared).map(|(slope, x)| slope * x).sum();
        for halvings in 0..MOST_HALVINGS {
            next.theta = state.theta.iter().zip(&step).map(|(x, s)| x + share * s).collect();
            next.learned = state.learned.iter().zip(scalars).map(|(x, s)| x + share * s).collect();
            next.lines = state.lines.iter().zip(lines).map(|(x, s)| x + share * s).collect();
            let after = self.loss(&next, phase) - share * drawn;
            let is_less = after <= before * (1.0 + 1e-9) + 1e-12;
            if after.is_finite() && (is_less || halvings + 1 >= HALVINGS) {
                break;
            }
            share *= 0.5;
            // Where no step has a value, none is taken.
            (next.theta, next.learned) = (state.theta.clone(), state.learned.clone());
            next.lines.clone_from(&state.lines);
        }
        let ahead = scalars.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let change = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let change = change(&state.theta, &next.theta).max(change(&state.learned, &next.learned));
        // Equations that are loose need no source, and what is left of the data is no noise before they nearly hold.
        let is_loose = phase == Phase::Solve && state.tolerance > TOLERANCE;
        let has_strayed = phase == Phase::Solve && strayed * state.tolerance.powi(2) > STRAYED.powi(2) * asked;
        self.count_lengths(&next, &covariance, &mut tallies)?;
        let is_prior = |class| self.roughness.contains(&class) || self.amplitude.contains(&Some(class));
        let judged: Vec<usize> = self.judged(phase).into_iter().map(|head| self.roughness[head]).collect();
        let is_length = |class| self.is_length(state, class);
        let is_other = |class| self.roughness.contains(&class) && !judged.contains(&class);
        renew(&mut next.classes, &tallies, |class| {
            let is_early =
                is_loose && (is_prior(class) || is_length(class)) || phase == Phase::Regress && is_length(class);
            has_strayed || is_early || is_other(class)
        });
        if phase == Phase::Solve {
            next.tolerance = tolerance::after(state.tolerance, share, TOLERANCE);
        }
        next.step += 1;
        let left = |class: usize| tallies[class].count - tallies[class].used;
        let told = self.roughness.iter().zip(&self.amplitude);
        let told = told.map(|(&rough, amplitude)| amplitude.map_or(0.0, |class| left(rough) + left(class))).collect();
        Ok(Some(Found { next, loss, change, ahead, evidence, covariance, noisy, told }))
    }

    /// Sum of the logarithms of what rows of such terms are divided by, those of priors aside.
    pub(super) fn log_sizes(&self, state: &State, tallies: &[Tally], is_such: impl Fn(&schema::Term) -> bool) -> f64 {
        let mut sum = 0.0;
        for (at, group) in self.groups.iter().enumerate() {
            for (number, term) in group.schema.terms.iter().enumerate().filter(|(_, term)| is_such(term)) {
                let rows = term.first..term.first + term.rows;
                let places = if group.schema.asks_between(term) { group.len().max(1) } else { 1 };
                let log = |row| {
                    (0..places).map(|p| self.sigma_at(state, (at, number), row, p).ln()).sum::<f64>() / places as f64
                };
                let logs: f64 = rows.map(log).sum();
                let count = tallies[self.classes[at][number]].count;
                // Terms without rows have no size.
                sum += if count > 0.0 { count * logs / term.rows as f64 } else { 0.0 };
                sum += self.log_rest(state, (at, number));
            }
        }
        sum
    }

    /// What error bars are taken from, and the step about it: sources as rough as a wave over the domain at least, and where
    /// hardly anything is told of them, as large as the evidence does not speak against. Where the evidence takes a source for
    /// nothing, or for a polynomial, error bars should not. Noise that rows share is as long as the evidence does not speak against, too:
    /// what is slow in it may as well be a source. Third, the variances along sources.
    pub(super) fn doubted(&mut self, mut state: State, along: &[Along]) -> Result<Option<Doubted>, Fault> {
        let variances = |solver: &Self| along.iter().map(|along| along.variance(&solver.triangle)).collect();
        let Some(mut found) = self.step(&state, Phase::Solve)? else { return Ok(None) };
        let mut spread = variances(self);
        let (least, natural) = (found.evidence - DOUBT, self.length.sqrt());
        for head in 0..self.roughness.len() {
            let Some(amplitude) = self.amplitude[head] else { continue };
            loop {
                let mut doubted = state.clone();
                let [own, rough] = [amplitude, self.roughness[head]].map(|class| state.classes[class].size);
                let own = if found.told[head] < TELLING { own.max((2.0 * own).min(natural)) } else { own };
                let wave = self.priors[head].roughness(own, self.heads.bases[head].cells() as f64);
                doubted.classes[amplitude].size = own;
                doubted.classes[self.roughness[head]].size = rough.max(wave);
                if doubted.classes == state.classes {
                    break;
                }
                match self.step(&doubted, Phase::Solve)? {
                    Some(next) if next.evidence > least => (state, found, spread) = (doubted, next, variances(self)),
                    _ => break,
                }
            }
        }
        while let Some(longer) = self.longer(&state) {
            match self.step(&longer, Phase::Solve)? {
                Some(next) if next.evidence > least => (state, found, spread) = (longer, next, variances(self)),
                _ => break,
            }
        }
        Ok(Some((state, found, spread)))
    }

    /// The variance along a row of a source that is believed before any measurement.
    pub(super) fn beforehand(&self, along: &Along, state: &State) -> f64 {
        let sizes = self.source_sizes(state, along.head);
        sizes.map_or(f64::INFINITY, |sizes| {
            along.beforehand(&self.heads, (&self.priors[along.head], self.belief), sizes)
        })
    }

    /// What priors use up, and what they are worth; returns the logarithm of the determinant of their rows.
    ///
    /// What roughness uses up is what everything else leaves of all unknowns: summed row by row it would be a small difference of
    /// large numbers where cells are much finer than the source.
    fn count_priors(&self, state: &State, tallies: &mut [Tally], phase: Phase) -> f64 {
        let mut log_determinant = 0.0;
        for head in self.believed(phase) {
            let (rough, Some(amplitude)) = (self.roughness[head], self.amplitude[head]) else { continue };
            let (roughness, own) = (state.classes[rough].size, state.classes[amplitude].size);
            let worth = self.priors[head].worth(roughness, own);
            let line = self.line_deviation(head, (roughness, own));
            log_determinant += worth.log_determinant - (0..self.belief.numbers).map(|_| line.ln()).sum::<f64>();
            // Rounding where waves are much longer than cells.
            let small = worth.amplitude.clamp(0.0, tallies[amplitude].count);
            tallies[rough].count = tallies[amplitude].count - small;
            tallies[amplitude].count = small;
        }
        let judged = self.judged(phase);
        let functions = match phase {
            Phase::Solve => self.heads.len(),
            // Nothing is asked of the others.
            Phase::Regress => judged.iter().map(|&head| self.heads.bases[head].len()).sum(),
        };
        let unknowns = (functions + self.bound.learned.len() + state.lines.len()) as f64;
        let is_rough = |class: usize| self.roughness.contains(&class);
        let is_equation = self.equations(state);
        let is_between = self.shared_with_between(state);
        let settling = tallies.iter_mut().zip(is_equation.iter().zip(&is_between)).filter(|(_, is)| *is.0 && !is.1);
        settling.for_each(|(tally, _)| tally.used = tally.count);
        let used: f64 =
            tallies.iter().enumerate().filter(|&(class, _)| !is_rough(class)).map(|(_, tally)| tally.used).sum();
        let rough = || judged.iter().map(|&head| self.roughness[head]);
        let by_rows: f64 = rough().map(|class| tallies[class].used.clamp(0.0, tallies[class].count)).sum();
        let count: f64 = rough().map(|class| tallies[class].count).sum();
        let left = (unknowns - used).clamp(0.0, count);
        for class in rough() {
            let own = tallies[class].used.clamp(0.0, tallies[class].count);
            let share = if by_rows > 0.0 { own / by_rows } else { tallies[class].count / count.max(1.0) };
            tallies[class].used = (left * share).min(tallies[class].count);
        }
        log_determinant
    }
}
