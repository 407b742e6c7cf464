//! Where the answer does not fit: data that the network does not follow or follows too closely, and places where an
//! equation fails.

use super::noise::{Noise, ObservationNoise, in_order, is_exact};
use super::place::place;
use super::swing::{self, Swing};
use crate::engine::Engine;
use crate::problem::Bound;
use crate::schema::{Loss, Term, TermKind};
use crate::solve::driver::{Warning, WarningKind};

/// Misfit beside the noise, above which data are not resolved; its square is chi^2 per datum.
const LOOSE: f64 = 1.5;
/// Misfit beside the noise, below which the noise is followed: three quarters of the data are used up by the fit.
const TIGHT: f64 = 0.5;
/// Misfit of exact data beside their own spread, above which they are not resolved.
const COARSE: f64 = 1e-3;

/// Longest gap of a record that counts as evenly sampled, beside the mean.
const LONGEST: f64 = 2.0;

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
                TermKind::Observation if term.loss == Loss::Square => {
                    let outward = bound.system.outward(&term.unit);
                    if let Some(message) = too_few(term, points, noise.of(at, number)) {
                        warnings.push(Warning { kind: WarningKind::Unresolved, message });
                    }
                    noise.of(at, number).and_then(|level| {
                        let rms = (own.iter().map(|x| x * x).sum::<f64>() / own.len() as f64).sqrt();
                        let unit = term.unit.text;
                        let Some(said) = misfit(rms, level.deviation, level.spread) else {
                            let swing = swing(&bound.coordinates[at], own, level)?;
                            return Some(smoothed_away(term.name, swing, outward, unit));
                        };
                        let (rms, sigma) = (rms * outward, level.deviation * outward);
                        Some(format!("`{}` {said} (rms {rms:.2e} {unit}, noise {sigma:.2e} {unit})", term.name))
                    })
                }
                TermKind::Residual => hot_spot(own, points, bound.sizes[at][number]).map(|(point, share)| {
                    let schema = bound.problem.scene().schema;
                    let inputs = schema.coordinates.len();
                    let inward = &bound.coordinates[at][point * inputs..][..inputs];
                    let units = schema.coordinates.iter().map(|c| bound.system.outward(&c.unit));
                    let outward: Vec<f64> = inward.iter().zip(units).map(|(x, unit)| x * unit).collect();
                    format!(
                        "`{}.{}` fails around {}, by {share:.2} of its natural size and much more than elsewhere: bind \
                         more points there, or take a wider network",
                        group.name,
                        term.name,
                        place(schema.coordinates, &outward),
                    )
                }),
                _ => None,
            };
            warnings.extend(message.map(|message| Warning { kind: WarningKind::Unresolved, message }));
        }
    }
    warnings
}

/// Says so where measurements are too few to tell noise from signal, and nobody says how noisy they are.
fn too_few(term: &Term, points: usize, level: Option<ObservationNoise>) -> Option<String> {
    (level.is_none() && term.within.is_none() && !term.columns.is_empty()).then(|| {
        format!(
            "`{}` has too few measurements ({points}) to tell noise from signal, and no error bars to trust: give more of them, \
             or say in the equations how far they may be off (`within`)",
            term.name
        )
    })
}

/// What a misfit says, where it is not that of noise.
fn misfit(rms: f64, noise: f64, spread: f64) -> Option<&'static str> {
    let exact = is_exact(noise, spread);
    if exact && rms > COARSE * spread {
        Some("is not resolved, though its data are all but exact: give more time, a wider network or another seed")
    } else if !exact && rms > LOOSE * noise {
        Some(
            "is not resolved: the misfit is above the noise of the data; give more time, a wider network or another seed",
        )
    } else if !exact && rms < TIGHT * noise {
        Some(
            "follows its noise: the misfit is far below that of the data; take the optimizer `evidence`, or a smaller network",
        )
    } else {
        None
    }
}

/// An oscillation in what is left of a noisy record, if that is evenly sampled.
fn swing(times: &[f64], residuals: &[f64], noise: ObservationNoise) -> Option<Swing> {
    let is_record = times.len() == residuals.len() && is_even(times) && !is_exact(noise.deviation, noise.spread);
    is_record.then(|| swing::strongest(&in_order(times, residuals))).flatten()
}

/// True where no gap is much longer than the others.
fn is_even(times: &[f64]) -> bool {
    let sorted = in_order(times, times);
    let longest = sorted.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    let whole = sorted.last().zip(sorted.first()).map_or(0.0, |(last, first)| last - first);
    longest <= LONGEST * whole / (sorted.len().max(2) - 1) as f64
}

fn smoothed_away(name: &str, swing: Swing, outward: f64, unit: &str) -> String {
    format!(
        "`{name}` is not resolved: what is left of its data goes up and down {} times over the record by {:.2e} {unit}, which \
         noise does not; the answer misses that, and its error bars do not know of it; give another seed",
        swing.periods,
        swing.amplitude * outward,
    )
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
    fn a_record_with_a_gap_is_not_even() {
        let even: Vec<f64> = (0..50).rev().map(|i| 0.1 * f64::from(i) + 0.02 * f64::from(i % 3)).collect();
        assert!(is_even(&even) && is_even(&[]) && is_even(&[1.0]));
        let gap: Vec<f64> = even.iter().map(|t| if *t > 2.0 { t + 1.0 } else { *t }).collect();
        assert!(!is_even(&gap));
    }

    #[test]
    fn misfits_are_compared_with_the_noise() {
        assert_eq!(misfit(0.011, 0.01, 1.0), None);
        assert!(misfit(0.02, 0.01, 1.0).unwrap().contains("not resolved"));
        assert!(misfit(0.004, 0.01, 1.0).unwrap().contains("follows its noise"));
        assert_eq!(misfit(1e-4, 1e-8, 1.0), None);
        assert!(misfit(1e-2, 1e-8, 1.0).unwrap().contains("exact"));
    }
}
