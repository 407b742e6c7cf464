//! Whether neighbouring numbers are alike: those of noise are not.

use std::num::NonZero;

use rand::SeedableRng;
use rand::rngs::StdRng;
use rand::seq::index::sample;

use crate::ends::ends;
use crate::layer::MOST_COORDINATES;
use crate::nearest::{Nearest, Neighbour};

/// Neighbours whose numbers are compared, each place itself among them.
const NEIGHBOURS: NonZero<usize> = NonZero::new(5).unwrap();
/// Places that are looked at, at most.
const MOST: usize = 20_000;

/// Correlation of numbers at neighbouring places, and the same in its standard deviation under noise.
pub(crate) fn of_neighbours<const D: usize>(places: &[[f64; D]], numbers: &[f64], tree: &Nearest<D>) -> (f64, f64) {
    let square = numbers.iter().map(|x| x * x).sum::<f64>() / numbers.len().max(1) as f64;
    let (mut sum, mut pairs) = (0.0, 0.0f64);
    for (i, place) in places.iter().enumerate() {
        for Neighbour { index: j, .. } in tree.some(place, NEIGHBOURS) {
            if j != i {
                sum += numbers[i] * numbers[j];
                pairs += 1.0;
            }
        }
    }
    if square == 0.0 || pairs == 0.0 {
        return (0.0, 0.0);
    }
    let correlation = sum / pairs / square;
    // Most pairs are counted from both of their ends.
    (correlation, correlation * (pairs / 2.0).sqrt())
}

/// The same of places with `axes` coordinates each, flat, each over its range; of some of them where there are many.
pub(crate) fn over_coordinates(places: &[f64], axes: usize, numbers: &[f64]) -> (f64, f64) {
    let range = |axis: usize| {
        let own = places.iter().skip(axis).step_by(axes);
        let (low, high) = ends(own.copied());
        if high > low { high - low } else { 1.0 }
    };
    let ranges: Vec<f64> = (0..axes).map(range).collect();
    let place = |at: usize| -> [f64; MOST_COORDINATES] {
        std::array::from_fn(|axis| ranges.get(axis).map_or(0.0, |range| places[at * axes + axis] / range))
    };
    let chosen: Vec<usize> = match numbers.len() {
        all @ ..=MOST => (0..all).collect(),
        all => sample(&mut StdRng::seed_from_u64(0), all, MOST).into_vec(),
    };
    let own: Vec<[f64; MOST_COORDINATES]> = chosen.iter().map(|&at| place(at)).collect();
    let numbers: Vec<f64> = chosen.iter().map(|&at| numbers[at]).collect();
    Nearest::of(&own).map_or((0.0, 0.0), |tree| of_neighbours(&own, &numbers, &tree))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::RngExt;

    #[test]
    fn noise_has_no_pattern_and_a_tilt_has() {
        let mut random = StdRng::seed_from_u64(5);
        let mut off = || (random.random::<f64>() - 0.5, 1e-2 * normal(&mut random));
        let (places, mut misfits): (Vec<[f64; 3]>, Vec<f64>) =
            (0..3000).map(|_| (off(), off())).map(|((x, misfit), (y, _))| ([x, y, 0.0], misfit)).unzip();
        let tree = Nearest::of(&places).unwrap();
        assert!(of_neighbours(&places, &misfits, &tree).1.abs() < 4.0);
        places.iter().zip(&mut misfits).for_each(|(place, misfit)| *misfit += 1e-2 * place[0]);
        assert!(of_neighbours(&places, &misfits, &tree).1 > 5.0);
    }

    /// A pattern of half of the noise, whatever the units of the coordinates are, and more places than are looked at.
    #[test]
    fn a_wave_is_seen_over_coordinates_of_any_units() {
        let mut random = StdRng::seed_from_u64(6);
        for count in [1500, 30_000] {
            let places: Vec<f64> =
                (0..count).flat_map(|_| [random.random::<f64>(), 1e4 * random.random::<f64>()]).collect();
            let mut noise: Vec<f64> = (0..count).map(|_| normal(&mut random)).collect();
            assert!(over_coordinates(&places, 2, &noise).1.abs() < 4.0);
            let wave = |at: &[f64]| (20.0 * at[0]).sin() * (2e-3 * at[1]).cos();
            noise.iter_mut().zip(places.chunks(2)).for_each(|(noise, at)| *noise += wave(at));
            let (correlation, deviations) = over_coordinates(&places, 2, &noise);
            assert!((0.1..0.25).contains(&correlation) && deviations > 5.0, "{correlation} {deviations}");
        }
    }
}
