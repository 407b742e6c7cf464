//! What an answer leaves of observations: it should be noise, no larger than the data's own, without a pattern.

use super::{Check, held, outliers, root_mean_square, slow, smooth, taken};
use crate::noise::{Noise, ObservationNoise, in_order, relative};
use crate::problem::Bound;
use crate::rhythm::rhythm;
use crate::schema::TermKind;

/// Misfit over the noise that differences between neighbouring data show.
const MISFIT: f64 = 1.6;
/// Misfit over a declared tolerance.
const TOLERANCE: f64 = 1.5;
/// Misfit of data that are exact but for rounding, over their spread.
const EXACT: f64 = 2e-3;
/// Excess of slow misfits in standard deviations.
const PATTERN: f64 = 4.0;
/// Excess of smooth misfits over several coordinates in standard deviations.
const SMOOTH: f64 = 5.0;
/// Patterns with less than this share of the misfit's square do not matter.
const SLIGHT: f64 = 0.05;
/// Misfit over the noise below which it has no pattern to speak of.
const BELOW: f64 = 0.5;
/// Amplitude of a rhythm over the noise below which it does not matter.
const FAINT: f64 = 0.1;
/// Values that say something of a correlation, at least.
const FEW: usize = 16;
/// Squares of outliers over those of noise.
const OUTLIERS: f64 = 1.0;
/// Share of a column in which its sensor may stand still.
const HELD: f64 = 0.02;
/// Misfit over its size by the median beyond which few values make most of it.
const HEAVY: f64 = 2.0;
/// Misfits beyond so many of their size by the median are left out by robust losses.
const TAIL: f64 = 3.0;
/// Share of the values that may be outliers.
const LEFT: f64 = 0.25;
/// Mean of a misfit over its size above which it is a constant.
const CONSTANT: f64 = 0.9;
/// Digits that numbers in files may be rounded to, as a share of their spread: nothing smaller is an outlier's measure.
const ROUNDING: f64 = 1e-5;

