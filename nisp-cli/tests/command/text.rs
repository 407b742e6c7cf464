//! Equations in text files.

use std::f64::consts::PI;
use std::fs;

use crate::common::{Place, Ran, circuit_table, names};
use serde_json::Value;

fn object(ran: &Ran) -> Value {
    serde_json::from_str(&ran.stdout).unwrap_or_else(|_| panic!("{}", ran.stderr))
}

#[test]
fn a_shipped_equation_in_a_text_has_the_same_answer() {
    const SOURCE: &str = include_str!("../../../equations/src/rlc.rs");
    let place = Place::new();
    let (_, text) = SOURCE.split_once("pde! {").unwrap();
    place.put("circuit.pde", text.split_once("\n}\n").unwrap().0);
    place.put("volts.csv", &circuit_table());
    let solve = |name: &str| object(&place.run(&format!("solve {name} --data volts.csv --iterations 40 --json")));
    let [shipped, read] = ["rlc", "circuit.pde"].map(solve);
    let loss = |object: &Value| object["loss"].as_f64().unwrap();
    assert!((loss(&shipped) / loss(&read) - 1.0).abs() < 1e-9, "{} {}", loss(&shipped), loss(&read));
    let values = |object: &Value| -> Vec<f64> {
        object["sources"][0]["values"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    assert_eq!(values(&read).len(), 60);
    for (a, b) in values(&shipped).iter().zip(values(&read)) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn a_new_equation_already_solves() {
    let place = Place::new();
    let made = place.run("new cup");
    assert_eq!(made.code, Some(0), "{}", made.stderr);
    assert_eq!(names(&place.path("cup")), ["README.md", "cup.pde", "data.csv", "truth.csv"]);
    let readme = fs::read_to_string(place.path("cup/README.md")).unwrap();
    for command in ["nisp check cup.pde --data data.csv", "nisp solve cup.pde --data data.csv --truth truth.csv"] {
        assert!(readme.contains(command), "{readme}");
    }
    let checked = place.run("check cup/cup.pde --data cup/data.csv --latex");
    let seen =
        ["A body that an unknown heater warms", "source     P     [W]", "samples: 121 points", "\\frac", "noise about"];
    assert!(seen.iter().all(|part| checked.stdout.contains(part)), "{}", checked.stdout);
    let ran = place.run("solve cup/cup.pde --data cup/data.csv --truth cup/truth.csv --budget 60 --json");
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
    let errors = &object(&ran)["errors"];
    // Two per cent of the power that the data were made with.
    let [error, size] = ["P", "P_if_zero"].map(|name| errors[name].as_f64().unwrap());
    assert!(error < 0.02 * size, "{errors}");
    let again = place.run("new cup");
    assert!(again.code == Some(2) && again.stderr.contains("cup is there already"), "{}", again.stderr);
    assert!(place.run("new move --rust").stderr.contains("a word of Rust"));
    assert!(place.run("new 3d").stderr.contains("letters, digits and underscores"));
}

#[test]
fn words_of_rust_are_names_where_they_mean_nothing() {
    let place = Place::new();
    place.put(
        "reactor.pde",
        "coordinates: t [h]; fields: yield [kg]; sources: loop [kg/h]; parameters: type [1/h] = 0.1;
         on move { static: d(yield, t) == loop - type * yield; } on box { observe yield; }",
    );
    let row = |i: u32| format!("{i},{}\n", 5.0 + (0.3 * f64::from(i)).sin());
    place.put("run.csv", &format!("t [h],yield [kg]\n{}", (0..60).map(row).collect::<String>()));
    let ran = place.run("solve reactor.pde --data run.csv");
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stdout.contains("loop") && ran.stdout.contains("yield"), "{}", ran.stdout);
}

/// A number that is put into seconds and back is shown as it was written.
#[test]
fn what_is_assumed_is_shown_as_it_was_declared() {
    let place = Place::new();
    place.put(
        "decay.pde",
        "coordinates: t [h]; fields: u [kg]; parameters: b [1/h] = 0.03;
         on body { falls: d(u, t) == -b * u; } on samples { observe u; }",
    );
    let row = |i: u32| format!("{i},{}\n", (-0.03 * f64::from(i)).exp());
    place.put("run.csv", &format!("t [h],u [kg]\n{}", (0..30).map(row).collect::<String>()));
    let ran = place.run("solve decay.pde --data run.csv");
    assert!(ran.stdout.contains("b = 0.03 1/h"), "{}{}", ran.stdout, ran.stderr);
}

/// What a file is called is not what a name in Rust may be.
#[test]
fn a_text_may_have_any_name() {
    let place = Place::new();
    for (file, name) in [("box.pde", "box_"), ("loop-2.pde", "loop_2"), ("2.pde", "equation_2"), ("wärme.pde", "w_rme")]
    {
        place.put(file, "coordinates: t; fields: u; on start { is: u == 1; } on body { falls: d(u, t) == -u; }");
        let ran = place.run(&format!("check {file}"));
        assert!(ran.code == Some(0) && ran.stdout.starts_with(name), "{}{}", ran.stdout, ran.stderr);
    }
}

#[test]
fn mistakes_have_their_place() {
    let place = Place::new();
    place
        .put("spring.pde", "coordinates: t [s];\nfields: y [m];\nsources: f [N];\non motion { a: d(y, t, 2) == f; }\n");
    let ran = place.run("solve spring.pde");
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""));
    for part in ["spring.pde:4:", "units differ", "4| on motion { a: d(y, t, 2) == f; }", "^"] {
        assert!(ran.stderr.contains(part), "{}", ran.stderr);
    }
    assert!(place.run("explain nowhere.pde").stderr.contains("nowhere.pde"));
}

