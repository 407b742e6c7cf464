//! What tanh and its derivatives in f32 are judged by: f64, and a power series where f64 loses digits too.

use crate::tanh_errors::{D, reference_single};

/// Below this magnitude three terms of the power series are good to twice the digits of f32.
const TINY: f32 = 1.0 / 4096.0;

/// `tanh a = a - a^3/3 + 2 a^5/15 - 17 a^7/315 + 62 a^9/2835 - 1382 a^11/155925 + ...`
const ODD: [f64; 6] = [1.0, -1.0 / 3.0, 2.0 / 15.0, -17.0 / 315.0, 62.0 / 2835.0, -1382.0 / 155_925.0];

/// The first three coefficients that are left of it in each derivative.
const POWER_SERIES: [[f64; 3]; D] = power_series();

const fn power_series() -> [[f64; 3]; D] {
    let mut table = [[0.0; 3]; D];
    let mut n = 0;
    while n < D {
        let mut k = 0;
        while k < 3 {
            let odd = n / 2 + k;
            let (mut coefficient, mut lost) = (ODD[odd], 0);
            while lost < n {
                coefficient *= (2 * odd + 1 - lost) as f64;
                lost += 1;
            }
            table[n][k] = coefficient;
            k += 1;
        }
        n += 1;
    }
    table
}

/// tanh and its derivatives by power series, term by term, the smallest first.
fn at_tiny(a: f32) -> [f64; D] {
    let a = f64::from(a);
    std::array::from_fn(|n| {
        let [first, second, third] = POWER_SERIES[n];
        let even = first + a * a * (second + a * a * third);
        if n.is_multiple_of(2) { a * even } else { even }
    })
}

/// What tanh and its derivatives in f32 are judged by.
pub(crate) fn wanted_single(a: f32) -> [f64; D] {
    if a.abs() < TINY { at_tiny(a) } else { reference_single(a) }
}
