//! tanh and its derivatives against references of twice the precision: f64 for f32, double-double for f64.

mod double_double;

use double_double::{Dd, exponential};
use nisp_runtime::real::Real;
use nisp_runtime::simd::{Isa, Kernel, Simd, dispatch};
use nisp_runtime::tanh::{derivatives, tanh_and_slope};

/// Derivatives under test: the function and its first eight.
const D: usize = 9;

/// A derivative counts as away from its zeros where it is at least this share of the largest size, relative to s or t s,
/// that it ever has: nearer, even a slope that is rounded correctly leaves it fewer digits.
const AWAY: f64 = 2.0 / 3.0;

/// Computes `[t, s, ...]` of every input: one row per input.
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
            let (t, s) = tanh_and_slope(unsafe { V::load(lanes.as_ptr()) });
            let phi = derivatives::<V, D>(t, s);
            for (n, value) in phi.into_iter().enumerate() {
                // SAFETY: as above.
                unsafe { value.store(lanes.as_mut_ptr()) };
                for (row, &x) in rows.iter_mut().zip(&lanes) {
                    row[n] = x;
                }
            }
        }
        rows
    }
}

/// The derivatives as Taylor coefficients of the solution of t' = s, s' = -2 t s: no polynomial of ours.
fn reference<T: Copy + From<f64> + std::ops::Add<Output = T> + std::ops::Mul<Output = T>>(
    t: T,
    s: T,
    zero: T,
    inverse: impl Fn(f64) -> T,
) -> [T; D] {
    let (mut t_k, mut s_k) = ([zero; D], [zero; D]);
    (t_k[0], s_k[0]) = (t, s);
    for k in 0..D - 1 {
        let product = (0..=k).fold(zero, |sum, i| sum + t_k[i] * s_k[k - i]);
        t_k[k + 1] = s_k[k] * inverse((k + 1) as f64);
        s_k[k + 1] = product * T::from(-2.0) * inverse((k + 1) as f64);
    }
    let mut factorial = 1.0;
    std::array::from_fn(|k| {
        factorial *= k.max(1) as f64;
        t_k[k] * T::from(factorial)
    })
}

fn reference_single(a: f32) -> [f64; D] {
    let a = f64::from(a);
    let e = (-2.0 * a.abs()).exp();
    reference(a.tanh(), 4.0 * e / ((1.0 + e) * (1.0 + e)), 0.0, |k| 1.0 / k)
}

fn reference_double(a: f64) -> [Dd; D] {
    let (e, less_one) = exponential(Dd::from(-2.0 * a.abs()));
    let sum = less_one + Dd::from(2.0);
    let t = -less_one / sum;
    let t = if a < 0.0 { -t } else { t };
    reference(t, Dd::from(4.0) * e / (sum * sum), Dd::ZERO, |k| Dd::from(1.0) / Dd::from(k))
}

/// Largest |phi_n| over its factor, s or t s, for each n.
fn largest_ratios() -> [f64; D] {
    let mut largest = [0.0_f64; D];
    for i in 1..4000 {
        let phi = reference_single(i as f32 * 5e-3);
        for n in 1..D {
            largest[n] = largest[n].max((phi[n] / factor(&phi, n)).abs());
        }
    }
    largest
}

fn factor(phi: &[f64; D], n: usize) -> f64 {
    if n.is_multiple_of(2) { phi[0] * phi[1] } else { phi[1] }
}

/// Distance from `x` to the next number of type `E` away from zero, at least that at the least normal number times 64:
/// what a denormal slope lacks in digits, the largest coefficient hands on.
fn spacing<E: Real>(x: f64) -> f64 {
    let (least_exponent, digits) = if E::NAME == "f32" { (-126, 23) } else { (-1022, 52) };
    let mut exponent = x.abs().log2().floor().max(-1100.0) as i32;
    exponent -= i32::from(2.0_f64.powi(exponent / 2) * 2.0_f64.powi(exponent - exponent / 2) > x.abs());
    let exponent = exponent.max(least_exponent + 6) - digits;
    2.0_f64.powi(exponent / 2) * 2.0_f64.powi(exponent - exponent / 2)
}

/// Worst errors over a set of inputs: units in the last place away from zeros, and elsewhere in units of epsilon times
/// the size that the derivative has nearby.
#[derive(Default, Debug)]
struct Worst {
    ulps: [f64; D],
    near_zeros: [f64; D],
}

