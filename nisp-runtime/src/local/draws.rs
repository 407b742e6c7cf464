//! Draws from the posterior of the coefficients.
//!
//! Where rows `r + J x` of unit variance have the normal matrix `H = J^T J`, a vector `J^T z` of standard normal `z` has
//! covariance `H`, so that `H^-1 J^T z` has covariance `H^-1`: one right-hand side a draw, and no inverse.

use rand::SeedableRng;
use rand::rngs::StdRng;

use super::block::Block;
use super::integrals::Integral;
use crate::network::normal;

/// Draws: a standard deviation is known to within `1 / sqrt(2 * 64)`, 9 %.
const COUNT: usize = 64;

/// Right-hand sides, summed up row by row beside the normal matrix.
pub(super) struct Draws {
    /// `[coefficient][draw]`
    right: Vec<f64>,
    /// `[learned scalar][draw]`
    below: Vec<f64>,
    random: StdRng,
}

/// Deviations of all unknowns, draw by draw; no draws where there was no time for any.
#[derive(Clone, Debug, Default)]
pub(super) struct Deviations {
    /// Right-hand sides of the coefficients.
    pub(super) coefficients: Vec<Vec<f64>>,
    /// Right-hand sides of the parameters of learned scalars.
    pub(super) learned: Vec<Vec<f64>>,
}

/// How an answer moves where given numbers are off together by one standard deviation: its coefficients, and the parameters of its learned
/// scalars.
#[derive(Clone, Debug)]
pub(super) struct Together {
    pub(super) coefficients: Vec<f64>,
    pub(super) learned: Vec<f64>,
}

impl Deviations {
    /// Adds numbers of these deviations to the coefficients and to the parameters of learned scalars, each by itself.
    pub(super) fn widen(&mut self, coefficients: &[f64], learned: &[f64]) {
        let mut random = StdRng::seed_from_u64(1);
        for (draws, deviations) in [(&mut self.coefficients, coefficients), (&mut self.learned, learned)] {
            for draw in draws {
                draw.iter_mut().zip(deviations).for_each(|(x, deviation)| *x += deviation * normal(&mut random));
            }
        }
    }

    /// Adds to every draw what follows numbers that are off by normal ones of their standard deviations.
    pub(super) fn follow(&mut self, all: &[Together]) {
        let mut random = StdRng::seed_from_u64(2);
        for (draw, learned) in self.coefficients.iter_mut().zip(&mut self.learned) {
            for own in all {
                let times = normal(&mut random);
                draw.iter_mut().zip(&own.coefficients).for_each(|(x, moved)| *x += times * moved);
                learned.iter_mut().zip(&own.learned).for_each(|(x, moved)| *x += times * moved);
            }
        }
    }
}

impl Draws {
    /// Draws for so many coefficients and learned scalars; they are the same every time.
    pub(super) fn new(len: usize, learned: usize) -> Self {
        Self { right: vec![0.0; len * COUNT], below: vec![0.0; learned * COUNT], random: StdRng::seed_from_u64(0) }
    }

    fn numbers(&mut self) -> [f64; COUNT] {
        std::array::from_fn(|_| normal(&mut self.random))
    }

    /// Adds a row with these slopes.
    pub(super) fn add(&mut self, slopes: &[(usize, f64)]) {
        let z = self.numbers();
        slopes.iter().for_each(|&(at, slope)| add(&mut self.right, at, slope, &z));
    }

    /// Adds a row of a block.
    pub(super) fn add_row(&mut self, block: &Block, row: usize) {
        let z = self.numbers();
        let width = block.dofs.len();
        for (at, dof) in block.kept() {
            add(&mut self.right, dof as usize, block.slopes[row * width + at], &z);
        }
        let learned = self.below.len() / COUNT;
        for at in 0..learned {
            add(&mut self.below, at, block.by_learned[row * learned + at], &z);
        }
    }

