//! What measurements look like before anything is solved: how noisy they are, which values stand alone, and how their places lie in
//! the domain that the equation declares.

mod cover;
mod fit;
mod strays;

use std::path::Path;

use nisp::noise;
use nisp::schema::{Coordinate, Group, Portion, TermKind};

use crate::entry::{Binding, Entry};
use crate::places::Body;
use crate::prepared::Prepared;
use crate::rivals::noise_level;

/// The places of a group's rows.
pub struct Survey<'a> {
    coordinates: &'static [Coordinate],
    /// Point by point, in declared units.
    pub points: &'a [f64],
    /// What the equation declares, if it does.
    domain: Option<Body>,
    /// True where measurements are made, and not only conditions stated.
    is_measured: bool,
}

impl<'a> Survey<'a> {
    /// Of a group that has points.
    pub fn of(entry: &Entry, prepared: &'a Prepared, group: &Group) -> Option<Self> {
        let schema = prepared.problem.scene().schema;
        let (points, _) = prepared.problem.group(group.name)?;
        let folder = match entry.binding {
            Binding::Tables(folder) => folder,
            _ => Path::new(""),
        };
        let places = || schema.groups.iter().filter_map(|group| group.place);
        let inside = || places().find(|place| place.portion == Portion::Inside);
        let place = group.place.or_else(inside).or_else(|| places().next());
        let domain = place.and_then(|place| Body::new(place.domain, schema.coordinates, folder).ok());
        let is_measured = group.terms.iter().any(|term| term.kind == TermKind::Observation);
        Some(Self { coordinates: schema.coordinates, points: &points.coordinates, domain, is_measured })
    }

    /// The values of a coordinate.
    pub fn axis(&self, at: usize) -> impl Iterator<Item = f64> + '_ {
        self.points.iter().skip(at).step_by(self.coordinates.len()).copied()
    }

    /// The declared range of a coordinate.
    pub fn declared(&self, at: usize) -> Option<[f64; 2]> {
        let (low, high) = self.domain.as_ref()?.bounds();
        Some([*low.get(at)?, *high.get(at)?])
    }

    /// The standard deviation of the noise of a column, NaN where nothing was measured; nothing where there is none to speak of, or
    /// too few values to judge.
    pub fn noise(&self, column: &[f64]) -> Option<f64> {
        let (places, values) = self.measured(column);
        let found = match self.coordinates.len() {
            // A classical smoother does with few values, and takes a course that it cannot follow for no noise at all.
            1 => noise_level(&places, &values).ok()?,
            axes => noise::of_values(&places, axes, &values, false)?,
        };
        (!noise::is_exact(found, noise::deviation(&values))).then_some(found)
    }

    /// Values of a column that stand alone, far off all their neighbours, in words.
    pub fn strays(&self, column: &[f64]) -> Option<String> {
        let (places, values) = self.measured(column);
        let found = strays::find(&places, self.coordinates.len(), &values, self.noise(column).unwrap_or(0.0));
        let farthest = found.iter().max_by(|a, b| a.off.total_cmp(&b.off))?;
        let axes = self.coordinates.len();
        // From shares of the ranges back to the coordinates.
        let place = self.rows(column).nth(farthest.at).map(|row| &self.points[row * axes..][..axes])?;
        let count = if found.len() == 1 { "1 value stands".into() } else { format!("{} values stand", found.len()) };
        Some(format!("{count} alone, {} at {}", short(values[farthest.at]), self.place(place)))
    }

    /// What is to be said of the places: how much of the domain they cover, and what may be wrong with them.
    pub fn notes(&self) -> Vec<String> {
        if !self.is_measured {
            return Vec::new();
        }
        let mut notes = self.questions();
        if notes.is_empty() {
            notes.extend(cover::notes(self));
        }
        notes.extend(self.twice());
        notes
    }

    /// What may be wrong with the places: another unit, swapped columns, rows outside of the domain.
    pub fn questions(&self) -> Vec<String> {
        if self.is_measured { fit::notes(self) } else { Vec::new() }
    }

    /// Rows that are measured.
    fn rows<'b>(&self, column: &'b [f64]) -> impl Iterator<Item = usize> + use<'b> {
        column.iter().enumerate().filter(|(_, value)| !value.is_nan()).map(|(row, _)| row)
    }

    /// Places, as shares of the range of each coordinate, and values of the rows that are measured.
    fn measured(&self, column: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let axes = self.coordinates.len();
        let ranges: Vec<[f64; 2]> = (0..axes).map(|at| range(self.axis(at))).collect();
        let share = |at: usize, x: f64| {
            let [low, high] = ranges[at];
            if high > low { (x - low) / (high - low) } else { 0.0 }
        };
        let place = |row: usize| (0..axes).map(move |at| (at, self.points[row * axes + at]));
        let places = self.rows(column).flat_map(|row| place(row).map(|(at, x)| share(at, x)).collect::<Vec<f64>>());
        (places.collect(), self.rows(column).map(|row| column[row]).collect())
    }

    /// That some rows share their place.
    fn twice(&self) -> Option<String> {
        let mut all: Vec<Vec<u64>> =
            self.points.chunks_exact(self.coordinates.len()).map(|p| p.iter().map(|x| x.to_bits()).collect()).collect();
        let rows = all.len();
        all.sort_unstable();
        all.dedup();
        (all.len() < rows).then(|| format!("{} of {rows} rows are at places of other rows", rows - all.len()))
    }

    /// A place in words.
    pub fn place(&self, point: &[f64]) -> String {
        let named = self.coordinates.iter().zip(point);
        let named = named.map(|(c, x)| format!("{} = {} {}", c.name, short(*x), c.unit.text).trim_end().to_string());
        named.collect::<Vec<_>>().join(", ")
    }
}

/// The least and the greatest of some numbers.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// Three digits.
fn short(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
