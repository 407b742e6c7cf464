//! Local functions on a drumhead with known answers: a disc of radius `R` under uniform tension `T`, inflated by `p` and
//! pressed by `f` on a disc of radius `a` around its middle. With `r` the distance from the middle, `-T laplacian(w) = p - f`
//! and `w(R) = 0` integrate to
//!
//! ```text
//! w = p (R^2 - r^2) / 4T + f a^2 ln(r / R) / 2T         outside the patch
//! w = w(a) + (p - f) (a^2 - r^2) / 4T                    inside
//! ```

use std::time::Duration;

use nisp::local::{Local, Patches};
use nisp::solve::driver::{Flow, Status, WarningKind};
use nisp::{Carrier, Points, Problem, SceneRef, Session, Settings, Solution, Tolerance, recover, scene};

nisp::pde! {
    /// A drumhead.
    pub mod drum {
        coordinates:
            /// place
            x [mm],
            /// place
            y [mm];
        fields:
            /// height
            w [mm];
        sources:
            /// pressure from above
            f [Pa] >= 0;
        parameters:
            /// tension
            T [N/m] in 1 .. 1000 = 20,
            /// pressure from below
            p [Pa];

        on interior { balance: -T * laplacian(w) == p - f; }
        on surface { cloud: chamfer [x, y, w]; }
        on rim { held: w == 0; }

        /// The pressure from above.
        scene pressed { }
        /// The tension of a drumhead that nothing presses.
        scene free { f = 0; learn T; }
    }
}

/// Radius in millimetres, tension, and the gauge pressure.
const R: f64 = 40.0;
const T: f64 = 50.0;
const P: f64 = 4000.0;

/// Height in millimetres at a distance from the middle, pressed by `f` within `a`.
fn height(r: f64, f: f64, a: f64) -> f64 {
    // N/m2 mm2 / (N/m) = 1e-3 mm
    let outside = |r: f64| 1e-3 * (P * (R * R - r * r) / (4.0 * T) + f * a * a * (r / R).ln() / (2.0 * T));
    if r >= a { outside(r) } else { outside(a) + 1e-3 * (P - f) * (a * a - r * r) / (4.0 * T) }
}

/// Points of a disc: a sunflower.
fn disc(count: usize) -> Vec<f64> {
    let point = |i: usize| {
        let (r, angle) = (R * ((i as f64 + 0.5) / count as f64).sqrt(), i as f64 * 2.399_963_229_728_653);
        [r * angle.cos(), r * angle.sin()]
    };
    (0..count).flat_map(point).collect()
}

/// Binds a drumhead that is seen with noise of a standard deviation in millimetres.
fn bind(problem: &mut Problem, f: f64, a: f64, noise: f64) {
    bind_with_outliers(problem, f, a, (noise, 0));
}

/// The same, where every so many points are 8 mm too high; 0 for none.
fn bind_with_outliers(problem: &mut Problem, f: f64, a: f64, (noise, every): (f64, usize)) {
    let (interior, rim) = (
        disc(4000),
        (0..240).flat_map(|i| {
            let angle = std::f64::consts::TAU * f64::from(i) / 240.0;
            [R * angle.cos(), R * angle.sin()]
        }),
    );
    let weights = vec![std::f64::consts::PI * R * R / 4000.0; 4000];
    problem.set_parameter("p", P).unwrap();
    problem.set_group("interior", Points { coordinates: interior, weights, ..Points::default() }, Vec::new()).unwrap();
    problem.set_group("surface", disc(3000).into(), Vec::new()).unwrap();
    problem.set_group("rim", rim.collect::<Vec<_>>().into(), Vec::new()).unwrap();
    let cloud = seen(f, a, ([0.0, 0.0, noise], every));
    set_cloud(problem, cloud);
    let term = problem.scene().schema.groups[1].terms[0].name;
    problem.set_view("surface", term, [0.0, 0.0, 1.0]).unwrap();
}

/// Binds a cloud in millimetres. Clouds are given in the unit of their term.
fn set_cloud(problem: &mut Problem, cloud: Vec<f64>) {
    let term = &problem.scene().schema.groups[1].terms[0];
    let unit = 1e-3 / term.unit.factor;
    problem.set_cloud("surface", term.name, cloud.into_iter().map(|x| unit * x).collect()).unwrap();
}

