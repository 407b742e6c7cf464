//! Derivatives of bounded heads over several coordinates, up to the second.

use super::Limits;
use crate::schema;

/// The jets of a bounded head at a site of a group, by their numbers.
#[derive(Debug, PartialEq)]
pub(crate) struct Across {
    pub(crate) head: usize,
    value: usize,
    /// Derivatives by one coordinate each.
    firsts: Vec<usize>,
    /// Sums of second derivatives, each with its parts.
    seconds: Vec<(usize, Vec<Part>)>,
}

/// A factor, and the two of the first derivatives that a second one is of.
type Part = (f64, usize, usize);

/// How a program's number follows the head at a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slopes {
    /// First to third derivative of the number by the head.
    by_head: [f64; 3],
    /// By how much the head is beyond what the number says.
    pub(crate) rest: f64,
}

impl Across {
    /// Of all bounded heads that a group reads; nothing where some derivatives are of another kind.
    pub(crate) fn all(group: &schema::Group, is_bounded: impl Fn(usize) -> bool) -> Option<Vec<Self>> {
        let order = |at: usize| group.jets[at].degree.iter().map(|&n| usize::from(n)).sum::<usize>();
        let bounded = || (0..group.jets.len()).filter(|&at| is_bounded(group.jets[at].head));
        let is_of = |value: usize, at: usize| {
            let (value, jet) = (&group.jets[value], &group.jets[at]);
            (value.head, value.site) == (jet.head, jet.site)
        };
        let towers: Option<Vec<Self>> = bounded()
            .filter(|&at| order(at) == 0)
            .map(|value| {
                let own = |wanted: usize| bounded().filter(move |&at| is_of(value, at) && order(at) == wanted);
                let axis = |at: usize| match group.jets[at].operator {
                    [(by, 1.0)] => by.iter().position(|&n| n == 1),
                    _ => None,
                };
                let firsts: Vec<usize> = own(1).collect();
                let axes: Vec<usize> = firsts.iter().map(|&at| axis(at)).collect::<Option<_>>()?;
                let part = |(by, factor): &(&[u8], f64)| {
                    let along = by.iter().enumerate().flat_map(|(axis, &n)| std::iter::repeat_n(axis, n.into()));
                    let known: Option<Vec<usize>> =
                        along.map(|axis| axes.iter().position(|&own| own == axis)).collect();
                    known.and_then(|pair| Some((*factor, *pair.first()?, *pair.get(1)?)))
                };
                let second = |at: usize| Some((at, group.jets[at].operator.iter().map(part).collect::<Option<_>>()?));
                let seconds = own(2).map(second).collect::<Option<_>>()?;
                Some(Self { head: group.jets[value].head, value, firsts, seconds })
            })
            .collect();
        towers.filter(|towers| {
            let known = towers.iter().map(|tower| 1 + tower.firsts.len() + tower.seconds.len()).sum::<usize>();
            known == bounded().count()
        })
    }

    /// Replaces a head of some scale and its derivatives by what programs read: `jets` gives the place of a jet.
    pub(crate) fn read(&self, limits: Limits, scale: f64, jets: &mut [f64], at: impl Fn(usize) -> usize) -> Slopes {
        let value = jets[at(self.value)];
        if self.firsts.is_empty() {
            let raw = limits.raw(scale, value);
            jets[at(self.value)] = raw.number;
            return Slopes { by_head: [raw.slope, 0.0, 0.0], rest: raw.rest };
        }
        // Along a line on which the head grows by one.
        let raw = limits.raw_along(scale, &[value, 1.0, 0.0, 0.0]);
        let [number, slope, second, third, _] = raw.numbers;
        jets[at(self.value)] = number;
        for (own, parts) in &self.seconds {
            let square: f64 =
                parts.iter().map(|(factor, a, b)| factor * jets[at(self.firsts[*a])] * jets[at(self.firsts[*b])]).sum();
            jets[at(*own)] = slope * jets[at(*own)] + second * square;
        }
        self.firsts.iter().for_each(|&first| jets[at(first)] *= slope);
        Slopes { by_head: [slope, second, third], rest: raw.rest }
    }

