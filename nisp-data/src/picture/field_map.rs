//! Coloured maps of a plane region, side by side: truth, estimate, error.

use super::axis::{Panel, Scale, x_axis_height, y_axis_width};
use super::canvas::{Anchor, Canvas, Frame, Stroke};
use super::contour::level_line;
use super::grid::{Grid, is_stretched};
use super::legend::{self, Swatch};
use super::line_plot::extent;
use super::quantity::Shown;
use super::style::{GAP, INK, LABEL, MARGIN, PALETTE, WIDTH};
use super::{Picture, Quantity, bar, heading, raster};
use crate::DataError;
use crate::colour::ColourScale;

/// Maps of one region.
#[derive(Debug, Clone)]
pub struct FieldMap {
    /// One line above everything.
    pub title: String,
    /// A smaller line below it.
    pub subtitle: String,
    /// The horizontal coordinate.
    pub x: Quantity,
    /// The vertical coordinate.
    pub y: Quantity,
    /// The region's edge (`Domain::outline`); empty if the colours may end where the values do.
    pub outline: Vec<[f64; 2]>,
    /// Where was measured, as dots; empty if that is not shown.
    pub marks: Vec<[f64; 2]>,
    /// From left to right, at most three.
    pub panels: Vec<MapPanel>,
}

/// One map.
#[derive(Debug, Clone)]
pub struct MapPanel {
    /// A word or two above the map.
    pub title: String,
    /// What is coloured.
    pub value: Quantity,
    /// Its values.
    pub grid: Grid,
    /// Its colours.
    pub scale: ColourScale,
    /// Level lines over the map: name, grid, level. A mask's outline is its level 0.5.
    pub contours: Vec<(String, Grid, f64)>,
}

/// Height over width of a map whose axes have a scale each.
const STRETCHED: f64 = 0.75;
/// Radius of a dot.
const MARK: f64 = 1.4;
/// A lone map need not fill the page.
const WIDEST: f64 = 560.0;

/// Draws the maps.
pub fn field_map(map: &FieldMap) -> Result<Picture, DataError> {
    let Some(([left_x, right_x], [low_y, high_y])) = region(map).filter(|_| map.panels.len() <= 3) else {
        return Err(DataError::invalid("a map needs one to three panels with some extent"));
    };
    let (shown_x, shown_y) = shown_axes(map, [left_x, right_x], [low_y, high_y]);
    let y_scale =
        |height: f64| Scale::linear(low_y / shown_y.factor, high_y / shown_y.factor, (height / 42.0).max(4.0));
    let count = map.panels.len() as f64;
    let gap = 3.0 * GAP;
    // Maps side by side span two columns of a page.
    let page = WIDTH * (0.75 + 0.25 * count);
    let stretched = is_stretched(right_x - left_x, high_y - low_y);
    let ratio = if stretched { STRETCHED } else { (high_y - low_y) / (right_x - left_x) };
    // Beside the marks of an axis of about this height.
    let beside = |about: f64| {
        let left = MARGIN + y_axis_width(y_scale(about).text_width());
        let width = ((page - left - 1.8 * MARGIN - gap * (count - 1.0)) / count).min(WIDEST);
        (left, width, (width * ratio).min(page))
    };
    let (.., about) = beside(200.0);
    let (left, width, height) = beside(about);

    let mut canvas = Canvas::new();
    let mut top = MARGIN;
    let used = left + count * width + gap * (count - 1.0);
    top += heading::draw(&mut canvas, [left, top], used - left, &map.title, &map.subtitle);
    let names = contour_names(map);
    let entries = names.iter().enumerate().map(|(k, name)| (Swatch::Line(contour_stroke(k)), name.to_string()));
    let marked = (!map.marks.is_empty()).then(|| (Swatch::Dot { colour: INK, radius: MARK }, "measured".to_string()));
    let entries: Vec<_> = entries.chain(marked).collect();
    legend::draw(&mut canvas, [left, top], page - left - MARGIN, &entries);
    top += legend::height(&entries, page - left - MARGIN) + 1.3 * LABEL;

    let bar_top = top + height + x_axis_height() + 2.0 * GAP;
    for (index, map_panel) in map.panels.iter().enumerate() {
        let frame = Frame { left: left + index as f64 * (width + gap), top, width, height };
        let x = Scale::linear(left_x / shown_x.factor, right_x / shown_x.factor, width / 75.0);
        let area = Panel { frame, x, y: y_scale(height) };
        canvas.text([frame.left + 0.5 * width, top - 0.45 * LABEL], LABEL, Anchor::Middle, &map_panel.title);
        draw_map(&mut canvas, &area, map, map_panel, [shown_x.factor, shown_y.factor], &names)?;
        area.draw_frame(&mut canvas, true, index == 0);
        area.draw_x_label(&mut canvas, &shown_x.label);
        if index == 0 {
            area.draw_y_label(&mut canvas, MARGIN + 0.9 * LABEL, &shown_y.label);
        }
        bar::draw(&mut canvas, [frame.left, bar_top], width, &map_panel.value, &map_panel.scale)?;
    }
    Ok(canvas.finish(used + 1.8 * MARGIN, bar_top + bar::height() + MARGIN, &map.title))
}

