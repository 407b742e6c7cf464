//! Curves over one coordinate: all of a record, or sources that depend on one coordinate alone.

use nisp::schema::Scene;
use nisp::{Estimate, Solution};
use nisp_data::DataError;
use nisp_data::picture::{Curve, LinePanel, LinePlot, Picture, Quantity, line_plot};
use nisp_equations::{Prepared, Truth};

use super::{first_line, range, subtitle, title};

/// Points of a curve: a layer between two measurements shows too.
const CURVE: usize = 600;

/// The coordinate over which curves are drawn: the only one, or the one on which the first source depends.
pub(super) fn axis(scene: &Scene) -> Option<usize> {
    let source = scene.heads.iter().position(|head| head.source);
    match (scene.coordinates.len(), source.map(|source| scene.axes(source)).as_deref()) {
        (1, _) => Some(0),
        (_, Some([axis])) => Some(*axis),
        _ => None,
    }
}

/// Points along a coordinate, halfway between the ends of the others.
pub(super) fn points(prepared: &Prepared, scene: &Scene, axis: usize) -> Vec<f64> {
    let ranges: Vec<[f64; 2]> = (0..scene.coordinates.len()).map(|at| range(prepared, scene, at)).collect();
    let at = |share: f64, [low, high]: [f64; 2]| low + (high - low) * share;
    let point = |i: usize| {
        let share = |own: usize| if own == axis { i as f64 / (CURVE - 1) as f64 } else { 0.5 };
        ranges.iter().enumerate().map(move |(own, range)| at(share(own), *range)).collect::<Vec<_>>()
    };
    (0..CURVE).flat_map(point).collect()
}

/// The heads that depend on a coordinate alone, from estimates at [`points`]; sources first.
pub(super) fn draw(
    prepared: &Prepared,
    solution: &Solution,
    axis: usize,
    (points, curves): (&[f64], &[Estimate]),
) -> Result<Picture, DataError> {
    let scene = solution.scene();
    let axes = scene.coordinates.len();
    let along: Vec<f64> = points.iter().skip(axis).step_by(axes).copied().collect();
    let mut drawn: Vec<_> = scene.heads.iter().zip(curves).enumerate().collect();
    drawn.retain(|(at, _)| scene.axes(*at) == [axis]);
    drawn.sort_by_key(|(_, (head, _))| !head.source);
    let panels = drawn.into_iter().map(|(_, (head, estimate))| {
        let mut panel = LinePanel::new(Quantity::new(estimate.name, estimate.unit.text));
        panel.caption = first_line(head.docs).into();
        let measured = prepared.measured.iter().find(|measured| axes == 1 && measured.name == estimate.name);
        panel.measured = measured.map(|measured| {
            let rows = measured.at.iter().copied().zip(measured.values.iter().copied());
            let (x, y) = rows.filter(|(_, value)| !value.is_nan()).unzip();
            Curve { x, y }
        });
        panel.estimate = Some(Curve::new(&along, &estimate.values));
        panel.deviation.clone_from(&estimate.deviations);
        panel.truth = prepared.truth.as_ref().and_then(|truth| true_curve(truth, estimate.name, (axis, axes)));
        panel
    });
    let x = Quantity::new(scene.coordinates[axis].name, scene.coordinates[axis].unit.text);
    line_plot(&LinePlot { title: title(solution), subtitle: subtitle(prepared, solution), x, panels: panels.collect() })
}

/// The truth of a head along a coordinate of several: once for each place.
fn true_curve(truth: &Truth, head: &str, (axis, axes): (usize, usize)) -> Option<Curve> {
    let mut rows: Vec<(f64, f64)> =
        truth.points.iter().skip(axis).step_by(axes).copied().zip(truth.of(head)?.iter().copied()).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows.dedup_by_key(|row| row.0);
    let (x, y) = rows.into_iter().unzip();
    Some(Curve { x, y })
}
