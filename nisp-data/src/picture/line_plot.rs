//! Curves over one axis, stacked: the source on top, the states below.

use super::axis::{Panel, Scale, x_axis_height, y_axis_width};
use super::canvas::{Anchor, Canvas, Frame, Stroke};
use super::legend::{self, Swatch};
use super::style::{BAND_OPACITY, ESTIMATE, GAP, MARGIN, MEASURED, PALETTE, QUIET, TICK, TRUTH, WIDTH};
use super::{Picture, Quantity, decimate, heading};
use crate::DataError;

/// Panels over a common axis.
#[derive(Debug, Clone)]
pub struct LinePlot {
    /// One line above everything.
    pub title: String,
    /// A smaller line below it.
    pub subtitle: String,
    /// The common axis, usually time.
    pub x: Quantity,
    /// From top to bottom. The first is drawn taller: put the source there.
    pub panels: Vec<LinePanel>,
}

/// One quantity over the common axis. Whatever is absent is not drawn.
#[derive(Debug, Clone)]
pub struct LinePanel {
    /// What the panel shows.
    pub y: Quantity,
    /// The same in words, above the panel.
    pub caption: String,
    /// What was measured, as dots.
    pub measured: Option<Curve>,
    /// What was estimated, as a line.
    pub estimate: Option<Curve>,
    /// Standard deviation of the estimate, one value for each of its points: drawn as a band of twice that.
    pub deviation: Option<Vec<f64>>,
    /// What is true, as a dashed line.
    pub truth: Option<Curve>,
    /// Other answers, by name.
    pub others: Vec<(String, Curve)>,
}

/// Points of a curve.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Positions on the common axis.
    pub x: Vec<f64>,
    /// Values.
    pub y: Vec<f64>,
}

impl Curve {
    /// From two slices of one length.
    pub fn new(x: &[f64], y: &[f64]) -> Curve {
        Curve { x: x.to_vec(), y: y.to_vec() }
    }
}

impl LinePanel {
    /// An empty panel for a quantity.
    pub fn new(y: Quantity) -> LinePanel {
        LinePanel {
            y,
            caption: String::new(),
            measured: None,
            estimate: None,
            deviation: None,
            truth: None,
            others: Vec::new(),
        }
    }

    fn curves(&self) -> impl Iterator<Item = &Curve> {
        let own = [&self.measured, &self.estimate, &self.truth];
        own.into_iter().flatten().chain(self.others.iter().map(|(_, curve)| curve))
    }
}

const FIRST_HEIGHT: f64 = 220.0;
const OTHER_HEIGHT: f64 = 130.0;
const ESTIMATE_STROKE: Stroke<'_> = Stroke { colour: ESTIMATE, width: 2.4, dash: "" };
const TRUTH_STROKE: Stroke<'_> = Stroke { colour: TRUTH, width: 1.6, dash: "5 4" };
const MEASURED_RADIUS: f64 = 2.0;

/// Draws the plot.
pub fn line_plot(plot: &LinePlot) -> Result<Picture, DataError> {
    check(plot)?;
    let xs = plot.panels.iter().flat_map(LinePanel::curves).flat_map(|curve| &curve.x);
    let (low, high) = extent(xs.copied()).ok_or_else(|| DataError::invalid("a plot without points"))?;
    let shown_x = plot.x.shown(low.abs().max(high.abs()));
    // A little air, so that a layer at the very start can be seen.
    let (low, high) = (low - 0.012 * (high - low), high + 0.012 * (high - low));
    let heights: Vec<f64> = (0..plot.panels.len()).map(panel_height).collect();
    let shown: Vec<_> = plot.panels.iter().zip(&heights).map(|(panel, height)| scaled(panel, *height)).collect();
    let widest = shown.iter().map(|panel| panel.scale.text_width()).fold(0.0, f64::max);

    let mut canvas = Canvas::new();
    let left = MARGIN + y_axis_width(widest);
    let width = WIDTH - left - 1.6 * MARGIN;
    let mut top = MARGIN;
    top += heading::draw(&mut canvas, [left, top], width, &plot.title, &plot.subtitle);
    let entries = legend_entries(plot);
    legend::draw(&mut canvas, [left, top], width, &entries);
    top += legend::height(&entries, width) + GAP;

    for (index, (panel, shown)) in plot.panels.iter().zip(shown).enumerate() {
        let height = heights[index];
        if !panel.caption.is_empty() {
            canvas.coloured_text([left, top + TICK], TICK, Anchor::Start, &panel.caption, QUIET);
            top += 1.4 * TICK;
        }
        let x = Scale::linear(low / shown_x.factor, high / shown_x.factor, width / 90.0);
        let area = Panel { frame: Frame { left, top, width, height }, x, y: shown.scale };
        let last = index + 1 == plot.panels.len();
        area.draw_grid(&mut canvas);
        canvas.clipped(area.frame, |canvas| draw_curves(canvas, &area, panel, [shown_x.factor, shown.factor]));
        area.draw_frame(&mut canvas, last, true);
        area.draw_y_label(&mut canvas, MARGIN + 0.9 * super::style::LABEL, &shown.label);
        if last {
            area.draw_x_label(&mut canvas, &shown_x.label);
        }
        top += height + 1.5 * GAP;
    }
    Ok(canvas.finish(WIDTH, top - 1.5 * GAP + x_axis_height() + 0.5 * MARGIN, &plot.title))
}

fn panel_height(index: usize) -> f64 {
    if index == 0 { FIRST_HEIGHT } else { OTHER_HEIGHT }
}

