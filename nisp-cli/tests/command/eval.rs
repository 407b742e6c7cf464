//! `nisp eval`: a saved answer, read without its data.

use std::fs;

use crate::common::{Place, Ran, circuit, names};
use serde_json::Value;

/// A cantilever of 1 m under `q0 = 100 N/m`, for which Euler and Bernoulli's equation has the solution
/// `w = q0 x^2 (x^2 - 4 x + 6) / 24 EI`, the moment `-q0 (1 - x)^2 / 2` and the shear force `q0 (1 - x)`.
const BEAM: &str = "
/// A cantilever under an unknown load.
coordinates: x [m];
fields: w [mm];
sources: q [N/m];
parameters: EI [N m^2] = 210;
let M = -EI * d(w, x, 2);
let Q = d(M, x);
domains: beam = 0 .. 1;
on inside in beam { balance: EI * d(w, x, 4) == q; }
on wall start of beam { clamped: w == 0; slope: d(w, x) == 0; }
on tip end of beam { free: d(w, x, 2) == 0; shear: d(w, x, 3) == 0; }
on gauges { observe w; }
";

/// A beam that was solved from deflections good to 0.05 mm, and whose data are gone.
fn solved() -> Place {
    let place = Place::new();
    place.put("beam.pde", BEAM);
    let row = |i: usize| {
        let x = i as f64 / 59.0;
        let w = 1e3 * 100.0 * x * x * (x * x - 4.0 * x + 6.0) / (24.0 * 210.0);
        // Disturbances of the size of noise that do not repeat (Weyl's quadratic sequence).
        format!("{x},{}\n", w + 0.07 * ((i * i) as f64 * 0.7548).sin())
    };
    place.put("gauges.csv", &("x [m],w [mm]\n".to_string() + &(0..60).map(row).collect::<String>()));
    let ran = place.run("solve beam.pde --data gauges.csv --out beam");
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
    for gone in ["beam.pde", "gauges.csv"] {
        fs::remove_file(place.path(gone)).unwrap();
    }
    place
}

