//! The minimal channel set: its size, its basis, and that its rules are exact.

mod middle_support;

use middle_support::{dense, iterated, laplacian, minimal, operator, partial};
use nisp_compiler::channels::{ChannelSet, Operator};
use nisp_compiler::rational::ratio;

fn monomials(coordinates: usize, orders: std::ops::RangeInclusive<u32>) -> Vec<Operator> {
    let all = dense(coordinates, *orders.end());
    all.iter().filter(|index| orders.contains(&index.iter().sum())).map(|index| partial(index)).collect()
}

fn von_karman() -> Vec<Operator> {
    let mut operators = monomials(2, 1..=2);
    operators.push(iterated(&laplacian(2, 2), 2));
    operators
}

#[test]
fn sizes_are_those_of_the_design() {
    let wave = operator(&[(1, &[2, 0, 0, 0]), (1, &[0, 2, 0, 0]), (1, &[0, 0, 2, 0]), (-4, &[0, 0, 0, 2])]);
    let cases: Vec<(&str, Vec<Operator>, usize)> = vec![
        ("value", vec![partial(&[0, 0])], 1),
        ("1-D order 2", vec![partial(&[2])], 3),
        ("2-D Laplacian", vec![laplacian(2, 2)], 4),
        ("3-D Laplacian", vec![laplacian(3, 3)], 5),
        ("2-D biharmonic", vec![iterated(&laplacian(2, 2), 2)], 9),
        ("von Karman", von_karman(), 9),
        ("3-D biharmonic", vec![iterated(&laplacian(3, 3), 2)], 14),
        ("2-D triharmonic", vec![iterated(&laplacian(2, 2), 3)], 16),
        ("3-D elasticity", monomials(3, 1..=2), 10),
        ("wave", vec![wave], 6),
        ("wave, run-time speed", vec![laplacian(3, 4), partial(&[0, 0, 0, 2])], 7),
        ("beam", vec![partial(&[4, 0]), partial(&[0, 2])], 7),
    ];
    for (name, operators, expected) in cases {
        assert_eq!(minimal(&operators).len(), expected, "{name}");
    }
}

#[test]
fn the_basis_prefers_plain_partials() {
    let set = minimal(&von_karman());
    let third = |a, b: [u32; 2]| operator(&[(1, a), (1, &b)]);
    let expected = [
        partial(&[0, 0]),
        partial(&[1, 0]),
        partial(&[0, 1]),
        partial(&[2, 0]),
        partial(&[1, 1]),
        partial(&[0, 2]),
        third(&[3, 0], [1, 2]),
        third(&[2, 1], [0, 3]),
        operator(&[(1, &[4, 0]), (2, &[2, 2]), (1, &[0, 4])]),
    ];
    assert_eq!(set.basis, expected);
}

#[test]
fn only_the_value_has_a_constant_term() {
    let set = minimal(&[operator(&[(1, &[2, 0]), (3, &[0, 1]), (5, &[0, 0])])]);
    assert_eq!(set.basis[0], partial(&[0, 0]));
    for other in &set.basis[1..] {
        assert_eq!(other.coefficient(&[0, 0]), ratio(0, 1));
    }
}

#[test]
fn operators_are_expressed_exactly() {
    let set = minimal(&von_karman());
    let wanted = operator(&[(3, &[4, 0]), (6, &[2, 2]), (3, &[0, 4]), (-2, &[1, 1]), (7, &[0, 0])]);
    let combination = set.express(&wanted).unwrap().unwrap();
    assert_eq!(combination, [(0, ratio(7, 1)), (4, ratio(-2, 1)), (8, ratio(3, 1))]);
    assert_eq!(set.express(&partial(&[3, 0])).unwrap(), None);
}

#[test]
fn a_coefficient_that_outgrows_exact_arithmetic_is_an_error() {
    let huge = i128::MAX / 3;
    let operators =
        [operator(&[(huge, &[4, 0]), (huge - 1, &[3, 1])]), operator(&[(huge - 5, &[4, 0]), (huge - 9, &[3, 1])])];
    assert!(ChannelSet::minimal(&operators, 2).is_err());
}