/// Checks of the observations of a group.
pub(super) fn checks(bound: &Bound, group: usize, (rows, noise): (&[Vec<f64>], &Noise), finer: &str) -> Vec<Check> {
    let schema = &bound.problem.scene().schema.groups[group];
    let mut checks = Vec::new();
    let terms = schema.terms.iter().enumerate();
    for (at, term) in terms.filter(|(_, term)| term.kind == TermKind::Observation) {
        let place = (schema.name, term.name);
        let own: Vec<Vec<f64>> =
            rows[term.first..term.first + term.rows].iter().map(|row| bound.measured(group, term, row)).collect();
        let own = &own[..];
        let places = &bound.measured(group, term, &bound.coordinates[group])[..];
        if places.is_empty() {
            continue;
        }
        let of = noise.of(group, at);
        let robust = bound.losses[group][at].is_robust();
        let rms = if robust { middle(own) } else { root_mean_square(own.iter().flatten().copied()) };
        let exact = of.is_some_and(|of| of.is_exact());
        let outward = bound.system.outward(&term.unit);
        let unit = term.unit.behind();
        if let Some(within) = term.within.map(|within| within / bound.system.size(&term.unit)) {
            let said = format!(
                "`{}` is not resolved: it is missed by {:.2e}{unit} (rms), where {:.2e}{unit} is declared: check the equations, the parameters \
                 and the tolerance",
                term.name,
                rms * outward,
                within * outward
            );
            checks.push(Check::new("misfit", place, (rms / within, TOLERANCE.max(by_chance(own))), said));
        } else if let Some(of) = of {
            let (scale, limit) =
                if exact { (of.spread, EXACT) } else { (of.deviation, MISFIT.max(by_chance(own)) * doubt(own)) };
            let said = format!(
                "`{}` is not resolved: it is missed by {:.2e}{unit} (rms), while the data's noise is {:.2e}{unit}: {}",
                term.name,
                rms * outward,
                of.deviation * outward,
                if rms > HEAVY * middle(own) {
                    "most of that lies in few values; if these are outliers, --robust leaves them out".into()
                } else {
                    taken::noisy(bound).unwrap_or_else(|| {
                        format!(
                            "the equations or a parameter do not fit these data, or the carrier is too coarse ({finer})"
                        )
                    })
                }
            );
            // Data that do not vary are met exactly or not at all.
            let value = if scale > 0.0 {
                rms / scale
            } else if rms > 0.0 {
                f64::INFINITY
            } else {
                0.0
            };
            // Instruments may be off by a share of what they show.
            let shares = (value > limit && !robust && !exact).then(|| share(bound, group, at, own)).flatten();
            let value = shares.map_or(value, |share| value.min(share));
            checks.push(Check::new("misfit", place, (value, limit), said));
        }
        let record = bound.problem.scene().schema.coordinates.len() == 1;
        if record && !exact {
            checks.extend(term.columns.iter().map(|&column| stuck(bound, (group, column), place, outward)));
        }
        if let Some(of) = of.filter(|_| record && !robust) {
            checks.extend(term.columns.iter().map(|&column| lonely(bound, (group, column), of, place, outward)));
        }
        if robust {
            let out = own.iter().flatten().filter(|x| x.abs() > TAIL * rms).count();
            let all = own.iter().map(Vec::len).sum::<usize>();
            let said = format!(
                "{out} of {all} values of `{}` are left out as outliers: so many are none, and the equations, a parameter or the \
                 carrier do not fit them",
                term.name
            );
            checks.push(Check::new("left", place, (out as f64 / all.max(1) as f64, LEFT), said));
        }
        // A misfit far below the noise is what a fit that follows the data leaves, not a part that it leaves out.
        let is_below = of.is_some_and(|of| rms < BELOW * of.deviation);
        if exact || is_below {
            continue;
        }
        // What a robust loss leaves out makes no pattern.
        let own: Vec<Vec<f64>> =
            if robust { own.iter().map(|row| without_tails(row, rms)).collect() } else { own.to_vec() };
        let own = &own[..];
        if !record {
            let axes = bound.problem.scene().schema.coordinates.len();
            for row in own.iter().filter(|row| row.len() >= FEW) {
                let (excess, share) = smooth::excess(places, axes, row);
                let said = format!(
                    "what is left of `{}` is no noise: {:.1} % of its square is smooth, so the equations or a parameter do not fit \
                     these data, or a part of them is smoothed away",
                    term.name,
                    100.0 * share
                );
                checks.push(Check::new("pattern", place, (excess, SMOOTH), said));
            }
            continue;
        }
        for row in own.iter().filter(|row| row.len() >= FEW) {
            let (excess, share) = slow::excess(&in_order(places, row));
            let value = if share > SLIGHT { excess } else { excess.min(PATTERN) };
            let mean = row.iter().sum::<f64>() / row.len() as f64;
            let said = if mean.abs() > CONSTANT * root_mean_square(row.iter().copied()) {
                format!(
                    "`{}` is off by {:.2e}{unit} all along: its sensor has an offset, or the equations do not describe it",
                    term.name,
                    -mean * outward
                )
            } else {
                format!(
                    "what is left of `{}` is no noise: {:.0} % of its square is a slow course, so a part of the data is smoothed \
                     away or not described by the equations",
                    term.name,
                    100.0 * share
                )
            };
            checks.push(Check::new("pattern", place, (value, PATTERN), said));
        }
        if let Some(swing) = of.and_then(|of| rhythm(places, &own[0], of)) {
            let said = format!(
                "what is left of `{}` goes up and down {} over the record by {:.2e}{unit}, which noise does not: the equations \
                 or a parameter do not describe it, or a rhythm was smoothed away ({finer})",
                term.name,
                if swing.periods == 1 { "once".into() } else { format!("{} times", swing.periods) },
                swing.amplitude * outward
            );
            checks.push(Check::new(
                "rhythm",
                place,
                (swing.amplitude / of.map_or(1.0, |of| of.deviation), FAINT),
                said,
            ));
        }
    }
    checks
}

/// Misfit of values as a share of each, over the noise as a share of each; nothing where that cannot be told.
fn share(bound: &Bound, group: usize, term: usize, rows: &[Vec<f64>]) -> Option<f64> {
    let (noise, columns) = relative(bound, group, term)?;
    let shares =
        rows.iter().zip(&columns).flat_map(|(row, column)| row.iter().zip(column).map(|(misfit, y)| misfit / y));
    (rows.len() == columns.len() && noise > 0.0).then(|| root_mean_square(shares) / noise)
}

