//! Maps over two coordinates: of a plane, of planes through more coordinates, or of what depends on two of these alone.

use nisp::schema::Scene;
use nisp::{Estimate, Solution};
use nisp_data::DataError;
use nisp_data::colour::ColourScale;
use nisp_data::picture::{FieldMap, Grid, MapPanel, Picture, Quantity, field_map};
use nisp_equations::Prepared;

use super::{range, subtitle, title};

/// Points of a map at least.
const FEWEST: usize = 4;
/// Points along each side of a map whose points nobody asked for.
const SIDE: usize = 61;
/// Maps side by side at most.
const PANELS: usize = 3;
/// Places of measurements that are marked at most: more would hide what is below them.
const MARKS: usize = 400;

/// The coordinates of a map of what depends on two of several alone: the first source, or the first field if there is none.
fn axes(scene: &Scene) -> Option<[usize; 2]> {
    let first = scene.heads.iter().position(|head| head.source).unwrap_or(0);
    <[usize; 2]>::try_from(scene.axes(first)).ok().filter(|_| scene.coordinates.len() > 2)
}

/// Points of such a map, on a grid, halfway between the ends of the other coordinates; none for other maps.
pub(super) fn points(prepared: &Prepared, scene: &Scene) -> Vec<f64> {
    let Some(axes) = axes(scene) else { return Vec::new() };
    // These lie within the body.
    if let ([0, 1], [_, (_, middle), ..]) = (axes, prepared.planes.as_slice()) {
        return middle.clone();
    }
    let ranges: Vec<[f64; 2]> = (0..scene.coordinates.len()).map(|at| range(prepared, scene, at)).collect();
    let point = |index: usize| {
        let share = |axis: usize| match axes.iter().position(|own| *own == axis) {
            Some(0) => (index % SIDE) as f64 / (SIDE - 1) as f64,
            Some(_) => (index / SIDE) as f64 / (SIDE - 1) as f64,
            None => 0.5,
        };
        let at = |(axis, [low, high]): (usize, &[f64; 2])| low + (high - low) * share(axis);
        ranges.iter().enumerate().map(at).collect::<Vec<_>>()
    };
    (0..SIDE * SIDE).flat_map(point).collect()
}

/// Sources, or fields if there are none: a lone one beside its truth where that is known, or else beside its deviation. Over
/// three coordinates and more, what depends on two of them alone is drawn over these, and anything else on planes; `drawn` is
/// the answer at [`points`].
pub(super) fn draw(
    prepared: &Prepared,
    solution: &Solution,
    estimates: &[Estimate],
    (points, drawn): (&[f64], &[Estimate]),
) -> Result<Picture, DataError> {
    let scene = solution.scene();
    let is_shown = |estimate: &&Estimate| estimate.source == estimates.iter().any(|estimate| estimate.source);
    let shown: Vec<&Estimate> = estimates.iter().filter(is_shown).take(PANELS).collect();
    let panels = match (axes(scene), shown.as_slice()) {
        (_, []) => Vec::new(),
        (Some(axes), _) => {
            let first = drawn.iter().find(is_shown);
            let panels = first.map(|first| beside_truth(prepared, solution, (first, points), axes)).transpose()?;
            return map(prepared, solution, axes, panels.unwrap_or_default());
        }
        (None, [first]) if scene.coordinates.len() == 2 => {
            beside_truth(prepared, solution, (first, &prepared.points), [0, 1])?
        }
        (None, _) if scene.coordinates.len() == 2 => side_by_side(prepared, &shown)?,
        (None, [first, ..]) => planes(prepared, solution, first)?,
    };
    map(prepared, solution, [0, 1], panels)
}

/// Several over a plane region.
fn side_by_side(prepared: &Prepared, shown: &[&Estimate]) -> Result<Vec<MapPanel>, DataError> {
    let (points, _) = prepared.points.as_chunks::<2>();
    let panel = |estimate: &&Estimate| {
        let scale = ColourScale::sequential(&estimate.values);
        let value = Quantity::new(estimate.name, estimate.unit.text);
        Ok(panel("estimate", value, Grid::from_points(points, &estimate.values)?, scale))
    };
    shown.iter().map(panel).collect()
}

/// An estimate at points, beside its truth where that is known, or else beside its deviation where it has one.
fn beside_truth(
    prepared: &Prepared,
    solution: &Solution,
    (estimate, points): (&Estimate, &[f64]),
    axes: [usize; 2],
) -> Result<Vec<MapPanel>, DataError> {
    let places = flat(points, solution.scene().coordinates.len(), axes);
    let quantity = |name: &str| Quantity::new(name, estimate.unit.text);
    let truth = prepared.truth.as_ref();
    if let Some((truth, real)) = truth.and_then(|truth| Some((truth, truth.of(estimate.name)?))) {
        let at = flat(&truth.points, solution.scene().coordinates.len(), axes);
        let scale = ColourScale::sequential(&shown_with(real, &estimate.values));
        let panels = compared(solution, (estimate, &places), (&truth.points, &at, real), scale)?;
        return Ok(panels.into());
    }
    let grid = Grid::from_points(&places, &estimate.values)?;
    let own = panel("estimate", quantity(estimate.name), grid, ColourScale::sequential(&estimate.values));
    let deviation = estimate.deviations.as_ref().map(|deviations| {
        let value = quantity(&format!("{}_sd", estimate.name));
        Ok(panel("deviation", value, Grid::from_points(&places, deviations)?, ColourScale::from_zero(deviations)))
    });
    Ok(std::iter::once(own).chain(deviation.transpose()?).collect())
}

