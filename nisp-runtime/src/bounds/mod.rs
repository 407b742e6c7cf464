//! Heads with bounds, for carriers that are linear in their coefficients: they carry a head's value itself.
//!
//! Programs read a number without bounds, which a network needs: `bound + sign * scale * softplus(number)`, or between two bounds
//! `lower + (upper - lower) * sigmoid(number)`. It has no inverse at a bound itself, where sources that are often zero are.

mod across;
mod along;
mod steps;

pub(crate) use across::{Across, Slopes};
pub(crate) use along::{RawAlong, towers};
pub(crate) use steps::{Bounded, Spring, WALL};

use crate::functions::{sigmoid, softplus};
use crate::problem::{Bound, UnitSystem};
use crate::schema;

/// Values closer to a bound than this share of the scale, or of the width between two, are read as linear.
const CLOSEST: f64 = 1e-6;
/// The bounds of a head, in the engine's units: one or two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits {
    lower: Option<f64>,
    upper: Option<f64>,
}

/// One bound of a head, in the engine's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limit {
    /// +1 for a lower, -1 for an upper bound.
    pub(crate) sign: f64,
    /// The bound itself.
    pub(crate) value: f64,
}

/// What a program reads of a bounded head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Raw {
    /// The number without bounds.
    pub(crate) number: f64,
    /// Its derivative by the head.
    pub(crate) slope: f64,
    /// By how much the head is beyond what the number says.
    pub(crate) rest: f64,
}

/// The bounds of a scene's heads; nothing for heads without.
pub(crate) fn limits(schema: &schema::Scene, system: &UnitSystem) -> Vec<Option<Limits>> {
    let limits = |head: &schema::Head| {
        let inward = |bound| system.size(&head.unit).back(bound).as_engine();
        let limits = Limits { lower: head.lower.map(inward), upper: head.upper.map(inward) };
        head.transformed.then_some(limits)
    };
    schema.heads.iter().map(limits).collect()
}

/// The bounds of all heads one by one, each with its head.
pub(crate) fn each(limits: &[Option<Limits>]) -> impl Iterator<Item = (usize, Limit)> {
    let bounded = limits.iter().enumerate().filter_map(|(head, limits)| Some((head, (*limits)?)));
    bounded.flat_map(|(head, limits)| limits.each().map(move |limit| (head, limit)))
}

/// Offsets and scales of a problem's heads with these bounds.
pub(crate) fn sizes(bound: &Bound, limits: &[Option<Limits>]) -> (Vec<f64>, Vec<f64>) {
    let own = bound.scaling.offset.iter().enumerate().map(|(head, &offset)| (offset, bound.head_scale(head)));
    let sized = |((offset, scale), limits): ((f64, f64), &Option<Limits>)| {
        limits.map_or((offset, scale), |limits| (limits.offset(), limits.scale(scale)))
    };
    own.zip(limits).map(sized).unzip()
}

/// What of bounded heads is asked for that such carriers cannot give; nothing if they can.
pub(crate) fn refused(schema: &schema::Scene) -> Option<&'static str> {
    if schema.heads.iter().any(|head| head.hard) {
        return Some("fields with hard conditions");
    }
    let mut groups = schema.groups.iter().chain([&schema.outputs]);
    groups.any(|group| !are_derived(group, schema)).then_some("such derivatives of bounded fields")
}

/// True if such carriers have all derivatives of bounded heads that a group reads: of orders up to the fourth over one coordinate, and
/// up to the second over several.
pub(crate) fn are_derived(group: &schema::Group, schema: &schema::Scene) -> bool {
    let is_bounded = |head: usize| schema.heads[head].transformed;
    match schema.coordinates {
        [_] => towers(group, is_bounded).is_some(),
        _ => Across::all(group, is_bounded).is_some(),
    }
}

impl Limits {
    /// Where a head that says nothing is: at zero, or at the bound that is nearest to it.
    pub(crate) fn offset(self) -> f64 {
        self.within(0.0)
    }

    /// The size of a head: half of the width between two bounds, or else what equations and data say.
    pub(crate) fn scale(self, found: f64) -> f64 {
        self.lower.zip(self.upper).map_or(found, |(lower, upper)| (upper - lower) / 2.0)
    }

