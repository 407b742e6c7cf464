//! The plate, the membrane and the sponge: the repository's samples, seen anew.

use std::io::Write;
use std::path::{Path, PathBuf};

use nisp::{Carrier, Settings};
use nisp_data::Cloud;
use nisp_equations::{Prepared, Request};

use super::corruption::Corruption::{
    Early, Exact, Few, Mirrored, Moved, Nothing, Outliers, Parameter, Scaled, Swapped, Turned,
};
use super::experiment::{Bind, Experiment, Ready, Stated, Subject, Told, Truth, cases};
use super::samples::{Column, Samples};

/// All of them.
pub(super) fn subjects(repository: &Path) -> Vec<Subject> {
    let pressed = [
        Nothing,
        Few(400),
        Outliers(0.03),
        Parameter("E", 1e6),
        Parameter("p", 1000.0),
        Mirrored("z", 0.0),
        Scaled("x", 1.1),
        Moved("x", 5e-3),
        Turned("x", "y", 90.0),
        Swapped("x", "z"),
        Scaled("z", 1e3),
    ];
    let free = [Nothing, Exact, Parameter("E", 1e6), Moved("z", 0.01), Turned("x", "z", 15.0), Turned("x", "y", 20.0)];
    let inflated = [Nothing, Moved("z", 5e-3), Scaled("x", 1.1)];
    let sponge = [
        Nothing,
        Few(200),
        Outliers(0.03),
        Parameter("E", 1e5),
        Turned("x", "y", 20.0),
        Moved("z", 5e-3),
        Scaled("z", 0.5),
    ];
    // A wrong Young's modulus of a plate is another plate, and the plate's equations are solved for it.
    let plate = [
        Nothing,
        Early(3),
        Parameter("E", -1e9),
        Parameter("nu", 1.5),
        Parameter("t", 0.0),
        Parameter("t", 3e-4),
        Parameter("E", 1e308),
    ];
    let membrane = |name, sample, scene, cases| {
        let truth = if name == "membrane" { "_truth.csv" } else { "" };
        body(repository, Body { name, sample, scene, truth, ..Body::MEMBRANE }, cases)
    };
    // Shape and pressure determine the modulus up to the pressure's own error.
    vec![
        plate_subject("plate", "clamped", &plate),
        plate_subject("plate, held only", "edge_only", &[Nothing]),
        membrane("membrane", "data/membrane/flower_1", "contact", cases(&pressed, &[])),
        membrane("membrane, free", "data/membrane/inflated_1", "contact", cases(&free, &[])),
        membrane(
            "membrane, modulus",
            "data/membrane/inflated_1",
            "identify",
            cases(&inflated, &[Parameter("p", 1000.0)]),
        ),
        body(repository, Body::SPONGE, cases(&sponge, &[])),
    ]
}

/// A body that is seen as a cloud.
#[derive(Clone, Copy)]
struct Body {
    name: &'static str,
    entry: &'static str,
    scene: &'static str,
    /// Path of its files in the repository, without their endings.
    sample: &'static str,
    /// Ending of the file with the true pressure; empty where nothing presses.
    truth: &'static str,
    /// Standard deviation of the noise along x, y and z, in metres.
    noise: [f64; 3],
    /// Pressure that an error is compared with where nothing presses, in pascals.
    pressure: f64,
}

impl Body {
    const MEMBRANE: Self = Self {
        name: "membrane",
        entry: "membrane",
        scene: "contact",
        sample: "",
        truth: "_truth.csv",
        noise: [0.0, 0.0, 1e-3],
        pressure: 1000.0,
    };
    const SPONGE: Self = Self {
        name: "sponge",
        entry: "sponge",
        scene: "unknown_terrain",
        sample: "data/sponge/plane_1",
        truth: "_bottom.csv",
        noise: [5e-4; 3],
        pressure: 1000.0,
    };
}

fn body(repository: &Path, body: Body, cases: Vec<super::experiment::Case>) -> Subject {
    let repository: PathBuf = repository.into();
    let make = move |_| {
        let file = |ending: &str| repository.join(format!("{}{ending}", body.sample));
        let exact = Cloud::read(file("_cloud_0.ply")).map_err(|error| {
            format!("{error}; the study needs the repository's data: name its folder with --repository")
        })?;
        let column = |(axis, name): (usize, &'static str)| Column {
            name,
            values: exact.points.iter().map(|point| point[axis]).collect(),
            measured: body.noise[axis] > 0.0,
            noise: Some(body.noise[axis]),
        };
        let columns = ["x", "y", "z"].into_iter().enumerate().map(column).collect();
        let (sample, truth) = (file(".toml"), file(body.truth));
        let bind: Bind = Box::new(move |samples, told| bind_body(body, (&sample, &truth), samples, told));
        Ok(Experiment { samples: Samples { columns }, noise: 0.0, bind })
    };
    // Three coordinates take longer.
    let patience = if body.entry == "sponge" { 3.0 } else { 1.0 };
    Subject { name: body.name, make: Box::new(make), cases, patience }
}

