//! Archives of NumPy arrays, of which one is the cloud.

use std::io::Read;
use std::path::Path;

use flate2::bufread::DeflateDecoder;
use rawzip::{CompressionMethod, ZipArchive};

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
    let archive = ZipArchive::from_slice(bytes).map_err(|error| unreadable(&error))?;
    let (mut names, mut clouds) = (Vec::new(), Vec::new());
    let (mut entries, mut count, mut left) = (archive.entries(), 0, MOST_BYTES);
    while let Some(entry) = entries.next_entry().map_err(|error| unreadable(&error))? {
        count += 1;
        let name = entry.file_path().try_normalize().map_err(|error| unreadable(&error))?.as_ref().to_string();
        let Some(name) = name.strip_suffix(".npy") else { continue };
        let packed = archive.get_entry(entry.wayfinder()).map_err(|error| unreadable(&error))?;
        let unpacked: Box<dyn Read> = match entry.compression_method() {
            CompressionMethod::STORE => Box::new(packed.data()),
            CompressionMethod::DEFLATE => Box::new(DeflateDecoder::new(packed.data())),
            _ => return Err(unreadable(&"packed in a way that NumPy has not")),
        };
        let mut array = Vec::new();
        // To its end, where its checksum is compared.
        let mut unpacked = packed.verifying_reader(unpacked).take(left + 1);
        unpacked.read_to_end(&mut array).map_err(|error| unreadable(&error))?;
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
    if count != archive.entries_hint() {
        return Err(unreadable(&"not all of its files are there"));
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
