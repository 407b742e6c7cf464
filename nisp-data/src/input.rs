//! Reads whole files, and only files that end.

use std::fs::{File, Metadata};
use std::io::Read;
use std::path::Path;

use crate::DataError;

/// Bytes of a table, a cloud or a configuration at most. Ten million points fit; a solver can use far fewer.
pub const MOST_BYTES: u64 = 256 << 20;

/// The bytes of a file, of which there may be `most`.
///
/// # Errors
/// Nothing stands there, it is a folder, a device or a pipe, it is larger than `most`, or the system refuses.
pub fn read_bytes(path: impl AsRef<Path>, most: u64) -> Result<Vec<u8>, DataError> {
    let path = path.as_ref();
    let fail = |source| DataError::reading(path, source);
    // Before it is opened: to open a pipe that nobody writes to would wait forever.
    let metadata = std::fs::metadata(path).map_err(fail)?;
    if let Some(what) = not_a_file(&metadata) {
        return Err(DataError::file(path, what));
    }
    let too_large = || {
        let what = format!("is larger than {} MiB; leave out what is not needed, or thin it out", most >> 20);
        DataError::file(path, what)
    };
    if metadata.len() > most {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    // A file may grow, and some that the system makes up say that they are empty.
    File::open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes)).map_err(fail)?;
    if bytes.len() as u64 > most { Err(too_large()) } else { Ok(bytes) }
}

/// The text of a file in UTF-8, at most [`MOST_BYTES`] long.
///
/// # Errors
/// As [`read_bytes`], or the bytes are no UTF-8.
pub fn read_text(path: impl AsRef<Path>) -> Result<String, DataError> {
    let path = path.as_ref();
    let utf8 = String::from_utf8(read_bytes(path, MOST_BYTES)?);
    utf8.map_err(|error| DataError::not_utf8(path, error.utf8_error()))
}

/// Text in UTF-8, without a byte order mark; `path` names the source in errors.
pub(crate) fn decode<'a>(path: &Path, bytes: &'a [u8]) -> Result<&'a str, DataError> {
    let text = std::str::from_utf8(bytes).map_err(|error| DataError::not_utf8(path, error))?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// What stands there instead of a file, and what to do.
fn not_a_file(metadata: &Metadata) -> Option<&'static str> {
    if metadata.is_file() {
        None
    } else if metadata.is_dir() {
        Some("is a folder; name a file inside it")
    } else {
        Some("is a device or a pipe; save what it gives to a file, and name that")
    }
}