const DISC: &str = "
    /// A membrane under even load, held along a circle.
    coordinates: x [m], y [m];
    fields: u [mm];
    parameters: k [mm/m^2] = 4;
    domains: disc = disc(0.5, 0, 200 [cm]);
    on inside in disc { balance: -laplacian(u) == k; }
    on edge boundary of disc { held: u == 0; }
";

#[test]
fn a_domain_says_where_groups_lie() {
    let place = Place::new();
    place.put("disc.pde", DISC);
    place.put("at.csv", "x_m,y_m\n0.5,0\n1.5,0\n0.5,-1.2\n");
    assert!(place.run("check disc.pde").stdout.contains("disc, scene all: A membrane under even load"));
    let ran = place.run("solve disc.pde --at at.csv --budget 60");
    assert_eq!(ran.code, Some(0), "{}{}", ran.stdout, ran.stderr);
    // k (r^2 - |x - c|^2) / 4
    let exact = [4.0, 3.0, 4.0 - 1.44];
    for (row, exact) in place.rows("nisp-out/state.csv").iter().zip(exact) {
        assert!((row[2] - exact).abs() < 1e-4, "{row:?}");
    }
    let ran = place.run("solve disc.pde --grid 9x5 --iterations 2 --out grid");
    let grid = place.rows("grid/state.csv");
    assert!(ran.code == Some(3) && grid.iter().all(|row| (row[0] - 0.5).hypot(row[1]) <= 2.0), "{}", ran.stderr);
    // Points of the grid that lie in the disc.
    let inside = (0..45).filter(|i| (f64::from(i % 9) * 0.5 - 2.0).hypot(f64::from(i / 9) - 2.0) <= 2.0);
    assert_eq!(grid.len(), inside.count());
}

/// `u = sin(pi x) sin(pi y)` is zero on all edges of an L. Values of the splines in its notch are not part of the answer.
#[test]
fn an_answer_over_an_l_is_not_judged_in_the_notch() {
    let place = Place::new();
    let text = "coordinates: x [m], y [m]; fields: u [mm]; sources: q [mm/m^2];
        domains: shape = polygon([0,0],[2,0],[2,1],[1,1],[1,2],[0,2]);
        on inside in shape { balance: -laplacian(u) == q; }
        on rim boundary of shape { held: u == 0; }
        on probes { observe u; }";
    place.put("l.pde", text);
    let [bend, load] = [1.0, 2.0 * PI * PI].map(|size| move |x: f64, y: f64| size * (PI * x).sin() * (PI * y).sin());
    // Multiples of irrational numbers scatter evenly (Roberts 2018); an error of a hundredth, by sines of large numbers.
    let places = (1..).map(f64::from).map(|i| [0.754_877_666_2, 0.569_840_290_9].map(|step| 2.0 * (i * step).fract()));
    let inside: Vec<[f64; 2]> = places.filter(|[x, y]| *x < 1.0 || *y < 1.0).take(500).collect();
    let row = |(i, [x, y]): (usize, &[f64; 2])| {
        let off = 0.014 * (1e4 * (1.0 + i as f64).sqrt()).sin();
        format!("{x},{y},{},{}\n", bend(*x, *y) + off, load(*x, *y))
    };
    let rows: String = inside.iter().enumerate().map(row).collect();
    place.put("u.csv", &format!("x,y,u,q\n{rows}"));
    let ran = place.run("solve l.pde --data u.csv --truth u.csv --at u.csv --json");
    let object = object(&ran);
    assert_eq!(object["status"], "converged", "{}", object["verdict"]);
    let [error, size] = ["q", "q_if_zero"].map(|name| object["errors"][name].as_f64().unwrap());
    assert!(error < 0.1 * size, "{error} of {size}");
}

