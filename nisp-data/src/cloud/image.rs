//! Depth images, and those in 16 bit greys.

use std::io::Cursor;
use std::path::Path;

use png::{BitDepth, ColorType, Decoder, Limits};

use crate::DataError;

/// Bytes of an image at most: more than any depth camera makes.
const MOST: usize = 1 << 28;

/// Metres in one whole number of a depth image, as cameras have it.
const MILLIMETRE: f64 = 1e-3;

/// A depth image, row by row; what is zero or not finite was not measured.
pub(super) struct Image {
    /// Pixels in a row.
    pub(super) width: usize,
    /// Depths, in units of the image.
    pub(super) depths: Vec<f64>,
    /// Metres in one of these units, where nothing else is said.
    pub(super) metres: f64,
}

impl Image {
    /// Of whole numbers.
    pub(super) fn of_numbers(width: usize, depths: Vec<f64>) -> Self {
        Self { width, depths, metres: MILLIMETRE }
    }
}

/// Reads a PNG.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Image, DataError> {
    let unreadable =
        |error: png::DecodingError| DataError::file(path, format!("not a readable PNG ({error}); save it again"));
    let decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: MOST });
    let mut reader = decoder.read_info().map_err(unreadable)?;
    let found = reader.output_color_type();
    if found != (ColorType::Grayscale, BitDepth::Sixteen) {
        let what = format!("is a picture ({:?}, {} bit); a depth image has greys of 16 bit", found.0, found.1 as u8);
        return Err(DataError::file(path, what));
    }
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let size = reader.output_buffer_size().filter(|&size| size <= MOST);
    let mut greys = vec![0; size.ok_or_else(|| DataError::file(path, "is larger than any depth image"))?];
    reader.next_frame(&mut greys).map_err(unreadable)?;
    let (pairs, _) = greys.as_chunks();
    let depths = pairs.iter().take(width * height).map(|&pair| f64::from(u16::from_be_bytes(pair)));
    Ok(Image::of_numbers(width, depths.collect()))
}
