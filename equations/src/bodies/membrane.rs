//! The membrane of small strains, as the paper has it.

use std::cell::OnceCell;

use nisp::local::Patches;
use nisp_data::domain::Domain;

use super::given::Given;
use super::inflated;
use super::inflated::{POINTS, Theory};
use super::observed::{Example, Observed};
use crate::PrepareError;
use crate::contact::{ContactRival, Load, Rule};
use crate::entry::Entry;
use crate::prepared::Prepared;
use crate::request::Request;
use crate::rivals::{CloudFit, inflated_tensions, pressure_by_operator};

const THEORY: Theory = Theory {
    pressed: PRESSED,
    inflated: INFLATED,
    load: Load::Fixed([0.0, 0.0, -1.0]),
    // The paper's rule.
    rule: |_| Rule { least: 2500.0, of_mean: 2.0 },
    patches: Patches { level: f64::NAN, edges: 0.15, area: 0.75, end: 0.7 },
    rather: &[],
    rival: Some(rival),
};

const PRESSED: Example = Example {
    path: "data/membrane/y_shape_1.toml",
    sample: include_str!("../../../data/membrane/y_shape_1.toml"),
    cloud_path: "data/membrane/y_shape_1_cloud_1.ply",
    cloud: include_bytes!("../../../data/membrane/y_shape_1_cloud_1.ply"),
    truth_path: "data/membrane/y_shape_1_truth.csv",
    truth: include_bytes!("../../../data/membrane/y_shape_1_truth.csv"),
};

const INFLATED: Example = Example {
    path: "data/membrane/inflated_1.toml",
    sample: include_str!("../../../data/membrane/inflated_1.toml"),
    cloud_path: "data/membrane/inflated_1_cloud_2.ply",
    cloud: include_bytes!("../../../data/membrane/inflated_1_cloud_2.ply"),
    truth_path: "data/membrane/inflated_1_truth.csv",
    truth: include_bytes!("../../../data/membrane/inflated_1_truth.csv"),
};

/// Reads what is asked for and binds a scene to it.
pub(crate) fn prepare(entry: &Entry, request: &Request) -> Result<Prepared, PrepareError> {
    inflated::prepare(&THEORY, entry, request)
}

/// The spline of the cloud with the operator: the rim is known to be at rest.
fn rival(given: &Given<'_>, observed: &Observed, axes: [f64; 2]) -> Result<ContactRival, PrepareError> {
    let value = |name| Ok::<_, PrepareError>(given.of(name)?.unwrap_or(f64::NAN));
    let (young, nu, thickness, pressure) = (value("E")?, value("nu")?, value("t")?, value("p")?);
    let rim = Domain::ellipse([0.0, 0.0], axes)?.boundary(POINTS.2);
    let mut points = observed.cloud.points.clone();
    points.extend(rim.iter().map(|point| [point[0], point[1], 0.0]));
    let tensions = inflated_tensions(young, nu, thickness, axes, pressure);
    // Only a table for people shows it: whoever asks for JSON does not wait for it.
    let fit = OnceCell::new();
    let pressure = move |at: &[f64]| {
        let fit = fit.get_or_init(|| CloudFit::new(points.clone(), axes[0]));
        pressure_by_operator(fit, tensions, pressure, at.as_chunks::<2>().0)
    };
    Ok(ContactRival { name: "spline of the cloud", pressure: Box::new(pressure) })
}
