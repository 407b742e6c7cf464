//! PLY: ascii and binary of either byte order, any number type, further properties and elements ignored.

mod header;

use std::path::Path;
use std::str::SplitWhitespace;

use crate::DataError;
use header::{Element, Format, Header, Kind};

pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let (header, body) = header::read(path, bytes)?;
    check(path, &header, body.len())?;
    let unreadable = |what: String| DataError::file(path, format!("not a readable PLY file ({what}); save it again"));
    let mut numbers = Numbers { format: header.format, rest: body, words: "".split_whitespace() };
    let mut points = Vec::new();
    for element in &header.elements {
        // Others are read as well, so that the file is known to be whole.
        let axes: Vec<Option<usize>> =
            element.properties.iter().map(|property| axis(element, &property.name)).collect();
        for number in 0..element.count {
            let point = read(&mut numbers, element, &axes).map_err(|what| {
                unreadable(format!("{what} in `{:.40}` {} of {}", element.name, number + 1, element.count))
            })?;
            points.extend((element.name == "vertex").then_some(point));
        }
    }
    let left = numbers.rest.trim_ascii().len();
    if left > 0 {
        let what = format!("{left} bytes follow the last of the elements that the PLY header counts; save it again");
        return Err(DataError::file(path, what));
    }
    Ok(points)
}

/// Which coordinate a property is.
fn axis(element: &Element, property: &str) -> Option<usize> {
    ["x", "y", "z"].iter().position(|axis| *axis == property).filter(|_| element.name == "vertex")
}

/// Whether there are vertices with coordinates, and no more elements than bytes are left for.
fn check(path: &Path, header: &Header, left: usize) -> Result<(), DataError> {
    let Some(vertex) = header.elements.iter().find(|element| element.name == "vertex") else {
        return Err(DataError::file(path, "the PLY file has no element `vertex`; save the points as vertices"));
    };
    let is_there = |axis: &str| vertex.properties.iter().any(|own| own.name == axis && own.list.is_none());
    if let Some(axis) = ["x", "y", "z"].iter().find(|axis| !is_there(axis)) {
        let what = format!("the PLY vertices have no property `{axis}`; x, y and z are needed");
        return Err(DataError::file(path, what));
    }
    match header.elements.iter().find(|element| element.count > left) {
        Some(Element { name, count, .. }) => {
            let what = format!("declares {count} times `{name:.40}`, more than the file holds; save it again");
            Err(DataError::file(path, what))
        }
        None => Ok(()),
    }
}

/// Reads an element; returns its coordinates.
fn read(numbers: &mut Numbers<'_>, element: &Element, axes: &[Option<usize>]) -> Result<[f64; 3], String> {
    let mut point = [f64::NAN; 3];
    if !element.properties.is_empty() {
        numbers.begin()?;
    }
    for (property, axis) in element.properties.iter().zip(axes) {
        let Some(count) = property.list else {
            let value = numbers.next(property.kind)?;
            axis.iter().for_each(|&axis| point[axis] = value);
            continue;
        };
        let count = numbers.next(count)?;
        if count < 0.0 {
            return Err(format!("a list of {count} numbers"));
        }
        for _ in 0..count as u64 {
            numbers.next(property.kind)?;
        }
    }
    numbers.end()?;
    Ok(point)
}

/// The numbers of a file, one after the other.
struct Numbers<'a> {
    format: Format,
    rest: &'a [u8],
    /// Words that are left of a line.
    words: SplitWhitespace<'a>,
}

impl Numbers<'_> {
    /// Begins an element: of words, a line that is not empty.
    fn begin(&mut self) -> Result<(), String> {
        if self.format != Format::Words {
            return Ok(());
        }
        let rest = self.rest.trim_ascii_start();
        let end = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        let line = std::str::from_utf8(&rest[..end]).map_err(|_| "no text")?;
        (self.words, self.rest) = (line.split_whitespace(), &rest[end..]);
        Ok(())
    }

    /// Ends an element.
    fn end(&mut self) -> Result<(), String> {
        self.words.next().map_or(Ok(()), |word| Err(format!("`{word:.40}` behind the last number")))
    }

    fn next(&mut self, kind: Kind) -> Result<f64, String> {
        match self.format {
            Format::Words => {
                let word = self.words.next().ok_or("too few numbers")?;
                let value = match kind {
                    Kind::F32 => word.parse::<f32>().ok().map(f64::from),
                    _ => word.parse::<f64>().ok().filter(|value| fits(kind, *value)),
                };
                value.ok_or_else(|| format!("`{word:.40}`, which is no number of its type,"))
            }
            format => {
                let (own, rest) = self.rest.split_at_checked(kind.bytes()).ok_or("the end of the file")?;
                self.rest = rest;
                let mut bytes = [0; 8];
                bytes[..own.len()].copy_from_slice(own);
                if format == Format::MostByteFirst {
                    bytes[..own.len()].reverse();
                }
                Ok(value(kind, u64::from_le_bytes(bytes)))
            }
        }
    }
}

/// Whether a number that was written out may be of a type.
fn fits(kind: Kind, value: f64) -> bool {
    let whole = |least: f64, most: f64| value.fract() == 0.0 && (least..=most).contains(&value);
    match kind {
        Kind::I8 => whole(i8::MIN.into(), i8::MAX.into()),
        Kind::U8 => whole(0.0, u8::MAX.into()),
        Kind::I16 => whole(i16::MIN.into(), i16::MAX.into()),
        Kind::U16 => whole(0.0, u16::MAX.into()),
        Kind::I32 => whole(i32::MIN.into(), i32::MAX.into()),
        Kind::U32 => whole(0.0, u32::MAX.into()),
        Kind::F32 | Kind::F64 => true,
    }
}

/// The number that the bits of a type are.
fn value(kind: Kind, bits: u64) -> f64 {
    match kind {
        Kind::I8 => f64::from(bits as i8),
        Kind::U8 => f64::from(bits as u8),
        Kind::I16 => f64::from(bits as i16),
        Kind::U16 => f64::from(bits as u16),
        Kind::I32 => f64::from(bits as i32),
        Kind::U32 => f64::from(bits as u32),
        Kind::F32 => f64::from(f32::from_bits(bits as u32)),
        Kind::F64 => f64::from_bits(bits),
    }
}
