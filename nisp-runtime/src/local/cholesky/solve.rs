//! Solutions with the factors of a sparse matrix.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::tree::Tree;
use crate::gemm::{Left, Right, Shape, Write, gemm};
use crate::simd::Isa;
use crate::solve::dense::{solve_backward, solve_forward};
use crate::solve::vector;

/// Right-hand sides that are solved for at once: whole vectors of every instruction set.
const SIDES: usize = 32;

/// `H^-1` times the columns of a matrix.
pub(super) fn solve(tree: &Tree, lower: &[f64], right: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, count) = right.shape();
    let mut solutions = DMatrix::zeros(rows, count);
    let chunks = solutions.as_mut_slice().par_chunks_mut((rows * SIDES).max(1)).enumerate();
    chunks.for_each(|(chunk, solutions)| {
        let right = &right.as_slice()[chunk * rows * SIDES..][..solutions.len()];
        if right.len() == rows {
            let mut x: Vec<f64> = tree.order.iter().map(|&unknown| right[unknown]).collect();
            one(tree, lower, &mut x);
            tree.order.iter().zip(x).for_each(|(&unknown, x)| solutions[unknown] = x);
        } else {
            let width = (right.len() / rows).next_multiple_of(8);
            let mut x = vec![0.0; rows * width];
            for (x, &unknown) in x.chunks_exact_mut(width).zip(&tree.order) {
                x.iter_mut().zip(right[unknown..].iter().step_by(rows)).for_each(|(x, right)| *x = *right);
            }
            several(tree, lower, &mut x, width);
            for (x, &unknown) in x.chunks_exact(width).zip(&tree.order) {
                solutions[unknown..].iter_mut().step_by(rows).zip(x).for_each(|(solution, x)| *solution = *x);
            }
        }
    });
    solutions
}

/// Solves for one right-hand side in place.
fn one(tree: &Tree, lower: &[f64], x: &mut [f64]) {
    let mut below = Vec::new();
    for front in &tree.fronts {
        let own = &mut x[front.first..][..front.width];
        below.clear();
        below.resize(front.below.len(), 0.0);
        for (i, row) in lower[front.at..].chunks_exact(front.size()).take(front.width).enumerate() {
            let solved = own[i] / row[i];
            own[i] = solved;
            vector::add_scaled(&mut own[i + 1..], -solved, &row[i + 1..front.width]);
            vector::add_scaled(&mut below, solved, &row[front.width..]);
        }
        front.below.iter().zip(&below).for_each(|(&at, below)| x[at] -= below);
    }
    for front in tree.fronts.iter().rev() {
        below.clear();
        below.extend(front.below.iter().map(|&at| x[at]));
        let own = &mut x[front.first..][..front.width];
        for (i, row) in lower[front.at..].chunks_exact(front.size()).take(front.width).enumerate().rev() {
            let known = vector::dot(&row[i + 1..front.width], &own[i + 1..]) + vector::dot(&row[front.width..], &below);
            own[i] = (own[i] - known) / row[i];
        }
    }
}

/// Solves for rows of so many right-hand sides in place.
fn several(tree: &Tree, lower: &[f64], x: &mut [f64], width: usize) {
    let isa = Isa::detect();
    let mut below = Vec::new();
    for front in &tree.fronts {
        let rows = &lower[front.at..][..front.width * front.size()];
        let own = &mut x[front.first * width..][..front.width * width];
        solve_forward(rows, front.size(), 0..front.width, own, width);
        if !front.below.is_empty() {
            below.resize(front.below.len() * width, 0.0);
            let shape = Shape { rows: front.below.len(), columns: width, inner: front.width };
            let (left, right) =
                (Left::transposed(&rows[front.width..], front.size()), Right::Rows { elements: own, stride: width });
            gemm(isa, shape, left, right, &mut below, width, Write::Set);
            for (&at, below) in front.below.iter().zip(below.chunks_exact(width)) {
                x[at * width..][..width].iter_mut().zip(below).for_each(|(x, below)| *x -= below);
            }
        }
    }
    for front in tree.fronts.iter().rev() {
        let rows = &lower[front.at..][..front.width * front.size()];
        below.clear();
        below.extend(front.below.iter().flat_map(|&at| x[at * width..][..width].iter().map(|x| -x)));
        let own = &mut x[front.first * width..][..front.width * width];
        if !front.below.is_empty() {
            let shape = Shape { rows: front.width, columns: width, inner: front.below.len() };
            let (left, right) =
                (Left::rows(&rows[front.width..], front.size()), Right::Rows { elements: &below, stride: width });
            gemm(isa, shape, left, right, own, width, Write::Add);
        }
        solve_backward(rows, front.size(), 0..front.width, own, width);
    }
}
