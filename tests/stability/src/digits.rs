//! The references themselves, against arithmetic of 300 bits: the double-double numbers that f64 is judged by, and the f64
//! numbers that f32 is judged by.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

use crate::double_double::{Dd, exponential};
use crate::row::{Extent, Row};
use crate::single::wanted_single;
use crate::tanh_errors::{D, reference_double};

type Many = FBig<HalfEven, 2>;

const BITS: usize = 300;

fn many(x: f64) -> Many {
    Many::try_from(x).expect("a finite number").with_precision(BITS).value()
}

/// tanh and its derivatives: `t^(n) = s R_n(t)` with `R_1 = 1` and `R_{n+1} = s R_n' - 2 t R_n`, as polynomials in t and s.
fn tanh(a: f64) -> [Many; D] {
    let e = (many(-2.0) * many(a.abs())).exp();
    let sum = many(1.0) + &e;
    let t = -(many(-2.0) * many(a.abs())).exp_m1() / &sum;
    let t = if a < 0.0 { -t } else { t };
    let s = many(4.0) * e / (&sum * &sum);
    // Coefficients of t^i s^j.
    let mut r = [[0.0; D]; D];
    r[0][0] = 1.0;
    let power = |x: &Many, n: usize| (0..n).fold(many(1.0), |product, _| product * x);
    std::array::from_fn(|n| {
        if n == 0 {
            return t.clone();
        }
        let mut value = many(0.0);
        let mut next = [[0.0; D]; D];
        for (i, row) in r.iter().enumerate() {
            for (j, &c) in row.iter().enumerate().filter(|(_, c)| **c != 0.0) {
                value += many(c) * power(&t, i) * power(&s, j);
                // (t^i s^j)' is i t^(i-1) s^(j+1) - 2 j t^(i+1) s^j, and the factor s in front gives another -2 t.
                if i > 0 {
                    next[i - 1][j + 1] += i as f64 * c;
                }
                if i + 1 < D {
                    next[i + 1][j] -= 2.0 * (j + 1) as f64 * c;
                }
            }
        }
        r = next;
        value * &s
    })
}

/// How far a reference is off, over the larger of a value and the size that it has near its zeros.
fn error(found: Dd, exact: &Many, size: &Many) -> f64 {
    let off = many(found.hi) + many(found.lo) - exact;
    let over = |size: &Many| (&off / size).to_f64().value().abs();
    over(exact).min(over(size))
}

/// The largest error of tanh and its derivatives, whose size near zeros is that of s or t s.
fn largest(inputs: &[f64], reference: impl Fn(f64) -> [Dd; D]) -> f64 {
    let of = |&a: &f64| {
        let (exact, found) = (tanh(a), reference(a));
        let size = |n: usize| if n.is_multiple_of(2) { &exact[0] * &exact[1] } else { exact[1].clone() };
        let errors = (0..D).map(|n| error(found[n], &exact[n], &if n == 0 { exact[0].clone() } else { size(n) }));
        errors.fold(0.0, f64::max)
    };
    inputs.iter().map(of).fold(0.0, f64::max)
}

pub(crate) fn rows(extent: Extent) -> Vec<Row> {
    let count = extent.pick(300_u32, 20_000);
    // Half of them evenly, half over all magnitudes.
    let spread = |least: f64, most: f64| {
        let ratio = (most / least).ln();
        (0..count).map(move |i| {
            let share = f64::from(i / 2 + 1) / f64::from(count / 2);
            let size = if i % 2 == 0 { most * share } else { least * (ratio * share).exp() };
            if i % 3 == 0 { -size } else { size }
        })
    };
    let samples = |what: &str| format!("{count} {what}");
    let doubles: Vec<f64> = spread(1e-290, 320.0).collect();
    let singles: Vec<f64> = spread(1e-38, 20.0).map(|a| f64::from(a as f32)).collect();
    let exps = spread(1e-290, 600.0).map(|y| {
        let ((value, less_one), y) = (exponential(Dd::from(y)), many(y));
        let (exact, exact_less_one) = (y.exp(), y.exp_m1());
        error(value, &exact, &exact).max(error(less_one, &exact_less_one, &exact_less_one))
    });
    vec![
        Row::new(
            "reference of f64: tanh and six derivatives",
            samples("in [1e-290, 320]"),
            largest(&doubles, reference_double),
            1e-27,
        ),
        Row::new("reference of f64: exp and exp - 1", samples("in [1e-290, 600]"), exps.fold(0.0, f64::max), 1e-27),
        Row::new(
            "reference of f32: tanh and six derivatives",
            samples("in [1e-38, 20]"),
            largest(&singles, |a| wanted_single(a as f32).map(Dd::from)),
            1e-13,
        ),
    ]
}
