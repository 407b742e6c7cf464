//! Matrix products of the shapes that a tile of points makes: some dozens or hundreds of rows, times a layer's weights.
//!
//! `C (+)= A B`, all row-major or nearly so, on one thread and without allocation. Vectors lie along the columns of B
//! and C; A is read element by element and may have any strides. A layer uses it three times:
//!
//! | product | A | B |
//! |---|---|---|
//! | forward, rows by W^T | rows, as they lie | W^T, packed |
//! | adjoint, rows by W | adjoint rows, as they lie | W, packed |
//! | gradient of W, `+=` | adjoint rows transposed: row stride 1 | rows, as they lie |
//!
//! Each element of C is one sum over the inner index in ascending order (in runs of [`RUN`] or fewer that are added to C one
//! after the other): for a given instruction set, its bits depend on nothing but its own row of A and column of B.
//! Blocks only decide what stays in registers (see `block`) and in the nearest cache (see `sweep`).

mod block;
mod pack;
mod sweep;

use crate::simd::{Element, Isa, Simd, dispatch};
pub use pack::Packed;
pub use sweep::RUN;

/// Extents of a product: C is `rows` by `columns`, the sum runs over `inner`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Rows of A and C.
    pub rows: usize,
    /// Columns of B and C: a multiple of the number of lanes.
    pub columns: usize,
    /// Columns of A and rows of B.
    pub inner: usize,
}

/// The left factor: element (i, k) is `elements[i * row + k * column]`.
#[derive(Clone, Copy, Debug)]
pub struct Left<'a, E> {
    /// Where the elements live.
    pub elements: &'a [E],
    /// Distance between rows.
    pub row: usize,
    /// Distance between columns.
    pub column: usize,
}

impl<'a, E> Left<'a, E> {
    /// Rows as they lie, `stride` apart.
    pub fn rows(elements: &'a [E], stride: usize) -> Self {
        Self { elements, row: stride, column: 1 }
    }

    /// The transpose of rows that lie `stride` apart.
    pub fn transposed(elements: &'a [E], stride: usize) -> Self {
        Self { elements, row: 1, column: stride }
    }
}

/// The right factor.
#[derive(Clone, Copy, Debug)]
pub enum Right<'a, E: Element> {
    /// Rows as they lie: element (k, j) is `elements[k * stride + j]`.
    Rows {
        /// Where the elements live.
        elements: &'a [E],
        /// Distance between rows.
        stride: usize,
    },
    /// Packed beforehand, for a factor that is used many times.
    Packed(&'a Packed<E>),
}

/// What happens to the former elements of C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Write {
    /// They are replaced.
    Set,
    /// The same, from sums of few products where the type has few bits ([`SUMMED`](crate::real::Real::SUMMED)): some per cent slower, and rounding
    /// takes a fraction.
    SetFromShortSums,
    /// The product is added to them.
    Add,
    /// The product is subtracted from them.
    Subtract,
}

impl Write {
    /// What happens to elements that hold a part of their sum.
    fn after(self) -> Self {
        if self == Self::Subtract { Self::Subtract } else { Self::Add }
    }
}

/// `C = A B`, `C += A B` or `C -= A B` with vectors of `isa`; element (i, j) of C is `c[i * stride + j]`.
///
/// # Panics
/// If a factor or C is too short for the shape, if the number of columns is not a multiple of the lanes of `isa`, or if
/// the right factor was packed for another shape or instruction set.
pub fn gemm<E: Element>(isa: Isa, shape: Shape, a: Left<E>, b: Right<E>, c: &mut [E], stride: usize, write: Write) {
    let Shape { rows, columns, inner } = shape;
    assert!(columns.is_multiple_of(isa.lanes::<E>()), "{columns} columns are no multiple of a vector");
    assert!(covers(c.len(), [rows, stride], [columns, 1]), "C is too short for {shape:?}");
    assert!(covers(a.elements.len(), [rows, a.row], [inner, a.column]), "A is too short for {shape:?}");
    assert!(stride >= columns || rows <= 1, "rows of C overlap");
    let (b, b_row) = match b {
        Right::Rows { elements, stride } => {
            assert!(covers(elements.len(), [inner, stride], [columns, 1]), "B is too short for {shape:?}");
            (elements.as_ptr(), Some(stride))
        }
        Right::Packed(packed) => {
            packed.check(isa, inner, columns);
            (packed.elements().as_ptr(), None)
        }
    };
    let task = Task {
        shape,
        a: a.elements.as_ptr(),
        a_row: a.row,
        a_column: a.column,
        b,
        b_row,
        c: c.as_mut_ptr(),
        c_row: stride,
        write,
        summed: if write == Write::SetFromShortSums { E::SUMMED } else { usize::MAX },
    };
    // SAFETY: the assertions above cover every element that the shape reaches; a number of four bytes is an f32, one of eight
    // an f64.
    unsafe { if size_of::<E>() == size_of::<f32>() { single(isa, task.of()) } else { double(isa, task.of()) } };
}

/// Whether `len` elements hold index (i, j) at `i * stride_i + j * stride_j` for all i, j below their counts.
fn covers(len: usize, [rows, row]: [usize; 2], [columns, column]: [usize; 2]) -> bool {
    if rows == 0 || columns == 0 {
        return true;
    }
    let last = |count: usize, stride: usize| (count - 1).checked_mul(stride);
    let end = last(rows, row).zip(last(columns, column)).and_then(|(i, j)| i.checked_add(j));
    end.is_some_and(|end| end < len)
}

/// A product whose extents have been checked.
struct Task<E> {
    shape: Shape,
    a: *const E,
    a_row: usize,
    a_column: usize,
    b: *const E,
    /// Distance between rows of B; panels if there is none.
    b_row: Option<usize>,
    c: *mut E,
    c_row: usize,
    write: Write,
    /// Products that are summed before their sum is added to others.
    summed: usize,
}

impl<E> Task<E> {
    /// The same task of another element type, which the caller knows `E` to be.
    fn of<F>(self) -> Task<F> {
        let Self { shape, a, a_row, a_column, b, b_row, c, c_row, write, summed } = self;
        Task { shape, a: a.cast(), a_row, a_column, b: b.cast(), b_row, c: c.cast(), c_row, write, summed }
    }
}

/// Does a task in single precision. Neither this nor [`double`] is generic, so that products are compiled here and not in
/// every crate that calls them.
///
/// # Safety
/// Every element that the task's shape reaches must exist, and those of C be exclusively the task's.
unsafe fn single(isa: Isa, task: Task<f32>) {
    dispatch(isa, sweep::Sweep(task));
}

/// Does a task in double precision.
///
/// # Safety
/// As of [`single`].
unsafe fn double(isa: Isa, task: Task<f64>) {
    dispatch(isa, sweep::Sweep(task));
}

/// Columns of one panel: two vectors.
const fn panel<V: Simd>() -> usize {
    2 * V::LANES
}
