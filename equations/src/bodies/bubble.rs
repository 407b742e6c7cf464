//! The bubble: an inflated membrane of large strains.

use nisp::local::Patches;

use super::inflated;
use super::inflated::Theory;
use super::observed::Example;
use crate::PrepareError;
use crate::contact::{Load, Rule};
use crate::entry::Entry;
use crate::prepared::Prepared;
use crate::request::Request;

const THEORY: Theory = Theory {
    pressed: PRESSED,
    inflated: INFLATED,
    load: Load::Follower,
    // A convex tool that lies on the bubble presses back at least as much as the gas does.
    rule: |gauge| Rule { least: 0.5 * gauge, of_mean: 0.0 },
    // A flat tool presses with the gauge pressure over a wide area. Its disc should not cost more than a narrow ring of higher
    // pressure. `level` is set from the gauge pressure.
    patches: Patches { level: f64::NAN, edges: 0.15, area: 0.75, end: 0.45 },
    // Their `f` is per area at rest, and vertical.
    rather: &[("f", "p_contact")],
    rival: None,
};

const PRESSED: Example = Example {
    path: "data/membrane_large/large_sphere_d35.toml",
    sample: include_str!("../../../data/membrane_large/large_sphere_d35.toml"),
    cloud_path: "data/membrane_large/large_sphere_d35_cloud_2.ply",
    cloud: include_bytes!("../../../data/membrane_large/large_sphere_d35_cloud_2.ply"),
    truth_path: "data/membrane_large/large_sphere_d35_truth.csv",
    truth: include_bytes!("../../../data/membrane_large/large_sphere_d35_truth.csv"),
};

const INFLATED: Example = Example {
    path: "data/membrane_large/large_inflated_1.toml",
    sample: include_str!("../../../data/membrane_large/large_inflated_1.toml"),
    cloud_path: "data/membrane_large/large_inflated_1_cloud_2.ply",
    cloud: include_bytes!("../../../data/membrane_large/large_inflated_1_cloud_2.ply"),
    truth_path: "data/membrane_large/large_inflated_1_truth.csv",
    truth: include_bytes!("../../../data/membrane_large/large_inflated_1_truth.csv"),
};

/// Reads what is asked for and binds a scene to it.
pub(crate) fn prepare(entry: &Entry, request: &Request) -> Result<Prepared, PrepareError> {
    inflated::prepare(&THEORY, entry, request)
}
