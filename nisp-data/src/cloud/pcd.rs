//! PCD (Point Cloud Library), ascii and binary. No maintained crate reads it.

use std::collections::BTreeMap;
use std::path::Path;

use crate::DataError;
use crate::input::decode as decode_text;

/// A field's bytes, or its values, at most.
const MOST_IN_FIELD: usize = 1 << 16;

/// What the header says of the points' layout.
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
    let (lines, body) = header_lines(path, bytes)?;
    let header = header(path, &lines)?;
    let places = places(path, &header)?;
    match header.data.as_str() {
        "ascii" => ascii(path, &header, places, body),
        "binary" => binary(path, &header, places, body),
        other => {
            let what = format!("PCD data of kind `{other}` is not supported; save it as binary or ascii");
            Err(DataError::file(path, what))
        }
    }
}

/// The words of every line down to `DATA`, by the first of them, and what follows.
fn header_lines<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Lines, &'a [u8]), DataError> {
    let mut lines = Lines::new();
    let mut rest = bytes;
    while !lines.contains_key("DATA") {
        let Some(end) = rest.iter().position(|&byte| byte == b'\n') else {
            return Err(DataError::file(path, "the PCD header has no DATA line; save the file again"));
        };
        let line = String::from_utf8_lossy(&rest[..end]).into_owned();
        rest = &rest[end + 1..];
        let mut words = line.split_whitespace().map(str::to_string);
        let Some(first) = words.next().filter(|word| !word.starts_with('#')) else { continue };
        if lines.contains_key(&first) {
            return Err(DataError::file(path, format!("the PCD header has two lines `{first:.20}`; save it again")));
        }
        lines.insert(first, words.collect());
    }
    Ok((lines, rest))
}

type Lines = BTreeMap<String, Vec<String>>;

/// What the header's lines say together.
fn header(path: &Path, lines: &Lines) -> Result<Header, DataError> {
    let fail = |what: String| DataError::file(path, format!("{what}; save the PCD file again"));
    let names = lines.get("FIELDS").ok_or_else(|| fail("the header has no line FIELDS".into()))?;
    // A line of one word for each field.
    let each = |key: &str| {
        let words = lines.get(key).ok_or_else(|| fail(format!("the header has no line {key}")))?;
        let counts = (words.len(), names.len());
        if counts.0 == counts.1 {
            Ok(words)
        } else {
            Err(fail(format!("{} words in {key} for {} FIELDS", counts.0, counts.1)))
        }
    };
    let number = |key: &str, word: &String| {
        let number = word.parse::<usize>().ok().filter(|number| (1..=MOST_IN_FIELD).contains(number));
        number.ok_or_else(|| fail(format!("`{word:.20}` in {key} is no size")))
    };
    let ones = vec!["1".to_string(); names.len()];
    let counts = if lines.contains_key("COUNT") { each("COUNT")? } else { &ones };
    let mut fields = Vec::new();
    for (((name, size), kind), count) in names.iter().zip(each("SIZE")?).zip(each("TYPE")?).zip(counts) {
        fields.push(Field {
            name: name.clone(),
            size: number("SIZE", size)?,
            kind: kind.chars().next().unwrap_or(' '),
            count: number("COUNT", count)?,
        });
    }
    let data = lines.get("DATA").and_then(|words| words.first()).cloned().unwrap_or_default();
    Ok(Header { fields, points: points(lines).map_err(fail)?, data })
}

/// The number of points: that of POINTS, that of WIDTH times HEIGHT, or both if they agree.
fn points(lines: &Lines) -> Result<usize, String> {
    let number = |key: &str| match lines.get(key).map(Vec::as_slice) {
        None => Ok(None),
        Some([word]) if word.parse::<usize>().is_ok() => Ok(word.parse::<usize>().ok()),
        Some(words) => Err(format!("`{:.20}` in {key} is no number of points", words.join(" "))),
    };
    let image = match (number("WIDTH")?, number("HEIGHT")?) {
        (Some(width), Some(height)) => {
            Some(width.checked_mul(height).ok_or("WIDTH times HEIGHT is no number of points")?)
        }
        _ => None,
    };
    match (number("POINTS")?, image) {
        (Some(points), Some(image)) if points != image => {
            Err(format!("POINTS are {points}, and WIDTH times HEIGHT is {image}"))
        }
        (Some(points), _) | (None, Some(points)) => Ok(points),
        (None, None) => Err("the header has no line POINTS".into()),
    }
}

/// Where one coordinate stands: among a point's values, among its bytes, and as what.
#[derive(Clone, Copy)]
struct Place<'a> {
    value: usize,
    byte: usize,
    field: &'a Field,
}

/// The places of x, y and z.
fn places<'a>(path: &Path, header: &'a Header) -> Result<[Place<'a>; 3], DataError> {
    let place = |axis: &str| {
        let (mut value, mut byte) = (0, 0);
        let mut found = None;
        for field in &header.fields {
            if field.name == axis && field.count == 1 && found.replace(Place { value, byte, field }).is_some() {
                return Err(DataError::file(path, format!("the PCD file has two fields `{axis}`; save it with one")));
            }
            value += field.count;
            byte += field.count * field.size;
        }
        let missing = || DataError::file(path, format!("the PCD file has no field `{axis}`; x, y and z are needed"));
        found.ok_or_else(missing)
    };
    Ok([place("x")?, place("y")?, place("z")?])
}

fn ascii(path: &Path, header: &Header, places: [Place<'_>; 3], body: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let text = decode_text(path, body)?;
    let width: usize = header.fields.iter().map(|field| field.count).sum();
    let mut points = Vec::new();
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.len() != width {
            let what = format!("point {}: {} values where the header counts {width}", points.len() + 1, words.len());
            return Err(DataError::file(path, what));
        }
        let mut point = [0.0; 3];
        for (coordinate, place) in point.iter_mut().zip(places) {
            let word = words[place.value];
            *coordinate = word.parse().map_err(|_| {
                let name = &place.field.name;
                let what = format!("point {}: `{word:.24}` for `{name}` is not a number", points.len() + 1);
                DataError::file(path, what)
            })?;
        }
        points.push(point);
    }
    if points.len() == header.points { Ok(points) } else { Err(miscounted(path, points.len(), header.points)) }
}

fn miscounted(path: &Path, held: usize, declared: usize) -> DataError {
    let what = format!("the PCD file holds {held} points and declares {declared}; record or copy it again");
    DataError::file(path, what)
}

fn binary(path: &Path, header: &Header, places: [Place<'_>; 3], body: &[u8]) -> Result<Vec<[f64; 3]>, DataError> {
    let stride: usize = header.fields.iter().map(|field| field.count * field.size).sum();
    if header.points.checked_mul(stride) != Some(body.len()) {
        return Err(miscounted(path, body.len() / stride, header.points));
    }
    let number = |row: &[u8], Place { byte, field, .. }: Place<'_>| {
        decode(&row[byte..byte + field.size], field.kind).ok_or_else(|| {
            let what = format!(
                "PCD field `{}` of type {} and size {}; save as F 4 or F 8",
                field.name, field.kind, field.size
            );
            DataError::file(path, what)
        })
    };
    let point = |row: &[u8]| Ok([number(row, places[0])?, number(row, places[1])?, number(row, places[2])?]);
    body.chunks_exact(stride).map(point).collect()
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
