//! Products of all shapes and strides against a triple loop in f64.

use nisp_runtime::gemm::{Left, Packed, RUN, Right, Shape, Write, gemm};
use nisp_runtime::real::Real;
use nisp_runtime::simd::{Element, Isa};

/// Numbers between -1 and 1 without a pattern that sums could hide in.
fn noise<E: Element>(count: usize, seed: u64) -> Vec<E> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    (0..count)
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            E::from_f64((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
        })
        .collect()
}

/// How the factors lie in memory.
#[derive(Clone, Copy, Debug)]
struct Layout {
    transposed: bool,
    packed: bool,
    write: Write,
    pad: usize,
}

/// One product by `gemm`; columns beyond the shape in the rows of C hold a mark that must survive.
fn product<E: Element>(isa: Isa, shape: Shape, layout: Layout) -> (Vec<E>, usize) {
    let Shape { rows, columns, inner } = shape;
    let (a_rows, a_columns) = if layout.transposed { (inner, rows) } else { (rows, inner) };
    let a_stride = a_columns + layout.pad;
    let a = noise::<E>(a_rows * a_stride, 1);
    let left = if layout.transposed { Left::transposed(&a, a_stride) } else { Left::rows(&a, a_stride) };
    let b_stride = columns + layout.pad;
    let b = noise::<E>(inner * b_stride, 2);
    let c_stride = columns + layout.pad;
    let mut c = noise::<E>(rows * c_stride, 3);
    let mut packed = Packed::zeros(isa, inner, columns);
    let right = if layout.packed {
        packed.pack(Left::rows(&b, b_stride), columns);
        Right::Packed(&packed)
    } else {
        Right::Rows { elements: &b, stride: b_stride }
    };
    gemm(isa, shape, left, right, &mut c, c_stride, layout.write);
    (c, c_stride)
}

/// The same by definition.
fn plain<E: Element>(shape: Shape, layout: Layout) -> Vec<f64> {
    let Shape { rows, columns, inner } = shape;
    let (a_rows, a_columns) = if layout.transposed { (inner, rows) } else { (rows, inner) };
    let (a_stride, b_stride, c_stride) = (a_columns + layout.pad, columns + layout.pad, columns + layout.pad);
    let (a, b) = (noise::<E>(a_rows * a_stride, 1), noise::<E>(inner * b_stride, 2));
    let mut c: Vec<f64> = noise::<E>(rows * c_stride, 3).into_iter().map(Real::to_f64).collect();
    for i in 0..rows {
        for j in 0..columns {
            let element = |k: usize| if layout.transposed { a[k * a_stride + i] } else { a[i * a_stride + k] };
            let sum: f64 = (0..inner).map(|k| element(k).to_f64() * b[k * b_stride + j].to_f64()).sum();
            let before = if layout.write == Write::Add { c[i * c_stride + j] } else { 0.0 };
            c[i * c_stride + j] = before + sum;
        }
    }
    c
}

fn compare<E: Element>(isa: Isa, shape: Shape, layout: Layout) {
    let (got, stride) = product::<E>(isa, shape, layout);
    let want = plain::<E>(shape, layout);
    let bound = E::EPSILON.to_f64() * (shape.inner as f64 + 4.0);
    for (at, (got, want)) in got.iter().zip(&want).enumerate() {
        let (i, j) = (at / stride, at % stride);
        let bound = if j < shape.columns { bound } else { 0.0 };
        let error = (got.to_f64() - want).abs();
        assert!(error <= bound, "{} {} {shape:?} {layout:?} at ({i}, {j}): {got} for {want}", E::NAME, isa.name());
    }
}

fn every_layout() -> Vec<Layout> {
    let mut all = Vec::new();
    for bits in 0..24 {
        all.push(Layout {
            transposed: bits & 1 != 0,
            packed: bits & 2 != 0,
            pad: if bits & 4 != 0 { 5 } else { 0 },
            write: [Write::Set, Write::Add, Write::SetFromShortSums][bits / 8],
        });
    }
    all
}

fn every_shape<E: Element>() {
    for isa in Isa::available() {
        let lanes = isa.lanes::<E>();
        // Every height of a block, several blocks, odd and even numbers of vectors, and more than one run.
        let heights = (1..=17).chain([28, 29, 43, 71]);
        for rows in heights {
            for vectors in [1, 2, 3] {
                for inner in [1, 2, 7, 33] {
                    for layout in every_layout() {
                        compare::<E>(isa, Shape { rows, columns: vectors * lanes, inner }, layout);
                    }
                }
            }
        }
        for inner in [RUN, RUN + 1, 2 * RUN + 3] {
            for layout in every_layout() {
                compare::<E>(isa, Shape { rows: 15, columns: 3 * lanes, inner }, layout);
            }
        }
    }
}

#[test]
fn single_precision_products_are_right() {
    every_shape::<f32>();
}

#[test]
fn double_precision_products_are_right() {
    every_shape::<f64>();
}

