//! Files appear whole or not at all: written beside their final place, flushed to the disk, then renamed.

use std::cell::Cell;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::DataError;

/// Writes `path` through `content`. If anything fails, the path keeps what it held before, and nothing is left behind.
pub fn write_atomic(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), DataError> {
    try_write(path, content).map_err(|source| DataError::Unwritable { path: path.to_path_buf(), source })
}

fn try_write(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".nisp-").suffix(".tmp");
    readable_by_others(&mut builder);
    let mut file = builder.tempfile_in(folder)?;
    {
        let mut buffer = BufWriter::new(file.as_file_mut());
        content(&mut buffer)?;
        buffer.flush()?;
    }
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    sync_folder(folder);
    Ok(())
}

/// Temporary files are private by default; a result is not.
#[cfg(unix)]
fn readable_by_others(builder: &mut tempfile::Builder<'_, '_>) {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666)); // less the umask
}

#[cfg(not(unix))]
fn readable_by_others(_builder: &mut tempfile::Builder<'_, '_>) {}

/// Makes the rename itself durable. Not every file system can, and the file is complete without it.
fn sync_folder(folder: &Path) {
    if let Ok(handle) = File::open(folder) {
        let _ = handle.sync_all();
    }
}

/// A folder for results that is known to be writable before the work starts.
///
/// If the folder was made here and nothing was ever written into it, it is removed again when dropped.
#[derive(Debug)]
pub struct OutDir {
    path: PathBuf,
    made_here: bool,
    used: Cell<bool>,
}

impl OutDir {
    /// Makes the folder (and its parents) if needed, and proves with a probe file that it can be written.
    pub fn create(path: impl AsRef<Path>) -> Result<OutDir, DataError> {
        let path = path.as_ref().to_path_buf();
        let fail = |source| DataError::Unwritable { path: path.clone(), source };
        let made_here = !path.exists();
        fs::create_dir_all(&path).map_err(fail)?;
        let out = OutDir { path: path.clone(), made_here, used: Cell::new(false) };
        tempfile::Builder::new().prefix(".nisp-").suffix(".tmp").tempfile_in(&path).map_err(fail)?;
        Ok(out)
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where a file of this name will stand.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes one file whole, and says where it is.
    pub fn write(
        &self,
        name: &str,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<PathBuf, DataError> {
        let path = self.file(name);
        write_atomic(&path, content)?;
        self.used.set(true);
        Ok(path)
    }
}

impl Drop for OutDir {
    fn drop(&mut self) {
        if self.made_here && !self.used.get() {
            // Fails, as it should, when someone else has put a file there.
            let _ = fs::remove_dir(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_failed_write_keeps_the_old_file_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("f.csv");
        write_atomic(&path, |w| w.write_all(b"old")).unwrap();
        let failed = write_atomic(&path, |w| {
            w.write_all(b"half of the n")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        });
        assert!(failed.unwrap_err().to_string().contains("disk is full"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["f.csv"]);
    }

    #[test]
    fn an_unused_folder_goes_away_and_a_used_one_stays() {
        let folder = tempfile::tempdir().unwrap();
        let unused = folder.path().join("a/b");
        drop(OutDir::create(&unused).unwrap());
        assert!(!unused.exists());
        let used = folder.path().join("c");
        OutDir::create(&used).unwrap().write("x", |w| w.write_all(b"1")).unwrap();
        assert_eq!(names(&used), ["x"]);
    }

    #[test]
    fn a_file_in_the_way_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taken");
        fs::write(&path, "x").unwrap();
        let message = OutDir::create(&path).unwrap_err().to_string();
        assert!(message.contains("a file stands where a folder is needed"), "{message}");
        assert_eq!(fs::read(&path).unwrap(), b"x");
    }
}
