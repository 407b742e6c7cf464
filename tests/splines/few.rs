//! Few values: exact ones tell scalars and sources to many digits, noisy ones have the bars of few.

use std::f64::consts::PI;

use nisp::solve::driver::Status;
use nisp::{Carrier, Problem, SceneRef};
use nisp_interpreter::interpret;

use crate::{normals, of, solve};

interpret! {
    /// Flow through a porous channel.
    mod channel {
        units: off;
        coordinates: x;
        fields: u;
        parameters: v in 0.1 .. 100 = 10, k in 1e-4 .. 1e-1 = 1e-2;
        on inside { balance: -v * d(u, x, 2) + u / k == 1000; }
        on walls { still: u == 0; }
        on samples { observe u; }
        scene porous { learn v, k; }
    }
}

interpret! {
    /// A load along a string.
    mod load {
        units: off;
        coordinates: x;
        fields: u;
        sources: q;
        on inside { balance: d(u, x, 2) == q; }
        on ends { held: u == 0; }
        on samples { observe u; }
        scene hung { }
    }
}

interpret! {
    /// A quantity that decays from an unknown beginning.
    mod decay {
        units: off;
        coordinates: x;
        fields: u;
        parameters: rate in 0.01 .. 100 = 1;
        on inside { balance: d(u, x) + rate * u == 0; }
        on samples { observe u; }
        scene falls { learn rate; }
    }
}

/// A problem over an interval whose field is measured at so many even places.
fn measured(
    scene: SceneRef,
    [low, high]: [f64; 2],
    count: usize,
    value: impl FnMut(f64) -> f64,
) -> (Problem, Vec<f64>) {
    let even =
        |count: usize| -> Vec<f64> { (0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect() };
    let mut problem = Problem::new(scene);
    problem.set_group("inside", even(300).into(), vec![]).unwrap();
    let places = even(count);
    let values = places.iter().copied().map(value).collect();
    problem.set_group("samples", places.clone().into(), vec![values]).unwrap();
    (problem, places)
}

/// The walls' layers are a twentieth of the channel wide, and seven values tell both coefficients to eight digits.
#[test]
fn exact_values_tell_scalars_to_eight_digits() {
    let exact: [f64; 2] = [2.5, 1e-3];
    let sharp = (exact[0] * exact[1]).sqrt().recip();
    let flow = |x: f64| 1.0 - (sharp * (x - 0.5)).cosh() / (0.5 * sharp).cosh();
    let (mut problem, _) = measured(channel::scene("porous"), [0.0, 1.0], 7, flow);
    problem.set_group("walls", vec![0.0, 1.0].into(), vec![]).unwrap();
    let mut solution = solve(&problem, Carrier::Auto);
    assert_eq!(solution.status, Status::Converged);
    for (learned, exact) in solution.learned().iter().zip(exact) {
        assert!((learned.value / exact - 1.0).abs() < 1e-8, "{learned:?} is not {exact}");
    }
}

/// A hundred values of a sine: its second derivative, at the ends too.
#[test]
fn exact_values_tell_a_smooth_source_up_to_its_ends() {
    let (mut problem, places) = measured(load::scene("hung"), [-1.0, 1.0], 100, |x| (PI * x).sin());
    problem.set_group("ends", vec![-1.0, 1.0].into(), vec![]).unwrap();
    let solution = solve(&problem, Carrier::Auto);
    assert_eq!(solution.status, Status::Converged);
    let estimates = solution.evaluate(&places);
    let found = &of(&estimates, "q").values;
    let off = |(x, q): (&f64, &f64)| (q + PI * PI * (PI * x).sin()).powi(2);
    let off = (places.iter().zip(found).map(off).sum::<f64>() / places.len() as f64).sqrt();
    assert!(off < 1e-6 * PI * PI / 2f64.sqrt(), "{off:e}");
}

/// A noise that five values tell leaves more open than their own scatter says: of 120 records five or six are expected to have a
/// rate beyond two deviations, and more than twelve with a chance of a few in a thousand. Two deviations of the scatter alone would
/// be left by seventeen (Student's distribution with three degrees of freedom).
#[test]
fn five_noisy_values_have_the_bars_of_five() {
    let mut normal = normals(3);
    let beyond = (0..120).filter(|_| {
        let noisy = |x: f64| 2.0 * (-1.7 * x).exp() + 0.02 * normal();
        let (problem, _) = measured(decay::scene("falls"), [0.0, 2.0], 5, noisy);
        let mut solution = solve(&problem, Carrier::Auto);
        let learned = &solution.learned()[0];
        learned.deviation.is_none_or(|deviation| (learned.value - 1.7).abs() > 2.0 * deviation)
    });
    let beyond = beyond.count();
    assert!(beyond <= 12, "{beyond}");
}
