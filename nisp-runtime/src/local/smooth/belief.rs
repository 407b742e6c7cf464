//! Which belief about sources the measurements bear out: that they bend little, or that they change little, as sources with edges do.
//!
//! The evidence of the measurements given the equations decides (MacKay 1992). It is the ratio of two integrals over all unknowns, with the
//! measurements and without them, and each of these is a sum of squares and a determinant.

use super::between::is_filled;
use super::rows::{Asked, Rows, is_any};
use super::solver::Solver;
use super::state::{Phase, State};
use crate::local::block::Block;
use crate::schema::TermKind;
use crate::tolerance::LOOSE;

/// How much larger the logarithm of the evidence that sources bend little must be, for edges to be ruled out. For boxes under noise of some
/// per cent it is up to .7 the larger, for smooth sources by more than one mostly.
const SURE: f64 = 1.0;
/// How many times looser than in the end equations are while evidence is found. In the end they are as strict as a hundredth of the share of
/// noise, so that this is a third of it.
const EASED: f64 = 30.0;
/// What is added to every coefficient's stiffness, as a share of it. Without it rounding decides the determinant where a coefficient is open.
const LIFT: f64 = 1e-12;

/// What the measurements say of sources.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BorneOut {
    /// That they bend little.
    Bends,
    /// That they change little, as sources with edges do, or either, about as much.
    Edges,
    /// The evidence was not found.
    Unknown,
}

impl BorneOut {
    /// By the logarithms of the evidence that sources bend little and that they change little.
    pub(super) fn by(bends: Option<f64>, edges: Option<f64>) -> Self {
        match bends.zip(edges) {
            Some((bends, edges)) if edges < bends - SURE => Self::Bends,
            Some(_) => Self::Edges,
            None => Self::Unknown,
        }
    }
}

impl Solver<'_> {
    /// Logarithm of the evidence of the measurements about a state that has settled. Terms that are equal for all beliefs about sources are
    /// left out. Nothing where scalars are learned: the determinant does not know them.
    pub(super) fn evidence_of_belief(&mut self, state: &State) -> Option<f64> {
        if !self.bound.learned.is_empty() {
            return None;
        }
        let evidence = self.evidence_under(&self.eased(state));
        self.set_sigmas(state);
        evidence
    }

    /// A state whose equations are nearly as loose as the measurements are noisy. Cells do not follow short waves of a source that the measurements
    /// would tell, and strict equations rule these out. Loose ones let fields follow as well as they can. Beside a source of all
    /// coordinates they would be as good as a source themselves.
    pub(super) fn eased(&self, state: &State) -> State {
        let eased = (EASED * state.tolerance).min(LOOSE).max(state.tolerance);
        let tolerance = if is_filled(self.schema()) { eased } else { state.tolerance };
        State { tolerance, ..state.clone() }
    }

    /// The same about a state with its own tolerance.
    fn evidence_under(&mut self, state: &State) -> Option<f64> {
        let slopes = self.set_learned(&state.learned);
        self.size(state);
        self.set_sigmas(state);
        self.find_feet(state);
        let all = self.rows(state, &slopes).ok()?;
        let asked = all.asked.iter().map(|asked| self.without(asked)).filter(|asked| is_any(&asked.counts)).collect();
        let given = Rows { asked, clouds: Vec::new(), learned: slopes };
        let evidence = self.integral(state, &all)? - self.integral(state, &given)? - self.noise_of(state, &all);
        evidence.is_finite().then_some(evidence)
    }

    /// Logarithm of the integral of the probability of rows and beliefs over all coefficients.
    fn integral(&mut self, state: &State, rows: &Rows) -> Option<f64> {
        self.add_all(state, rows);
        let judged = self.judged(Phase::Solve);
        let is_zero = |&head: &usize| self.squares(state, head) <= 0.0;
        if judged.iter().any(is_zero) {
            return None;
        }
        // Every head is taken to be about as large as it was found: a belief says nothing of a source's level or slope, and equations may
        // leave a field open.
        (0..self.schema().heads.len()).for_each(|head| self.hold(state, head));
        self.normal.lift(LIFT);
        let factor = self.normal.factor()?;
        let (step, shared) = self.normal.step(&factor)?;
        let left =
            |block: Block| (0..block.misfits.len()).map(|row| block.after(row, &step, &shared).powi(2)).sum::<f64>();
        let asked = rows.asked.iter().flat_map(|asked| self.batches(rows, asked)).flatten().map(left).sum::<f64>();
        let clouds = rows.clouds.iter().flatten().cloned().map(left).sum::<f64>();
        let believed = judged.iter().flat_map(|&head| self.prior_rows(state, head)).map(left).sum::<f64>();
        Some(-0.5 * (asked + clouds + believed + factor.log_determinant()?))
    }

    /// Sum of the logarithms of the noise of all measurements.
    fn noise_of(&self, state: &State, rows: &Rows) -> f64 {
        let of_group = |asked: &Asked| {
            let terms = self.groups[asked.at].schema.terms.iter().zip(&self.classes[asked.at]);
            let observed = terms.filter(|(term, _)| term.kind == TermKind::Observation);
            let of_term = observed.map(|(term, &class)| {
                let counts = asked.counts[term.first..term.first + term.rows].iter().flatten();
                counts.filter(|counts| **counts).count() as f64 * state.classes[class].size.ln()
            });
            of_term.sum::<f64>()
        };
        let clouds = self.surfaces.iter().zip(&rows.clouds);
        let of_clouds = clouds.map(|(surface, blocks)| blocks.len() as f64 * self.sigma(state, surface).ln());
        rows.asked.iter().map(of_group).sum::<f64>() + of_clouds.sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::BorneOut;

    #[test]
    fn evidence_decides_where_it_is_large() {
        assert_eq!(BorneOut::by(Some(5.0), Some(2.0)), BorneOut::Bends);
        assert_eq!(BorneOut::by(Some(2.0), Some(5.0)), BorneOut::Edges);
        assert_eq!(BorneOut::by(Some(2.5), Some(2.0)), BorneOut::Edges);
        assert_eq!(BorneOut::by(None, Some(2.5)), BorneOut::Unknown);
    }
}