fn shown_axes(map: &FieldMap, x: [f64; 2], y: [f64; 2]) -> (Shown, Shown) {
    let [size_x, size_y] = [x, y].map(|range| range[0].abs().max(range[1].abs()));
    if is_stretched(x[1] - x[0], y[1] - y[0]) {
        return (map.x.shown(size_x), map.y.shown(size_y));
    }
    // Both axes have one scale, so they should have one unit.
    let largest = size_x.max(size_y);
    (map.x.shown(largest), map.y.shown(largest))
}

/// What the maps cover, with a little air.
fn region(map: &FieldMap) -> Option<([f64; 2], [f64; 2])> {
    let grids = || map.panels.iter().map(|panel| &panel.grid);
    let span = |axis: usize| {
        let nodes = grids().flat_map(move |grid| if axis == 0 { &grid.x } else { &grid.y }).copied();
        let edge = map.outline.iter().map(move |point| point[axis]);
        extent(nodes.chain(edge)).filter(|(low, high)| low < high)
    };
    let ((left, right), (low, high)) = (span(0)?, span(1)?);
    let (wide, tall) = (right - left, high - low);
    let [air_x, air_y] = if is_stretched(wide, tall) { [wide, tall] } else { [wide.max(tall); 2] }.map(|x| 0.02 * x);
    Some(([left - air_x, right + air_x], [low - air_y, high + air_y]))
}

fn contour_names(map: &FieldMap) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _, _) in map.panels.iter().flat_map(|panel| &panel.contours) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}

fn contour_stroke(index: usize) -> Stroke<'static> {
    Stroke { colour: [PALETTE[1], INK, PALETTE[3]][index % 3], width: 1.5, dash: "" }
}

fn draw_map(
    canvas: &mut Canvas,
    area: &Panel,
    map: &FieldMap,
    panel: &MapPanel,
    factors: [f64; 2],
    names: &[&str],
) -> Result<(), DataError> {
    let place = |[x, y]: [f64; 2]| area.at([x / factors[0], y / factors[1]]);
    let grid = &panel.grid;
    let (low, high) = ([grid.x[0], grid.y[0]], [grid.x[grid.x.len() - 1], grid.y[grid.y.len() - 1]]);
    let edge: Vec<[f64; 2]> = map.outline.iter().map(|&point| place(point)).collect();
    let (low, high) = if edge.is_empty() { (low, high) } else { hull(map, low, high) };
    let image = raster::field(grid, &panel.scale, low, high, edge.is_empty())?;
    let (corner, opposite) = (place([low[0], high[1]]), place([high[0], low[1]]));
    let frame =
        Frame { left: corner[0], top: corner[1], width: opposite[0] - corner[0], height: opposite[1] - corner[1] };
    if edge.is_empty() {
        canvas.image(frame, &image);
    } else {
        canvas.clipped_to(&edge, |canvas| canvas.image(frame, &image));
        canvas.outline(&edge, Stroke::solid(INK, 1.4));
    }
    for (name, grid, level) in &panel.contours {
        let stroke = contour_stroke(names.iter().position(|known| known == name).unwrap_or(0));
        let pieces: Vec<_> = level_line(grid, *level).into_iter().map(|piece| piece.map(place)).collect();
        // A light casing keeps the line visible on every colour.
        canvas.pieces(&pieces, Stroke::solid("#ffffff", stroke.width + 1.2));
        canvas.pieces(&pieces, stroke);
    }
    // A light rim keeps a dot visible on every colour.
    let marks: Vec<[f64; 2]> = map.marks.iter().map(|&mark| place(mark)).collect();
    canvas.dots(&marks, 1.5 * MARK, "#ffffff");
    canvas.dots(&marks, MARK, INK);
    Ok(())
}

/// The box around grid and outline together.
fn hull(map: &FieldMap, low: [f64; 2], high: [f64; 2]) -> ([f64; 2], [f64; 2]) {
    map.outline.iter().fold((low, high), |(low, high), point| {
        ([low[0].min(point[0]), low[1].min(point[1])], [high[0].max(point[0]), high[1].max(point[1])])
    })
}
