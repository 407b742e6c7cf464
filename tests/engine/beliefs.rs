//! What is believed of a learned parameter, and what data make of it.

use nisp::solve::driver::Flow;
use nisp::{Optimizer, Problem, Settings, recover};

nisp::pde! {
    mod spring {
        coordinates: s [cm];
        fields: u [mm];
        parameters: k [N/m] in 1 .. 9 = 5 within 0.5;
        on samples { observe u within 0.3 [mm]; }
        // Groups of these names are the compiler's too.
        on outputs { observe pull: k * s ~ force [mN] within 3 [mN]; }
        on beliefs { bounded: u <= 1 [m]; }
        scene believed { learn k; }
        scene hardly { learn k within 20 [N/m]; }
    }
}

/// Where the spring was pulled to, in cm, and the force there, in mN: about 6 N/m.
const PULLS: [(f64, f64); 4] = [(0.1, 3.0), (0.2, 14.0), (0.25, 13.0), (0.3, 20.0)];

/// The stiffness found, and its standard deviation, in N/m.
fn found(problem: &Problem, optimizer: Optimizer) -> (f64, f64) {
    let settings = Settings { optimizer, iterations: Some(200), ..Settings::default() };
    let mut solution = recover(problem, &settings, &mut |_| Flow::Continue).unwrap();
    let learned = solution.learned();
    (learned[0].value, learned[0].deviation.unwrap())
}

/// A line through the origin under a Gaussian prior has a closed form: means weigh as much as they are precise.
fn weighed(start: f64, spread: f64) -> (f64, f64) {
    // N/m times cm are 10 mN.
    let slopes = PULLS.map(|(s, _)| 10.0 * s / 3.0);
    let precision = spread.powi(-2) + slopes.iter().map(|slope| slope * slope).sum::<f64>();
    let pulls: f64 = slopes.iter().zip(PULLS).map(|(slope, (_, force))| slope * force / 3.0).sum();
    ((start * spread.powi(-2) + pulls) / precision, precision.powf(-0.5))
}

macro_rules! bound {
    ($scene:ident, $start:expr) => {{
        use spring::$scene::{OutputsData, Parameters, SamplesData, bind};
        let at: Vec<f64> = (0..20).map(|i| 0.02 * f64::from(i)).collect();
        let u = at.iter().map(|s| s.sin()).collect();
        let (pulled, force): (Vec<f64>, Vec<f64>) = PULLS.into_iter().unzip();
        let samples = bind(Parameters { k: $start }).samples(at.clone(), SamplesData { u });
        samples.outputs(pulled, OutputsData { force }).beliefs(at).problem()
    }};
}

#[test]
fn a_belief_and_data_weigh_as_much_as_they_are_precise() {
    for (problem, (mean, deviation)) in [
        (bound!(believed, 5.0), weighed(5.0, 0.5)),
        (bound!(believed, 3.0), weighed(3.0, 0.5)),
        (bound!(hardly, 3.0), weighed(3.0, 20.0)),
    ] {
        for optimizer in [Optimizer::Evidence, Optimizer::Marquardt] {
            let (value, spread) = found(&problem, optimizer);
            assert!((value - mean).abs() <= 1e-4 * deviation, "{value} instead of {mean}");
            assert!((spread - deviation).abs() <= 1e-3 * deviation, "{spread} instead of {deviation}");
        }
    }
}
