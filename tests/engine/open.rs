//! A stiffness and a load that only occur as a ratio: what the data leave open is named, and what closes it.

// The macro warns of what is left open; here the solver is asked.
#![allow(deprecated)]

use nisp::solve::driver::{Flow, WarningKind};
use nisp::{Optimizer, Problem, Settings, Solution, recover};

nisp::pde! {
    mod rope {
        coordinates: s [m];
        fields: y [mm];
        sources: f [N/m];
        parameters: T [N], q [N/m];
        on inside { balance: -T * d(y, s, 2) == f; }
        on under { weight: -T * d(y, s, 2) == q; }
        on probes { observe y; }
        /// A load that varies, and a tension that nobody has measured.
        scene loaded { learn T; without under; }
        /// The same, with a tension that is known roughly.
        scene believed { learn T within 0.4 [N]; without under; }
        /// A rope's own weight.
        scene hanging { f = 0; learn T, q; without inside; }
    }
}

nisp::pde! {
    mod twins {
        coordinates: s [m];
        fields: y [mm];
        sources: f [N/m], g [N/m];
        parameters: T [N];
        on inside { balance: -T * d(y, s, 2) == f + g; even: d(f, s) == 0; level: d(g, s) == 0; }
        on probes { observe y; }
        /// Two even loads, of which only the sum is seen.
        scene both { }
    }
}

const POINTS: usize = 40;

/// From -1 m to 1 m.
fn places() -> Vec<f64> {
    (0..POINTS).map(|i| -1.0 + 2.0 * i as f64 / (POINTS - 1) as f64).collect()
}

/// Sag in mm under a load of 0.05, or of `0.05 cos(pi s / 2)` N/m, with a tension of 20 N, and a disturbance that no smooth
/// load makes.
fn sag(varies: bool) -> Vec<f64> {
    let half_pi = std::f64::consts::FRAC_PI_2;
    let shape = |s: f64| if varies { (half_pi * s).cos() / half_pi.powi(2) } else { (1.0 - s * s) / 2.0 };
    let disturbed = |(i, s): (usize, f64)| 2.5 * shape(s) + 0.01 * (2.1 * (i * i) as f64).sin();
    places().into_iter().enumerate().map(disturbed).collect()
}

fn solved(problem: &Problem, optimizer: Optimizer) -> Solution {
    let settings = Settings { optimizer, iterations: Some(300), ..Settings::default() };
    recover(problem, &settings, &mut |_| Flow::Continue).unwrap()
}

fn said(solution: &Solution, kind: &WarningKind) -> String {
    let of_kind = solution.warnings.iter().filter(|warning| warning.kind == *kind);
    of_kind.map(|warning| warning.message.as_str()).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_load_and_a_tension_are_known_as_a_ratio() {
    use rope::loaded::{Parameters, ProbesData, bind};
    let data = ProbesData { y: sag(true) };
    let problem = bind(Parameters { T: 40.0 }).inside(places()).probes(places(), data).problem();
    let mut solution = solved(&problem, Optimizer::Evidence);
    let said = said(&solution, &WarningKind::Undetermined);
    assert!(said.starts_with("the data do not determine `T`: `T` + 1.00 % with `f` +"), "{said}");
    // One warning for the two of them.
    assert!(!said.contains('\n'), "{said}");
    let tension = solution.learned()[0].value;
    let source = |s: f64| solution.evaluate(&[s])[1].values[0];
    assert!((source(0.0) / tension / 0.0025 - 1.0).abs() < 0.02, "{} {tension}", source(0.0));
    // What goes with a hundredth of the tension is a hundredth of the load.
    let number = |before: &str| -> f64 {
        let (_, from) = said.split_once(before).unwrap();
        from.split(' ').next().unwrap().parse().unwrap()
    };
    let share = number("`f` + ") / source(number("at s = "));
    assert!((share / 0.01 - 1.0).abs() < 0.1, "{said}: {share}");
}

#[test]
fn a_belief_that_settles_it_is_named() {
    use rope::believed::{Parameters, ProbesData, bind};
    let data = ProbesData { y: sag(true) };
    let problem = bind(Parameters { T: 40.0 }).inside(places()).probes(places(), data).problem();
    let solution = solved(&problem, Optimizer::Evidence);
    assert_eq!(said(&solution, &WarningKind::Undetermined), "");
    let said = said(&solution, &WarningKind::Settled);
    assert!(said.contains("`T` rests on what is believed of `T`: without it `T` + 1.00 % with `f` +"), "{said}");
}

#[test]
fn two_scalars_that_scale_together_do_not_run_away() {
    use rope::hanging::{Parameters, ProbesData, bind};
    let y = sag(false);
    let problem = bind(Parameters { T: 40.0, q: 0.1 }).under(places()).probes(places(), ProbesData { y }).problem();
    for optimizer in [Optimizer::Marquardt, Optimizer::Evidence] {
        let mut solution = solved(&problem, optimizer);
        let said = said(&solution, &WarningKind::Undetermined);
        assert!(said.contains("do not determine `T` and `q`") || said.contains("`q` and `T`"), "{said}");
        assert!(said.contains("+ 1.00 % with") && said.contains("a known value of `"), "{said}");
        let learned: Vec<f64> = solution.learned().iter().map(|learned| learned.value).collect();
        let [tension, load] = learned[..] else { panic!("{learned:?}") };
        assert!((load / tension / 0.0025 - 1.0).abs() < 0.05, "{learned:?}");
        assert!((4.0..400.0).contains(&tension), "{learned:?}");
    }
}

#[test]
fn two_sources_that_are_known_as_a_sum_are_both_told_of() {
    use twins::both::{Parameters, ProbesData, bind};
    let data = ProbesData { y: sag(false) };
    let problem = bind(Parameters { T: 20.0 }).inside(places()).probes(places(), data).problem();
    let solution = solved(&problem, Optimizer::Evidence);
    let said = said(&solution, &WarningKind::Undetermined);
    let [f, g] = said.lines().collect::<Vec<_>>()[..] else { panic!("{said}") };
    assert!(f.contains("do not determine `f`") && f.contains("may be added to it if `g` moves along"), "{f}");
    assert!(g.contains("do not determine `g`") && g.contains("may be added to it if `f` moves along"), "{g}");
    let loads = solution.evaluate(&[0.0]);
    assert!(((loads[1].values[0] + loads[2].values[0]) / 0.05 - 1.0).abs() < 0.02, "{loads:?}");
}
