//! Right factors laid out in the order in which they are read.

use super::{Left, panel};
use crate::aligned::AlignedVec;
use crate::simd::{Element, Isa, Kernel, Simd, dispatch};

/// A right factor as panels of two vectors' columns, each panel row by row; the last panel has one vector if their
/// number is odd.
#[derive(Clone, Debug)]
pub struct Packed<E: Element> {
    isa: Isa,
    /// Columns of a full panel.
    panel: usize,
    inner: usize,
    columns: usize,
    elements: AlignedVec<E>,
}

impl<E: Element> Packed<E> {
    /// Room for `inner` rows and `columns` columns, all zero; columns are rounded up to whole vectors of `isa`.
    pub fn zeros(isa: Isa, inner: usize, columns: usize) -> Self {
        let columns = columns.next_multiple_of(isa.lanes::<E>());
        let elements = AlignedVec::zeros(inner * columns);
        Self { isa, panel: dispatch::<E, _>(isa, Panel), inner, columns, elements }
    }

    /// Number of rows: the inner extent of products.
    pub fn inner(&self) -> usize {
        self.inner
    }

    /// Number of columns, rounded up to whole vectors.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Fills in `B(k, j) = factor(k, j)` for all `inner` rows and the first `columns` columns; the others become zero.
    ///
    /// For weights W, row-major with one row per output: the factor of the forward product, W^T, is
    /// `Left::transposed(w, stride)`, with one row per input; that of the adjoint, W, is `Left::rows(w, stride)`.
    ///
    /// # Panics
    /// If the factor is too short, or has more columns than this has room for.
    pub fn pack(&mut self, factor: Left<E>, columns: usize) {
        assert!(columns <= self.columns, "room for {} columns, not {columns}", self.columns);
        let covered = super::covers(factor.elements.len(), [self.inner, factor.row], [columns, factor.column]);
        assert!(covered, "the factor is too short for {} by {columns}", self.inner);
        if self.inner == 0 {
            return;
        }
        for first in (0..self.columns).step_by(self.panel) {
            let width = self.panel.min(self.columns - first);
            let panel = &mut self.elements[first * self.inner..][..width * self.inner];
            let used = width.min(columns.saturating_sub(first));
            if used < width {
                panel.fill(E::ZERO);
            }
            let source = if used > 0 { &factor.elements[first * factor.column..] } else { &[] };
            if factor.column == 1 {
                for (k, row) in panel.chunks_exact_mut(width).enumerate() {
                    row[..used].copy_from_slice(&source[k * factor.row..][..used]);
                }
            } else {
                for j in 0..used {
                    for (k, row) in panel.chunks_exact_mut(width).enumerate() {
                        row[j] = source[k * factor.row + j * factor.column];
                    }
                }
            }
        }
    }

    pub(super) fn elements(&self) -> &[E] {
        &self.elements
    }

    /// Panics unless packed for this instruction set and these extents.
    pub(super) fn check(&self, isa: Isa, inner: usize, columns: usize) {
        assert_eq!(self.isa, isa, "packed for another instruction set");
        assert_eq!((self.inner, self.columns), (inner, columns), "packed for other extents");
    }
}

struct Panel;

impl<E: Element> Kernel<E> for Panel {
    type Output = usize;
    #[inline(always)]
    fn run<V: Simd<Elem = E>>(self) -> usize {
        panel::<V>()
    }
}
