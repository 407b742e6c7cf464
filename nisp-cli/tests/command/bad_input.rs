//! Whatever is wrong with the input: a line for each fault that says what to do, exit code 2, no files, no panic.

use std::fs;

use crate::common::{Place, circuit, circuit_table};

/// Runs `solve rlc --data data.csv` and more on a table, and returns what is said: a line for each of two columns at most.
fn refusal(table: &str, more: &str) -> String {
    let place = Place::new();
    place.put("data.csv", table);
    let ran = place.run(&format!("solve rlc --data data.csv --budget 1 --out out {more}"));
    assert_eq!(ran.code, Some(2), "{table:.60} {more}: {}{}", ran.stdout, ran.stderr);
    assert_eq!(ran.stdout, "");
    assert!(ran.stderr.lines().count() <= 2, "{}", ran.stderr);
    assert!(ran.stderr.starts_with("nisp: ") && !ran.stderr.contains("panicked"), "{}", ran.stderr);
    assert_eq!(place.names(), ["data.csv"]);
    ran.stderr
}

#[track_caller]
fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

fn with_cell(row: usize, cell: &str) -> String {
    "t_s,v_V\n".to_string()
        + &circuit(60, |r, t, v| if r == row { format!("{t},{cell}\n") } else { format!("{t},{v}\n") })
}

/// A machine reads standard output alone.
#[test]
fn an_object_says_what_was_wrong() {
    let place = Place::new();
    for (line, part) in [
        ("solve rlc --data none.csv --json", "none.csv"),
        ("solve rlc --budgt 3 --json", "--budgt"),
        ("eval none.nisp --grid 5 --json", "none.nisp"),
    ] {
        let ran = place.run(line);
        assert_eq!(ran.code, Some(2), "{line}");
        let object: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
        assert_eq!(object["status"], "error");
        assert!(object["error"].as_str().unwrap().contains(part) && ran.stderr.contains(part), "{line}: {object}");
    }
}

#[test]
fn columns() {
    says(&refusal("t_s,volt\n0,1\n1,2\n", ""), &["no column for `v` in V", "--column v=volt", "columns: t_s, volt"]);
    says(&refusal(&circuit_table(), "--column v=v_mV"), &["`v_mV`", "the nearest is `v_V`: --column v=v_V"]);
    says(&refusal(&circuit_table(), "--column w=v_V"), &["observes no `w`", "it observes: v, t"]);
    says(&refusal(&circuit_table(), "--column v"), &["NAME=HEADER"]);
    says(&refusal("time,v\n0,1\n1,2\n", ""), &["no column for `t` in s", "--column t=time"]);
    says(&refusal("t,v_V,v [V]\n0,1,2\n1,2,3\n", ""), &["several columns answer to `v`", "--column"]);
    says(&refusal("t v\n0 1\n1 2\n", ""), &["one column, `t v`", "commas, semicolons or tabs"]);
}

#[test]
fn cells() {
    // Of measured cells these say that nothing was measured; a time must be there.
    let untimed = |text: &str| {
        let row = |r, t, v| if r == 4 { format!("{text},{v}\n") } else { format!("{t},{v}\n") };
        "t_s,v_V\n".to_string() + &circuit(20, row)
    };
    says(&refusal(&untimed("NaN"), ""), &["line 6, column `t_s`", "`NaN` is not a finite number"]);
    says(&refusal(&untimed(""), ""), &["line 6", "the cell is empty"]);
    says(&refusal(&with_cell(0, "x7"), ""), &["line 2, column `v_V`", "`x7` is not a number"]);
    says(&refusal(&with_cell(9, "inf"), ""), &["line 11", "not a finite number"]);
    says(&refusal(&with_cell(9, "1e999"), ""), &["line 11", "not a finite number"]);
    says(&refusal(&with_cell(9, "1,2"), ""), &["line 11: 3 cells where the header has 2"]);
    says(&refusal(&with_cell(9, "-1e70"), ""), &["`v` goes up to 1e70 V", "check its column and its unit"]);
    says(&refusal("t,v\n0,\"1,5\"\n1,\"2,5\"\n", ""), &["decimal comma"]);
}

#[test]
fn rows() {
    says(&refusal("", ""), &["the file is empty"]);
    says(&refusal("t_s,v_V\n", ""), &["0 row(s)", "at least 2"]);
    says(&refusal("t_s,v_V\n0,1\n", ""), &["1 row(s)", "at least 2"]);
    says(&refusal("0,1\n1,2\n", ""), &["a line of column names above"]);
    says(&refusal("t_s,v_V\n0,1\n2,1\n1,1\n", ""), &["line 4, column `t_s`: 1 comes after 2; sort the rows"]);
    says(&refusal("t_s,v_V\n0,1\n1,1\n1,1\n", ""), &["line 4, column `t_s`: the value 1 is there twice"]);
}

