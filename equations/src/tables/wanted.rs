//! Where an answer is wanted.

use nisp::schema::Scene;
use nisp_data::Table;

use super::read::places;
use super::{Clock, Found};
use crate::error::PrepareError;
use crate::places::Body;
use crate::request::{Request, Wanted};

/// Points of an answer along each coordinate, over one, two, three and more coordinates, where nothing else is wanted.
const GRID: [usize; 4] = [201, 61, 21, 9];

/// Where the answer is wanted.
pub(super) fn wanted(schema: &Scene, found: &Found, clock: Clock, request: &Request) -> Result<Vec<f64>, PrepareError> {
    let axes = schema.coordinates.len();
    let counts = match &request.wanted {
        Some(Wanted::At(path)) => {
            let mut table = Table::read_places(path)?;
            clock.count(&mut table);
            return places(schema, &table, request);
        }
        Some(Wanted::Grid(counts)) if counts.len() == axes => counts.clone(),
        Some(Wanted::Grid(counts)) => {
            let names: Vec<&str> = schema.coordinates.iter().map(|axis| axis.name).collect();
            return Err(PrepareError::Grid { given: counts.len(), coordinates: names.join(", ") });
        }
        None if axes == 1 && !found.places.is_empty() => return Ok(found.places.clone()),
        None => vec![GRID[(axes - 1).min(GRID.len() - 1)]; axes],
    };
    Ok(grid(&counts, &found.bounds, found.body.as_ref()))
}

/// Planes of the first two coordinates: at the start, the middle and the end of the last one, and in the middle of the others.
pub(super) fn planes(schema: &Scene, found: &Found) -> Vec<(String, Vec<f64>)> {
    let Some((last, [low, high])) = schema.coordinates.iter().zip(&found.bounds).skip(2).last() else {
        return Vec::new();
    };
    let plane = |share: f64| {
        let at = low + share * (high - low);
        let mut bounds = found.bounds.clone();
        bounds.iter_mut().skip(2).for_each(|[low, high]| [*low, *high] = [(*low + *high) / 2.0; 2]);
        if let Some(range) = bounds.last_mut() {
            *range = [at; 2];
        }
        let counts: Vec<usize> = (0..bounds.len()).map(|axis| if axis < 2 { GRID[1] } else { 1 }).collect();
        (format!("{} = {at} {}", last.name, last.unit.text), grid(&counts, &bounds, found.body.as_ref()))
    };
    [0.0, 0.5, 1.0].map(plane).into()
}

/// A grid of points, the first coordinate running fastest, as far as it lies within the body.
fn grid(counts: &[usize], bounds: &[[f64; 2]], body: Option<&Body>) -> Vec<f64> {
    let total: usize = counts.iter().product();
    let point = |index: usize| -> Vec<f64> {
        let mut rest = index;
        let along = counts.iter().zip(bounds).map(|(count, [low, high])| {
            let at = rest % count;
            rest /= count;
            low + (high - low) * if *count > 1 { at as f64 / (count - 1) as f64 } else { 0.5 }
        });
        along.collect()
    };
    (0..total).map(point).filter(|point| body.is_none_or(|body| body.contains(point))).flatten().collect()
}
