//! A record smoothed as it comes: beside the same record solved as a whole, beside closed forms, and where rows are spoiled.

use nisp::solve::driver::Flow;
use nisp::{Carrier, FixedLagSmoother, LagSettings, Problem, SceneRef, Settings, Smoothed, recover};
use nisp_interpreter::interpret;

mod first;
mod given;
mod learned;
mod rows;

interpret! {
    /// A damped oscillator under an unknown drive.
    mod driven {
        units: off;
        coordinates: t;
        fields: y;
        sources: u;
        on motion { balance: d(y, t, 2) + 0.4 * d(y, t) + 4 * y == u; }
        on samples { observe y; }
        scene recover { }
    }
}

interpret! {
    /// A spring that hardens, under an unknown drive.
    mod hard {
        units: off;
        coordinates: t;
        fields: y;
        sources: u;
        on motion { balance: d(y, t, 2) + 0.4 * d(y, t) + 4 * y + 3 * y^3 == u; }
        on samples { observe y; }
        scene recover { }
    }
}

interpret! {
    /// A level that flows out as its root, under an unknown inflow.
    mod outflow {
        units: off;
        coordinates: t;
        fields: y;
        sources: u;
        on tank { balance: d(y, t) + 0.5 * sqrt(y) == u; }
        on samples { observe y; }
        scene recover { }
    }
}

interpret! {
    /// The first one over time: its drive may set in with the record.
    mod timed {
        coordinates: t [s];
        fields: y [m];
        sources: u [m/s^2];
        parameters: c [1/s] = 0.4, k [1/s^2] = 4;
        on motion { balance: d(y, t, 2) + c * d(y, t) + k * y == u; }
        on samples { observe y; }
        scene recover { }
    }
}

interpret! {
    /// The first one, with a drive that is known beside the unknown one.
    mod fed {
        units: off;
        coordinates: t;
        fields: y;
        sources: u;
        on motion { columns: fed; balance: d(y, t, 2) + 0.4 * d(y, t) + 4 * y == u + fed; }
        on samples { observe y; }
        scene recover { }
    }
}

interpret! {
    /// A spring that nobody knows, under an unknown force.
    mod spring {
        units: off;
        coordinates: t;
        fields: y;
        sources: u;
        parameters: c > 0 = 1, k > 0 = 10;
        on motion { balance: d(y, t, 2) + c * d(y, t) + k * y == u; }
        on samples { observe y; }
        scene recover { learn c, k; }
    }
}

interpret! {
    /// An oscillator that is left to itself.
    mod free {
        units: off;
        coordinates: t;
        fields: y;
        parameters: k = 4;
        on motion { balance: d(y, t, 2) + 0.1 * d(y, t) + k * y == 0; }
        on samples { observe y; }
        scene ring { }
    }
}

interpret! {
    /// A stirred tank that heats itself, and an unknown heater.
    mod tank {
        coordinates: t [min];
        fields: c [mol/l], T [K];
        sources: q [K/min];
        parameters: cold [K] = 300;
        let rate = 5e9 [1/min] * exp(-7500 [K] / T) * c;
        on tank {
            mass: d(c, t) == 0.1 [1/min] * (2 [mol/l] - c) - rate;
            heat: d(T, t) == 0.1 [1/min] * (cold - T) + 60 [K l/mol] * rate + q;
        }
        on samples { observe T; }
        scene recover { }
    }
}

/// Numbers of deviation one, the same every time: sums of twelve uniform ones (a linear congruential generator, Knuth).
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    move || (0..12).map(|_| uniform()).sum::<f64>() - 6.0
}

/// The motion `sin(1.3 t) + 0.5 cos(2.9 t)`, and the drive that it takes.
fn motion(t: f64) -> f64 {
    (1.3 * t).sin() + 0.5 * (2.9 * t).cos()
}

fn drive(t: f64, cubic: f64) -> f64 {
    let (rate, bend) =
        (1.3 * (1.3 * t).cos() - 1.45 * (2.9 * t).sin(), -1.69 * (1.3 * t).sin() - 4.205 * (2.9 * t).cos());
    bend + 0.4 * rate + 4.0 * motion(t) + cubic * motion(t).powi(3)
}

