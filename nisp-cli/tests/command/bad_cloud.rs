//! Clouds and samples that cannot be right: one line that says what to do, exit code 2, nothing written.

use std::fs;
use std::path::Path;

use crate::common::Place;

/// A hemisphere-like cloud of an ellipse of 60 by 40 mm, in metres times `scale`, moved along x.
fn bubble(scale: f64, along: f64) -> String {
    let point = |i: i32| {
        let (radius, angle) = ((f64::from(i) / 600.0).sqrt(), 2.4 * f64::from(i));
        let [x, y, z] = [0.06 * radius * angle.cos(), 0.04 * radius * angle.sin(), 0.03 * (1.0 - radius * radius)];
        format!("{},{},{}\n", scale * (x + along), scale * y, scale * z)
    };
    (0..600).map(point).collect()
}

fn sample() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/membrane/inflated_1.toml");
    fs::read_to_string(path).unwrap()
}

/// Puts files, runs, and expects all of `parts` in the one line.
#[track_caller]
fn refused(files: &[(&str, &str)], line: &str, parts: &[&str]) {
    let place = Place::new();
    files.iter().for_each(|(name, content)| place.put(name, content));
    let before = place.names();
    let ran = place.run(&format!("solve {line} --budget 1 --out out"));
    assert_eq!((ran.code, ran.stdout.as_str()), (Some(2), ""), "{line}: {}", ran.stderr);
    assert_eq!(ran.stderr.lines().count(), 1, "{}", ran.stderr);
    for part in parts {
        assert!(ran.stderr.contains(part), "`{part}` is not in: {}", ran.stderr);
    }
    assert_eq!(place.names(), before);
}

#[test]
fn clouds() {
    let cloud = |content: &str, more: &str, parts: &[&str]| {
        refused(&[("c.csv", content)], &format!("membrane --data c.csv --set p=5670 {more}"), parts);
    };
    cloud("", "", &["c.csv: the file is empty"]);
    cloud("x,y,z\n", "", &["c.csv"]);
    cloud("nan,nan,nan\nnan,0,1\n", "", &["none of the 2 points is finite"]);
    cloud("x,y,depth\n1,2,3\n4,5,6\n", "", &["no column for `z`", "columns: x, y, depth"]);
    cloud("1 2\n3 4\n", "", &["no number for z; each row needs `x`, `y` and `z`"]);
    cloud(&bubble(1e3, 0.0), "", &["is the cloud in millimetres? give --unit mm"]);
    cloud(&bubble(1e2, 0.0), "", &["give --unit cm"]);
    cloud(&bubble(1.0, 0.0), "--unit mm", &["the cloud spans", "another object"]);
    cloud(&bubble(1.0, 0.0), "--unit furlong", &["--unit", "write m, cm, mm, um or in"]);
    cloud(&bubble(1.0, 0.5), "", &["is it in another frame?"]);
    // Near, but beside the membrane.
    cloud(&bubble(1.0, 0.08), "", &["% of the points lie where the membrane can be", "another object"]);
    cloud(&bubble(5.0, 0.0), "", &["another object"]);
    let few = |count: usize| bubble(1.0, 0.0).lines().take(count).map(|line| format!("{line}\n")).collect::<String>();
    cloud(&few(49), "", &["c.csv: 49 points do not show a membrane; record 50 at least"]);
    cloud(&few(1), "", &["1 points do not show a membrane"]);
    // A sponge hangs below its origin.
    let sponge = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/sponge/edge_1_cloud_0.ply");
    let line = format!("membrane --data {} --set p=5670", sponge.display());
    refused(&[], &line, &["where the membrane can be", "another object"]);
    refused(
        &[("c.csv", &bubble(1.0, 0.0))],
        "sponge --data c.csv --set force_z=3",
        &["parameter `force_x` has no value"],
    );
    let wrench = "--set force_x=0 --set force_y=0 --set force_z=3 --set torque_x=0 --set torque_y=0 --set torque_z=0";
    let parts = &["where the sponge can be", "another object"];
    let line = format!("sponge --data c.csv {wrench}");
    refused(&[("c.csv", &bubble(1.0, 0.0))], &line, parts);
    refused(&[("c.csv", &few(49))], &line, &["49 points do not show a sponge; record 50 at least"]);
}