struct ScaledPanel {
    factor: f64,
    label: String,
    scale: Scale,
}

/// Chooses the vertical scale of a panel.
fn scaled(panel: &LinePanel, height: f64) -> ScaledPanel {
    let curves = extent(panel.curves().flat_map(|curve| &curve.y).copied()).unwrap_or((0.0, 1.0));
    let (low, high) = with_band(panel, curves);
    let shown = panel.y.shown(low.abs().max(high.abs()));
    let pad = 0.06 * (high - low);
    let scale = Scale::linear((low - pad) / shown.factor, (high + pad) / shown.factor, height / 42.0);
    ScaledPanel { factor: shown.factor, label: shown.label, scale }
}

/// Widens the range for the band, but never so far that the curves become flat lines.
fn with_band(panel: &LinePanel, (low, high): (f64, f64)) -> (f64, f64) {
    let (Some(estimate), Some(deviation)) = (&panel.estimate, &panel.deviation) else { return (low, high) };
    let edges = estimate.y.iter().zip(deviation).flat_map(|(y, sd)| [y - 2.0 * sd, y + 2.0 * sd]);
    let Some((band_low, band_high)) = extent(edges) else { return (low, high) };
    let room = high - low;
    if room == 0.0 {
        return (band_low.min(low), band_high.max(high));
    }
    (band_low.max(low - room).min(low), band_high.min(high + room).max(high))
}

fn draw_curves(canvas: &mut Canvas, area: &Panel, panel: &LinePanel, factors: [f64; 2]) {
    let place = |curve: &Curve| {
        let scale = |values: &[f64], factor: f64| values.iter().map(|value| value / factor).collect::<Vec<_>>();
        area.all_at(&scale(&curve.x, factors[0]), &scale(&curve.y, factors[1]))
    };
    if let Some(measured) = &panel.measured {
        canvas.dots(&decimate::dots(&place(measured), MEASURED_RADIUS), MEASURED_RADIUS, MEASURED);
    }
    if let (Some(estimate), Some(deviation)) = (&panel.estimate, &panel.deviation) {
        let edge = |sign: f64| {
            let y = estimate.y.iter().zip(deviation).map(|(y, sd)| y + sign * 2.0 * sd).collect();
            decimate::curve(&place(&Curve { x: estimate.x.clone(), y }))
        };
        let mut band = edge(1.0);
        band.extend(edge(-1.0).into_iter().rev());
        canvas.polygon(&band, ESTIMATE, BAND_OPACITY);
    }
    for (index, (_, other)) in panel.others.iter().enumerate() {
        canvas.polyline(&decimate::curve(&place(other)), other_stroke(index));
    }
    if let Some(estimate) = &panel.estimate {
        canvas.polyline(&decimate::curve(&place(estimate)), ESTIMATE_STROKE);
    }
    if let Some(truth) = &panel.truth {
        canvas.polyline(&decimate::curve(&place(truth)), TRUTH_STROKE);
    }
}

fn other_stroke(index: usize) -> Stroke<'static> {
    Stroke::solid(PALETTE[1 + index % (PALETTE.len() - 1)], 1.6)
}

fn legend_entries(plot: &LinePlot) -> Vec<(Swatch<'static>, String)> {
    let any = |test: fn(&LinePanel) -> bool| plot.panels.iter().any(test);
    let mut entries = Vec::new();
    // Dots alone are what the title says.
    if any(|panel| panel.measured.is_some()) && any(|panel| panel.curves().count() > 1) {
        entries.push((Swatch::Dot { colour: MEASURED, radius: 1.5 * MEASURED_RADIUS }, "measured".to_string()));
    }
    if any(|panel| panel.deviation.is_some() && panel.estimate.is_some()) {
        entries.push((Swatch::BandLine(ESTIMATE_STROKE), "estimate ± 2 sd".to_string()));
    } else if any(|panel| panel.estimate.is_some()) {
        entries.push((Swatch::Line(ESTIMATE_STROKE), "estimate".to_string()));
    }
    if any(|panel| panel.truth.is_some()) {
        entries.push((Swatch::Line(TRUTH_STROKE), "truth".to_string()));
    }
    let longest = plot.panels.iter().map(|panel| &panel.others).max_by_key(|others| others.len());
    for (index, (name, _)) in longest.into_iter().flatten().enumerate() {
        entries.push((Swatch::Line(other_stroke(index)), name.clone()));
    }
    entries
}

fn check(plot: &LinePlot) -> Result<(), DataError> {
    for panel in &plot.panels {
        let name = panel.y.symbol();
        for curve in panel.curves() {
            if curve.x.len() != curve.y.len() {
                return Err(DataError::invalid(format!("plot of {name}: a curve has unequal numbers of x and y")));
            }
            if curve.x.iter().chain(&curve.y).any(|value| !value.is_finite()) {
                return Err(DataError::invalid(format!("plot of {name}: a value is not finite")));
            }
        }
        let points = panel.estimate.as_ref().map_or(0, |curve| curve.x.len());
        if panel.deviation.as_ref().is_some_and(|sd| sd.len() != points || sd.iter().any(|value| !value.is_finite())) {
            return Err(DataError::invalid(format!("plot of {name}: the band does not fit the estimate")));
        }
    }
    Ok(())
}

/// Smallest and largest value.
pub(super) fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range, value| match range {
        None => Some((value, value)),
        Some((low, high)) => Some((low.min(value), high.max(value))),
    })
}