fn record(rows: usize, step: f64, sigma: f64) -> Vec<(f64, f64)> {
    let mut noise = noise(7);
    (0..rows).map(|i| i as f64 * step).map(|t| (t, motion(t) + sigma * noise())).collect()
}

fn smoother(scene: SceneRef, settings: LagSettings) -> FixedLagSmoother {
    FixedLagSmoother::new(Problem::new(scene), settings).unwrap()
}

fn smoothed(smoother: &mut FixedLagSmoother, rows: &[(f64, f64)]) -> Vec<Smoothed> {
    let mut found: Vec<Smoothed> = Vec::new();
    rows.iter().for_each(|(t, y)| found.extend(smoother.push(*t, &[*y]).unwrap()));
    found.extend(smoother.finish().unwrap());
    found
}

#[test]
fn a_linear_record_is_smoothed_as_it_is_solved() {
    let rows = record(400, 0.1, 0.02);
    let mut smoother = smoother(driven::scene("recover"), LagSettings { lag: Some(4.0), first_rows: 200 });
    let found = smoothed(&mut smoother, &rows);
    assert_eq!(found.len(), rows.len());
    let mut problem = Problem::new(driven::scene("recover"));
    let times: Vec<f64> = rows.iter().map(|row| row.0).collect();
    problem.set_group("motion", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.clone().into(), vec![rows.iter().map(|row| row.1).collect()]).unwrap();
    let settings = Settings { carrier: Carrier::Splines, ..Settings::default() };
    let mut whole = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    let whole = whole.evaluate_with_errors(&times);
    for (at, found) in found.iter().enumerate() {
        assert!(found.lag >= 4.0 - 1e-9 || at >= 360, "row {at} waited for {}", found.lag);
        for (head, (value, deviation)) in found.heads.iter().enumerate() {
            let (exact, bar) = (whole[head].values[at], whole[head].deviations.as_ref().unwrap()[at]);
            // A stream knows noise and smoothness from its first rows, has one kind of smoothness, and its sources keep near to zero. Bars
            // of a whole record are of all kinds that may be right, and its sources keep near to a line.
            assert!((value - exact).abs() < 0.5 * bar, "row {at}: {value} beside {exact} +- {bar}");
            assert!((0.7..1.6).contains(&(deviation / bar)), "row {at}: {deviation} beside {bar}");
        }
    }
}

#[test]
fn a_long_record_is_right_by_its_closed_form() {
    for (scene, cubic) in [(driven::scene("recover"), 0.0), (hard::scene("recover"), 3.0)] {
        let rows = record(3000, 0.05, 0.01);
        let mut smoother = smoother(scene, LagSettings::default());
        let found = smoothed(&mut smoother, &rows);
        assert_eq!(found.len(), rows.len());
        let lag = smoother.lag().unwrap();
        let (mut square, mut size, mut inside, mut count) = (0.0, 0.0, 0, 0);
        for found in &found[100..2900] {
            let (value, deviation) = found.heads[1];
            let error = value - drive(found.at, cubic);
            square += error * error;
            size += drive(found.at, cubic).powi(2);
            inside += usize::from(error.abs() < 2.0 * deviation);
            count += 1;
        }
        let error = (square / size).sqrt();
        assert!(error < 0.1, "{error} of the drive's size");
        assert!(inside as f64 > 0.93 * count as f64, "{inside} of {count} within two deviations");
        assert!(found.iter().all(Smoothed::is_sound));
        assert!(lag < 2.0, "a lag of {lag} is longer than a period of the drive");
    }
}

/// What a drive does in the first moments is hardly measured: the bars have to say so.
#[test]
fn a_drive_that_sets_in_with_the_record_is_within_its_bars() {
    // By size and rate: what dies away slowly, and what does within the first rows.
    let parts = [(0.5_f64, 0.5_f64), (-0.05, 20.0)];
    let sum = |t: f64, of: &dyn Fn(f64) -> f64| parts.iter().map(|(a, r)| a * of(*r) * (-r * t).exp()).sum::<f64>();
    let mut noise = noise(5);
    let times = (0..300).map(|i| 0.05 * f64::from(i));
    let rows: Vec<(f64, f64)> = times.map(|t| (t, sum(t, &|_| 1.0) + 0.01 * noise())).collect();
    let found = smoothed(&mut smoother(timed::scene("recover"), LagSettings::default()), &rows);
    for found in &found[..20] {
        let exact = sum(found.at, &|r| r * r - 0.4 * r + 4.0);
        let (value, deviation) = found.heads[1];
        assert!((value - exact).abs() < 4.0 * deviation, "{}: {value} +- {deviation} for {exact}", found.at);
    }
}

