//! Binds the scenes of an inflated membrane over an elliptic rim to a cloud of its surface.

use nisp::local::{Local, Patches};
use nisp::schema::Origin;
use nisp::units::{Number, Scale};
use nisp::{Problem, Tolerance};
use nisp_data::DataError;
use nisp_data::domain::{Domain, Sampling};
use serde::Deserialize;

use super::calibrate::region;
use super::given::{Given, Positive, Sampled};
use super::observed::{Example, Observed, Sample};
use crate::PrepareError;
use crate::contact::{
    CALIBRATES, Calibration, Contact, ContactRival, Face, LEARNED, Load, Membrane, References, Rule, SHIFT, Surface,
    TURN, WIDEN,
};
use crate::entry::{Entry, Size};
use crate::frames::{Frames, bind_cloud};
use crate::prepared::Prepared;
use crate::request::Request;
use crate::truth::{Headers, Truth};

/// What one theory of the membrane has of its own.
pub(super) struct Theory {
    /// The example of a scene that has a pressure.
    pub(super) pressed: Example,
    /// The example of a scene that nothing touches.
    pub(super) inflated: Example,
    /// How the contact pressure acts.
    pub(super) load: Load,
    /// How a touched point is told, given the gauge pressure in pascals.
    pub(super) rule: fn(f64) -> Rule,
    /// What is known of the pressure; its `level` is the gauge pressure: what touches the membrane presses it out of its bulge, which
    /// takes that much at least.
    pub(super) patches: Patches,
    /// What the truth's files call things, see [`Headers`].
    pub(super) rather: &'static [(&'static str, &'static str)],
    /// A classical way to the pressure.
    pub(super) rival: Option<Rival>,
}