    /// From a row's derivatives by what programs read to those by the head and its derivatives: the adjoint of
    /// [`Across::read`], whose result `numbers` is. Returns the derivative by the head's value.
    pub(crate) fn pull(&self, slopes: &Slopes, numbers: &[f64], bars: &mut [f64], at: impl Fn(usize) -> usize) -> f64 {
        let [slope, second, third] = slopes.by_head;
        let mut by_value = slope * bars[at(self.value)];
        let derivative = |first: usize| numbers[at(self.firsts[first])] / slope;
        let mut by_firsts = vec![0.0; self.firsts.len()];
        for (first, by) in by_firsts.iter_mut().enumerate() {
            let bar = bars[at(self.firsts[first])];
            *by = slope * bar;
            by_value += second * derivative(first) * bar;
        }
        for (own, parts) in &self.seconds {
            let bar = bars[at(*own)];
            let mut square = 0.0;
            for &(factor, a, b) in parts {
                let (of_a, of_b) = (derivative(a), derivative(b));
                square += factor * of_a * of_b;
                by_firsts[a] += second * factor * of_b * bar;
                by_firsts[b] += second * factor * of_a * bar;
            }
            let sum = (numbers[at(*own)] - second * square) / slope;
            by_value += (second * sum + third * square) * bar;
            bars[at(*own)] = slope * bar;
        }
        self.firsts.iter().zip(by_firsts).for_each(|(&first, by)| bars[at(first)] = by);
        bars[at(self.value)] = by_value;
        by_value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A head with two first derivatives and the sum of its second ones: jets 0 to 3.
    fn tower() -> Across {
        Across { head: 0, value: 0, firsts: vec![1, 2], seconds: vec![(3, vec![(1.0, 0, 0), (1.0, 1, 1)])] }
    }

    const LIMITS: [Limits; 3] = [
        Limits { lower: Some(0.0), upper: None },
        Limits { lower: None, upper: Some(2.0) },
        Limits { lower: Some(-1.0), upper: Some(3.0) },
    ];

    fn number(limits: Limits, value: f64) -> f64 {
        limits.raw(0.7, value).number
    }

    /// `y = 0.8 + 0.3 x - 0.5 t + 0.2 x^2 + 0.4 t^2`, whose number is differentiated by differences.
    #[test]
    fn numbers_have_the_derivatives_of_the_head() {
        for limits in LIMITS {
            let y = |x: f64, t: f64| 0.8 + 0.3 * x - 0.5 * t + 0.2 * x * x + 0.4 * t * t;
            let mut jets = [0.8, 0.3, -0.5, 1.2];
            tower().read(limits, 0.7, &mut jets, |jet| jet);
            let (h, n) = (1e-4, |x: f64, t: f64| number(limits, y(x, t)));
            let sum = n(h, 0.0) + n(-h, 0.0) + n(0.0, h) + n(0.0, -h) - 4.0 * n(0.0, 0.0);
            let exact = [
                n(0.0, 0.0),
                (n(h, 0.0) - n(-h, 0.0)) / (2.0 * h),
                (n(0.0, h) - n(0.0, -h)) / (2.0 * h),
                sum / (h * h),
            ];
            for (found, exact) in jets.iter().zip(exact) {
                assert!((found - exact).abs() < 1e-6 * exact.abs().max(1.0), "{limits:?}: {found} {exact}");
            }
        }
    }

    /// Differences of a sum of numbers by the head and its derivatives.
    #[test]
    fn derivatives_by_numbers_are_pulled_back_to_the_head() {
        for limits in LIMITS {
            let (head, weights, h) = ([0.4, 0.3, -0.5, 1.2], [0.3, -1.1, 0.7, 0.2], 1e-6);
            let read = |mut jets: [f64; 4]| (tower().read(limits, 0.7, &mut jets, |jet| jet), jets);
            let sum = |jets: [f64; 4]| read(jets).1.iter().zip(weights).map(|(n, w)| n * w).sum::<f64>();
            let ((slopes, numbers), mut bars) = (read(head), weights);
            let by_value = tower().pull(&slopes, &numbers, &mut bars, |jet| jet);
            assert_eq!(by_value, bars[0]);
            for (k, found) in bars.iter().enumerate() {
                let (mut above, mut below) = (head, head);
                (above[k], below[k]) = (head[k] + h, head[k] - h);
                let exact = (sum(above) - sum(below)) / (2.0 * h);
                assert!((found - exact).abs() < 1e-6 * exact.abs().max(1.0), "{limits:?} {k}: {found} {exact}");
            }
        }
    }
}
