//! Conditions that hold by construction, from `pde!` to the answer.

use std::f64::consts::PI;

use nisp::solve::driver::Flow;
use nisp::{Optimizer, Settings, recover};

nisp::pde! {
    mod string {
        coordinates: x [mm];
        fields: u [mm];
        parameters: pull [N] = 20, load [N/m] = 3, length [mm] = 800, lift [mm] = 5;
        hard u = lift * x / length by x * (length - x) / length^2;
        on inside { balance: -pull * d(u, x, 2) == load * sin(3 * x / length * pi); }
        scene sag { }
    }
}

#[test]
fn ends_are_held_exactly_and_the_rest_is_solved() {
    let (pull, load, length, lift) = (20.0, 3e-3, 800.0, 5.0);
    let inside: Vec<f64> = (0..=100).map(|i| 8.0 * f64::from(i)).collect();
    let parameters = string::sag::Parameters { pull, load: 3.0, length, lift };
    let problem = string::sag::bind(parameters).inside(inside.clone()).problem();
    // u = lift x / length + load (length / 3 pi)^2 sin(3 pi x / length) / pull, in millimetres.
    let wave = load * (length / (3.0 * PI)).powi(2) / pull;
    let exact = |x: f64| lift * x / length + wave * (3.0 * PI * x / length).sin();
    // The second takes equations to be off by a hundredth of their natural size, which therefore has to be right.
    for (optimizer, tolerance) in [(Optimizer::Broyden, 1e-5), (Optimizer::Marquardt, 1e-2)] {
        let settings = Settings { optimizer, ..Settings::default() };
        let solution = recover(&problem, &settings, &mut |_| Flow::Continue).expect("a solution");
        let value = |at: &[f64]| solution.evaluate(at).into_iter().find(|e| e.name == "u").expect("the field").values;
        // At the ends nothing is left of the network.
        let ends = value(&[0.0, length]);
        assert!(ends[0] == 0.0 && (ends[1] - lift).abs() <= 1e-14 * lift, "{ends:?}");
        let worst = value(&inside).iter().zip(&inside).map(|(u, &x)| (u - exact(x)).abs()).fold(0.0, f64::max);
        assert!(worst <= tolerance * wave, "{optimizer:?}: {worst:e} of {wave}");
    }
}
