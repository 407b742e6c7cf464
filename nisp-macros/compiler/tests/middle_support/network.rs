//! A random small network in the channels of a set, against dense jets.

use nisp_compiler::channels::{self, ChannelSet, Operator};
use nisp_compiler::plan::rule_programs;
use nisp_compiler::program::{Program, Slot};
use nisp_compiler::rational::ratio;
use proptest::prelude::*;

use super::Numbers;
use super::jet::Jet;
use super::tangent::{compare, moving, tangent};

/// Channels of the two factors of a product, or of the argument of a composition.
fn run(program: &Program, phi: &[f64], left: &[f64], right: &[f64]) -> Vec<f64> {
    program.evaluate(|slot, index| match slot {
        Slot::Phi => phi[index],
        Slot::Argument | Slot::Left | Slot::Weight => left[index],
        Slot::Right => right[index],
        other => panic!("unexpected {other:?}"),
    })
}

/// The largest size that cancellation can leave its rounding on: the same computation with absolute values.
fn absolute(jet: &Jet) -> Jet {
    let mut result = jet.clone();
    result.coefficients.values_mut().for_each(|c| *c = c.abs());
    result
}

/// Compares every channel of a random small network with its dense jet.
pub(crate) fn check(set: &ChannelSet, seed: u64) -> Result<(), TestCaseError> {
    let (mut numbers, degree) = (Numbers(seed), set.order());
    let all = vec![true; set.len()];
    let program = |rule: channels::Rule| rule_programs(rule, &all).unwrap().0;
    let [compose, affine, product] =
        [channels::compose(set), channels::affine(set), channels::product(set)].map(|rule| program(rule.unwrap()));
    let phi = numbers.take(degree as usize + 1);
    // Two affine units through the activation, multiplied, mixed and through the activation again.
    let weights: Vec<Vec<f64>> = (0..2).map(|_| numbers.take(set.coordinates)).collect();
    let unit = |w: &Vec<f64>| (run(&affine, &phi, w, &[]), Jet::affine(w, 0.3, degree).compose(&phi));
    let ((a, a_jet), (b, b_jet)) = (unit(&weights[0]), unit(&weights[1]));
    let (gate, gate_jet) = (run(&product, &phi, &a, &b), a_jet.times(&b_jet));
    let mixed: Vec<f64> = gate.iter().zip(&a).map(|(g, a)| g - 0.5 * a).collect();
    let mixed_jet = gate_jet.plus(&a_jet.scale(-0.5));
    let (out, out_jet) = (run(&compose, &phi, &mixed, &[]), mixed_jet.compose(&phi));
    let bounds = absolute(&absolute(&gate_jet).plus(&absolute(&a_jet)))
        .compose(&phi.iter().map(|p| p.abs()).collect::<Vec<_>>());
    for (operator, got) in set.basis.iter().zip(out) {
        let positive =
            Operator::from_terms(operator.terms().map(|(i, c)| (i.clone(), if *c < ratio(0, 1) { -c } else { *c })));
        let scale = bounds.apply(&positive.unwrap()).max(1e-6);
        let expected = out_jet.apply(operator);
        prop_assert!((got - expected).abs() <= 1e-12 * scale, "{operator:?}: {got} instead of {expected} ({scale})");
    }
    Ok(())
}

/// Compares `u.(J v)` with `(J^T u).v` of the rules of a set, `J` being the derivative of the channels that a rule gives by
/// those that it takes.
pub(crate) fn check_adjoints(set: &ChannelSet, seed: u64) -> Result<(), TestCaseError> {
    let (mut numbers, all) = (Numbers(seed), vec![true; set.len()]);
    // One more than there are orders: where the argument moves, each derivative moves by the next.
    let phi = numbers.take(set.order() as usize + 2);
    for rule in [channels::compose(set), channels::affine(set), channels::product(set)] {
        let rule = rule.unwrap();
        let wanted = rule.inputs.clone();
        let (forward, adjoint) = rule_programs(rule, &all).unwrap();
        // Weights are one for each coordinate, the others one for each channel.
        let mut vector = || numbers.take(set.len().max(set.coordinates));
        let values = [vector(), vector(), vector()];
        let value = |slot: Slot, index: usize| match slot {
            Slot::Phi => phi[index],
            Slot::Argument | Slot::Left | Slot::Weight => values[0][index],
            Slot::Right => values[1][index],
            Slot::Seed => values[2][index],
            other => panic!("a rule does not read {other:?}"),
        };
        let direction = numbers.take(wanted.len());
        let speed = |slot: Slot, index: usize| -> f64 {
            let of = |(at, v): (&Option<(Slot, usize)>, &f64)| match (at, slot) {
                (None, Slot::Phi) => v * phi[index + 1],
                (Some(at), _) if *at == (slot, index) => *v,
                _ => 0.0,
            };
            wanted.iter().zip(&direction).map(of).sum()
        };
        let moved = tangent(&forward, |slot, index| moving(value(slot, index), speed(slot, index)));
        let adjoints = adjoint.evaluate(value);
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<f64>>();
        let compared = compare(&product(&values[2], &moved), &product(&adjoints, &direction), 0.0);
        prop_assert!(compared.is_ok(), "{compared:?}");
    }
    Ok(())
}
