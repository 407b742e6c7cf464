//! Derivatives of bounded heads along one coordinate, by Taylor series.

use super::{CLOSEST, Limits, Raw};
use crate::schema;

/// Most that is read of a head: its value, and derivatives up to the order before this.
const MOST: usize = 5;

/// What a program reads of a bounded head and of its derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RawAlong {
    /// The number without bounds and its derivatives.
    pub(crate) numbers: [f64; MOST],
    /// Taylor coefficients of the number's derivative by the head.
    slopes: [f64; MOST],
    /// By how much the head is beyond what the number says.
    pub(crate) rest: f64,
}

impl Limits {
    /// What a program reads of a head of some scale that has a value and derivatives, in their order.
    pub(crate) fn raw_along(self, scale: f64, derivatives: &[f64]) -> RawAlong {
        let count = derivatives.len();
        let Raw { number, slope, rest } = self.raw(scale, derivatives[0]);
        let mut raw = RawAlong { numbers: [number, 0.0, 0.0, 0.0, 0.0], slopes: [slope, 0.0, 0.0, 0.0, 0.0], rest };
        if count == 1 {
            return raw;
        }
        // The head from its bound inwards, and how that grows with the head.
        let (first, grows) = match (self.lower, self.upper) {
            (Some(lower), Some(upper)) => {
                (((derivatives[0] - lower) / (upper - lower)).min(1.0 - CLOSEST), 1.0 / (upper - lower))
            }
            _ => self
                .each()
                .next()
                .map_or((1.0, 1.0), |limit| (limit.inside(derivatives[0]) / scale, limit.sign / scale)),
        };
        let mut head = [0.0; MOST];
        head.iter_mut()
            .zip(derivatives)
            .zip(FACTORIALS)
            .for_each(|((own, value), factorial)| *own = grows * value / factorial);
        head[0] = first.max(CLOSEST);
        // The derivative of the number by the head is one over this: `u - u^2` of a sigmoid's, `1 - exp(-u)` of softplus.
        let below = match (self.lower, self.upper) {
            (Some(_), Some(_)) => {
                let square = |k: usize| (0..=k).map(|j| head[j] * head[k - j]).sum::<f64>();
                std::array::from_fn(|k| head[k] - square(k))
            }
            _ => {
                let mut decay = [0.0; MOST];
                decay[0] = (-head[0]).exp();
                for k in 1..count {
                    decay[k] = -(1..=k).map(|j| j as f64 * head[j] * decay[k - j]).sum::<f64>() / k as f64;
                }
                let mut below = decay.map(|decay| -decay);
                below[0] = -(-head[0]).exp_m1();
                below
            }
        };
        let mut slopes = [0.0; MOST];
        slopes[0] = 1.0 / below[0];
        for k in 1..count {
            slopes[k] = -(1..=k).map(|j| below[j] * slopes[k - j]).sum::<f64>() / below[0];
        }
        for k in 1..count {
            let sum = (1..=k).map(|j| j as f64 * head[j] * slopes[k - j]).sum::<f64>();
            raw.numbers[k] = sum / k as f64 * FACTORIALS[k];
            raw.slopes[k] = slopes[k] * grows;
        }
        raw
    }
}

const FACTORIALS: [f64; MOST] = [1.0, 1.0, 2.0, 6.0, 24.0];

impl RawAlong {
    /// From a row's derivatives by the numbers to those by the head and its derivatives: the adjoint of what changes the numbers.
    pub(crate) fn pull(&self, bars: &[f64]) -> [f64; MOST] {
        let by = |j: usize| (j..bars.len()).map(|k| bars[k] * FACTORIALS[k] / FACTORIALS[j] * self.slopes[k - j]).sum();
        std::array::from_fn(by)
    }
}

