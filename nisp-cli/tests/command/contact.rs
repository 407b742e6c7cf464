//! Membrane and sponge from point clouds: what is read, what is written, what is measured.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{Place, names};
use serde_json::Value;

/// A file of the repository's data.
fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data").join(name)
}

fn object(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

const FILES: [&str; 7] =
    ["answer.nisp", "plot.svg", "source.csv", "state.csv", "surface.ply", "surface.svg", "surface.vtu"];

#[test]
fn a_contact_is_scored_beside_a_classical_way_and_its_surface_is_written() {
    let place = Place::new();
    let ran = place.run("solve membrane --carrier network --iterations 3 --width 6 --rivals --out out");
    assert_eq!(ran.code, Some(3), "{}", ran.stderr);
    for row in ["y_shape_1_cloud_1.ply", "net force", "overlap of the patch (IoU)", "spline of the cloud"] {
        assert!(ran.stdout.contains(row), "no `{row}` in: {}", ran.stdout);
    }
    assert_eq!(names(&place.path("out")), FILES);
    let vtu = fs::read_to_string(place.path("out/surface.vtu")).unwrap();
    for array in ["u [mm]", "v [mm]", "w [mm]", "f [Pa]"] {
        assert!(vtu.contains(&format!("Name=\"{array}\"")), "{array}");
    }
    let source = fs::read_to_string(place.path("out/source.csv")).unwrap();
    // A millimetre grid over an ellipse of 7540 square millimetres.
    assert!((7400..7600).contains(&source.lines().count()), "{}", source.lines().count());
}

#[test]
fn the_object_has_the_promised_errors() {
    let place = Place::new();
    let errors = |line: &str| {
        let ran = place.run(&format!("solve {line} --carrier network --iterations 2 --width 4 --json"));
        assert!(matches!(ran.code, Some(0 | 3)), "{}", ran.stderr);
        object(&ran.stdout)["errors"].clone()
    };
    let keys = |errors: &Value| errors.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    let contact = ["force_N", "force_error_N", "iou", "patch_chamfer_mm2"];
    let membrane = errors("membrane");
    for key in contact.iter().chain(&["f", "f_if_zero", "u", "v", "w"]) {
        assert!(keys(&membrane).contains(&key.to_string()), "no {key} in {membrane}");
    }
    let sponge = errors("sponge");
    for key in contact.iter().chain(&["f", "u_x", "u_z"]) {
        assert!(keys(&sponge).contains(&key.to_string()), "no {key} in {sponge}");
    }
    let modulus = errors("membrane --scene identify");
    assert_eq!(keys(&modulus), ["E", "E_sd", "u", "v", "w"]);
    assert!(modulus["E"].as_f64().unwrap() > 1e4);
}

/// The truth is in the sample's file and beside it; none of it may matter.
#[test]
fn the_truth_in_a_sample_is_not_read() {
    let place = Place::new();
    for (scene, name, truths) in [
        ("membrane", "membrane/cylinder_1", &["tool", "contact", "state", "solver"][..]),
        ("sponge", "sponge/edge_1", &["terrain", "contact", "solver"]),
    ] {
        let text = fs::read_to_string(data(&format!("{name}.toml"))).unwrap();
        let cloud = format!("{}_cloud_1.ply", name.split('/').next_back().unwrap());
        fs::copy(data(&format!("{name}_cloud_1.ply")), place.path(&cloud)).unwrap();
        let mut table: toml::Table = text.parse().unwrap();
        place.put("whole.toml", &text);
        for truth in truths {
            assert!(table.remove(*truth).is_some(), "{name} has no [{truth}]");
        }
        if let Some(toml::Value::Table(observation)) = table.get_mut("observation") {
            observation.insert("noise_sigma_m".into(), toml::Value::Array(vec![toml::Value::Float(7.0)]));
        }
        place.put("bare.toml", &table.to_string());
        let answer = |sample: &str| {
            let ran = place.run(&format!(
                "solve {scene} --sample {sample}.toml --cloud 1 --carrier network --iterations 3 --width 4 --threads 1 --json --out {sample}"
            ));
            assert!(matches!(ran.code, Some(0 | 3)), "{}", ran.stderr);
            let files: Vec<_> = FILES.iter().filter(|name| !name.ends_with(".svg")).collect();
            let read = |name: &&&str| fs::read(place.path(sample).join(name)).unwrap();
            (object(&ran.stdout)["loss"].clone(), files.iter().map(read).collect::<Vec<_>>())
        };
        let (whole, bare) = (answer("whole"), answer("bare"));
        assert_eq!(whole.0, bare.0, "{scene}");
        assert!(whole.1 == bare.1, "{scene}");
    }
}

fn copy(place: &Place, names: &[&str]) {
    for name in names {
        fs::copy(data(name), place.path(name.split('/').next_back().unwrap())).unwrap();
    }
}

/// What a short run answers, up to its last digit.
fn source(place: &Place, line: &str) -> String {
    let ran =
        place.run(&format!("solve {line} --carrier network --iterations 2 --width 4 --threads 1 --json --out out"));
    assert!(matches!(ran.code, Some(0 | 3)), "{line}: {}", ran.stderr);
    fs::read_to_string(place.path("out/source.csv")).unwrap()
        + &fs::read_to_string(place.path("out/state.csv")).unwrap()
}

#[test]
fn a_sample_can_be_named_in_several_ways_and_what_is_set_wins() {
    let place = Place::new();
    copy(&place, &["membrane/cylinder_1.toml", "membrane/cylinder_1_cloud_0.ply", "membrane/cylinder_1_cloud_1.ply"]);
    let whole = source(&place, "membrane --sample cylinder_1.toml --cloud 1");
    assert!(whole == source(&place, "membrane --data cylinder_1 --cloud 1"));
    assert!(whole == source(&place, "membrane --data cylinder_1.toml --cloud 1"));
    assert!(whole == source(&place, "membrane --sample cylinder_1.toml --data cylinder_1_cloud_1.ply"));
    fs::create_dir(place.path("study")).unwrap();
    place.put("study/run.toml", "sample = \"../cylinder_1.toml\"\ncloud = 1\n");
    assert!(whole == source(&place, "membrane --config study/run.toml"));
    // The sample's numbers, one by one: a user without its file.
    let toml: toml::Table = fs::read_to_string(place.path("cylinder_1.toml")).unwrap().parse().unwrap();
    let p = &toml["membrane"]["gauge_pressure_Pa"];
    let numbers = |text: &str| text.split([',', '\n']).filter_map(|cell| cell.parse().ok()).collect::<Vec<f64>>();
    let alone = numbers(&source(&place, &format!("membrane --data cylinder_1_cloud_1.ply --set p={p}")));
    // Up to the rounding of a thickness that is given in metres and counted in millimetres.
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-6 * (1.0 + a.abs());
    assert!(numbers(&whole).len() == alone.len() && numbers(&whole).iter().zip(&alone).all(near));
    assert!(whole != source(&place, "membrane --sample cylinder_1.toml --cloud 1 --set p=4000"));
    assert!(whole != source(&place, "membrane --sample cylinder_1.toml --cloud 0"));
    assert!(
        source(&place, "membrane --sample cylinder_1.toml") == source(&place, "membrane --data cylinder_1 --cloud 0")
    );
}

#[test]
fn a_wrist_that_carries_the_weight_says_the_same() {
    let place = Place::new();
    copy(&place, &["sponge/ridge_1.toml", "sponge/ridge_1_cloud_1.ply"]);
    let mut table: toml::Table = fs::read_to_string(place.path("ridge_1.toml")).unwrap().parse().unwrap();
    if let Some(toml::Value::Table(wrench)) = table.get_mut("wrench") {
        wrench.retain(|key, _| key.starts_with("wrist"));
    }
    place.put("wrist.toml", &table.to_string());
    let force = |sample: &str| -> Vec<f64> {
        let text = source(&place, &format!("sponge --sample {sample}.toml --cloud 1"));
        let rows = text.lines().filter_map(|line| line.split(',').nth(3)?.parse().ok());
        rows.collect()
    };
    let (contact, wrist) = (force("ridge_1"), force("wrist"));
    assert!(contact.len() > 2000);
    // The sample's figures have six digits.
    let size = contact.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
    assert!(contact.iter().zip(&wrist).all(|(a, b)| (a - b).abs() < 1e-3 * size));
    assert_ne!(contact, wrist);
}

/// Terrain presses along its normals, which differ on a ridge.
#[test]
fn a_ridge_is_found_where_it_is() {
    let place = Place::new();
    let file = |ending: &str| data(&format!("sponge/ridge_1{ending}")).display().to_string();
    let (sample, truth) = (file(".toml"), file("_bottom.csv"));
    let ran = place.run(&format!("solve sponge --sample {sample} --cloud 1 --truth {truth} --budget 300 --json"));
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let found = object(&ran.stdout);
    let of = |name: &str| found["errors"][name].as_f64().unwrap();
    assert!(of("iou") > 0.6 && of("patch_chamfer_mm2") < 12.0, "{}", found["errors"]);
    assert!(of("force_error_N") < 0.02 * of("force_N"), "{}", found["errors"]);
}

#[test]
fn units_and_missing_points_are_taken_care_of() {
    let place = Place::new();
    let cloud = |scale: f64, more: &str| -> String {
        let point = |i: i32| {
            let (radius, angle) = ((f64::from(i) / 500.0).sqrt(), 2.4 * f64::from(i));
            let [x, y, z] = [0.06 * radius * angle.cos(), 0.04 * radius * angle.sin(), 0.03 * (1.0 - radius * radius)];
            format!("{:e},{:e},{:e}\n", scale * x, scale * y, scale * z)
        };
        (0..500).map(point).collect::<String>() + more
    };
    place.put("m.csv", &cloud(1.0, ""));
    place.put("mm.csv", &cloud(1e3, ""));
    place.put("holes.csv", &cloud(1.0, "nan,nan,nan\n0,0,nan\n"));
    let ran = |line: &str| {
        let ran = place.run(&format!(
            "solve membrane --data {line} --set p=5000 --carrier network --iterations 3 --width 4 --threads 1 --json"
        ));
        assert!(matches!(ran.code, Some(0 | 3)), "{line}: {}", ran.stderr);
        object(&ran.stdout)
    };
    // Seen by a camera over the body that looks down: y of its frame is -y of the body's, and z is depth.
    let below = |line: &str| {
        let [x, y, z] = [0, 1, 2].map(|axis| line.split(',').nth(axis).unwrap().parse::<f64>().unwrap());
        format!("{:e},{:e},{:e}\n", 100.0 * (x - 0.01), -100.0 * y, 100.0 * (0.2 - z))
    };
    let seen: String = cloud(1.0, "").lines().map(below).collect();
    place.put("seen.csv", &("x_cm,y_cm,z_cm\n".to_string() + &seen));
    let turned = "rotation = [[1, 0, 0], [0, -1, 0], [0, 0, -1]]\nposition = [0.01, 0, 0.2]\n";
    place.put("camera.toml", &format!("fx = 400\nfy = 400\ncx = 320\ncy = 240\n{turned}"));

    let (metres, millimetres, holes) = (ran("m.csv"), ran("mm.csv --unit mm"), ran("holes.csv"));
    let force = |object: &Value| object["errors"]["force_N"].as_f64().unwrap();
    for same in [millimetres, ran("seen.csv --camera camera.toml")] {
        assert!((force(&metres) / force(&same) - 1.0).abs() < 1e-6, "{metres} {same}");
    }
    assert_eq!(force(&metres), force(&holes));
    assert!(holes["warnings"].to_string().contains("2 of 502 points were not finite"), "{holes}");
    // Without a truth there is a force, and nothing to compare it with.
    assert_eq!(metres["errors"].as_object().unwrap().len(), 1, "{metres}");
}

/// A high bulge is no load: the first surface has to be where the cloud is, or `f = p` on a flat membrane explains all.
#[test]
fn nothing_presses_a_free_membrane() {
    let place = Place::new();
    let ran = place.run(&format!(
        "solve membrane --sample {} --cloud 2 --iterations 24 --budget 600 --json",
        data("membrane/inflated_1.toml").display()
    ));
    assert_eq!(ran.code, Some(0), "{} {}", ran.stderr, ran.stdout);
    let found = object(&ran.stdout);
    assert!(found["errors"]["force_N"].as_f64().unwrap() < 0.3, "{}", found["errors"]);
    assert!(found["patches"].as_array().unwrap().is_empty(), "{}", found["patches"]);
}

/// Not the best that the solver reaches: so many steps that a wrong turn would show.
#[test]
fn local_functions_find_the_patch_and_the_modulus() {
    let place = Place::new();
    let answer = |line: &str| {
        let ran = place.run(&format!("solve {line} --budget 300 --json"));
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        object(&ran.stdout)
    };
    let contact = answer("membrane --iterations 24");
    assert_eq!(contact["optimizer"], "gauss-newton");
    let of = |name: &str| contact["errors"][name].as_f64().unwrap();
    assert!(of("iou") > 0.7, "{}", contact["errors"]);
    assert!(of("force_error_N") < 0.05 * of("force_N"), "{}", contact["errors"]);
    let (sample, truth) = (data("membrane/inflated_3.toml"), 285_000.0);
    let modulus = answer(&format!("membrane --scene identify --sample {} --cloud 0", sample.display()));
    let found = modulus["errors"]["E"].as_f64().unwrap();
    assert!((found / truth - 1.0).abs() < 0.005, "{found}");
}

/// Local functions have one method of their own, so that naming another asks for a network.
#[test]
fn a_named_method_trains_a_network() {
    let ran = Place::new().run("solve membrane --optimizer adam --iterations 2 --width 4 --json");
    assert_eq!(object(&ran.stdout)["optimizer"], "adam", "{}", ran.stderr);
}

/// Von Karman's membrane has no scale of its own: with heights three tenths as large, displacements within its plane and pressures are so by the second
/// and the third power. A membrane that is hardly bulged is pressed as one that is.
#[test]
fn a_shallow_membrane_tells_its_force() {
    let place = Place::new();
    let truth = fs::read_to_string(data("membrane/y_shape_1_truth.csv")).unwrap();
    let share = 0.3_f64;
    let mut cloud = String::from("x [m],y [m],z [m]\n");
    for line in truth.lines().skip(1).step_by(2) {
        let at: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [x, y] = [0, 1].map(|axis| at[axis] + share.powi(2) * at[2 + axis]);
        cloud += &format!("{x},{y},{}\n", share * at[4]);
    }
    place.put("c.csv", &cloud);
    let gauge = share.powi(3) * 5673.2;
    let ran = place.run(&format!(
        "solve membrane --scene contact --data c.csv --set a=0.06 --set b=0.04 --set t=0.45 --set E=341260 --set nu=0.5 --set p={gauge} \
         --budget 300 --json"
    ));
    assert_eq!(ran.code, Some(0), "{} {}", ran.stderr, ran.stdout);
    let found = object(&ran.stdout);
    let [force, deviation] = [&found["force"][2], &found["force_sd"]].map(|value| value.as_f64().unwrap());
    let off = (force / share.powi(3) + 10.721).abs();
    assert!(off < 0.2 && off < 4.0 * deviation / share.powi(3), "{force} {deviation}");
}
