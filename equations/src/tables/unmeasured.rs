//! Points of groups for which nothing was measured.

use std::path::Path;

use nisp::Points;
use nisp::network::Stretched;
use nisp::schema::{Group, Place, Portion, Scene, TermKind};

use crate::error::PrepareError;
use crate::pairs;
use crate::places::{self, Body, Placed};
use crate::request::Request;

/// Places over one coordinate at which the equations are asked to hold.
const COLLOCATION: usize = 300;

/// Points of a group for which nothing was measured.
pub(super) fn unmeasured(
    schema: &Scene,
    group: &Group,
    bounds: &[[f64; 2]],
    folder: &Path,
    request: &Request,
) -> Result<Placed, PrepareError> {
    let is_summed = group.terms.iter().any(|term| term.kind == TermKind::Integral);
    let asked = group.place.as_ref().and_then(|place| places::asked(group, place, &request.points));
    let along = |[first, last]: [f64; 2]| -> Vec<f64> {
        let count = asked.unwrap_or(COLLOCATION).max(2);
        (0..count).map(|i| first + (last - first) * collocation(i, count)).collect()
    };
    let alone = |coordinates: Vec<f64>| Placed { points: coordinates.into(), normals: Vec::new() };
    let mut placed = match (group.place, bounds) {
        (Some(Place { portion: Portion::Inside, domain, .. }), [_]) if !is_summed => {
            let (low, high) = Body::new(domain, schema.coordinates, folder)?.bounds();
            return Ok(alone(along([low[0], high[0]])));
        }
        (Some(place), _) => {
            let body = Body::new(place.domain, schema.coordinates, folder)?;
            let count = asked.unwrap_or_else(|| body.usual(place.portion, group.order));
            let mut placed = body.sample(place.portion, count);
            if group.paired {
                pairs::pair(&mut placed, place.portion, &body.bounds());
            }
            placed
        }
        (None, [range]) if range[0] < range[1] => match group.name {
            "start" => return Ok(alone(vec![range[0]])),
            "end" => return Ok(alone(vec![range[1]])),
            _ => {
                let coordinates = along(*range);
                let weights = if is_summed { trapezoids(&coordinates) } else { Vec::new() };
                return Ok(Placed {
                    points: Points { coordinates, weights, ..Points::default() },
                    normals: Vec::new(),
                });
            }
        },
        (None, _) => {
            let names: Vec<&str> = schema.coordinates.iter().map(|axis| axis.name).collect();
            return Err(PrepareError::Nowhere { group: group.name, coordinates: names.join(", ") });
        }
    };
    if !is_summed {
        placed.points.weights = Vec::new();
    }
    Ok(placed)
}

/// Place `i` of so many collocation points in [0, 1]: half of them spread evenly, half evenly in the logarithm of the distance
/// from the start, as the network sees it.
fn collocation(i: usize, count: usize) -> f64 {
    let ratio = Stretched::default().ratio;
    let share = i as f64 / (count - 1) as f64;
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > f64::EPSILON {
        let middle: f64 = 0.5 * (low + high);
        let so_far = 0.5 * (middle + (ratio * middle).ln_1p() / ratio.ln_1p());
        *(if so_far < share { &mut low } else { &mut high }) = middle;
    }
    high
}

/// What each of several points on a line stands for.
fn trapezoids(points: &[f64]) -> Vec<f64> {
    let last = points.len() - 1;
    let side = |i: usize| points[(i + 1).min(last)] - points[i.saturating_sub(1)];
    (0..points.len()).map(|i| side(i) / 2.0).collect()
}
