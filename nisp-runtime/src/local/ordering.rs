//! In which order the unknowns of a sparse symmetric matrix are eliminated.
//!
//! Coefficients of several fields on one lattice meet the same others: no order tells them apart, and they fill the same factors. An
//! order is sought for one of each kind (approximate minimum degree, Amestoy, Davis and Duff 1996), and holds for all.

use std::collections::HashMap;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::Perm;
use faer::sparse::linalg::amd;
use faer::sparse::{SymbolicSparseColMat, SymbolicSparseColMatRef};

/// An order of the unknowns of a matrix, of which the lower triangle has these entries; nothing where memory is too small.
pub(super) fn order(entries: SymbolicSparseColMatRef<'_, usize>) -> Option<Perm<usize>> {
    let members = alike(entries);
    let mut kind = vec![0; entries.ncols()];
    for (number, members) in members.iter().enumerate() {
        members.iter().for_each(|&member| kind[member] = number);
    }
    // The first of every kind stand for all.
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for first in members.iter().map(|members| members[0]) {
        let own = entries.row_idx_of_col(first).filter(|&row| members[kind[row]][0] == row);
        rows.extend(own.map(|row| kind[row]));
        starts.push(rows.len());
    }
    let count = members.len();
    let (mut forward, mut inverse) = (vec![0; count], vec![0; count]);
    let mut memory = MemBuffer::try_new(amd::order_scratch::<usize>(count, rows.len())).ok()?;
    let reduced = SymbolicSparseColMat::new_checked(count, count, starts, None, rows);
    let stack = MemStack::new(&mut memory);
    amd::order(&mut forward, &mut inverse, reduced.as_ref(), Default::default(), stack).ok()?;
    let all: Vec<usize> = forward.into_iter().flat_map(|kind| members[kind].iter().copied()).collect();
    let mut places = vec![0; all.len()];
    all.iter().enumerate().for_each(|(place, &unknown)| places[unknown] = place);
    Some(Perm::new_checked(all.into(), places.into(), kind.len()))
}

/// Unknowns that have entries with the same others, by kind; kinds in the order of their first.
fn alike(entries: SymbolicSparseColMatRef<'_, usize>) -> Vec<Vec<usize>> {
    let mut sums = vec![0u64; entries.ncols()];
    for column in 0..entries.ncols() {
        for row in entries.row_idx_of_col(column) {
            sums[column] = sums[column].wrapping_add(scrambled(row));
            if row != column {
                sums[row] = sums[row].wrapping_add(scrambled(column));
            }
        }
    }
    let mut kinds = HashMap::new();
    let mut members: Vec<Vec<usize>> = Vec::new();
    for (unknown, sum) in sums.into_iter().enumerate() {
        let kind = *kinds.entry(sum).or_insert(members.len());
        if kind == members.len() {
            members.push(Vec::new());
        }
        members[kind].push(unknown);
    }
    members
}

/// A number whose sums tell sets of unknowns apart (the finaliser of SplitMix64, Steele, Lea and Flood 2014).
fn scrambled(unknown: usize) -> u64 {
    let mut mixed = (unknown as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ (mixed >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of four places with two unknowns each: those of a place are alike, and follow each other.
    #[test]
    fn unknowns_of_a_place_are_eliminated_together() {
        let place = |unknown: usize| unknown % 4;
        let column = |column: usize| {
            let near = (column..8).filter(move |&row| place(row).abs_diff(place(column)) < 2);
            near.collect::<Vec<usize>>()
        };
        let columns: Vec<Vec<usize>> = (0..8).map(column).collect();
        let starts = (0..=8).map(|end| columns[..end].iter().map(Vec::len).sum()).collect();
        let entries = SymbolicSparseColMat::new_checked(8, 8, starts, None, columns.concat());
        assert_eq!(alike(entries.as_ref()), [[0, 4], [1, 5], [2, 6], [3, 7]]);
        let order = order(entries.as_ref()).unwrap();
        let (forward, inverse) = order.arrays();
        for pair in forward.chunks_exact(2) {
            assert_eq!(place(pair[0]), place(pair[1]));
        }
        (0..8).for_each(|place| assert_eq!(inverse[forward[place]], place));
        // An end of the chain goes first.
        assert!([0, 3].contains(&place(forward[0])));
    }
}
