//! Points over all cells of a lattice for means of what varies in a cell: those of Gauss, where it jumps points at random.

use rand::RngExt;
use rand::rngs::StdRng;

use crate::local::lattice::Lattice;

/// Points of a cell with a jump, about: means are as good as these say where the jump is.
const NEAR: f64 = 216.0;
/// Points along a side of the other cells, and their shares: what is left there is smooth.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Points of all cells, flat.
pub(super) struct Quadrature {
    pub(super) points: Vec<f64>,
    /// What each point stands for, in cells.
    pub(super) weights: Vec<f64>,
    /// Whether it is the middle of a cell without a jump and where conditions agree.
    pub(super) is_middle: Vec<bool>,
}

impl Quadrature {
    /// The points of Gauss, or in cells with one of the `jumps` one at random in each of many equal parts. In cells with one of the
    /// `clashes`, where conditions contradict each other, there are as many, in the middle of such parts: the derivatives are largest there,
    /// and an equation is as large as they are at its points.
    pub(super) fn new(lattice: &Lattice, [jumps, clashes]: [&[f64]; 2], random: &mut StdRng) -> Self {
        let inputs = lattice.cells.len();
        let cells: usize = lattice.cells.iter().product();
        let cells_with = |points: &[f64]| {
            let mut is_near = vec![false; cells];
            points.chunks_exact(inputs).for_each(|point| is_near[number(lattice, point)] = true);
            is_near
        };
        let (is_near, is_clash) = (cells_with(jumps), cells_with(clashes));
        let (low, spacing, _) = lattice.parts();
        let (mut points, mut weights, mut is_middle) = (Vec::new(), Vec::new(), Vec::new());
        let parts = NEAR.powf((inputs as f64).recip()).round() as usize;
        for (cell, (&is_near, &is_clash)) in is_near.iter().zip(&is_clash).enumerate() {
            let is_dense = is_near || is_clash;
            let along = if is_dense { parts } else { GAUSS.len() };
            for part in 0..along.pow(inputs as u32) {
                is_middle.push(!is_dense && 2 * part + 1 == along.pow(inputs as u32));
                let (mut cell, mut part, mut weight) = (cell, part, 1.0);
                for axis in 0..inputs {
                    let at = part % along;
                    let mut beside = || if is_near { random.random::<f64>() } else { 0.5 };
                    let (within, share) = match is_dense {
                        true => ((at as f64 + beside()) / along as f64, (along as f64).recip()),
                        false => GAUSS[at],
                    };
                    points.push(low[axis] + spacing[axis] * ((cell % lattice.cells[axis]) as f64 + within));
                    (cell, part, weight) = (cell / lattice.cells[axis], part / along, weight * share);
                }
                weights.push(weight);
            }
        }
        Self { points, weights, is_middle }
    }
}

/// Number of the cell that a point lies in.
fn number(lattice: &Lattice, point: &[f64]) -> usize {
    let cell = lattice.place(point).cell;
    lattice.cells.iter().zip(cell).rev().fold(0, |number, (n, at)| number * n + at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    /// Four by three cells over the box from (-1, 2) to (3, 3.5).
    fn quadrature(jumps: &[f64], clashes: &[f64]) -> Quadrature {
        let lattice = Lattice::new(1, vec![-1.0, 2.0], vec![1.0, 0.5], vec![4, 3]);
        Quadrature::new(&lattice, [jumps, clashes], &mut StdRng::seed_from_u64(5))
    }

    impl Quadrature {
        fn integral(&self, of: impl Fn(f64, f64) -> f64) -> f64 {
            let points = self.points.as_chunks::<2>().0.iter().zip(&self.weights);
            points.map(|(&[x, y], weight)| 0.5 * weight * of(x, y)).sum()
        }
    }

    /// Gauss's points along a side are exact for the fifth power.
    #[test]
    fn points_of_gauss_integrate_powers() {
        let own = quadrature(&[], &[]);
        assert_eq!(own.weights.len(), 12 * 9);
        let power = |n: i32, low: f64, high: f64| (high.powi(n + 1) - low.powi(n + 1)) / f64::from(n + 1);
        for (n, m) in [(0, 0), (1, 0), (5, 0), (2, 3), (5, 5)] {
            let exact = power(n, -1.0, 3.0) * power(m, 2.0, 3.5);
            let found = own.integral(|x, y| x.powi(n) * y.powi(m));
            assert!((found - exact).abs() < 1e-12 * exact.abs(), "{n} {m}: {found} {exact}");
        }
        let middles: Vec<[f64; 2]> =
            own.points.as_chunks::<2>().0.iter().zip(&own.is_middle).filter(|(_, is)| **is).map(|(p, _)| *p).collect();
        assert_eq!(middles.len(), 12);
        assert!(
            middles
                .iter()
                .all(|[x, y]| (x - x.floor() - 0.5).abs() < 1e-12 && (2.0 * y - (2.0 * y).floor() - 0.5).abs() < 1e-12)
        );
    }

    /// A cell that a wall cuts in two at a third of its side: its mean is as good as many points in even parts make it, and the other cells keep
    /// theirs.
    #[test]
    fn cells_with_a_jump_have_many_points() {
        let wall = 0.0 + 1.0 / 3.0;
        let own = quadrature(&[wall, 2.1, wall, 2.6, wall, 3.2], &[]);
        assert_eq!(own.is_middle.iter().filter(|is| **is).count(), 9);
        assert_eq!(own.weights.len(), 9 * 9 + 3 * 15 * 15);
        assert!((own.integral(|_, _| 1.0) - 6.0).abs() < 1e-12);
        let found = own.integral(|x, _| f64::from(u8::from(x < wall)));
        // Of three cells each, fifteen rows of points are cut at random within one of fifteen parts.
        assert!((found - 1.5 * (1.0 + wall)).abs() < 3.0 * 0.5 / 15.0 / 45f64.sqrt(), "{found}");
    }

    #[test]
    fn cells_with_a_clash_have_as_many_in_even_rows() {
        let own = quadrature(&[], &[-1.0, 2.0]);
        assert_eq!(own.weights.len(), 11 * 9 + 15 * 15);
        assert_eq!(own.is_middle.iter().filter(|is| **is).count(), 11);
        assert!((own.integral(|x, y| x * y) - 4.0 * 1.5 * 2.75).abs() < 1e-12);
        let first: Vec<f64> = own.points.as_chunks::<2>().0[..15].iter().map(|[x, _]| x + 1.0).collect();
        assert!(first.iter().enumerate().all(|(at, x)| (x - (at as f64 + 0.5) / 15.0).abs() < 1e-12), "{first:?}");
    }
}