#[test]
fn what_is_missing_is_named() {
    let place = Place::new();
    let text = "units: off; coordinates: x, y; fields: u; sources: f;
        on inside { balance: laplacian(u) == f; } on probes { observe u; } on edge { held: u == 0; }";
    place.put("plate.pde", text);
    place.put("u.csv", "x,y,u\n0,0,1\n1,0,2\n0,1,3\n");
    let refused = |line: &str, parts: &[&str]| {
        let ran = place.run(&format!("solve plate.pde {line}"));
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{line}");
        assert!(parts.iter().all(|part| ran.stderr.contains(part)), "{line}: {}", ran.stderr);
    };
    refused("--data inside=u.csv --data edge=u.csv", &["`probes` wants measurements of u", "--data probes=FILE"]);
    refused("--data u.csv", &["nothing says where `inside` lies", "on inside in DOMAIN", "--data inside=FILE"]);
    refused("--data prob=u.csv", &["no group `prob`, did you mean `probes`?"]);
    refused("--data u.csv --data inside=u.csv --data edge=u.csv --grid 5", &["--grid has 1 numbers", "x, y"]);
    refused("--data u.csv --unit mm", &["takes no --unit"]);
    // Options that an equation has no use for are refused, and a file without the extension stands for nothing.
    let ran = place.run("solve rlc --grid 30");
    assert!(ran.code == Some(2) && ran.stderr.contains("`rlc` takes no --grid"), "{}", ran.stderr);
    place.put("rlc", "no equation");
    assert_eq!(place.run("explain rlc").code, Some(0));
    fs::remove_file(place.path("rlc")).unwrap();
    assert_eq!(place.names(), ["plate.pde", "u.csv"]);
    let ran = place.run("solve plate.pde --data u.csv --data inside=u.csv --data edge=u.csv --grid 3x3 --iterations 2");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    assert_eq!(place.rows("nisp-out/source.csv").len(), 9);
}

/// Over three coordinates the answer is drawn in planes.
#[test]
fn a_slab_is_drawn_in_planes() {
    let place = Place::new();
    let text = "coordinates: x [m], y [m], t: time [s]; fields: u [K]; parameters: k [m^2/s] = 1;
        domains: slab = box(0 .. 1, 0 .. 1) times 0 .. 5;
        on inside in slab { balance: d(u, t) == k * laplacian(u); }
        on edge boundary of slab { held: u == 0; }
        on cold start of slab { rest: u == 1 [K]; }";
    place.put("slab.pde", text);
    let ran = place.run("solve slab.pde --iterations 2 --width 6 --grid 3x3x2");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    assert_eq!(place.rows("nisp-out/state.csv").len(), 18);
    let plot = fs::read_to_string(place.path("nisp-out/plot.svg")).unwrap();
    assert!(["t = 0 s", "t = 2.5 s", "t = 5 s"].iter().all(|title| plot.contains(title)));
}

/// One reading of a decay from a known beginning tells its rate; nothing says where the equation holds without a domain.
#[test]
fn one_reading_tells_one_number() {
    let place = Place::new();
    let text = "units: off; coordinates: t; fields: u; parameters: k in 0.01 .. 100 = 1; domains: span = 0 .. 2;
        on inside in span { balance: d(u, t) + k * u == 0; }
        on first start of span { begun: u == 2; }
        on samples { observe u; }
        scene identify { learn k; }";
    place.put("decay.pde", text);
    place.put("reading.csv", "t,u\n0.5,1.3\n");
    let ran = place.run("solve decay.pde --data reading.csv --json");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let rate = object(&ran)["learned"][0]["value"].as_f64().unwrap();
    let exact = (2.0f64 / 1.3).ln() / 0.5;
    assert!((rate - exact).abs() < 1e-3 * exact, "{rate} is not {exact}");
    place.put(
        "open.pde",
        &text.replace(" in span", "").replace("domains: span = 0 .. 2;", "").replace(" start of span", ""),
    );
    let ran = place.run("solve open.pde --data reading.csv");
    assert!(ran.code == Some(2) && ran.stderr.contains("nothing says where `inside` lies"), "{}", ran.stderr);
}

