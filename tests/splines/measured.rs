//! Measurements that are not plain: with outliers, with noise that is a share of every value, or of a logarithm.

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem};
use nisp_interpreter::interpret;

use crate::{normals, of, solve};

interpret! {
    /// A culture in a vessel that is fed, whose growth is sought.
    mod vessel {
        units: off;
        coordinates: t;
        fields: X, G;
        sources: mu;
        on growing { cells: d(X, t) == (mu - 0.3) * X; food: d(G, t) == 0.3 * (10 - G) - mu * X / 0.45; }
        on samples { observe X, G; }
        scene recover { }
    }
}

interpret! {
    /// A vessel that runs empty while `q` fills it, of whose level a logarithm is measured.
    mod gauge {
        units: off;
        coordinates: t;
        fields: u;
        sources: q;
        on inside { balance: d(u, t) == q - u; }
        on samples { observe level: ln(u) ~ lnu; }
        scene recover { }
    }
}

interpret! {
    /// What decays at an unknown rate.
    mod decay {
        units: off;
        coordinates: t;
        fields: u;
        parameters: k = 1;
        on inside { decay: d(u, t) == -k * u; }
        on samples { observe u; }
        scene rate { learn k; }
    }
}

/// Growth of a culture in a vessel that is fed, by steps of Runge and Kutta.
fn culture(times: &[f64]) -> [Vec<f64>; 2] {
    let slope = |t: f64, [x, g]: [f64; 2]| {
        let mu = growth(t);
        [(mu - 0.3) * x, 0.3 * (10.0 - g) - mu * x / 0.45]
    };
    let mut state = [0.5, 8.0];
    let mut found = [vec![state[0]], vec![state[1]]];
    for ends in times.windows(2) {
        let h = (ends[1] - ends[0]) / 20.0;
        for step in 0..20 {
            let t = ends[0] + h * f64::from(step);
            let moved = |k: [f64; 2], share: f64| [state[0] + share * h * k[0], state[1] + share * h * k[1]];
            let a = slope(t, state);
            let b = slope(t + h / 2.0, moved(a, 0.5));
            let c = slope(t + h / 2.0, moved(b, 0.5));
            let d = slope(t + h, moved(c, 1.0));
            state = [0, 1].map(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        found.iter_mut().zip(state).for_each(|(own, value)| own.push(value));
    }
    found
}

fn growth(t: f64) -> f64 {
    0.35 + 0.15 * (0.4 * t).sin()
}

#[test]
fn a_robust_loss_leaves_out_outliers_and_nothing_else() {
    let times: Vec<f64> = (0..161).map(|i| 0.15 * f64::from(i)).collect();
    let mut normal = normals(5);
    let measured = culture(&times).map(|own| own.into_iter().map(|x| x + 0.03 * normal()).collect::<Vec<f64>>());
    let mut spoiled = measured.clone();
    [12, 47, 90, 133].into_iter().for_each(|row| spoiled[0][row] += 3.0);
    for columns in [measured, spoiled] {
        let mut problem = Problem::new(vessel::scene("recover"));
        problem.set_robust(true);
        problem.set_group("growing", times.clone().into(), vec![]).unwrap();
        problem.set_group("samples", times.clone().into(), columns.into()).unwrap();
        let solution = solve(&problem, Carrier::Splines);
        assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
        let found = of(&solution.evaluate(&times), "mu").values.clone();
        let error = times.iter().zip(&found).map(|(&t, mu)| (mu - growth(t)).abs()).sum::<f64>() / 161.0;
        assert!(error < 0.02, "{error}");
    }
}

#[test]
fn noise_that_is_a_share_of_every_value_is_no_misfit() {
    let times: Vec<f64> = (0..200).map(|i| 10.0 * f64::from(i) / 199.0).collect();
    let solved = |truth: &dyn Fn(f64) -> f64| {
        let mut normal = normals(5);
        let values = times.iter().map(|&t| truth(t) * (1.0 + 0.05 * normal())).collect();
        let mut problem = Problem::new(decay::scene("rate"));
        problem.set_group("inside", times.clone().into(), vec![]).unwrap();
        problem.set_group("samples", times.clone().into(), vec![values]).unwrap();
        solve(&problem, Carrier::Splines)
    };
    let mut right = solved(&|t| 100.0 * (-0.4 * t).exp());
    assert_eq!(right.status, Status::Converged, "{:?}", right.verdict);
    let rate = &right.learned()[0];
    assert!((rate.value - 0.4).abs() < 4.0 * rate.deviation.unwrap(), "{rate:?}");
    // Another law with the same noise.
    assert_eq!(solved(&|t| 100.0 / (1.0 + 0.8 * t)).status, Status::Inconsistent);
}

#[test]
fn a_logarithm_is_measured_of_a_field_that_starts_at_zero() {
    let (u, q) = (|t: f64| 3.0 + (0.5 * t).sin(), |t: f64| 3.0 + (0.5 * t).sin() + 0.5 * (0.5 * t).cos());
    let times: Vec<f64> = (0..200).map(|i| 20.0 * f64::from(i) / 199.0).collect();
    let mut normal = normals(3);
    let logarithms = times.iter().map(|&t| u(t).ln() + 0.003 * normal()).collect();
    let mut problem = Problem::new(gauge::scene("recover"));
    problem.set_group("inside", times.clone().into(), vec![]).unwrap();
    problem.set_group("samples", times.clone().into(), vec![logarithms]).unwrap();
    let solution = solve(&problem, Carrier::Splines);
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict);
    let found = of(&solution.evaluate(&times), "q").values.clone();
    let off = found.iter().zip(&times).map(|(found, &t)| (found - q(t)).powi(2)).sum::<f64>() / times.len() as f64;
    assert!(off.sqrt() < 0.03, "{off}");
}
