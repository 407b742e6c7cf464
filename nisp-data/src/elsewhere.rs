//! Results whose folder cannot be written any more go to another place: they may have taken hours.

use std::path::{Path, PathBuf};

use crate::DataError;
use crate::out_dir::{Content, OutDir};

/// Folders beside the one that was asked for: as many are tried.
const TRIES: usize = 20;

/// Where results went.
#[derive(Debug)]
pub struct Written {
    /// The folder that holds them all; nothing if no place could be written.
    pub folder: Option<PathBuf>,
    /// Why they are not in the folder that was asked for.
    pub fault: Option<DataError>,
}

impl OutDir {
    /// As [`OutDir::write`], but where that fails the files go together to another folder: the same one made anew if it is
    /// gone, a new one beside it, or a new one in the system's temporary folder.
    pub fn write_somewhere(&self, files: &[Content]) -> Written {
        let Err(fault) = self.write(files) else {
            return Written { folder: Some(self.path().to_path_buf()), fault: None };
        };
        let mut places = places(self.path());
        let folder = places.find(|place| OutDir::create(place).is_ok_and(|out| out.write(files).is_ok()));
        Written { folder: folder.or_else(|| temporary(files)), fault: Some(fault) }
    }
}

/// The folder itself, if it is gone, and names beside it that are free.
fn places(path: &Path) -> impl Iterator<Item = PathBuf> {
    let beside = (1..=TRIES).filter_map(|number| {
        let mut name = path.file_name()?.to_os_string();
        name.push(format!("-{number}"));
        Some(path.with_file_name(name))
    });
    std::iter::once(path.to_path_buf()).chain(beside).filter(|place| !place.exists())
}

/// A new folder in the system's temporary folder, with the files.
fn temporary(files: &[Content]) -> Option<PathBuf> {
    let folder = tempfile::Builder::new().prefix("nisp-out-").tempdir().ok()?;
    OutDir::create(folder.path()).ok()?.write(files).ok()?;
    Some(folder.keep())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    const FILES: fn() -> [Content; 2] = || [("source.csv", b"1".to_vec()), ("state.csv", b"2".to_vec())];

    fn holds_them(folder: &Path) -> bool {
        FILES().iter().all(|(name, bytes)| fs::read(folder.join(name)).is_ok_and(|own| own == *bytes))
    }

    #[test]
    fn a_folder_that_is_gone_is_made_again() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("out");
        let out = OutDir::create(&path).unwrap();
        fs::remove_dir_all(&path).unwrap();
        let written = out.write_somewhere(&FILES());
        assert_eq!(written.folder.as_deref(), Some(path.as_path()));
        assert!(written.fault.is_some() && holds_them(&path));
        drop(out);
        assert!(holds_them(&path));
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_left_for_one_beside_it() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("out");
        fs::create_dir_all(path.join("state.csv")).unwrap();
        fs::create_dir(place.path().join("out-1")).unwrap();
        let out = OutDir::create(&path).unwrap();
        let written = out.write_somewhere(&FILES());
        assert_eq!(written.folder, Some(place.path().join("out-2")));
        assert!(written.fault.unwrap().to_string().contains("a folder stands where the file is to be"));
        assert!(holds_them(&place.path().join("out-2")));
        assert!(!path.join("source.csv").exists());
    }

    #[test]
    fn the_temporary_folder_takes_them_in_the_end() {
        let place = tempfile::tempdir().unwrap();
        let parent = place.path().join("parent");
        let out = OutDir::create(parent.join("out")).unwrap();
        fs::remove_dir_all(&parent).unwrap();
        // A file where the parent was: neither the folder nor one beside it can be made.
        fs::write(&parent, "in the way").unwrap();
        let folder = out.write_somewhere(&FILES()).folder.unwrap();
        assert!(folder.starts_with(std::env::temp_dir()) && holds_them(&folder));
        fs::remove_dir_all(folder).unwrap();
    }
}
