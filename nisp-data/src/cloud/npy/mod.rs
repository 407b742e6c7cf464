//! NumPy arrays: points in rows of as many columns as a point has numbers, or more in space, organised points, depth images.

mod header;

use std::path::Path;

use super::image::Image;
use crate::DataError;
use crate::components::Components;
use header::{Header, Kind, Number, Of};

/// Columns from which on an array is a depth image: no point has so many members.
const IMAGE: u64 = 17;

/// An array whose numbers are all there.
pub(super) struct Array<'a> {
    header: Header,
    numbers: &'a [u8],
}

impl<'a> Array<'a> {
    /// Reads the header, and compares the size that it declares with what follows.
    pub(super) fn new(path: &Path, bytes: &'a [u8]) -> Result<Self, DataError> {
        let strange = |what| DataError::file(path, format!("not a readable NumPy file ({what}); save it again"));
        let (header, numbers) = header::read(bytes).map_err(strange)?;
        let each = match header.kind {
            Kind::Number(number) => number.of.bytes(),
            Kind::Other(_, bytes) => bytes,
            Kind::Objects => {
                let what = "an array of objects, not of numbers; save it as float32 or float64";
                return Err(DataError::file(path, what));
            }
        };
        let held = numbers.len();
        // Of each axis by itself, too: an array without rows has any number of columns.
        let size = header.shape.iter().try_fold(each, |all, size| all.checked_mul(*size));
        let is_too_large = header.shape.iter().any(|size| *size > held as u64);
        match size {
            Some(size) if size == held as u64 && !is_too_large => Ok(Self { header, numbers }),
            Some(size) if !is_too_large => {
                Err(DataError::file(path, format!("declares {size} bytes of numbers and holds {held}; save it again")))
            }
            _ => {
                let sizes: Vec<String> = header.shape.iter().map(u64::to_string).collect();
                let tuple = format!("({})", sizes.join(", "));
                let what = format!("declares an array of shape {tuple:.60}, more than the file holds; save it again");
                Err(DataError::file(path, what))
            }
        }
    }

    /// Whether it may be a cloud.
    pub(super) fn is_cloud(&self, components: Components<'_>) -> bool {
        let least = components.count() as u64;
        matches!(*self.header.shape, [_, width] | [_, _, width] if (least..IMAGE).contains(&width))
    }

    /// A depth image, if it is one.
    pub(super) fn image(self, path: &Path) -> Result<Option<Image>, DataError> {
        let [height, width] = *self.header.shape else { return Ok(None) };
        if width < IMAGE {
            return Ok(None);
        }
        let (height, width) = (height as usize, width as usize);
        let is_whole = matches!(self.header.kind, Kind::Number(Number { of: Of::Short, .. }));
        let flat = if is_whole { self.shorts() } else { self.numbers(path)? };
        let by_columns = || (0..height * width).map(|index| flat[index % width * height + index / width]).collect();
        let depths = if self.header.is_by_columns { by_columns() } else { flat };
        Ok(Some(if is_whole { Image::of_numbers(width, depths) } else { Image { width, depths, metres: 1.0 } }))
    }

    /// Its points.
    pub(super) fn points(self, path: &Path, components: Components<'_>) -> Result<Vec<[f64; 3]>, DataError> {
        let (shape, is_by_columns) = (&self.header.shape, self.header.is_by_columns);
        let (count, width) = match *shape.as_slice() {
            [count, width] => (count, width),
            [rows, columns, width] if !is_by_columns => (rows * columns, width),
            _ => {
                return Err(DataError::file(
                    path,
                    format!("an array of shape {shape:?}; (n, {}) is needed", components.count()),
                ));
            }
        };
        components.refuse_width(path, width as usize)?;
        let flat = self.numbers(path)?;
        let (count, width) = (count as usize, width as usize);
        let at =
            |row: usize, column: usize| flat[if is_by_columns { column * count + row } else { row * width + column }];
        let of = |row: usize, axis: usize| if axis < components.count() { at(row, axis) } else { 0.0 };
        Ok((0..count).map(|row| [0, 1, 2].map(|axis| of(row, axis))).collect())
    }

    /// All numbers, if they are of a type that coordinates have.
    fn numbers(&self, path: &Path) -> Result<Vec<f64>, DataError> {
        let (doubles, singles) = (self.numbers.as_chunks().0.iter(), self.numbers.as_chunks().0.iter());
        let name = match &self.header.kind {
            Kind::Number(Number { of: Of::Double, least_first: true }) => {
                return Ok(doubles.map(|bytes| f64::from_le_bytes(*bytes)).collect());
            }
            Kind::Number(Number { of: Of::Double, .. }) => {
                return Ok(doubles.map(|bytes| f64::from_be_bytes(*bytes)).collect());
            }
            Kind::Number(Number { of: Of::Single, least_first: true }) => {
                return Ok(singles.map(|bytes| f64::from(f32::from_le_bytes(*bytes))).collect());
            }
            Kind::Number(Number { of: Of::Single, .. }) => {
                return Ok(singles.map(|bytes| f64::from(f32::from_be_bytes(*bytes))).collect());
            }
            Kind::Number(Number { of: Of::Short, .. }) => "u2",
            Kind::Other(name, _) => name,
            Kind::Objects => "object",
        };
        Err(DataError::file(path, format!("an array of type {name}; save it as float32 or float64")))
    }

    /// All numbers, which are whole ones of two bytes.
    fn shorts(&self) -> Vec<f64> {
        let least_first = matches!(self.header.kind, Kind::Number(Number { least_first: true, .. }));
        let number = |&bytes| if least_first { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) };
        self.numbers.as_chunks().0.iter().map(|bytes| f64::from(number(bytes))).collect()
    }
}
