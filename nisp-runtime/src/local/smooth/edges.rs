//! What the cells of a lattice cannot hold of a source that has edges: waves shorter than four cells.

use std::f64::consts::{FRAC_PI_2, PI};

use super::prior::changes;
use super::short::squares;
use crate::local::heads::Heads;

/// Standard deviation to add to each coefficient of a head of this roughness that changes little. It covers the waves shorter than four cells
/// of a source with edges.
pub(super) fn unresolved(heads: &Heads, head: usize, roughness: f64) -> f64 {
    let lattice = &heads.lattices[head];
    (changes(lattice, roughness) * shorter(lattice.dimensions()) / squares(heads, head)).sqrt()
}

/// The variance of such waves over that of differences from a cell to the next. The spectrum of a head that changes little falls with
/// the square of the frequency down to these waves. From there on it falls as that of a head with edges does: with the number of coordinates
/// and one more.
fn shorter(dimensions: usize) -> f64 {
    // Directions of waves, over the volume of their frequencies.
    let directions = match dimensions {
        1 => 1.0 / PI,
        2 => 0.5 / PI,
        3 => 0.5 / (PI * PI),
        _ => 0.125 / (PI * PI),
    };
    directions * FRAC_PI_2.powi(dimensions as i32 - 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::normal;
    use rand::{SeedableRng, rngs::StdRng};
    use std::f64::consts::TAU;

    /// Walks whose steps over a cell have variance one, without their waves of four cells and longer ones.
    #[test]
    fn a_walk_has_as_many_short_waves() {
        const CELLS: usize = 64;
        const PLACES: usize = 16 * CELLS;
        const WALKS: usize = 100;
        let mut random = StdRng::seed_from_u64(1);
        let mut left = 0.0;
        for _ in 0..WALKS {
            let size = (CELLS as f64 / PLACES as f64).sqrt();
            let steps: Vec<f64> = (0..PLACES).map(|_| size * normal(&mut random)).collect();
            let mean = steps.iter().sum::<f64>() / PLACES as f64;
            let mut at = 0.0;
            let walk: Vec<f64> = steps.iter().map(|step| (at += step - mean, at).1).collect();
            let power = |wave: usize| {
                let phase = |at: usize| TAU * (wave * at % PLACES) as f64 / PLACES as f64;
                let along = |of: fn(f64) -> f64| walk.iter().enumerate().map(|(at, x)| x * of(phase(at))).sum::<f64>();
                let times = if wave == 0 { 1.0 } else { 2.0 };
                times * (along(f64::cos).powi(2) + along(f64::sin).powi(2)) / (PLACES as f64).powi(2)
            };
            let all = walk.iter().map(|x| x * x).sum::<f64>() / PLACES as f64;
            left += (all - (0..=CELLS / 4).map(power).sum::<f64>()) / WALKS as f64;
        }
        assert!((left / shorter(1) - 1.0).abs() < 0.1, "{left} {}", shorter(1));
    }

    /// Two coordinates: the spectrum summed up over a fine grid of frequencies.
    #[test]
    fn short_waves_of_all_directions_count() {
        const STEP: f64 = 0.1;
        let spectrum = |frequency: f64| FRAC_PI_2.powi(-2) * (FRAC_PI_2 / frequency).powi(3);
        let mut sum = 0.0;
        for (i, j) in (-1500..1500).flat_map(|i| (-1500..1500).map(move |j| (i, j))) {
            let frequency = STEP * (f64::from(i) + 0.5).hypot(f64::from(j) + 0.5);
            sum += if frequency > FRAC_PI_2 { spectrum(frequency) * (STEP / TAU).powi(2) } else { 0.0 };
        }
        assert!((sum / shorter(2) - 1.0).abs() < 0.03, "{sum} {}", shorter(2));
    }
}
