//! Whether what is left of an observation has a pattern, which noise has not.

use super::misfits::Misfits;
use super::stretches::worst;
use super::{Check, root_mean_square, slow, smooth};
use crate::correlation;
use crate::facts::Answer;
use crate::noise::in_order;
use crate::rhythm::{FAINT, rhythm};
use crate::schema::{Term, TermKind};

/// Excess of slow misfits in standard deviations.
const PATTERN: f64 = 4.0;
/// Excess of smooth misfits over several coordinates in standard deviations. Right answers follow the data so far that of fifty none had
/// more than two.
const SMOOTH: f64 = 3.5;
/// Patterns with less than this share of the misfit's square do not matter.
const SLIGHT: f64 = 0.05;
/// Misfit over the noise below which it has no pattern to speak of.
pub(super) const BELOW: f64 = 0.5;
/// Values that say something of a correlation, at least.
const FEW: usize = 16;
/// Mean of a misfit over its size above which it is a constant.
const CONSTANT: f64 = 0.9;

/// Checks of the order of misfits. Those of exact data are of rounding, and those far below the noise are what a fit that follows
/// the data leaves, not a part that it leaves out.
pub(super) fn checks(left: &Misfits, answer: &Answer) -> Vec<Check> {
    if left.is_exact() || left.noise.is_some_and(|noise| left.size < BELOW * noise.deviation) {
        return Vec::new();
    }
    let rows = left.kept();
    let long = rows.iter().filter(|row| row.len() >= FEW);
    if !left.is_record() {
        return long.map(|row| over(left, row, answer)).collect();
    }
    let mut checks: Vec<Check> = long.clone().map(|row| along(left, row)).collect();
    checks.extend(long.enumerate().filter_map(|(at, row)| stretch(left, at, row)));
    checks.extend(swing(left, &rows[0], answer.finer));
    checks
}

/// Smooth misfits over several coordinates, or neighbouring ones that are alike, beside an answer made from a share of the measurements.
fn over(left: &Misfits, row: &[f64], answer: &Answer) -> Check {
    let (used, finer) = (answer.used, answer.finer);
    let (excess, share) = smooth::excess(&left.places, left.axes(), row, used);
    let (alike, deviations) = correlation::over_coordinates(&left.places, left.axes(), row);
    // An answer made from a share of the measurements is off from one place to the next by what the noise of these leaves.
    if used < 1.0 || alike < SLIGHT || deviations < excess {
        let said = format!(
            "what is left of `{}` is no noise: {:.1} % of its square is smooth, so the equations or a parameter do not fit these data, \
             or a part of them is smoothed away ({finer})",
            left.term.name,
            100.0 * share
        );
        return Check::new("pattern", left.name(), (excess, SMOOTH), said);
    }
    let said = format!(
        "what is left of `{}` is no noise: neighbours correlate by {alike:.2}, so that the equations or a parameter do not fit these data, \
         a source varies along a coordinate that it was not given, or the cells are too coarse for it ({finer})",
        left.term.name
    );
    Check::new("pattern", left.name(), (deviations, SMOOTH), said)
}

/// Slow misfits along a record.
fn along(left: &Misfits, row: &[f64]) -> Check {
    let (excess, share) = slow::excess(&in_order(&left.places, row));
    let value = if share > SLIGHT { excess } else { excess.min(PATTERN) };
    let mean = row.iter().sum::<f64>() / row.len() as f64;
    let said = if mean.abs() > CONSTANT * root_mean_square(row.iter().copied()) {
        let others = of_the_same(left)
            .iter()
            .map(|name| format!(", or that of `{name}`, which measures the same field"))
            .collect::<String>();
        format!(
            "`{}` is off by {} all along: its sensor has an offset{others}, its column is in another unit, or the equations do not \
             describe it",
            left.term.name,
            left.words(-mean)
        )
    } else {
        format!(
            "what is left of `{}` is no noise: {:.0} % of its square is a slow course, so a part of the data is smoothed away or not \
             described by the equations",
            left.term.name,
            100.0 * share
        )
    };
    Check::new("pattern", left.name(), (value, PATTERN), said)
}

/// Other observations of the same field's value: which of their sensors is off the answer does not tell.
fn of_the_same(left: &Misfits) -> Vec<&'static str> {
    let groups = left.bound.problem.scene().schema.groups;
    let field = |group: usize, term: &Term| match *term.jets {
        [jet] if groups[group].jets[jet].is_value() => Some(groups[group].jets[jet].head),
        _ => None,
    };
    let own = field(left.group, left.term);
    let all = groups.iter().enumerate().flat_map(|(group, schema)| schema.terms.iter().map(move |term| (group, term)));
    let others = all.filter(|(_, term)| term.kind == TermKind::Observation && !std::ptr::eq(*term, left.term));
    others.filter(|(group, term)| own.is_some() && field(*group, term) == own).map(|(_, term)| term.name).collect()
}

/// A stretch of a record that is missed, however well the rest is met.
fn stretch(left: &Misfits, at: usize, row: &[f64]) -> Option<Check> {
    let noise = (left.noise?.deviation * left.doubt()).max(left.middle());
    let column = *left.term.columns.get(at)?;
    let values = left.bound.measured(left.group, left.term, &left.bound.columns[left.group][column]);
    let places = in_order(&left.places, &left.places);
    let ordered = in_order(&left.places, row);
    let found = worst(&ordered, &in_order(&left.places, &values), noise)?;
    let place = |row: usize| left.bound.place(&places[row..][..1]);
    let said = format!(
        "`{}` is missed by {} (rms) from {} to {}: what acts there, or how the record starts or ends, is not described by \
         the equations, or is smoothed away",
        left.term.name,
        left.words(root_mean_square(ordered[found.rows.0..found.rows.1].iter().copied())),
        place(found.rows.0),
        place(found.rows.1 - 1),
    );
    Some(Check::new("stretch", left.name(), (found.size, found.limit), said))
}

/// A rhythm along a record.
fn swing(left: &Misfits, row: &[f64], finer: &str) -> Option<Check> {
    let noise = left.noise?;
    let swing = rhythm(&left.places, row, noise)?;
    let said = format!(
        "what is left of `{}` goes up and down {} over the record by {}, which noise does not: the equations or a parameter do not \
         describe it, or a rhythm was smoothed away ({finer})",
        left.term.name,
        if swing.periods == 1 { "once".into() } else { format!("{} times", swing.periods) },
        left.words(swing.amplitude)
    );
    Some(Check::new("rhythm", left.name(), (swing.amplitude / noise.deviation, FAINT), said))
}
