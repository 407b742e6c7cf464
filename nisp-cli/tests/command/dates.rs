//! Records whose times are dates.

use std::f64::consts::PI;

use crate::common::Place;
use serde_json::Value;

const ROOM: &str = "coordinates: t [min]; fields: T [K]; sources: P [K/min];
on body { warms: d(T, t) == P; } on samples { observe T; }
";

/// A warming of closed form, minute by minute over midnight, from minute `first`.
fn log(first: u32, header: &str, value: fn(f64) -> f64) -> String {
    let row = |minute: u32| {
        let of_day = (23 * 60 + minute) % (24 * 60);
        let day = if minute < 60 { 28 } else { 29 };
        format!("2024-02-{day} {:02}:{:02}:00,{}\n", of_day / 60, of_day % 60, value(f64::from(minute)))
    };
    format!("stamp,{header}\n{}", (first..=120).map(row).collect::<String>())
}

#[test]
fn dates_are_times_counted_from_the_first_row_in_every_table() {
    let place = Place::new();
    place.put("room.pde", ROOM);
    place.put("log.csv", &log(0, "T [K]", |t| 290.0 + 10.0 * (1.0 - (PI * t / 120.0).cos())));
    // The truth begins later, and is counted from the same moment.
    place.put("truth.csv", &log(30, "P [K/min]", |t| 10.0 * PI / 120.0 * (PI * t / 120.0).sin()));
    let files = "room.pde --data log.csv --truth truth.csv --column t=stamp";
    let ran = place.run(&format!("solve {files} --out out --json"));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let object: Value = serde_json::from_str(&ran.stdout).unwrap();
    let [error, size] = ["P", "P_if_zero"].map(|name| object["errors"][name].as_f64().unwrap());
    assert!(error < 1e-3 * size, "{error} {size}");
    assert!(ran.stdout.contains("counted from 2024-02-28 23:00:00"), "{}", ran.stdout);
    // A saved answer knows that moment, too: 20 minutes after it, and at the end.
    place.put("at.csv", "stamp\n2024-02-28 23:20:00\n2024-02-29 01:00:00\n");
    let eval = place.run("eval out/answer.nisp --at at.csv --column t=stamp --of P");
    let rows: Vec<Vec<f64>> =
        eval.stdout.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [20.0, 120.0], "{}{}", eval.stdout, eval.stderr);
    let exact = 10.0 * PI / 120.0 * (PI / 6.0).sin();
    assert!((rows[0][1] - exact).abs() < 0.01 * exact, "{} {exact}", rows[0][1]);
}

#[test]
fn tables_may_have_headers_of_their_own() {
    let place = Place::new();
    place.put(
        "room.pde",
        &ROOM.replace(
            "on body { warms: d(T, t) == P; }",
            "on body { columns: A [K]; warms: d(T, t) == P + A / 60 [min]; }",
        ),
    );
    place.put("log.csv", &log(0, "T [K]", |t| 290.0 + 10.0 * (1.0 - (PI * t / 120.0).cos())));
    place.put("air.csv", &log(0, "air", |t| 20.0 + (PI * t / 120.0).sin()).replacen("stamp", "when", 1));
    let files = "room.pde --data samples=log.csv --data body=air.csv";
    let asked = place.run(&format!("check {files}"));
    let said = ["--column t=stamp", "--column t=when"];
    assert!(said.iter().all(|part| asked.stderr.contains(part)), "{}", asked.stderr);
    let ran = place.run(&format!("check {files} --column t=stamp --column t=when --column A=air[degC]"));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stdout.contains("A [K]: 293.15 to 294.15"), "{}", ran.stdout);
    let slip = place.run(&format!("check {files} --column t=stmp --column t=when --column A=air"));
    assert!(slip.code == Some(2) && slip.stderr.contains("no column for `stmp`"), "{}", slip.stderr);
}
