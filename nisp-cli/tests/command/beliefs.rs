//! What is believed of learned parameters, in texts.

use serde_json::Value;

use crate::common::Place;

const DECAY: &str = "coordinates: t [h];
fields: c [mg/l];
parameters: r [1/h] in 0.1 .. 100 = 3 within 1, c0 [mg/l] in 0.1 .. 100 = 9 within 2;
on decay { balance: d(c, t) == -r * c; }
on start { known: c == c0; }
on samples { observe c; }
scene rates { learn r, c0; }
";

/// A dose of 10 mg/l that decays by 2.5 per hour: closed form, with errors of a known pattern below 0.1 mg/l.
#[test]
fn beliefs_come_without_a_table_and_must_not_be_contradicted() {
    let place = Place::new();
    place.put("decay.pde", DECAY);
    let row = |i: i32| (f64::from(i) / 40.0, 0.1 * (7.3 * f64::from(i * i)).sin());
    let rows: String = (0..=40).map(row).map(|(t, off)| format!("{t},{}\n", 10.0 * (-2.5 * t).exp() + off)).collect();
    place.put("samples.csv", &format!("t [h],c [mg/l]\n{rows}"));
    let solve = |options: &str| {
        let ran = place.run(&format!("solve decay.pde --data samples.csv --json --out out {options}"));
        let report: Value = serde_json::from_str(&ran.stdout).unwrap();
        (ran.code.unwrap(), report)
    };
    let (code, report) = solve("");
    assert_eq!((code, &report["status"]), (0, &Value::from("converged")), "{}", report["verdict"]);
    for (at, (name, exact)) in [("r", 2.5), ("c0", 10.0)].into_iter().enumerate() {
        let learned = &report["learned"][at];
        assert_eq!(learned["name"], name);
        let off = learned["value"].as_f64().unwrap() - exact;
        assert!(off.abs() < 3.0 * learned["deviation"].as_f64().unwrap(), "{learned}");
    }
    // A belief far from what the data say.
    let (code, report) = solve("--set r=60");
    let failed = report["verdict"].as_array().unwrap().iter().filter(|check| check["passed"] == false);
    let failed: Vec<&Value> = failed.collect();
    assert_eq!((code, failed.len(), &failed[0]["check"], &failed[0]["term"]), (3, 1, &"belief".into(), &"r".into()));
    // A belief is no column.
    let ran = place.run("solve decay.pde --data samples.csv --column r=c");
    assert!(ran.code == Some(2) && ran.stderr.contains("`r`"), "{}", ran.stderr);
}
