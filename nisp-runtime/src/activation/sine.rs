//! Sine and cosine, vectorised.
//!
//! `a = n pi/2 + r` with |r| <= pi/4. Multiples of pi/2 are taken off in three parts, the first two of which have so few
//! bits that their products are exact (Cody and Waite 1980). The quarter `n` says which of sin r and cos r is which, and
//! with which sign.

use crate::simd::Simd;

/// What depends on the element type.
struct Constants<const TERMS: usize> {
    /// pi/2 in three parts.
    quarter: [f64; 3],
    /// P in `sin r = r + r^3 P(r^2)`, lowest power first, nearly minimax: relative errors 2^-26 and 2^-55.
    sine: [f64; TERMS],
    /// Q in `cos r = 1 - r^2/2 + r^4 Q(r^2)`, likewise: 2^-29 and 2^-59.
    cosine: [f64; TERMS],
}

const SINGLE: Constants<3> = Constants {
    quarter: [1.570_312_5, 4.837_512_969_970_703e-4, 7.549_789_954_891_882e-8],
    sine: [-0.166_666_646_017_541_14, 8.332_736_559_177_13e-3, -1.958_537_320_669_302e-4],
    cosine: [0.041_666_664_598_827_98, -1.388_829_130_055_693_3e-3, 2.454_541_907_832_953_5e-5],
};

const DOUBLE: Constants<6> = Constants {
    quarter: [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21],
    sine: [
        -0.166_666_666_666_666_66,
        8.333_333_333_330_827e-3,
        -1.984_126_983_657_571e-4,
        2.755_731_600_817_155e-6,
        -2.505_111_227_257_324_3e-8,
        1.591_672_619_388_933_6e-10,
    ],
    cosine: [
        0.041_666_666_666_666_664,
        -1.388_888_888_888_732_2e-3,
        2.480_158_729_865_129_2e-5,
        -2.755_731_721_268_659e-7,
        2.087_613_402_409_014_5e-9,
        -1.138_175_465_366_293_7e-11,
    ],
};

/// `(sin a, cos a)`
///
/// For |a| below 1e4 they are at most 2 units in the last place off. Values below a thousandth are at most as far off as a
/// thousandth. For larger |a| digits are lost, but the result stays finite. NaN and infinities give NaN.
#[inline(always)]
pub fn sine_and_cosine<V: Simd>(a: V) -> (V, V) {
    if size_of::<V::Elem>() == 4 { of(a, &SINGLE) } else { of(a, &DOUBLE) }
}

#[inline(always)]
fn of<V: Simd, const TERMS: usize>(a: V, constants: &Constants<TERMS>) -> (V, V) {
    let n = a.mul(V::lit(std::f64::consts::FRAC_2_PI)).round();
    let r = constants.quarter.iter().fold(a, |r, &part| n.neg_mul_add(V::lit(part), r));
    // Only where digits are lost is it out of these bounds. Operands in this order so that a NaN passes.
    let r = V::lit(1.0).min(V::lit(-1.0).max(r));
    let square = r.mul(r);
    let sine = polynomial(&constants.sine, square).mul(square).mul_add(r, r);
    let cosine = polynomial(&constants.cosine, square).mul_sub(square, V::lit(0.5)).mul_add(square, V::lit(1.0));
    // n = 2 halves + quarter, and quarter is -1, 0 or 1.
    let halves = n.mul(V::lit(0.5)).round();
    let quarter = halves.neg_mul_add(V::lit(2.0), n);
    let parity = halves.mul(V::lit(0.5)).round().neg_mul_add(V::lit(2.0), halves);
    // (-1)^halves
    let sign = parity.mul(parity).neg_mul_add(V::lit(2.0), V::lit(1.0));
    let turned = V::lit(0.5).less(quarter.abs());
    let turn = quarter.mul(sign);
    (V::select(turned, cosine.mul(turn), sine.mul(sign)), V::select(turned, sine.mul(turn).neg(), cosine.mul(sign)))
}

#[inline(always)]
fn polynomial<V: Simd, const TERMS: usize>(coefficients: &[f64; TERMS], x: V) -> V {
    let mut value = V::lit(coefficients[TERMS - 1]);
    for &c in coefficients[..TERMS - 1].iter().rev() {
        value = value.mul_add(x, V::lit(c));
    }
    value
}

/// `sin a` and its first `D - 1` derivatives, from `sin a` and `cos a`: `[sin a, cos a, -sin a, -cos a, sin a, ...]`.
#[inline(always)]
pub fn derivatives<V: Simd, const D: usize>(sine: V, cosine: V) -> [V; D] {
    let mut phi = [sine; D];
    for (n, phi) in phi.iter_mut().enumerate() {
        *phi = [sine, cosine, sine.neg(), cosine.neg()][n % 4];
    }
    phi
}
