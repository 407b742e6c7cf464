//! Error against time: points of several methods on logarithmic axes, with levels to beat.

use super::axis::{Panel, Scale, x_axis_height, y_axis_width};
use super::canvas::{Anchor, Canvas, Frame, Stroke};
use super::legend::{self, Swatch};
use super::line_plot::extent;
use super::style::{GAP, INK, MARGIN, PALETTE, QUIET, TICK, WIDTH};
use super::{Picture, Quantity, heading, text};
use crate::DataError;

/// Series and marks on logarithmic axes.
#[derive(Debug, Clone)]
pub struct LogLog {
    /// One line above everything.
    pub title: String,
    /// A smaller line below it.
    pub subtitle: String,
    /// The horizontal axis, usually time.
    pub x: Quantity,
    /// The vertical axis, usually an error.
    pub y: Quantity,
    /// Points of each method.
    pub series: Vec<Series>,
    /// Levels to compare with.
    pub marks: Vec<Mark>,
}

/// Points of one method.
#[derive(Debug, Clone)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// Series of one family share a colour.
    pub family: usize,
    /// Positions, both coordinates above zero.
    pub points: Vec<[f64; 2]>,
    /// Whether a line joins the points, in their order.
    pub joined: bool,
}

/// A level across the plot.
#[derive(Debug, Clone)]
pub enum Mark {
    /// A level of the vertical axis, named on the right.
    Horizontal(String, f64),
    /// A level of the horizontal axis, named on top.
    Vertical(String, f64),
}

const HEIGHT: f64 = 420.0;
const RADIUS: f64 = 4.5;
const MARK: Stroke<'_> = Stroke { colour: QUIET, width: 1.4, dash: "6 4" };

/// Draws the plot.
pub fn log_log(plot: &LogLog) -> Result<Picture, DataError> {
    let [x_range, y_range] = ranges(plot)?;
    let y = Scale::logarithmic(y_range.0, y_range.1, 8.0);
    let left = MARGIN + y_axis_width(y.text_width());
    let names = plot.marks.iter().filter_map(|mark| match mark {
        Mark::Horizontal(name, _) => Some(text::width(name, TICK)),
        Mark::Vertical(..) => None,
    });
    let right = MARGIN + names.fold(0.0, f64::max) + GAP;
    let width = WIDTH - left - right;
    let mut canvas = Canvas::new();
    let mut top = MARGIN;
    top += heading::draw(&mut canvas, [left, top], WIDTH - left - MARGIN, &plot.title, &plot.subtitle);
    let looks = looks(&plot.series);
    let entries: Vec<_> = plot
        .series
        .iter()
        .zip(&looks)
        .map(|(series, look)| (look.swatch(series.joined), series.name.clone()))
        .collect();
    legend::draw(&mut canvas, [left, top], WIDTH - left - MARGIN, &entries);
    top += legend::height(&entries, WIDTH - left - MARGIN) + GAP;
    let x = Scale::logarithmic(x_range.0, x_range.1, 8.0);
    let rows = vertical_rows(plot, &x, width);
    top += 1.2 * TICK * rows.iter().map(|(_, row)| row + 1).max().unwrap_or(0) as f64;

    let area = Panel { frame: Frame { left, top, width, height: HEIGHT }, x, y };
    area.draw_grid(&mut canvas);
    draw_marks(&mut canvas, &area, plot, &rows);
    for (series, look) in plot.series.iter().zip(&looks) {
        let points: Vec<[f64; 2]> = series.points.iter().map(|&point| area.at(point)).collect();
        if series.joined {
            canvas.polyline(&points, look.stroke);
        }
        canvas.dots(&points, RADIUS + 1.5, "#ffffff");
        canvas.dots(&points, RADIUS, look.stroke.colour);
        canvas.dots(&points, look.inside * RADIUS, "#ffffff");
    }
    area.draw_frame(&mut canvas, true, true);
    area.draw_x_label(&mut canvas, &plot.x.label());
    area.draw_y_label(&mut canvas, MARGIN + 0.9 * super::style::LABEL, &plot.y.label());
    Ok(canvas.finish(WIDTH, top + HEIGHT + x_axis_height() + 0.5 * MARGIN, &plot.title))
}

/// How a series is drawn.
#[derive(Clone, Copy)]
struct Look {
    stroke: Stroke<'static>,
    /// Share of a point that is white inside.
    inside: f64,
}

impl Look {
    fn swatch(self, joined: bool) -> Swatch<'static> {
        let Self { stroke, inside } = self;
        match joined {
            true => Swatch::LineDot { stroke, radius: RADIUS, inside },
            false => Swatch::Dot { colour: stroke.colour, radius: RADIUS },
        }
    }
}

