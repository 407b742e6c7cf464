//! Records row by row: what is said of each, and what of those that cannot be taken.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

use serde_json::Value;

use crate::common::Place;

const SPRING: &str = "\
coordinates: t [s];
fields: y [m];
sources: u [m/s^2];
on motion { balance: d(y, t, 2) + 0.4 [1/s] * d(y, t) + 4 [1/s^2] * y == u; }
on samples { observe y; }
scene recover { }
";

/// A turn in five seconds, and the force that it takes.
fn motion(t: f64) -> (f64, f64) {
    let rate = TAU / 5.0;
    let (sine, cosine) = (rate * t).sin_cos();
    (sine, (4.0 - rate * rate) * sine + 0.4 * rate * cosine)
}

/// A row of the record; digits of a sine that turns fast stand for noise.
fn row(i: usize) -> String {
    let t = 0.05 * i as f64;
    let noise = (43_758.545_3 * (12.989_8 * i as f64).sin()).rem_euclid(1.0) - 0.5;
    format!("{t},{}", motion(t).0 + 0.02 * noise)
}

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn every_row_has_its_line_and_a_bad_one_is_named() {
    let place = Place::new();
    place.put("spring.pde", SPRING);
    let mut csv = String::from("t_s,y_m\n");
    for i in 0..400 {
        // One value is far off.
        writeln!(csv, "{}", if i == 360 { "18,1".into() } else { row(i) }).unwrap();
        match i {
            250 => csv.push_str("3,1\n"),
            300 => csv.push_str("15.01,word\n"),
            320 => csv.push_str("16.01,1,2\n"),
            340 => csv.push_str("1e6,1\n"),
            _ => {}
        }
    }
    place.put("run.csv", &csv);
    let ran = place.run("stream spring.pde --data run.csv");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let (bad, good): (Vec<_>, Vec<_>) = lines(&ran.stdout).into_iter().partition(|line| line["status"] == "error");
    assert_eq!((good.len(), bad.len()), (400, 4));
    let wrong = [
        ("3 does not come after 12.5", Some(3.0)),
        ("`word` is not a number", Some(15.01)),
        ("3 cells where", None),
        ("1000000 is far ahead", Some(1e6)),
    ];
    for (line, (what, at)) in bad.iter().zip(wrong) {
        assert!(line["error"].as_str().unwrap().contains(what) && line["t"].as_f64() == at, "{line}");
    }
    let mut within = 0;
    for (i, line) in good.iter().enumerate() {
        let (t, source) = (line["t"].as_f64().unwrap(), &line["sources"]["u"]);
        assert!((t - 0.05 * i as f64).abs() < 1e-9 && line["latency_ms"].as_f64().unwrap() > 0.0, "{line}");
        assert_eq!(line["status"], "converged");
        assert_eq!(line.get("stray"), (i == 360).then_some(&Value::Bool(true)));
        let (value, sd) = (source["value"].as_f64().unwrap(), source["sd"].as_f64().unwrap());
        within += usize::from((value - motion(t).1).abs() < 2.0 * sd);
        assert!((line["state"]["y"]["value"].as_f64().unwrap() - motion(t).0).abs() < 0.02, "{line}");
    }
    assert!(within > 370, "{within} of 400 within two deviations");
    let lag = |line: &Value| line["lag"].as_f64().unwrap();
    assert!(lag(&good[399]) < 1e-9 && (lag(&good[200]) - lag(&good[210])).abs() < 1e-6);
}

/// A clock that was set back ends a record and begins another: its rows are answered, and so are those that waited.
#[test]
fn a_clock_that_is_set_back_begins_a_record_anew() {
    let place = Place::new();
    place.put("spring.pde", SPRING);
    let mut csv = String::from("t_s,y_m\n");
    for i in (0..320).chain(100..400) {
        writeln!(csv, "{}", row(i)).unwrap();
    }
    place.put("run.csv", &csv);
    let ran = place.run("stream spring.pde --data run.csv");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stderr.contains("20 rows rise from `t` = 5 on") && ran.stderr.contains("set back"), "{}", ran.stderr);
    let (bad, good): (Vec<_>, Vec<_>) = lines(&ran.stdout).into_iter().partition(|line| line["status"] == "error");
    assert_eq!((good.len(), bad.len()), (620, 20));
    for (i, line) in (0..320).chain(100..400).zip(&good) {
        let t = line["t"].as_f64().unwrap();
        assert!((t - 0.05 * f64::from(i)).abs() < 1e-9, "{line}");
        assert!((line["state"]["y"]["value"].as_f64().unwrap() - motion(t).0).abs() < 0.02, "{line}");
    }
}

