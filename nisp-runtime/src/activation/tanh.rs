//! tanh and its derivatives, vectorised.
//!
//! Everything comes from `e = exp(-2|a|)`: with t = tanh a, the slope s = t' is `4 e / (1 + e)^2`. The textbook `1 - t^2`
//! has no correct digit left past |a| = 9 (f32) or 19 (f64), where t rounds to one; here s stays good to a few units in
//! the last place down to the denormals. All higher derivatives are polynomials in s, times t for the even ones.

use crate::simd::Simd;

/// Highest number of derivatives that [`derivatives`] gives, the function itself included.
pub const MAX_DERIVATIVES: usize = 10;

/// The polynomials have at most this many coefficients.
const TERMS: usize = MAX_DERIVATIVES / 2 + 1;

/// Row n holds the polynomial P of the n-th derivative, lowest power first: P(s) for odd n, t P(s) for even n.
const POLYNOMIALS: [[i64; TERMS]; MAX_DERIVATIVES] = polynomials();

/// Differentiates with t' = s, s' = -2 t s, t^2 = 1 - s: `(t P)' = s P - 2 s (1 - s) P'` and `P' s' = t (-2 s P')`.
const fn polynomials() -> [[i64; TERMS]; MAX_DERIVATIVES] {
    let mut table = [[0; TERMS]; MAX_DERIVATIVES];
    table[0][0] = 1;
    let mut n = 0;
    while n + 1 < MAX_DERIVATIVES {
        let even = n % 2 == 0;
        let mut power = 0;
        while power < TERMS {
            let c = table[n][power];
            let slope = 2 * power as i64 * c;
            table[n + 1][power] -= slope;
            if even && c != 0 {
                table[n + 1][power + 1] += c + slope;
            }
            power += 1;
        }
        n += 1;
    }
    table
}

/// What of the exponential depends on the element type.
struct Exponential<const TERMS: usize> {
    /// ln(2) / 2 in two parts; the first has so few bits that its product with any exponent is exact.
    half_ln2: [f64; 2],
    /// Past this argument 4 exp(-2 a) is less than half of the least denormal.
    largest: f64,
    /// Minimax coefficients of Q in `(1 - exp(-2 u)) / 2 = u - u^2 Q(u)` for |u| <= ln(2)/4, lowest power first: relative
    /// errors 2^-26 and 2^-55.
    series: [f64; TERMS],
}

const SINGLE: Exponential<5> = Exponential {
    half_ln2: [0.346_679_687_5, -1.060_972_200_273_452_9e-4],
    largest: 53.0,
    series: [
        0.999_999_962_984_245_6,
        -0.666_661_736_737_256_5,
        0.333_337_606_878_548_4,
        -0.133_864_763_018_579_33,
        0.044_424_020_150_229_9,
    ],
};

const DOUBLE: Exponential<10> = Exponential {
    half_ln2: [0.346_573_590_184_561_9, 9.541_074_646_352_939e-11],
    largest: 374.0,
    series: [
        1.000_000_000_000_001,
        -0.666_666_666_666_663_5,
        0.333_333_333_332_611_56,
        -0.133_333_333_334_234_72,
        0.044_444_444_581_353_64,
        -0.012_698_412_620_070_203,
        3.174_592_657_509_685_5e-3,
        -7.054_696_331_449_864e-4,
        1.414_456_056_732_026_4e-4,
        -2.565_511_416_117_023_4e-5,
    ],
};

/// e = exp(-2 a) for a >= 0, in parts of which each use takes the best.
struct Decay<V> {
    /// e = mantissa 2^power.
    mantissa: V,
    power: V,
    /// 2^power
    scale: V,
    /// h = (1 - e) / 2, and what rounding took from it.
    half: V,
    rest: V,
}

#[inline(always)]
fn decay<V: Simd, const TERMS: usize>(a: V, constants: &Exponential<TERMS>) -> Decay<V> {
    // Operands in this order so that a NaN passes.
    let a = V::lit(constants.largest).min(a);
    // exp(-2 a) = 2^n exp(-2 u)
    let n = a.mul(V::lit(-2.0 * std::f64::consts::LOG2_E)).round();
    let u = n.mul_add(V::lit(constants.half_ln2[0]), a);
    let u = n.mul_add(V::lit(constants.half_ln2[1]), u);
    let mut q = V::lit(constants.series[TERMS - 1]);
    for &c in constants.series[..TERMS - 1].iter().rev() {
        q = q.mul_add(u, V::lit(c));
    }
    let part = u.mul(u).neg_mul_add(q, u);
    let scale = V::lit(1.0).scale2(n);
    let shift = scale.neg_mul_add(V::lit(0.5), V::lit(0.5));
    let half = scale.mul_add(part, shift);
    let rest = scale.mul_sub(part, half.sub(shift));
    // Two roundings more than a fused part has.
    let part_rest = u.sub(part).sub(u.mul(u).mul(q));
    let rest = if V::FUSED { rest } else { scale.mul_add(part_rest, rest) };
    Decay { mantissa: part.neg_mul_add(V::lit(2.0), V::lit(1.0)), power: n, scale, half, rest }
}

