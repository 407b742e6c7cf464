//! One process writes into a folder at a time.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use crate::DataError;

/// Name of the file that is locked.
const NAME: &str = ".nisp.lock";
/// The file may be removed by its owner just as it is opened: look again, but not forever.
const TRIES: usize = 10;

/// A folder that no other process takes while this lives.
///
/// The system lets go of the lock when the process ends, however it ends: a file that a dead process left is no obstacle.
#[derive(Debug)]
pub(crate) struct FolderLock {
    path: PathBuf,
    /// Holds the lock until it is closed.
    file: File,
}

impl FolderLock {
    /// Takes the folder.
    ///
    /// # Errors
    /// Another process has it, or the file cannot be made.
    pub(crate) fn take(folder: &Path) -> Result<FolderLock, DataError> {
        let path = folder.join(NAME);
        let fail = |source| DataError::Unwritable { path: folder.to_path_buf(), source };
        for _ in 0..TRIES {
            let mut file =
                OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path).map_err(fail)?;
            match file.try_lock() {
                Ok(()) if !is_there(&file, &path) => continue,
                Ok(()) => {}
                // Some network file systems know no locks; the run is worth more than the guard.
                Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
                Err(TryLockError::Error(error)) => return Err(fail(error)),
                Err(TryLockError::WouldBlock) => {
                    return Err(DataError::Busy { path: folder.to_path_buf(), process: owner(&mut file) });
                }
            }
            // Only told to others: a full disk is found out by whoever writes results.
            let _ = file.set_len(0).and_then(|()| writeln!(file, "{}", std::process::id()));
            return Ok(FolderLock { path, file });
        }
        Err(DataError::Busy { path: folder.to_path_buf(), process: String::new() })
    }

    /// The file that is locked.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        // Before the lock is let go of, and only its own. If it fails, an unlocked file stays, which does no harm.
        if is_there(&self.file, &self.path) {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// The process that has the lock, as it wrote.
fn owner(file: &mut File) -> String {
    let mut text = String::new();
    let read = file.take(20).read_to_string(&mut text);
    let process = read.ok().and_then(|_| text.trim().parse::<u32>().ok());
    process.map_or_else(String::new, |process| format!(" (process {process})"))
}

/// Whether the file that was opened is still the one of this path.
#[cfg(unix)]
fn is_there(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
    match (file.metadata(), fs::metadata(path)) {
        (Ok(own), Ok(there)) => id(own) == id(there),
        _ => false,
    }
}

/// Whether the file that was opened is still the one of this path: elsewhere an open file cannot be removed.
#[cfg(not(unix))]
fn is_there(_file: &File, _path: &Path) -> bool {
    true
}