/// A cloud in millimetres that is noisy along the axes; every so many points are 8 mm too high, 0 for none.
fn seen(f: f64, a: f64, (noise, every): ([f64; 3], usize)) -> Vec<f64> {
    let mut random = 1u64;
    // Twelve numbers between 0 and 1 have a sum of variance 1.
    let mut normal = || -> f64 {
        let mut uniform = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    };
    let mut cloud = Vec::new();
    for (i, c) in disc(1500).chunks(2).enumerate() {
        let off = if every > 0 && i.is_multiple_of(every) { 8.0 } else { 0.0 };
        let exact = [c[0], c[1], height(c[0].hypot(c[1]), f, a) + off];
        cloud.extend(exact.iter().zip(noise).map(|(x, noise)| if noise > 0.0 { x + noise * normal() } else { *x }));
    }
    cloud
}

fn solve(problem: &Problem, patches: Option<Patches>, threads: usize) -> Solution {
    let local = Local { cells: 24, coarser: 3, degree: 3, tests: 1, finer: 2, source_dimensions: 2, patches };
    // Steps end the run, not time.
    let budget = Some(Duration::from_secs(300));
    let settings =
        Settings { carrier: Carrier::Local(local), iterations: Some(40), budget, threads, ..Settings::default() };
    recover(problem, &settings, &mut |_| Flow::Continue).unwrap()
}

fn values<'a>(estimates: &'a [nisp::Estimate], name: &str) -> &'a [f64] {
    &estimates.iter().find(|estimate| estimate.name == name).unwrap().values
}

#[test]
fn the_tension_of_an_inflated_drumhead_is_found() {
    let mut problem = Problem::new(scene::<drum::free::Scene>());
    bind(&mut problem, 0.0, 1.0, 0.0);
    let mut solution = solve(&problem, None, 2);
    let tension = &solution.learned()[0];
    assert_eq!(solution.status, Status::Converged);
    assert!((tension.value / T - 1.0).abs() < 1e-3, "{tension:?}");
    let deviation = tension.deviation.unwrap();
    assert!(deviation > 0.0 && deviation < 0.05 * T, "{deviation}");
}

#[test]
fn a_pressed_patch_is_found_with_its_force_and_its_edge() {
    let (f, a) = (12_000.0, 12.0);
    let mut problem = Problem::new(scene::<drum::pressed::Scene>());
    problem.set_parameter("T", T).unwrap();
    bind(&mut problem, f, a, 0.0);
    let patches = Patches { level: P, edges: 0.15, area: 0.75, end: 0.7 };
    let solution = solve(&problem, Some(patches), 2);
    let points = disc(6000);
    let found = solution.evaluate(&points);
    let pressure = values(&found, "f");
    let area = 1e-6 * std::f64::consts::PI * R * R / 6000.0;
    let force: f64 = pressure.iter().map(|f| f * area).sum();
    let truth = 1e-6 * std::f64::consts::PI * a * a * f;
    assert!((force / truth - 1.0).abs() < 0.02, "{force} {truth}");
    let (mut both, mut either) = (0, 0);
    for (pressure, point) in pressure.iter().zip(points.chunks(2)) {
        let masks = (*pressure > 0.5 * f, point[0].hypot(point[1]) < a);
        both += usize::from(masks.0 && masks.1);
        either += usize::from(masks.0 || masks.1);
    }
    // Half a cell of the pressure's lattice around the edge.
    assert!(f64::from(both as u32) > 0.85 * f64::from(either as u32), "{both} {either}");
    let off = points.chunks(2).zip(values(&found, "w")).map(|(c, w)| (w - height(c[0].hypot(c[1]), f, a)).abs());
    assert!(off.sum::<f64>() / 6000.0 < 0.02, "mean error of the height in mm");
}

#[test]
fn error_bars_cover_the_truth_and_no_more() {
    let (f, a, noise) = (12_000.0, 12.0, 0.3);
    let mut problem = Problem::new(scene::<drum::pressed::Scene>());
    problem.set_parameter("T", T).unwrap();
    bind(&mut problem, f, a, noise);
    let mut solution = solve(&problem, Some(Patches { level: P, edges: 0.15, area: 0.75, end: 0.7 }), 2);
    let points = disc(2000);
    let found = solution.evaluate_with_errors(&points);
    let of = |name: &str| {
        let estimate = found.iter().find(|estimate| estimate.name == name).unwrap();
        estimate.values.iter().zip(estimate.deviations.as_ref().unwrap()).zip(points.chunks(2))
    };
    let share = |within: Vec<bool>| within.iter().filter(|is| **is).count() as f64 / within.len() as f64;
    let height = |c: &[f64]| height(c[0].hypot(c[1]), f, a);
    let covered = share(of("w").map(|((w, sd), c)| (w - height(c)).abs() < 2.0 * sd).collect());
    assert!(covered > 0.8, "{covered} of the heights");
    // Fifteen hundred points know far more than one.
    assert!(of("w").all(|((_, sd), _)| *sd > 0.0 && *sd < noise));
    // Conditional on the patch: well inside it.
    let inside = of("f").filter(|(_, c)| c[0].hypot(c[1]) < 0.8 * a);
    let covered = share(inside.map(|((p, sd), _)| (p - f).abs() < 2.0 * sd && *sd < f).collect());
    assert!(covered > 0.8, "{covered} of the pressures");
}

