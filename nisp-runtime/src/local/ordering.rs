//! In which order the unknowns of a sparse symmetric matrix are eliminated.
//!
//! Coefficients of several fields on one lattice meet the same others: no order tells them apart, and they fill the same factors. An
//! order is sought for one of each kind (approximate minimum degree, Amestoy, Davis and Duff 1996), and holds for all.

use std::collections::HashMap;

use super::entries::Entries;

/// An order of the unknowns of a matrix, of which the lower triangle has these entries; nothing where none is found.
pub(super) fn order(entries: &Entries) -> Option<Vec<usize>> {
    let members = alike(entries);
    let mut kind = vec![0; entries.columns()];
    for (number, members) in members.iter().enumerate() {
        members.iter().for_each(|&member| kind[member] = number);
    }
    // The first of every kind stand for all.
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for first in members.iter().map(|members| members[0]) {
        let own = entries.rows_of(first).iter().filter(|&&row| members[kind[row]][0] == row);
        rows.extend(own.map(|&row| kind[row]));
        starts.push(rows.len());
    }
    let (order, _, _) = amd::order(members.len(), &starts, &rows, &amd::Control::default()).ok()?;
    Some(order.into_iter().flat_map(|kind| members[kind].iter().copied()).collect())
}

/// Unknowns that have entries with the same others, by kind; kinds in the order of their first.
fn alike(entries: &Entries) -> Vec<Vec<usize>> {
    let mut sums = vec![0u64; entries.columns()];
    for column in 0..entries.columns() {
        for &row in entries.rows_of(column) {
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
        let entries = Entries::new(&columns);
        assert_eq!(alike(&entries), [[0, 4], [1, 5], [2, 6], [3, 7]]);
        let order = order(&entries).unwrap();
        for pair in order.chunks_exact(2) {
            assert_eq!(place(pair[0]), place(pair[1]));
        }
        let mut all = order.clone();
        all.sort_unstable();
        assert_eq!(all, [0, 1, 2, 3, 4, 5, 6, 7]);
        // An end of the chain goes first.
        assert!([0, 3].contains(&place(order[0])));
    }
}
