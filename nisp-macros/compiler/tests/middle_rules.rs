//! Propagation rules against a dense Taylor jet, and their adjoints against differences.

mod middle_support;

use middle_support::jet::Jet;
use middle_support::{Numbers, iterated, laplacian, minimal, operator, partial};
use nisp_compiler::channels::{self, Operator, Rule};
use nisp_compiler::plan::rule_programs;
use nisp_compiler::program::{Op, Program, Slot};
use nisp_compiler::symbolic::exact::Exact;

type MakeRule = fn(&channels::ChannelSet) -> Exact<Rule>;

const RULES: [MakeRule; 3] = [channels::compose, channels::affine, channels::product];

/// Values of all inputs, by slot.
#[derive(Clone)]
struct Inputs {
    phi: Vec<f64>,
    argument: Vec<f64>,
    left: Vec<f64>,
    right: Vec<f64>,
    weight: Vec<f64>,
    seed: Vec<f64>,
}

impl Inputs {
    fn random(channels: usize, coordinates: usize, order: usize, numbers: &mut Numbers) -> Self {
        Self {
            phi: numbers.take(order + 2),
            argument: numbers.take(channels),
            left: numbers.take(channels),
            right: numbers.take(channels),
            weight: numbers.take(coordinates),
            seed: numbers.take(channels),
        }
    }

    fn slot(&mut self, slot: Slot) -> &mut Vec<f64> {
        match slot {
            Slot::Phi => &mut self.phi,
            Slot::Argument => &mut self.argument,
            Slot::Left => &mut self.left,
            Slot::Right => &mut self.right,
            Slot::Weight => &mut self.weight,
            Slot::Seed => &mut self.seed,
            other => panic!("a rule does not read {other:?}"),
        }
    }

    fn run(&self, program: &Program) -> Vec<f64> {
        program.evaluate(|slot, index| self.clone().slot(slot)[index])
    }
}

fn examples() -> Vec<Vec<Operator>> {
    vec![
        vec![partial(&[0])],
        vec![partial(&[1])],
        vec![partial(&[6])],
        vec![laplacian(2, 2)],
        vec![laplacian(3, 3), partial(&[1, 1, 0])],
        vec![iterated(&laplacian(2, 2), 2), partial(&[1, 1])],
        vec![iterated(&laplacian(3, 3), 2)],
        vec![iterated(&laplacian(2, 2), 3)],
        vec![operator(&[(2, &[2, 0]), (3, &[1, 1]), (-1, &[0, 1])])],
        vec![partial(&[2, 1, 1, 0]), partial(&[0, 0, 1, 3])],
    ]
}

fn close(got: f64, expected: f64, scale: f64, what: &str) {
    assert!((got - expected).abs() <= 1e-12 * scale.max(1.0), "{what}: {got} instead of {expected}");
}

#[test]
fn compositions_and_products_agree_with_a_dense_jet() {
    let mut numbers = Numbers(1);
    for operators in examples() {
        let set = minimal(&operators);
        let degree = set.order();
        let f = Jet::random(set.coordinates, degree, &mut numbers);
        let g = Jet::random(set.coordinates, degree, &mut numbers);
        let mut inputs = Inputs::random(set.len(), set.coordinates, degree as usize, &mut numbers);
        let channels = |jet: &Jet| set.basis.iter().map(|operator| jet.apply(operator)).collect::<Vec<f64>>();
        (inputs.left, inputs.right, inputs.argument) = (channels(&f), channels(&g), channels(&f));
        let all = vec![true; set.len()];
        let scale = |v: &[f64]| v.iter().fold(0.0f64, |m, x| m.max(x.abs()));

        let expected = channels(&f.times(&g));
        let (product, _) = rule_programs(channels::product(&set).unwrap(), &all).unwrap();
        for (got, want) in inputs.run(&product).iter().zip(&expected) {
            close(*got, *want, scale(&expected), "product");
        }
        let expected = channels(&f.compose(&inputs.phi));
        let (compose, _) = rule_programs(channels::compose(&set).unwrap(), &all).unwrap();
        for (got, want) in inputs.run(&compose).iter().zip(&expected) {
            close(*got, *want, scale(&expected), "compose");
        }
        let affine_jet = Jet::affine(&inputs.weight, 0.3, degree);
        let expected = channels(&affine_jet.compose(&inputs.phi));
        let (affine, _) = rule_programs(channels::affine(&set).unwrap(), &all).unwrap();
        for (got, want) in inputs.run(&affine).iter().zip(&expected) {
            close(*got, *want, scale(&expected), "affine");
        }
        // The same by substitution into the general rule.
        inputs.argument = channels(&affine_jet);
        for (got, want) in inputs.run(&compose).iter().zip(inputs.run(&affine)) {
            close(*got, want, scale(&expected), "affine by substitution");
        }
    }
}

