//! Error bars of an answer, kind of smoothness by kind, and what they say of its sources.

use super::heads::Heads;
use super::kept::{KeptSplines, Spread};
use super::leaning::hedge;
use super::place::Tried;
use super::prior::{Course, KINDS};
use super::solver::Solver;
use super::told::{Along, told};
use crate::facts::Told;
use crate::solve::fault::Fault;
use crate::student;

/// What every kind of smoothness says that the evidence does not rule out.
pub(super) struct Bars {
    spreads: Vec<Spread>,
    /// The answer's sources as rows of the unknowns.
    sources: Vec<Along>,
    /// By kind, the variances along them.
    variances: Vec<Vec<f64>>,
    /// By source, the share that the data leave of the variance of its mean.
    open: Vec<f64>,
    /// By kind and unknown, the variance of what splines on the cells cannot hold.
    unresolved: Vec<Vec<f64>>,
    /// Whether a kind leaves unknowns open.
    pub(super) is_open: bool,
}

impl Bars {
    /// Error bars about an answer, from kinds of smoothness with their shares.
    pub(super) fn of(solver: &mut Solver<'_>, likely: Vec<(f64, Tried)>, theta: &[f64]) -> Result<Self, Fault> {
        let schema = solver.bound.problem.scene().schema;
        let mut rows = Along::sources(&solver.heads, schema, theta);
        let count = rows.len();
        rows.extend(Along::means(&solver.heads, schema));
        let (mut spreads, mut variances, mut unresolved) = (Vec::new(), Vec::new(), Vec::new());
        let (mut open, mut is_open) = (vec![0.0; count], false);
        for (share, Tried { kind, state, .. }) in likely {
            solver.set_smoothness(KINDS[kind], &state);
            let Some((state, mut found, own)) = solver.doubted(state, &rows)? else {
                is_open = true;
                continue;
            };
            if let Some(rows) = found.noisy {
                found.covariance.multiply(student::longer(rows).powi(2));
            }
            unresolved.push(solver.unresolved(&state, &found.covariance));
            found.covariance.forget_shared(state.learned.len());
            if solver.is_beside_sources() {
                let by_prior = solver.by_prior(&state, &found.covariance)?;
                found.covariance.stretch_shared(&by_prior.iter().copied().map(hedge).collect::<Vec<f64>>());
            }
            for ((open, mean), left) in open.iter_mut().zip(&rows[count..]).zip(&own[count..]) {
                *open += share * left / solver.beforehand(mean, &state);
            }
            let covariance = found.covariance.within(solver.heads.band);
            spreads.push(Spread { share, theta: state.theta, learned: state.learned, covariance });
            variances.push(own);
        }
        rows.truncate(count);
        Ok(Self { spreads, sources: rows, variances, open, unresolved, is_open })
    }

    /// What is kept of the answer, and how much is told of its sources along a course.
    pub(super) fn keep(
        self,
        (heads, theta, learned): (Heads, Vec<f64>, Vec<f64>),
        course: Option<Course>,
    ) -> (KeptSplines, Vec<Told>) {
        let mut kept = KeptSplines { heads, theta, learned, spreads: self.spreads };
        // What the cells cannot hold tells no source from none.
        let told = course.map(|course| told(&kept, course, (&self.sources, &self.open), &self.variances));
        kept.spreads.iter_mut().zip(&self.unresolved).for_each(|(spread, own)| spread.covariance.widen(own));
        (kept, told.unwrap_or_default())
    }
}
