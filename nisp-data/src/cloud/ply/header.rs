//! Headers of PLY files: which elements follow, and what each is made of.

use std::path::Path;

use crate::DataError;

/// What a header says of its file.
pub(super) struct Header {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
}

/// How numbers are written.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Format {
    /// As words, an element to a line.
    Words,
    LeastByteFirst,
    MostByteFirst,
}

/// Elements of one kind.
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

/// A number of an element, or a list of them.
pub(super) struct Property {
    pub(super) name: String,
    /// Of what type the number is that a list begins with: how many follow.
    pub(super) list: Option<Kind>,
    pub(super) kind: Kind,
}

/// Types of numbers.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Kind::I8,
            "uchar" | "uint8" => Kind::U8,
            "short" | "int16" => Kind::I16,
            "ushort" | "uint16" => Kind::U16,
            "int" | "int32" => Kind::I32,
            "uint" | "uint32" => Kind::U32,
            "float" | "float32" => Kind::F32,
            "double" | "float64" => Kind::F64,
            _ => return None,
        })
    }

    /// Bytes of a number.
    pub(super) fn bytes(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        }
    }
}

/// Reads a header; returns it with what follows.
pub(super) fn read<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Header, &'a [u8]), DataError> {
    let (mut format, mut elements) = (None, Vec::<Element>::new());
    let mut rest = bytes;
    for number in 1.. {
        let Some(end) = rest.iter().position(|&byte| byte == b'\n') else { break };
        let (line, after) = rest.split_at(end + 1);
        rest = after;
        let line = String::from_utf8_lossy(line);
        let words: Vec<&str> = line.split_whitespace().collect();
        let fail = |what: String| DataError::line(path, number, what);
        match words.as_slice() {
            ["ply"] if number == 1 => {}
            ["format", kind, "1.0"] if format.is_none() => {
                format = Some(match *kind {
                    "ascii" => Format::Words,
                    "binary_little_endian" => Format::LeastByteFirst,
                    "binary_big_endian" => Format::MostByteFirst,
                    _ => return Err(fail(format!("`{kind:.40}` is no format of PLY; save it as ascii"))),
                });
            }
            ["comment" | "obj_info", ..] | [] => {}
            ["element", name, count] => {
                let count = count.parse().map_err(|_| fail(format!("`{count:.40}` is no number of elements")))?;
                refuse_second("element", name, elements.iter().map(|element| &element.name)).map_err(fail)?;
                elements.push(Element { name: name.to_string(), count, properties: Vec::new() });
            }
            ["property", kind @ .., name] => {
                let element = elements.last_mut().ok_or_else(|| fail("a property before any element".into()))?;
                refuse_second("property", name, element.properties.iter().map(|property| &property.name))
                    .map_err(fail)?;
                let property =
                    property(kind, name).ok_or_else(|| fail(format!("no type is `{:.40}`", kind.join(" "))))?;
                element.properties.push(property);
            }
            ["end_header"] => {
                let format = format.ok_or_else(|| fail("the PLY header has no format; save it again".into()))?;
                return Ok((Header { format, elements }, rest));
            }
            _ => return Err(fail(format!("`{:.40}` is not known in a PLY header; save it again", line.trim()))),
        }
    }
    Err(DataError::file(path, "not a readable PLY file (its header does not end); save it again"))
}

fn property(kind: &[&str], name: &str) -> Option<Property> {
    let (list, kind) = match kind {
        ["list", count, kind] => {
            (Some(Kind::named(count).filter(|kind| ![Kind::F32, Kind::F64].contains(kind))?), kind)
        }
        [kind] => (None, kind),
        _ => return None,
    };
    Some(Property { name: name.to_string(), list, kind: Kind::named(kind)? })
}

/// Elements and properties of one name: which of them is meant is not said.
fn refuse_second<'a>(of: &str, name: &str, mut names: impl Iterator<Item = &'a String>) -> Result<(), String> {
    match names.any(|own| own == name) {
        true => Err(format!("the second `{of}` of the name `{name:.40}`; save it with one")),
        false => Ok(()),
    }
}
