//! The largest errors of tanh and its slope over every f32 from zero to 110, and their cost per element.
//!
//! `cargo run --release -p nisp-runtime --example tanh_errors [stride]`; the full run (stride 1) takes a minute.

use nisp_runtime::activation::tanh::{derivatives, tanh_and_slope};
use nisp_runtime::simd::{Element, Isa, Kernel, Simd, dispatch};
use std::time::Instant;

/// Elements in a piece: a multiple of every vector, and small enough for the nearest cache.
const PIECE: usize = 1024;

/// tanh and slope of a piece.
struct Evaluate<'a, E> {
    a: &'a [E],
    t: &'a mut [E],
    s: &'a mut [E],
    /// Add the second to fifth derivative to the slope: for their cost, and that of the slope that they need.
    higher: bool,
}

impl<E: Element> Kernel<E> for Evaluate<'_, E> {
    type Output = ();
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) {
        let pieces = self.a.chunks_exact(V::LANES).zip(self.t.chunks_exact_mut(V::LANES));
        for ((a, t), s) in pieces.zip(self.s.chunks_exact_mut(V::LANES)) {
            // SAFETY: each chunk has LANES elements.
            unsafe {
                let (mut value, mut slope) = tanh_and_slope::<V, 4>(V::load(a.as_ptr()));
                if self.higher {
                    (value, slope) = tanh_and_slope::<V, 6>(V::load(a.as_ptr()));
                    let [_, first, second, third, fourth, fifth] = derivatives::<V, 6>(value, slope);
                    slope = first.add(second).add(third.add(fourth).add(fifth));
                }
                value.store(t.as_mut_ptr());
                slope.store(s.as_mut_ptr());
            }
        }
    }
}

/// Error in units of the last place of the nearest f32.
fn ulps(got: f32, want: f64) -> f64 {
    let near = (want as f32).abs().max(f32::MIN_POSITIVE);
    let below = f32::from_bits(near.to_bits() - 1);
    (f64::from(got) - want).abs() / f64::from(near - below)
}

/// Largest error so far, and where.
#[derive(Default)]
struct Worst {
    ulps: f64,
    at: f32,
}

impl Worst {
    fn add(&mut self, ulps: f64, at: f32) {
        if ulps > self.ulps {
            *self = Self { ulps, at };
        }
    }
}

fn errors(isa: Isa, stride: usize) {
    let (mut tanh, mut slope) = (Worst::default(), Worst::default());
    let mut inputs = (0..110.0_f32.to_bits()).step_by(stride).map(f32::from_bits);
    let (mut t, mut s) = (vec![0.0; PIECE], vec![0.0; PIECE]);
    loop {
        let mut a: Vec<f32> = inputs.by_ref().take(PIECE).collect();
        let count = a.len();
        if count == 0 {
            break;
        }
        a.resize(PIECE, 0.0);
        dispatch(isa, Evaluate { a: &a, t: &mut t, s: &mut s, higher: false });
        for (i, &a) in a[..count].iter().enumerate() {
            let e = (-2.0 * f64::from(a)).exp();
            tanh.add(ulps(t[i], f64::from(a).tanh()), a);
            slope.add(ulps(s[i], 4.0 * e / ((1.0 + e) * (1.0 + e))), a);
        }
    }
    println!(
        "{:>6}: tanh {:.2} ulp at {:e}, slope {:.2} ulp at {:e}",
        isa.name(),
        tanh.ulps,
        tanh.at,
        slope.ulps,
        slope.at
    );
}

fn cost<E: Element>(isa: Isa) {
    let a: Vec<E> = (0..PIECE).map(|i| E::from_f64(i as f64 * 5e-3 - 2.5)).collect();
    let (mut t, mut s) = (a.clone(), a.clone());
    let mut nanoseconds = [false, true].map(|higher| {
        let mut best = f64::INFINITY;
        for _ in 0..5000 {
            let start = Instant::now();
            dispatch(isa, Evaluate { a: &a, t: &mut t, s: &mut s, higher });
            best = best.min(start.elapsed().as_secs_f64() * 1e9 / PIECE as f64);
        }
        best
    });
    nanoseconds[1] -= nanoseconds[0];
    let [first, more] = nanoseconds;
    println!(
        "{:>6} {}: {first:.2} ns an element, {more:.2} ns more for the second to fifth derivative",
        isa.name(),
        E::NAME
    );
}

fn main() {
    let stride = std::env::args().nth(1).and_then(|stride| stride.parse().ok()).unwrap_or(1);
    for isa in Isa::available() {
        cost::<f32>(isa);
        cost::<f64>(isa);
    }
    for isa in Isa::available() {
        errors(isa, stride);
    }
}
