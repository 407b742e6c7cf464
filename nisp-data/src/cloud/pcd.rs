//! PCD (Point Cloud Library), ascii and binary. No maintained crate reads it.

use std::path::Path;

use crate::DataError;

/// What the header says of the points' layout.
#[derive(Default)]
struct Header {
    fields: Vec<Field>,
    points: usize,
    data: String,
}

/// One field of a point.
struct Field {
    name: String,
    size: usize,
    kind: char,
    count: usize,
}

pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let (header, body) = read_header(path, bytes)?;
    match header.data.as_str() {
        "ascii" => ascii(path, &header, body),
        "binary" => binary(path, &header, body),
        other => {
            let what = format!("PCD data of kind `{other}` is not supported; save it as binary or ascii");
            Err(DataError::file(path, what))
        }
    }
}

fn read_header<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Header, &'a [u8]), DataError> {
    let mut header = Header::default();
    let (mut sizes, mut kinds, mut counts) = (Vec::new(), Vec::new(), Vec::new());
    let mut names: Vec<String> = Vec::new();
    let mut rest = bytes;
    while header.data.is_empty() {
        let Some(end) = rest.iter().position(|&byte| byte == b'\n') else {
            return Err(DataError::file(path, "the PCD header has no DATA line; save the file again"));
        };
        let line = String::from_utf8_lossy(&rest[..end]).trim().to_string();
        rest = &rest[end + 1..];
        let mut words = line.split_whitespace().map(str::to_string);
        match words.next().as_deref() {
            Some("FIELDS") => names = words.collect(),
            Some("SIZE") => sizes = words.collect(),
            Some("TYPE") => kinds = words.collect(),
            Some("COUNT") => counts = words.collect(),
            Some("POINTS") => header.points = words.next().and_then(|word| word.parse().ok()).unwrap_or(0),
            Some("DATA") => header.data = words.next().unwrap_or_else(|| "missing".into()),
            _ => {}
        }
    }
    let number = |words: &[String], index: usize, default: usize| {
        words.get(index).and_then(|word| word.parse().ok()).filter(|&value| value <= 1 << 16).unwrap_or(default)
    };
    let field = |(index, name): (usize, String)| Field {
        name,
        size: number(&sizes, index, 4),
        kind: kinds.get(index).and_then(|word: &String| word.chars().next()).unwrap_or('F'),
        count: number(&counts, index, 1),
    };
    header.fields = names.into_iter().enumerate().map(field).collect();
    Ok((header, rest))
}

/// For x, y and z: the index among a point's values, the byte offset, and the field itself.
fn places<'a>(path: &Path, header: &'a Header) -> Result<[(usize, usize, &'a Field); 3], DataError> {
    let place = |axis: &str| {
        let (mut value, mut byte) = (0, 0);
        for field in &header.fields {
            if field.name == axis && field.count == 1 {
                return Ok((value, byte, field));
            }
            value += field.count;
            byte += field.count * field.size;
        }
        Err(DataError::file(path, format!("the PCD file has no field `{axis}`; x, y and z are needed")))
    };
    Ok([place("x")?, place("y")?, place("z")?])
}

fn ascii(path: &Path, header: &Header, body: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let places = places(path, header)?;
    let text = String::from_utf8_lossy(body);
    let mut points = Vec::new();
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let mut point = [0.0; 3];
        for (value, (index, _, field)) in point.iter_mut().zip(places) {
            let word = words.get(index).copied().unwrap_or("");
            *value = word.parse().map_err(|_| {
                let what = format!("point {}: `{word}` for `{}` is not a number", points.len() + 1, field.name);
                DataError::file(path, what)
            })?;
        }
        points.push(point);
    }
    Ok(points)
}

fn binary(path: &Path, header: &Header, body: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let places = places(path, header)?;
    let stride: usize = header.fields.iter().map(|field| field.count * field.size).sum();
    let held = body.len() / stride.max(1);
    if held < header.points {
        let what = format!("the PCD file ends after {held} of {} points; record or copy it again", header.points);
        return Err(DataError::file(path, what));
    }
    let number = |row: &[u8], (_, byte, field): (usize, usize, &Field)| {
        decode(&row[byte..byte + field.size], field.kind).ok_or_else(|| {
            let what = format!(
                "PCD field `{}` of type {} and size {}; save as F 4 or F 8",
                field.name, field.kind, field.size
            );
            DataError::file(path, what)
        })
    };
    let point = |row: &[u8]| Ok([number(row, places[0])?, number(row, places[1])?, number(row, places[2])?]);
    body.chunks_exact(stride.max(1)).take(header.points).map(point).collect()
}

fn decode(bytes: &[u8], kind: char) -> Option<f64> {
    match (kind, bytes) {
        ('F', &[a, b, c, d]) => Some(f64::from(f32::from_le_bytes([a, b, c, d]))),
        ('F', bytes) => Some(f64::from_le_bytes(bytes.try_into().ok()?)),
        ('I', &[a, b]) => Some(f64::from(i16::from_le_bytes([a, b]))),
        ('I', &[a, b, c, d]) => Some(f64::from(i32::from_le_bytes([a, b, c, d]))),
        _ => None,
    }
}
