//! What an answer leaves of observations: it should be noise, no larger than the data's own, without a pattern.

use super::gathered::{Lie, lie};
use super::misfits::{MISFIT, Misfits, TAIL};
use super::{
    Check, contradicted, filtered, lasting, left_out, outliers, parts, patterns, repeated, root_mean_square, scaled,
    taken,
};
use crate::facts::Answer;
use crate::noise::{Noise, ObservationNoise, in_order, relative};
use crate::problem::Bound;
use crate::schema::TermKind;
use crate::standing::{held, polled};
use crate::units::Number;

/// Misfit over a declared tolerance.
const TOLERANCE: f64 = 1.5;
/// Misfit of data that are exact but for rounding, over their spread.
const EXACT: f64 = 2e-3;
/// Squares of outliers over those of noise.
const OUTLIERS: f64 = 1.0;
/// Share of a column in which its sensor may stand still.
const HELD: f64 = 0.02;
/// Rows that a value of a sensor may stand for.
const POLLED: f64 = 1.5;
/// Misfit over its size by the median beyond which few values make most of it.
const HEAVY: f64 = 2.0;
/// Values up to which noise may be a source that changes faster than they come, where nothing else is measured, and the share of
/// their spread that it may be. All simulated answers with so few values and so much noise had taken a source for it.
const FEW: usize = 100;
const NOISY: f64 = 0.25;
/// Digits that numbers in files may be rounded to, as a share of their spread: nothing smaller is an outlier's measure.
const ROUNDING: f64 = 1e-5;

/// Checks of the observations of a group.
pub(super) fn checks(bound: &Bound, group: usize, (rows, noise): (&[Vec<f64>], &Noise), answer: &Answer) -> Vec<Check> {
    let terms = bound.problem.scene().schema.groups[group].terms.iter().enumerate();
    let observations = terms.filter(|(_, term)| term.kind == TermKind::Observation);
    let of = |(at, _)| {
        let shared = answer.shared(group, at);
        let left = Misfits::of(bound, (group, at), rows, (noise, shared))?;
        let own = of(&left, answer);
        // Rows that are not as they were measured are the likely cause of all else. Values that are there several times look filtered.
        let is_polled = own.iter().any(|check| check.check == "polled" && !check.passed);
        let mut checks = if is_polled { Vec::new() } else { filtered::checks(&left, shared) };
        checks.extend(own);
        checks.extend(lasting::check(&left, shared));
        Some(checks)
    };
    observations.filter_map(of).flatten().collect()
}

/// Checks of one observation.
fn of(left: &Misfits, answer: &Answer) -> Vec<Check> {
    let mut checks: Vec<Check> = misfit(left, answer.finer).into_iter().collect();
    if left.is_record() && !left.is_exact() {
        checks.extend(left.term.columns.iter().map(|&column| stuck(left, column)));
        checks.extend(left.term.columns.iter().filter_map(|&column| often(left, column)));
        checks.extend(left.term.columns.iter().filter_map(|&column| twice(left, column)));
    }
    if !left.is_record() {
        checks.extend(copied(left));
    }
    if let Some(noise) = left.noise.filter(|_| left.is_record() && !left.is_robust) {
        checks.extend((0..left.term.columns.len()).map(|number| lonely(left, number, noise)));
    }
    if left.is_robust {
        checks.push(left_out::share(left));
        checks.extend(left_out::together(left));
    }
    checks.extend(noisy(left));
    checks.extend(contradicted::check(left));
    checks.extend(patterns::checks(left, answer));
    checks
}

/// Whether what is taken for noise may be a source, of few values whose noise is not declared.
fn noisy(left: &Misfits) -> Option<Check> {
    let schema = left.bound.problem.scene().schema;
    let measured = schema.groups.iter().flat_map(|group| group.terms);
    let is_alone = measured.filter(|term| term.kind == TermKind::Observation).count() == 1;
    let has_source = is_alone && schema.heads.iter().any(|head| head.source);
    let is_few = left.count() <= FEW && left.term.within.is_none() && !left.is_robust && !left.is_exact();
    // A single value does not vary.
    let spread = Some(left.spread()).filter(|spread| has_source && is_few && *spread > 0.0)?;
    let share = left.size / spread;
    let said = format!(
        "what is taken for noise of `{}` is {} (rms), {:.0} % of how much its {} values vary: a source that changes faster than they \
         come would look alike; measure more often, or say how exact they are (`observe {} within ...`)",
        left.term.name,
        left.words(left.size),
        100.0 * share,
        left.count(),
        left.term.name
    );
    Some(Check::new("noise", left.name(), (share, NOISY), said))
}