/// The adjoint times a direction is the seed times the derivative in that direction.
#[test]
fn adjoints_agree_with_central_differences() {
    let mut numbers = Numbers(2);
    for (operators, rule) in examples().into_iter().flat_map(|o| RULES.map(|rule| (o.clone(), rule))) {
        let set = minimal(&operators);
        let order = set.order() as usize;
        let inputs = Inputs::random(set.len(), set.coordinates, order, &mut numbers);
        for read in [vec![true; set.len()], (0..set.len()).map(|k| k % 2 == set.len() % 2).collect()] {
            let rule = rule(&set).unwrap();
            let wanted = rule.inputs.clone();
            let (forward, adjoint) = rule_programs(rule, &read).unwrap();
            let adjoints = inputs.run(&adjoint);
            assert_eq!(adjoints.len(), wanted.len());
            for (input, adjoint) in wanted.into_iter().zip(adjoints) {
                let loss = |h: f64| {
                    let mut moved = inputs.clone();
                    match input {
                        Some((slot, index)) => moved.slot(slot)[index] += h,
                        // The argument's value moves every derivative of the activation.
                        None => (0..=order).for_each(|n| moved.phi[n] += h * inputs.phi[n + 1]),
                    }
                    moved.run(&forward).iter().zip(&inputs.seed).map(|(y, s)| y * s).sum::<f64>()
                };
                let h = 1e-4;
                // Richardson: the rules are polynomials of degree at most 7.
                let (d1, d2) = ((loss(h) - loss(-h)) / (2.0 * h), (loss(2.0 * h) - loss(-2.0 * h)) / (4.0 * h));
                let expected = (4.0 * d1 - d2) / 3.0;
                assert!((adjoint - expected).abs() <= 1e-8 * expected.abs().max(10.0), "{adjoint} not {expected}");
            }
        }
    }
}

#[test]
fn seeds_of_channels_that_are_not_read_do_not_occur() {
    let set = minimal(&[iterated(&laplacian(2, 2), 2)]);
    let read: Vec<bool> = (0..set.len()).map(|k| k == 0 || k == 8).collect();
    for rule in RULES {
        let (forward, adjoint) = rule_programs(rule(&set).unwrap(), &read).unwrap();
        for (k, output) in forward.outputs.iter().enumerate() {
            assert!(read[k] || output.is_none());
        }
        for op in &adjoint.ops {
            if let Op::Input(Slot::Seed, k) = op {
                assert!(read[*k]);
            }
        }
    }
}

/// Operations per unit and point of the hottest code there is: a change here is a change of speed.
#[test]
fn von_karman_takes_about_a_hundred_operations() {
    let set = minimal(&[iterated(&laplacian(2, 2), 2), partial(&[1, 1])]);
    let all = vec![true; set.len()];
    let count = |rule: MakeRule| {
        let (forward, adjoint) = rule_programs(rule(&set).unwrap(), &all).unwrap();
        (forward.operations(), adjoint.operations())
    };
    assert_eq!(count(channels::compose), (48, 125));
    assert_eq!(count(channels::affine), (16, 48));
    assert_eq!(count(channels::product), (47, 102));
}
