//! How the points of a cloud count: their noise and its directions, points that are off alike, declared losses and weights.

use nisp::schema::Unit;
use nisp::solve::driver::{Status, WarningKind};
use nisp::units::Number;
use nisp::{Problem, SceneRef, Tolerance, scene};

use crate::drum::*;

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

/// A length in a unit, in metres.
fn metres(unit: Unit, length: f64) -> f64 {
    unit.factor.of(Number::declared(length)).as_si()
}

/// Tension, its deviation, and the noise of the cloud in millimetres.
fn tension(scene: SceneRef, noise: f64, every: usize) -> (f64, f64, f64) {
    let mut problem = Problem::new(scene);
    bind_with_outliers(&mut problem, 0.0, 1.0, (noise, every));
    let mut solution = solve(&problem, None, 1);
    let tension = solution.learned()[0].clone();
    let terms = solution.terms();
    let cloud = terms.iter().find(|term| term.observation).unwrap();
    (tension.value, tension.deviation.unwrap_or(f64::NAN), metres(cloud.unit, cloud.noise.unwrap()) * 1e3)
}

/// Whether points are off along the view alone or in all directions is found out from the points, of which some are pushed beyond
/// the rim, where the surface is steep: a slope of 1.6.
#[test]
fn noise_may_be_along_the_view_or_in_all_directions() {
    let (f, a) = (12_000.0, 12.0);
    for noise in [[0.0, 0.0, 1.0], [1.0; 3]] {
        let mut problem = Problem::new(scene::<drum::pressed::Scene>());
        problem.set_parameter("T", T).unwrap();
        bind(&mut problem, f, a, 0.0);
        set_cloud(&mut problem, seen(f, a, (noise, 0)));
        let mut solution = solve(&problem, Some(PATCHES), 2);
        let force = force(&solution);
        let off = (force / true_force(f, a) - 1.0).abs();
        let found = solution.terms().iter().find(|term| term.observation).unwrap().noise.unwrap();
        let unit = problem.scene().schema.groups[1].terms[0].unit;
        assert!(off < 0.02, "{noise:?}: {force}");
        assert!((1e3 * metres(unit, found) - 1.0).abs() < 0.1, "{noise:?}: {found}");
        assert_eq!(solution.status, Status::Converged, "{noise:?}");
    }
}

/// A sensor that is off by half a millimetre over regions of a centimetre shows nothing that presses, if that is known of it: its
/// points do not say the same anew.
#[test]
fn points_that_are_off_alike_count_as_one() {
    let pressed = |region: f64, common: f64| {
        let mut problem = Problem::new(scene::<drum::pressed::Scene>());
        problem.set_parameter("T", T).unwrap();
        bind(&mut problem, 0.0, 1.0, 0.0);
        let mut cloud = seen(0.0, 1.0, ([0.0, 0.0, 0.1], 0));
        cloud.chunks_mut(3).for_each(|c| c[2] += 0.7 * (c[0] / 4.0).sin() * (c[1] / 4.0).sin());
        set_cloud(&mut problem, cloud);
        let unit = problem.scene().schema.groups[1].terms[0].unit;
        let declared = |metres| unit.factor.back(Number::si(metres)).as_declared();
        let tolerance = Tolerance { size: declared(0.5e-3), region: declared(1e-3 * region), common };
        problem.set_tolerance("surface", "cloud", tolerance).unwrap();
        let solution = solve(&problem, Some(PATCHES), 2);
        force(&solution)
    };
    // Regions of which none has two points.
    let (each, together) = (pressed(0.1, 1.0), pressed(10.0, 1.0));
    assert!(together < 0.02 && each > 0.1, "{together} N, and {each} N if every point counts");
    assert_eq!(pressed(10.0, 0.0), each, "what has nothing in common counts by itself");
}

/// A camera sees half of a drum that is free, and a few strays above the other half. They are all that is known of it, and say nothing.
#[test]
fn points_that_stand_alone_are_left_out() {
    let found = |strays: &[[f64; 3]]| {
        let mut problem = Problem::new(scene::<drum::pressed::Scene>());
        problem.set_parameter("T", T).unwrap();
        bind(&mut problem, 0.0, 1.0, 0.0);
        let mut cloud = seen(0.0, 1.0, ([0.0, 0.0, 0.1], 0));
        cloud = cloud.chunks(3).filter(|c| c[0] < 0.0).flatten().copied().collect();
        cloud.extend(strays.iter().flatten());
        set_cloud(&mut problem, cloud);
        solve(&problem, Some(PATCHES), 2)
    };
    let strays = [12.0, 18.0, 24.0].map(|x| [x, 3.0, height(x, 0.0, 1.0) - 5.0]);
    let (clean, with) = (found(&[]), found(&strays));
    assert!((force(&clean) - force(&with)).abs() < 1e-6, "{} N, and {} N with strays", force(&clean), force(&with));
    let said = with.warnings.iter().find(|warning| warning.kind == WarningKind::LeftOut).unwrap();
    assert!(said.message.contains("3 points of `cloud` are far from all others"), "{said}");
    assert!(clean.warnings.iter().all(|warning| warning.kind != WarningKind::LeftOut), "{:?}", clean.warnings);
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
    let millimetres = |term: &nisp::TermReport| metres(term.unit, term.rms) * 1e3;
    assert!((millimetres(cloud) / 0.1 - 1.0).abs() < 0.1, "{}", millimetres(cloud));
    assert!(held.rms < 1e-2 * held.size, "{held:?}");
    // The pressure in the unit of the equation, from which the splines are off by little.
    assert!(
        (balance.unit.factor.of(Number::declared(balance.size)).as_si() / P - 2.0).abs() < 1.5
            && balance.rms < 0.05 * balance.size,
        "{balance:?}"
    );
}
