//! An oscillator with a hardening spring, `m y'' + c y' + a y + b y^3 = u`. The motion is a sum of sines with many periods, of which
//! the drive follows in closed form.

use nisp::solve::driver::{Flow, Status};
use nisp::{Carrier, Problem, Solution, recover, resume};
use nisp_interpreter::interpret;

use crate::{normals, of, settings, solve};

interpret! {
    /// An oscillator with an unknown drive.
    mod driven {
        coordinates: t [s];
        fields: y [V];
        sources: u [V];
        parameters: m [s^2] = 5e-6, c [s] = 2e-4, a = 1, b [1/V^2] = 3;
        on motion { balance: m * d(y, t, 2) + c * d(y, t) + a * y + b * y^3 == u; }
        on samples { observe y; }
        scene recover { }
    }
}

interpret! {
    /// The same oscillator with a drive that is measured, and coefficients that are not known.
    mod measured {
        coordinates: t [s];
        fields: y [V];
        parameters: m [s^2] = 1e-5, c [s] = 1e-4, a = 0.5, b [1/V^2] = 1;
        on samples {
            observe y;
            observe drive: m * d(y, t, 2) + c * d(y, t) + a * y + b * y^3 ~ u [V];
        }
        scene identify { learn m, c, a, b; }
    }
}

const M: f64 = 5e-6;
const C: f64 = 2e-4;
const A: f64 = 1.0;
const B: f64 = 3.0;
/// Samples a second.
const RATE: f64 = 600.0;

/// Frequencies in Hz, amplitudes in V and phases of the motion: eight and a half samples in the shortest period.
const WAVES: [(f64, f64, f64); 6] = [
    (11.0, 0.02, 0.3),
    (23.7, 0.015, 1.1),
    (37.2, 0.02, 2.9),
    (48.1, 0.02, 4.0),
    (61.3, 0.025, 5.2),
    (70.4, 0.015, 0.9),
];

/// Motion and drive.
fn oscillation(t: f64) -> (f64, f64) {
    driven_by(&WAVES, t)
}

/// Motion and drive, where the motion is a sum of waves.
fn driven_by(waves: &[(f64, f64, f64)], t: f64) -> (f64, f64) {
    let wave = |derivative: u32| -> f64 {
        let turned = f64::from(derivative) * std::f64::consts::FRAC_PI_2;
        let own = |&(hertz, amplitude, phase): &(f64, f64, f64)| {
            let omega = std::f64::consts::TAU * hertz;
            amplitude * omega.powi(derivative as i32) * (omega * t + phase + turned).sin()
        };
        waves.iter().map(own).sum()
    };
    let y = wave(0);
    (y, M * wave(2) + C * wave(1) + A * y + B * y.powi(3))
}

fn times(count: usize) -> Vec<f64> {
    (0..count).map(|i| i as f64 / RATE).collect()
}

/// A record of the motion with noise in V.
fn record(count: usize, noise: f64) -> Problem {
    record_of(&WAVES, count, noise)
}

/// A record of a motion that is a sum of waves.
fn record_of(waves: &[(f64, f64, f64)], count: usize, noise: f64) -> Problem {
    let mut normal = normals(7);
    let times = times(count);
    let y = times.iter().map(|&t| driven_by(waves, t).0 + noise * normal()).collect();
    let mut problem = Problem::new(driven::scene("recover"));
    let last = times[count - 1];
    problem
        .set_group("motion", (0..300).map(|i| last * f64::from(i) / 299.0).collect::<Vec<f64>>().into(), vec![])
        .unwrap();
    problem.set_group("samples", times.into(), vec![y]).unwrap();
    problem
}

/// Error of the drive beside the drive, root mean squares over a part of the samples.
fn share(drive: &[f64], part: std::ops::Range<usize>) -> f64 {
    let all = times(drive.len());
    let exact = |i: usize| oscillation(all[i]).1;
    let square = |value: &dyn Fn(usize) -> f64| part.clone().map(|i| value(i).powi(2)).sum::<f64>();
    (square(&|i| drive[i] - exact(i)) / square(&exact)).sqrt()
}

#[test]
fn a_record_with_many_periods_is_followed_and_the_choice_is_explained() {
    let mut solution = solve(&record(600, 0.0), Carrier::Auto);
    assert_eq!((solution.carrier, &*solution.carrier_reason), ("splines", "one coordinate"));
    assert_eq!(solution.status, Status::Converged);
    let drive = of(&solution.evaluate(&times(600)), "u").values.clone();
    let (whole, inside) = (share(&drive, 0..600), share(&drive, 20..580));
    assert!(whole < 0.06 && inside < 0.01, "{whole} and {inside}");
    let terms = solution.terms();
    let balance = terms.iter().find(|term| term.name == "motion.balance").unwrap();
    assert!(balance.rms < 1e-5 * balance.size, "{balance:?}");
}

