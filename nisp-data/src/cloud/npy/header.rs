//! Headers of NumPy arrays: a dictionary as Python writes it, of the type, the order and the shape.

/// Bytes of a header at most, as in NumPy itself.
const MOST_HEADER: usize = 10_000;

/// What a header says of its array.
pub(super) struct Header {
    pub(super) kind: Kind,
    pub(super) shape: Vec<u64>,
    /// Whether columns are whole in memory, and not rows.
    pub(super) is_by_columns: bool,
}

/// Of what type numbers are.
pub(super) enum Kind {
    /// Numbers that are read.
    Number(Number),
    /// Numbers of another type, as NumPy names it, and the bytes of each.
    Other(String, u64),
    /// Anything else.
    Objects,
}

/// A type of numbers, and whether the least byte is first.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Number {
    pub(super) of: Of,
    pub(super) least_first: bool,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Of {
    Double,
    Single,
    /// Whole numbers of two bytes, from zero.
    Short,
}

impl Of {
    /// Bytes of each.
    pub(super) fn bytes(self) -> u64 {
        match self {
            Of::Double => 8,
            Of::Single => 4,
            Of::Short => 2,
        }
    }
}

/// The header of a file and the bytes after it; or what is wrong with it.
pub(super) fn read(bytes: &[u8]) -> Result<(Header, &[u8]), String> {
    let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or("it does not begin as one")?;
    let (text, numbers) = split(rest).ok_or("it ends within its header")?;
    if text.len() > MOST_HEADER {
        return Err("its header is longer than any array needs".into());
    }
    let text = std::str::from_utf8(text).map_err(|_| "its header is no text")?;
    let header = Header::of(text).ok_or_else(|| format!("its header is `{:.60}`", text.trim_end()))?;
    Ok((header, numbers))
}

/// The text of a header, whose length stands before it in two bytes or, from version 2 on, in four; and what follows.
fn split(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (version, rest) = bytes.split_at_checked(2)?;
    let (length, rest) = match version[0] {
        1 => rest.split_first_chunk().map(|(length, rest)| (usize::from(u16::from_le_bytes(*length)), rest))?,
        _ => rest.split_first_chunk().map(|(length, rest)| (u32::from_le_bytes(*length) as usize, rest))?,
    };
    rest.split_at_checked(length)
}

impl Header {
    fn of(text: &str) -> Option<Self> {
        let (mut kind, mut shape, mut is_by_columns) = (None, None, None);
        let mut rest = text.trim().strip_prefix('{')?.strip_suffix('}')?.trim();
        while !rest.is_empty() {
            let (name, after) = quoted(rest)?;
            let value = after.trim_start().strip_prefix(':')?.trim_start();
            let (value, after) = value.split_at(end(value)?);
            match name {
                "descr" => kind = Some(Kind::of(value.trim())?),
                "fortran_order" => is_by_columns = Some(value.trim() == "True"),
                "shape" => shape = Some(sizes(value.trim())?),
                _ => return None,
            }
            rest = after.strip_prefix(',').unwrap_or(after).trim_start();
        }
        Some(Self { kind: kind?, shape: shape?, is_by_columns: is_by_columns? })
    }
}

/// What stands between the quotes that a text begins with, and what follows.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let mark = text.chars().next().filter(|mark| ['\'', '"'].contains(mark))?;
    text[1..].split_once(mark)
}

/// Where a value ends: at a comma that is within no brackets, or with the text.
fn end(text: &str) -> Option<usize> {
    let mut depth = 0_i32;
    for (at, letter) in text.char_indices() {
        match letter {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            ',' if depth == 0 => return Some(at),
            _ => {}
        }
    }
    (depth == 0).then_some(text.len())
}

/// The sizes of a tuple.
fn sizes(tuple: &str) -> Option<Vec<u64>> {
    let inner = tuple.strip_prefix('(')?.strip_suffix(')')?.trim();
    let inner = inner.strip_suffix(',').unwrap_or(inner);
    if inner.is_empty() {
        return Some(Vec::new());
    }
    inner.split(',').map(|size| size.trim().trim_end_matches('L').parse().ok()).collect()
}

impl Kind {
    fn of(value: &str) -> Option<Self> {
        if value.starts_with('[') {
            // A table of several members.
            return Some(Kind::Objects);
        }
        let (name, after) = quoted(value)?;
        let (order, kind) = name.split_at_checked(1)?;
        let least_first = match order {
            "<" | "|" => true,
            ">" => false,
            "=" => cfg!(target_endian = "little"),
            _ => return None,
        };
        let of = match kind {
            "f8" => Of::Double,
            "f4" => Of::Single,
            "u2" => Of::Short,
            _ => {
                let size = kind.get(1..)?.parse().ok().filter(|_| !kind.starts_with('O'));
                return Some(size.map_or(Kind::Objects, |size| Kind::Other(name.to_string(), size)));
            }
        };
        after.is_empty().then_some(Kind::Number(Number { of, least_first }))
    }
}
