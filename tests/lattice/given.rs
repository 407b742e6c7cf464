//! Given numbers that the data contradict, where a source takes over most of what is wrong with them.

use nisp_interpreter::interpret;

use super::some::measured_rod;
use super::sources::scattered;
use super::*;

interpret! {
    /// A rod that is warmed evenly all the time.
    pub mod warmed {
        units: off;
        coordinates: x, t: time;
        fields: u;
        sources: q(x);
        parameters: a = 0.1;
        on inside { flow: d(u, t) == a * d(u, x, 2) + q; }
        on begin { cold: u == 0; }
        on walls { held: u == 0; }
        on probes { observe u; }
        scene recover { }
    }
}

/// `u = (1 - exp(-r t)) sin(pi x)` with `r = 0.1 pi^2`: with another diffusivity a source makes the same warmth in the end, at another pace.
#[test]
fn a_diffusivity_that_is_wrong_is_named_with_what_it_should_be() {
    let rate = 0.1 * PI * PI;
    let found = |diffusivity: f64| {
        let mut normal = normals(8);
        let probes = scattered(300, [1.0, 2.0], 3);
        let warm = |[x, t]: [f64; 2]| (1.0 - (-rate * t).exp()) * (PI * x).sin();
        let measured = pairs(&probes).map(|place| warm(place) + 0.02 * normal()).collect();
        let mut problem = measured_rod(warmed::scene("recover"), probes, measured);
        problem.set_parameter("a", diffusivity).unwrap();
        solve(&problem)
    };
    let right = found(0.1);
    assert_eq!(right.status, Status::Converged, "{:?}", right.verdict.failed().collect::<Vec<_>>());
    let wrong = found(0.12);
    assert_eq!(wrong.status, Status::Inconsistent);
    let check = wrong.verdict.failed().find(|check| check.check == "given").unwrap();
    assert!(check.message.contains("`a` about 9.") || check.message.contains("`a` about 1.0"), "{}", check.message);
}
