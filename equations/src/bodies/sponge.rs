//! Binds the sponge's scenes to a cloud of its sides and the wrench that it carries.

use nisp::local::{Local, Patches};
use nisp::units::{Number, Scale};
use nisp_data::domain::{Domain, Points, Sampling};
use serde::Deserialize;

use super::cube::{face, surface};
use super::given::{Given, Positive, Sampled};
use super::observed::{Example, Observed, Sample};
use crate::PrepareError;
use crate::contact::{Contact, ContactRival, Face, Load, Rule, length};
use crate::entry::{Entry, Size};
use crate::frames::{Frames, bind_cloud};
use crate::prepared::Prepared;
use crate::request::Request;
use crate::rivals::LinearPressure;
use crate::truth::{Headers, Truth};

/// A sponge in a sample, in SI units and its own frame.
#[derive(Deserialize)]
struct Tables {
    sponge: Sponge,
    pose: Pose,
    wrench: Wrench,
}

#[derive(Deserialize)]
struct Sponge {
    side_m: Option<f64>,
    #[serde(rename = "young_Pa")]
    young: Option<f64>,
    poisson: Option<f64>,
    density_kg_m3: Option<f64>,
}

#[derive(Deserialize)]
struct Pose {
    gravity_in_sponge_frame_m_s2: Option<[f64; 3]>,
}

/// What a wrist sensor shows: `contact` if it was zeroed with the sponge in the air, `wrist` if it carries its weight.
#[derive(Deserialize)]
struct Wrench {
    #[serde(rename = "contact_force_N")]
    contact_force: Option<[f64; 3]>,
    #[serde(rename = "contact_torque_Nm")]
    contact_torque: Option<[f64; 3]>,
    #[serde(rename = "wrist_force_N")]
    wrist_force: Option<[f64; 3]>,
    #[serde(rename = "wrist_torque_Nm")]
    wrist_torque: Option<[f64; 3]>,
}

const GRAVITY: [&str; 3] = ["g_x", "g_y", "g_z"];
const FORCE: [&str; 3] = ["force_x", "force_y", "force_z"];
const TORQUE: [&str; 3] = ["torque_x", "torque_y", "torque_z"];

/// The side of a cube; that of the paper's sponge where nothing else is said.
pub(crate) const SIDE: &[Size] = &[Size { name: "side", usual: 0.046, about: "Side of the sponge, which is a cube." }];

const POSITIVE: &Positive = &[
    ("nu", "the equations divide by it: give Poisson's ratio with --set nu=VALUE"),
    (
        "force_z",
        "terrain presses up: give the force of the terrain on the sponge, in its frame, with --set force_z=VALUE",
    ),
];

/// Points inside, on the whole boundary for the equations and for the surface that the cloud is compared with.
const POINTS: (usize, usize, usize) = (1500, 2400, 4800);
/// The same for local functions: some three points along every cell.
const LOCAL_POINTS: (usize, usize, usize) = (13_824, 6144, 12_696);
/// Local functions: cells of nearly six millimetres on the paper's sponge.
const LOCAL: Local = Local { cells: 8, coarser: 3, degree: 2, tests: 2, finer: 2, source_dimensions: 2, patches: None };
/// The prior of patches; their level is that of a force that is spread over the touched face, see [`COVERED`].
const PATCHES: Patches = Patches { level: f64::NAN, edges: 0.15, area: 0.75, end: 0.7 };
/// Share of the face over which the force is spread at its least pressure: terrain seldom touches more.
const COVERED: f64 = 0.75;
/// Nodes along an edge where the answer is wanted: a millimetre apart on the paper's sponge.
const NODES: usize = 47;
const FINE: usize = 101;

/// The threshold at which the truth counts a point as touched.
const RULE: Rule = Rule { least: 200.0, of_mean: 0.0 };

/// What the truth's files call things.
const ALSO: &[(&str, &str)] = &[("u_x", "ux"), ("u_y", "uy"), ("u_z", "uz"), ("f", "p")];

