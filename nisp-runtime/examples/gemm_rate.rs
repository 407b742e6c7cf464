//! Rates of the three products of a layer, one thread, beside faer's and matrixmultiply's: a share of the peak that is
//! measured in the same run.
//!
//! `cargo run --release -p nisp-runtime --example gemm_rate [rows ...]`

use faer::linalg::matmul::matmul;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use nisp_runtime::aligned::AlignedVec;
use nisp_runtime::gemm::{Left, Packed, Right, Shape, Write, gemm};
use nisp_runtime::peak::fma_peak;
use nisp_runtime::simd::{Element, Isa};
use std::time::{Duration, Instant};

/// The other libraries' products, which are not generic over the element type in the same way.
trait Rival: Element {
    /// `C = A B` or, if `add`, `C += A B` by faer.
    fn faer(c: MatMut<Self>, add: bool, a: MatRef<Self>, b: MatRef<Self>);
    /// The same by matrixmultiply.
    fn matrixmultiply(c: MatMut<Self>, add: bool, a: MatRef<Self>, b: MatRef<Self>);
}

macro_rules! rival {
    ($elem:ident, $gemm:ident) => {
        impl Rival for $elem {
            fn faer(c: MatMut<Self>, add: bool, a: MatRef<Self>, b: MatRef<Self>) {
                matmul(c, if add { Accum::Add } else { Accum::Replace }, a, b, 1.0, Par::Seq);
            }
            fn matrixmultiply(c: MatMut<Self>, add: bool, a: MatRef<Self>, b: MatRef<Self>) {
                let (beta, a_at, b_at) = (if add { 1.0 } else { 0.0 }, a.as_ptr(), b.as_ptr());
                let ((a_row, a_col), (b_row, b_col)) =
                    ((a.row_stride(), a.col_stride()), (b.row_stride(), b.col_stride()));
                let (m, k, n, c_row, c_col) = (a.nrows(), a.ncols(), b.ncols(), c.row_stride(), c.col_stride());
                let c_at = c.as_ptr_mut();
                // SAFETY: extents and strides are those of faer's views.
                unsafe {
                    matrixmultiply::$gemm(
                        m, k, n, 1.0, a_at, a_row, a_col, b_at, b_row, b_col, beta, c_at, c_row, c_col,
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
    fn rival(&mut self, product: fn(MatMut<E>, bool, MatRef<E>, MatRef<E>)) -> [f64; 3] {
        let Self { rows, width, stride, .. } = *self;
        let x = MatRef::from_row_major_slice_with_stride(&self.x, rows, width, stride);
        let w = MatRef::from_row_major_slice(&self.w, width, width);
        // Not `from_row_major_slice_with_stride_mut`: in faer 0.24 it swaps the strides and writes past the slice.
        let mut y = MatMut::from_column_major_slice_with_stride_mut(&mut self.y, width, rows, stride).transpose_mut();
        let mut gradient = MatMut::from_row_major_slice_mut(&mut self.gradient, width, width);
        [
            best(|| product(y.rb_mut(), false, x, w.transpose())),
            best(|| product(y.rb_mut(), false, x, w)),
            best(|| product(gradient.rb_mut(), true, y.rb().transpose(), x)),
        ]
    }
}

fn table<E: Rival>(isa: Isa, heights: &[usize]) {
    let peak = fma_peak::<E>(isa, 1) / 1e9;
    println!("\n{} {}: peak {peak:.0} GF/s; forward / adjoint / gradient in GF/s", E::NAME, isa.name());
    println!("{:>5} {:>5}  {:^26}  {:^17}  {:^17}", "width", "rows", "here (share of peak)", "faer", "matrixmultiply");
    for width in [256, 128, 64, 32, 16] {
        for &rows in heights {
            let operations = (2 * rows * width * width) as f64 / 1e9;
            let mut layer = Layer::<E>::new(rows, width);
            let ours = layer.ours(isa).map(|seconds| operations / seconds);
            let faer = layer.rival(E::faer).map(|seconds| operations / seconds);
            let plain = layer.rival(E::matrixmultiply).map(|seconds| operations / seconds);
            let share = ours.iter().sum::<f64>() / 3.0 / peak;
            let rates = |[a, b, c]: [f64; 3]| format!("{a:>5.0} {b:>5.0} {c:>5.0}");
            println!("{width:>5} {rows:>5}  {}   ({share:.2})  {}  {}", rates(ours), rates(faer), rates(plain));
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
