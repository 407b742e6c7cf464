//! A second start where the noise may hide a source (see `start`), and the evidence that chooses.

use super::solver::Solver;
use super::state::{Ended, Phase, State};
use crate::local::block::Block;
use crate::local::normal::factor::Factor;
use crate::noise::{Noise, ObservationNoise};
use crate::schema::TermKind;
use crate::solve::dense;
use crate::start::{self, ENOUGH, QUIETER, ROUGHER};

/// A direction of which less than this is left is settled by measurements alone.
const SETTLED: f64 = 1e-8;

impl Solver<'_> {
    /// Where the solver starts again after a state that has settled; nothing if its noise hides no source, or if it is of the second
    /// start itself.
    pub(super) fn again(&mut self, noise: &Noise, state: &State) -> Option<State> {
        let count = |found: &ObservationNoise| self.groups[found.group].sites.count;
        let size = |found: &ObservationNoise| state.classes[self.classes[found.group][found.term]].size;
        // The evidence costs the cube of the measurements, and clouds have thousands.
        let is_few = noise.observations.iter().map(count).sum::<usize>() <= ENOUGH;
        let may_hide = is_few && start::may_hide(noise, count, size);
        if state.earlier.is_some() || !self.surfaces.is_empty() || !may_hide || self.judged(Phase::Solve).is_empty() {
            return None;
        }
        let evidence = self.evidence(state)?;
        let mut quieter = noise.clone();
        quieter.observations.iter_mut().for_each(|found| found.deviation *= QUIETER);
        let earlier = Some(Box::new(Ended { state: state.clone(), evidence }));
        let mut first = self.first(&quieter);
        for (&class, prior) in self.roughness.iter().zip(&self.priors) {
            first.classes[class].restart(ROUGHER * prior.natural);
        }
        Some(State { step: state.step, earlier, ..first })
    }

    /// The end of the earlier start, unless the later one has settled at a state with more evidence.
    pub(super) fn earlier(&mut self, state: &mut State, has_settled: bool) -> Option<State> {
        let earlier = state.earlier.take()?;
        let is_better = has_settled && self.evidence(state).is_some_and(|evidence| evidence > earlier.evidence);
        (!is_better).then_some(State { step: state.step, ..earlier.state })
    }

    /// Logarithm of the evidence of the measurements about a state that has settled, but for what all states share.
    pub(super) fn evidence(&mut self, state: &State) -> Option<f64> {
        let slopes = self.set_learned(&state.learned);
        self.size(state);
        self.set_sigmas(state);
        let loss = self.loss(state);
        let all = self.assemble(state, &slopes).ok()?;
        let factor = self.normal.factor()?;
        let blocks: Vec<Vec<Block>> =
            all.asked.iter().map(|asked| self.batches(&all, asked).flatten().collect()).collect();
        let (mut rows, mut volume) = (Vec::new(), 0.0);
        for (asked, blocks) in all.asked.iter().zip(&blocks) {
            let group = &self.groups[asked.at];
            let terms = group.schema.terms.iter().filter(|term| term.kind == TermKind::Observation);
            for (at, row) in
                terms.flat_map(|term| (0..term.rows).map(|row| (group.first_own(term) + row, term.first + row)))
            {
                let counts = |p: &u32| asked.counts[row][*p as usize];
                let own = group.order.iter().zip(blocks).filter(|(p, _)| counts(p)).map(|(_, block)| (block, at));
                let before = rows.len();
                rows.extend(own);
                volume += (rows.len() - before) as f64 * group.sigma[row].ln();
            }
        }
        let (left, directions) = left(&rows, &factor, (state.theta.len(), state.learned.len()))?;
        Some(0.5 * left - loss - volume * directions as f64 / rows.len().max(1) as f64)
    }
}

/// Logarithm of the determinant of one less the influence matrix of rows, over so many coefficients and learned scalars; and how
/// many directions it is of. Those that no prior speaks of are settled by measurements alone, under any noise.
fn left(rows: &[(&Block, usize)], factor: &Factor, lens: (usize, usize)) -> Option<(f64, usize)> {
    let solved = |&(block, row): &(&Block, usize)| {
        let (mut by, mut below) = (vec![0.0; lens.0], vec![0.0; lens.1]);
        block.add_signed(row, false, &mut by, &mut below);
        factor.solve(&by, &below)
    };
    let solved: Vec<(Vec<f64>, Vec<f64>)> = rows.iter().map(solved).collect::<Option<_>>()?;
    let influence = |i: usize, j: usize| {
        let (block, row) = rows[i];
        block.after(row, &solved[j].0, &solved[j].1) - block.misfits[row]
    };
    // Symmetric, so that columns may stand for rows.
    let influence: Vec<f64> =
        (0..rows.len()).flat_map(|j| (0..rows.len()).map(move |i| (i, j))).map(|(i, j)| influence(i, j)).collect();
    let (values, _) = dense::eigen(&influence, rows.len())?;
    let left: Vec<f64> = values.iter().map(|value| 1.0 - value).filter(|&left| left > SETTLED).collect();
    Some((left.iter().map(|left| left.ln()).sum(), left.len()))
}