/// A force that steps tells the spring by its ringing, to a window whose force is as rough all along as well.
#[test]
fn a_spring_is_learned_from_the_steps_of_its_force() {
    let (stiffness, steps) = (16.0_f64, [(0.0, 1.6), (6.0, 6.4), (13.0, -12.0)]);
    let frequency = (stiffness - 0.09).sqrt();
    let sum = |t: f64, of: &dyn Fn(f64) -> f64| -> f64 {
        steps.iter().filter(|(from, _)| *from <= t).map(|(from, size)| size * of(t - from)).sum()
    };
    let rings = |t: f64| {
        let swing = (frequency * t).cos() + 0.3 / frequency * (frequency * t).sin();
        (1.0 - (-0.3 * t).exp() * swing) / stiffness
    };
    let mut noise = noise(9);
    // It begins away from rest.
    let motion = |t: f64| 0.4 * (1.0 - stiffness * rings(t)) + sum(t, &rings);
    let times = (0..600).map(|i| f64::from(i) / 30.0);
    let rows: Vec<(f64, f64)> = times.map(|t| (t, motion(t) + 0.003 * noise())).collect();
    let found = smoothed(&mut smoother(spring::scene("recover"), LagSettings::default()), &rows);
    let is_quiet = |found: &&Smoothed| steps.iter().all(|(from, _)| (found.at - from).abs() > 0.6);
    let quiet: Vec<&Smoothed> = found[200..590].iter().filter(is_quiet).collect();
    let is_off = |found: &&&Smoothed| (found.heads[1].0 - sum(found.at, &|_| 1.0)).abs() > 4.0 * found.heads[1].1;
    let off = quiet.iter().filter(is_off).count();
    assert!(20 * off < quiet.len(), "{off} of {}", quiet.len());
}

/// An oscillator at rest until it is driven: `y = 1 - cos 3 s` for the time `s` after that. The first rows say that there is no drive.
#[test]
fn a_drive_that_sets_in_late_is_found() {
    let (begins, sigma) = (8.5, 0.01);
    let since = |t: f64| (t - begins).max(0.0);
    let drive = |t: f64| match since(t) {
        s if s > 0.0 => 4.0 + 5.0 * (3.0 * s).cos() + 1.2 * (3.0 * s).sin(),
        _ => 0.0,
    };
    let mut noise = noise(4);
    let times = (0..1000).map(|i| 0.02 * f64::from(i));
    let rows: Vec<(f64, f64)> = times.map(|t| (t, 1.0 - (3.0 * since(t)).cos() + sigma * noise())).collect();
    let found = smoothed(&mut smoother(driven::scene("recover"), LagSettings::default()), &rows);
    assert_eq!(found.len(), rows.len());
    assert!(found.iter().zip(&rows).all(|(found, row)| (found.at - row.0).abs() < 1e-9), "every row once, in order");
    let driven = &found[430..990];
    let sound: Vec<&Smoothed> = driven.iter().filter(|found| found.is_sound()).collect();
    assert!(10 * sound.len() > 8 * driven.len(), "{} of {} rows are sound", sound.len(), driven.len());
    let off = sound.iter().filter(|found| (found.heads[1].0 - drive(found.at)).abs() > 4.0 * found.heads[1].1).count();
    assert!(20 * off < sound.len(), "{off} of {} rows are off", sound.len());
}

