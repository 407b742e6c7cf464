//! The bar that says what colours mean.

use super::Quantity;
use super::axis::Scale;
use super::canvas::{Anchor, Canvas, Frame, Stroke};
use super::raster;
use super::style::{FRAME, GAP, LABEL, TICK, TICK_LENGTH};
use crate::DataError;
use crate::colour::ColourScale;

const HEIGHT: f64 = 14.0;

/// Height of a bar with its texts.
pub(super) fn height() -> f64 {
    HEIGHT + text_height()
}

fn text_height() -> f64 {
    TICK_LENGTH + 0.3 * GAP + 1.3 * TICK + 1.2 * LABEL
}

/// Draws a bar with its top left corner at `at`.
pub(super) fn draw(
    canvas: &mut Canvas,
    at: [f64; 2],
    width: f64,
    value: &Quantity,
    colours: &ColourScale,
) -> Result<(), DataError> {
    let (low, high) = colours.range();
    let shown = value.shown(low.abs().max(high.abs()));
    let frame = Frame { left: at[0], top: at[1], width, height: HEIGHT };
    canvas.image(frame, &raster::bar(colours)?);
    let stroke = Stroke::solid(FRAME, 1.2);
    canvas.rect(frame, "none", Some(stroke));
    let scale = Scale::linear(low / shown.factor, high / shown.factor, width / 70.0);
    for (value, text) in &scale.marks {
        let x = frame.left + scale.share(*value) * frame.width;
        canvas.line([x, frame.bottom()], [x, frame.bottom() + TICK_LENGTH], stroke);
        canvas.text([x, frame.bottom() + TICK_LENGTH + 0.3 * GAP + 0.8 * TICK], TICK, Anchor::Middle, text);
    }
    let y = frame.bottom() + text_height() - 0.3 * LABEL;
    canvas.text([frame.left + 0.5 * frame.width, y], LABEL, Anchor::Middle, &shown.label);
    Ok(())
}
