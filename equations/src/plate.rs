//! A thin plate under pressure: the paper's forward problem (section 3.5 of its ablations).

#![allow(deprecated, reason = "scene `edge_only` leaves the plate without its second edge condition on purpose")]

use nisp::units::{Number, Scale};
use nisp::{Points, Problem, scene_in_both_precisions as scene};
use nisp_data::Table;
use nisp_data::domain::{Domain, Sampling};
use nisp_data::input::read_text;
use serde::Deserialize;
use std::path::Path;

use crate::entry::{Binding, Entry};
use crate::error::PrepareError;
use crate::prepared::Prepared;
use crate::request::Request;
use crate::truth::{Headers, Truth};

/// The plate on the command line.
pub(crate) fn entry() -> Entry {
    Entry {
        name: "plate",
        about: "the deflection of a clamped circular plate under pressure: a forward problem",
        scenes: vec![scene::<plate::clamped::Scene>(), scene::<plate::edge_only::Scene>()],
        data: "data/plate/plate.toml",
        sizes: &[],
        binding: Binding::Own(prepare),
    }
}

/// A plate in a file, in SI units.
#[derive(Deserialize)]
struct Sample {
    #[serde(rename = "radius_m")]
    radius: f64,
    #[serde(rename = "pressure_Pa")]
    pressure: f64,
    #[serde(rename = "young_Pa")]
    young: f64,
    poisson: f64,
    #[serde(rename = "thickness_m")]
    thickness: f64,
}

/// Points within the plate, and on its rim.
const POINTS: (usize, usize) = (400, 80);

fn prepare(entry: &Entry, request: &Request) -> Result<Prepared, PrepareError> {
    const EXAMPLE: &str = include_str!("../../data/plate/plate.toml");
    const TRUTH: &[u8] = include_bytes!("../../data/plate/plate_points.csv");
    let file = request.file(entry.name)?;
    let path = file.map_or_else(|| entry.data.into(), Path::to_path_buf);
    let fault = |reason: String| PrepareError::File { path: path.clone(), reason };
    let text = match file {
        Some(path) => read_text(path)?,
        None => EXAMPLE.into(),
    };
    let sample: Sample = toml::from_str(&text).map_err(|error| fault(error.message().into()))?;
    let scene = entry.scene(request.scene.as_deref())?;
    let mut problem = Problem::new(scene);
    let sampled = [("E", sample.young), ("nu", sample.poisson), ("t", sample.thickness), ("P", sample.pressure)];
    for (name, value) in sampled {
        let scalar = scene.schema.scalars.iter().find(|scalar| scalar.name == name);
        let unit = scalar.map_or(Scale::new(1.0), |scalar| scalar.unit.factor);
        problem.set_parameter(name, unit.inverse().of(Number::si(value)).as_declared())?;
    }
    for (name, value) in &request.parameters {
        problem.set_parameter(name, *value)?;
    }
    let disc = Domain::disc([0.0, 0.0], sample.radius)?;
    let interior = disc.interior(POINTS.0, Sampling::Sobol, 0);
    let rim = disc.boundary(POINTS.1);
    // Whoever asks for the slope across the rim asks for its normals.
    let asked = scene.schema.groups[1].columns.len();
    let normals = rim.normals.as_deref().unwrap_or_default();
    let normals = (0..asked).map(|axis| normals.iter().skip(axis).step_by(2).copied().collect()).collect();
    problem.set_group("interior", Points::from(interior.coords), Vec::new())?;
    problem.set_group("rim", Points::from(rim.coords), normals)?;
    let truth = match (&request.truth, file) {
        (Some(path), _) => Some(Table::read(path)?),
        (None, None) => Some(Table::parse(Path::new("data/plate/plate_points.csv"), TRUTH)?),
        (None, Some(_)) => None,
    };
    let truth = truth.map(|table| Truth::read(&table, scene.schema, &[], Headers::default())).transpose()?;
    let points = grid(sample.radius).filter(|point| disc.contains(point)).flatten().collect();
    let source = path.display().to_string();
    Ok(Prepared {
        problem,
        points,
        outline: disc.outline(200),
        planes: Vec::new(),
        measured: Vec::new(),
        truth,
        source,
        begin: None,
        warnings: Vec::new(),
        assumed: Vec::new(),
        rival: None,
        local: None,
        contact: None,
        references: None,
        frames: None,
    })
}

/// A grid over the plate.
fn grid(radius: f64) -> impl Iterator<Item = [f64; 2]> {
    const HALF: i32 = 30;
    let step = radius / f64::from(HALF);
    (-HALF..=HALF).flat_map(move |i| (-HALF..=HALF).map(move |j| [f64::from(j) * step, f64::from(i) * step]))
}

nisp::pde! {
    /// Kirchhoff's plate `D biharmonic(w) = P` on a disc. Its truth `w = P (r^2 - x^2 - y^2)^2 / (64 D)` has a clamped edge,
    /// whose slope vanishes too: with `w = 0` alone the plate could as well be hinged.
    pub mod plate {
        coordinates:
            /// place
            x [m],
            /// place
            y [m];
        fields:
            /// deflection
            w [mm];
        parameters:
            /// Young's modulus
            E [Pa] > 0 = 1e9,
            /// Poisson's ratio
            nu in -1 .. 0.5 = 0.5,
            /// thickness
            t [mm] > 0 = 0.3,
            /// pressure
            P [Pa] = 2757;

        let D = E * t^3 / (12 * (1 - nu^2));

        on interior { balance: D * biharmonic(w) == P; }
        on rim {
            columns:
                /// outward normal
                n: vector [1];
            held: w == 0;
            clamped: dot(grad(w), n) == 0;
        }

        /// The deflection of a plate that is held and clamped along its edge.
        scene clamped { }
        /// The deflection of a plate that is only held: not enough to determine it.
        scene edge_only { without rim.clamped; }
    }
}