#[test]
fn names() {
    let place = Place::new();
    let refused = |line: &str, parts: &[&str]| {
        let ran = place.run(line);
        assert_eq!(
            (ran.code, ran.stdout.as_str(), ran.stderr.lines().count()),
            (Some(2), "", 1),
            "{line}: {}",
            ran.stderr
        );
        says(&ran.stderr, parts);
        assert!(place.names().is_empty());
    };
    refused("solve pendullum", &["did you mean `pendulum`?", "nisp list"]);
    refused("explain zzz", &["there is no `zzz`", "pendulum, rlc"]);
    refused("solve rlc --scene fre", &["did you mean `free`?", "recover, free"]);
    refused("solve rlc --data nowhere.csv", &["nowhere.csv: no such file"]);
    refused("solve rlc --data .", &["is a folder"]);
    refused("solve rlc --truth nowhere.csv", &["nowhere.csv: no such file"]);
    refused("solve rlc --config nowhere.toml", &["nowhere.toml"]);
    refused("solve rlc --set f1=3", &["no parameter `f1`", "f0"]);
    refused("solve pendulum --set m0=-1", &["`m0` is -1 kg", "must be above 0 kg"]);
    refused("solve plate --set E=-1e9", &["`E` is -1000000000 Pa", "must be above 0 Pa"]);
    refused("solve plate --set nu=1.5", &["`nu` is 1.5", "must be at least -1 and at most 0.5"]);
    refused("solve plate --set t=0", &["`t` is 0 mm", "must be above 0 mm"]);
    refused("solve rlc --sede 3", &["'--sede'", "'--seed'"]);
    refused("solve", &["<SCENE>"]);
    refused("slove rlc", &["'slove'", "'solve'"]);
}

#[test]
fn values() {
    let table = circuit_table();
    for (option, parts) in [
        ("--set f0=5V", &["finite number", "declared unit"][..]),
        ("--set f0", &["NAME=VALUE"]),
        ("--set f0=nan", &["finite number"]),
        ("--width 0", &["--width", "from 1 to"]),
        ("--width 100000", &["from 1 to 4096"]),
        ("--width 400 --optimizer broyden", &["too costly", "smaller width", "lbfgs"]),
        ("--width 4096 --layers 4096", &["4096 layers of 4096 units cannot be built"]),
        ("--layers 0", &["--layers", "from 1 to"]),
        ("--threads 0", &["--threads", "from 1 to"]),
        ("--threads 5000", &["at most 1024"]),
        ("--optimizer lm --carrier splines", &["--carrier splines takes no --optimizer"]),
        ("--iterations 0", &["--iterations", "from 1 to"]),
        ("--budget -3", &["--budget", "positive number of seconds"]),
        ("--budget 0", &["positive number of seconds"]),
        ("--budget nan", &["positive number of seconds"]),
        ("--budget 1e300", &["positive number of seconds"]),
        ("--budget 10s", &["positive number of seconds"]),
        ("--seed -1", &["--seed"]),
        ("--seed x", &["--seed"]),
        ("--precision f16", &["f32, f64"]),
        ("--optimizer adma", &["adam"]),
        ("--precision f32 --optimizer broyden", &["works in f64 only", "--precision f64"]),
    ] {
        says(&refusal(&table, option), parts);
    }
}

#[test]
fn truths() {
    let place = Place::new();
    let refused = |truth: &str, parts: &[&str]| {
        place.put("truth.csv", truth);
        let ran = place.run("solve rlc --truth truth.csv --budget 1 --out out");
        assert_eq!((ran.code, ran.stderr.lines().count()), (Some(2), 1), "{}", ran.stderr);
        says(&ran.stderr, parts);
        assert_eq!(place.names(), ["truth.csv"]);
    };
    refused("t,f\n5,1\n6,1\n", &["the truth's times, 5 to 6 s, are all outside those of the data, 0 to 2 s"]);
    refused("t,f\n0,1\n1,x\n", &["line 3, column `f`"]);
    refused("t,g\n0,1\n1,1\n", &["no column answers to any of v, f"]);
    refused("t,f\n1,1\n0,1\n", &["sort the rows"]);
}

#[test]
fn folders() {
    let place = Place::new();
    place.put("taken", "a file");
    for out in ["taken", "taken/inside", "/proc/nisp"] {
        let ran = place.run(&format!("solve rlc --budget 1 --out {out}"));
        assert_eq!((ran.code, ran.stderr.lines().count()), (Some(2), 1), "{out}: {}", ran.stderr);
        says(&ran.stderr, &["cannot be written"]);
        assert_eq!(place.names(), ["taken"]);
    }
    assert_eq!(fs::read_to_string(place.path("taken")).unwrap(), "a file");
}

/// Extreme and degenerate numbers may have no good answer, but they have an answer.
#[test]
fn strange_numbers_end_in_words() {
    let place = Place::new();
    let tables = [
        "t,v\n0,1\n1,2\n".to_string(),
        "t,v\n".to_string() + &circuit(30, |_, t, _| format!("{t},0\n")),
        "t,v\n".to_string() + &circuit(30, |_, t, _| format!("{t},7\n")),
        "t,v\n".to_string() + &circuit(30, |_, t, v| format!("{t},{}\n", 1e300 * v)),
        "t,v\n".to_string() + &circuit(30, |_, t, v| format!("{t},{}\n", 1e-300 * v)),
        "t,v\n".to_string() + &circuit(30, |_, t, v| format!("{},{v}\n", 1e200 * t)),
        "t,v\n".to_string() + &circuit(30, |_, t, v| format!("{},{v}\n", 1e9 + t)),
        "t,v\n".to_string() + &circuit(30, |_, t, v| format!("{},{v}\n", 1e3 * t)),
    ];
    for table in tables {
        place.put("data.csv", &table);
        let ran = place.run("solve rlc --data data.csv --budget 0.3 --out out");
        assert!(matches!(ran.code, Some(0 | 2 | 3)), "{table:.40}: {:?} {}", ran.code, ran.stderr);
        assert!(ran.stderr.lines().count() <= 1, "{table:.40}: {}", ran.stderr);
        assert!(!(ran.stdout.to_string() + &ran.stderr).contains("panicked"), "{table:.40}: {}", ran.stderr);
    }
}
