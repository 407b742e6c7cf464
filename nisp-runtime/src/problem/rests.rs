//! Where measured quantities would be if nothing changed and no source acted: what equations and conditions compare them with.

use super::probe::{Data, Probe};
use super::{BindError, Bound, Problem, Rest};
use crate::ends::ends;
use crate::network::Inputs;
use crate::schema::{self, Column, Jet, Origin, Term, TermKind};
use crate::units::{Number, Si};

/// Network output that puts a bounded quantity on its bound.
const ON_BOUND: f64 = -40.0;
/// Newton steps to a root, at most: a fourth power that starts a thousand times too high takes some thirty.
const STEPS: usize = 60;
/// Last step to a root, as a share of it.
const CLOSE: f64 = 1e-9;
/// Share of the least and of the greatest measurements that do not count: there are strays.
const TAIL: f64 = 0.1;

impl Problem {
    /// Where conditions hold the quantities that are measured directly. A condition that reads a field that is not measured, or
    /// an unknown of the same unit, holds nothing.
    ///
    /// # Errors
    /// A problem that is not fully or not sensibly bound.
    pub fn rests(&self) -> Result<Vec<Rest>, BindError> {
        let bound = self.bound(Inputs::Automatic)?;
        let schema = bound.problem.scene().schema;
        let probes = probes(&bound);
        let groups = || schema.groups.iter().enumerate().filter(|(_, group)| !group.is_beliefs());
        let terms = groups().flat_map(|(at, group)| group.terms.iter().map(move |term| (at, term)));
        let read = |(at, term)| readings(&bound, at, term).unwrap_or_default();
        let readings: Vec<Reading> = terms.clone().flat_map(read).collect();
        let mut rests: Vec<Rest> = readings.iter().filter_map(|reading| bounds(&bound, reading)).collect();
        let gauge = |reading| gauge(&bound, &probes, reading);
        let gauges: Vec<Gauge> = readings.into_iter().filter_map(gauge).collect();
        for (at, term) in terms.filter(|(_, term)| term.kind == TermKind::Residual) {
            let at = Place { bound: &bound, probe: &probes[at], group: at };
            for row in term.first..term.first + term.rows {
                rests.extend(gauges.iter().filter_map(|gauge| at.rest(term, row, gauge, &gauges)));
            }
        }
        Ok(rests)
    }
}

/// The programs of all groups at a sample of their points.
fn probes(bound: &Bound) -> Vec<Probe> {
    let Bound { problem, coordinates, partners, columns, clouds, .. } = bound;
    let scene = problem.scene();
    let data = Data { coordinates, partners, columns, clouds };
    let groups = scene.double().into_iter().zip(scene.schema.groups).enumerate();
    groups.map(|(at, (kernel, group))| Probe::new(kernel, group, data, at, scene.schema.coordinates.len())).collect()
}

/// A column that measures one head and nothing else.
struct Reading {
    group: usize,
    row: usize,
    head: usize,
    column: &'static Column,
    /// In the column's unit.
    measured: [f64; 2],
    least: f64,
    /// The mean of all measurements, in the engine's units.
    mean: f64,
}

/// The columns of an observation that reads the value of one head; nothing where it reads more, or nothing was measured.
fn readings(bound: &Bound, group: usize, term: &'static Term) -> Option<Vec<Reading>> {
    let own = &bound.problem.scene().schema.groups[group];
    let [jet] = *term.jets else { return None };
    let jet = Some(&own.jets[jet]).filter(|jet| term.kind == TermKind::Observation && jet.is_value())?;
    let reading = |(&at, row): (&usize, usize)| {
        let column = &own.columns[at];
        let mut values = bound.measured(group, term, &bound.columns[group][at]);
        values.sort_by(f64::total_cmp);
        let last = values.len().checked_sub(1)?;
        let tail = (TAIL * values.len() as f64) as usize;
        let outward = bound.system.outward(&column.unit);
        let [low, high, least] = [tail, last - tail, 0].map(|at| outward.of(Number::engine(values[at])).as_declared());
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        Some(Reading { group, row, head: jet.head, column, measured: [low, high], least, mean })
    };
    term.columns.iter().zip(term.first..).map(reading).collect()
}

/// The bounds of a head that is observed by itself.
fn bounds(bound: &Bound, reading: &Reading) -> Option<Rest> {
    let head = &bound.problem.scene().schema.heads[reading.head];
    if head.lower.is_none() && head.upper.is_none() || head.unit.exponents != reading.column.unit.exponents {
        return None;
    }
    let declared = |end: Number<Si>| reading.column.unit.factor.back(end).as_declared();
    let at = [head.lower.map_or(f64::NEG_INFINITY, declared), head.upper.map_or(f64::INFINITY, declared)];
    Some(Rest { by: None, column: reading.column, measured: reading.measured, least: reading.least, at })
}

/// A reading of a head's value.
struct Gauge {
    reading: Reading,
    /// The group's programs with nothing measured: rows are what would be.
    probe: Probe,
    /// The jet's value at the mean of the measurements.
    mean: f64,
}

