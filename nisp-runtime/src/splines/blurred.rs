//! Equations that know no better than what they take for known.
//!
//! A column of an equation may be a measurement, whose noise the equation takes for a motion. Such an equation is off by what the noise
//! makes of it: by as much may its rows be missed. Differences of the column say how noisy it is; but a drive may be as fast as noise,
//! so that the evidence says whether it is.

use super::iterate::State;
use super::place::Place;
use super::solver::Solver;
use crate::noise::Noise;
use crate::schema::TermKind;

impl Solver<'_> {
    /// By class, whether its rows are those of an equation that holds exactly; one more for what is known beforehand.
    pub(super) fn equations(&self, state: &State) -> Vec<bool> {
        let terms = self.groups.iter().enumerate().flat_map(|(at, group)| {
            group.schema.terms.iter().map(move |term| (term, &self.blurs[at][term.first..term.first + term.rows]))
        });
        let others = state.classes.len() - self.classes.iter().map(Vec::len).sum::<usize>();
        let is_exact = |blurs: &[f64]| !state.blurred || blurs.iter().all(|blur| *blur == 0.0);
        let holds = terms.map(|(term, blurs)| term.kind == TermKind::Residual && is_exact(blurs));
        holds.chain(vec![false; others + 1]).collect()
    }

    /// Where steps start again with equations that know no better than their columns: at the best end of those before. From the
    /// first state a source may take the noise for its own, which the evidence has no reason to leave. Nothing where no column is
    /// noisy.
    pub(super) fn blurred(&mut self, noise: &Noise, place: &Place) -> Option<State> {
        let is_noisy = self.noise_of_columns.iter().flatten().any(|noise| *noise > 0.0);
        (is_noisy && !place.is_blurred).then(|| State {
            blurred: true,
            step: place.state.step,
            ..place.best().map_or_else(|| self.first(noise), |best| best.state.clone())
        })
    }
}
