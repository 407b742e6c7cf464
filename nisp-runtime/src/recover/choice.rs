//! Which carrier a problem gets, and why: the one place that chooses.

use super::settings::{Carrier, Optimizer, Settings};
use crate::local::Local;
use crate::noise;
use crate::problem::Bound;
use crate::splines;

/// Numbers that describe an observed quantity, of which a small network holds no more: twenty periods of a wave and some.
const RICH: f64 = 60.0;
/// Rows from which on a network takes longer than anybody waits.
const MANY: usize = 5000;

/// A carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Chosen {
    Network,
    Splines,
    Local(Local),
}

impl Chosen {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Network => "network",
            Self::Splines => "splines",
            Self::Local(_) => "local functions",
        }
    }
}

/// The carrier of a problem, and why in a sentence for the user.
pub(super) fn of(bound: &Bound, settings: &Settings) -> (Chosen, String) {
    let asked = |chosen| (chosen, "asked for".to_string());
    match settings.carrier {
        Carrier::Network => asked(Chosen::Network),
        Carrier::Splines => asked(Chosen::Splines),
        Carrier::Local(local) => (Chosen::Local(local), "the scene has edges, which they know".into()),
        Carrier::Auto if settings.optimizer != Optimizer::Auto => {
            (Chosen::Network, format!("{} trains networks", settings.optimizer.name()))
        }
        Carrier::Auto => by_data(bound),
    }
}

/// Splines for records that are too long or too rich for a small network.
fn by_data(bound: &Bound) -> (Chosen, String) {
    let schema = bound.problem.scene().schema;
    if let Some(what) = splines::refused(schema) {
        return (Chosen::Network, format!("splines over time do not do {what}"));
    }
    let measured = schema.groups.iter().zip(&bound.coordinates).filter(|(group, _)| !group.columns.is_empty());
    let rows = measured.map(|(_, points)| points.len()).max().unwrap_or(0);
    if rows > MANY {
        return (Chosen::Splines, format!("{rows} rows are more than a network is quick with"));
    }
    let rich = splines::richness(bound, &noise::estimate(bound));
    if rich > RICH {
        (Chosen::Splines, format!("it takes {rich:.0} numbers to describe the data, more than a small network holds"))
    } else {
        (Chosen::Network, format!("{rich:.0} numbers describe the data: a small network holds them"))
    }
}