/// A colour for each family; within one, solid lines with filled points, then dashed and dotted ones with ever smaller rims.
fn looks(all: &[Series]) -> Vec<Look> {
    let colours: Vec<&str> = PALETTE.into_iter().chain([INK]).collect();
    let look = |index: usize| {
        let family = all[index].family;
        let before = all[..index].iter().filter(|other| other.family == family).count();
        let (dash, inside) = [("", 0.0), ("8 4", 0.45), ("2 4", 0.7)][before % 3];
        Look { stroke: Stroke { colour: colours[family % colours.len()], width: 2.0, dash }, inside }
    };
    (0..all.len()).map(look).collect()
}

fn ranges(plot: &LogLog) -> Result<[(f64, f64); 2], DataError> {
    let points = || plot.series.iter().flat_map(|series| &series.points);
    let mark = |vertical: bool| {
        plot.marks.iter().filter_map(move |mark| match mark {
            Mark::Vertical(_, at) if vertical => Some(*at),
            Mark::Horizontal(_, at) if !vertical => Some(*at),
            _ => None,
        })
    };
    let x = extent(points().map(|point| point[0]).chain(mark(true)));
    let y = extent(points().map(|point| point[1]).chain(mark(false)));
    let (Some(x), Some(y)) = (x, y) else { return Err(DataError::invalid("a plot without points")) };
    if !points().flatten().copied().chain(mark(true)).chain(mark(false)).all(|value| value.is_finite() && value > 0.0) {
        return Err(DataError::invalid("logarithmic axes need finite values above zero"));
    }
    Ok([x, y])
}

/// Vertical marks from left to right, each with the row (from the frame upwards) where its name finds room.
fn vertical_rows(plot: &LogLog, x: &Scale, width: f64) -> Vec<(usize, usize)> {
    let mut marks: Vec<(usize, f64, f64)> = plot
        .marks
        .iter()
        .enumerate()
        .filter_map(|(index, mark)| match mark {
            Mark::Vertical(name, at) => Some((index, x.share(*at) * width, 0.5 * text::width(name, TICK) + GAP)),
            Mark::Horizontal(..) => None,
        })
        .collect();
    marks.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut ends: Vec<f64> = Vec::new();
    marks
        .into_iter()
        .map(|(index, centre, half)| {
            let row = ends.iter().position(|&end| end <= centre - half).unwrap_or(ends.len());
            if row == ends.len() {
                ends.push(0.0);
            }
            ends[row] = centre + half;
            (index, row)
        })
        .collect()
}

fn draw_marks(canvas: &mut Canvas, area: &Panel, plot: &LogLog, rows: &[(usize, usize)]) {
    let frame = area.frame;
    for &(index, row) in rows {
        if let Mark::Vertical(name, at) = &plot.marks[index] {
            let x = frame.left + area.x.share(*at) * frame.width;
            canvas.line([x, frame.top], [x, frame.bottom()], MARK);
            canvas.coloured_text(
                [x, frame.top - 0.4 * TICK - 1.2 * TICK * row as f64],
                TICK,
                Anchor::Middle,
                name,
                INK,
            );
        }
    }
    let mut levels: Vec<(f64, &str)> = Vec::new();
    for mark in &plot.marks {
        if let Mark::Horizontal(name, at) = mark {
            levels.push((frame.bottom() - area.y.share(*at) * frame.height, name));
        }
    }
    levels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let names = spaced(&levels.iter().map(|(y, _)| *y).collect::<Vec<_>>(), 1.15 * TICK);
    for ((y, name), name_y) in levels.iter().zip(names) {
        canvas.line([frame.left, *y], [frame.right(), *y], MARK);
        canvas.line([frame.right(), *y], [frame.right() + 0.7 * GAP, name_y], Stroke::solid(MARK.colour, 1.0));
        canvas.coloured_text([frame.right() + GAP, name_y + 0.35 * TICK], TICK, Anchor::Start, name, INK);
    }
}

/// Positions as near as possible to the wanted ones (sorted) with at least `gap` between neighbours.
fn spaced(wanted: &[f64], gap: f64) -> Vec<f64> {
    // Groups that would overlap are spread around their common middle.
    let mut groups: Vec<(f64, usize)> = Vec::new();
    for &position in wanted {
        groups.push((position, 1));
        while let [.., (a, m), (b, n)] = groups[..] {
            if b - a >= 0.5 * gap * (m + n) as f64 {
                break;
            }
            groups.truncate(groups.len() - 2);
            groups.push(((a * m as f64 + b * n as f64) / (m + n) as f64, m + n));
        }
    }
    let place =
        |(middle, count): (f64, usize)| (0..count).map(move |k| middle + gap * (k as f64 - 0.5 * (count - 1) as f64));
    groups.into_iter().flat_map(place).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn names_keep_their_distance() {
        assert_eq!(super::spaced(&[0.0, 1.0, 50.0], 10.0), [-4.5, 5.5, 50.0]);
    }
}
