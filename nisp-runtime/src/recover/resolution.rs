//! Where a network is the wrong size: data that it follows too closely, and places where an equation fails.

use crate::engine::Engine;
use crate::noise::{Noise, ObservationNoise};
use crate::problem::Bound;
use crate::schema::{Loss, Term, TermKind};
use crate::solve::driver::{Warning, WarningKind};
use crate::units::Number;

/// Misfit beside the noise, below which the noise is followed: three quarters of the data are used up by the fit.
const TIGHT: f64 = 0.5;

/// Points of a term at least for some of them to stand out.
const MANY: usize = 50;
/// Share of the points that make a hot spot, and the share of the sum of squares that they have there.
const SPOT: f64 = 0.02;
const HEAT: f64 = 0.5;
/// Residual beside its natural size, below which no place is hot.
const COLD: f64 = 0.03;

/// What does not fit at `theta`.
pub(super) fn warnings(bound: &Bound, engine: &mut Engine<f64>, theta: &[f64], noise: &Noise) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for at in 0..engine.groups.len() {
        let rows = engine.raw_rows(at, theta);
        let group = engine.groups[at].schema;
        let points = engine.groups[at].points;
        for (number, term) in group.terms.iter().enumerate() {
            let own = &rows[term.first * points..(term.first + term.rows) * points];
            let message = match term.kind {
                TermKind::Observation if bound.losses[at][number] == Loss::Square => {
                    let own: Vec<f64> =
                        own.chunks_exact(points).flat_map(|row| bound.measured(at, term, row)).collect();
                    let outward = |x| bound.system.outward(&term.unit).of(Number::engine(x));
                    if let Some(message) = too_few(term, own.len() / term.rows, noise.of(at, number)) {
                        warnings.push(Warning { kind: WarningKind::Unresolved, message });
                    }
                    let rms = (own.iter().map(|x| x * x).sum::<f64>() / own.len().max(1) as f64).sqrt();
                    let level = noise.of(at, number).filter(|level| follows_noise(rms, *level));
                    level.map(|level| {
                        let (rms, sigma, unit) = (outward(rms), outward(level.deviation), term.unit.behind());
                        format!(
                            "`{}` follows its noise: the misfit is far below that of the data; take the optimizer `evidence`, \
                             or a smaller network (rms {rms:.2e}{unit}, noise {sigma:.2e}{unit})",
                            term.name
                        )
                    })
                }
                TermKind::Residual => hot_spot(own, points, bound.sizes[at][number]).map(|(point, share)| {
                    let inputs = bound.problem.scene().schema.coordinates.len();
                    format!(
                        "`{}.{}` fails around {}, by {share:.2} of its natural size and much more than elsewhere: bind \
                         more points there, or take a wider network",
                        group.name,
                        term.name,
                        bound.place(&bound.coordinates[at][point * inputs..][..inputs]),
                    )
                }),
                _ => None,
            };
            warnings.extend(message.map(|message| Warning { kind: WarningKind::Unresolved, message }));
        }
    }
    warnings
}

/// True where a misfit is far below the noise of the data.
fn follows_noise(rms: f64, level: ObservationNoise) -> bool {
    !level.is_exact() && rms < TIGHT * level.deviation
}

/// Says so where measurements are too few to tell noise from signal, and nobody says how noisy they are.
fn too_few(term: &Term, points: usize, level: Option<ObservationNoise>) -> Option<String> {
    (points > 0 && level.is_none() && term.within.is_none() && !term.columns.is_empty()).then(|| {
        format!(
            "`{}` has too few measurements ({points}) to tell noise from signal, and no error bars to trust: give more of them, \
             or say in the equations how far they may be off (`within`)",
            term.name
        )
    })
}
/// The worst point and its residual beside `size`, where few points have most of the sum of squares. Rows come one after
/// the other, each over all points.
fn hot_spot(rows: &[f64], points: usize, size: f64) -> Option<(usize, f64)> {
    if points < MANY {
        return None;
    }
    let square = |point: usize| rows.iter().skip(point).step_by(points).map(|x| x * x).sum::<f64>();
    let mut squares: Vec<(f64, usize)> = (0..points).map(|point| (square(point), point)).collect();
    squares.sort_by(|a, b| b.0.total_cmp(&a.0));
    let sum = |squares: &[(f64, usize)]| squares.iter().map(|(square, _)| square).sum::<f64>();
    let few = ((SPOT * points as f64).ceil() as usize).max(1);
    let (worst, point) = squares[0];
    let share = worst.sqrt() / size;
    (share > COLD && sum(&squares[..few]) > HEAT * sum(&squares)).then_some((point, share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_is_hot_and_a_wave_is_not() {
        let wave: Vec<f64> = (0..200).map(|i| 0.1 * (0.3 * f64::from(i)).sin()).collect();
        assert_eq!(hot_spot(&wave, 100, 1.0), None);
        let mut peak = wave.clone();
        // The second row at point 40.
        peak[140] = 2.0;
        assert_eq!(hot_spot(&peak, 100, 4.0).map(|(point, _)| point), Some(40));
        assert_eq!(hot_spot(&peak, 100, 400.0), None, "too small to matter");
    }

    #[test]
    fn a_misfit_far_below_the_noise_follows_it() {
        let level = |deviation| ObservationNoise { group: 0, term: 0, deviation, spread: 1.0 };
        assert!(follows_noise(0.004, level(0.01)));
        assert!(!follows_noise(0.011, level(0.01)));
        assert!(!follows_noise(1e-9, level(1e-8)), "exact data");
    }
}
