//! B-splines of fifth degree on evenly spaced knots: smooth enough for second derivatives to mean something.

/// Polynomial degree.
pub(super) const DEGREE: usize = 5;
/// How many splines are not zero at a point.
pub(super) const SUPPORT: usize = DEGREE + 1;

/// A spline space on an interval.
#[derive(Clone)]
pub(super) struct Basis {
    knots: Vec<f64>,
    intervals: usize,
}

/// The splines alive at a point: the first one's index, and their values and derivatives.
pub(super) struct Alive {
    pub(super) first: usize,
    /// `derivatives[k][i]`: derivative `k` (0 to 3) of spline `first + i`.
    pub(super) derivatives: [[f64; SUPPORT]; 4],
}

impl Basis {
    /// `intervals` equal pieces from `start` to `end`; the end knots are repeated.
    pub(super) fn new(start: f64, end: f64, intervals: usize) -> Basis {
        let step = (end - start) / intervals as f64;
        let knots = (0..=intervals + 2 * DEGREE)
            .map(|k| start + step * (k.saturating_sub(DEGREE)).min(intervals) as f64)
            .collect();
        Basis { knots, intervals }
    }

    pub(super) fn len(&self) -> usize {
        self.intervals + DEGREE
    }

    /// Middles of `per_interval` equal parts of every interval, for quadrature; and their common weight.
    pub(super) fn nodes(&self, per_interval: usize) -> (Vec<f64>, f64) {
        let (start, end) = (self.knots[DEGREE], self.knots[DEGREE + self.intervals]);
        let count = self.intervals * per_interval;
        let step = (end - start) / count as f64;
        ((0..count).map(|k| start + step * (k as f64 + 0.5)).collect(), step)
    }

    /// Everything about the splines alive at `t`, which is moved into the interval if outside.
    pub(super) fn alive(&self, t: f64) -> Alive {
        let (low, high) = (self.knots[DEGREE], self.knots[DEGREE + self.intervals]);
        let t = t.clamp(low, high);
        let span =
            (self.knots.partition_point(|&knot| knot <= t).max(1) - 1).clamp(DEGREE, DEGREE + self.intervals - 1);
        // Row `k` of the triangle: splines of degree DEGREE - k.
        let mut out = Alive { first: span - DEGREE, derivatives: [[0.0; SUPPORT]; 4] };
        for (order, row) in out.derivatives.iter_mut().enumerate() {
            let mut values = self.values(span, t, DEGREE - order);
            for degree in DEGREE - order + 1..=DEGREE {
                values = self.differentiate(span, degree, &values);
            }
            row.copy_from_slice(&values);
        }
        out
    }

    /// The alive splines of a degree by Cox and de Boor's recursion; entry `i` is spline `span - degree + i`.
    fn values(&self, span: usize, t: f64, degree: usize) -> [f64; SUPPORT] {
        let mut values = [0.0; SUPPORT];
        values[0] = 1.0;
        for current in 1..=degree {
            let mut carried = 0.0;
            for (i, value) in values.iter_mut().enumerate().take(current) {
                let (left, right) = (self.knots[span + 1 + i - current], self.knots[span + 1 + i]);
                let share = *value / (right - left);
                *value = carried + (right - t) * share;
                carried = (t - left) * share;
            }
            values[current] = carried;
        }
        values
    }

    /// From coefficients' duals of degree `degree - 1` to the derivative of splines of degree `degree`.
    fn differentiate(&self, span: usize, degree: usize, lower: &[f64; SUPPORT]) -> [f64; SUPPORT] {
        let slope = |i: usize| {
            // Spline `span - degree + 1 + i` of the lower degree.
            let first = span - degree + 1 + i;
            lower[i] * degree as f64 / (self.knots[first + degree] - self.knots[first])
        };
        let mut out = [0.0; SUPPORT];
        for (i, value) in out.iter_mut().enumerate().take(degree + 1) {
            let rise = if i > 0 { slope(i - 1) } else { 0.0 };
            let fall = if i < degree { slope(i) } else { 0.0 };
            *value = rise - fall;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_sum_to_one_and_derivatives_match_differences() {
        let basis = Basis::new(-1.0, 3.0, 7);
        let curve = |t: f64, order: usize| -> f64 {
            let alive = basis.alive(t);
            (0..SUPPORT).map(|i| ((alive.first + i) as f64 * 1.3).sin() * alive.derivatives[order][i]).sum()
        };
        for k in 0..50 {
            let t = -0.95 + 3.9 * f64::from(k) / 50.0;
            assert!((basis.alive(t).derivatives[0].iter().sum::<f64>() - 1.0).abs() < 1e-13);
            for order in 0..3 {
                let slope = (curve(t + 1e-5, order) - curve(t - 1e-5, order)) / 2e-5;
                assert!((slope - curve(t, order + 1)).abs() < 1e-6 * (1.0 + slope.abs()), "{t} {order}");
            }
        }
        assert_eq!(basis.alive(-1.0).first, 0);
        assert_eq!(basis.alive(3.0).first + SUPPORT, basis.len());
    }
}
