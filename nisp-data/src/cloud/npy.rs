//! NumPy arrays: points in rows of as many columns as a point has numbers, or more in space, organised points, depth images.

use std::path::Path;

use npyz::{NpyFile, NpyHeader, Order};

use super::image::Image;
use crate::DataError;
use crate::components::Components;

/// Bytes of a header at most, as in NumPy itself.
const MOST_HEADER: usize = 10_000;
/// Brackets within brackets of a header at most: a name, a tuple and a list need three.
const DEEPEST: usize = 16;

/// Columns from which on an array is a depth image: no point has so many members.
const IMAGE: u64 = 17;

/// An array whose numbers are all there.
pub(super) struct Array<'a> {
    header: NpyHeader,
    numbers: &'a [u8],
}

impl<'a> Array<'a> {
    /// Reads the header, and compares the size that it declares with what follows.
    pub(super) fn new(path: &Path, bytes: &'a [u8]) -> Result<Self, DataError> {
        refuse_strange(path, bytes)?;
        let mut numbers = bytes;
        let header = NpyHeader::from_reader(&mut numbers).map_err(|error| unreadable(path, &error))?;
        let each = header.dtype().num_bytes().map(|size| size as u64);
        let size = each.and_then(|each| header.shape().iter().try_fold(each, |all, size| all.checked_mul(*size)));
        match size {
            Some(size) if size == numbers.len() as u64 => Ok(Self { header, numbers }),
            Some(size) => {
                let held = numbers.len();
                Err(DataError::file(path, format!("declares {size} bytes of numbers and holds {held}; save it again")))
            }
            None => Err(DataError::file(path, "an array of objects, not of numbers; save it as float32 or float64")),
        }
    }

    /// Whether it may be a cloud.
    pub(super) fn is_cloud(&self, components: Components<'_>) -> bool {
        let least = components.count() as u64;
        matches!(self.header.shape(), &[_, width] | &[_, _, width] if (least..IMAGE).contains(&width))
    }

    /// A depth image, if it is one.
    pub(super) fn image(self, path: &Path) -> Result<Option<Image>, DataError> {
        let &[height, width] = self.header.shape() else { return Ok(None) };
        if width < IMAGE {
            return Ok(None);
        }
        let is_by_rows = self.header.order() == Order::C;
        let file = NpyFile::with_header(self.header, self.numbers);
        let (height, width) = (height as usize, width as usize);
        let (flat, is_whole) = match file.try_data::<u16>() {
            Ok(data) => {
                let whole: std::io::Result<Vec<f64>> = data.map(|value| value.map(f64::from)).collect();
                (whole.map_err(|error| unreadable(path, &error))?, true)
            }
            Err(file) => (numbers(path, file)?, false),
        };
        let by_columns = || (0..height * width).map(|index| flat[index % width * height + index / width]).collect();
        let depths = if is_by_rows { flat } else { by_columns() };
        Ok(Some(if is_whole { Image::of_numbers(width, depths) } else { Image { width, depths, metres: 1.0 } }))
    }

    /// Its points.
    pub(super) fn points(self, path: &Path, components: Components<'_>) -> Result<Vec<[f64; 3]>, DataError> {
        let (shape, order) = (self.header.shape().to_vec(), self.header.order());
        let (count, width) = match *shape.as_slice() {
            [count, width] => (count, width),
            [rows, columns, width] if order == Order::C => (rows * columns, width),
            _ => {
                return Err(DataError::file(
                    path,
                    format!("an array of shape {shape:?}; (n, {}) is needed", components.count()),
                ));
            }
        };
        components.refuse_width(path, width as usize)?;
        let flat = numbers(path, NpyFile::with_header(self.header, self.numbers))?;
        let (count, width) = (count as usize, width as usize);
        let at = |row: usize, column: usize| match order {
            Order::C => flat[row * width + column],
            Order::Fortran => flat[column * count + row],
        };
        let of = |row: usize, axis: usize| if axis < components.count() { at(row, axis) } else { 0.0 };
        Ok((0..count).map(|row| [0, 1, 2].map(|axis| of(row, axis))).collect())
    }
}

fn numbers(path: &Path, file: NpyFile<&[u8]>) -> Result<Vec<f64>, DataError> {
    let collect = |result: std::io::Result<Vec<f64>>| result.map_err(|error| unreadable(path, &error));
    let file = match file.try_data::<f64>() {
        Ok(data) => return collect(data.collect()),
        Err(file) => file,
    };
    match file.try_data::<f32>() {
        Ok(data) => collect(data.map(|value| value.map(f64::from)).collect()),
        Err(file) => {
            let what = format!("an array of type {}; save it as float32 or float64", file.dtype().descr());
            Err(DataError::file(path, what))
        }
    }
}

/// Refuses headers that the crate behind this would follow into a panic: too deep, or of a size that no number holds.
fn refuse_strange(path: &Path, bytes: &[u8]) -> Result<(), DataError> {
    let header = header(bytes).ok_or_else(|| DataError::file(path, "ends within its header; save it again"))?;
    let mut depth = 0_usize;
    let deepest = header.iter().map(|byte| match byte {
        b'(' | b'[' | b'{' => {
            depth += 1;
            depth
        }
        b')' | b']' | b'}' => {
            depth = depth.saturating_sub(1);
            depth
        }
        _ => depth,
    });
    if header.len() > MOST_HEADER || deepest.max().unwrap_or(0) > DEEPEST {
        return Err(DataError::file(path, "has a header that no array needs; save it again"));
    }
    let text = String::from_utf8_lossy(header);
    for (at, _) in text.match_indices("shape") {
        let tuple = text[at..].split(')').next().unwrap_or_default();
        let sizes = tuple.split(|letter: char| !letter.is_ascii_digit()).filter(|digits| !digits.is_empty());
        let mut all = sizes.map(|digits| digits.parse::<u64>().ok());
        let all = all.try_fold(1_u64, |all, size| all.checked_mul(size?.max(1)));
        if all.is_none_or(|all| all > bytes.len() as u64) {
            let tuple = tuple.trim_start_matches(|letter| letter != '(');
            let what = format!("declares an array of shape {tuple:.60}), more than the file holds; save it again");
            return Err(DataError::file(path, what));
        }
    }
    Ok(())
}

/// The header of a file, whose length stands before it in two bytes or, from version 2 on, in four.
fn header(bytes: &[u8]) -> Option<&[u8]> {
    let rest = bytes.get(8..)?;
    let (length, rest) = match bytes[6] {
        1 => rest.split_first_chunk().map(|(length, rest)| (usize::from(u16::from_le_bytes(*length)), rest))?,
        _ => rest.split_first_chunk().map(|(length, rest)| (u32::from_le_bytes(*length) as usize, rest))?,
    };
    rest.get(..length)
}

fn unreadable(path: &Path, error: &std::io::Error) -> DataError {
    let text = error.to_string().replace('\n', " ");
    DataError::file(path, format!("not a readable NumPy file ({text}); save it again"))
}