/// `(tanh a, tanh' a)`, of which [`derivatives`] makes `D` functions.
///
/// At most 1.5 (in double precision 2) and 6 units in the last place off; good down to the denormals. At infinity (1 or
/// -1, 0); NaN gives NaN.
#[inline(always)]
pub fn tanh_and_slope<V: Simd, const D: usize>(a: V) -> (V, V) {
    let size = a.abs();
    let single = size_of::<V::Elem>() == 4;
    let decay = if single { decay(size, &SINGLE) } else { decay(size, &DOUBLE) };
    let Decay { mantissa, power, scale, half, rest } = decay;
    // With h = (1 - e) / 2: t = h / (1 - h).
    let inverse = V::lit(1.0).div(V::lit(1.0).sub(half));
    let quotient = half.mul(inverse);
    // h - q (1 - h), of which the first difference is exact.
    let difference = half.sub(quotient);
    let error =
        if is_steep::<D>() { exact_mul_add(quotient, half, difference) } else { quotient.mul_add(half, difference) };
    let error = if single || is_steep::<D>() { quotient.mul_add(rest, error).add(rest) } else { error };
    let t = error.mul_add(inverse, quotient);
    let s = if is_steep::<D>() {
        // Until s is small, 1 - t^2 is the more accurate: t is known to more than its digits.
        let t_rest = error.mul_sub(inverse, t.sub(quotient));
        let near = t_rest.neg_mul_add(t.add(t), exact_mul_add(t.neg(), t, V::lit(1.0)));
        // 4 e / (1 + e)^2, by 1 + t = 2 / (1 + e): t is known better than the inverse.
        let sum = t.add(V::lit(1.0));
        V::select(size.less(V::lit(4.0)), near, mantissa.mul(sum.mul(sum)).scale2(power))
    } else {
        // (1 - t) (1 + t), with 1 - t = e / (1 - h).
        let less = scale.mul(mantissa).mul(inverse);
        less.mul_add(t, less)
    };
    (t.copysign(a), s)
}

/// True if a derivative among the first `D - 1` may magnify the slope's error more than a little: the fourth and fifth
/// have zeros where they are steep. Fields of second order do without them, adjoint included.
const fn is_steep<const D: usize>() -> bool {
    D > 4
}

/// `a b + c` of numbers whose sum is much smaller than they are, and the product not rounded.
#[inline(always)]
fn exact_mul_add<V: Simd>(a: V, b: V, c: V) -> V {
    if V::FUSED {
        return a.mul_add(b, c);
    }
    // Factors in halves, whose products are exact (Dekker 1971).
    let half_of_the_bits = if size_of::<V::Elem>() == 4 { 4097.0 } else { 134_217_729.0 };
    let halves = |x: V| {
        let shifted = x.mul(V::lit(half_of_the_bits));
        let high = shifted.sub(shifted.sub(x));
        (high, x.sub(high))
    };
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let product = a.mul(b);
    let rest = a_high.mul(b_high).sub(product).add(a_high.mul(b_low)).add(a_low.mul(b_high)).add(a_low.mul(b_low));
    product.add(c).add(rest)
}

/// `tanh` and its first `D - 1` derivatives, from t = tanh a and s = tanh' a as [`tanh_and_slope`] gives them.
///
/// `[t, s, -2 t s, s (4 - 6 s), 8 t s (3 s - 1), ...]`; `D` is at most [`MAX_DERIVATIVES`] (checked by the compiler).
#[inline(always)]
pub fn derivatives<V: Simd, const D: usize>(t: V, s: V) -> [V; D] {
    const { assert!(D <= MAX_DERIVATIVES) };
    let ts = t.mul(s);
    let mut phi = [t; D];
    macro_rules! each {
        ($($n:literal times $factor:ident),*) => {
            $(if D > $n {
                phi[$n] = over_s::<V, $n>(s, $factor);
            })*
        };
    }
    each!(1 times s, 2 times ts, 3 times s, 4 times ts, 6 times ts, 7 times s, 8 times ts, 9 times s);
    if D > 5 {
        // s (120 s^2 - 120 s + 16) from the middle of the parabola, which is the same for s and 1 - s = t^2: the smaller is
        // known better.
        let from_middle = s.min(t.mul(t)).sub(V::lit(0.5));
        phi[5] = from_middle.mul(V::lit(120.0)).mul_sub(from_middle, V::lit(14.0)).mul(s);
    }
    phi
}

/// The polynomial of the `N`-th derivative at `s`, its common factor s replaced by `factor`. Unrolled by hand: at low
/// optimisation levels a loop would stay one.
#[inline(always)]
fn over_s<V: Simd, const N: usize>(s: V, factor: V) -> V {
    let top = const { degree(N) };
    if top == 1 && POLYNOMIALS[N][1] == 1 {
        return factor;
    }
    let mut value = V::lit(const { POLYNOMIALS[N][degree(N)] as f64 });
    macro_rules! horner {
        ($($power:literal)*) => {
            $(if top > $power {
                value = value.mul_add(s, V::lit(const { POLYNOMIALS[N][$power] as f64 }));
            })*
        };
    }
    horner!(4 3 2 1);
    value.mul(factor)
}

/// Highest power of s in the `n`-th derivative.
const fn degree(n: usize) -> usize {
    let mut degree = TERMS - 1;
    while POLYNOMIALS[n][degree] == 0 {
        degree -= 1;
    }
    degree
}
