//! A source over a rod and time from probes at few places.

use std::f64::consts::PI;

use serde_json::Value;

use crate::common::Place;

const ROD: &str = "units: off;
coordinates: x, t: time;
fields: u;
sources: q;
domains: rod = 0 .. 1 times 0 .. 2;
on inside in rod { balance: d(u, t) == 0.1 * d(u, x, 2) + q; }
on ends boundary of rod { held: u == 0; }
on begin start of rod { first: u == 0; }
on probes { observe u; }
";

/// What `4 sin(2 pi x) sin(3 t)` heats, in closed form.
fn heated(x: f64, t: f64) -> f64 {
    let rate = 0.1 * (2.0 * PI).powi(2);
    let along = rate * (3.0 * t).sin() - 3.0 * (3.0 * t).cos() + 3.0 * (-rate * t).exp();
    4.0 * (2.0 * PI * x).sin() * along / (rate * rate + 9.0)
}

/// Exact values at two or three places leave most of a source open: an answer that is called right has bars that say so.
#[test]
fn exact_probes_at_few_places_leave_a_source_its_bars() {
    for probes in [&[0.3, 0.7][..], &[0.25, 0.5, 0.75]] {
        let place = Place::new();
        place.put("rod.pde", ROD);
        let times = (1..=40).map(|i| f64::from(i) / 20.0);
        let row = |(t, x): (f64, &f64)| format!("{x},{t},{:.8}\n", heated(*x, t));
        let rows: String = times.flat_map(|t| probes.iter().map(move |x| row((t, x)))).collect();
        place.put("probes.csv", &format!("x,t,u\n{rows}"));
        let ran = place.run("solve rod.pde --data probes.csv --budget 20 --json --out out");
        let report: Value = serde_json::from_str(&ran.stdout).unwrap();
        // On a busy machine the budget may end before the bars: that is said.
        let has_bars = report["sources"][0]["deviations"].is_array();
        assert!(has_bars || report["status"] != "converged" || ran.stdout.contains("no time was left"), "{report}");
        if !has_bars {
            continue;
        }
        let rows = place.rows("out/source.csv");
        let exact = |row: &[f64]| 4.0 * (2.0 * PI * row[0]).sin() * (3.0 * row[1]).sin();
        let beyond = rows.iter().filter(|row| (row[2] - exact(row)).abs() > 2.0 * row[3]).count();
        assert!(10 * beyond < rows.len(), "{beyond} of {} beyond two deviations", rows.len());
    }
}
