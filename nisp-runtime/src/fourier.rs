//! The cosine transform of a record of any length, in a time that is nearly linear in the record.

use std::f64::consts::PI;

use nalgebra::Complex;

/// Squares of the coefficients of cosines with 0, 1, 2, ... half waves over the record (discrete cosine transform of the second
/// kind, orthonormal). They sum to the sum of the values' squares.
pub(crate) fn cosine_powers(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    // Even places upwards, then odd places downwards: the cosine transform of a record is the Fourier transform of this
    // order, turned by a quarter wave at most (Makhoul 1980).
    let upwards = values.iter().step_by(2);
    let downwards = values.iter().skip(1).step_by(2).rev();
    let mut order: Vec<Complex<f64>> = upwards.chain(downwards).map(|&x| Complex::new(x, 0.0)).collect();
    transform(&mut order);
    let power = |(mode, wave): (usize, Complex<f64>)| {
        let turned = (wave * turn(-PI * mode as f64 / (2 * count) as f64)).re;
        turned * turned * if mode == 0 { 1.0 } else { 2.0 } / count as f64
    };
    order.into_iter().enumerate().map(power).collect()
}

/// The Fourier transform `sum_j values[j] exp(-2 pi i j k / n)` of any length, as a convolution with a chirp (Bluestein 1970):
/// `2 j k = j^2 + k^2 - (k - j)^2`.
fn transform(values: &mut [Complex<f64>]) {
    let count = values.len();
    if count < 2 {
        return;
    }
    let length = (2 * count - 1).next_power_of_two();
    // Whole turns are taken away from the square first: the angle keeps its digits.
    let chirp = |k: usize| turn(-PI * ((k as u128 * k as u128) % (2 * count as u128)) as f64 / count as f64);
    let chirps: Vec<Complex<f64>> = (0..count).map(chirp).collect();
    let mut signal = vec![Complex::default(); length];
    let mut kernel = vec![Complex::default(); length];
    for (k, (value, chirp)) in values.iter().zip(&chirps).enumerate() {
        signal[k] = value * chirp;
        kernel[k] = chirp.conj();
        kernel[(length - k) % length] = chirp.conj();
    }
    halving(&mut signal, -1.0);
    halving(&mut kernel, -1.0);
    signal.iter_mut().zip(&kernel).for_each(|(s, k)| *s *= k);
    halving(&mut signal, 1.0);
    for ((value, found), chirp) in values.iter_mut().zip(&signal).zip(&chirps) {
        *value = found * chirp / length as f64;
    }
}

/// The Fourier transform of a power of two of values, with this sign of the exponent (Cooley and Tukey 1965).
fn halving(values: &mut [Complex<f64>], sign: f64) {
    let count = values.len();
    if count < 2 {
        return;
    }
    let bits = count.trailing_zeros();
    for at in 0..count {
        let mirrored = at.reverse_bits() >> (usize::BITS - bits);
        if at < mirrored {
            values.swap(at, mirrored);
        }
    }
    let waves: Vec<Complex<f64>> = (0..count / 2).map(|k| turn(sign * 2.0 * PI * k as f64 / count as f64)).collect();
    let mut half = 1;
    while half < count {
        let stride = count / (2 * half);
        for block in values.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for ((a, b), wave) in low.iter_mut().zip(high).zip(waves.iter().step_by(stride)) {
                let turned = *b * wave;
                (*a, *b) = (*a + turned, *a - turned);
            }
        }
        half *= 2;
    }
}

/// The complex number of magnitude one at an angle.
fn turn(angle: f64) -> Complex<f64> {
    let (sine, cosine) = angle.sin_cos();
    Complex::new(cosine, sine)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers without a pattern.
    fn record(count: usize) -> Vec<f64> {
        (0..count).map(|at| ((at * 7919 + 13) % 101) as f64 / 101.0 - 0.4).collect()
    }

    /// The sums of the definition, for lengths that are powers of two, primes and neither.
    #[test]
    fn powers_are_those_of_the_definition() {
        for count in [1, 2, 3, 4, 7, 12, 64, 97, 200] {
            let values = record(count);
            for (mode, found) in cosine_powers(&values).into_iter().enumerate() {
                let wave =
                    |(at, value): (usize, &f64)| value * (PI * mode as f64 * (at as f64 + 0.5) / count as f64).cos();
                let sum: f64 = values.iter().enumerate().map(wave).sum();
                let exact = sum * sum * if mode == 0 { 1.0 } else { 2.0 } / count as f64;
                assert!((found - exact).abs() < 1e-12 * count as f64, "{count}, {mode}: {found} {exact}");
            }
        }
        assert!(cosine_powers(&[]).is_empty());
    }

    /// A cosine of a whole number of half waves has one coefficient: half of its amplitude's square times the length.
    #[test]
    fn a_long_cosine_has_one_coefficient() {
        let (count, half_waves) = (100_003, 771);
        let wave = |at: usize| (PI * half_waves as f64 * (at as f64 + 0.5) / count as f64).cos();
        let powers = cosine_powers(&(0..count).map(wave).collect::<Vec<_>>());
        let whole = count as f64 / 2.0;
        assert!((powers[half_waves] / whole - 1.0).abs() < 1e-10, "{}", powers[half_waves]);
        assert!(powers.iter().sum::<f64>() - powers[half_waves] < 1e-10 * whole);
    }
}