    /// Adds a row of all coefficients.
    pub(super) fn add_dense(&mut self, row: &Integral) {
        let z = self.numbers();
        row.slopes.iter().enumerate().for_each(|(at, slope)| add(&mut self.right, at, slope / row.sigma, &z));
        row.by_learned.iter().enumerate().for_each(|(at, slope)| add(&mut self.below, at, slope / row.sigma, &z));
    }

    /// Adds a row that sees a learned scalar only.
    pub(super) fn add_learned(&mut self, at: usize, slope: f64) {
        let z = self.numbers();
        add(&mut self.below, at, slope, &z);
    }

    /// Right-hand sides of the coefficients, draw by draw.
    pub(super) fn sides(&self) -> Vec<Vec<f64>> {
        (0..COUNT).map(|draw| self.right.iter().skip(draw).step_by(COUNT).copied().collect()).collect()
    }

    /// Right-hand side of the learned scalars.
    pub(super) fn below(&self, draw: usize) -> Vec<f64> {
        self.below.iter().skip(draw).step_by(COUNT).copied().collect()
    }
}

fn add(sums: &mut [f64], at: usize, slope: f64, z: &[f64; COUNT]) {
    if slope != 0.0 {
        sums[at * COUNT..][..COUNT].iter_mut().zip(z).for_each(|(sum, z)| *sum += slope * z);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::normal::Normal;

    /// Two coefficients with precisions 4 and 9, tied to each other by 2: the inverse of [[6, -2], [-2, 11]] is
    /// [[11, 2], [2, 6]] / 62.
    #[test]
    fn draws_spread_as_the_inverse_says() {
        let mut normal = Normal::new(2, 0, &[vec![0, 1]]).unwrap();
        let mut products = [[0.0; 2]; 2];
        let rounds = 40;
        let mut draws = Draws::new(2, 0);
        for _ in 0..rounds {
            normal.clear();
            draws.right.fill(0.0);
            normal.draws = Some(draws);
            normal.add_stiffness(0, 4.0);
            normal.add_stiffness(1, 9.0);
            normal.add_difference([0, 1], 2.0, 0.0);
            draws = normal.draws.take().unwrap();
            for x in normal.factor().unwrap().deviations(&draws).unwrap().coefficients {
                (0..4).for_each(|i| products[i / 2][i % 2] += x[i / 2] * x[i % 2] / f64::from(rounds * COUNT as i32));
            }
        }
        // Variances of 2560 draws are known to within three per cent.
        for (found, exact) in products.as_flattened().iter().zip([11.0, 2.0, 2.0, 6.0].map(|x: f64| x / 62.0)) {
            assert!((found - exact).abs() < 0.1 * 11.0 / 62.0, "{products:?}");
        }
    }

    /// A row that all coefficients share goes by way of the border: precision 1 each and 3 of their sum's square gives the
    /// inverse of [[4, 3], [3, 4]], [[4, -3], [-3, 4]] / 7.
    #[test]
    fn rows_of_all_coefficients_count() {
        let mut normal = Normal::new(2, 0, &[vec![0], vec![1]]).unwrap();
        normal.draws = Some(Draws::new(2, 0));
        normal.add_stiffness(0, 1.0);
        normal.add_stiffness(1, 1.0);
        let slopes = vec![1.0, 1.0];
        normal.add_dense(&Integral { misfit: 0.0, slopes, by_learned: Vec::new(), sigma: 1.0 / 3f64.sqrt() });
        let draws = normal.draws.take().unwrap();
        let spread = normal.factor().unwrap().deviations(&draws).unwrap().coefficients;
        let mean = |of: &dyn Fn(&[f64]) -> f64| spread.iter().map(|x| of(x)).sum::<f64>() / COUNT as f64;
        // The sum has variance 2 / 7, the difference 2; 64 draws know them to within a sixth.
        let (sum, difference) = (mean(&|x| (x[0] + x[1]).powi(2)), mean(&|x| (x[0] - x[1]).powi(2)));
        assert!((sum * 3.5 - 1.0).abs() < 0.5 && (difference / 2.0 - 1.0).abs() < 0.5, "{sum} {difference}");
    }
}
