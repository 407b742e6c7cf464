//! Random operator sets up to order 6 in up to 4 coordinates, through a random small network.

mod middle_support;

use std::collections::BTreeMap;

use middle_support::{Numbers, dense, network};
use nisp_compiler::channels::{ChannelSet, Operator};
use nisp_compiler::rational::{Rational, ratio};
use proptest::prelude::*;

/// Sets larger than this are left to the other tests: their dense jets take long in a debug build.
const LARGE: usize = 70;

/// Rank of the span of all derivatives of the operators, by plain elimination on dense rows.
fn rank(operators: &[Operator], coordinates: usize) -> usize {
    let mut all = vec![Operator::one(coordinates)];
    let mut open = operators.to_vec();
    while let Some(operator) = open.pop() {
        open.extend((0..coordinates).map(|i| operator.derivative(i).unwrap()).filter(|d| !d.is_empty()));
        if !all.contains(&operator) {
            all.push(operator);
        }
    }
    let columns = dense(coordinates, 6);
    let mut rows: Vec<Vec<Rational>> =
        all.iter().map(|operator| columns.iter().map(|index| operator.coefficient(index)).collect()).collect();
    let mut rank = 0;
    for column in 0..columns.len() {
        let Some(pivot) = (rank..rows.len()).find(|&r| rows[r][column] != ratio(0, 1)) else { continue };
        rows.swap(rank, pivot);
        let (above, below) = rows.split_at_mut(rank + 1);
        for row in below.iter_mut().filter(|row| row[column] != ratio(0, 1)) {
            let factor = row[column] / above[rank][column];
            row.iter_mut().zip(&above[rank]).for_each(|(x, p)| *x -= factor * p);
        }
        rank += 1;
    }
    rank
}

fn operators() -> impl Strategy<Value = Vec<Operator>> {
    (1usize..=4).prop_flat_map(|coordinates| {
        let indices = dense(coordinates, 6);
        let term = (0..indices.len(), prop_oneof![-5i128..=-1, 1i128..=5]);
        let operator = prop::collection::vec(term, 1..4);
        prop::collection::vec(operator, 1..3).prop_map(move |list| {
            let operator = |terms: Vec<(usize, i128)>| {
                Operator::from_terms(terms.into_iter().map(|(i, c)| (indices[i].clone(), ratio(c, 1)))).unwrap()
            };
            list.into_iter().map(operator).collect()
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn minimal_sets_are_exact_and_minimal(operators in operators(), seed: u64) {
        let coordinates = operators.iter().find_map(|o| o.terms().next().map(|(i, _)| i.len())).unwrap_or(1);
        let set = ChannelSet::minimal(&operators, coordinates).unwrap();
        prop_assert_eq!(set.len(), rank(&operators, coordinates));
        for operator in &operators {
            prop_assert!(set.express(operator).unwrap().is_some());
        }
        // The dual basis reads every channel off itself.
        let alone: Vec<_> = set.basis.iter().map(|b| set.express(b).unwrap()).collect();
        let expected: Vec<_> = (0..set.len()).map(|k| Some(vec![(k, ratio(1, 1))])).collect();
        prop_assert_eq!(alone, expected);
        if set.len() <= LARGE {
            network::check(&set, seed)?;
        }
    }
}

/// The coproduct is that of the polynomials: `b(xi + eta)` at random points.
#[test]
fn coproducts_hold_at_random_points() {
    let mut numbers = Numbers(5);
    let operators = [middle_support::iterated(&middle_support::laplacian(3, 3), 3)];
    let set = middle_support::minimal(&operators);
    let value = |operator: &Operator, at: &[f64]| -> f64 {
        let term = |(index, c): (&Vec<u32>, &Rational)| {
            let power: f64 = index.iter().zip(at).map(|(&e, x)| x.powi(e as i32)).product();
            *c.numer() as f64 / *c.denom() as f64 * power
        };
        operator.terms().map(term).sum()
    };
    let (xi, eta) = (numbers.take(3), numbers.take(3));
    let both: Vec<f64> = xi.iter().zip(&eta).map(|(x, y)| x + y).collect();
    let mut sizes = BTreeMap::new();
    for k in 0..set.len() {
        let shares = set.coproduct(k).unwrap();
        *sizes.entry(shares.len()).or_insert(0) += 1;
        let share = |(i, j, c): &(usize, usize, Rational)| {
            *c.numer() as f64 / *c.denom() as f64 * value(&set.basis[*i], &xi) * value(&set.basis[*j], &eta)
        };
        let (got, expected) = (shares.iter().map(share).sum::<f64>(), value(&set.basis[k], &both));
        assert!((got - expected).abs() < 1e-10, "channel {k}: {got} instead of {expected}");
    }
    assert!(sizes.len() > 3);
}
