//! Legends stand outside the data: in rows above a plot.

use super::canvas::{Anchor, Canvas, Frame, Stroke};
use super::style::{BAND_OPACITY, GAP, TICK};
use super::text;

/// What a legend shows beside a name.
#[derive(Clone, Copy)]
pub(super) enum Swatch<'a> {
    Line(Stroke<'a>),
    /// A line through a shaded band.
    BandLine(Stroke<'a>),
    Dot {
        colour: &'a str,
        radius: f64,
    },
    LineDot {
        stroke: Stroke<'a>,
        radius: f64,
        /// Share of the radius that is white inside.
        inside: f64,
    },
}

const SWATCH: f64 = 28.0;
const ROW: f64 = 1.55 * TICK;

/// Breaks the entries into rows of at most `width`.
fn rows<'a, 'b>(entries: &'b [(Swatch<'a>, String)], width: f64) -> Vec<&'b [(Swatch<'a>, String)]> {
    let mut out = Vec::new();
    let (mut start, mut used) = (0, 0.0);
    for (index, (_, name)) in entries.iter().enumerate() {
        let wide = entry_width(name);
        if used + wide > width && index > start {
            out.push(&entries[start..index]);
            (start, used) = (index, 0.0);
        }
        used += wide;
    }
    if start < entries.len() {
        out.push(&entries[start..]);
    }
    out
}

fn entry_width(name: &str) -> f64 {
    SWATCH + GAP + text::width(name, TICK) + 2.0 * GAP
}

/// Height of the legend at this width.
pub(super) fn height(entries: &[(Swatch<'_>, String)], width: f64) -> f64 {
    rows(entries, width).len() as f64 * ROW
}

/// Draws the legend with its top left corner at `at`.
pub(super) fn draw(canvas: &mut Canvas, at: [f64; 2], width: f64, entries: &[(Swatch<'_>, String)]) {
    for (index, row) in rows(entries, width).into_iter().enumerate() {
        let y = at[1] + (index as f64 + 0.5) * ROW;
        let mut x = at[0];
        for (swatch, name) in row {
            draw_swatch(canvas, [x, y], swatch);
            canvas.text([x + SWATCH + GAP, y + 0.35 * TICK], TICK, Anchor::Start, name);
            x += entry_width(name);
        }
    }
}

fn draw_swatch(canvas: &mut Canvas, [x, y]: [f64; 2], swatch: &Swatch<'_>) {
    let ends = ([x, y], [x + SWATCH, y]);
    match *swatch {
        Swatch::Line(stroke) => canvas.line(ends.0, ends.1, stroke),
        Swatch::BandLine(stroke) => {
            let band = Frame { left: x, top: y - 6.0, width: SWATCH, height: 12.0 };
            let corners = [[x, y - 6.0], [band.right(), y - 6.0], [band.right(), y + 6.0], [x, y + 6.0]];
            canvas.polygon(&corners, stroke.colour, BAND_OPACITY);
            canvas.line(ends.0, ends.1, stroke);
        }
        Swatch::Dot { colour, radius } => canvas.dots(&[[x + 0.5 * SWATCH, y]], radius, colour),
        Swatch::LineDot { stroke, radius, inside } => {
            canvas.line(ends.0, ends.1, stroke);
            canvas.dots(&[[x + 0.5 * SWATCH, y]], radius, stroke.colour);
            canvas.dots(&[[x + 0.5 * SWATCH, y]], inside * radius, "#ffffff");
        }
    }
}