/// Values of a measured column where its sensor stood still.
fn stuck(bound: &Bound, (group, column): (usize, usize), place: (&'static str, &'static str), outward: f64) -> Check {
    let (_, values) = there(bound, group, column);
    let (count, value) = held::held(&values);
    let share = count as f64 / values.len().max(1) as f64;
    let said = format!(
        "`{}` stands still in {count} of {} rows, at {:.3e} in the longest run, and varies elsewhere: a sensor at the end of its \
         range, or one that failed, says nothing there; leave these cells empty",
        bound.problem.scene().schema.groups[group].columns[column].name,
        values.len(),
        value * outward,
    );
    Check::new("held", place, (share, HELD), said)
}

/// The places and the values of a measured column, in the order of the only coordinate.
fn there(bound: &Bound, group: usize, column: usize) -> (Vec<f64>, Vec<f64>) {
    let (places, values) = (&bound.coordinates[group], &bound.columns[group][column]);
    let rows = || (0..places.len()).filter(|&at| !values[at].is_nan());
    let places: Vec<f64> = rows().map(|at| places[at]).collect();
    let values: Vec<f64> = rows().map(|at| values[at]).collect();
    (in_order(&places, &places), in_order(&places, &values))
}

/// Values of a measured column that stand alone.
fn lonely(
    bound: &Bound,
    (group, column): (usize, usize),
    of: ObservationNoise,
    place: (&'static str, &'static str),
    outward: f64,
) -> Check {
    let (places, values) = there(bound, group, column);
    let deviation = of.deviation.max(ROUNDING * of.spread);
    let (found, weight) = outliers::weight(&places, &values, deviation);
    let (stand, them) = if found.len() == 1 { ("value stands", "it") } else { ("values stand", "them") };
    let said = format!(
        "{} {stand} alone in `{}`, more than ten times the noise of {:.2e} off the neighbours: the answer follows {them}; remove \
         {them}, or give --robust",
        found.len(),
        bound.problem.scene().schema.groups[group].columns[column].name,
        deviation * outward,
    );
    Check::new("outliers", place, (weight, OUTLIERS), said)
}

/// Root mean square of so many normal numbers of deviation one that four deviations of chance allow (Wilson and Hilferty
/// 1931): few misfits may be large by chance.
fn by_chance(rows: &[Vec<f64>]) -> f64 {
    let part = 2.0 / (9.0 * rows.iter().map(Vec::len).sum::<usize>().max(1) as f64);
    (1.0 - part + 4.0 * part.sqrt()).powf(1.5)
}

/// How much larger the noise may be than differences of few data say. Eighth differences of neighbours share most of their
/// values, so that six data make about one of them that is its own; one and a half deviations of chi squared.
fn doubt(rows: &[Vec<f64>]) -> f64 {
    let own = rows.first().map_or(0.0, |row| (row.len() as f64 - 8.0) / 6.0).max(1.0);
    let part = 2.0 / (9.0 * own);
    (1.0 - part - 1.5 * part.sqrt()).max(0.1).powf(-1.5)
}

/// The size of values by their median magnitude, in standard deviations of normal numbers: outliers count for nothing.
fn middle(rows: &[Vec<f64>]) -> f64 {
    let mut magnitudes: Vec<f64> = rows.iter().flatten().map(|x| x.abs()).collect();
    magnitudes.sort_by(f64::total_cmp);
    magnitudes.get(magnitudes.len() / 2).copied().unwrap_or(0.0) * 1.4826
}

/// Values with nothing in place of those that are far off, beside this size of the others.
fn without_tails(row: &[f64], size: f64) -> Vec<f64> {
    row.iter().map(|x| if x.abs() > TAIL * size { 0.0 } else { *x }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chi squared over its degrees of freedom has mean 1 and deviation sqrt(2 / n).
    #[test]
    fn chance_allows_less_to_many() {
        let rows = |count| vec![vec![0.0; count]];
        let exact = |count: f64| (1.0 + 4.0 * (2.0 / count).sqrt()).sqrt();
        assert!((by_chance(&rows(10_000)) - exact(1e4)).abs() < 1e-3);
        assert!(by_chance(&rows(4)) > 2.3 && by_chance(&rows(4)) < 2.8);
    }

    #[test]
    fn outliers_do_not_move_the_median() {
        let mut row: Vec<f64> = (0..101).map(|i| (f64::from(i) - 50.0) / 50.0).collect();
        let clean = middle(&[row.clone()]);
        row[0] = 1e6;
        assert!((middle(&[row]) - clean).abs() < 0.05);
    }
}
