//! A record smoothed as it comes: beside the same record solved as a whole, beside closed forms, and where rows are spoiled.

use nisp::solve::driver::Flow;
use nisp::{Carrier, FixedLagSmoother, LagSettings, Problem, SceneRef, Settings, Smoothed, recover, scene};

nisp::pde! {
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

nisp::pde! {
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
    let (rate, bend) = (1.3 * (1.3 * t).cos() - 1.45 * (2.9 * t).sin(), -1.69 * (1.3 * t).sin() - 4.205 * (2.9 * t).cos());
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
    let rows = record(200, 0.1, 0.02);
    let mut smoother = smoother(scene::<driven::recover::Scene>(), LagSettings { lag: Some(4.0), first_rows: 200 });
    let found = smoothed(&mut smoother, &rows);
    assert_eq!(found.len(), rows.len());
    let mut problem = Problem::new(scene::<driven::recover::Scene>());
    let times: Vec<f64> = rows.iter().map(|row| row.0).collect();
    problem.set_group("motion", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.clone().into(), vec![rows.iter().map(|row| row.1).collect()]).unwrap();
    let settings = Settings { carrier: Carrier::Splines, ..Settings::default() };
    let mut whole = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    let whole = whole.evaluate_with_errors(&times);
    for (at, found) in found.iter().enumerate() {
        for (head, (value, deviation)) in found.heads.iter().enumerate() {
            let (exact, bar) = (whole[head].values[at], whole[head].deviations.as_ref().unwrap()[at]);
            println!("{at} {head} {value:.5} {exact:.5} {deviation:.5} {bar:.5} lag {}", found.lag);
        }
    }
}

#[test]
fn a_long_record_is_right_by_its_closed_form() {
    for (scene, cubic) in [(scene::<driven::recover::Scene>(), 0.0), (scene::<hard::recover::Scene>(), 3.0)] {
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
        let last = found.last().unwrap();
        println!("lag {lag} error {} cover {} misfit {}", (square / size).sqrt(), inside as f64 / count as f64, last.misfit);
    }
}
