//! A scalar that is learned beside a free source: told by a source that does not change, or by nothing but that the source is smooth.

use nisp_interpreter::interpret;

use super::some::measured_rod;
use super::sources::scattered;
use super::*;

interpret! {
    /// A rod that something heats, somehow, of which nobody knows how well it conducts.
    pub mod rod {
        units: off;
        coordinates: x, t: time;
        fields: u;
        sources: q;
        parameters: k > 0 = 0.2;
        on inside { flow: d(u, t) == k * d(u, x, 2) + q; }
        on begin { cold: u == 0; }
        on walls { held: u == 0; }
        on probes { observe u; }
        scene recover { learn k; }
    }
}

interpret! {
    /// The same rod, heated always in the same way.
    pub mod even {
        units: off;
        coordinates: x, t: time;
        fields: u;
        sources: q(x);
        parameters: k > 0 = 0.2;
        on inside { flow: d(u, t) == k * d(u, x, 2) + q; }
        on begin { cold: u == 0; }
        on walls { held: u == 0; }
        on probes { observe u; }
        scene recover { learn k; }
    }
}

/// A warmth whose first wave settles with a conductivity of a tenth, with noise of a hundredth of its size.
fn solved(scene: SceneRef) -> Solution {
    let mut normal = normals(23);
    let samples = scattered(600, [1.0, 2.0], 24);
    let rate = 0.1 * PI * PI;
    let warmth = |[x, t]: [f64; 2]| (PI * x).sin() * (1.0 - (-rate * t).exp()) / rate;
    let values = pairs(&samples).map(|place| warmth(place) + 0.003 * normal()).collect();
    solve(&measured_rod(scene, samples, values))
}

#[test]
fn a_conductivity_is_told_beside_a_source_that_does_not_change() {
    let mut solution = solved(even::scene("recover"));
    assert_eq!(solution.status, Status::Converged, "{:?}", solution.verdict.failed().collect::<Vec<_>>());
    let learned = &solution.learned()[0];
    let off = (learned.value - 0.1).abs();
    assert!(off < 0.01 && off < 4.0 * learned.deviation.unwrap(), "{learned:?}");
}

/// Any conductivity has a source that makes this warmth. The smoothest belongs to another one than the true.
#[test]
fn a_conductivity_is_not_told_beside_a_source_that_may_be_any() {
    let solution = solved(rod::scene("recover"));
    let mut failed = solution.verdict.failed();
    let is_of_scalar = |check: &nisp::Check| ["leaning", "determined"].contains(&check.check) && check.term == "k";
    assert!(failed.any(is_of_scalar), "{:?}", solution.verdict.checks);
    assert_eq!(solution.status, Status::Inconsistent);
}
