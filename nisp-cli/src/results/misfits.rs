//! Where an inconsistent answer is off: what is left of every measurement, as a table and as a picture.

use nisp::schema::Scene;
use nisp::{Misfits, Solution};
use nisp_data::colour::ColourScale;
use nisp_data::picture::{
    Curve, FieldMap, Grid, LinePanel, LinePlot, MapPanel, Picture, Quantity, field_map, line_plot,
};
use nisp_data::{DataError, Table};

use super::Answer;

/// Names of the files.
pub(super) const FILES: [&str; 2] = ["misfits.csv", "misfits.svg"];

/// Panels of the picture at most.
const PANELS: usize = 3;

/// Adds the files, where anything was measured.
pub(super) fn show(answer: &mut Answer, solution: &mut Solution) {
    let misfits = solution.misfits();
    if misfits.is_empty() {
        return;
    }
    let scene = solution.scene();
    answer.show(FILES[0], table(scene, &misfits));
    // Over more coordinates there is no picture that shows where it is.
    if let Some(picture) = picture(scene, &misfits) {
        answer.show(FILES[1], picture.map(|picture| picture.svg().into()));
    }
}

/// A row for each measurement, a column for each measured quantity, NaN where a row has another one.
fn table(scene: &Scene, misfits: &[Misfits]) -> Result<Vec<u8>, DataError> {
    let mut table = Table::empty();
    let axes = scene.coordinates.len();
    let places: Vec<f64> = misfits.iter().flat_map(|own| own.points.iter().copied()).collect();
    for (at, axis) in scene.coordinates.iter().enumerate() {
        let values: Vec<f64> = places.iter().skip(at).step_by(axes).copied().collect();
        table.push(axis.name, axis.unit.text, &values)?;
    }
    for own in misfits {
        let part = |other: &Misfits| {
            if std::ptr::eq(own, other) { own.values.clone() } else { vec![f64::NAN; other.values.len()] }
        };
        let values: Vec<f64> = misfits.iter().flat_map(part).collect();
        table.push(&own.name, own.unit.text, &values)?;
    }
    let mut bytes = Vec::new();
    // A vector takes everything.
    let _ = table.write_to(&mut bytes);
    Ok(bytes)
}

/// Misfits over one or two coordinates.
fn picture(scene: &Scene, misfits: &[Misfits]) -> Option<Result<Picture, DataError>> {
    let title = "What is left of the measurements".to_string();
    let subtitle = format!("{}, scene {}: the answer less the measurement", scene.module, scene.name);
    let quantity = |at: usize| Quantity::new(scene.coordinates[at].name, scene.coordinates[at].unit.text);
    let shown = misfits.iter().take(PANELS);
    match scene.coordinates.len() {
        1 => {
            let panels = shown.map(|own| {
                let mut panel = LinePanel::new(Quantity::new(&own.name, own.unit.text));
                panel.measured = Some(Curve::new(&own.points, &own.values));
                panel
            });
            Some(line_plot(&LinePlot { title, subtitle, x: quantity(0), panels: panels.collect() }))
        }
        2 => {
            let panels = shown.map(|own| {
                let (places, _) = own.points.as_chunks::<2>();
                Ok(MapPanel {
                    title: own.name.clone(),
                    value: Quantity::new(&own.name, own.unit.text),
                    grid: Grid::from_points(places, &own.values)?,
                    scale: ColourScale::diverging(&own.values),
                    contours: Vec::new(),
                })
            });
            let panels = panels.collect::<Result<Vec<_>, DataError>>();
            let map = |panels| FieldMap {
                title,
                subtitle,
                x: quantity(0),
                y: quantity(1),
                outline: Vec::new(),
                marks: Vec::new(),
                panels,
            };
            Some(panels.and_then(|panels| field_map(&map(panels))))
        }
        _ => None,
    }
}