#[test]
fn parameters() {
    let cloud = |line: &str, parts: &[&str]| {
        refused(&[("c.csv", &bubble(1.0, 0.0))], &format!("membrane --data c.csv {line}"), parts);
    };
    cloud("", &["parameter `p` has no value; give it with --set p=VALUE in Pa", "--sample"]);
    // Nor is there where to begin, if it is learned.
    cloud("--scene identify_unknown_pressure", &["parameter `p` has no value; give it with --set p=VALUE in Pa"]);
    cloud("--set p=0", &["`p` is 0 Pa", "nothing inflates", "--set p=VALUE"]);
    cloud("--set p=-5670", &["`p` is -5670 Pa"]);
    cloud("--set p=5670 --set t=0", &["`t` is 0 mm", "must be above 0 mm"]);
    cloud("--set p=5670 --set nu=0.7", &["`nu` is 0.7", "at least 0 and at most 0.5"]);
    cloud("--set p=5670 --set a=-1", &["`a` is -1 m"]);
    cloud("--set p=5670 --set q=1", &["there is no parameter `q`; the scene has: E, nu, t, p, a, b"]);
    refused(&[], "sponge --set nu=0", &["`nu` is 0"]);
    refused(&[], "sponge --set force_z=0", &["`force_z` is 0 N", "terrain presses up"]);
    refused(&[], "sponge --set force_z=-3", &["`force_z` is -3 N", "terrain on the sponge"]);
}

#[test]
fn samples() {
    let clouds = "[observation]\nclouds = [\"c.csv\"]\n";
    let run = |sample: &str, more: &str, parts: &[&str]| {
        refused(
            &[("s.toml", sample), ("c.csv", &bubble(1.0, 0.0))],
            &format!("membrane --sample s.toml {more}"),
            parts,
        );
    };
    run(&sample(), "--cloud 5", &["--cloud 5", "s.toml has 0 to 4"]);
    run(&sample(), "--cloud -1", &["--cloud"]);
    run(&sample(), "--cloud 0", &["inflated_1_cloud_0.ply: no such file"]);
    run(&sample(), "--cloud 0 --data c.csv", &["--cloud 0", "--data names a cloud already"]);
    run("[observation]\nclouds = []\n[membrane]\n", "", &["s.toml names none"]);
    run("[membrane]\na_m = 0.06\n", "", &["s.toml", "missing field `observation`"]);
    run(clouds, "", &["s.toml", "missing field `membrane`"]);
    let thin = sample().replace("gauge_pressure_Pa = 5670\n", "");
    run(&thin, "--data c.csv", &["s.toml: no `[membrane] gauge_pressure_Pa`", "--set p=VALUE in Pa"]);
    run(&sample().replace("= 5670", "= \"high\""), "--data c.csv", &["s.toml: line 11", "string"]);
    run(&sample().replace("= 5670", "= 0"), "--data c.csv", &["`p` is 0 Pa"]);
    run("a = [", "", &["s.toml: line 1"]);
    refused(&[], "membrane --sample nowhere.toml", &["nowhere.toml"]);
    refused(&[], "membrane --cloud 1", &["name the sample with --sample"]);
    refused(&[], "sponge --scene known_terrain", &["needs the terrain", "--scene unknown_terrain"]);
    refused(&[], "rlc --cloud 1", &["`rlc` takes no --cloud", "--data"]);
    refused(&[], "plate --unit mm", &["`plate` takes no --unit"]);
}

#[test]
fn truths() {
    let head = "x_m,y_m,u_m,v_m,w_m";
    let rows = |row: &str| {
        (0..4).map(|i| format!("{},{},{row}\n", 0.01 * f64::from(i % 2), 0.01 * f64::from(i / 2))).collect::<String>()
    };
    let run = |truth: &str, parts: &[&str]| refused(&[("t.csv", truth)], "membrane --truth t.csv", parts);
    run(&format!("{head}\n{}", rows("0,0,0")), &["t.csv: no column for `f` in Pa"]);
    run(&format!("{head},f_Pa\n{}", rows("0,0,0,0")), &["t.csv: no column for `contact`"]);
    run(&format!("x_m,y_m,w_m,f_Pa,contact\n{}", rows("0,0,0")), &["t.csv: no column for `u` in mm"]);
    run(&format!("z_m,y_m,w_m\n{}", rows("0")), &["t.csv: no column for `x` in m"]);
    run(&format!("{head},f_Pa,contact\n{}", rows("0,0,0,nan,0")), &["line 2, column `f_Pa`"]);
    let elsewhere = "x,y,u_m,v_m,w_m,f_Pa,contact\n0,0,0,0,0,0,0\n50,10,0,0,0,0,0\n";
    run(elsewhere, &["t.csv: `alpha` runs from 0 to 50 m, the body from -0.0600 to 0.0600", "another unit"]);
    refused(&[], "membrane --truth nowhere.csv", &["nowhere.csv: no such file"]);
}