/// Jets of bounded heads, each a value first and then its derivatives in their order; nothing where some are of another kind.
pub(crate) fn towers(group: &schema::Group, is_bounded: impl Fn(usize) -> bool) -> Option<Vec<Vec<usize>>> {
    let mut towers: Vec<Vec<usize>> = Vec::new();
    let mut own: Vec<usize> = (0..group.jets.len()).filter(|&at| is_bounded(group.jets[at].head)).collect();
    let order = |at: usize| group.jets[at].degree.iter().map(|&n| usize::from(n)).sum::<usize>();
    own.sort_by_key(|&at| (group.jets[at].head, group.jets[at].site, order(at)));
    for at in own {
        if order(at) == 0 {
            towers.push(Vec::new());
        }
        let tower = towers.last_mut().filter(|tower| tower.len() == order(at) && tower.len() < MOST)?;
        let is_next = tower.first().is_none_or(|&first| {
            (group.jets[first].head, group.jets[first].site) == (group.jets[at].head, group.jets[at].site)
        });
        let is_plain = matches!(group.jets[at].operator, [(_, factor)] if *factor == 1.0);
        if !(is_next && is_plain) {
            return None;
        }
        tower.push(at);
    }
    Some(towers)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A head that runs as `y = 1 + t + t^2 / 2 - t^3 / 3`, whose number is differentiated by differences of closed forms.
    #[test]
    fn numbers_have_the_derivatives_of_the_head() {
        let y = |t: f64| 1.0 + t + t * t / 2.0 - t * t * t / 3.0;
        let one = |t: f64| (y(t) / 0.7).exp_m1().ln();
        let two = |t: f64| ((y(t) + 1.0) / (4.0 - (y(t) + 1.0))).ln();
        let upper = |t: f64| ((2.5 - y(t)) / 0.7).exp_m1().ln();
        let cases: [(Limits, &dyn Fn(f64) -> f64); 3] = [
            (Limits { lower: Some(0.0), upper: None }, &one),
            (Limits { lower: Some(-1.0), upper: Some(3.0) }, &two),
            (Limits { lower: None, upper: Some(2.5) }, &upper),
        ];
        for (limits, number) in cases {
            let raw = limits.raw_along(0.7, &[1.0, 1.0, 1.0, -2.0]);
            let h = 1e-2;
            let at = |k: i32| number(f64::from(k) * h);
            let exact = [
                at(0),
                (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * h),
                (16.0 * (at(1) + at(-1)) - (at(2) + at(-2)) - 30.0 * at(0)) / (12.0 * h * h),
                (-13.0 * (at(1) - at(-1)) + 8.0 * (at(2) - at(-2)) - (at(3) - at(-3))) / (8.0 * h * h * h),
            ];
            for (found, exact) in raw.numbers.iter().zip(exact) {
                assert!((found - exact).abs() < 3e-5 * exact.abs().max(1.0), "{limits:?}: {found} {exact}");
            }
        }
    }

    /// Differences of numbers by what the head and its derivatives are.
    #[test]
    fn derivatives_by_numbers_are_pulled_back_to_the_head() {
        for limits in [Limits { lower: Some(0.0), upper: None }, Limits { lower: Some(-1.0), upper: Some(3.0) }] {
            let (head, bars, h) = ([0.4, -0.8, 1.3, 0.6], [0.3, -1.1, 0.7, 0.2], 1e-6);
            let sum =
                |head: [f64; 4]| limits.raw_along(0.7, &head).numbers.iter().zip(bars).map(|(n, b)| n * b).sum::<f64>();
            let pulled = limits.raw_along(0.7, &head).pull(&bars);
            for k in 0..4 {
                let (mut above, mut below) = (head, head);
                (above[k], below[k]) = (head[k] + h, head[k] - h);
                let exact = (sum(above) - sum(below)) / (2.0 * h);
                assert!(
                    (pulled[k] - exact).abs() < 1e-6 * exact.abs().max(1.0),
                    "{limits:?} {k}: {} {exact}",
                    pulled[k]
                );
            }
        }
    }
}