/// The gauge of a reading; nothing where the head does not reach the mean of the measurements, or is not plain.
fn gauge(bound: &Bound, probes: &[Probe], reading: Reading) -> Option<Gauge> {
    let heads = bound.problem.scene().schema.heads;
    let probe = probes[reading.group].without_columns();
    let start = vec![0.0; heads.len()];
    let found = roots(bound, &probe, (reading.row, reading.head), &start, reading.mean);
    let mean = found.into_iter().next().flatten().filter(|_| !heads[reading.head].hard)?;
    Some(Gauge { reading, probe, mean })
}

/// A group whose conditions are looked at.
struct Place<'a> {
    bound: &'a Bound,
    probe: &'a Probe,
    group: usize,
}

impl Place<'_> {
    /// Where a row holds what a gauge measures; nothing where it does not.
    fn rest(&self, term: &'static Term, row: usize, gauge: &Gauge, gauges: &[Gauge]) -> Option<Rest> {
        let scene = self.bound.problem.scene().schema;
        let group = &scene.groups[self.group];
        let mean = |head: usize| gauges.iter().find(|gauge| gauge.reading.head == head).map(|gauge| gauge.mean);
        let still = |head: usize| match (mean(head), &scene.heads[head]) {
            (Some(mean), _) => mean,
            (None, head) if head.source && head.transformed => ON_BOUND,
            _ => 0.0,
        };
        let values: Vec<f64> = (0..scene.heads.len()).map(still).collect();
        let bars = self.probe.sensitivities(row, &jets(self.probe, &values, None), &self.bound.scalars);
        let is_read = |at: usize| self.probe.rms(&bars[at * self.probe.stride..]) > 0.0;
        let Reading { row: observed, head: own, column, measured, least, .. } = gauge.reading;
        let is_like = |unit: &schema::Unit| unit.exponents == column.unit.exponents;
        let is_open = |(at, jet): (usize, &Jet)| {
            let head = &scene.heads[jet.head];
            jet.is_value() && mean(jet.head).is_none() && (!head.source || is_like(&head.unit)) && is_read(at)
        };
        let is_learned = |(slot, scalar): (usize, &schema::Scalar)| {
            matches!(scalar.origin, Origin::Learned { .. }) && is_like(&scalar.unit) && is_read(group.jets.len() + slot)
        };
        let is_held = term.jets.iter().any(|&at| group.jets[at].head == own && group.jets[at].is_value());
        if !is_held || group.jets.iter().enumerate().any(is_open) || scene.scalars.iter().enumerate().any(is_learned) {
            return None;
        }
        let outward = self.bound.system.outward(&column.unit);
        let at = roots(self.bound, self.probe, (row, own), &values, 0.0).into_iter().flatten();
        let at = at.filter_map(|root| {
            let mut values = values.clone();
            values[own] = root;
            let rows = gauge.probe.rows(&jets(&gauge.probe, &values, None), &self.bound.scalars, false);
            Some(outward.of(Number::engine(*rows.get(observed * gauge.probe.stride)?)).as_declared())
        });
        let at: [f64; 2] = ends(at).into();
        let rest = Rest { by: Some((group.name, term.name)), column, measured, least, at };
        at.iter().all(|x| x.is_finite()).then_some(rest)
    }
}

/// Jets of heads that are so large, by head, and do not change; one head may differ from point to point.
fn jets(probe: &Probe, values: &[f64], own: Option<(usize, &[f64])>) -> Vec<f64> {
    let mut jets = probe.jets(|jet| if jet.is_value() { values[jet.head] } else { 0.0 });
    if let Some((head, own)) = own {
        let all = jets.chunks_exact_mut(probe.stride).zip(probe.schema.jets);
        all.filter(|(_, jet)| jet.head == head && jet.is_value()).for_each(|(jets, _)| jets.copy_from_slice(own));
    }
    jets
}

/// The values of a head at which a row is `target`, point by point, by Newton's steps from its value among those of all heads;
/// nothing where they do not come to an end.
fn roots(bound: &Bound, probe: &Probe, (row, head): (usize, usize), values: &[f64], target: f64) -> Vec<Option<f64>> {
    let mut found = vec![values[head]; probe.stride];
    let mut steps = vec![f64::INFINITY; probe.stride];
    for _ in 0..STEPS {
        let jets = jets(probe, values, Some((head, &found)));
        let left = probe.rows(&jets, &bound.scalars, false);
        let bars = probe.sensitivities(row, &jets, &bound.scalars);
        let own = || probe.schema.jets.iter().enumerate().filter(|(_, jet)| jet.head == head && jet.is_value());
        for (at, (found, step)) in found.iter_mut().zip(&mut steps).enumerate() {
            let slope: f64 = own().map(|(jet, _)| bars[jet * probe.stride + at]).sum();
            *step = (left[row * probe.stride + at] - target) / slope;
            *found -= *step;
        }
        // A step that is no number leads nowhere.
        let goes_on = |(step, found): (&f64, &f64)| step.abs() > CLOSE * found.abs();
        if !steps.iter().zip(&found).any(goes_on) {
            break;
        }
    }
    let ended = |(found, step): (f64, f64)| (step.abs() <= CLOSE * found.abs()).then_some(found);
    found.into_iter().zip(steps).take(probe.count).map(ended).collect()
}
