//! What the cells of a lattice cannot hold of a source of which it is not known whether it has edges: waves shorter than four cells. A source
//! has as much of them as the waves of about four cells let on.

use std::f64::consts::{FRAC_PI_2, PI};

use super::prior::{bends, next};
use crate::local::heads::Heads;
use crate::local::lattice::Lattice;

/// The deviation of a head's coefficients that stands for waves shorter than four cells, of which the data say nothing and which the cells
/// cannot hold. `likely` are coefficients that a head of this roughness may have. The spectrum of one that bends little falls with the
/// fourth power of the frequency down to these waves. From there on it falls as that of a head with edges does, with the third power; it
/// is summed up over two octaves.
pub(super) fn unresolved(heads: &Heads, head: usize, likely: &[Vec<f64>], roughness: f64) -> f64 {
    let lattice = &heads.lattices[head];
    let dimensions = lattice.dimensions();
    // The integral of `frequency^(dimensions - 4)`, times the directions of waves over the volume of their frequencies.
    let octaves = match dimensions {
        1 => 15.0 / 32.0 / PI,
        2 => 0.75 / (2.0 * PI),
        3 => 4f64.ln() / (2.0 * PI * PI),
        _ => 3.0 / (8.0 * PI * PI),
    };
    // Where nothing was seen coefficients may be anything.
    let bending = bending(lattice, likely).min(bends(lattice, roughness));
    let variance = bending * FRAC_PI_2.powi(dimensions as i32 - 4) * octaves;
    (variance / squares(heads, head)).sqrt()
}

/// The variance of a head inside of its lattice, over that of coefficients that are independent.
pub(super) fn squares(heads: &Heads, head: usize) -> f64 {
    let lattice = &heads.lattices[head];
    let parts = heads.parts(head, &lattice.site(lattice.len() / 2));
    parts.iter().map(|(_, part)| (part / heads.scale[head]).powi(2)).sum()
}

/// The variance of second differences of coefficients from a cell to the next, of a head that bends little and has as many waves of about
/// four cells as these coefficients.
fn bending(lattice: &Lattice, likely: &[Vec<f64>]) -> f64 {
    let own = |coefficients: &Vec<f64>| coefficients.iter().copied().map(Some).collect::<Vec<Option<f64>>>();
    let second: Vec<Vec<Option<f64>>> = likely.iter().map(|likely| differences(lattice, 1, &own(likely))).collect();
    // Differences over one cell and then over two see little of long waves, and little of waves of two cells, which splines hardly show.
    let fourth = mean_square(second.iter().map(|second| differences(lattice, 2, second)));
    // Second differences of such a head are independent. Differences of these are sums of so many squares.
    let dimensions = lattice.dimensions() as f64;
    let fourth = fourth.map(|square| square / (2.0 * dimensions + 4.0 * dimensions * dimensions));
    fourth.or_else(|| mean_square(second.into_iter())).unwrap_or(0.0)
}

/// The mean square of all numbers that are there; nothing if there are none.
fn mean_square(all: impl Iterator<Item = Vec<Option<f64>>>) -> Option<f64> {
    let (sum, count) = all.flatten().flatten().fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

/// By function the sum of second differences along every coordinate, from a function to one so many further; nothing where there is none.
fn differences(lattice: &Lattice, step: usize, numbers: &[Option<f64>]) -> Vec<Option<f64>> {
    let mut sums = vec![Some(0.0); numbers.len()];
    for axis in 0..lattice.dimensions() {
        let next = next(lattice, axis);
        let after = |at: usize| (0..step).try_fold(at as u32, |at, _| next[at as usize]).map(|at| at as usize);
        let mut along = vec![None; numbers.len()];
        for first in 0..numbers.len() {
            if let Some((middle, last)) = after(first).and_then(|middle| Some((middle, after(middle)?))) {
                let own = [first, middle, last].map(|at| numbers[at]);
                along[middle] = if let [Some(a), Some(b), Some(c)] = own { Some(a - 2.0 * b + c) } else { None };
            }
        }
        sums.iter_mut().zip(along).for_each(|(sum, own)| *sum = sum.zip(own).map(|(sum, own)| sum + own));
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{RngExt, SeedableRng, rngs::StdRng};
    use std::f64::consts::TAU;

    /// Sums of independent second differences of variance one, on a line.
    #[test]
    fn a_line_bends_as_it_was_made_to() {
        let lattice = Lattice::new(5, vec![0.0], vec![1.0], vec![395]);
        let mut random = StdRng::seed_from_u64(2);
        let mut line = || {
            let (mut slope, mut height) = (0.0, 0.0);
            let mut next = || {
                slope += normal(&mut random);
                height += slope;
                height
            };
            (0..400).map(|_| next()).collect::<Vec<f64>>()
        };
        let found = bending(&lattice, &[line(), line(), line(), line()]);
        assert!((found - 1.0).abs() < 0.2, "{found}");
    }

    /// Waves in all directions whose sum of second differences is as large at every frequency, over two coordinates.
    #[test]
    fn waves_of_all_lengths_bend_as_each_does() {
        const SIDE: usize = 30;
        let lattice = Lattice::new(5, vec![0.0; 2], vec![1.0; 2], vec![SIDE - 5; 2]);
        let mut random = StdRng::seed_from_u64(3);
        let (mut sum, mut squares) = (vec![0.0; SIDE * SIDE], 0.0);
        for (i, j) in (0..SIDE).flat_map(|i| (0..=SIDE / 2).map(move |j| (i, j))).skip(1) {
            let (f, g) = (TAU * i as f64 / SIDE as f64, TAU * j as f64 / SIDE as f64);
            let (size, phase) = (1.0 / (4.0 - 2.0 * f.cos() - 2.0 * g.cos()), TAU * random.random::<f64>());
            (0..sum.len()).for_each(|at| {
                sum[at] += size * (f * (at % SIDE) as f64 + g * (at / SIDE) as f64 + phase).cos();
            });
            squares += 0.5;
        }
        let found = bending(&lattice, &[sum]);
        assert!((found / squares - 1.0).abs() < 0.2, "{found} {squares}");
    }

    /// A source that is one wave over forty cells has hardly any short ones, however large it is.
    #[test]
    fn long_waves_say_nothing_of_short_ones() {
        let lattice = Lattice::new(5, vec![0.0], vec![1.0], vec![40]);
        let wave: Vec<f64> = (0..45).map(|at| 100.0 * (TAU * f64::from(at) / 40.0).sin()).collect();
        let second = (2.0 - 2.0 * (TAU / 40.0).cos()) * 100.0 / 2f64.sqrt();
        assert!(bending(&lattice, &[wave]).sqrt() < 0.05 * second);
    }

    /// Where there are too few functions for more, their second differences count.
    #[test]
    fn few_functions_have_second_differences() {
        let lattice = Lattice::new(3, vec![0.0], vec![1.0], vec![1]);
        assert!((bending(&lattice, &[vec![0.0, 1.0, 4.0, 9.0]]) - 4.0).abs() < 1e-12);
    }
}
