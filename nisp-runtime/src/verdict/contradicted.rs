//! Few values that are all missed alike. How noisy they are is told by the misfit itself, so that an answer may leave them aside as a whole:
//! a table of six values that contradicts all others is then no more than noise.

use super::misfits::Misfits;
use super::{Check, root_mean_square};
use crate::schema::TermKind;

/// Values that say so, at least; and the most, since longer columns have patterns.
const FEWEST: usize = 4;
const FEW: usize = 16;
/// Logarithm of the chance that what is left of noise is so much a multiple of the answer and a constant.
const CHANCE: f64 = 10.0;
/// Misfits below this share of how much the values vary do not matter.
const SLIGHT: f64 = 0.1;

/// Whether few values are missed alike; nothing where their noise is declared, or where nothing else is measured.
pub(super) fn check(left: &Misfits) -> Option<Check> {
    let observed = left.bound.problem.scene().schema.groups.iter().flat_map(|group| group.terms);
    let others = observed.filter(|term| term.kind != TermKind::Residual && !std::ptr::eq(*term, left.term)).count();
    let ([misfits], [column]) = (&left.plain[..], left.term.columns) else { return None };
    if others == 0 || left.term.within.is_some() || !(FEWEST..FEW).contains(&misfits.len()) {
        return None;
    }
    let measured = left.bound.measured(left.group, left.term, &left.bound.columns[left.group][*column]);
    let spread = crate::noise::deviation(&measured);
    let slight = root_mean_square(misfits.iter().copied()) <= SLIGHT * spread;
    let value = alike(&measured, misfits)?;
    let said = format!(
        "all {} values of `{}` are missed alike, by {} (rms), and that is taken for their noise: they contradict the other measurements, \
         or the equations; check their unit, the parameters and the conditions, or say how exact they are (`observe {} within ...`)",
        misfits.len(),
        left.term.name,
        left.words(left.size),
        left.term.name
    );
    Some(Check::new("contradicted", left.name(), (if slight { value.min(CHANCE) } else { value }, CHANCE), said))
}

/// How unlikely it is that noise is so much a multiple of the answer and a constant, as the logarithm of its chance: an F-test with two
/// and all but two degrees of freedom. The answer is by `misfits` larger than what is measured.
fn alike(measured: &[f64], misfits: &[f64]) -> Option<f64> {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let answer: Vec<f64> = measured.iter().zip(misfits).map(|(own, misfit)| own + misfit).collect();
    let (centre, constant) = (mean(&answer), mean(misfits));
    let square: f64 = answer.iter().map(|x| (x - centre).powi(2)).sum();
    let product: f64 = answer.iter().zip(misfits).map(|(x, misfit)| (x - centre) * misfit).sum();
    let factor = if square > 0.0 { product / square } else { 0.0 };
    let rest = answer.iter().zip(misfits).map(|(x, misfit)| misfit - constant - factor * (x - centre));
    let (rest, all) = (root_mean_square(rest), root_mean_square(misfits.iter().copied()));
    (all > 0.0).then(|| (misfits.len() - 2) as f64 * (all / rest.max(1e-12 * all)).ln())
}

#[cfg(test)]
mod tests {
    use super::{CHANCE, alike};

    #[test]
    fn values_that_are_half_of_the_answer_are_missed_alike() {
        let noise = [0.3, -1.1, 0.6, 0.2, -0.4, 0.9];
        let answer = [3.0, 5.0, 4.0, 7.0, 6.0, 2.0];
        let by = |measured: &dyn Fn(usize) -> f64| {
            let measured: Vec<f64> = (0..answer.len()).map(measured).collect();
            let misfits: Vec<f64> = answer.iter().zip(&measured).map(|(answer, own)| answer - own).collect();
            alike(&measured, &misfits).unwrap()
        };
        assert!(by(&|at| 0.5 * answer[at] + 0.05 * noise[at]) > CHANCE);
        assert!(by(&|at| answer[at] + 3.0 + 0.1 * noise[at]) > CHANCE);
        assert!(by(&|at| answer[at] + noise[at]) < 3.0);
    }
}
