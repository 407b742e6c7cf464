//! Which carrier a problem gets, and why: the one place that chooses.

use super::carried;
use super::network::Network;
use super::on_lattice::OnLattice;
use super::on_splines::OnSplines;
use super::settings::{Carrier, Optimizer, Settings};
use crate::local::{Local, smooth};
use crate::noise;
use crate::problem::Bound;
use crate::schema::Scene;
use crate::solve::state::State;
use crate::splines;

/// Rows from which on a network takes longer than anybody waits.
const MANY: usize = 5000;

/// Share of the budget that a lattice may take where a network can be tried after it.
const FIRST: f64 = 0.5;

/// Which carrier: the only place that tells them apart.
#[derive(Clone, Copy, PartialEq)]
enum Chosen {
    Network,
    /// Over one coordinate.
    Splines,
    /// Splines over several coordinates.
    Lattice,
    Local(Local),
}

/// A carrier and a start, and why in a sentence for the user.
pub(super) struct Attempt {
    pub(super) carrier: Box<dyn carried::Carrier>,
    pub(super) seed: u64,
    pub(super) why: String,
    /// The share of the budget that it may take.
    pub(super) share: f64,
}

impl Attempt {
    fn new(chosen: Chosen, seed: u64, why: String) -> Self {
        let carrier: Box<dyn carried::Carrier> = match chosen {
            Chosen::Network => Box::new(Network),
            Chosen::Splines => Box::new(OnSplines),
            Chosen::Lattice => Box::new(OnLattice),
            Chosen::Local(local) => Box::new(local),
        };
        Self { carrier, seed, why, share: 1.0 }
    }
}

/// What a problem is solved with first, and what is tried where the answer is not sound and time is left. A saved run goes on
/// with what it had.
pub(super) fn attempts(bound: &Bound, settings: &Settings, from: Option<&State>) -> (Attempt, Vec<Attempt>) {
    let seed = settings.seed;
    let (chosen, why) = of(bound, settings);
    let saved = |state: &State| match (state.method.as_str(), chosen) {
        (splines::METHOD, _) => Chosen::Splines,
        (smooth::METHOD, _) => Chosen::Lattice,
        (_, Chosen::Splines | Chosen::Lattice) => Chosen::Network,
        (_, chosen) => chosen,
    };
    if let Some(chosen) = from.map(saved) {
        return (Attempt::new(chosen, seed, why), Vec::new());
    }
    let is_measured = !bound.problem.scene().schema.observed().is_empty();
    let after = |what: &str| format!("what was tried first ended inconsistent; {what}");
    let network = |seed: u64, what: &str| Attempt::new(Chosen::Network, seed, after(what));
    let is_free = settings.carrier == Carrier::Auto && settings.optimizer == Optimizer::Auto;
    let can_splines = beyond_splines(bound.problem.scene().schema).is_none();
    let others = match chosen {
        _ if !is_free => Vec::new(),
        Chosen::Lattice if !is_measured => vec![network(seed, "a network instead of splines")],
        Chosen::Local(_) | Chosen::Lattice => Vec::new(),
        Chosen::Splines if most_rows(bound) > MANY => Vec::new(),
        Chosen::Splines => vec![network(seed, "a network instead of splines")],
        Chosen::Network if can_splines => {
            vec![Attempt::new(Chosen::Splines, seed, after("splines instead of a network"))]
        }
        Chosen::Network => vec![network(seed.wrapping_add(1), "another seed")],
    };
    // For a thin layer a lattice gets finer and finer. A network may follow the layer.
    let share = if chosen == Chosen::Lattice && !others.is_empty() { FIRST } else { 1.0 };
    (Attempt { share, ..Attempt::new(chosen, seed, why) }, others)
}

/// The carrier of a problem, and why.
fn of(bound: &Bound, settings: &Settings) -> (Chosen, String) {
    let asked = |chosen| (chosen, "asked for".to_string());
    match settings.carrier {
        Carrier::Network => asked(Chosen::Network),
        Carrier::Splines if is_for_lattices(bound.problem.scene().schema) => asked(Chosen::Lattice),
        Carrier::Splines => asked(Chosen::Splines),
        Carrier::Local(local) => (Chosen::Local(local), "the scene has edges, which they know".into()),
        Carrier::Auto if settings.optimizer != Optimizer::Auto => {
            (Chosen::Network, format!("{} trains networks", settings.optimizer.name()))
        }
        Carrier::Auto => by_data(bound),
    }
}

/// Rows of the longest record.
fn most_rows(bound: &Bound) -> usize {
    let groups = bound.problem.scene().schema.groups.iter().zip(&bound.coordinates);
    groups.filter(|(group, _)| !group.columns.is_empty()).map(|(_, points)| points.len()).max().unwrap_or(0)
}

/// What splines do not do of a scene; nothing where they carry it unless the settings ask for something else.
pub fn beyond_splines(schema: &Scene) -> Option<&'static str> {
    if is_for_lattices(schema) { smooth::refused(schema) } else { splines::refused(schema) }
}

/// Whether splines of a scene are those on a lattice: over several coordinates, and with what those along a record do not do.
fn is_for_lattices(schema: &Scene) -> bool {
    schema.coordinates.len() > 1 || smooth::is_for_one(schema)
}

/// Splines where they can: a record of any length has an answer in less time than a network takes its first steps. Of a source
/// that is differentiated a network finds far more on short exact records, and hardly more where there is noise.
fn by_data(bound: &Bound) -> (Chosen, String) {
    let schema = bound.problem.scene().schema;
    let is_short_and_exact = || most_rows(bound) <= MANY && !noise::estimate(bound).is_there(schema);
    let differentiated = differentiated(schema).filter(|_| is_short_and_exact());
    match (beyond_splines(schema), schema.coordinates.len(), differentiated) {
        (Some(what), ..) => (Chosen::Network, format!("splines do not do {what}")),
        (None, 1, _) if is_for_lattices(schema) => (Chosen::Lattice, "a cloud, an integral or pairs of points".into()),
        (None, 2.., _) => (Chosen::Lattice, format!("{} coordinates", schema.coordinates.len())),
        (None, _, Some(name)) => {
            (Chosen::Network, format!("`{name}` is differentiated, and the record is short and exact"))
        }
        (None, _, None) => (Chosen::Splines, "one coordinate".into()),
    }
}

/// A source of which an equation reads a derivative.
fn differentiated(schema: &Scene) -> Option<&'static str> {
    let jets = schema.groups.iter().flat_map(|group| group.jets);
    let mut sources = jets.filter(|jet| schema.heads[jet.head].source);
    sources.find(|jet| !jet.is_value()).map(|jet| schema.heads[jet.head].name)
}
