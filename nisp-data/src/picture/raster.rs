//! Fields as small embedded PNG images: thousands of coloured cells would make a heavy SVG.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::grid::{Grid, is_stretched};
use crate::DataError;
use crate::colour::ColourScale;

/// Pixels along the longer side.
const PIXELS: f64 = 480.0;
const BAR_PIXELS: usize = 256;

/// The grid between two corners, top row first. With `holes`, empty places are transparent.
pub(super) fn field(
    grid: &Grid,
    scale: &ColourScale,
    low: [f64; 2],
    high: [f64; 2],
    holes: bool,
) -> Result<String, DataError> {
    let (wide, tall) = (high[0] - low[0], high[1] - low[1]);
    let share = |length: f64| if is_stretched(wide, tall) { 1.0 } else { length / wide.max(tall) };
    let pixels = |length: f64| (PIXELS * share(length)).round().max(1.0) as usize;
    let (width, height) = (pixels(wide), pixels(tall));
    let filled = grid.spread();
    let mut rgba = Vec::with_capacity(4 * width * height);
    for row in 0..height {
        let y = high[1] - (row as f64 + 0.5) / height as f64 * tall;
        for column in 0..width {
            let x = low[0] + (column as f64 + 0.5) / width as f64 * wide;
            let [r, g, b] = scale.colour(filled.at(x, y));
            rgba.extend([r, g, b, if holes && !grid.covers(x, y) { 0 } else { 255 }]);
        }
    }
    encode(width, height, &rgba)
}

/// The scale itself from left to right.
pub(super) fn bar(scale: &ColourScale) -> Result<String, DataError> {
    let (low, high) = scale.range();
    let pixel = |index: usize| {
        let [r, g, b] = scale.colour(low + (high - low) * (index as f64 + 0.5) / BAR_PIXELS as f64);
        [r, g, b, 255]
    };
    encode(BAR_PIXELS, 1, &(0..BAR_PIXELS).flat_map(pixel).collect::<Vec<u8>>())
}

/// An image of four bytes a pixel, row by row from the top, as PNG.
pub(super) fn encode(width: usize, height: usize, rgba: &[u8]) -> Result<String, DataError> {
    let mut bytes = Vec::new();
    let fail = |error: png::EncodingError| DataError::invalid(format!("a picture could not be encoded: {error}"));
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgba);
    // The file gets a third larger, and a user waits for it no longer.
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().map_err(fail)?;
    writer.write_image_data(rgba).map_err(fail)?;
    writer.finish().map_err(fail)?;
    Ok(STANDARD.encode(bytes))
}
