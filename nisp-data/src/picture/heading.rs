//! Title and subtitle, shrunk where they would not fit.

use super::canvas::{Anchor, Canvas};
use super::style::{QUIET, TICK, TITLE};
use super::text;

/// Draws what is not empty with its top left corner at `at`, and returns the height used.
pub(super) fn draw(canvas: &mut Canvas, at: [f64; 2], width: f64, title: &str, subtitle: &str) -> f64 {
    let mut height = 0.0;
    if !title.is_empty() {
        // Bold letters are about a tenth wider.
        let size = fitting(TITLE, 1.1 * text::width(title, TITLE), width);
        canvas.bold_text([at[0], at[1] + 0.8 * TITLE], size, Anchor::Start, title);
        height += 1.3 * TITLE;
    }
    if !subtitle.is_empty() {
        let size = fitting(TICK, text::width(subtitle, TICK), width);
        canvas.coloured_text([at[0], at[1] + height + 0.8 * TICK], size, Anchor::Start, subtitle, QUIET);
        height += 1.45 * TICK;
    }
    height
}

fn fitting(size: f64, needed: f64, width: f64) -> f64 {
    size * (width / needed).min(1.0)
}
