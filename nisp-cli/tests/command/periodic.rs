//! Conditions between opposite sides of a domain, from a text.

use crate::common::Place;

const RING: &str = "
    units: off;
    coordinates: x;
    fields: u;
    sources: s;
    parameters: k = 0.01;
    domains: ring = 0 .. 1;
    on inside in ring { balance: u - k * d(u, x, 2) == s; }
    on seam boundary of ring pairs { value: u == partner(u); slope: d(u, x) == partner(d(u, x)); }
    on probes { observe u; }
";

/// `u = sin(2 pi x)`, of which nothing is seen in the last fifth: what comes around from the start says what it is at the end.
#[test]
fn a_field_on_a_ring_is_the_same_at_both_ends() {
    let place = Place::new();
    place.put("ring.pde", RING);
    let u = |x: f64| (std::f64::consts::TAU * x).sin();
    let rows: String = (0..80).map(|i| f64::from(i) / 100.0).map(|x| format!("{x},{}\n", u(x))).collect();
    place.put("run.csv", &format!("x,u\n{rows}"));
    let ran = place.run("solve ring.pde --data run.csv --out out --grid 101 --budget 20");
    assert_eq!(ran.code, Some(0), "{} {}", ran.stdout, ran.stderr);
    let found = place.rows("out/state.csv");
    let at = |i: usize| found[i][1];
    assert!((at(0) - at(100)).abs() < 0.02, "{} and {}", at(0), at(100));
    assert!(found.iter().all(|row| (row[1] - u(row[0])).abs() < 0.1), "{found:?}");
}

#[test]
fn pairs_whose_partners_nothing_says_are_refused_by_check_and_solve() {
    let place = Place::new();
    for seam in ["on seam pairs", "on seam in ring pairs"] {
        place.put("ring.pde", &RING.replace("on seam boundary of ring pairs", seam));
        place.put("run.csv", "x,u\n0,1\n0.5,2\n1,1\n");
        for line in ["check ring.pde", "check ring.pde --data run.csv", "solve ring.pde --data run.csv"] {
            let ran = place.run(line);
            assert_ne!(ran.code, Some(0), "{line}");
            assert!(ran.stderr.contains("write `on seam boundary of DOMAIN pairs`"), "{}", ran.stderr);
        }
    }
}
