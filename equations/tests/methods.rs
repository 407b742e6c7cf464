//! Every method takes every equation, in every precision that it works in.

use std::f64::consts::TAU;
use std::time::Duration;

use nisp::local::Local;
use nisp::network::Architecture;
use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Optimizer, RecoverError, Settings, Solution, Width, recover};
use nisp_data::Table;
use nisp_equations::{Prepared, Request, catalogue, noisy_copy};

fn prepared(name: &str) -> Prepared {
    let entry = catalogue().into_iter().find(|entry| entry.name == name).unwrap();
    entry.prepare(&Request { network: true, ..Request::default() }).unwrap()
}

fn run(prepared: &Prepared, settings: &Settings) -> Result<Solution, RecoverError> {
    recover(&prepared.problem, settings, &mut |_| Flow::Continue)
}

fn narrow(width: usize) -> Architecture {
    Architecture { width, ..Settings::default().architecture }
}

#[test]
fn each_method_takes_each_equation() {
    for entry in catalogue() {
        let prepared = prepared(entry.name);
        for optimizer in Optimizer::ALL {
            let settings = Settings {
                optimizer,
                architecture: narrow(4),
                iterations: Some(2),
                budget: None,
                ..Settings::default()
            };
            match run(&prepared, &settings) {
                Ok(solution) => assert!(solution.loss.is_finite(), "{} {}", entry.name, optimizer.name()),
                // Not every equation has a head in which all of its terms are linear.
                Err(RecoverError::NotLinear) => assert_eq!(optimizer, Optimizer::Projection, "{}", entry.name),
                Err(error) => panic!("{} {}: {error}", entry.name, optimizer.name()),
            }
        }
    }
}

#[test]
fn double_precision_goes_on_where_single_stops() {
    let prepared = prepared("rlc");
    let settings = |precision| Settings {
        precision,
        optimizer: Optimizer::Lbfgs,
        architecture: narrow(12),
        iterations: Some(3000),
        budget: None,
        ..Settings::default()
    };
    let [single, both] = [Width::F32, Width::Auto].map(|width| run(&prepared, &settings(width)).unwrap());
    assert_eq!((single.precision(), both.precision()), ("f32", "f32, then f64"));
    assert!(both.loss < 0.3 * single.loss, "{} {}", both.loss, single.loss);
    assert!(both.iterations > single.iterations);
}

#[test]
fn wide_networks_get_the_method_that_wins_a_trial() {
    let prepared = prepared("rlc");
    let settings = Settings { architecture: narrow(64), iterations: Some(3), budget: None, ..Settings::default() };
    let solution = run(&prepared, &settings).unwrap();
    let tried = [Optimizer::Lbfgs, Optimizer::GaussNewton];
    assert!(tried.contains(&solution.optimizer), "{}", solution.optimizer.name());
    // The trial counts steps, not seconds.
    assert_eq!(run(&prepared, &settings).unwrap().optimizer, solution.optimizer);
}

#[test]
fn an_unresolved_answer_says_so() {
    let prepared = prepared("pendulum");
    let settings = Settings {
        optimizer: Optimizer::Lbfgs,
        architecture: narrow(2),
        iterations: Some(5),
        budget: Some(Duration::from_secs(60)),
        ..Settings::default()
    };
    let solution = run(&prepared, &settings).unwrap();
    assert_eq!(solution.status, Status::Budget);
    let said = |words: &str| solution.verdict.failed().any(|check| check.message.contains(words));
    assert!(said("`q` is not resolved"), "{:?}", solution.verdict);
}

#[test]
fn a_rhythm_as_weak_as_the_noise_is_not_missed_in_silence() {
    let entry = catalogue().into_iter().find(|entry| entry.name == "rlc").unwrap();
    let times: Vec<f64> = (0..400).map(|i| 0.005 * f64::from(i)).collect();
    let hum: Vec<f64> = times.iter().map(|t| 0.02 * (TAU * 12.5 * t).sin()).collect();
    let mut truth = Table::empty();
    truth.push("t", "s", &times).unwrap();
    truth.push("v", "V", &hum).unwrap();
    let copy = noisy_copy(&truth, entry.scene(None).unwrap().schema, 1, 0.02, 1).unwrap();
    let request = Request { parameters: vec![("f0".into(), 0.0)], ..Request::default() };
    let circuit = entry.series().unwrap().bind(&entry, &request, &copy, None).unwrap();
    // Two units a layer do not follow 25 periods.
    let settings = Settings { architecture: narrow(2), iterations: Some(30), budget: None, ..Settings::default() };
    let solution = run(&circuit, &settings).unwrap();
    let fails = |what: &str| solution.verdict.failed().any(|check| check.check == what);
    let says = |what: &str| solution.verdict.failed().any(|check| check.message.contains(what));
    assert!(says("up and down 25 times") && !fails("misfit"), "{:?}", solution.verdict);
}

#[test]
fn without_time_for_the_fine_lattice_the_answer_is_said_to_be_coarse() {
    let entry = catalogue().into_iter().find(|entry| entry.name == "membrane").unwrap();
    let membrane = entry.prepare(&Request::default()).unwrap();
    let local = membrane.local.map(|local| Local { cells: 18, ..local });
    let solution = run(
        &membrane,
        &Settings {
            carrier: local.map_or(Carrier::Auto, Carrier::Local),
            budget: Some(Duration::ZERO),
            ..Settings::default()
        },
    )
    .unwrap();
    assert_eq!(solution.status, Status::NotConverged);
    let says = |what: &str| solution.warnings.iter().any(|warning| warning.message.contains(what));
    assert!(says("before the equations were solved") && says("coarse"), "{:?}", solution.warnings);
}