/// Loggers write titles, a line of units, dates and Windows line ends, into pipes as into files.
#[test]
fn what_files_may_have_streams_may_have() {
    let place = Place::new();
    place.put("spring.pde", SPRING);
    let mut csv = String::from("Rig 7\r\nRun of today;;\r\n\r\nclock;y\r\n;mm\r\n");
    for i in 0..300 {
        let (plain, ms) = (row(i), 50 * i);
        let y: f64 = plain.split_once(',').unwrap().1.parse().unwrap();
        let clock = format!("31.01.2026 23:59:{:02}.{:03}", 40 + ms / 1000, ms % 1000);
        let y = format!("{}", 1e3 * y).replace('.', ",");
        writeln!(csv, "{clock};{}\r", if i == 250 { "oops".into() } else { y }).unwrap();
    }
    place.put("run.csv", &csv);
    let ran = place.run("stream spring.pde --data run.csv --column t=clock");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stderr.contains("counted from 2026-01-31 23:59:40"), "{}", ran.stderr);
    let (bad, good): (Vec<_>, Vec<_>) = lines(&ran.stdout).into_iter().partition(|line| line["status"] == "error");
    let [bad] = &bad[..] else { panic!("{bad:?}") };
    assert!(bad["error"].as_str().unwrap().contains("line 256, column `y [mm]`: `oops`"), "{bad}");
    assert_eq!(good.len(), 299);
    let is_right = |line: &Value| {
        let t = line["t"].as_f64().unwrap();
        (line["state"]["y"]["value"].as_f64().unwrap() - motion(t).0).abs() < 0.02
    };
    assert!(good.iter().all(is_right) && good[298]["t"].as_f64().is_some_and(|t| (t - 14.95).abs() < 1e-9));
}

/// What is asked of a program that waits: an answer before the input ends.
#[test]
fn rows_are_answered_as_they_come() {
    let place = Place::new();
    place.put("spring.pde", SPRING);
    let mut command = place.command("stream spring.pde - --lag 0.5");
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap()).lines();
    input.write_all(b"t_s,y_m\n").unwrap();
    (0..200).for_each(|i| writeln!(input, "{}", row(i)).unwrap());
    let mut next = || serde_json::from_str::<Value>(&output.next().unwrap().unwrap()).unwrap()["t"].as_f64().unwrap();
    // All but the ten rows of the lag.
    (0..190).for_each(|i| assert!((next() - 0.05 * f64::from(i)).abs() < 1e-9));
    for i in 200..220 {
        writeln!(input, "{}", row(i)).unwrap();
        assert!((next() - 0.05 * (i as f64 - 10.0)).abs() < 1e-9);
    }
    drop(input);
    (0..10).for_each(|i| assert!((next() - 0.05 * f64::from(210 + i)).abs() < 1e-9));
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn what_cannot_be_followed_is_said_with_what_to_do() {
    let place = Place::new();
    place.put("spring.pde", SPRING);
    place.put("few.csv", "t_s,y_m\n0,1\n1,1\n");
    place.put("other.csv", "t_s,x_m\n0,1\n1,1\n");
    place.put("empty.csv", &format!("t_s,y_m\n{}", (0..20).map(|i| format!("{i},\n")).collect::<String>()));
    for (line, code, what) in [
        ("stream spring.pde --data few.csv", 3, "too few"),
        ("stream spring.pde --data empty.csv", 3, "none of the first 20 rows has a measurement"),
        ("stream spring.pde --data other.csv", 2, "y"),
        ("stream spring.pde --data none.csv", 2, "none.csv"),
        ("stream spring.pde --data few.csv --maps maps", 2, "--maps is about clouds"),
        ("stream membrane --data few.csv", 2, "rows"),
        ("stream plate --data few.csv", 2, "nisp solve"),
    ] {
        let ran = place.run(line);
        assert_eq!(ran.code, Some(code), "{line}: {}", ran.stderr);
        assert!(ran.stderr.contains(what), "{line}: {}", ran.stderr);
    }
}
