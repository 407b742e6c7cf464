//! Rates of the three products of a layer, one thread, beside matrixmultiply's: a share of the peak that is measured in
//! the same run.
//!
//! `cargo run --release -p nisp-runtime --example gemm_rate [rows ...]`

use nisp_runtime::aligned::AlignedVec;
use nisp_runtime::gemm::{Left, Packed, Right, Shape, Write, gemm};
use nisp_runtime::peak::fma_peak;
use nisp_runtime::simd::{Element, Isa};
use std::time::{Duration, Instant};

/// A matrix where it lies: its first element, and the distances between its rows and columns.
type At<P> = (P, isize, isize);

/// The other library's products, which are not generic over the element type in the same way.
trait Rival: Element {
    /// `C = A B` or, if `add`, `C += A B`, of `[rows, inner, columns]`.
    ///
    /// # Safety
    /// All elements must exist.
    unsafe fn product(shape: [usize; 3], c: At<*mut Self>, add: bool, a: At<*const Self>, b: At<*const Self>);
}

macro_rules! rival {
    ($elem:ident, $gemm:ident) => {
        impl Rival for $elem {
            unsafe fn product(
                [m, k, n]: [usize; 3],
                (c, c_row, c_col): At<*mut Self>,
                add: bool,
                (a, a_row, a_col): At<*const Self>,
                (b, b_row, b_col): At<*const Self>,
            ) {
                let beta = if add { 1.0 } else { 0.0 };
                // SAFETY: as the caller vouches.
                unsafe {
                    matrixmultiply::$gemm(m, k, n, 1.0, a, a_row, a_col, b, b_row, b_col, beta, c, c_row, c_col);
                }
            }
        }
    };
}

rival!(f32, sgemm);
rival!(f64, dgemm);

/// Shortest time of one call, over about a tenth of a second.
fn best(mut work: impl FnMut()) -> f64 {
    let begin = Instant::now();
    let mut best = f64::INFINITY;
    while begin.elapsed() < Duration::from_millis(100) {
        let start = Instant::now();
        work();
        best = best.min(start.elapsed().as_secs_f64());
    }
    best
}

/// A layer's arrays: rows of activations and adjoints, `stride` apart, and square weights.
struct Layer<E> {
    rows: usize,
    width: usize,
    stride: usize,
    x: AlignedVec<E>,
    y: AlignedVec<E>,
    w: AlignedVec<E>,
    gradient: AlignedVec<E>,
}

impl<E: Rival> Layer<E> {
    fn new(rows: usize, width: usize) -> Self {
        // One line more than the width: rows a power of two apart would fight for the same cache sets.
        let stride = width + 64 / size_of::<E>();
        let wavy = |count: usize| {
            let values: Vec<E> = (0..count).map(|i| E::from_f64((i as f64 * 0.37).sin())).collect();
            AlignedVec::from(&*values)
        };
        let (x, y, w) = (wavy(rows * stride), wavy(rows * stride), wavy(width * width));
        Self { rows, width, stride, x, y, w, gradient: AlignedVec::zeros(width * width) }
    }

    /// Seconds of the forward product, the adjoint and the gradient.
    fn ours(&mut self, isa: Isa) -> [f64; 3] {
        let Self { rows, width, stride, .. } = *self;
        let by_weights = Shape { rows, columns: width, inner: width };
        let mut forward = Packed::zeros(isa, width, width);
        forward.pack(Left::transposed(&self.w, width), width);
        let mut adjoint = Packed::zeros(isa, width, width);
        adjoint.pack(Left::rows(&self.w, width), width);
        let x = Left::rows(&self.x, stride);
        let gradient_shape = Shape { rows: width, columns: width, inner: rows };
        [
            best(|| gemm(isa, by_weights, x, Right::Packed(&forward), &mut self.y, stride, Write::SetFromShortSums)),
            best(|| gemm(isa, by_weights, x, Right::Packed(&adjoint), &mut self.y, stride, Write::Set)),
            best(|| {
                let right = Right::Rows { elements: &self.x, stride };
                let left = Left::transposed(&self.y, stride);
                gemm(isa, gradient_shape, left, right, &mut self.gradient, width, Write::Add);
            }),
        ]
    }

    /// The same by the other library.
    fn rival(&mut self) -> [f64; 3] {
        let Self { rows, width, .. } = *self;
        let (stride, across) = (self.stride as isize, self.width as isize);
        let (x, w) = (self.x.as_ptr(), self.w.as_ptr());
        let (y, gradient) = (self.y.as_mut_ptr(), self.gradient.as_mut_ptr());
        let by_weights = [rows, width, width];
        // SAFETY: extents and strides are those of the layer's arrays.
        unsafe {
            [
                best(|| E::product(by_weights, (y, stride, 1), false, (x, stride, 1), (w, 1, across))),
                best(|| E::product(by_weights, (y, stride, 1), false, (x, stride, 1), (w, across, 1))),
                best(|| {
                    let shape = [width, rows, width];
                    E::product(shape, (gradient, across, 1), true, (y.cast_const(), 1, stride), (x, stride, 1));
                }),
            ]
        }
    }
}

fn table<E: Rival>(isa: Isa, heights: &[usize]) {
    let peak = fma_peak::<E>(isa, 1) / 1e9;
    println!("\n{} {}: peak {peak:.0} GF/s; forward / adjoint / gradient in GF/s", E::NAME, isa.name());
    println!("{:>5} {:>5}  {:^26}  {:^17}", "width", "rows", "here (share of peak)", "matrixmultiply");
    for width in [256, 128, 64, 32, 16] {
        for &rows in heights {
            let operations = (2 * rows * width * width) as f64 / 1e9;
            let mut layer = Layer::<E>::new(rows, width);
            let ours = layer.ours(isa).map(|seconds| operations / seconds);
            let plain = layer.rival().map(|seconds| operations / seconds);
            let share = ours.iter().sum::<f64>() / 3.0 / peak;
            let rates = |[a, b, c]: [f64; 3]| format!("{a:>5.0} {b:>5.0} {c:>5.0}");
            println!("{width:>5} {rows:>5}  {}   ({share:.2})  {}", rates(ours), rates(plain));
        }
    }
}

fn main() {
    let mut heights: Vec<usize> = std::env::args().skip(1).filter_map(|rows| rows.parse().ok()).collect();
    if heights.is_empty() {
        heights = vec![72, 108, 144, 176];
    }
    for isa in Isa::available().filter(|&isa| isa != Isa::SCALAR) {
        table::<f32>(isa, &heights);
        table::<f64>(isa, &heights);
    }
}