/// Whether points are off along the view alone or in all directions is found out from the points, of which some are pushed beyond
/// the rim, where the surface is steep: a slope of 1.6.
#[test]
fn noise_may_be_along_the_view_or_in_all_directions() {
    let (f, a) = (12_000.0, 12.0);
    let truth = 1e-6 * std::f64::consts::PI * a * a * f;
    let points = disc(6000);
    let area = 1e-6 * std::f64::consts::PI * R * R / 6000.0;
    for noise in [[0.0, 0.0, 1.0], [1.0; 3]] {
        let mut problem = Problem::new(scene::<drum::pressed::Scene>());
        problem.set_parameter("T", T).unwrap();
        bind(&mut problem, f, a, 0.0);
        set_cloud(&mut problem, seen(f, a, (noise, 0)));
        let mut solution = solve(&problem, Some(Patches { level: P, edges: 0.15, area: 0.75, end: 0.7 }), 2);
        let force: f64 = values(&solution.evaluate(&points), "f").iter().map(|f| f * area).sum();
        let off = (force / truth - 1.0).abs();
        let found = solution.terms().iter().find(|term| term.observation).unwrap().noise.unwrap();
        let unit = problem.scene().schema.groups[1].terms[0].unit.factor;
        assert!(off < 0.02, "{noise:?}: {force} for {truth}");
        assert!((1e3 * unit * found - 1.0).abs() < 0.1, "{noise:?}: {found}");
        assert_eq!(solution.status, Status::Converged, "{noise:?}");
    }
}

/// A sensor that is off by half a millimetre over regions of a centimetre shows nothing that presses, if that is known of it: its
/// points do not say the same anew.
#[test]
fn points_that_are_off_alike_count_as_one() {
    let force = |region: f64| {
        let mut problem = Problem::new(scene::<drum::pressed::Scene>());
        problem.set_parameter("T", T).unwrap();
        bind(&mut problem, 0.0, 1.0, 0.0);
        let mut cloud = seen(0.0, 1.0, ([0.0, 0.0, 0.1], 0));
        cloud.chunks_mut(3).for_each(|c| c[2] += 0.7 * (c[0] / 4.0).sin() * (c[1] / 4.0).sin());
        set_cloud(&mut problem, cloud);
        let unit = 1e-3 / problem.scene().schema.groups[1].terms[0].unit.factor;
        let tolerance = Tolerance { size: 0.5 * unit, region: region * unit };
        problem.set_tolerance("surface", "cloud", tolerance).unwrap();
        let solution = solve(&problem, Some(Patches { level: P, edges: 0.15, area: 0.75, end: 0.7 }), 2);
        let area = 1e-6 * std::f64::consts::PI * R * R / 6000.0;
        values(&solution.evaluate(&disc(6000)), "f").iter().map(|f| f * area).sum::<f64>()
    };
    // Regions of which none has two points.
    let (each, together) = (force(0.1), force(10.0));
    assert!(together < 0.02 && each > 0.1, "{together} N, and {each} N if every point counts");
}