const EXAMPLE: Example = Example {
    path: "data/sponge/plane_1.toml",
    sample: include_str!("../../../data/sponge/plane_1.toml"),
    cloud_path: "data/sponge/plane_1_cloud_1.ply",
    cloud: include_bytes!("../../../data/sponge/plane_1_cloud_1.ply"),
    truth_path: "data/sponge/plane_1_bottom.csv",
    truth: include_bytes!("../../../data/sponge/plane_1_bottom.csv"),
};

/// Reads what is asked for and binds a scene to it.
pub(crate) fn prepare(entry: &Entry, request: &Request) -> Result<Prepared, PrepareError> {
    let scene = entry.scene(request.scene.as_deref())?;
    let schema = scene.schema;
    if schema.groups.iter().flat_map(|group| group.columns).any(|column| column.name == "clearance") {
        return Err(PrepareError::Terrain { scene: schema.name });
    }
    let mut observed = Observed::read(entry, request, &EXAMPLE)?;
    let sample =
        observed.sample.as_ref().map(|sample| Ok::<_, PrepareError>((sample.path.as_path(), numbers(sample)?)));
    let given = Given { scene, request, sample: sample.transpose()?, sizes: entry.sizes };
    let mut problem = given.problem(POSITIVE)?;
    let assumed = given.assumed()?;
    let side = given.size("side")?;
    let (low, high) = ([-0.5 * side, -0.5 * side, -side], [0.5 * side, 0.5 * side, 0.0]);
    let frames =
        Frames { calibration: None, pose: None, body: "sponge", within: (low, high), cell: side / LOCAL.cells as f64 };
    frames.take(&observed.source, &mut observed.cloud)?;

    let vector = |names: [&'static str; 3]| -> Result<[f64; 3], PrepareError> {
        let [x, y, z] = names.map(|name| given.of(name));
        Ok([x?, y?, z?].map(|value| value.unwrap_or(0.0)))
    };
    let wrench = [vector(FORCE)?, vector(TORQUE)?];
    let presses = direction(wrench[0]);

    let cube = Domain::cuboid(&low, &high)?;
    let least = Number::si(length(wrench[0]) / (COVERED * side * side));
    let patches = schema.heads.iter().find(|head| head.source).map(|head| {
        let level = head.unit.factor.back(least).as_declared();
        Patches { level, ..PATCHES }
    });
    let local = (!request.network).then_some(Local { patches, ..LOCAL });
    let (counts, sampling) = if local.is_some() { (LOCAL_POINTS, Sampling::Grid) } else { (POINTS, Sampling::Sobol) };
    for group in schema.groups {
        let count = if group.name == "surface" { counts.2 } else { counts.1 };
        let points = match group.name {
            "volume" => cube.interior(counts.0, sampling, 0),
            "bottom" => cube.boundary(count).select(|_, normal| normal[2] < -0.5),
            "top" => cube.boundary(count).select(|_, normal| normal[2] > 0.5),
            _ => cube.boundary(count).select(|_, normal| normal[2].abs() < 0.5),
        };
        let columns = group.columns.iter().map(|column| normals(&points, column.name)).collect();
        let weights = points.weights.unwrap_or_default();
        problem.set_group(
            group.name,
            nisp::Points { coordinates: points.coords, weights, partners: vec![] },
            columns,
        )?;
    }
    bind_cloud(&mut problem, &observed.cloud)?;

    let headers = Headers { chosen: &request.columns, rather: &[], also: ALSO };
    let truth = observed.truth.as_ref().map(|table| Truth::read(table, schema, &[], headers)).transpose()?;
    let square = Domain::cuboid(&low[..2], &high[..2])?;
    let mut contact = Contact {
        displacement: ["u_x", "u_y", "u_z"],
        unit: Scale::new(1e-3),
        pressure: Some("f"),
        rule: RULE,
        load: Load::Normal(presses),
        face: Face::new(3, on_the_bottom(FINE, side))?,
        surface: surface(side),
        near: frames.near(),
        cloud: observed.cloud.points,
        // From below, where the pressure is.
        eye: [-60.0, -35.0],
        truth: None,
        rival: rival(wrench, side),
    };
    contact.truth = contact.true_contact(schema, observed.truth.as_ref().zip(truth.as_ref()), headers)?;
    Ok(Prepared {
        problem,
        points: on_the_bottom(NODES, side),
        outline: square.outline(4),
        planes: Vec::new(),
        measured: Vec::new(),
        truth,
        source: observed.source.display().to_string(),
        begin: None,
        warnings: observed.cloud.warnings,
        assumed,
        rival: None,
        local,
        contact: Some(contact),
        references: None,
        // The wrench is part of every frame too.
        frames: None,
    })
}

