//! Puts several files into their places: all of them, or none.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

use crate::atomic::{SUFFIX, folder_of};

/// A file that stands in its place, and the one that stood there before, under another name.
struct Placed {
    path: PathBuf,
    before: Option<TempPath>,
}

/// Renames staged files to their final paths. If one cannot be renamed, the others get back what they held before, and its
/// path is returned with the reason. Names of temporary files begin with `prefix`.
pub(crate) fn replace(staged: Vec<(PathBuf, NamedTempFile)>, prefix: &str) -> Result<(), (PathBuf, io::Error)> {
    let mut placed: Vec<Placed> = Vec::new();
    for (path, file) in staged {
        let put = keep(&path, prefix).and_then(|before| match file.persist(&path) {
            Ok(_) => Ok(before),
            Err(error) => Err(error.error),
        });
        match put {
            Ok(before) => placed.push(Placed { path, before }),
            Err(error) => {
                undo(placed);
                return Err((path, error));
            }
        }
    }
    Ok(())
}

/// Gives the file of a path a second name, under which it outlives being replaced; nothing if there is none.
fn keep(path: &Path, prefix: &str) -> io::Result<Option<TempPath>> {
    match fs::symlink_metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
        Ok(metadata) if metadata.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(_) => {}
    }
    let second = |make: &dyn Fn(&Path) -> io::Result<()>| {
        tempfile::Builder::new().prefix(prefix).suffix(SUFFIX).make_in(folder_of(path), make)
    };
    // Not every file system has second names.
    let kept = second(&|name| fs::hard_link(path, name)).or_else(|_| second(&|name| fs::copy(path, name).map(drop)))?;
    Ok(Some(kept.into_temp_path()))
}

/// Puts back what stood there before. What cannot be put back stays as it is: the first fault is the one to tell.
fn undo(placed: Vec<Placed>) {
    for Placed { path, before } in placed.into_iter().rev() {
        let _ = match before {
            Some(before) => before.persist(&path).map_err(|error| error.error),
            None => fs::remove_file(&path),
        };
    }
}