/// A tenth, which no type of few bits holds, 256 times: one long sum is off by several last places.
#[test]
fn short_sums_lose_little() {
    for isa in Isa::available() {
        let (inner, lanes) = (256, isa.lanes::<f32>());
        let shape = Shape { rows: 1, columns: lanes, inner };
        let (a, b) = (vec![0.1_f32; inner], vec![1.0; inner * lanes]);
        let product = |write| {
            let mut c = vec![0.0; lanes];
            let right = Right::Rows { elements: &b, stride: lanes };
            gemm(isa, shape, Left::rows(&a, inner), right, &mut c, lanes, write);
            (c[0] / (0.1 * inner as f32) - 1.0).abs() / f32::EPSILON
        };
        assert!(product(Write::Set) > 4.0 && product(Write::SetFromShortSums) <= 2.0);
    }
}

#[test]
fn empty_extents_are_harmless() {
    let isa = Isa::detect();
    let lanes = isa.lanes::<f64>();
    for (rows, columns, inner) in [(0, lanes, 3), (3, 0, 3), (3, lanes, 0), (0, 0, 0)] {
        for layout in every_layout() {
            compare::<f64>(isa, Shape { rows, columns, inner }, layout);
        }
    }
}

#[test]
fn an_element_depends_on_its_own_row_and_column_alone() {
    let layout = Layout { transposed: false, packed: true, write: Write::Set, pad: 0 };
    for isa in Isa::available() {
        let columns = 3 * isa.lanes::<f32>();
        let (all, stride) = product::<f32>(isa, Shape { rows: 40, columns, inner: 300 }, layout);
        for rows in 1..40 {
            let (some, _) = product::<f32>(isa, Shape { rows, columns, inner: 300 }, layout);
            let same = some.iter().zip(&all[..rows * stride]).all(|(x, y)| x.to_bits() == y.to_bits());
            assert!(same, "{} rows {rows}", isa.name());
        }
    }
}

#[test]
fn packing_transposes_and_pads_with_zeros() {
    for isa in Isa::available() {
        let (outputs, inputs, stride) = (5, 7, 9);
        let w = noise::<f64>(outputs * stride, 4);
        // One row, a unit vector, picks a row of the packed factor.
        let row_of = |packed: &Packed<f64>, k: usize| {
            let mut unit = vec![0.0; packed.inner()];
            unit[k] = 1.0;
            let mut c = vec![f64::NAN; packed.columns()];
            let shape = Shape { rows: 1, columns: packed.columns(), inner: packed.inner() };
            gemm(isa, shape, Left::rows(&unit, 1), Right::Packed(packed), &mut c, packed.columns(), Write::Set);
            c
        };
        let mut forward = Packed::zeros(isa, inputs, outputs);
        let mut adjoint = Packed::zeros(isa, outputs, inputs);
        for _ in 0..2 {
            forward.pack(Left::transposed(&w, stride), outputs);
            adjoint.pack(Left::rows(&w, stride), inputs);
        }
        for k in 0..inputs {
            let row = row_of(&forward, k);
            assert!((0..row.len()).all(|j| row[j] == if j < outputs { w[j * stride + k] } else { 0.0 }));
        }
        for k in 0..outputs {
            let row = row_of(&adjoint, k);
            assert!((0..row.len()).all(|j| row[j] == if j < inputs { w[k * stride + j] } else { 0.0 }));
        }
    }
}

fn refused(shape: Shape, a: usize, b: usize, c: usize) {
    let (a, b) = (vec![0.0_f32; a], vec![0.0_f32; b]);
    let mut c = vec![0.0_f32; c];
    let right = Right::Rows { elements: &b, stride: shape.columns };
    gemm(Isa::SCALAR, shape, Left::rows(&a, shape.inner), right, &mut c, shape.columns, Write::Set);
}

const SHAPE: Shape = Shape { rows: 3, columns: 4, inner: 5 };

#[test]
#[should_panic(expected = "A is too short")]
fn a_short_left_factor_is_refused() {
    refused(SHAPE, 14, 20, 12);
}

#[test]
#[should_panic(expected = "B is too short")]
fn a_short_right_factor_is_refused() {
    refused(SHAPE, 15, 19, 12);
}

#[test]
#[should_panic(expected = "C is too short")]
fn a_short_result_is_refused() {
    refused(SHAPE, 15, 20, 11);
}

/// Five columns are no whole vectors, but where a vector is one number.
#[test]
fn a_broken_vector_is_refused() {
    for isa in Isa::available().filter(|isa| isa.lanes::<f32>() > 1) {
        let shape = Shape { columns: 5, ..SHAPE };
        let product = || {
            let right = Right::Rows { elements: &[0.0_f32; 25], stride: 5 };
            gemm(isa, shape, Left::rows(&[0.0; 15], 5), right, &mut [0.0; 15], 5, Write::Set);
        };
        let message = *std::panic::catch_unwind(product).unwrap_err().downcast::<String>().unwrap();
        assert!(message.contains("no multiple of a vector"), "{message}");
    }
}

#[test]
#[should_panic(expected = "too short")]
fn extents_that_overflow_are_refused() {
    let mut c = [0.0_f32; 8];
    let shape = Shape { rows: 3, columns: 4, inner: 1 };
    let right = Right::Rows { elements: &[0.0; 4], stride: 4 };
    gemm(Isa::SCALAR, shape, Left::rows(&[0.0; 9], 1), right, &mut c, usize::MAX / 2 + 1, Write::Set);
}
