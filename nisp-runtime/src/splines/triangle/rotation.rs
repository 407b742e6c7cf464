//! Rotations (Givens), and sums of products.

/// A sum of products, four of them side by side.
#[inline(always)]
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (&a[..a.len().min(b.len())], &b[..a.len().min(b.len())]);
    let (pairs, rest) = (a.chunks_exact(4).zip(b.chunks_exact(4)), a.len() / 4 * 4);
    let mut sums = [0.0; 4];
    for (a, b) in pairs {
        (0..4).for_each(|lane| sums[lane] += a[lane] * b[lane]);
    }
    let tail: f64 = a[rest..].iter().zip(&b[rest..]).map(|(a, b)| a * b).sum();
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + tail
}

/// Cosine and sine that turn `(a, b)` into `(r, 0)`.
#[inline(always)]
pub(super) fn rotation(a: f64, b: f64) -> (f64, f64) {
    let square = a * a + b * b;
    // Squares of tiny numbers vanish.
    let r = if square > f64::MIN_POSITIVE / f64::EPSILON { square.sqrt() } else { a.hypot(b) };
    (a / r, b / r)
}

#[inline(always)]
pub(super) fn turned(cosine: f64, sine: f64, a: f64, b: f64) -> (f64, f64) {
    (cosine * a + sine * b, cosine * b - sine * a)
}

#[inline(always)]
pub(super) fn turn(cosine: f64, sine: f64, a: &mut [f64], b: &mut [f64]) {
    for (a, b) in a.iter_mut().zip(b) {
        (*a, *b) = turned(cosine, sine, *a, *b);
    }
}
