//! B-splines on any breakpoints, with all knots at the ends repeated, or on cells of one width (de Boor, *A Practical Guide to
//! Splines*, chapters IX and X).

/// Largest degree.
pub(super) const HIGHEST_DEGREE: usize = 13;

/// Values or a derivative of the splines that do not vanish on a cell, the leftmost first.
pub(super) type Line = [f64; HIGHEST_DEGREE + 1];

/// Splines of one degree over cells between breakpoints: one more than `cells + degree - 1` functions, of which those from
/// `cell` to `cell + degree` do not vanish on a cell.
#[derive(Clone, Debug)]
pub(super) struct Basis {
    pub(super) degree: usize,
    /// The breakpoints, with as many knots as the degree before the first and after the last.
    knots: Vec<f64>,
}

impl Basis {
    /// Splines of a degree over the cells between increasing breakpoints, two at least.
    pub(super) fn new(degree: usize, breakpoints: &[f64]) -> Self {
        let ends = |at: f64| std::iter::repeat_n(at, degree);
        let (first, last) = (breakpoints[0], breakpoints[breakpoints.len() - 1]);
        Self { degree, knots: ends(first).chain(breakpoints.iter().copied()).chain(ends(last)).collect() }
    }

    /// Splines of a degree over so many cells of one width from zero on, with the knots going on at both ends: every function is
    /// a shift of every other.
    pub(super) fn uniform(degree: usize, cells: usize, width: f64) -> Self {
        let knot = |at: usize| (at as f64 - degree as f64) * width;
        Self { degree, knots: (0..=cells + 2 * degree).map(knot).collect() }
    }

    /// Number of functions.
    pub(super) fn len(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Number of cells.
    pub(super) fn cells(&self) -> usize {
        self.len() - self.degree
    }

    /// The cell of a place; places outside belong to the nearest.
    pub(super) fn cell(&self, at: f64) -> usize {
        self.breakpoints().partition_point(|&knot| knot <= at).clamp(1, self.cells()) - 1
    }

    /// The ends of the cells.
    pub(super) fn breakpoints(&self) -> &[f64] {
        &self.knots[self.degree..self.knots.len() - self.degree]
    }

    /// Where a function is centred: the mean of the knots inside its support (Greville).
    pub(super) fn centre(&self, function: usize) -> f64 {
        let inner = &self.knots[function + 1..][..self.degree.max(1)];
        inner.iter().sum::<f64>() / inner.len() as f64
    }

    /// The mean width of a cell in a function's support.
    pub(super) fn width(&self, function: usize) -> f64 {
        let (first, last) = (function.max(self.degree), (function + self.degree + 1).min(self.len()));
        (self.knots[last] - self.knots[first]) / (last - first).max(1) as f64
    }

    /// The sum of the squares of all functions where one is centred.
    pub(super) fn squares(&self, function: usize) -> f64 {
        let at = self.centre(function);
        self.line(self.cell(at), at, 0).iter().map(|value| value * value).sum()
    }

    /// A derivative of the functions that do not vanish on a cell, at a place in it. Zero above the degree.
    pub(super) fn line(&self, cell: usize, at: f64, order: usize) -> Line {
        let (degree, knots) = (self.degree, &self.knots[cell + 1..]);
        let mut line = [0.0; HIGHEST_DEGREE + 1];
        if order > degree {
            return line;
        }
        // `knots[degree - 1]` and `knots[degree]` are the cell's ends.
        line[0] = 1.0;
        for k in 1..=degree - order {
            for j in (0..=k).rev() {
                let first = degree + j - k;
                let left = if j > 0 { rising(knots, first - 1, k, at) * line[j - 1] } else { 0.0 };
                let own = if j < k { (1.0 - rising(knots, first, k, at)) * line[j] } else { 0.0 };
                line[j] = left + own;
            }
        }
        // The derivative of a spline is the difference of two of a degree less.
        for k in degree - order + 1..=degree {
            for j in (0..=k).rev() {
                let first = degree + j - k;
                let left = if j > 0 { line[j - 1] / width(knots, first - 1, k) } else { 0.0 };
                let own = if j < k { line[j] / width(knots, first, k) } else { 0.0 };
                line[j] = k as f64 * (left - own);
            }
        }
        line
    }

    /// The coefficients of a derivative's splines as sums of those of the function's: for each, the first of the function's
    /// coefficients, what each of `order + 1` of them is multiplied by, and the mean width of a cell in its support.
    pub(super) fn differences(&self, order: usize) -> impl Iterator<Item = (usize, Line, f64)> + '_ {
        let count = self.len() - order;
        (0..count).map(move |first| {
            let mut factors = [0.0; HIGHEST_DEGREE + 1];
            factors[0] = 1.0;
            // Back from the last difference: each is `k (c[i + 1] - c[i]) / (t[i + degree + 1] - t[i + step + 1])`.
            for step in (0..order).rev() {
                let own = factors;
                factors = [0.0; HIGHEST_DEGREE + 1];
                for (at, factor) in own.iter().enumerate().take(order - step) {
                    let i = first + at;
                    let span = self.knots[i + self.degree + 1] - self.knots[i + step + 1];
                    let slope = factor * (self.degree - step) as f64 / span;
                    factors[at] -= slope;
                    factors[at + 1] += slope;
                }
            }
            let low = self.degree - order;
            let width = self.knots[first + self.degree + 1] - self.knots[first + order];
            (first, factors, width / (low + 1) as f64)
        })
    }
}

