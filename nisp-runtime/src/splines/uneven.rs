//! Sources that are rougher in some parts of a record than in others: a contact, a valve that opens, dry friction that turns.
//!
//! One roughness for all of a record is too small where such a source steps and too large elsewhere. Here the square of the
//! roughness varies along the record. Beside its mean it is believed to be the inverse of a gamma number, so that innovations are
//! those of a Student process (Shah, Wilson and Ghahramani 2014). It is the most likely one given the square of the innovations
//! nearby, as many of them as tell some numbers of the source (MacKay 1992).

use super::iterate::{Phase, State};
use super::solver::Solver;
use crate::solve::fault::Fault;

/// Numbers of a source that are told by the innovations that are looked at together.
const TOGETHER: f64 = 1.5;
/// Shape of the gamma number, twice: how many numbers of a source its mean roughness is worth.
const BELIEF: f64 = 1.0;
/// Square of innovations over what it should be that chance does not make, in one of many parts of a record.
const CHANCE: f64 = 2.0;
/// Changes of the logarithm of a roughness that no longer matter.
const SETTLED: f64 = 0.05;

/// What innovations in a row of a source's prior are, and how many numbers they tell.
struct Innovation {
    square: f64,
    told: f64,
}

impl Solver<'_> {
    /// The state with sources that are as rough along the record as it says itself; nothing where that changes nothing, or where
    /// one roughness describes all of the record.
    pub(super) fn uneven(&mut self, state: &State) -> Result<Option<State>, Fault> {
        let Some(found) = self.step(state, Phase::Solve)? else { return Ok(None) };
        let mut innovations: Vec<Vec<Innovation>> = self.roughness.iter().map(|_| Vec::new()).collect();
        let (roughness, covariance) = (self.roughness.clone(), &found.covariance);
        self.add_priors(state, Phase::Solve, &mut |row, class| {
            if let Some(head) = roughness.iter().position(|&own| own == class) {
                let told = 1.0 - covariance.of(row.first, row.slopes, row.shared);
                innovations[head].push(Innovation { square: row.value.powi(2), told: told.clamp(0.0, 1.0) });
            }
        });
        let (mut next, mut change, mut most) = (State { uneven: Vec::new(), doubt: 0.0, ..state.clone() }, 0.0, 0.0);
        for (head, own) in innovations.iter().enumerate().filter(|(_, own)| !own.is_empty()) {
            let before = self.priors[head].uneven();
            let parts = parts(own, before);
            for (at, (square, told)) in parts.iter().enumerate() {
                let rough = ((square + BELIEF) / (told + BELIEF)).sqrt();
                most = f64::max(most, square / told.max(TOGETHER));
                change = f64::max(change, (rough / before[at]).ln().abs());
                next.doubt += own[at].told / TOGETHER * 0.5 * BELIEF * (rough.powi(-2) + 2.0 * rough.ln() - 1.0);
                next.uneven.push(rough);
            }
            let last = next.uneven[next.uneven.len() - 1];
            next.uneven.resize(next.uneven.len() + before.len() - own.len(), last);
        }
        let is_even = state.uneven.is_empty() && most < CHANCE;
        Ok((!is_even && change > SETTLED).then_some(next))
    }
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