/// A camera that shows one half: what presses on the other is anybody's guess, and the deviations say so.
#[test]
fn what_no_cloud_saw_is_not_known() {
    let (f, a) = (12_000.0, 12.0);
    let mut problem = Problem::new(scene::<drum::pressed::Scene>());
    problem.set_parameter("T", T).unwrap();
    bind(&mut problem, f, a, 0.0);
    let patches = Some(Patches { level: P, edges: 0.15, area: 0.75, end: 0.7 });
    let guesses = |solution: &Solution| solution.warnings.iter().any(|warning| warning.kind == WarningKind::Settled);
    let deviations = |solution: &mut Solution, points: &[f64]| {
        let found = solution.evaluate_with_errors(points);
        found.into_iter().find(|estimate| estimate.name == "f").unwrap().deviations.unwrap()
    };
    let (far, near) = ([-25.0, 0.0], [25.0, 0.0]);
    let mut whole = solve(&problem, patches, 2);
    assert!(!guesses(&whole), "{:?}", whole.warnings);
    let known = deviations(&mut whole, &[far, near].concat());
    let all = seen(f, a, ([0.0; 3], 0));
    set_cloud(&mut problem, all.chunks(3).filter(|c| c[0] > 0.0).flatten().copied().collect());
    let mut one_sided = solve(&problem, patches, 2);
    assert!(guesses(&one_sided), "{:?}", one_sided.warnings);
    let found = deviations(&mut one_sided, &[far, near].concat());
    assert!(found[0] > 0.5 * P && found[0] > 3.0 * known[0], "{found:?} {known:?}");
    assert!(found[1] < 2.0 * known[1], "{found:?} {known:?}");
}

/// A pressure of the contact takes over what a gas pressure a fifth too high leaves, and the surface fits.
#[test]
fn a_wrong_pressure_is_named_and_a_right_one_is_not_doubted() {
    for (given, passes) in [(P, true), (1.2 * P, false)] {
        let mut problem = Problem::new(scene::<drum::pressed::Scene>());
        problem.set_parameter("T", T).unwrap();
        bind(&mut problem, 12_000.0, 12.0, 0.3);
        problem.set_parameter("p", given).unwrap();
        let solution = solve(&problem, Some(Patches { level: P, edges: 0.15, area: 0.75, end: 0.7 }), 2);
        let first = &solution.verdict.checks[0];
        assert_eq!((first.check, first.passed), ("given", passes), "{first:?}");
        assert!(passes || first.message.contains("`p` about"), "{first:?}");
    }
}

#[test]
fn the_answer_does_not_depend_on_the_threads() {
    let mut problem = Problem::new(scene::<drum::pressed::Scene>());
    problem.set_parameter("T", T).unwrap();
    bind(&mut problem, 12_000.0, 12.0, 0.0);
    let patches = Patches { level: P, edges: 0.15, area: 0.75, end: 0.7 };
    let of = |threads| values(&solve(&problem, Some(patches), threads).evaluate(&disc(50)), "f").to_vec();
    assert_eq!(of(1), of(3));
}

nisp::pde! {
    /// A load on a beam of which only the sum is known.
    pub mod load {
        coordinates:
            /// place
            x [mm];
        sources:
            /// load
            f [N/m];
        parameters:
            /// its sum
            F [N];

        on beam { even: d(f, x) == 0; total: integral(f) == F; }

        /// The even load.
        scene even_load { }
    }
}

#[test]
fn a_lattice_without_cells_is_refused() {
    let mut problem = Problem::new(scene::<load::even_load::Scene>());
    problem.set_parameter("F", 3.0).unwrap();
    problem.set_group("beam", vec![0.0, 1.0, 2.0].into(), Vec::new()).unwrap();
    let local = Local { cells: 0, coarser: 3, degree: 3, tests: 1, finer: 2, source_dimensions: 1, patches: None };
    let settings = Settings { carrier: Carrier::Local(local), ..Settings::default() };
    let refused = recover(&problem, &settings, &mut |_| Flow::Continue).err().unwrap().to_string();
    assert!(refused.contains("fewer cells than a test"), "{refused}");
}

/// 3 N over 20 mm are 150 N/m, whatever the unit of the weights.
#[test]
fn weights_are_in_the_unit_of_the_coordinates() {
    let mut problem = Problem::new(scene::<load::even_load::Scene>());
    problem.set_parameter("F", 3.0).unwrap();
    let points: Vec<f64> = (0..40).map(|i| 0.5 * (f64::from(i) + 0.5)).collect();
    problem
        .set_group("beam", Points { coordinates: points, weights: vec![0.5; 40], ..Points::default() }, Vec::new())
        .unwrap();
    let settings = Settings { iterations: Some(300), ..Settings::default() };
    let solution = recover(&problem, &settings, &mut |_| Flow::Continue).unwrap();
    for value in values(&solution.evaluate(&[1.0, 10.0, 19.0]), "f") {
        assert!((value - 150.0).abs() < 1e-3, "{value}");
    }
}

