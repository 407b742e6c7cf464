//! The rivals on the repository's data. Bounds are loose: they say that a method works, not how well.

use std::path::Path;

use nisp_data::Table;
use nisp_equations::rivals::{
    Estimate, Measurements, Pendulum, RivalError, Rlc, collocation, mean_abs_error, noise_level, savitzky_golay,
    savitzky_golay_oracle, smoothing_spline, zero_error,
};

fn table(name: &str) -> Table {
    Table::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../data").join(name)).unwrap()
}

/// The error of a method on one run, and of the answer zero.
fn score(
    run: &str,
    noise: &str,
    method: impl Fn(&Measurements<'_>, &[f64], &[f64]) -> Result<Estimate, RivalError>,
) -> (f64, f64) {
    let (observed, truth) = (table(&format!("pendulum/{run}_obs.csv")), table(&format!("pendulum/{run}_truth.csv")));
    let headers = ["q_m", "psi_rad", "phi_rad"].map(|name| format!("{name}_sigma{noise}"));
    let states = headers.each_ref().map(|header| observed.column(header).unwrap());
    let noise = [noise.parse().unwrap(); 3];
    let data = Measurements { times: observed.column("t").unwrap(), states: &states, noise: &noise };
    let (at, f) = (truth.column("t").unwrap(), truth.column("f").unwrap());
    (mean_abs_error(&method(&data, at, f).unwrap().source, f), zero_error(f))
}

#[test]
fn exact_measurements_give_the_force() {
    let system = Pendulum::default();
    let (golay, zero) = score("run_01", "0", |data, at, f| savitzky_golay_oracle(&system, data, 6, at, f));
    let (spline, _) = score("run_01", "0", |data, at, _| smoothing_spline(&system, data, at));
    let (direct, _) = score("run_01", "0", |data, at, _| collocation(&system, data, 1e-3, at));
    println!("zero {zero:.1e}, Savitzky-Golay {golay:.1e}, spline {spline:.1e}, collocation {direct:.1e}");
    assert!(golay < 0.05 * zero && spline < 0.3 * zero && direct < 0.05 * zero);
}

#[test]
fn collocation_with_evidence_withstands_noise() {
    let system = Pendulum::default();
    let (direct, zero) = score("run_01", "0.01", |data, at, _| collocation(&system, data, 1e-2, at));
    let (golay, _) = score("run_01", "0.01", |data, at, _| savitzky_golay(&system, data, 21, 4, at));
    println!("zero {zero:.1e}, collocation {direct:.1e}, Savitzky-Golay {golay:.1e}");
    assert!(direct < 0.8 * zero && direct < golay);
}

#[test]
fn the_circuit_gives_its_voltage_back() {
    let data = table("rlc/rlc_exponential.csv");
    let system = Rlc::default();
    let t = data.column("t").unwrap();
    let states = [data.column("v_V").unwrap()];
    let measured = Measurements { times: t, states: &states, noise: &[0.0] };
    let truth = data.column("f_V").unwrap();
    let direct = collocation(&system, &measured, 1e-4, t).unwrap();
    let golay = savitzky_golay(&system, &measured, 21, 4, t).unwrap();
    let spline = smoothing_spline(&system, &measured, t).unwrap();
    let errors = [&direct, &golay, &spline].map(|estimate| mean_abs_error(&estimate.source, truth));
    println!("collocation, Savitzky-Golay, spline: {errors:?}");
    assert!(errors.iter().all(|&error| error < 0.02));
}

#[test]
fn senseless_input_is_refused() {
    let system = Rlc::default();
    let times = [0.0, 1.0, 0.5];
    let states = [&times[..]];
    let data = Measurements { times: &times, states: &states, noise: &[0.0] };
    assert!(savitzky_golay(&system, &data, 3, 2, &times).is_err());
    assert!(savitzky_golay(&system, &data, 2, 2, &times).is_err());
    assert!(smoothing_spline(&Pendulum::default(), &data, &times).is_err());
    assert!(collocation(&system, &data, 0.0, &times).is_err());
}

#[test]
fn the_noise_is_found_where_there_is_some() {
    let data = table("rlc/rlc_exponential.csv");
    let t = data.column("t").unwrap();
    let noisy = noise_level(t, data.column("v_obs_sigma0.01_V").unwrap()).unwrap();
    assert!((noisy - 0.01).abs() < 1e-3, "{noisy}");
    assert_eq!(noise_level(t, data.column("v_V").unwrap()).unwrap(), 0.0);
    assert!(noise_level(&t[..3], &t[..3]).is_err());
}