fn numbers(sample: &Sample) -> Result<Vec<Sampled>, PrepareError> {
    let Tables { sponge, pose, wrench } = sample.tables()?;
    let number = |name, key, value| Sampled { name, key, value };
    let mut numbers = vec![
        number("side", "[sponge] side_m", sponge.side_m),
        number("E", "[sponge] young_Pa", sponge.young),
        number("nu", "[sponge] poisson", sponge.poisson),
        number("rho", "[sponge] density_kg_m3", sponge.density_kg_m3),
    ];
    let gravity = pose.gravity_in_sponge_frame_m_s2;
    let weight = || -> Option<[[f64; 3]; 2]> {
        let mass = sponge.density_kg_m3? * sponge.side_m?.powi(3);
        Some(weight(gravity?.map(|g| mass * g), sponge.side_m?))
    };
    let without = |total: Option<[f64; 3]>, part: usize| -> Option<[f64; 3]> {
        let (total, weight) = (total?, weight()?[part]);
        Some(std::array::from_fn(|axis| total[axis] - weight[axis]))
    };
    let vectors = [
        (GRAVITY, "[pose] gravity_in_sponge_frame_m_s2", gravity),
        (FORCE, "[wrench] contact_force_N", wrench.contact_force.or_else(|| without(wrench.wrist_force, 0))),
        (TORQUE, "[wrench] contact_torque_Nm", wrench.contact_torque.or_else(|| without(wrench.wrist_torque, 1))),
    ];
    for (names, key, vector) in vectors {
        numbers.extend((0..3).map(|axis| number(names[axis], key, vector.map(|vector| vector[axis]))));
    }
    Ok(numbers)
}

/// A weight that acts in the cube's middle, half a side below the origin: its force and its torque.
fn weight(force: [f64; 3], side: f64) -> [[f64; 3]; 2] {
    let arm = -0.5 * side;
    [force, [-arm * force[1], arm * force[0], 0.0]]
}

/// The direction in which frictionless terrain presses, as far as a force tells: its own, or upwards if there is none.
fn direction(force: [f64; 3]) -> [f64; 3] {
    let size = length(force);
    if size > 0.0 && force[2] > 0.0 { force.map(|x| x / size) } else { [0.0, 0.0, 1.0] }
}

/// A component of the outward normal, by its name.
fn normals(points: &Points, column: &str) -> Vec<f64> {
    let axis = if column.ends_with("_x") {
        0
    } else if column.ends_with("_y") {
        1
    } else {
        2
    };
    points.normals.iter().flatten().skip(axis).step_by(3).copied().collect()
}

/// The wrench alone: moments of the force across the face, without what its part along the face does at the origin.
fn rival([force, torque]: [[f64; 3]; 2], side: f64) -> Option<ContactRival> {
    let moments = [-torque[1] - side * force[0], torque[0] - side * force[1]];
    let linear = LinearPressure::carrying(side, force[2], moments)?;
    let pressure = move |at: &[f64]| at.as_chunks::<3>().0.iter().map(|&[x, y, _]| linear.at(x, y)).collect();
    Some(ContactRival { name: "the wrench alone", pressure: Box::new(pressure) })
}

/// Nodes on the face that is pressed, so many along an edge.
fn on_the_bottom(nodes: usize, side: f64) -> Vec<f64> {
    face(nodes).into_iter().flat_map(|[x, y]| [side * x, side * y, -side]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sample's own figures: wrist = contact + weight.
    #[test]
    fn a_wrist_that_carries_the_weight_shows_it() {
        let [force, torque] = weight([-0.00116622, -0.000874664, -0.0333885], 0.046);
        assert_eq!(force[2], -0.0333885);
        let shown = [-0.000500953 + 0.000480836, 0.000667844 - 0.000641021];
        assert!((torque[0] - shown[0]).abs() < 1e-9 && (torque[1] - shown[1]).abs() < 1e-9, "{torque:?}");
    }
}
