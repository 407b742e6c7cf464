//! PLY: ascii and binary of either byte order, any number type, further properties and elements ignored.

use std::path::Path;

use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

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

pub(super) fn parse(path: &Path, mut bytes: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let one_line = |error: ply_rs_bw::parser::ParseError| {
        let text = error.to_string().replace('\n', " ");
        DataError::file(path, format!("not a readable PLY file ({text}); save it again"))
    };
    let mut ply = Parser::<Vertex>::new().read_ply(&mut bytes).map_err(one_line)?;
    let Some(element) = ply.header.elements.get("vertex") else {
        return Err(DataError::file(path, "the PLY file has no element `vertex`; save the points as vertices"));
    };
    if let Some(axis) = ["x", "y", "z"].iter().find(|axis| !element.properties.contains_key(**axis)) {
        return Err(DataError::file(
            path,
            format!("the PLY vertices have no property `{axis}`; x, y and z are needed"),
        ));
    }
    let vertices = ply.payload.swap_remove("vertex").unwrap_or_default();
    Ok(vertices.into_iter().map(|vertex| vertex.0).collect())
}
