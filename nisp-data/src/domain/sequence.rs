//! Points in the unit cube: independent, Sobol, Latin hypercube. All are functions of the seed alone.

use rand::rngs::Xoshiro256PlusPlus;
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};

use super::Sampling;

/// Turns by which consecutive points of a sunflower differ.
pub(super) const GOLDEN_TURN: f64 = 0.618_033_988_749_894_9;

/// Sobol's direction numbers are listed for this many dimensions.
pub(super) const MAX_DIM: usize = 6;

/// Joe and Kuo's primitive polynomials (degree, inner coefficients) and first direction numbers, from dimension two on.
/// No maintained crate gives Sobol points in double precision without a limit near 65 000.
const DIRECTIONS: [(u32, u32, &[u32]); MAX_DIM - 1] =
    [(1, 0, &[1]), (2, 1, &[1, 3]), (3, 1, &[1, 3, 1]), (3, 2, &[1, 1, 1]), (4, 1, &[1, 1, 3, 3])];

/// A generator whose stream is part of our contract: the same seed gives the same points after any upgrade.
pub(super) fn generator(seed: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(seed)
}

/// `count` points of the unit cube, point by point. Regular grids are no business of this file: they come as Sobol.
pub(super) fn unit_cube(dim: usize, count: usize, sampling: Sampling, seed: u64) -> Vec<f64> {
    let mut generator = generator(seed);
    match sampling {
        Sampling::Uniform => (0..count * dim).map(|_| generator.random::<f64>()).collect(),
        Sampling::LatinHypercube => latin(dim, count, &mut generator),
        Sampling::Sobol | Sampling::Grid => sobol(dim, count, &mut generator),
    }
}

fn latin(dim: usize, count: usize, generator: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    let mut out = vec![0.0; count * dim];
    let mut slices: Vec<usize> = (0..count).collect();
    for axis in 0..dim {
        slices.shuffle(generator);
        for (index, &slice) in slices.iter().enumerate() {
            out[index * dim + axis] = (slice as f64 + generator.random::<f64>()) / count as f64;
        }
    }
    out
}

/// In Gray-code order, with a random digital shift: it keeps the evenness and gives each seed its own points.
fn sobol(dim: usize, count: usize, generator: &mut Xoshiro256PlusPlus) -> Vec<f64> {
    let directions: Vec<[u32; 32]> = (0..dim).map(directions).collect();
    let mut state: Vec<u32> = (0..dim).map(|_| generator.random::<u32>()).collect();
    let mut out = Vec::with_capacity(count * dim);
    for index in 0..count as u32 {
        out.extend(state.iter().map(|&bits| (f64::from(bits) + 0.5) / 2f64.powi(32)));
        let flip = (index + 1).trailing_zeros().min(31) as usize;
        for (bits, axis) in state.iter_mut().zip(&directions) {
            *bits ^= axis[flip];
        }
    }
    out
}

fn directions(axis: usize) -> [u32; 32] {
    let mut numbers = [0; 32];
    let Some((degree, inner, first)) = axis.checked_sub(1).map(|index| DIRECTIONS[index]) else {
        return std::array::from_fn(|bit| 1 << (31 - bit));
    };
    let degree = degree as usize;
    for bit in 0..32 {
        numbers[bit] = if bit < degree {
            first[bit] << (31 - bit)
        } else {
            let tail = numbers[bit - degree] ^ (numbers[bit - degree] >> degree);
            (1..degree).filter(|k| (inner >> (degree - 1 - k)) & 1 == 1).fold(tail, |sum, k| sum ^ numbers[bit - k])
        };
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every dyadic slice of every axis holds the same number of points: the defining property, shift or not.
    #[test]
    fn sobol_points_are_stratified() {
        let points = sobol(MAX_DIM, 64, &mut generator(3));
        for axis in 0..MAX_DIM {
            let mut counts = [0; 64];
            points.chunks(MAX_DIM).for_each(|point| counts[(point[axis] * 64.0) as usize] += 1);
            assert!(counts.iter().all(|&count| count == 1), "axis {axis}: {counts:?}");
        }
        let pairs: std::collections::BTreeSet<_> =
            points.chunks(MAX_DIM).map(|point| ((point[0] * 8.0) as u32, (point[1] * 8.0) as u32)).collect();
        assert_eq!(pairs.len(), 64);
    }

    /// The first points of the unshifted sequence, as published.
    #[test]
    fn directions_are_joe_and_kuos() {
        let leading = |axis: usize| directions(axis).map(|number| number >> 28)[..4].to_vec();
        assert_eq!(leading(0), [8, 4, 2, 1]);
        assert_eq!(leading(1), [8, 12, 10, 15]);
        assert_eq!(leading(2), [8, 12, 6, 9]);
    }
}
