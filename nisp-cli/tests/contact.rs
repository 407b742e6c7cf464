//! Membrane and sponge from point clouds: what is read, what is written, what is measured.

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use common::{Place, names};
use serde_json::Value;

/// A file of the repository's data.
fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data").join(name)
}

fn object(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

const FILES: [&str; 6] = ["plot.svg", "source.csv", "state.csv", "surface.ply", "surface.svg", "surface.vtu"];

#[test]
fn a_contact_is_scored_beside_a_classical_way_and_its_surface_is_written() {
    let place = Place::new();
    let ran = place.run("solve membrane --iterations 3 --width 6 --out out");
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
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
        let ran = place.run(&format!("solve {line} --iterations 2 --width 4 --json"));
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
                "solve {scene} --sample {sample}.toml --cloud 1 --iterations 3 --width 4 --threads 1 --json --out {sample}"
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
