//! A drumhead with known answers: a disc of radius `R` under uniform tension `T`, inflated by `p` and
//! pressed by `f` on a disc of radius `a` around its middle. With `r` the distance from the middle, `-T laplacian(w) = p - f`
//! and `w(R) = 0` integrate to
//!
//! ```text
//! w = p (R^2 - r^2) / 4T + f a^2 ln(r / R) / 2T         outside the patch
//! w = w(a) + (p - f) (a^2 - r^2) / 4T                    inside
//! ```

use std::f64::consts::PI;
use std::time::Duration;

use nisp::local::{Local, Patches};
use nisp::solve::driver::Flow;
use nisp::units::Number;
use nisp::{Carrier, Points, Problem, Settings, Solution, recover};

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
            p [Pa],
            /// what a gauge that stands at zero may hide of it
            hidden [Pa] = 0;

        on interior { balance: -T * laplacian(w) == p + hidden - f; }
        on surface { cloud: chamfer [x, y, w]; }
        on rim { held: w == 0; }

        /// The pressure from above.
        scene pressed { }
        /// The tension of a drumhead that nothing presses.
        scene free { f = 0; learn T; }
    }
}

/// Radius in millimetres, tension, and the gauge pressure.
pub(crate) const R: f64 = 40.0;
pub(crate) const T: f64 = 50.0;
pub(crate) const P: f64 = 4000.0;

/// What is known of the pressure from above: patches, inside of which it is that from below at least.
pub(crate) const PATCHES: Patches = Patches { level: P, edges: 0.15, area: 0.75, end: 0.7 };

/// Height in millimetres at a distance from the middle, pressed by `f` within `a`.
pub(crate) fn height(r: f64, f: f64, a: f64) -> f64 {
    // N/m2 mm2 / (N/m) = 1e-3 mm
    let outside = |r: f64| 1e-3 * (P * (R * R - r * r) / (4.0 * T) + f * a * a * (r / R).ln() / (2.0 * T));
    if r >= a { outside(r) } else { outside(a) + 1e-3 * (P - f) * (a * a - r * r) / (4.0 * T) }
}

/// Points of a disc: a sunflower.
pub(crate) fn disc(count: usize) -> Vec<f64> {
    let point = |i: usize| {
        let (r, angle) = (R * ((i as f64 + 0.5) / count as f64).sqrt(), i as f64 * 2.399_963_229_728_653);
        [r * angle.cos(), r * angle.sin()]
    };
    (0..count).flat_map(point).collect()
}

/// Binds a drumhead that is seen with noise of a standard deviation in millimetres.
pub(crate) fn bind(problem: &mut Problem, f: f64, a: f64, noise: f64) {
    bind_with_outliers(problem, f, a, (noise, 0));
}

/// The same, where every so many points are 8 mm too high; 0 for none.
pub(crate) fn bind_with_outliers(problem: &mut Problem, f: f64, a: f64, (noise, every): (f64, usize)) {
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
pub(crate) fn set_cloud(problem: &mut Problem, cloud: Vec<f64>) {
    let term = &problem.scene().schema.groups[1].terms[0];
    let declared = |millimetres| term.unit.factor.back(Number::si(1e-3 * millimetres)).as_declared();
    problem.set_cloud("surface", term.name, cloud.into_iter().map(declared).collect()).unwrap();
}

/// A cloud in millimetres that is noisy along the axes; every so many points are 8 mm too high, 0 for none.
pub(crate) fn seen(f: f64, a: f64, (noise, every): ([f64; 3], usize)) -> Vec<f64> {
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

pub(crate) fn solve(problem: &Problem, patches: Option<Patches>, threads: usize) -> Solution {
    let local = Local { cells: 24, coarser: 3, degree: 3, tests: 1, finer: 2, source_dimensions: 2, patches };
    // Steps end the run, not time.
    let budget = Some(Duration::from_secs(300));
    let settings =
        Settings { carrier: Carrier::Local(local), iterations: Some(40), budget, threads, ..Settings::default() };
    recover(problem, &settings, &mut |_| Flow::Continue).unwrap()
}

pub(crate) fn values<'a>(estimates: &'a [nisp::Estimate], name: &str) -> &'a [f64] {
    &estimates.iter().find(|estimate| estimate.name == name).unwrap().values
}

/// Net force in newtons of the pressure `f`.
pub(crate) fn force(solution: &Solution) -> f64 {
    const POINTS: usize = 6000;
    let area = 1e-6 * PI * R * R / POINTS as f64;
    area * values(&solution.evaluate(&disc(POINTS)), "f").iter().sum::<f64>()
}

/// That of a pressure `f` within `a`.
pub(crate) fn true_force(f: f64, a: f64) -> f64 {
    1e-6 * PI * a * a * f
}
