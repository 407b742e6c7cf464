//! Sources that lattices must find though their cells are too coarse for strict equations.

use std::f64::consts::PI;

use serde_json::Value;

use crate::common::Place;

const SKIN: &str = "units: off;
coordinates: x, y, t: time;
fields: u;
sources: q(x, y);
domains: skin = box(0 .. 1, 0 .. 1) times 0 .. 3;
on inside in skin { balance: d(u, t, 2) == 0.09 * laplacian(u) + q; }
on edge boundary of skin { held: u == 0; }
on begin start of skin { flat: u == 0; still: d(u, t) == 0; }
on probes { observe u; }
";

/// Modes of the source with their amplitudes.
const MODES: [(f64, f64, f64); 3] = [(1.0, 1.0, 1.0), (2.0, 1.0, 0.6), (1.0, 2.0, 0.4)];

fn sum(x: f64, y: f64, of: impl Fn(f64) -> f64) -> f64 {
    let mode =
        |&(m, n, size): &(f64, f64, f64)| size * (m * PI * x).sin() * (n * PI * y).sin() * of(0.3 * PI * m.hypot(n));
    MODES.iter().map(mode).sum()
}

/// A load that is put on a skin at once. On the first lattice a strict equation missed the measurements, which then counted as noise, and
/// the load was nothing.
#[test]
fn a_load_over_two_lengths_is_found_from_what_it_sets_in_motion() {
    let place = Place::new();
    // Places that fill the domain evenly, by powers of a root of x^4 = x + 1; noise of three even numbers, of deviation one.
    let share = |number: usize, power: i32| (number as f64 / 1.220_744_084_605_76_f64.powi(power)).fract();
    let noise = |number: usize| 2.0 * (1..=3).map(|k| share(7919 * number + 13 * k, 4) - 0.5).sum::<f64>();
    let row = |number: usize| {
        let [x, y, t] = [1, 2, 3].map(|power| share(number, power));
        let u = sum(x, y, |rate| (1.0 - (3.0 * rate * t).cos()) / (rate * rate));
        format!("{x},{y},{},{}\n", 3.0 * t, u + 0.002 * noise(number))
    };
    place.put("skin.pde", SKIN);
    place.put("probes.csv", &format!("x,y,t,u\n{}", (1..=1000).map(row).collect::<String>()));
    let ran = place.run("solve skin.pde --data probes.csv --grid 9x9x2 --budget 120 --json --out out");
    let report: Value = serde_json::from_str(&ran.stdout).unwrap_or_else(|_| panic!("{}{}", ran.stdout, ran.stderr));
    let rows = place.rows("out/source.csv");
    let [mut off, mut size] = [0.0; 2];
    for row in &rows {
        let [x, y, q] = [row[0], row[1], row[3]];
        let exact = sum(x, y, |_| 1.0);
        (off, size) = (off + (q - exact).powi(2), size + exact.powi(2));
    }
    assert!(off < 0.01 * size, "{} of the load, {}", (off / size).sqrt(), report["verdict"]);
    assert_eq!(ran.code, Some(0), "{}", report["verdict"]);
}
