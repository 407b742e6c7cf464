//! Places that do not fit the declared domain: outside of it, in another unit, or with two columns swapped.

use nisp::units::Number;
use nisp_units::conversion;

use super::{Survey, range, short};

/// How far beyond its end a domain still has a row, as a share of its width.
const SLACK: f64 = 0.02;
/// Shares of a domain that places in the right unit fill at least, and places in the wrong one at most.
const FILLS: f64 = 0.2;
const TINY: f64 = 0.02;
/// Widths of the domain that places in the wrong unit go over at least, if they are not next to nothing of it.
const FAR: f64 = 2.5;
/// Units that tables have.
const UNITS: [&str; 17] =
    ["m", "cm", "mm", "um", "km", "inch", "ft", "s", "ms", "us", "min", "h", "d", "year", "rad", "deg", "%"];
/// Factors between units that have no name.
const FACTORS: [f64; 8] = [1e3, 1e-3, 60.0, 1.0 / 60.0, 1e2, 1e-2, 1e6, 1e-6];
/// Rounding of a place at an edge, as a share of the way to the middle.
const ROUNDING: f64 = 1e-6;

/// What is wrong with the places, in words.
pub(super) fn notes(survey: &Survey<'_>) -> Vec<String> {
    let axes = survey.coordinates.len();
    let along = |at: usize| Some(Along { seen: range(survey.axis(at)), declared: survey.declared(at)? });
    let Some(all) = (0..axes).map(along).collect::<Option<Vec<Along>>>() else { return Vec::new() };
    let swapped = (0..axes).flat_map(|one| (one + 1..axes).map(move |other| (one, other))).find(|&(one, other)| {
        let (a, b) = (&all[one], &all[other]);
        let is_off = !a.fits(1.0) || !b.fits(1.0);
        let crossed = [Along { seen: b.seen, ..*a }, Along { seen: a.seen, ..*b }];
        is_off && crossed.iter().all(|along| along.fits(1.0)) && crossed.iter().any(|along| along.share(1.0) > FILLS)
    });
    if let Some((one, other)) = swapped {
        let [one, other] = [one, other].map(|at| survey.coordinates[at].name);
        return vec![format!("`{one}` and `{other}` fit each other's range and not their own: are they swapped?")];
    }
    let units = (0..axes).filter_map(|at| {
        let (along, c) = (&all[at], &survey.coordinates[at]);
        let ([low, high], [from, to]) = (along.seen.map(short), along.declared.map(short));
        let unit = c.unit.text;
        let said = format!("`{}` goes from {low} to {high}, and its domain from {from} to {to} {unit}", c.name);
        let said = said.trim_end();
        Some(match along.other_unit(unit)? {
            Other::Named(other) => {
                format!("{said}: is it in {other}? say so in the header, as in `{} [{other}]`", c.name)
            }
            Other::Factor(factor) => format!("{said}: is it in another unit, {} times too large?", short(1.0 / factor)),
        })
    });
    let units: Vec<String> = units.collect();
    if units.is_empty() { outside(survey).into_iter().collect() } else { units }
}

/// Rows outside of the domain, in words.
fn outside(survey: &Survey<'_>) -> Option<String> {
    let body = survey.domain.as_ref()?;
    let (low, high) = body.bounds();
    let is_outside = |point: &&[f64]| {
        let towards = |(at, x): (usize, &f64)| x + ROUNDING * ((low[at] + high[at]) / 2.0 - x);
        let inward: Vec<f64> = point.iter().enumerate().map(towards).collect();
        !body.contains(point) && !body.contains(&inward)
    };
    let axes = survey.coordinates.len();
    let count = survey.points.chunks_exact(axes).filter(is_outside).count();
    (count > 0).then(|| format!("{count} of {} rows lie outside of the domain", survey.points.len() / axes))
}

/// A range of places and the declared one.
struct Along {
    seen: [f64; 2],
    declared: [f64; 2],
}

/// A unit that a column may be in.
enum Other {
    Named(&'static str),
    Factor(f64),
}

impl Along {
    /// True if the places, so multiplied, lie within the domain.
    fn fits(&self, factor: f64) -> bool {
        let ([a, b], [low, high]) = (self.seen.map(|x| factor * x), self.declared);
        let slack = SLACK * (high - low);
        a >= low - slack && b <= high + slack
    }

    /// The share of the domain's width that the places, so multiplied, go over.
    fn share(&self, factor: f64) -> f64 {
        let ([a, b], [low, high]) = (self.seen, self.declared);
        factor * (b - a) / (high - low)
    }

    /// The unit in which the places would fill the domain, where they lie elsewhere, go far beyond it, or are next to nothing of it.
    fn other_unit(&self, unit: &str) -> Option<Other> {
        let is_tiny = self.share(1.0) < TINY && self.seen[1] > self.seen[0];
        let is_elsewhere = self.seen[0] > self.declared[1] || self.seen[1] < self.declared[0];
        if !is_tiny && !is_elsewhere && self.share(1.0) < FAR {
            return None;
        }
        let suits = |factor: f64| self.fits(factor) && self.share(factor) > FILLS;
        let factor = |other: &str| {
            let conversion = conversion(other, unit)?;
            Some((conversion.of(Number::file(1.0)) - conversion.of(Number::file(0.0))).as_declared())
        };
        let named = UNITS.iter().filter_map(|other| Some((*other, factor(other)?)));
        let named: Vec<(&str, f64)> = if unit.is_empty() { Vec::new() } else { named.collect() };
        if named.is_empty() {
            return FACTORS.into_iter().find(|factor| suits(*factor)).map(Other::Factor);
        }
        let suiting = named.into_iter().filter(|(_, factor)| suits(*factor));
        let most = suiting.max_by(|a, b| self.share(a.1).total_cmp(&self.share(b.1)))?;
        Some(Other::Named(most.0))
    }
}
