//! Heads with one bound, for carriers that are linear in their coefficients: they carry how far a head is from its bound.
//!
//! Programs read a number without bounds, `bound + sign * scale * softplus(number)`, which a network needs. It has no inverse at the
//! bound itself, where sources that are often zero are.

use crate::functions::{sigmoid, softplus};
use crate::problem::UnitSystem;
use crate::schema;

/// Values closer to the bound than this share of the scale are read as linear.
const CLOSEST: f64 = 1e-6;
/// How stiff a value is held at its head's bound, how far beyond it a value may be, both over the head's scale, and how many sets of
/// held ones are tried in a step.
pub(crate) const WALL: f64 = 1e4;
const BEYOND: f64 = 1e-6;
const MOST_SETS: u32 = 60;
/// How often all numbers on the wrong side are turned though they do not get fewer.
const PATIENCE: u32 = 3;

/// A bound in the engine's units.
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

/// The bounds of a scene's heads; nothing for heads without, or between two.
pub(crate) fn limits(schema: &schema::Scene, system: &UnitSystem) -> Vec<Option<Limit>> {
    let limit = |head: &schema::Head| {
        let size = system.size(&head.unit);
        match (head.lower, head.upper) {
            (Some(lower), None) => Some(Limit { sign: 1.0, value: lower / size }),
            (None, Some(upper)) => Some(Limit { sign: -1.0, value: upper / size }),
            _ => None,
        }
    };
    schema.heads.iter().map(limit).collect()
}

/// What of bounded heads is asked for that such carriers cannot give; nothing if they can.
pub(crate) fn refused(schema: &schema::Scene) -> Option<&'static str> {
    let one_sided = |head: &schema::Head| head.lower.is_some() != head.upper.is_some();
    let derived = |jet: &schema::Jet| schema.heads[jet.head].transformed && jet.degree.iter().any(|&n| n > 0);
    if schema.heads.iter().any(|head| head.hard || (head.transformed && !one_sided(head))) {
        return Some("heads between two bounds or with hard conditions");
    }
    schema.groups.iter().flat_map(|group| group.jets).any(derived).then_some("derivatives of bounded heads")
}

/// A step after which none of so many numbers is beyond its bound, found by block principal pivoting (Judice and Pires 1994).
/// `inside` says how far a number is inside of its bound after a step; `hold` returns the step with these numbers held at it by
/// stiff springs, or nothing if there is none. `step` holds none of them; where it is not enough, those in `held` are held first.
pub(crate) fn within<S>(
    count: usize,
    step: S,
    held: Vec<usize>,
    inside: impl Fn(&S, usize) -> f64,
    mut hold: impl FnMut(&[usize]) -> Option<S>,
) -> S {
    if (0..count).all(|at| inside(&step, at) >= -BEYOND) {
        return step;
    }
    let mut is_held = vec![false; count];
    held.iter().for_each(|&at| is_held[at] = true);
    let (mut found, mut fewest, mut patience) = (hold(&held), usize::MAX, PATIENCE);
    for _ in 0..MOST_SETS {
        let Some(last) = &found else { return step };
        // A spring that keeps a number from going further in is in the way.
        let is_wrong = |&at: &usize| if is_held[at] { inside(last, at) > 0.0 } else { inside(last, at) < -BEYOND };
        let wrong: Vec<usize> = (0..count).filter(is_wrong).collect();
        let Some(&one) = wrong.last() else { break };
        if wrong.len() < fewest {
            (fewest, patience) = (wrong.len(), PATIENCE);
        } else {
            patience = patience.saturating_sub(1);
        }
        // Turning all of them may go round in circles; the last alone does not.
        let turned = if patience > 0 { wrong } else { vec![one] };
        turned.into_iter().for_each(|at| is_held[at] = !is_held[at]);
        let held: Vec<usize> = (0..count).filter(|&at| is_held[at]).collect();
        found = hold(&held);
    }
    found.unwrap_or(step)
}

impl Limit {
    /// A head's value within the bound, `away` from it.
    pub(crate) fn within(self, away: f64) -> f64 {
        self.value + self.sign * (self.sign * away).max(0.0)
    }

    /// What a program reads of a head of some scale that is `away` from its bound.
    pub(crate) fn raw(self, scale: f64, away: f64) -> Raw {
        let distance = self.sign * away / scale;
        let inside = distance.max(CLOSEST);
        // softplus(number) = inside
        let number = if inside > 30.0 { inside } else { inside.exp_m1().ln() };
        debug_assert!((softplus(number) - inside).abs() <= 1e-9 * inside.max(1.0));
        Raw { number, slope: self.sign / (scale * sigmoid(number)), rest: (distance - inside) * scale * self.sign }
    }
}