/// Where a reaction depends on the temperature as `exp(-E / T)`, a whole step may lead to where nothing has a value. The truth is by
/// Runge and Kutta.
#[test]
fn a_tank_that_heats_itself_is_followed() {
    let heater = |t: f64| if (21.0..36.0).contains(&t) { 3.0 } else { 0.0 };
    let slope = |t: f64, [c, hot]: [f64; 2]| {
        let rate = 5e9 * (-7500.0 / hot).exp() * c;
        [0.1 * (2.0 - c) - rate, 0.1 * (300.0 - hot) + 60.0 * rate + heater(t)]
    };
    let step = 0.001;
    let next = |t: f64, y: [f64; 2]| {
        let ahead = |k: [f64; 2], by: f64| [y[0] + by * k[0], y[1] + by * k[1]];
        let k1 = slope(t, y);
        let k2 = slope(t + step / 2.0, ahead(k1, step / 2.0));
        let k3 = slope(t + step / 2.0, ahead(k2, step / 2.0));
        let k4 = slope(t + step, ahead(k3, step));
        std::array::from_fn(|i| y[i] + step / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    };
    let mut noise = noise(5);
    let (mut state, mut rows) = ([2.0, 300.0], Vec::new());
    for i in 0..60_000 {
        let t = f64::from(i) * step;
        if i % 60 == 0 {
            rows.push((t, state[1] + 0.03 * noise()));
        }
        state = next(t, state);
    }
    let found = smoothed(&mut smoother(tank::scene("recover"), LagSettings::default()), &rows);
    let driven = &found[430..990];
    let sound: Vec<&Smoothed> = driven.iter().filter(|found| found.is_sound()).collect();
    assert!(10 * sound.len() > 7 * driven.len(), "{} of {} rows are sound", sound.len(), driven.len());
    let off = sound.iter().filter(|found| (found.heads[2].0 - heater(found.at)).abs() > 4.0 * found.heads[2].1).count();
    assert!(20 * off < sound.len(), "{off} of {} rows are off", sound.len());
}

/// Where equations come with columns they hold up to the last row and no farther.
#[test]
fn a_known_column_is_taken_with_its_rows() {
    let rows: Vec<(f64, [f64; 2])> =
        record(1000, 0.05, 0.01).into_iter().map(|(t, y)| (t, [(0.9 * t).sin(), y])).collect();
    let mut smoother = smoother(fed::scene("recover"), LagSettings::default());
    let mut found = Vec::new();
    rows.iter().for_each(|(t, values)| found.extend(smoother.push(*t, values).unwrap()));
    found.extend(smoother.finish().unwrap());
    assert_eq!(found.len(), rows.len());
    let is_right = |found: &&Smoothed| {
        let exact = drive(found.at, 0.0) - (0.9 * found.at).sin();
        found.is_sound() && (found.heads[1].0 - exact).abs() < 4.0 * found.heads[1].1
    };
    let right = found[..980].iter().filter(is_right).count();
    assert!(right > 960, "{right} of 980 rows are sound and within four deviations");
}

/// A slow force and the spring that it bends tell one ratio, and not the stiffness.
#[test]
fn a_stiffness_that_rests_on_a_small_force_is_not_called_sound() {
    let mut noise = noise(6);
    let times = (0..600).map(|i| 0.05 * f64::from(i));
    let rows: Vec<(f64, f64)> = times.map(|t| (t, 0.5 * (0.3 * t).sin() + 0.003 * noise())).collect();
    let found = smoothed(&mut smoother(spring::scene("recover"), LagSettings::default()), &rows);
    // Later rows are asked anew.
    let sound = found[..400].iter().filter(|found| found.is_sound()).count();
    assert!(sound == 0, "{sound} of 400 rows are sound");
}

/// A wrong stiffness has nothing to hide behind where the drive is known to be zero: there is no source then.
#[test]
fn a_wrong_equation_is_told_from_a_right_one() {
    let free = |t: f64| (-0.05 * t).exp() * (2.0 * t).sin();
    let mut noise = noise(3);
    let rows: Vec<(f64, f64)> = (0..600).map(|i| 0.05 * f64::from(i)).map(|t| (t, free(t) + 0.01 * noise())).collect();
    for (stiffness, is_right) in [(4.0025, true), (5.0, false)] {
        let mut problem = Problem::new(free::scene("ring"));
        problem.set_parameter("k", stiffness).unwrap();
        let found = smoothed(&mut FixedLagSmoother::new(problem, LagSettings::default()).unwrap(), &rows);
        let sound = found[200..].iter().filter(|found| found.is_sound()).count();
        assert_eq!(sound > 390, is_right, "{sound} of 400 rows are sound for k = {stiffness}");
    }
}
