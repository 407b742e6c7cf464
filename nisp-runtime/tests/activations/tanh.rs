//! tanh and its derivatives.

use crate::double_double::Dd;
use crate::tanh_errors::{D, Rows, Worst, largest_ratios, reference_double, reference_single};
use nisp_runtime::real::Real;
use nisp_runtime::simd::{Element, Isa, dispatch};

fn check(worst: &Worst, isa: Isa, elem: &str, tanh: f64) {
    println!("{elem} {}: {:.2?} near zeros {:.2?}", isa.name(), worst.ulps, worst.near_zeros);
    // Six derivatives are promised.
    let bound = 8.0;
    assert!(worst.ulps[0] <= tanh, "tanh off by {} ulp", worst.ulps[0]);
    for n in 1..=6 {
        assert!(worst.ulps[n] <= bound, "derivative {n} off by {} ulp", worst.ulps[n]);
        assert!(worst.near_zeros[n] <= bound, "derivative {n} off by {} ulp of its size", worst.near_zeros[n]);
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
        for (got, want) in dispatch(isa, Rows(&inputs)).iter().zip(wanted.iter().chain(&wanted)) {
            let error = std::array::from_fn(|n| f64::from(got[n]) - want[n]);
            worst.add::<f32>(want, &error, &largest);
        }
        check(&worst, isa, "f32", 1.5);
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
        for (got, want) in dispatch(isa, Rows(&inputs)).iter().zip(wanted.iter().chain(&wanted)) {
            let error = std::array::from_fn(|n| (Dd::from(got[n]) - want[n]).abs().hi);
            worst.add::<f64>(&want.map(|x| x.hi), &error, &largest);
        }
        check(&worst, isa, "f64", 4.0);
    }
}

fn special_values<E: Element>() {
    let inputs = [0.0, -0.0, 1e300, -1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN].map(E::from_f64);
    for isa in Isa::available() {
        let rows: Vec<[f64; D]> = dispatch(isa, Rows(&inputs)).iter().map(|row| row.map(Real::to_f64)).collect();
        for rows in rows.chunks_exact(inputs.len()) {
            assert_eq!(rows[0][..6], [0.0, 1.0, 0.0, -2.0, 0.0, 16.0]);
            assert!(rows[0][0].is_sign_positive() && rows[1][0].is_sign_negative());
            for (row, t) in rows[2..6].iter().zip([1.0, -1.0, 1.0, -1.0]) {
                assert_eq!(row[0], t);
                assert!(row[1..].iter().all(|&x| x == 0.0), "saturated: {row:?}");
            }
            assert!(rows[6].iter().all(|x| x.is_nan()), "{}: {:?}", isa.name(), rows[6]);
        }
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
        for [t, s, ..] in dispatch(isa, Rows(&[10.0_f32])) {
            assert_eq!(1.0 - t * t, 0.0);
            assert!((f64::from(s) / 8.244_614_512_554_7e-9 - 1.0).abs() < 1e-6, "{s}");
        }
    }
}