/// The size of what is left, beside a declared tolerance or the data's own noise; nothing where neither is known.
fn misfit(left: &Misfits, finer: &str) -> Option<Check> {
    let (bound, term) = (left.bound, left.term);
    let rms = left.size;
    if let Some(within) = term.within.map(|within| bound.system.size(&term.unit).back(within).as_engine()) {
        let said = format!(
            "`{}` is not resolved: it is missed by {} (rms), where {} is declared: check the equations, the parameters and the tolerance",
            term.name,
            left.words(rms),
            left.words(within)
        );
        return Some(Check::new("misfit", left.name(), (rms / within, TOLERANCE.max(left.by_chance())), said));
    }
    let noise = left.noise?;
    let (scale, limit) = if left.is_exact() {
        (noise.spread, EXACT)
    } else {
        // What equations may leave beside the noise, or what chance and the doubt of the noise make up. Outliers raise the noise that
        // neighbours show.
        let chance = left.by_chance() * left.doubt();
        (noise.deviation, if left.is_robust { MISFIT * left.doubt() } else { MISFIT }.max(chance))
    };
    // Data that do not vary are met exactly or not at all.
    let value = match rms {
        0.0 => 0.0,
        rms => rms / scale,
    };
    // Instruments may be off by a share of what they show, or worse in a part of the record.
    let is_doubted = value > limit && !left.is_robust && !left.is_exact();
    let by_parts = || parts::noise(left).map(|noise| rms / noise);
    let others = [is_doubted.then(|| share(left)), is_doubted.then(by_parts)].into_iter().flatten().flatten();
    let value = others.fold(value, f64::min);
    let said = format!(
        "`{}` is not resolved: it is missed by {} (rms), while the data's noise is {}: {}",
        term.name,
        left.words(rms),
        left.words(noise.deviation),
        if value > limit { cause(left, finer) } else { String::new() }
    );
    Some(Check::new("misfit", left.name(), (value, limit), said))
}

/// The likely cause of a misfit, by where it lies.
fn cause(left: &Misfits, finer: &str) -> String {
    if let Some(noisy) = taken::noisy(left.bound) {
        return noisy;
    }
    if let Some(scaled) = scaled::factor(left) {
        return scaled;
    }
    let all = format!("the equations or a parameter do not fit these data, or the carrier is too coarse ({finer})");
    let middle = left.middle();
    if left.size <= HEAVY * middle {
        return all;
    }
    let largest = |at: usize| left.rows.iter().map(|row| row[at].abs()).fold(0.0, f64::max);
    let misfits: Vec<f64> = (0..left.rows[0].len()).map(largest).collect();
    let point = |at: usize| &left.places[at * left.axes()..][..left.axes()];
    match lie(&left.places, left.axes(), &misfits, TAIL * middle) {
        Lie::Apart => "most of that lies in few values; if these are outliers, --robust leaves them out".into(),
        Lie::Station(at, axes) => format!(
            "most of that lies at {}: check the measurements and the conditions there",
            left.bound.place_along(&axes, point(at))
        ),
        Lie::Together(at) => format!(
            "most of that lies around {}: check the measurements and the conditions there, and what acts there; {all}",
            left.bound.place(point(at))
        ),
    }
}

/// Misfit of values as a share of each, over the noise as a share of each; nothing where that cannot be told.
fn share(left: &Misfits) -> Option<f64> {
    let (noise, columns) = relative(left.bound, left.group, left.at)?;
    let shares =
        left.rows.iter().zip(&columns).flat_map(|(row, column)| row.iter().zip(column).map(|(misfit, y)| misfit / y));
    (left.rows.len() == columns.len() && noise > 0.0).then(|| root_mean_square(shares) / noise)
}

