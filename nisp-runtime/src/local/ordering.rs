//! In which order the unknowns of a sparse symmetric matrix are eliminated.
//!
//! Coefficients of several fields on one lattice meet the same others: no order tells them apart, and they fill the same factors. An
//! order is sought for one of each kind (approximate minimum degree, Amestoy, Davis and Duff 1996), and holds for all.

use std::collections::HashMap;

use super::entries::Entries;

/// Unknowns by kind, in the order in which the kinds are eliminated, and which kinds meet.
pub(super) struct Ordering {
    /// Unknowns of every kind.
    pub(super) members: Vec<Vec<usize>>,
    /// By kind, those that come later and meet it.
    pub(super) later: Vec<Vec<usize>>,
}

impl Ordering {
    /// Of a matrix, of which the lower triangle has these entries; nothing where they are no such triangle.
    pub(super) fn of(entries: &Entries) -> Option<Self> {
        let members = alike(entries);
        let mut kind = vec![0; entries.len()];
        for (number, members) in members.iter().enumerate() {
            members.iter().for_each(|&member| kind[member] = number);
        }
        // The first of every kind stand for all.
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for first in members.iter().map(|members| members[0]) {
            let own = entries.column(first).iter().filter(|&&row| members[kind[row]][0] == row);
            rows.extend(own.map(|&row| kind[row]));
            starts.push(rows.len());
        }
        let (order, places, _) = amd::order(members.len(), &starts, &rows, &amd::Control::default()).ok()?;
        let mut later = vec![Vec::new(); members.len()];
        for column in 0..members.len() {
            for &row in rows[starts[column]..starts[column + 1]].iter().filter(|&&row| row != column) {
                let (a, b) = (places[column], places[row]);
                later[a.min(b)].push(a.max(b));
            }
        }
        let mut members: Vec<Option<Vec<usize>>> = members.into_iter().map(Some).collect();
        let members = order.into_iter().filter_map(|kind| members[kind].take()).collect();
        Some(Self { members, later })
    }
}

/// Unknowns that have entries with the same others, by kind; kinds in the order of their first.
fn alike(entries: &Entries) -> Vec<Vec<usize>> {
    let mut sums = vec![0u64; entries.len()];
    for column in 0..entries.len() {
        for &row in entries.column(column) {
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
        let entries = Entries::of((0..8).map(column));
        assert_eq!(alike(&entries), [[0, 4], [1, 5], [2, 6], [3, 7]]);
        let ordering = Ordering::of(&entries).unwrap();
        for members in &ordering.members {
            assert_eq!(place(members[0]), place(members[1]));
        }
        let mut all = ordering.members.concat();
        all.sort_unstable();
        assert_eq!(all, (0..8).collect::<Vec<usize>>());
        // An end of the chain goes first, and meets one other.
        assert!([0, 3].contains(&place(ordering.members[0][0])) && ordering.later[0].len() == 1);
        assert_eq!(ordering.later.iter().map(Vec::len).sum::<usize>(), 3);
    }
}
