//! Every method resumes from its saved state with the same bits, and refuses a state that is not its own.

mod solve_common;

use nisp_runtime::solve::adam::{Adam, AdamSettings};
use nisp_runtime::solve::broyden::{Broyden, Update};
use nisp_runtime::solve::empirical_bayes::{EmpiricalBayes, EmpiricalBayesSettings};
use nisp_runtime::solve::fault::Kind;
use nisp_runtime::solve::gauss_newton::GaussNewton;
use nisp_runtime::solve::lbfgs::Lbfgs;
use nisp_runtime::solve::marquardt::Marquardt;
use nisp_runtime::solve::method::{Method, Verdict};
use nisp_runtime::solve::objective::{BlockKind, Objective};
use nisp_runtime::solve::prior::WeightPrior;
use solve_common::rows::{Rows, exponential};

type Make = fn() -> Box<dyn Method<f64, Rows>>;

const START: [f64; 3] = [1.0, 0.1, 0.0];

/// All methods in double precision.
const METHODS: [Make; 7] = [
    || Box::new(Adam::new(START.to_vec(), AdamSettings { rate: 0.02, ..AdamSettings::default() })),
    || Box::new(Lbfgs::new(START.to_vec(), 4)),
    || Box::new(Broyden::new(START.to_vec(), Update::Bfgs)),
    || Box::new(Broyden::new(START.to_vec(), Update::SelfScaledBroyden)),
    || Box::new(Marquardt::new(START.to_vec(), WeightPrior::uniform(1e-4, 3))),
    || Box::new(GaussNewton::new(START.to_vec(), WeightPrior::uniform(1e-4, 3), 10)),
    || {
        let settings = EmpiricalBayesSettings { warm_up: 2, every: 1, ..EmpiricalBayesSettings::default() };
        Box::new(EmpiricalBayes::new(START.to_vec(), WeightPrior::uniform(1.0, 3), settings))
    },
];

fn problem() -> Rows {
    let mut rows = exponential(25);
    rows.blocks[0].kind = BlockKind::ObservationOfUnknownNoise;
    rows
}

fn bits(theta: &[f64]) -> Vec<u64> {
    theta.iter().map(|x| x.to_bits()).collect()
}

#[test]
fn resuming_gives_the_same_bits() {
    for make in METHODS {
        for stop in [0, 1, 5, 8] {
            let (mut straight, mut rows) = (make(), problem());
            (0..stop).for_each(|_| assert!(straight.step(&mut rows).is_ok()));
            let state = straight.save();
            let (mut resumed, mut other_rows) = (make(), problem());
            resumed.restore(&state).unwrap();
            for step in 0..6 {
                let a = straight.step(&mut rows).unwrap();
                let b = resumed.step(&mut other_rows).unwrap();
                let name = straight.name();
                assert_eq!(bits(straight.theta()), bits(resumed.theta()), "{name} {stop} + {step}");
                assert_eq!(a.loss.to_bits(), b.loss.to_bits(), "{name} {stop} + {step}");
            }
            assert_eq!(straight.save(), resumed.save(), "{}", straight.name());
        }
    }
}

#[test]
fn single_precision_resumes_too() {
    let mut function = solve_common::Narrow(solve_common::rosenbrock(2));
    let function: &mut dyn Objective<f32> = &mut function;
    let mut straight = Lbfgs::new(vec![-1.2_f32, 1.0], 5);
    (0..7).for_each(|_| assert!(straight.step(function).is_ok()));
    let mut resumed = Lbfgs::new(vec![0.0_f32; 2], 5);
    let state = Method::<f32, dyn Objective<f32>>::save(&straight);
    Method::<f32, dyn Objective<f32>>::restore(&mut resumed, &state).unwrap();
    for _ in 0..5 {
        let (a, b) = (straight.step(function).unwrap(), resumed.step(function).unwrap());
        assert_eq!(a, b);
    }
}

#[test]
fn a_spoilt_state_is_refused_and_changes_nothing() {
    for make in METHODS {
        let (mut method, mut rows) = (make(), problem());
        (0..4).for_each(|_| assert!(method.step(&mut rows).is_ok()));
        let good = method.save();
        let mut not_a_number = good.clone();
        not_a_number.vectors[0].1[1] = f64::NAN;
        let mut short = good.clone();
        short.vectors[0].1.pop();
        let mut missing = good.clone();
        missing.counters.clear();
        let mut foreign = good.clone();
        foreign.method = "newton".into();
        for bad in [not_a_number, short, missing, foreign] {
            let fault = method.restore(&bad).unwrap_err();
            assert_eq!(fault.what, Kind::State);
            assert_eq!(method.save(), good, "{}", method.name());
        }
    }
}

#[test]
fn every_method_gets_over_a_passing_fault() {
    for make in METHODS {
        for ahead in [1, 2, 3] {
            let (mut method, mut rows) = (make(), problem());
            (0..4).for_each(|_| assert!(method.step(&mut rows).is_ok()));
            rows.faulty = vec![rows.calls + ahead];
            let mut last = method.theta().to_vec();
            let mut moved = false;
            for _ in 0..8 {
                let step = method.step(&mut rows).unwrap();
                if matches!(step.verdict, Verdict::Faulty(_) | Verdict::Refused) {
                    assert_eq!(bits(method.theta()), bits(&last), "{}", method.name());
                }
                let past = rows.calls >= rows.faulty[0];
                moved |= past && matches!(step.verdict, Verdict::Moved | Verdict::Changed);
                last = method.theta().to_vec();
            }
            assert!(moved, "{} {ahead}", method.name());
        }
    }
}

#[test]
fn every_method_stops_at_a_lasting_fault() {
    for make in METHODS {
        let (mut method, mut rows) = (make(), problem());
        (0..3).for_each(|_| assert!(method.step(&mut rows).is_ok()));
        rows.faulty = (rows.calls + 1..rows.calls + 1000).collect();
        let before = method.theta().to_vec();
        let fault = (0..5).find_map(|_| method.step(&mut rows).err());
        assert_eq!(fault.expect("stops").term, "balance", "{}", method.name());
        assert_eq!(bits(method.theta()), bits(&before), "{}", method.name());
    }
}
