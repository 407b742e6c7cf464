//! Sine and cosine.

use nisp_runtime::activation::Activation;
use nisp_runtime::real::Real;
use nisp_runtime::simd::{Element, Isa, Kernel, Simd, dispatch};

use crate::double_double::Dd;

/// Functions under test: sine and its first five derivatives.
const D: usize = 6;

/// Computes `[sin a, cos a, ...]` of every input.
struct Rows<'a, E>(&'a [E]);

impl<E: Real> Kernel<E> for Rows<'_, E> {
    type Output = Vec<[E; D]>;
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) -> Vec<[E; D]> {
        let mut rows = vec![[E::ZERO; D]; self.0.len()];
        let mut lanes = vec![E::ZERO; V::LANES];
        for (inputs, rows) in self.0.chunks(V::LANES).zip(rows.chunks_mut(V::LANES)) {
            lanes[..inputs.len()].copy_from_slice(inputs);
            // SAFETY: `lanes` has LANES elements.
            let (value, slope) = Activation::Sine.value_and_slope::<V, D>(unsafe { V::load(lanes.as_ptr()) });
            for (n, phi) in Activation::Sine.derivatives::<V, D>(value, slope).into_iter().enumerate() {
                // SAFETY: as above.
                unsafe { phi.store(lanes.as_mut_ptr()) };
                rows.iter_mut().zip(&lanes).for_each(|(row, &x)| row[n] = x);
            }
        }
        rows
    }
}

/// `[sin a, cos a]` by the power series of exp(i r), `a = n pi/2 + r`.
fn reference(a: f64) -> [Dd; 2] {
    // pi/2 in three parts: the product of two f64 is exact, so that no digit is lost next to zeros.
    const QUARTER: [f64; 3] = [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_18e-33];
    let n = (a / QUARTER[0]).round();
    let r = QUARTER.iter().fold(Dd::from(a), |r, &part| r - Dd::from(n) * Dd::from(part));
    let (mut term, mut sums) = (Dd::from(1.0), [Dd::from(1.0), Dd::ZERO, Dd::ZERO, Dd::ZERO]);
    for k in 1..30 {
        term = term * r / Dd::from(k as f64);
        sums[k % 4] = sums[k % 4] + term;
    }
    let (cosine, sine) = (sums[0] - sums[2], sums[1] - sums[3]);
    match n.rem_euclid(4.0) {
        0.0 => [sine, cosine],
        1.0 => [cosine, -sine],
        2.0 => [-sine, -cosine],
        _ => [-cosine, sine],
    }
}

/// Arguments up to 1e4 of both signs, dense where networks work; and as many next to zeros of sine and cosine.
fn inputs() -> impl Iterator<Item = f64> {
    let signed = |(i, a): (usize, f64)| if i % 2 == 0 { a } else { -a };
    let plain = (0..40_000).map(|i| f64::from(i) * 2.3e-4);
    let far = (0..40_000).map(|i| f64::from(i) * 0.249_97);
    let zeros = (0..6300).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_2);
    let small = (0..300).map(|i| 0.5_f64.powi(i / 3) * (1.0 + f64::from(i % 3) / 3.0));
    plain.chain(far).chain(zeros).chain(small).enumerate().map(signed)
}

/// The largest error in units in the last place, of numbers that are at least a thousandth.
fn check<E: Element>(epsilon: f64) {
    let inputs: Vec<E> = inputs().map(E::from_f64).collect();
    let wanted: Vec<[Dd; 2]> = inputs.iter().map(|a| reference(a.to_f64())).collect();
    for isa in Isa::available() {
        let mut worst = 0.0_f64;
        for (row, wanted) in dispatch(isa, Rows(&inputs)).iter().zip(&wanted) {
            let row = row.map(Real::to_f64);
            for (found, wanted) in row.iter().zip(wanted) {
                let unit = epsilon * 2.0_f64.powf(wanted.hi.abs().max(1e-3).log2().floor());
                worst = worst.max((Dd::from(*found) - *wanted).abs().hi / unit);
            }
            assert_eq!(row[2..], [-row[0], -row[1], row[0], row[1]]);
        }
        println!("{} {}: {worst:.2}", E::NAME, isa.name());
        assert!(worst <= 2.0, "{} {}: {worst} units in the last place", E::NAME, isa.name());
    }
}

#[test]
fn single_precision_up_to_ten_thousand() {
    check::<f32>(f64::from(f32::EPSILON));
}

#[test]
fn double_precision_up_to_ten_thousand() {
    check::<f64>(f64::EPSILON);
}

fn special_values<E: Element>() {
    let inputs = [0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e12, -1e30].map(E::from_f64);
    for isa in Isa::available() {
        let rows: Vec<[f64; D]> = dispatch(isa, Rows(&inputs)).iter().map(|row| row.map(Real::to_f64)).collect();
        assert_eq!(rows[0], [0.0, 1.0, 0.0, -1.0, 0.0, 1.0]);
        assert!(rows[1..4].iter().flatten().all(|x| x.is_nan()), "{}: {:?}", isa.name(), &rows[1..4]);
        assert!(rows[4..].iter().flatten().all(|x| x.is_finite()), "{}: {:?}", isa.name(), &rows[4..]);
    }
}

#[test]
fn nan_and_infinities_give_nan_and_the_rest_is_finite() {
    special_values::<f32>();
    special_values::<f64>();
}