nisp::pde! {
    /// A drumhead under a ceiling, above which its equation has no value.
    pub mod low {
        coordinates:
            /// place
            x [mm],
            /// place
            y [mm];
        fields:
            /// height
            w [mm];
        parameters:
            /// tension
            T [N/m] in 1 .. 1000 = 20,
            /// pressure from below
            p [Pa],
            /// height of the ceiling
            c [mm];

        on interior { balance: -T * laplacian(w) == p + 1e-9 * p * sqrt(1 - w / c); }
        on surface { cloud: chamfer [x, y, w]; }
        on rim { held: w == 0; }

        /// The tension.
        scene under { learn T; }
    }
}

/// Data lead every step through the ceiling: all of them are taken back, and what is left is the state before.
#[test]
fn steps_into_places_without_a_value_are_taken_back_and_named() {
    let mut problem = Problem::new(scene::<low::under::Scene>());
    problem.set_parameter("c", 0.5 * height(0.0, 0.0, 1.0)).unwrap();
    bind(&mut problem, 0.0, 1.0, 0.0);
    let solution = solve(&problem, None, 2);
    assert_eq!(solution.status, Status::NotConverged);
    let named = |warning: &str| warning.contains("interior.balance") && warning.contains("point");
    assert!(solution.warnings.iter().any(|warning| named(&warning.message)), "{:?}", solution.warnings);
    assert!(values(&solution.evaluate(&disc(200)), "w").iter().all(|w| w.is_finite()));
}

nisp::pde! {
    /// A drumhead seen with declared noise.
    pub mod seen {
        coordinates:
            /// place
            x [mm],
            /// place
            y [mm];
        fields:
            /// height
            w [mm];
        parameters:
            /// tension
            T [N/m] in 1 .. 1000 = 20,
            /// pressure from below
            p [Pa];

        on interior { balance: -T * laplacian(w) == p; }
        on surface {
            cloud: chamfer [x, y, w];
            tukey: chamfer [x, y, w] with tukey(4);
            sure: chamfer [x, y, w] within 3 [mm];
            surer: chamfer [x, y, w] within 3 [mm] weight 4;
        }
        on rim { held: w == 0; }

        /// Nothing declared.
        scene plain { learn T; without surface.tukey, surface.sure, surface.surer; }
        /// A loss.
        scene robust { learn T; without surface.cloud, surface.sure, surface.surer; }
        /// Noise.
        scene noisy { learn T; without surface.cloud, surface.tukey, surface.surer; }
        /// Noise, and a weight.
        scene heavy { learn T; without surface.cloud, surface.tukey, surface.sure; }
    }
}

/// Tension, its deviation, and the noise of the cloud in millimetres.
fn tension(scene: SceneRef, noise: f64, every: usize) -> (f64, f64, f64) {
    let mut problem = Problem::new(scene);
    bind_with_outliers(&mut problem, 0.0, 1.0, (noise, every));
    let mut solution = solve(&problem, None, 1);
    let tension = solution.learned()[0].clone();
    let terms = solution.terms();
    let cloud = terms.iter().find(|term| term.observation).unwrap();
    (tension.value, tension.deviation.unwrap_or(f64::NAN), cloud.noise.unwrap() * cloud.unit.factor * 1e3)
}

/// One point of six is 8 mm too high. Huber's loss counts each as three deviations; Tukey's leaves it out.
#[test]
fn a_declared_loss_acts_on_a_cloud() {
    let off = |(value, ..): (f64, f64, f64)| (value / T - 1.0).abs();
    let huber = off(tension(scene::<seen::plain::Scene>(), 0.1, 6));
    let (value, deviation, noise) = tension(scene::<seen::robust::Scene>(), 0.1, 6);
    let tukey = off((value, deviation, noise));
    assert!(tukey < 2e-3 && 3.0 * tukey < huber, "{tukey} beside {huber}");
    assert!((noise / 0.1 - 1.0).abs() < 0.1, "{noise}");
}

/// Noise that is declared is not estimated; a weight of four makes half the deviation.
#[test]
fn declared_noise_and_weight_act_on_a_cloud() {
    let (_, estimated, noise) = tension(scene::<seen::plain::Scene>(), 0.1, 0);
    let (_, declared, within) = tension(scene::<seen::noisy::Scene>(), 0.1, 0);
    let (_, heavy, _) = tension(scene::<seen::heavy::Scene>(), 0.1, 0);
    assert!((noise / 0.1 - 1.0).abs() < 0.1 && (within / 3.0 - 1.0).abs() < 1e-9, "{noise} {within}");
    assert!(declared > 5.0 * estimated, "{declared} beside {estimated}");
    assert!((heavy / declared - 0.5).abs() < 0.05, "{heavy} beside {declared}");
}

