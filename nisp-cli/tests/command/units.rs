//! Measurements whose unit seems to be another one than their header says.

use crate::common::Place;

const ROOM: &str = "
    coordinates: t [h];
    fields: T [K];
    sources: P [W];
    parameters: C [kJ/K] = 4000, h [W/K] = 80, out [K] = 278;
    on room { balance: C * d(T, t) + h * (T - out) == P; }
    on samples { observe T; }
";

const ASKED: &str = "where nothing acts";

/// What `check` says of a text and a course of temperatures under a header.
fn checked(text: &str, header: &str, temperature: impl Fn(f64) -> f64) -> String {
    let place = Place::new();
    place.put("room.pde", text);
    let lines: String = (0..60).map(|i| f64::from(i) / 4.0).map(|t| format!("{t},{}\n", temperature(t))).collect();
    place.put("run.csv", &format!("t,{header}\n{lines}"));
    let ran = place.run("check room.pde --data run.csv");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    ran.stdout
}

fn kelvins(t: f64) -> f64 {
    290.0 + 3.0 * (t / 4.0).sin()
}

fn celsius(t: f64) -> f64 {
    kelvins(t) - 273.15
}

#[test]
fn a_stream_asks_as_well() {
    let place = Place::new();
    place.put("room.pde", ROOM);
    let lines: String = (0..60).map(|i| f64::from(i) / 4.0).map(|t| format!("{t},{}\n", celsius(t))).collect();
    for (header, code, rows) in [("T", 2, 0), ("T [K]", 0, 60), ("T [degC]", 0, 60)] {
        place.put("run.csv", &format!("t,{header}\n{lines}"));
        let ran = place.run("stream room.pde --data run.csv");
        assert_eq!((ran.code, ran.stdout.lines().count()), (Some(code), rows), "{header}: {}", ran.stderr);
        assert_eq!(ran.stderr.contains("is `T` in degrees Celsius"), header != "T [degC]", "{}", ran.stderr);
    }
}

#[test]
fn degrees_under_kelvins_are_suspected() {
    let said = checked(ROOM, "T [K]", celsius);
    let question = "and `room.balance` would hold it at 278 K where nothing acts: is `T` in degrees Celsius";
    assert!(said.contains(question) && said.contains("as in `T [degC]`"), "{said}");
    let said = checked(ROOM, "T [K]", |t| 1.8 * celsius(t) + 32.0);
    assert!(said.contains(ASKED) && said.contains("Fahrenheit"), "{said}");
    let said = checked(ROOM, "T [K]", |t| 1e3 * kelvins(t));
    assert!(said.contains("is one of them in another unit, 1000 times too large or small?"), "{said}");
    // An oven that begins in the room, and is hotter than the room in kelvins at last.
    let said = checked(ROOM, "T [K]", |t| 4.9 + 60.0 * t);
    assert!(said.contains("`T` is measured at 4.9 to") && said.contains(question), "{said}");
    let said = checked(ROOM, "T [K]", |t| 278.0 + 20.0 * t);
    assert!(!said.contains(ASKED), "{said}");
    // A minute for a second is asked of a flow, and not of a temperature.
    let said = checked(ROOM, "T [K]", |t| 60.0 * kelvins(t));
    assert!(!said.contains("another unit"), "{said}");
    let flow = ROOM.replace("T [K]", "T [m^3/s]").replace("out [K] = 278", "out [m^3/s] = 278");
    let flow = flow.replace("C [kJ/K]", "C [kJ s/m^3]").replace("h [W/K]", "h [W s/m^3]");
    let said = checked(&flow, "T [m^3/s]", |t| 60.0 * kelvins(t));
    assert!(said.contains("is one of them in another unit, 60 times too large or small?"), "{said}");
    // What it is compared with: a parameter, a fourth power's root, a bound.
    let said = checked(&ROOM.replace("278", "5"), "T [K]", kelvins);
    assert!(said.contains("is what it is compared with in degrees Celsius"), "{said}");
    let radiator = ROOM.replace("h * (T - out)", "1e-6 [W/K^4] * (T^4 - out^4)");
    let said = checked(&radiator, "T [K]", celsius);
    assert!(said.contains("would hold it at 278 K where nothing acts: is `T` in degrees Celsius"), "{said}");
    let bounded = ROOM.replace("fields: T [K]", "fields: T [K] in 250 .. 330");
    let said = checked(&bounded, "T [K]", celsius);
    assert!(said.contains("and its bounds are 250 to 330 K: is `T` in degrees Celsius"), "{said}");
}

