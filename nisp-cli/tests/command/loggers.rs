//! Tables as loggers write them.

use crate::common::Place;

const ROD: &str = "coordinates: x [m], t [min]; fields: T [K]; sources: q(x) [K/min];
domains: rod = 0 .. 0.2 times 0 .. 3;
on body in rod { warms: d(T, t) == 1 [m^2/min] * d(T, x, 2) + q; } on samples { observe T; }
";

/// The log of three sensors over four minutes: titles, decimal commas, dates, and a line of units.
fn log(headers: &str) -> String {
    let row = |minute: u32| format!("31.12.2025 23:{};2{minute},5;21;3{minute},25\n", 57 + minute);
    let rows = (0..3).map(row).collect::<String>();
    format!("Logger 7, hall 2\nserial;77\nwhen;{headers}\n;°C;°C;°C\n{rows}01.01.2026;29,5;21;33,25\n")
}

#[test]
fn sensors_have_columns_whose_headers_say_their_places() {
    let place = Place::new();
    place.put("rod.pde", ROD);
    place.put("log.csv", &log("T(x=10 mm);T(x=0 mm);T(x=200 mm)"));
    let ran = place.run("check rod.pde --data log.csv --column t=when");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let said = ["samples: 12 points", "x [m]: 0 to 0.2", "t [min]: 0 to 3", "T [K]: 293.65 to 306.4"];
    assert!(said.iter().all(|part| ran.stdout.contains(part)), "{}", ran.stdout);
    place.put("log.csv", &log("T_1;T_2;T_3"));
    let asked = place.run("check rod.pde --data log.csv --column t=when");
    assert_eq!(asked.code, Some(2));
    assert!(asked.stderr.contains("no column for `x` in m"), "{}", asked.stderr);
    assert!(asked.stderr.contains("its header may say where that is, as `T(x=0.1)`"), "{}", asked.stderr);
}