/// The share of a support of `k` cells from knot `first` on that lies before a place.
fn rising(knots: &[f64], first: usize, k: usize, at: f64) -> f64 {
    (at - knots[first]) / width(knots, first, k)
}

fn width(knots: &[f64], first: usize, k: usize) -> f64 {
    knots[first + k] - knots[first]
}

#[cfg(test)]
mod tests {
    use super::*;

    const BREAKPOINTS: [f64; 6] = [0.0, 0.3, 0.5, 1.1, 1.3, 2.0];

    /// Value or derivative of a sum of splines.
    fn sum(basis: &Basis, coefficients: &[f64], at: f64, order: usize) -> f64 {
        let cell = basis.cell(at);
        let line = basis.line(cell, at, order);
        coefficients[cell..].iter().zip(&line[..=basis.degree]).map(|(c, b)| c * b).sum()
    }

    #[test]
    fn splines_add_up_to_one_and_their_derivatives_to_nothing() {
        for degree in 0..6 {
            let basis = Basis::new(degree, &BREAKPOINTS);
            assert_eq!(basis.len(), 5 + degree);
            for at in [0.0, 0.1, 0.5, 1.25, 2.0] {
                for order in 0..=degree {
                    let sum = sum(&basis, &vec![1.0; basis.len()], at, order);
                    let expected = if order == 0 { 1.0 } else { 0.0 };
                    // Fourth derivatives are of the order of ten thousand.
                    assert!((sum - expected).abs() < 1e-10, "degree {degree}, order {order}: {sum}");
                }
            }
        }
    }

    /// Coefficients at the centres give a straight line back (de Boor, chapter IX, identity of Marsden).
    #[test]
    fn centres_are_those_of_a_straight_line() {
        let basis = Basis::new(4, &BREAKPOINTS);
        let line: Vec<f64> = (0..basis.len()).map(|i| 3.0 - 2.0 * basis.centre(i)).collect();
        assert!((sum(&basis, &line, 0.77, 0) - (3.0 - 2.0 * 0.77)).abs() < 1e-14);
        assert!((sum(&basis, &line, 1.9, 1) + 2.0).abs() < 1e-13);
    }

    #[test]
    fn widths_and_squares_are_those_of_the_support() {
        let basis = Basis::new(2, &BREAKPOINTS);
        // Breakpoints .3, .5, 1.1, 1.3; of the first function one cell alone.
        assert!((basis.width(3) - 1.0 / 3.0).abs() < 1e-14 && (basis.width(0) - 0.3).abs() < 1e-14);
        // A parabola on cells of one width is 3/4 in the middle and 1/8 on either side.
        let even = Basis::new(2, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert!((even.squares(4) - (9.0 / 16.0 + 2.0 / 64.0)).abs() < 1e-14 && (even.squares(0) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn splines_on_cells_of_one_width_are_shifts_of_each_other() {
        let basis = Basis::uniform(3, 6, 0.25);
        assert_eq!((basis.len(), basis.cells(), basis.cell(0.3)), (9, 6, 1));
        // The cubic of the textbooks: 1/6, 2/3, 1/6 at a knot, slopes -1/2, 0, 1/2 over the width.
        for cell in 0..6 {
            let at = cell as f64 * 0.25;
            for (order, exact) in [(0, [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0, 0.0]), (1, [-2.0, 0.0, 2.0, 0.0])] {
                let line = basis.line(cell, at, order);
                assert!(line.iter().zip(exact).all(|(found, exact)| (found - exact).abs() < 1e-14), "{line:?}");
            }
        }
    }

    #[test]
    fn differences_are_the_coefficients_of_derivatives() {
        let basis = Basis::new(5, &BREAKPOINTS);
        let coefficients: Vec<f64> = (0..basis.len()).map(|i| ((i * 7919) % 101) as f64 / 101.0).collect();
        for order in 0..=5 {
            let differences: Vec<_> = basis.differences(order).collect();
            let derived: Vec<f64> = differences
                .iter()
                .map(|(first, factors, _)| {
                    coefficients[*first..].iter().zip(&factors[..=order]).map(|(c, f)| c * f).sum()
                })
                .collect();
            let low = Basis::new(5 - order, &BREAKPOINTS);
            assert_eq!(derived.len(), low.len());
            for at in [0.0, 0.4, 1.2, 1.99] {
                let (found, exact) = (sum(&low, &derived, at, 0), sum(&basis, &coefficients, at, order));
                assert!((found - exact).abs() < 1e-11 * exact.abs().max(1.0), "order {order}: {found} {exact}");
            }
            let whole: f64 = differences.iter().map(|(_, _, width)| width).sum();
            assert!((whole - 2.0).abs() < 1e-13, "order {order}: {whole}");
        }
    }
}
