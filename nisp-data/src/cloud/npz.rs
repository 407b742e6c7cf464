//! Archives of NumPy arrays, of which one is the cloud.

use std::io::{Cursor, Read};
use std::path::Path;

use zip::ZipArchive;

use super::npy::Array;
use crate::DataError;
use crate::components::Components;
use crate::input::MOST_BYTES;

/// Takes the only array that can be a cloud.
pub(super) fn parse(path: &Path, bytes: &[u8], components: Components<'_>) -> Result<Vec<[f64; 3]>, DataError> {
    let unreadable = |error: &dyn std::fmt::Display| {
        let text = error.to_string().replace('\n', " ");
        DataError::file(path, format!("not a readable NPZ archive ({text}); save or copy it again"))
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| unreadable(&error))?;
    let (mut names, mut clouds) = (Vec::new(), Vec::new());
    let mut left = MOST_BYTES;
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(|error| unreadable(&error))?;
        let name = entry.name().map_err(|error| unreadable(&error))?.to_string();
        let Some(name) = name.strip_suffix(".npy") else { continue };
        let mut array = Vec::new();
        // To its end, where its checksum is compared.
        entry.take(left + 1).read_to_end(&mut array).map_err(|error| unreadable(&error))?;
        let Some(rest) = left.checked_sub(array.len() as u64) else {
            let what = format!("unpacks to more than {} MiB; save the cloud alone as .npy", MOST_BYTES >> 20);
            return Err(DataError::file(path, what));
        };
        left = rest;
        if Array::new(path, &array)?.is_cloud(components) {
            clouds.push(array);
        }
        names.push(name.to_string());
    }
    match clouds.as_slice() {
        [cloud] => Array::new(path, cloud)?.points(path, components),
        _ => {
            let (count, names) = (clouds.len(), names.join(", "));
            let width = components.count();
            let what =
                format!("{count} of its arrays ({names}) have the shape (n, {width}); save the cloud alone as .npy");
            Err(DataError::file(path, what))
        }
    }
}