impl Worst {
    /// `error[n]` is the computed value minus `phi[n]`.
    fn add<E: Real>(&mut self, phi: &[f64; D], error: &[f64; D], largest: &[f64; D]) {
        self.ulps[0] = self.ulps[0].max(error[0].abs() / spacing::<E>(phi[0]));
        for n in 1..D {
            let size = factor(phi, n).abs() * largest[n];
            if phi[n].abs() >= AWAY * size {
                self.ulps[n] = self.ulps[n].max(error[n].abs() / spacing::<E>(phi[n]));
            } else {
                self.near_zeros[n] = self.near_zeros[n].max(error[n].abs() / spacing::<E>(size));
            }
        }
    }

    fn check(&self, isa: Isa, elem: &str, tanh: f64) {
        println!("{elem} {}: {:.2?} near zeros {:.2?}", isa.name(), self.ulps, self.near_zeros);
        // Six derivatives are promised. Without fused multiply-add, roundings add up to twice as much.
        let (tanh, bound) = if isa == Isa::SCALAR { (2.0 * tanh, 16.0) } else { (tanh, 8.0) };
        assert!(self.ulps[0] <= tanh, "tanh off by {} ulp", self.ulps[0]);
        for n in 1..=6 {
            assert!(self.ulps[n] <= bound, "derivative {n} off by {} ulp", self.ulps[n]);
            assert!(self.near_zeros[n] <= bound, "derivative {n} off by {} ulp of its size", self.near_zeros[n]);
        }
    }
}

#[test]
fn single_precision_over_all_magnitudes() {
    let largest = largest_ratios();
    let inputs: Vec<f32> = (0..f32::INFINITY.to_bits())
        .step_by(2 * 997)
        .enumerate()
        .map(|(i, bits)| if i % 2 == 0 { f32::from_bits(bits) } else { -f32::from_bits(bits) })
        .collect();
    let wanted: Vec<[f64; D]> = inputs.iter().map(|&a| reference_single(a)).collect();
    for isa in Isa::available() {
        let mut worst = Worst::default();
        for (got, want) in dispatch(isa, Rows(&inputs)).iter().zip(&wanted) {
            let error = std::array::from_fn(|n| f64::from(got[n]) - want[n]);
            worst.add::<f32>(want, &error, &largest);
        }
        worst.check(isa, "f32", 1.5);
    }
}

#[test]
fn double_precision_over_all_magnitudes() {
    let largest = largest_ratios();
    // Every size from the least denormal to the largest number, densest where the derivatives live.
    let tiny = (0..4000).map(|i| f64::from_bits(i * 1_000_003 + (i << 48)));
    let plain = (0..60_000).map(|i| f64::from(i) * 3.7e-4 * if i % 2 == 0 { 1.0 } else { -1.0 });
    let saturated = (0..4000).map(|i| 20.0 + f64::from(i) * 0.0917);
    let inputs: Vec<f64> = tiny.chain(plain).chain(saturated).filter(|a| a.abs() < 370.0).collect();
    let wanted: Vec<[Dd; D]> = inputs.iter().map(|&a| reference_double(a)).collect();
    for isa in Isa::available() {
        let mut worst = Worst::default();
        for (got, want) in dispatch(isa, Rows(&inputs)).iter().zip(&wanted) {
            let error = std::array::from_fn(|n| (Dd::from(got[n]) - want[n]).abs().hi);
            worst.add::<f64>(&want.map(|x| x.hi), &error, &largest);
        }
        worst.check(isa, "f64", 4.0);
    }
}

fn special_values<E: Real>() {
    let inputs = [0.0, -0.0, 1e300, -1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN].map(E::from_f64);
    for isa in Isa::available() {
        let rows: Vec<[f64; D]> = dispatch(isa, Rows(&inputs)).iter().map(|row| row.map(Real::to_f64)).collect();
        assert_eq!(rows[0][..6], [0.0, 1.0, 0.0, -2.0, 0.0, 16.0]);
        assert!(rows[0][0].is_sign_positive() && rows[1][0].is_sign_negative());
        for (row, t) in rows[2..6].iter().zip([1.0, -1.0, 1.0, -1.0]) {
            assert_eq!(row[0], t);
            assert!(row[1..].iter().all(|&x| x == 0.0), "saturated: {row:?}");
        }
        assert!(rows[6].iter().all(|x| x.is_nan()), "{}: {:?}", isa.name(), rows[6]);
    }
}

#[test]
fn infinities_saturate_and_nan_passes() {
    special_values::<f32>();
    special_values::<f64>();
}

#[test]
fn the_slope_outlives_one_minus_t_squared() {
    for isa in Isa::available() {
        let [t, s, ..] = dispatch(isa, Rows(&[10.0_f32]))[0];
        assert_eq!(1.0 - t * t, 0.0);
        assert!((f64::from(s) / 8.244_614_512_554_7e-9 - 1.0).abs() < 1e-6, "{s}");
    }
}