    /// The lower bound first.
    pub(crate) fn each(self) -> impl Iterator<Item = Limit> {
        let limit = |sign| move |value| Limit { sign, value };
        self.lower.map(limit(1.0)).into_iter().chain(self.upper.map(limit(-1.0)))
    }

    /// True if a head can be below a value, and not above.
    pub(crate) fn is_below(self, value: f64) -> bool {
        self.upper == Some(value)
    }

    /// A value within the bounds.
    pub(crate) fn within(self, value: f64) -> f64 {
        self.each().fold(value, |value, limit| if limit.inside(value) < 0.0 { limit.value } else { value })
    }

    /// What a program reads of a head of some scale that has a value.
    pub(crate) fn raw(self, scale: f64, value: f64) -> Raw {
        match (self.lower, self.upper) {
            (Some(lower), Some(upper)) => {
                let (width, share) = (upper - lower, (value - lower) / (upper - lower));
                let inside = share.clamp(CLOSEST, 1.0 - CLOSEST);
                // sigmoid(number) = inside
                let slope = 1.0 / (width * inside * (1.0 - inside));
                Raw { number: (inside / (1.0 - inside)).ln(), slope, rest: (share - inside) * width }
            }
            _ => {
                self.each().next().map_or(Raw { number: value, slope: 1.0, rest: 0.0 }, |limit| limit.raw(scale, value))
            }
        }
    }
}

impl Limit {
    /// How far a value is inside of the bound.
    pub(crate) fn inside(self, value: f64) -> f64 {
        self.sign * (value - self.value)
    }

    /// What a program reads of a head with this bound alone.
    fn raw(self, scale: f64, value: f64) -> Raw {
        let distance = self.inside(value) / scale;
        let inside = distance.max(CLOSEST);
        // softplus(number) = inside
        let number = if inside > 30.0 { inside } else { inside.exp_m1().ln() };
        debug_assert!((softplus(number) - inside).abs() <= 1e-9 * inside.max(1.0));
        Raw { number, slope: self.sign / (scale * sigmoid(number)), rest: (distance - inside) * scale * self.sign }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(lower: Option<f64>, upper: Option<f64>) -> Limits {
        Limits { lower, upper }
    }

    /// What programs make of a number, as `pde!` writes it down.
    fn passed(limits: Limits, scale: f64, number: f64) -> f64 {
        match (limits.lower, limits.upper) {
            (Some(lower), Some(upper)) => lower + (upper - lower) * sigmoid(number),
            (Some(lower), None) => lower + scale * softplus(number),
            (_, upper) => upper.unwrap() - scale * softplus(number),
        }
    }

    #[test]
    fn programs_read_the_value_that_a_head_has() {
        for limits in [limits(Some(-1.0), Some(3.0)), limits(Some(-1.0), None), limits(None, Some(3.0))] {
            for value in [-0.999, 0.0, 0.5, 2.9] {
                let (raw, step) = (limits.raw(0.7, value), 1e-6);
                assert!((passed(limits, 0.7, raw.number) + raw.rest - value).abs() < 1e-12, "{limits:?} {value}");
                let moved = passed(limits, 0.7, raw.number + step * raw.slope);
                assert!((moved - value - step).abs() < 1e-8, "{limits:?} {value}");
            }
        }
    }

    #[test]
    fn what_is_beyond_a_bound_is_left_over() {
        let raw = limits(Some(-1.0), Some(3.0)).raw(0.7, 3.5);
        assert!((raw.rest - 0.5).abs() < 1e-5, "{raw:?}");
        let raw = limits(Some(-1.0), None).raw(0.7, -2.0);
        assert!((raw.rest + 1.0).abs() < 1e-5, "{raw:?}");
    }

    #[test]
    fn heads_say_zero_or_the_nearest_bound_at_first() {
        assert_eq!(limits(Some(-1.0), Some(3.0)).offset(), 0.0);
        assert_eq!(limits(Some(2.0), Some(3.0)).offset(), 2.0);
        assert_eq!(limits(None, Some(-3.0)).offset(), -3.0);
    }
}