fn bind_body(body: Body, (sample, truth): (&Path, &Path), samples: &Samples, told: Told<'_>) -> Result<Ready, String> {
    let entry = crate::entry(body.entry)?;
    let fault = |error: std::io::Error| error.to_string();
    let mut cloud = tempfile::Builder::new().suffix(".xyz").tempfile().map_err(fault)?;
    for row in 0..samples.rows() {
        let [x, y, z] = [0, 1, 2].map(|axis| samples.columns[axis].values[row]);
        writeln!(cloud, "{x} {y} {z}").map_err(fault)?;
    }
    let request = Request {
        scene: Some(body.scene.into()),
        sample: Some(sample.into()),
        data: vec![(None, cloud.path().into())],
        truth: (!body.truth.is_empty()).then(|| truth.into()),
        parameters: told.iter().map(|(name, value)| ((*name).into(), *value)).collect(),
        ..Request::default()
    };
    let prepared = entry.prepare(&request).map_err(|error| error.to_string())?;
    let carrier = carrier(&prepared);
    let size = body.pressure;
    let truth = match prepared.truth {
        // The modulus that the repository's membranes are made with.
        _ if body.scene == "identify" => Truth { scalars: vec![("E", 341_260.0)], ..Truth::default() },
        Some(known) => {
            let pressure = known.of("f").ok_or("no true pressure")?.to_vec();
            Truth { points: known.points, heads: vec![("f", pressure)], size, ..Truth::default() }
        }
        None => {
            let points = prepared.points;
            let zeros = vec![0.0; points.len() / prepared.problem.scene().schema.coordinates.len()];
            Truth { points, heads: vec![("f", zeros)], size, ..Truth::default() }
        }
    };
    Ok(Ready { problem: prepared.problem, carrier, stated: Vec::new(), truth })
}

/// What `nisp solve` carries it with.
fn carrier(prepared: &Prepared) -> Carrier {
    prepared.suited(Settings::default()).carrier
}

/// A plate, which has no data: the truth is the closed form for the parameters that it is told.
fn plate_subject(name: &'static str, scene: &'static str, told: &[super::corruption::Corruption]) -> Subject {
    let make = move |_| {
        let bind: Bind = Box::new(move |_, told| bind_plate(scene, told));
        Ok(Experiment { samples: Samples::default(), noise: 0.0, bind })
    };
    Subject { name, make: Box::new(make), cases: cases(told, &[]), patience: 1.0 }
}

fn bind_plate(scene: &str, told: Told<'_>) -> Result<Ready, String> {
    let parameters = told.iter().map(|(name, value)| ((*name).into(), *value)).collect();
    let request = Request { scene: Some(scene.into()), parameters, ..Request::default() };
    let prepared = crate::entry("plate")?.prepare(&request).map_err(|error| error.to_string())?;
    let known = prepared.truth.as_ref().ok_or("no truth")?;
    let value = |name: &str, usual: f64| told.iter().find(|(own, _)| *own == name).map_or(usual, |(_, value)| *value);
    // The deflection goes with (1 - nu^2) / (E t^3); the example has E = 1e9 Pa, nu = 0.5, t = 0.3 mm.
    let softer = (1e9 / value("E", 1e9)) * (0.3 / value("t", 0.3)).powi(3) * (1.0 - value("nu", 0.5).powi(2)) / 0.75;
    let deflection: Vec<f64> = known.of("w").ok_or("no deflection")?.iter().map(|w| softer * w).collect();
    let largest = deflection.iter().fold(0.0, |largest: f64, w| largest.max(w.abs()));
    let radius = prepared.outline.iter().fold(0.0, |radius: f64, [x, _]| radius.max(*x));
    Ok(Ready {
        carrier: carrier(&prepared),
        stated: vec![Stated { head: "w", at: vec![radius, 0.0], value: 0.0, size: largest }],
        truth: Truth { points: known.points.clone(), heads: vec![("w", deflection)], ..Truth::default() },
        problem: prepared.problem,
    })
}
