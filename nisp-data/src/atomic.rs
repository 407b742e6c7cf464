//! Files appear whole or not at all: written beside their final place, flushed to the disk, then renamed.

use std::cell::Cell;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::DataError;

/// Writes `path` through `content`. If anything fails, the path keeps what it held before, and nothing is left behind.
pub fn write_atomic(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), DataError> {
    try_write(path, content).map_err(|source| DataError::Unwritable { path: path.to_path_buf(), source })
}

fn try_write(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    stage(path, content)?.persist(path).map_err(|error| error.error)?;
    sync_folder(folder_of(path));
    Ok(())
}

/// Writes the content beside its final place, through to the disk. The file goes away if it is dropped.
fn stage(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".nisp-").suffix(".tmp");
    readable_by_others(&mut builder);
    let mut file = builder.tempfile_in(folder_of(path))?;
    {
        let mut buffer = BufWriter::new(file.as_file_mut());
        content(&mut buffer)?;
        buffer.flush()?;
    }
    file.as_file().sync_all()?;
    Ok(file)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
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
/// If nothing was ever written into it, what was made of it (and of its parents) is removed again when dropped.
#[derive(Debug)]
pub struct OutDir {
    path: PathBuf,
    /// Folders that were not there before, the innermost first.
    made: Vec<PathBuf>,
    used: Cell<bool>,
}

/// A file that waits to be written: its name in the folder, and its bytes.
pub type Content = (&'static str, Vec<u8>);

impl OutDir {
    /// Makes the folder (and its parents) if needed, and proves with a probe file that it can be written.
    pub fn create(path: impl AsRef<Path>) -> Result<OutDir, DataError> {
        let path = path.as_ref().to_path_buf();
        let fail = |source| DataError::Unwritable { path: path.clone(), source };
        let absent = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
        let made = path.ancestors().take_while(absent).map(Path::to_path_buf).collect();
        let out = OutDir { path: path.clone(), made, used: Cell::new(false) };
        fs::create_dir_all(&path).map_err(fail)?;
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

    /// Writes several files: all of them or, if one cannot be written, none.
    pub fn write(&self, files: &[Content]) -> Result<(), DataError> {
        let fail = |name: &str| {
            let path = self.file(name);
            move |source| DataError::Unwritable { path, source }
        };
        let mut staged = Vec::new();
        for (name, bytes) in files {
            staged.push((name, stage(&self.file(name), |out| out.write_all(bytes)).map_err(fail(name))?));
        }
        // Everything is on the disk: what is left are renames within a folder.
        for (name, file) in staged {
            file.persist(self.file(name)).map_err(|error| fail(name)(error.error))?;
            self.used.set(true);
        }
        sync_folder(&self.path);
        Ok(())
    }
}

impl Drop for OutDir {
    fn drop(&mut self) {
        if !self.used.get() {
            for folder in &self.made {
                // Fails, as it should, when someone else has put a file there.
                let _ = fs::remove_dir(folder);
            }
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
        drop(OutDir::create(folder.path().join("a/b")).unwrap());
        assert!(!folder.path().join("a").exists());
        let used = folder.path().join("c");
        OutDir::create(&used).unwrap().write(&[("x", b"1".to_vec())]).unwrap();
        assert_eq!(names(&used), ["x"]);
    }

    #[test]
    fn files_that_belong_together_are_written_together_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let out = OutDir::create(folder.path().join("a")).unwrap();
        // The second file's folder does not exist, so that it cannot be staged.
        assert!(out.write(&[("x", b"1".to_vec()), ("none/y", b"2".to_vec())]).is_err());
        assert!(names(out.path()).is_empty());
        drop(out);
        assert!(!folder.path().join("a").exists());
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