#[test]
fn rivals_that_do_not_know_an_equation_say_so() {
    let place = Place::new();
    place.run("new cup");
    let line = "solve cup/cup.pde --data cup/data.csv --truth cup/truth.csv --rivals";
    let ran = place.run(line);
    assert!(
        ran.stdout.contains("no classical method: they are written by hand for `pendulum`, `rlc`"),
        "{}",
        ran.stdout
    );
    let rivals = &object(&place.run(&format!("{line} --json")))["rivals"];
    assert!(rivals["none"].as_str().unwrap().contains("read no other equation"), "{rivals}");
    assert_eq!(rivals["errors"].as_array().unwrap().len(), 0);
    // An equation that they know has errors of all three, unless there is nothing to score them by or a value is missing.
    let asked =
        |line: &str| object(&place.run(&format!("solve rlc --iterations 3 --rivals --json {line}")))["rivals"].clone();
    let known = asked("");
    let methods: Vec<&str> =
        known["errors"].as_array().unwrap().iter().map(|error| error["method"].as_str().unwrap()).collect();
    assert_eq!(
        (methods, &known["none"]),
        (vec!["collocation", "smoothing spline", "Savitzky-Golay (oracle)"], &Value::Null)
    );
    place.put("volts.csv", &circuit_table());
    assert!(asked("--data volts.csv")["none"].as_str().unwrap().contains("give it with --truth FILE"));
    let table = circuit_table();
    let (kept, last) = table.trim_end().rsplit_once(',').unwrap();
    assert!(!last.is_empty());
    place.put("gap.csv", &format!("{kept},\n"));
    place.put("truth.csv", "t_s,f_V\n0,6\n1,0.298722\n2,0.0148725\n");
    assert!(asked("--data gap.csv --truth truth.csv")["none"].as_str().unwrap().contains("they know no gaps"));
}

/// What the command says of a small text, after a change of it and with a line of options.
fn said(from: &str, to: &str, options: &str) -> String {
    let place = Place::new();
    let text = "coordinates: t [s];\nfields: T [K];\nsources: P [W];\nparameters: C [J/K] = 2;\n\
                on body { balance: C * d(T, t) == P; }\non samples { observe T; }\n";
    assert!(text.contains(from));
    place.put("room.pde", &text.replace(from, to));
    place.put("room.txt", text);
    let rows =
        |first: i32| (first..first + 40).map(|i| format!("{i},{}\n", 290.0 + f64::from(i).sin())).collect::<String>();
    place.put("one.csv", &format!("t,T\n{},\n,\n", rows(0)));
    place.put("two.csv", &format!("t,T\n{}", rows(40)));
    place.put("list.toml", "data = [\"one.csv\"]\n");
    let ran = place.run(&format!("solve {options} --out out"));
    ran.stdout + &ran.stderr
}

#[test]
fn usual_slips_have_messages_of_their_own() {
    for (from, to, options, part) in [
        ("d(T, t)", "dT/dt", "room.pde --data one.csv", "a derivative is written `d(T, t)`"),
        ("d(T, t)", "T'", "room.pde --data one.csv", "a derivative is written `d(u, t)`"),
        ("C * d", "C × d", "room.pde --data one.csv", "a product is written with `*`"),
        ("observe T", "observe T - 2 [K] ~ T2", "room.pde --data one.csv", "an observed expression needs a name"),
        ("T [K]", "T [°C]", "room.pde --data one.csv", "temperatures are in `K`"),
        ("t", "t", "room.txt --data one.csv", "ends in .pde"),
        ("t", "t", "room.pde --config list.toml", "or a table [data] of GROUP = FILE pairs"),
        ("t", "t", "room.pde --data one.csv --data two.csv", "--data is given twice: one.csv and two.csv"),
        ("t", "t", "room.pde --data samples=one.csv --data samples=two.csv", "given twice for group `samples`"),
        // Two rows of nothing but commas stand below the first table.
        ("t", "t", "room.pde --data one.csv --iterations 2", "stopped by --iterations after"),
    ] {
        let found = said(from, to, options);
        assert!(found.contains(part), "`{part}` is not in: {found}");
    }
}
