//! Triangles of matrices by reflections (Householder 1958), in blocks (Schreiber and Van Loan 1989).

use crate::gemm::{Left, Packed, Right, Shape, Write, gemm};
use crate::simd::Isa;
use crate::solve::vector;

/// Columns that are reflected one by one; a multiple of the lanes of every instruction set.
const BLOCK: usize = 32;

/// The rows of `R` with `R^T R = A^T A`, for `a` row-major with `n` columns: each from its diagonal on, one after the other, as many as
/// `a` has rows or columns.
pub(crate) fn triangle_of(a: &[f64], n: usize) -> Vec<f64> {
    let rows = a.len() / n.max(1);
    // Columns of whole vectors, one after the other.
    let height = rows.next_multiple_of(8);
    let mut columns = vec![0.0; n * height];
    for (row, a) in a.chunks_exact(n.max(1)).enumerate() {
        columns.iter_mut().skip(row).step_by(height.max(1)).zip(a).for_each(|(x, a)| *x = *a);
    }
    let least = rows.min(n);
    for first in (0..least).step_by(BLOCK) {
        reflect(&mut columns[first * height..], height, first, BLOCK.min(least - first));
    }
    (0..least).flat_map(|row| (row..n).map(move |column| (row, column))).map(|(i, j)| columns[j * height + i]).collect()
}

/// Clears the first `count` columns below the diagonal, of which the first begins at row `first`, and reflects the others alike.
fn reflect(columns: &mut [f64], height: usize, first: usize, count: usize) {
    let (block, others) = columns.split_at_mut(count * height);
    // Reflectors I - v v^T t, whose v are the rows of `all`, and the triangle T of their product I - V^T T V.
    let mut all = vec![0.0; count * height];
    let mut triangle = vec![0.0; count * count];
    for at in 0..count {
        let (column, later) = block[at * height..].split_at_mut(height);
        let v = &mut all[at * height..][..height];
        let scale = householder(column, first + at, v);
        for later in later.chunks_exact_mut(height) {
            let along = scale * vector::dot(v, later);
            vector::add_scaled(later, -along, v);
        }
        let (before, v) = all.split_at(at * height);
        let products: Vec<f64> = before.chunks_exact(height).map(|before| vector::dot(before, &v[..height])).collect();
        for i in 0..at {
            let sum: f64 = (i..at).map(|k| triangle[i * count + k] * products[k]).sum();
            triangle[i * count + at] = -scale * sum;
        }
        triangle[at * count + at] = scale;
    }
    // Every other column c becomes (I - V^T T^T V) c: as rows, C - (C V^T) T V.
    let (isa, rest) = (Isa::detect(), others.len() / height);
    if rest == 0 {
        return;
    }
    let mut turned = Packed::zeros(isa, height, count);
    turned.pack(Left::transposed(&all, height), count);
    let width = turned.columns();
    let mut along = vec![0.0; rest * width];
    let shape = Shape { rows: rest, columns: width, inner: height };
    gemm(isa, shape, Left::rows(others, height), Right::Packed(&turned), &mut along, width, Write::Set);
    let mut weights = Vec::with_capacity(rest * count);
    for along in along.chunks_exact(width) {
        weights.extend((0..count).map(|k| -(0..=k).map(|i| along[i] * triangle[i * count + k]).sum::<f64>()));
    }
    let shape = Shape { rows: rest, columns: height, inner: count };
    let right = Right::Rows { elements: &all, stride: height };
    gemm(isa, shape, Left::rows(&weights, count), right, others, height, Write::Add);
}

/// Reflects a column onto its entry `at`: writes `v` of the reflector `I - scale v v^T`, and returns the scale.
fn householder(column: &mut [f64], at: usize, v: &mut [f64]) -> f64 {
    let norm = vector::norm(&column[at..]);
    if norm == 0.0 {
        return 0.0;
    }
    v[at..].copy_from_slice(&column[at..]);
    let end = -norm.copysign(column[at]);
    v[at] -= end;
    column[at] = end;
    column[at + 1..].fill(0.0);
    // |v|^2 = 2 norm (norm + |x|).
    1.0 / (norm * v[at].abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::dense::tests::{plain, wavy};

    #[test]
    fn triangles_multiply_to_the_products_of_columns() {
        for (rows, n) in [(1, 1), (3, 5), (9, 4), (40, 40), (70, 45), (200, 97)] {
            let a = wavy(rows, n);
            let (triangle, expected) = (triangle_of(&a, n), plain(&a, n));
            let mut found = vec![0.0; n * n];
            let mut rest = triangle.as_slice();
            for first in 0..rows.min(n) {
                let (row, after) = rest.split_at(n - first);
                for i in first..n {
                    (first..n).for_each(|j| found[i * n + j] += row[i - first] * row[j - first]);
                }
                rest = after;
            }
            assert!(rest.is_empty());
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-13 * rows as f64, "{rows} {n}: {found} {expected}");
            }
        }
    }

    #[test]
    fn columns_of_zeros_are_left_alone() {
        let sizes: Vec<f64> = triangle_of(&[0.0, 3.0, 0.0, 4.0], 2).into_iter().map(f64::abs).collect();
        assert_eq!(sizes, [0.0, 3.0, 4.0]);
    }
}
