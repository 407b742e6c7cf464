//! Going on from a checkpoint gives the same bits as not stopping: every method, both precisions, clouds, local functions.

use nisp::local::Local;
use nisp::network::Architecture;
use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Checkpoint, Optimizer, RecoverError, Settings, Solution, Width, recover, resume};
use nisp_equations::{Prepared, Request, catalogue};

fn prepared(entry: &str, scene: Option<&str>, network: bool) -> Prepared {
    let entry = catalogue().into_iter().find(|known| known.name == entry).expect("an entry");
    let request = Request { scene: scene.map(String::from), network, ..Request::default() };
    entry.prepare(&request).expect("the repository's example")
}

fn settings(optimizer: Optimizer, precision: Width) -> Settings {
    let architecture = Architecture { width: 6, ..Settings::default().architecture };
    Settings { optimizer, precision, architecture, budget: None, ..Settings::default() }
}

fn run(prepared: &Prepared, settings: &Settings, iterations: u64, threads: usize, from: Option<&[u8]>) -> Solution {
    let settings = Settings { iterations: Some(iterations), threads, ..settings.clone() };
    let monitor = &mut |_: nisp::Report<'_>| Flow::Continue;
    let solution = match from {
        None => recover(&prepared.problem, &settings, monitor),
        // By way of the bytes of a file.
        Some(bytes) => resume(&prepared.problem, &settings, &Checkpoint::from_bytes(bytes).expect("whole"), monitor),
    };
    solution.expect("a solution")
}

/// Stops after each of `stops` steps and goes on to `iterations`, on another number of threads.
fn stops_leave_no_trace(prepared: &Prepared, settings: &Settings, stops: &[u64], iterations: u64) {
    let straight = run(prepared, settings, iterations, 1, None);
    for &stop in stops {
        let first = run(prepared, settings, stop, 2, None);
        let resumed = run(prepared, settings, iterations, 3, Some(&first.checkpoint.to_bytes()));
        let what = format!("{:?} {:?} after {stop}", settings.optimizer, settings.precision);
        assert_eq!(resumed.loss.to_bits(), straight.loss.to_bits(), "{what}");
        assert_eq!((resumed.status, resumed.iterations), (straight.status, straight.iterations), "{what}");
        assert!(resumed.checkpoint.to_bytes() == straight.checkpoint.to_bytes(), "{what}");
        let at = &prepared.points[..prepared.points.len().min(60)];
        assert_eq!(resumed.evaluate(at), straight.evaluate(at), "{what}");
    }
}

#[test]
fn every_method_goes_on_with_the_same_bits() {
    let pendulum = prepared("pendulum", None, true);
    for optimizer in Optimizer::ALL {
        // The evidence chooses its weights first after fifteen steps.
        let stops: &[u64] = if optimizer == Optimizer::Evidence { &[1, 16, 22] } else { &[1, 7] };
        stops_leave_no_trace(&pendulum, &settings(optimizer, Width::F64), stops, 26);
    }
    for optimizer in [Optimizer::Adam, Optimizer::Lbfgs] {
        stops_leave_no_trace(&pendulum, &settings(optimizer, Width::F32), &[7], 12);
    }
}

#[test]
fn a_converged_run_is_the_same_however_often_it_stopped() {
    let plate = prepared("plate", None, true);
    let settings = settings(Optimizer::Marquardt, Width::F64);
    let straight = run(&plate, &settings, 100_000, 2, None);
    // Its steps come to their end, whatever the verdict thinks of six units.
    assert!(matches!(straight.status, Status::Converged | Status::Inconsistent), "{:?}", straight.status);
    let mut bytes = run(&plate, &settings, 5, 2, None).checkpoint.to_bytes();
    for stop in [6, 11, 100_000] {
        bytes = run(&plate, &settings, stop, 2, Some(&bytes)).checkpoint.to_bytes();
    }
    assert!(bytes == straight.checkpoint.to_bytes());
}

#[test]
fn single_precision_gives_way_to_double_with_the_same_bits() {
    let circuit = prepared("rlc", None, true);
    let settings = settings(Optimizer::Lbfgs, Width::Auto);
    let promoted = run(&circuit, &settings, 2000, 2, None);
    assert_eq!(promoted.precision(), "f32, then f64", "a run that ends in double precision");
    // In single precision, and in double.
    stops_leave_no_trace(&circuit, &settings, &[50, 1990], 2000);
}

#[test]
fn assignments_of_a_cloud_are_those_of_the_last_step() {
    let membrane = prepared("membrane", None, true);
    stops_leave_no_trace(&membrane, &settings(Optimizer::Adam, Width::F64), &[4], 7);
}

#[test]
fn local_functions_go_on_on_either_lattice() {
    let membrane = prepared("membrane", None, false);
    // Sixteen cells first, then these.
    let local = membrane.local.map(|local| Local { cells: 18, finer: 1, ..local });
    let settings =
        Settings { carrier: local.map_or(Carrier::Auto, Carrier::Local), ..settings(Optimizer::Auto, Width::F64) };
    let coarse = run(&membrane, &settings, 2, 2, None);
    assert_eq!(coarse.checkpoint.iterations(), 1, "the step before the last, which is repeated");
    stops_leave_no_trace(&membrane, &settings, &[3, 8], 9);
}

#[test]
fn a_checkpoint_of_another_problem_is_refused() {
    let circuit = prepared("rlc", None, true);
    let own = settings(Optimizer::Lbfgs, Width::F64);
    let checkpoint = run(&circuit, &own, 3, 1, None).checkpoint;
    let refused = |prepared: &Prepared, settings: &Settings| {
        let result = resume(&prepared.problem, settings, &checkpoint, &mut |_| Flow::Continue);
        matches!(result, Err(RecoverError::Checkpoint(nisp::CheckpointError::Other)))
    };
    assert!(refused(&prepared("pendulum", None, true), &own));
    assert!(refused(&prepared("rlc", Some("free"), true), &own));
    for other in [
        Settings { seed: 1, ..own.clone() },
        Settings { precision: Width::F32, ..own.clone() },
        Settings { optimizer: Optimizer::Adam, ..own.clone() },
        Settings { architecture: Architecture { width: 7, ..own.architecture }, ..own.clone() },
    ] {
        assert!(refused(&circuit, &other), "{other:?}");
    }
    let mut one_parameter = prepared("rlc", None, true);
    one_parameter.problem.set_parameter("a", 7.000_000_000_000_001).expect("a parameter");
    assert!(refused(&one_parameter, &own));
}
