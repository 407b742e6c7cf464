//! Sources that are rougher in some parts of a record than in others: a contact, a valve that opens, dry friction that turns.
//!
//! One roughness for all of a record is too small where such a source steps and too large elsewhere. Here the square of the
//! roughness varies along the record. Beside its mean it is believed to be the inverse of a gamma number, so that innovations are
//! those of a Student process (Shah, Wilson and Ghahramani 2014). It is the most likely one given the square of the innovations
//! nearby, as many of them as tell some numbers of the source (MacKay 1992).

use super::iterate::{Phase, State};
use super::solver::Solver;
use super::triangle::covariance::Covariance;
use crate::solve::fault::Fault;

/// Numbers of a source that are told by the innovations that are looked at together.
const TOGETHER: f64 = 1.5;
/// Shape of the gamma number, twice: how many numbers of a source its mean roughness is worth.
const BELIEF: f64 = 1.0;
/// Square of the innovations in the roughest part over what it should be, below which a source is clearly even. Chance makes as much
/// of some even sources too: of these the evidence refuses another roughness.
const CHANCE: f64 = 2.0;
/// Changes of the logarithm of a roughness that no longer matter.
const SETTLED: f64 = 0.05;

/// What innovations in a row of a source's prior are, and how many numbers they tell.
struct Innovation {
    square: f64,
    told: f64,
}

/// Variance of what cells cannot hold, beside that of what they hold, at most.
const BEYOND: f64 = 4.0;

impl Solver<'_> {
    /// The state with the roughness that its own sources show along the record; nothing where that is the one they have, or where
    /// they are clearly even.
    pub(super) fn uneven(&mut self, state: &State) -> Result<Option<State>, Fault> {
        let Some(found) = self.step(state, Phase::Solve)? else { return Ok(None) };
        let innovations = self.innovations(state, &found.covariance);
        let (mut next, mut change, mut most) = (State { uneven: Vec::new(), doubt: 0.0, ..state.clone() }, 0.0, 0.0);
        for head in self.believed(Phase::Solve) {
            let (own, before) = (&innovations[head], self.priors[head].uneven());
            if own.is_empty() {
                next.uneven.extend(before);
                continue;
            }
            let parts = parts(own, &before[(before.len() - own.len()) / 2..]);
            let rough = |&(square, told): &(f64, f64)| ((square + BELIEF) / (told + BELIEF)).sqrt();
            for (own, part) in own.iter().zip(&parts) {
                let rough = rough(part);
                most = f64::max(most, part.0 / part.1.max(TOGETHER));
                next.doubt += own.told / TOGETHER * 0.5 * BELIEF * (rough.powi(-2) + 2.0 * rough.ln() - 1.0);
            }
            for (function, row) in rows(before.len(), own.len()) {
                change = f64::max(change, (rough(&parts[row]) / before[function]).ln().abs());
                next.uneven.push(rough(&parts[row]));
            }
        }
        let is_even = state.uneven.is_empty() && most < CHANCE;
        Ok((!is_even && change > SETTLED).then_some(next))
    }

    /// By head, the innovations in the rows of its prior; none of fields.
    fn innovations(&self, state: &State, covariance: &Covariance) -> Vec<Vec<Innovation>> {
        let mut innovations: Vec<Vec<Innovation>> = self.roughness.iter().map(|_| Vec::new()).collect();
        self.add_priors(state, Phase::Solve, &mut |row, class| {
            if let Some(head) = self.roughness.iter().position(|&own| own == class) {
                let told = 1.0 - covariance.of(row.first, row.slopes, row.shared);
                innovations[head].push(Innovation { square: row.value.powi(2), told: told.clamp(0.0, 1.0) });
            }
        });
        innovations
    }

    /// By unknown, the variance of sources that splines on the cells cannot hold. Where the data tell the innovations in most single
    /// cells, as where every measurement has one, they tell of shorter waves too. No more than what is open of what cells do hold, about:
    /// where a layer may be at the start, the first cells hold none of it, but a large one would be seen in the data.
    pub(super) fn unresolved(&self, state: &State, covariance: &Covariance) -> Vec<f64> {
        let mut variances = vec![0.0; self.heads.len()];
        let shared = vec![0.0; state.shared()];
        for (head, innovations) in self.innovations(state, covariance).iter().enumerate() {
            let Some((rough, amplitude)) = self.source_sizes(state, head).filter(|_| !innovations.is_empty()) else {
                continue;
            };
            let (basis, prior) = (&self.heads.bases[head], &self.priors[head]);
            let told = innovations.iter().map(|own| own.told).sum::<f64>() / innovations.len() as f64;
            for function in 0..basis.len() {
                let number = self.heads.numbers(head, function)[0];
                let unresolved = (1.0 - told) * prior.unresolved(function, rough, amplitude) / basis.squares(function);
                variances[number] = unresolved.min(BEYOND * covariance.of(number, &[1.0], &shared).max(0.0));
            }
        }
        variances
    }
}

/// Every function with the number of the prior's row that is centred on it. A row is a difference of neighbouring functions, and is
/// centred on the middle one.
fn rows(functions: usize, rows: usize) -> impl Iterator<Item = (usize, usize)> {
    let ahead = (functions - rows) / 2;
    (0..functions).map(move |function| (function, function.saturating_sub(ahead).min(rows - 1)))
}

/// About every row: the sum of the squares of innovations, each over the mean roughness, and the numbers that they tell.
fn parts(innovations: &[Innovation], uneven: &[f64]) -> Vec<(f64, f64)> {
    let mut sums = vec![(0.0, 0.0)];
    for (own, rough) in innovations.iter().zip(uneven) {
        let (squares, told) = sums[sums.len() - 1];
        sums.push((squares + own.square * rough * rough, told + own.told));
    }
    let count = innovations.len();
    let part = |at: usize| {
        let ends = |reach: usize| (at.saturating_sub(reach), (at + reach + 1).min(count));
        let told = |reach: usize| sums[ends(reach).1].1 - sums[ends(reach).0].1;
        // The shortest reach that tells enough, by halving.
        let (mut short, mut long) = (0, count);
        while short < long {
            let middle = (short + long) / 2;
            if told(middle) < TOGETHER { short = middle + 1 } else { long = middle }
        }
        let (from, to) = ends(short);
        (sums[to].0 - sums[from].0, told(short))
    };
    (0..count).map(part).collect()
}
