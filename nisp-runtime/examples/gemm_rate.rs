//! Rates of the three products of a layer, one thread, beside matrixmultiply's: a share of the peak that is measured in the
//! same run.
//!
//! `cargo run --release -p nisp-runtime --example gemm_rate [rows ...]`

use nisp_runtime::aligned::AlignedVec;
use nisp_runtime::gemm::{Left, Packed, Right, Shape, Write, gemm};
use nisp_runtime::peak::fma_peak;
use nisp_runtime::simd::{Element, Isa};
use std::time::{Duration, Instant};

/// A matrix as another library takes it: its first element, and the distances between rows and between columns.
type View<T> = (T, [isize; 2]);

/// The other library's product, which is not generic over the element type in the same way.
trait Rival: Element {
    /// `C = A B` or, if `add`, `C += A B` by matrixmultiply, for `[rows, inner, columns]`.
    ///
    /// # Safety
    /// The views must hold what the extents reach.
    unsafe fn product(extents: [usize; 3], c: View<*mut Self>, add: bool, a: View<*const Self>, b: View<*const Self>);
}

macro_rules! rival {
    ($elem:ident, $gemm:ident) => {
        impl Rival for $elem {
            unsafe fn product(
                [m, k, n]: [usize; 3],
                (c, [c_row, c_column]): View<*mut Self>,
                add: bool,
                (a, [a_row, a_column]): View<*const Self>,
                (b, [b_row, b_column]): View<*const Self>,
            ) {
                let beta = if add { 1.0 } else { 0.0 };
                // SAFETY: the caller vouches for the views.
                unsafe {
                    matrixmultiply::$gemm(
                        m, k, n, 1.0, a, a_row, a_column, b, b_row, b_column, beta, c, c_row, c_column,
                    );
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

    /// The same by another library.
    fn rival(&mut self) -> [f64; 3] {
        let Self { rows, width, stride, .. } = *self;
        let (long, across) = (stride as isize, width as isize);
        let (x, w) = ((self.x.as_ptr(), [long, 1]), self.w.as_ptr());
        let y = self.y.as_mut_ptr();
        let gradient = (self.gradient.as_mut_ptr(), [across, 1]);
        let by_weights = [rows, width, width];
        // SAFETY: extents and distances are those of the layer's arrays.
        unsafe {
            [
                best(|| E::product(by_weights, (y, [long, 1]), false, x, (w, [1, across]))),
                best(|| E::product(by_weights, (y, [long, 1]), false, x, (w, [across, 1]))),
                best(|| E::product([width, rows, width], gradient, true, (y.cast_const(), [1, long]), x)),
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
