//! Columns that are a multiple of what the answer says: one of several sensors is in another unit, or has the other sign.

use super::misfits::Misfits;
use crate::schema::TermKind;

/// Share of a column's square that is a multiple of the answer's, at least.
const ALIKE: f64 = 0.95;
/// Factors up to which a parameter is as likely the cause.
const NEAR: f64 = 1.25;
/// Values that say so, at least.
const FEW: usize = 8;

/// What a column is in terms of the answer, where it is another multiple of it than one; nothing where no other sensor says what it should be.
pub(super) fn factor(left: &Misfits) -> Option<String> {
    let observed = left.bound.problem.scene().schema.groups.iter().flat_map(|group| group.terms);
    let others = observed.filter(|term| term.kind == TermKind::Observation && !std::ptr::eq(*term, left.term));
    let ([misfits], [column], true) = (&left.plain[..], left.term.columns, others.count() > 0) else { return None };
    let measured = left.bound.measured(left.group, left.term, &left.bound.columns[left.group][*column]);
    let factor = multiple(&measured, misfits)?;
    let said = if (-NEAR..-NEAR.recip()).contains(&factor) {
        "has the other sign than what the equations make of the other measurements: one of them is turned".into()
    } else {
        format!(
            "is {factor:.3} times what the equations make of the other measurements: one of them may be in another unit"
        )
    };
    Some(format!("`{}` {said}", left.term.name))
}

/// Which multiple of an answer measured values are, about their means: the answer is by `misfits` larger than they are.
fn multiple(measured: &[f64], misfits: &[f64]) -> Option<f64> {
    let answer: Vec<f64> = measured.iter().zip(misfits).map(|(own, misfit)| own + misfit).collect();
    let about = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|x| x - mean).collect::<Vec<f64>>()
    };
    let (own, answer) = (about(measured), about(&answer));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (both, squares) = (product(&own, &answer), product(&own, &own) * product(&answer, &answer));
    let factor = both / product(&answer, &answer);
    let is_one = (NEAR.recip()..NEAR).contains(&factor);
    (own.len() >= FEW && squares > 0.0 && both * both >= ALIKE * squares && !is_one).then_some(factor)
}

#[cfg(test)]
mod tests {
    use super::multiple;

    #[test]
    fn degrees_are_a_multiple_of_radians() {
        let answer: Vec<f64> = (0..40).map(|at| (0.3 * f64::from(at)).sin()).collect();
        let of = |factor: f64, noise: f64| {
            let measured: Vec<f64> = answer
                .iter()
                .enumerate()
                .map(|(at, y)| factor * (y + noise * (7.0 * (at * at) as f64).sin()) + 3.0)
                .collect();
            let misfits: Vec<f64> = answer.iter().zip(&measured).map(|(y, own)| y - own).collect();
            multiple(&measured, &misfits)
        };
        assert!((of(57.3, 0.05).unwrap() / 57.3 - 1.0).abs() < 0.05);
        assert!((of(-1.0, 0.0).unwrap() + 1.0).abs() < 1e-12);
        // A parameter may be a tenth off, and what is not alike is no multiple.
        assert_eq!(of(1.1, 0.0), None);
        assert_eq!(of(57.3, 2.0), None);
    }
}