/// Runs with arguments that hold spaces.
fn run(place: &Place, line: &str, of: &str) -> Ran {
    let output = place.command(line).args(["--of", of]).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ran { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

fn object(ran: &Ran) -> Value {
    serde_json::from_str(&ran.stdout).unwrap_or_else(|_| panic!("{}", ran.stderr))
}

/// Values or deviations of the quantity of this number.
fn numbers(object: &Value, at: usize, what: &str) -> Vec<f64> {
    object["values"][at][what].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

#[test]
fn moment_and_shear_force_are_read_with_their_deviations() {
    let place = solved();
    let ran = run(&place, "eval beam/answer.nisp --grid 9 --json", "w, M, Q, EI, -M/EI");
    assert_eq!((ran.code, ran.stderr.as_str()), (Some(0), ""));
    let object = object(&ran);
    let described = |at: usize| (object["values"][at]["name"].clone(), object["values"][at]["unit"].clone());
    let expected = [("w", "mm"), ("M", "J"), ("Q", "N"), ("EI", "N m^2"), ("-M / EI", "1/m")];
    for (at, (name, unit)) in expected.into_iter().enumerate() {
        assert_eq!(described(at), (name.into(), unit.into()));
    }
    let x: Vec<f64> =
        object["coordinates"][0]["values"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
    assert_eq!(x, (0..9).map(|i| f64::from(i) / 8.0).collect::<Vec<f64>>());
    let [moment, shear] = [1, 2].map(|at| (numbers(&object, at, "values"), numbers(&object, at, "deviations")));
    for (at, x) in x.iter().enumerate() {
        let is_right = |(values, deviations): &(Vec<f64>, Vec<f64>), exact: f64, most: f64| {
            let (error, deviation) = ((values[at] - exact).abs(), deviations[at]);
            assert!(error < 4.0 * deviation + 1e-3 && deviation < most, "{x}: {error} {deviation}");
        };
        is_right(&moment, -50.0 * (1.0 - x).powi(2), 5.0);
        is_right(&shear, 100.0 * (1.0 - x), 50.0);
    }
    // A given parameter is exact, and a curvature is a moment over a stiffness.
    assert!(numbers(&object, 3, "values").iter().all(|value| (value - 210.0).abs() < 1e-9));
    assert!(numbers(&object, 3, "deviations").iter().all(|deviation| *deviation == 0.0));
    // Variances lose half of their digits where a condition holds the quantity, as at the tip.
    let most = moment.1.iter().fold(0.0, |most: f64, x| most.max(*x));
    for (curvature, moment) in numbers(&object, 4, "deviations").iter().zip(&moment.1) {
        assert!((curvature * 210.0 - moment).abs() < 1e-3 * most, "{curvature} {moment}");
    }
}

#[test]
fn values_are_those_of_the_tables() {
    let place = solved();
    let ran = place.run("eval beam/answer.nisp --at beam/source.csv --out read.csv");
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(0), "wrote 60 rows to read.csv\n"), "{}", ran.stderr);
    let columns = |file: &str| -> Vec<(String, Vec<f64>)> {
        let text = fs::read_to_string(place.path(file)).unwrap();
        let mut lines = text.lines();
        let headers = lines.next().unwrap().split(',').map(str::to_string);
        let rows: Vec<Vec<f64>> =
            lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
        headers.enumerate().map(|(at, header)| (header, rows.iter().map(|row| row[at]).collect())).collect()
    };
    let read = columns("read.csv");
    assert_eq!(
        read.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        ["x [m]", "w [mm]", "w_sd [mm]", "q [N/m]", "q_sd [N/m]"]
    );
    for (name, values) in columns("beam/source.csv").iter().chain(&columns("beam/state.csv")) {
        let (_, again) = read.iter().find(|(own, _)| own == name).unwrap();
        if name.contains("_sd") {
            values.iter().zip(again).for_each(|(a, b)| assert!((a / b - 1.0).abs() < 1e-9, "{name}: {a} {b}"));
        } else {
            assert_eq!(values, again, "{name}");
        }
    }
}

#[test]
fn points_outside_have_no_value_and_are_counted() {
    let place = solved();
    place.put("at.csv", "x [mm]\n100\n2000\n-5\n1000\n");
    let ran = place.run("eval beam/answer.nisp --at at.csv");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stderr.contains("2 of 4 points lie outside") && ran.stderr.contains("x = 0 to 1 m"), "{}", ran.stderr);
    let cells: Vec<&str> = ran.stdout.lines().skip(1).map(|line| line.split(',').nth(1).unwrap()).collect();
    assert!(cells[1] == "NaN" && cells[2] == "NaN", "{cells:?}");
    assert!(cells[0].parse::<f64>().unwrap() > 1.0 && cells[3].parse::<f64>().unwrap() > 50.0, "{cells:?}");
    let ran = place.run("eval beam/answer.nisp --at at.csv --json");
    assert_eq!(object(&ran)["values"][0]["values"][1], Value::Null);
    place.put("far.csv", "x\n3\n");
    let ran = place.run("eval beam/answer.nisp --at far.csv");
    assert!(ran.code == Some(2) && ran.stderr.contains("none of the 1 points"), "{}", ran.stderr);
}

#[test]
fn what_cannot_be_read_is_refused_with_what_to_do() {
    let place = solved();
    place.put("seconds.csv", "x [s]\n1\n");
    place.put("y.csv", "when [m],remark\n0.5,7\n");
    let bytes = fs::read(place.path("beam/answer.nisp")).unwrap();
    fs::write(place.path("cut.nisp"), &bytes[..1000]).unwrap();
    let mut later = bytes.clone();
    later[12] = b'7';
    fs::write(place.path("later.nisp"), &later).unwrap();
    let refusal = |line: &str| {
        let ran = place.run(line);
        assert!(ran.code == Some(2) && ran.stdout.is_empty(), "{line}: {:?} {}", ran.code, ran.stdout);
        ran.stderr
    };
    for (line, expected) in [
        ("eval beam/source.csv --grid 5", "not a saved answer"),
        ("eval cut.nisp --grid 5", "damaged"),
        ("eval later.nisp --grid 5", "layout 7"),
        ("eval nowhere.nisp --grid 5", "no such file"),
        ("eval beam/answer.nisp", "--at <FILE>|--grid <NxM>"),
        ("eval beam/answer.nisp --grid 5x5", "one for each of the coordinates x"),
        ("eval beam/answer.nisp --at seconds.csv", "`x [s]` is in s, where `x` is in m"),
        ("eval beam/answer.nisp --at y.csv", "--column x="),
        ("eval beam/answer.nisp --at y.csv --column z=when", "no coordinate `z`"),
        ("eval beam/answer.nisp --grid 5 --of moment", "`moment` is not declared"),
        ("eval beam/answer.nisp --grid 5 --of sin(w)", "pure number"),
        ("eval beam/answer.nisp --grid 5 --of q_xxxxx", "order 4 is the highest"),
        ("eval beam/answer.nisp --grid 5 --of ,", "expected"),
        ("eval beam/answer.nisp --grid 5 --of integral(q)", "declare a field `F` with `d(F, t) == 2 * f`"),
    ] {
        let said = refusal(line);
        assert!(said.contains(expected), "{line}: {said}");
    }
    assert_eq!(place.run("eval beam/answer.nisp --at y.csv --column x=when").code, Some(0));
    let ran = place.run("eval beam/answer.nisp --grid 5 --out beam");
    assert_eq!(ran.code, Some(4), "{}", ran.stderr);
}

#[test]
fn a_shipped_equation_is_read_by_its_own_text() {
    let place = Place::new();
    place.put("volts.csv", &("t_s,v_V\n".to_string() + &circuit(60, |_, t, v| format!("{t},{v}\n"))));
    let ran = place.run("solve rlc --data volts.csv --iterations 60 --out out");
    assert!(names(&place.path("out")).contains(&"answer.nisp".to_string()), "{}", ran.stderr);
    // The balance of the circuit, which the solver holds to its own residual.
    let balance = "d(v, t, 2) + a * d(v, t) + b * v - c * d(f, t) - e * f";
    let ran = run(&place, "eval out/answer.nisp --grid 20 --json", &format!("v, d(v, t, 2), {balance}"));
    let object = object(&ran);
    let most = |at: usize| numbers(&object, at, "values").into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    assert!(most(2) < 0.1 * most(1) && most(1) > 1.0, "{} {}", most(2), most(1));
    assert!(!object["warnings"].to_string().contains("ships"), "{object}");
}

#[test]
fn an_equation_that_has_changed_since_is_said_and_read_as_it_was() {
    const SHIPPED: &str = include_str!("../../../equations/src/rlc.rs");
    let place = Place::new();
    let text = SHIPPED.split_once("pde! {").unwrap().1.split_once("\n}\n").unwrap().0;
    place.put("older.pde", &text.replace("c * d(f, t)", "2 * c * d(f, t)"));
    place.put("volts.csv", &("t_s,v_V\n".to_string() + &circuit(60, |_, t, v| format!("{t},{v}\n"))));
    place.run("solve older.pde --data volts.csv --iterations 20 --out out");
    let ran = place.run("eval out/answer.nisp --grid 3");
    assert!(ran.stdout.starts_with("t [s],v [V],f [V]\n0,"), "{}", ran.stdout);
    assert!(ran.stderr.contains("`rlc` is not the one that ships with this version"), "{}", ran.stderr);
}

#[test]
fn an_answer_that_failed_a_check_says_so_again() {
    let place = Place::new();
    let ran = place.run("solve rlc --set f0=1e8 --budget 3 --out out");
    assert_eq!(ran.code, Some(3), "{}", ran.stdout);
    let ran = place.run("eval out/answer.nisp --grid 3");
    assert_eq!(ran.code, Some(3), "{}", ran.stdout);
    assert!(
        ran.stderr.contains("not to be relied on") && ran.stderr.contains("failed when it was solved"),
        "{}",
        ran.stderr
    );
    assert!(ran.stdout.starts_with("t [s],v [V],f [V]\n"), "{}", ran.stdout);
}

/// A load of `q0 sin(pi x)` on a string under the tension `S` bends it by `q0 sin(pi x) / (S pi^2)`; up to `x` it weighs
/// `q0 (1 - cos(pi x)) / pi`.
#[test]
fn an_integral_is_read_as_a_field_of_its_own() {
    let place = Place::new();
    let text = "coordinates: x [m]; fields: w [mm], Q [N]; sources: q [N/m]; parameters: S [N] = 50;
        domains: string = 0 .. 1;
        on inside in string { balance: -S * d(w, x, 2) == q; weight: d(Q, x) == q; }
        on left start of string { none: Q == 0 [N]; held: w == 0; }
        on right end of string { held: w == 0; }
        on gauges { observe w; }";
    place.put("string.pde", text);
    let pi = std::f64::consts::PI;
    let row = |i: usize| {
        let x = i as f64 / 79.0;
        let w = 1e3 * 100.0 * (pi * x).sin() / (50.0 * pi * pi);
        format!("{x},{}\n", w + 0.3 * ((i * i) as f64 * 0.7548).sin())
    };
    place.put("w.csv", &("x,w\n".to_string() + &(0..80).map(row).collect::<String>()));
    let ran = place.run("solve string.pde --data w.csv");
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
    let object = object(&run(&place, "eval nisp-out/answer.nisp --grid 5 --json", "Q"));
    let (values, deviations) = (numbers(&object, 0, "values"), numbers(&object, 0, "deviations"));
    for (at, (value, deviation)) in values.iter().zip(&deviations).enumerate() {
        let exact = 100.0 * (1.0 - (pi * at as f64 / 4.0).cos()) / pi;
        assert!((value - exact).abs() < 3.0 * deviation + 1e-6, "{at}: {value} ± {deviation} for {exact}");
        assert!(*deviation < 4.0, "{at}: {deviation}");
    }
}
