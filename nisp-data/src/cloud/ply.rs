//! PLY: ascii and binary of either byte order, any number type, further properties and elements ignored.

use std::path::Path;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{Header, Property, PropertyAccess, PropertyAccessResult};

use crate::DataError;

struct Vertex([f64; 3]);

impl PropertyAccess for Vertex {
    fn new() -> Vertex {
        Vertex([f64::NAN; 3])
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        self.0[axis] = match property {
            Property::Float(value) => f64::from(value),
            Property::Double(value) => value,
            Property::Char(value) => f64::from(value),
            Property::UChar(value) => f64::from(value),
            Property::Short(value) => f64::from(value),
            Property::UShort(value) => f64::from(value),
            Property::Int(value) => f64::from(value),
            Property::UInt(value) => f64::from(value),
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

/// An element that is no vertex: read, so that the file is known to be whole, and not kept.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Skipped {
        Skipped
    }

    fn set_property(&mut self, _name: &str, _property: Property) -> PropertyAccessResult {
        PropertyAccessResult::Ignored
    }
}

pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let one_line = |error: ParseError| {
        let text: String = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        DataError::file(path, format!("not a readable PLY file ({text:.300}); save it again"))
    };
    refuse_twice(path, bytes)?;
    let mut reader = Reader::new(bytes);
    let header = Parser::<Vertex>::new().read_header(&mut reader).map_err(one_line)?;
    check(path, &header, reader.get_ref().len())?;
    let mut points = Vec::new();
    for (name, element) in &header.elements {
        if name == "vertex" {
            let vertices = Parser::<Vertex>::new().read_payload_for_element(&mut reader, element, &header);
            points = vertices.map_err(one_line)?.into_iter().map(|vertex| vertex.0).collect();
        } else {
            Parser::<Skipped>::new().read_payload_for_element(&mut reader, element, &header).map_err(one_line)?;
        }
    }
    let left = reader.into_inner().trim_ascii().len();
    if left > 0 {
        let what = format!("{left} bytes follow the last of the elements that the PLY header counts; save it again");
        return Err(DataError::file(path, what));
    }
    Ok(points)
}

/// Elements and properties of one name: the reader keeps the last, and would take what follows for something else.
fn refuse_twice(path: &Path, bytes: &[u8]) -> Result<(), DataError> {
    let (mut elements, mut properties) = (Vec::new(), Vec::new());
    for (index, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line);
        let words: Vec<&str> = line.split_whitespace().collect();
        let seen = match words.as_slice() {
            ["end_header", ..] => break,
            ["element", name, ..] => {
                properties.clear();
                Some((&mut elements, name.to_string()))
            }
            ["property", .., name] => Some((&mut properties, name.to_string())),
            _ => None,
        };
        let Some((names, name)) = seen else { continue };
        if names.contains(&name) {
            let what = format!("the second `{}` of the name `{name}`; save it with one", words[0]);
            return Err(DataError::line(path, index + 1, what));
        }
        names.push(name);
    }
    Ok(())
}

/// Whether there are vertices with coordinates, and no more elements than bytes are left for.
fn check(path: &Path, header: &Header, left: usize) -> Result<(), DataError> {
    let Some(vertex) = header.elements.get("vertex") else {
        return Err(DataError::file(path, "the PLY file has no element `vertex`; save the points as vertices"));
    };
    if let Some(axis) = ["x", "y", "z"].iter().find(|axis| !vertex.properties.contains_key(**axis)) {
        let what = format!("the PLY vertices have no property `{axis}`; x, y and z are needed");
        return Err(DataError::file(path, what));
    }
    match header.elements.iter().find(|(_, element)| element.count > left) {
        Some((name, element)) => {
            let what = format!("declares {} times `{name}`, more than the file holds; save it again", element.count);
            Err(DataError::file(path, what))
        }
        None => Ok(()),
    }
}