/// A way to a [`ContactRival`], for these semi-axes in metres.
type Rival = fn(&Given<'_>, &Observed, [f64; 2]) -> Result<ContactRival, PrepareError>;

/// A membrane in a sample, in SI units.
#[derive(Deserialize)]
struct Tables {
    membrane: Membrane,
}

/// Semi-axes; those of the paper's membrane where nothing else is said.
pub(crate) const SEMI_AXES: &[Size] = &[
    Size { name: "a", usual: 0.06, about: "Semi-axis of the rim along x." },
    Size { name: "b", usual: 0.04, about: "Semi-axis of the rim along y." },
];

const POSITIVE: &Positive =
    &[("p", "nothing inflates the membrane without pressure from below: give the gauge pressure with --set p=VALUE")];

/// Points within the membrane for the equations, for the surface that the cloud is compared with, and on the rim.
pub(super) const POINTS: (usize, usize, usize) = (1500, 2000, 200);
/// The same for local functions: some nine points in every cell.
const LOCAL_POINTS: (usize, usize, usize) = (17_000, 8000, 400);
/// Local functions: cells of two millimetres on the paper's membrane for a pressure with edges, of four where nothing
/// touches it.
const LOCAL: Local =
    Local { cells: 30, coarser: 3, degree: 3, tests: 1, finer: 2, source_dimensions: 2, patches: None };
const CELLS_FOR_PATCHES: usize = 60;
/// Points between which the net force is integrated, and those of the surface in pictures.
const FINE: (usize, usize) = (20_000, 4000);
/// Points in a metre where the answer is wanted.
const PER_METRE: f64 = 1000.0;

/// What the truth's files call the coordinates.
const ALSO: &[(&str, &str)] = &[("alpha", "x"), ("beta", "y")];

/// Reads what is asked for and binds a scene to it.
pub(super) fn prepare(theory: &Theory, entry: &Entry, request: &Request) -> Result<Prepared, PrepareError> {
    let has_cloud = request.frame.is_some() || !request.data.is_empty();
    if request.calibration.is_some() && (!has_cloud || request.sample.is_some()) {
        let instead = "it goes with a frame of the calibrated sensor, and without --sample: --data FRAME";
        return Err(PrepareError::Option { entry: entry.name, option: "calibration", instead });
    }
    let calibration = request.calibration.as_deref().map(Calibration::read).transpose()?;
    let mut scene = entry.scene(request.scene.as_deref())?;
    if let Some(calibration) = &calibration {
        scene = entry.scene(Some(&calibration.scene_for(scene.schema.name)))?;
    }
    let schema = scene.schema;
    let calibrates = schema.name.starts_with(CALIBRATES);
    let source = schema.heads.iter().find(|head| head.source);
    let pressure = source.map(|head| head.name);
    let example = if pressure.is_some() { &theory.pressed } else { &theory.inflated };
    let (mut observed, points) = match calibrates {
        true => Observed::all(request)?,
        false => (Observed::read(entry, request, example)?, Vec::new()),
    };
    let sample =
        observed.sample.as_ref().map(|sample| Ok::<_, PrepareError>((sample.path.as_path(), numbers(sample)?)));
    let given = Given { scene, request, sample: sample.transpose()?, sizes: entry.sizes };
    let mut problem = given.problem(POSITIVE)?;
    let mut assumed = given.assumed()?;
    let (mut a, mut b) = (given.size("a")?, given.size("b")?);
    let mut pose = calibration.as_ref().map(|calibration| calibration.pose);
    if !calibrates {
        for (size, name) in [&mut a, &mut b].into_iter().zip(WIDEN) {
            *size *= taken(&mut problem, &given, name)?.unwrap_or(1.0);
        }
        for axis in 0..3 {
            if let Some(turn) = taken(&mut problem, &given, TURN[axis])? {
                pose.get_or_insert_default().turn_rad[axis] = turn;
            }
            if let Some(shift) = taken(&mut problem, &given, SHIFT[axis])? {
                pose.get_or_insert_default().shift_m[axis] = shift;
            }
        }
        // The calibration knows them.
        assumed.retain(|own| calibration.is_none() || !LEARNED.contains(&own.name));
    }
    let references = calibrates.then(|| References::new(&mut observed.cloud, points, &given)).transpose()?;
    if calibrates && given.says("E").is_none() {
        problem.set_parameter("E", stiff(&given)?)?;
    }

    let ellipse = Domain::ellipse([0.0, 0.0], [a, b])?;
    let patches = given.of("p")?.zip(source).map(|(level, head)| {
        let level = head.unit.factor.back(Number::si(level)).as_declared();
        Patches { level, ..theory.patches }
    });
    // What a calibration leaves must not be the error of a coarser lattice than later frames are solved on.
    let usual = if patches.is_some() || calibrates { CELLS_FOR_PATCHES } else { LOCAL.cells };
    let cells = request.cells.unwrap_or(usual);
    let local = (!request.network).then_some(Local { cells, patches, ..LOCAL });
    // Cells of another size have as many points each.
    let scaled = |count: usize, dimensions| (count as f64 * (cells as f64 / usual as f64).powi(dimensions)) as usize;
    let (counts, sampling) = match local {
        Some(_) => {
            let (inner, surface, rim) = LOCAL_POINTS;
            ((scaled(inner, 2), scaled(surface, 2), scaled(rim, 1)), Sampling::Grid)
        }
        None => (POINTS, Sampling::Sobol),
    };
    for group in schema.groups {
        let points = match group.name {
            "rim" => ellipse.boundary(counts.2),
            "surface" => ellipse.interior(counts.1, sampling, 0),
            _ => ellipse.interior(counts.0, sampling, 0),
        };
        // Equations are tested by weighted means; conditions on the rim and places of the surface are single points.
        let weights = points.weights.filter(|_| local.is_some() && group.name == "interior").unwrap_or_default();
        let points = nisp::Points { coordinates: points.coords, weights, ..nisp::Points::default() };
        problem.set_group(group.name, points, Vec::new())?;
    }
    let frames = Frames {
        calibration,
        pose,
        body: "membrane",
        within: ([-a, -b, 0.0], [a, b, b]),
        cell: 2.0 * a.max(b) / cells as f64,
    };
    frames.take(&observed.source, &mut observed.cloud)?;
    bind_cloud(&mut problem, &observed.cloud)?;
    match &frames.calibration {
        // What was taken off a point may be off by as much as it is where the surface is pressed into another shape.
        Some(calibration) => {
            let tolerance = Tolerance {
                size: calibration.found.misfit_m,
                region: region(a, b),
                common: calibration.found.common(),
            };
            problem.set_tolerance("surface", "cloud", tolerance)?;
            calibration.doubts().into_iter().for_each(|doubt| problem.add_doubt(doubt));
            for amounts in &calibration.posterior {
                let is_said = |name: &str| request.parameters.iter().any(|(own, _)| own == name);
                let amounts = amounts.iter().filter(|(name, _)| !is_said(name));
                problem.set_uncertain(&amounts.map(|(name, amount)| (name.as_str(), *amount)).collect::<Vec<_>>())?;
            }
        }
        // The camera looks up.
        None if local.is_some() && !calibrates => problem.set_view("surface", "cloud", [0.0, 0.0, 1.0])?,
        None => {}
    }

    let doubt = frames.calibration.as_ref().and_then(Calibration::doubt);
    let headers = Headers { chosen: &request.columns, rather: theory.rather, also: ALSO };
    let truth = observed.truth.as_ref().map(|table| Truth::read(table, schema, &[], headers)).transpose()?;
    let mut contact = Contact {
        displacement: ["u", "v", "w"],
        unit: Scale::new(1e-3),
        pressure,
        rule: (theory.rule)(given.of("p")?.unwrap_or(0.0)),
        load: theory.load,
        face: face(&ellipse, FINE.0)?,
        surface: surface(&ellipse)?,
        eye: [-65.0, 40.0],
        truth: None,
        rival: pressure.and(theory.rival).map(|rival| rival(&given, &observed, [a, b])).transpose()?,
        near: frames.near(),
        cloud: observed.cloud.points,
    };
    contact.truth = contact.true_contact(schema, observed.truth.as_ref().zip(truth.as_ref()), headers)?;
    Ok(Prepared {
        problem,
        points: grid(&ellipse),
        outline: ellipse.outline(200),
        planes: Vec::new(),
        measured: Vec::new(),
        truth,
        source: observed.source.display().to_string(),
        begin: None,
        warnings: observed.cloud.warnings.into_iter().chain(doubt).collect(),
        assumed,
        rival: None,
        local,
        contact: Some(contact),
        references,
        frames: Some(frames).filter(|_| !calibrates),
    })
}

/// A width or a number of the pose that the user gave, in SI units. The caller changes semi-axes or clouds by it, so that the problem's own
/// parameter goes back to what is declared.
fn taken(problem: &mut Problem, given: &Given<'_>, name: &'static str) -> Result<Option<f64>, PrepareError> {
    let Some(said) = given.says(name) else { return Ok(None) };
    for scalar in given.scene.schema.scalars.iter().filter(|scalar| scalar.name == name) {
        if let Origin::Given(Some(usual)) = scalar.origin {
            problem.set_parameter(name, scalar.unit.factor.back(usual).as_declared())?;
        }
    }
    Ok(Some(said.as_si()))
}

/// A modulus in pascals at which the gas stretches the membrane by a twentieth: steps towards a softer one that bulges as the
/// cloud does are safe, while one that is too soft may have no equilibrium.
fn stiff(given: &Given<'_>) -> Result<f64, PrepareError> {
    const STRETCH: f64 = 0.05;
    let value = |name| Ok::<_, PrepareError>(given.of(name)?.unwrap_or(f64::NAN));
    // The tension of a sphere over the shorter axis is half the pressure times its radius.
    Ok(0.5 * value("p")? * value("b")? / (STRETCH * value("t")?))
}

fn numbers(sample: &Sample) -> Result<Vec<Sampled>, PrepareError> {
    let Membrane { a_m, b_m, thickness_m, young, poisson, stretch, pressure } = sample.tables::<Tables>()?.membrane;
    let number = |name, key, value| Sampled { name, key, value };
    let mut numbers = vec![
        number("a", "[membrane] a_m", a_m),
        number("b", "[membrane] b_m", b_m),
        number("t", "[membrane] thickness_m", thickness_m),
        number("E", "[membrane] young_Pa", young),
        number("nu", "[membrane] poisson", poisson),
        number("p", "[membrane] gauge_pressure_Pa", pressure),
    ];
    // Most samples have none.
    numbers.extend(stretch.map(|stretch| number("stretch", "[membrane] stretch", Some(stretch))));
    Ok(numbers)
}

/// Points on a regular grid around the origin.
fn grid(domain: &Domain) -> Vec<f64> {
    let (_, high) = domain.bounds();
    let half = |axis: usize| (high[axis] * PER_METRE).floor() as i32;
    let line = |axis: usize| (-half(axis)..=half(axis)).map(|i| f64::from(i) / PER_METRE);
    let points = line(1).flat_map(|y| line(0).map(move |x| [x, y]));
    points.filter(|point| domain.contains(point)).flatten().collect()
}

/// The membrane in triangles between so many points and those of its rim.
fn face(ellipse: &Domain, count: usize) -> Result<Face, DataError> {
    let inner = ellipse.interior(count, Sampling::Grid, 0).coords;
    Face::new(2, [ellipse.boundary(POINTS.2).coords, inner].concat())
}

fn surface(ellipse: &Domain) -> Result<Surface, DataError> {
    let Face { points, triangles, .. } = face(ellipse, FINE.1)?;
    Ok(Surface { loaded: vec![true; points.len() / 2], points, triangles })
}
