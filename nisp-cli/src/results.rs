//! The files of a solved problem: source and state as CSV, and a plot.

use nisp::Estimate;
use nisp_data::atomic::Content;
use nisp_data::picture::{Curve, LinePanel, LinePlot, Picture, Quantity, line_plot};
use nisp_data::{DataError, Table};
use nisp_equations::Prepared;

/// Names and contents, to be written together.
pub(crate) fn files(prepared: &Prepared, estimates: &[Estimate]) -> Result<Vec<Content>, DataError> {
    let plot = plot(prepared, estimates)?;
    Ok(vec![
        ("source.csv", table(prepared, estimates, true)?),
        ("state.csv", table(prepared, estimates, false)?),
        ("plot.svg", plot.svg().into()),
    ])
}

/// Sources or fields over time, each with its standard deviation where there is one.
fn table(prepared: &Prepared, estimates: &[Estimate], source: bool) -> Result<Vec<u8>, DataError> {
    let mut table = Table::empty();
    table.push("t", "s", &prepared.times)?;
    for estimate in estimates.iter().filter(|estimate| estimate.source == source) {
        table.push(estimate.name, estimate.unit.text, &estimate.values)?;
        if let Some(deviations) = &estimate.deviations {
            table.push(&format!("{}_sd", estimate.name), estimate.unit.text, deviations)?;
        }
    }
    let mut bytes = Vec::new();
    // A vector takes everything.
    let _ = table.write_to(&mut bytes);
    Ok(bytes)
}

fn plot(prepared: &Prepared, estimates: &[Estimate]) -> Result<Picture, DataError> {
    let mut sorted: Vec<&Estimate> = estimates.iter().collect();
    sorted.sort_by_key(|estimate| !estimate.source);
    let panels = sorted.into_iter().map(|estimate| {
        let mut panel = LinePanel::new(Quantity::new(estimate.name, estimate.unit.text));
        let measured = prepared.measured.iter().find(|(name, _)| *name == estimate.name);
        panel.measured = measured.map(|(_, values)| Curve::new(&prepared.times, values));
        panel.estimate = Some(Curve::new(&prepared.times, &estimate.values));
        panel.deviation.clone_from(&estimate.deviations);
        let truth = prepared.truth.as_ref();
        panel.truth = truth.and_then(|truth| Some(Curve::new(&truth.times, truth.of(estimate.name)?)));
        panel
    });
    let scene = prepared.problem.scene().schema;
    let file = prepared.source.rsplit(['/', '\\']).next().unwrap_or(&prepared.source);
    let title = format!("{}, {} from {file}", scene.module, scene.name);
    line_plot(&LinePlot { title, x: Quantity::new("t", "s"), panels: panels.collect() })
}