#[test]
fn nobody_is_asked_where_units_are_right_or_nothing_is_compared() {
    let asked = |said: &str| said.contains("degrees") || said.contains("another unit");
    for (header, temperature) in [("T [K]", kelvins as fn(f64) -> f64), ("T [degC]", celsius)] {
        let said = checked(ROOM, header, temperature);
        assert!(!asked(&said), "{said}");
    }
    // An oven, a room below its surroundings, and rises of temperature.
    let said = checked(ROOM, "T [K]", |t| 600.0 + 40.0 * t.cos());
    assert!(!asked(&said), "{said}");
    let said = checked(ROOM, "T [K]", |t| 240.0 + 10.0 * t.cos());
    assert!(!asked(&said), "{said}");
    let rise = ROOM.replace("T - out", "T").replace(", out [K] = 278", "");
    let said = checked(&rise, "T [K]", |t| 0.6 + 0.2 * t.cos());
    assert!(!asked(&said), "{said}");
    // What is sought may be anything, also where something else of its unit is known.
    let sought = "
        coordinates: t [h];
        fields: T [K];
        sources: out [K];
        parameters: C [kJ/K] = 4000, h [W/K] = 10, g [W/K] = 140, cellar [K] = 284;
        on room { balance: C * d(T, t) + h * (T - cellar) + g * (T - out) == 0 [W]; }
        on samples { observe T; }
    ";
    let said = checked(sought, "T [K]", kelvins);
    assert!(!asked(&said), "{said}");
}

#[test]
fn solve_warns_of_what_check_asks() {
    let place = Place::new();
    place.put("room.pde", ROOM);
    place.put("run.csv", &record("T [K]"));
    let ran = place.run("solve room.pde --data run.csv");
    assert!(ran.stdout.contains("is `T` in degrees Celsius"), "{}", ran.stdout);
}

#[test]
fn a_doubtful_column_without_a_unit_is_refused_until_one_is_said() {
    let place = Place::new();
    place.put("room.pde", ROOM);
    place.put("run.csv", &record("T"));
    for command in ["solve room.pde --data run.csv", "check room.pde --data run.csv"] {
        let ran = place.run(command);
        assert_eq!(ran.code, Some(2), "{}", ran.stdout);
        assert!(ran.stderr.contains("is `T` in degrees Celsius"), "{}", ran.stderr);
        assert!(ran.stderr.contains("--column 'T=HEADER [K]'"), "{}", ran.stderr);
    }
    // Either unit is taken, in the header or with it; brackets need no blank.
    for (header, column, is_asked) in
        [("T", "--column T=T[K]", true), ("T", "--column T=T[degC]", false), ("T_K", "", true), ("T [degC]", "", false)]
    {
        place.put("run.csv", &record(header));
        let ran = place.run(&format!("check room.pde --data run.csv {column}"));
        assert_eq!(ran.code, Some(0), "{header} {column}: {}", ran.stderr);
        assert_eq!(ran.stdout.contains("in degrees"), is_asked, "{header} {column}: {}", ran.stdout);
    }
}

/// A record of degrees Celsius under a header.
fn record(header: &str) -> String {
    let lines: String = (0..60).map(|i| f64::from(i) / 4.0).map(|t| format!("{t},{:.2}\n", celsius(t))).collect();
    format!("t,{header}\n{lines}")
}
