//! A panel: a frame with a horizontal and a vertical scale, its marks and its labels.

use super::canvas::{Anchor, Canvas, Frame, Stroke};
use super::style::{FAINT, FRAME, GAP, LABEL, TICK, TICK_LENGTH};
use super::text;
use super::ticks;

/// Maps values onto a stretch of the figure.
#[derive(Clone, Debug)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    logarithmic: bool,
    /// Where the marks stand, and their texts (empty for a minor mark).
    pub(super) marks: Vec<(f64, String)>,
}

impl Scale {
    /// Linear over `low..high`, with about `count` marks.
    pub(super) fn linear(low: f64, high: f64, count: f64) -> Scale {
        let (low, high) = if high > low { (low, high) } else { widen(low) };
        let at = ticks::linear(low, high, count);
        let marks = at.iter().copied().zip(ticks::texts(&at)).collect();
        Scale { low, high, logarithmic: false, marks }
    }

    /// Logarithmic, over whole decades if few, with at most about `count` texts.
    pub(super) fn logarithmic(low: f64, high: f64, count: f64) -> Scale {
        let (low, high) = (low.log10() - 0.08, high.log10() + 0.08);
        let (first, last) = (low.floor() as i32, high.ceil() as i32);
        let stride = (f64::from(last - first) / count).ceil().max(1.0) as i32;
        let mut marks = Vec::new();
        for exponent in first..=last {
            let text = if exponent.rem_euclid(stride) == 0 { ticks::decade(exponent) } else { String::new() };
            marks.push((10f64.powi(exponent), text));
            if stride == 1 {
                marks.extend((2..10).map(|digit| (f64::from(digit) * 10f64.powi(exponent), String::new())));
            }
        }
        let mut scale = Scale { low, high, logarithmic: true, marks: Vec::new() };
        marks.retain(|(value, _)| (-1e-9..=1.0 + 1e-9).contains(&scale.share(*value)));
        scale.marks = marks;
        scale.name_short_ranges();
        scale
    }

    /// Less than two decades in sight leave hardly a named mark: name 2 and 5 as well.
    fn name_short_ranges(&mut self) {
        if self.marks.iter().filter(|(_, text)| !text.is_empty()).count() >= 2 {
            return;
        }
        for (value, text) in &mut self.marks {
            let exponent = value.log10().floor() as i32;
            let lead = (*value / 10f64.powi(exponent)).round() as i32;
            if text.is_empty() && matches!(lead, 2 | 5) {
                *text = if (-2..=3).contains(&exponent) {
                    format!("{}", lead as f64 * 10f64.powi(exponent))
                } else {
                    format!("{lead}×{}", ticks::decade(exponent))
                };
            }
        }
    }

    /// Share of the way from the low end to the high end.
    pub(super) fn share(&self, value: f64) -> f64 {
        let value = if self.logarithmic { value.log10() } else { value };
        (value - self.low) / (self.high - self.low)
    }

    /// Width of the widest mark's text.
    pub(super) fn text_width(&self) -> f64 {
        self.marks.iter().map(|(_, text)| text::width(text, TICK)).fold(0.0, f64::max)
    }
}

fn widen(value: f64) -> (f64, f64) {
    let half = if value == 0.0 { 1.0 } else { 0.5 * value.abs() };
    (value - half, value + half)
}

/// A frame with its two scales.
pub(super) struct Panel {
    pub(super) frame: Frame,
    pub(super) x: Scale,
    pub(super) y: Scale,
}

impl Panel {
    /// Figure position of a data point.
    pub(super) fn at(&self, point: [f64; 2]) -> [f64; 2] {
        let Frame { left, width, height, .. } = self.frame;
        [left + self.x.share(point[0]) * width, self.frame.bottom() - self.y.share(point[1]) * height]
    }

    pub(super) fn all_at(&self, xs: &[f64], ys: &[f64]) -> Vec<[f64; 2]> {
        xs.iter().zip(ys).map(|(&x, &y)| self.at([x, y])).collect()
    }

    /// Faint lines through the named marks. Drawn before the data.
    pub(super) fn draw_grid(&self, canvas: &mut Canvas) {
        let Frame { left, top, .. } = self.frame;
        let faint = Stroke::solid(FAINT, 1.0);
        for (value, _) in self.x.marks.iter().filter(|(_, text)| !text.is_empty()) {
            let x = left + self.x.share(*value) * self.frame.width;
            canvas.line([x, top], [x, self.frame.bottom()], faint);
        }
        for (value, _) in self.y.marks.iter().filter(|(_, text)| !text.is_empty()) {
            let y = self.frame.bottom() - self.y.share(*value) * self.frame.height;
            canvas.line([left, y], [self.frame.right(), y], faint);
        }
    }

    /// Frame, marks and their texts. Drawn after the data. `named_x` and `named_y` are false where a neighbour
    /// carries the texts.
    pub(super) fn draw_frame(&self, canvas: &mut Canvas, named_x: bool, named_y: bool) {
        let Frame { left, .. } = self.frame;
        let bottom = self.frame.bottom();
        let stroke = Stroke::solid(FRAME, 1.2);
        canvas.rect(self.frame, "none", Some(stroke));
        for (value, text) in &self.x.marks {
            let x = left + self.x.share(*value) * self.frame.width;
            canvas.line([x, bottom], [x, bottom + mark_length(text)], stroke);
            if named_x && !text.is_empty() {
                canvas.text([x, bottom + TICK_LENGTH + 0.3 * GAP + 0.8 * TICK], TICK, Anchor::Middle, text);
            }
        }
        for (value, text) in &self.y.marks {
            let y = bottom - self.y.share(*value) * self.frame.height;
            canvas.line([left - mark_length(text), y], [left, y], stroke);
            if named_y && !text.is_empty() {
                canvas.text([left - TICK_LENGTH - 0.5 * GAP, y + 0.35 * TICK], TICK, Anchor::End, text);
            }
        }
    }

    pub(super) fn draw_x_label(&self, canvas: &mut Canvas, label: &str) {
        let x = self.frame.left + 0.5 * self.frame.width;
        canvas.text([x, self.frame.bottom() + x_marks_height() + 0.9 * LABEL], LABEL, Anchor::Middle, label);
    }

    /// The vertical label, with its base line at `x`.
    pub(super) fn draw_y_label(&self, canvas: &mut Canvas, x: f64, label: &str) {
        canvas.upward_text([x, self.frame.top + 0.5 * self.frame.height], LABEL, label);
    }
}

fn mark_length(text: &str) -> f64 {
    if text.is_empty() { 0.6 * TICK_LENGTH } else { TICK_LENGTH }
}

/// Space that the texts of the horizontal marks take below a frame.
pub(super) fn x_marks_height() -> f64 {
    TICK_LENGTH + 0.3 * GAP + TICK + 0.4 * GAP
}

/// Space that marks and label take below a frame.
pub(super) fn x_axis_height() -> f64 {
    x_marks_height() + 1.3 * LABEL
}

/// Space that marks and label take left of a frame whose widest mark text is given.
pub(super) fn y_axis_width(widest: f64) -> f64 {
    TICK_LENGTH + 0.5 * GAP + widest + GAP + 1.2 * LABEL
}