/// An estimate over planes of the first two coordinates.
fn planes(prepared: &Prepared, solution: &Solution, shown: &Estimate) -> Result<Vec<MapPanel>, DataError> {
    let axes = solution.scene().coordinates.len();
    let drawn = prepared.planes.iter().map(|(title, points)| {
        let found = solution.evaluate(points).into_iter().find(|estimate| estimate.name == shown.name);
        found.map(|estimate| (title, estimate, flat(points, axes, [0, 1])))
    });
    // A plane may only touch the body.
    let drawn: Vec<_> = drawn.flatten().filter(|(_, _, places)| places.len() >= FEWEST).collect();
    let values: Vec<f64> = drawn.iter().flat_map(|(_, estimate, _)| estimate.values.iter().copied()).collect();
    // One scale for all, so that they can be compared.
    let scale = ColourScale::sequential(&values);
    let panels = drawn.iter().map(|(title, estimate, places)| {
        let value = Quantity::new(estimate.name, estimate.unit.text);
        Ok(panel(title, value, Grid::from_points(places, &estimate.values)?, scale))
    });
    panels.collect()
}

/// An estimate, the truth in the same colours, and what the estimate is off by; the truth with its points, in full and in the
/// plane of the picture.
pub(super) fn compared(
    solution: &Solution,
    (estimate, places): (&Estimate, &[[f64; 2]]),
    (points, at, real): (&[f64], &[[f64; 2]], &[f64]),
    scale: ColourScale,
) -> Result<[MapPanel; 3], DataError> {
    let again = solution.evaluate(points).into_iter().find(|again| again.name == estimate.name);
    let found = again.iter().flat_map(|found| &found.values);
    let error: Vec<f64> = found.zip(real).map(|(found, real)| found - real).collect();
    // One wild point must not leave the rest of the error without a colour.
    let most = real.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let clamped: Vec<f64> = error.iter().map(|error| error.clamp(-most, most)).collect();
    let quantity = |name: &str| Quantity::new(name, estimate.unit.text);
    let difference = quantity(&format!("error of {}", estimate.name));
    Ok([
        panel("estimate", quantity(estimate.name), Grid::from_points(places, &estimate.values)?, scale),
        panel("truth", quantity(estimate.name), Grid::from_points(at, real)?, scale),
        panel("error", difference, Grid::from_points(at, &error)?, ColourScale::diverging(&clamped)),
    ])
}

/// Values that a scale of colours shows beside a truth: those of the estimate, too, but for wild ones.
fn shown_with(real: &[f64], found: &[f64]) -> Vec<f64> {
    let (low, high) = real.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (x.min(l), x.max(h)));
    let range = high - low;
    real.iter().copied().chain(found.iter().map(|value| value.clamp(low - range, high + range))).collect()
}

/// Panels over two coordinates.
pub(super) fn map(
    prepared: &Prepared,
    solution: &Solution,
    axes: [usize; 2],
    panels: Vec<MapPanel>,
) -> Result<Picture, DataError> {
    let scene = solution.scene();
    let [x, y] = axes.map(|at| Quantity::new(scene.coordinates[at].name, scene.coordinates[at].unit.text));
    field_map(&FieldMap {
        title: title(solution),
        subtitle: subtitle(prepared, solution),
        x,
        y,
        outline: if axes == [0, 1] { prepared.outline.clone() } else { Vec::new() },
        marks: marks(prepared, scene.coordinates.len(), axes),
        panels,
    })
}

/// Where was measured, unless it was nearly everywhere.
fn marks(prepared: &Prepared, count: usize, axes: [usize; 2]) -> Vec<[f64; 2]> {
    let mut places: Vec<[f64; 2]> =
        prepared.measured.iter().flat_map(|measured| flat(&measured.at, count, axes)).collect();
    places.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    places.dedup();
    if places.len() > MARKS { Vec::new() } else { places }
}

/// Two coordinates of points of several.
fn flat(points: &[f64], count: usize, [x, y]: [usize; 2]) -> Vec<[f64; 2]> {
    points.chunks_exact(count).map(|point| [point[x], point[y]]).collect()
}

/// A panel without level lines.
pub(super) fn panel(title: &str, value: Quantity, grid: Grid, scale: ColourScale) -> MapPanel {
    MapPanel { title: title.into(), value, grid, scale, contours: Vec::new() }
}