/// A drive with as much of every frequency up to a third of a period a row, as generators of test signals make it: what neighbouring rows
/// share is the drive, and no noise that a filter has made smooth.
#[test]
fn a_drive_that_changes_from_row_to_row_is_no_filtered_noise() {
    let mut normal = normals(5);
    let wave = |hertz: f64| {
        let omega = std::f64::consts::TAU * hertz;
        let stiffness = (A - M * omega * omega).hypot(C * omega);
        (hertz, 0.01 / stiffness, 3.0 * normal())
    };
    let waves: Vec<(f64, f64, f64)> = (1..=200).map(f64::from).map(wave).collect();
    let solution = solve(&record_of(&waves, 800, 2e-5), Carrier::Auto);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let drive = of(&solution.evaluate(&times(800)), "u").values.clone();
    let exact: Vec<f64> = times(800).into_iter().map(|t| driven_by(&waves, t).1).collect();
    let square = |of: &dyn Fn(usize) -> f64| (20..780).map(|i| of(i).powi(2)).sum::<f64>();
    let off = (square(&|i| drive[i] - exact[i]) / square(&|i| exact[i])).sqrt();
    assert!(off < 0.1, "{off}");
}

#[test]
fn error_bars_cover_what_noise_does() {
    let mut solution = solve(&record(1200, 5e-4), Carrier::Splines);
    assert_eq!(solution.status, Status::Converged);
    let estimates = solution.evaluate_with_errors(&times(1200));
    let drive = of(&estimates, "u");
    let deviations = drive.deviations.as_ref().unwrap();
    let all = times(1200);
    let near = |i: &usize| (drive.values[*i] - oscillation(all[*i]).1).abs() < 2.0 * deviations[*i];
    let cover = (0..1200).filter(near).count() as f64 / 1200.0;
    assert!((0.88..=1.0).contains(&cover), "{cover}");
    assert!(share(&drive.values, 30..1170) < 0.05, "{}", share(&drive.values, 30..1170));
    let noise = solution.terms().iter().find(|term| term.observation).unwrap().noise.unwrap();
    assert!((0.5..1.6).contains(&(noise / 5e-4)), "{noise}");
}

#[test]
fn coefficients_are_learned_from_a_measured_drive() {
    let mut normal = normals(3);
    let all = times(900);
    let (y, u) = all.iter().map(|&t| oscillation(t)).map(|(y, u)| (y + 1e-4 * normal(), u + 1e-4 * normal())).unzip();
    let mut problem = Problem::new(measured::scene("identify"));
    problem.set_group("samples", all.into(), vec![y, u]).unwrap();
    let mut solution = solve(&problem, Carrier::Auto);
    assert_eq!((solution.carrier, solution.status), ("splines", Status::Converged));
    for (learned, exact) in solution.learned().iter().zip([M, C, A, B]) {
        let deviation = learned.deviation.unwrap();
        assert!((learned.value / exact - 1.0).abs() < 0.02, "{learned:?} is not {exact}");
        assert!((learned.value - exact).abs() < 4.0 * deviation, "{learned:?} is not {exact}");
    }
}

/// Two thirds of one wave.
#[test]
fn a_short_smooth_record_is_followed_too() {
    let mut normal = normals(11);
    let mut problem = Problem::new(driven::scene("recover"));
    let times: Vec<f64> = (0..100).map(|i| 1e-3 * f64::from(i)).collect();
    let wave = |t: f64| 0.05 * (20.0 * t).sin();
    let y = times.iter().map(|&t| wave(t) + 5e-4 * normal()).collect();
    problem.set_group("motion", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.clone().into(), vec![y]).unwrap();
    let mut solution = solve(&problem, Carrier::Auto);
    assert_eq!((solution.carrier, solution.status), ("splines", Status::Converged));
    let estimates = solution.evaluate_with_errors(&times);
    let found = of(&estimates, "u");
    let drive = |t: f64| {
        let y = wave(t);
        (A - M * 400.0) * y + C * (20.0 * t).cos() + B * y.powi(3)
    };
    let off = |i: usize| (found.values[i] - drive(times[i])).abs();
    let covered = (0..100).filter(|&i| off(i) < 2.0 * found.deviations.as_ref().unwrap()[i]).count();
    let largest = (0..100).map(off).fold(0.0, f64::max);
    assert!(largest < 5e-3 && covered >= 80, "{largest}, {covered} covered");
}

#[test]
fn a_resumed_run_has_the_bits_of_one_that_was_not_stopped() {
    let problem = record(300, 5e-4);
    let whole = solve(&problem, Carrier::Splines);
    let all = settings(Carrier::Splines);
    for stop in [3, 25, whole.iterations - 5] {
        let mut steps = 0;
        let part = recover(&problem, &all, &mut |_| {
            steps += 1;
            if steps == stop { Flow::Stop } else { Flow::Continue }
        });
        let part = part.unwrap();
        assert_eq!(part.status, Status::Interrupted);
        let resumed = resume(&problem, &all, &part.checkpoint, &mut |_| Flow::Continue).unwrap();
        assert_eq!(resumed.iterations, whole.iterations);
        let values = |solution: &Solution| of(&solution.evaluate(&times(300)), "u").values.clone();
        assert_eq!(values(&resumed), values(&whole), "stopped after {stop}");
    }
}