/// Values of a measured column where its sensor stood still.
fn stuck(left: &Misfits, column: usize) -> Check {
    let values = left.bound.measured(left.group, left.term, &left.bound.columns[left.group][column]);
    let values = in_order(&left.places, &values);
    let is_state = left.bound.problem.scene().schema.reads_states(left.group, left.term);
    let held = held(&values, is_state);
    let count: usize = held.iter().map(|run| run.len()).sum();
    let value = held.iter().max_by_key(|run| run.len()).map_or(0.0, |run| values[run.start]);
    let share = count as f64 / values.len().max(1) as f64;
    let said = format!(
        "`{}` stands still in {count} of {} rows, at {:.3e} in the longest run, and varies elsewhere: a sensor at the end of its \
         range, or one that failed, says nothing there; leave these cells empty",
        left.bound.problem.scene().schema.groups[left.group].columns[column].name,
        values.len(),
        left.bound.system.outward(&left.term.unit).of(Number::engine(value)),
    );
    Check::new("held", left.name(), (share, HELD), said)
}

/// How many rows each value of a column stands for; nothing where that cannot be told.
fn often(left: &Misfits, column: usize) -> Option<Check> {
    let values = left.bound.measured(left.group, left.term, &left.bound.columns[left.group][column]);
    let rows = polled(&in_order(&left.places, &values))?;
    let said = format!(
        "each value of `{}` stands in about {rows:.1} rows: a sensor that is read more often than it measures; keep the first row of \
         each value, and leave the other cells empty",
        left.bound.problem.scene().schema.groups[left.group].columns[column].name,
    );
    Some(Check::new("polled", left.name(), (rows, POLLED), said))
}

/// Whether rows of a column are in it twice; nothing where none are.
fn twice(left: &Misfits, column: usize) -> Option<Check> {
    let values =
        in_order(&left.places, &left.bound.measured(left.group, left.term, &left.bound.columns[left.group][column]));
    let places = in_order(&left.places, &left.places);
    let (again, first) = repeated::repeated(&values, left.noise?.deviation)?;
    let [from, to, before] = [again.start, again.end - 1, first].map(|at| left.bound.place(&[places[at]]));
    let said = format!(
        "{} rows of `{}` are there twice, noise and all: those from {from} to {to} repeat those from {before} on; leave out what \
         was written or pasted once more",
        again.len(),
        left.bound.problem.scene().schema.groups[left.group].columns[column].name,
    );
    Some(Check::new("repeated", left.name(), (again.len() as f64, 0.0), said))
}

/// Whether rows over several coordinates are there twice; nothing where they are not.
fn copied(left: &Misfits) -> Option<Check> {
    let measured =
        |&column: &usize| left.bound.measured(left.group, left.term, &left.bound.columns[left.group][column]);
    let columns: Vec<Vec<f64>> = left.term.columns.iter().map(measured).collect();
    let twice = repeated::copies(&left.places, left.axes(), &columns)?;
    let said = format!(
        "{twice} of {} rows of `{}` are there twice, at the same places and with the same digits, which hides their noise; leave out what \
         was written or pasted once more",
        left.rows[0].len(),
        left.term.name
    );
    Some(Check::new("repeated", left.name(), (twice as f64, 0.0), said))
}

/// Values of a measured column that stand alone.
fn lonely(left: &Misfits, number: usize, noise: ObservationNoise) -> Check {
    let column = left.term.columns[number];
    let values = left.bound.measured(left.group, left.term, &left.bound.columns[left.group][column]);
    let noisiness: Vec<f64> = left.bound.noisiness_of((left.group, left.term), left.term.first + number);
    let [places, values, noisiness] = [&left.places, &values, &noisiness].map(|own| in_order(&left.places, own));
    let deviation = noise.deviation.max(ROUNDING * noise.spread);
    let deviations: Vec<f64> = noisiness.into_iter().map(|own| deviation * own).collect();
    let (found, weight) = outliers::weight(&places, &values, &deviations);
    let (stand, them) = if found.len() == 1 { ("value stands", "it") } else { ("values stand", "them") };
    let said = format!(
        "{} {stand} alone in `{}`, more than ten times the noise of {} off the neighbours: the answer follows {them}; remove {them}, or \
         give --robust",
        found.len(),
        left.bound.problem.scene().schema.groups[left.group].columns[column].name,
        left.words(deviation),
    );
    Check::new("outliers", left.name(), (weight, OUTLIERS), said)
}
