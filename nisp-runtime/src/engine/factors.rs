//! How much each term counts by its natural size.

use super::Engine;
use crate::kernel::Precision;
use crate::schema::TermKind;
use crate::solve::fault::Fault;

/// Noise that data count with beside beliefs where they are taken as exact, as a share of their natural size.
const ASSUMED_NOISE: f64 = 1e-3;

/// Mean squares of rows over their natural sizes, times the user's weights: for exact data.
pub(crate) fn by_size<E: Precision>(engine: &mut Engine<E>) {
    let points = engine.groups.iter().map(|group| group.points).max().unwrap_or(1);
    for group in &mut engine.groups {
        if group.schema.is_beliefs() {
            // A row over its spread stands beside rows over their noise, not beside mean squares.
            group.terms.iter_mut().for_each(|term| term.factor = ASSUMED_NOISE / (points as f64).sqrt());
            continue;
        }
        for term in &mut group.terms {
            let count = match (&term.chamfer, term.schema.kind) {
                (Some(chamfer), _) => chamfer.cloud_points(),
                (None, TermKind::Integral) => 1,
                (None, _) => group.points,
            };
            term.factor = (term.schema.weight / count as f64).sqrt();
        }
    }
}

/// The paper's rule: residuals are weighted so that at the start `ratio` times their gradient is no longer than the
/// gradient of the regression terms. First the data are regressed, then the source is solved for (paper, section 3.2).
pub(crate) fn regress_first<E: Precision>(engine: &mut Engine<E>, theta: &[E], ratio: f64) -> Result<(), Fault> {
    let mut regression = 0.0;
    let mut residual = 0.0;
    for is_regression in [true, false] {
        let length = gradient_of(engine, theta, is_regression)?;
        *(if is_regression { &mut regression } else { &mut residual }) = length;
    }
    if regression > 0.0 && residual > 0.0 {
        let weight = (regression / (ratio * residual)).min(1.0);
        each_term(engine, |kind, factor| {
            if !regresses(kind) {
                *factor *= weight.sqrt();
            }
        });
    }
    Ok(())
}

/// Weights the rows of an engine as those of another of the same problem.
pub(crate) fn alike<E: Precision, F: Precision>(engine: &mut Engine<E>, other: &Engine<F>) {
    let terms = engine.groups.iter_mut().flat_map(|group| &mut group.terms);
    for (term, other) in terms.zip(other.groups.iter().flat_map(|group| &group.terms)) {
        (term.size, term.factor) = (other.size, other.factor);
    }
}

fn regresses(kind: TermKind) -> bool {
    matches!(kind, TermKind::Observation | TermKind::Chamfer { .. })
}

fn each_term<E: Precision>(engine: &mut Engine<E>, mut change: impl FnMut(TermKind, &mut f64)) {
    for term in engine.groups.iter_mut().flat_map(|group| &mut group.terms) {
        change(term.schema.kind, &mut term.factor);
    }
}

/// Length of the gradient of the regression terms alone, or of the others.
fn gradient_of<E: Precision>(engine: &mut Engine<E>, theta: &[E], regression: bool) -> Result<f64, Fault> {
    let kept: Vec<f64> = engine.groups.iter().flat_map(|g| &g.terms).map(|t| t.factor).collect();
    each_term(engine, |kind, factor| {
        if regresses(kind) != regression {
            *factor = 0.0;
        }
    });
    let mut gradient = vec![E::ZERO; theta.len()];
    let result = engine.loss_and_gradient(theta, &mut gradient);
    let mut kept = kept.into_iter();
    each_term(engine, |_, factor| *factor = kept.next().unwrap_or(1.0));
    result?;
    Ok(gradient.iter().map(|g| g.to_f64() * g.to_f64()).sum::<f64>().sqrt())
}