#[test]
fn terms_say_how_well_they_are_met() {
    let mut problem = Problem::new(scene::<seen::plain::Scene>());
    bind(&mut problem, 0.0, 1.0, 0.1);
    let terms = solve(&problem, None, 1).terms();
    let names: Vec<&str> = terms.iter().map(|term| term.name.as_str()).collect();
    assert_eq!(names, ["interior.balance", "surface.cloud", "rim.held"]);
    let [balance, cloud, held] = &terms[..] else { panic!("three terms") };
    assert!(cloud.observation && !balance.observation && balance.noise.is_none() && held.noise.is_none());
    let millimetres = |term: &nisp::TermReport| term.rms * term.unit.factor * 1e3;
    assert!((millimetres(cloud) / 0.1 - 1.0).abs() < 0.1, "{}", millimetres(cloud));
    assert!(held.rms < 1e-2 * held.size, "{held:?}");
    // The pressure in the unit of the equation, from which the splines are off by little.
    assert!(
        (balance.size * balance.unit.factor / P - 2.0).abs() < 1.5 && balance.rms < 0.05 * balance.size,
        "{balance:?}"
    );
}

/// The disc that presses grows and then weighs more, frame by frame, and is exchanged for a larger one: the forces that a session
/// finds are right, and all answers but the first, and one that may be lost, follow from the one before.
#[test]
fn a_session_follows_what_presses() {
    let mut session = pressed_session(0.1);
    let frames =
        [(12_000.0, 12.0), (12_000.0, 12.7), (12_800.0, 12.7), (13_600.0, 12.7), (13_600.0, 12.0), (9_000.0, 16.0)];
    let mut followed = 0;
    for (at, (f, a)) in frames.into_iter().enumerate() {
        bind(session.problem(), f, a, 0.1);
        let solution = session.update(&mut |_| Flow::Continue).unwrap();
        assert!(solution.is_sound() && solution.status == Status::Converged, "{at}: {:?}", solution.verdict);
        followed += usize::from(solution.iterations < 5);
        let points = disc(20_000);
        let area = 1e-6 * std::f64::consts::PI * R * R / 20_000.0;
        let weights = vec![area; 20_000];
        let force = area * values(&solution.evaluate(&points), "f").iter().sum::<f64>();
        let real = 1e-6 * std::f64::consts::PI * a * a * f;
        // A single answer is off by as much: a twentieth of what presses.
        assert!((force - real).abs() < 0.27, "{at}: {force} N of {real}");
        let deviation = solution.deviation_of_sum("f", &points, &weights);
        assert!(deviation.is_some_and(|deviation| (1e-3..0.2).contains(&deviation)), "{at}: {deviation:?}");
    }
    assert!((4..6).contains(&followed), "{followed}");
}

/// A wrong pressure in the middle of a session is named, by the answer from nothing that it leads to and by those that go on
/// from there; the right one is not.
#[test]
fn a_session_doubts_what_a_single_answer_doubts() {
    let mut session = pressed_session(0.3);
    for (number, (given, passes)) in [(P, true), (P, true), (1.2 * P, false), (1.2 * P, false)].into_iter().enumerate()
    {
        bind(session.problem(), 12_000.0, 12.0, 0.3);
        session.problem().set_parameter("p", given).unwrap();
        let solution = session.update(&mut |_| Flow::Continue).unwrap();
        let first = &solution.verdict.checks[0];
        assert_eq!((first.check, first.passed), ("given", passes), "{number}: {first:?}");
        assert_eq!(solution.status == Status::Converged, passes, "{number}");
        assert_eq!(solution.iterations < 5, number % 2 == 1, "{number}: {:?}", solution.verdict);
    }
}

/// A session with the pressed drumhead, its first cloud as noisy as this.
fn pressed_session(noise: f64) -> Session {
    let mut problem = Problem::new(scene::<drum::pressed::Scene>());
    let patches = Some(Patches { level: P, edges: 0.15, area: 0.75, end: 0.7 });
    problem.set_parameter("T", T).unwrap();
    bind(&mut problem, 12_000.0, 12.0, noise);
    let local = Local { cells: 24, coarser: 3, degree: 3, tests: 1, finer: 2, source_dimensions: 2, patches };
    let settings = Settings {
        carrier: Carrier::Local(local),
        iterations: Some(40),
        budget: Some(Duration::from_secs(300)),
        threads: 2,
        ..Settings::default()
    };
    Session::new(problem, settings).unwrap()
}
