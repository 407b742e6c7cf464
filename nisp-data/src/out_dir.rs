//! A folder for the results of one run.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::DataError;
use crate::atomic::{SUFFIX, stage, sync_folder};
use crate::lock::FolderLock;
use crate::replace::replace;

/// How the names of a run's temporary files begin. Only who has the folder's lock makes such files.
const PREFIX: &str = ".nisp-run-";

/// A file that waits to be written: its name in the folder, and its bytes.
pub type Content = (&'static str, Vec<u8>);

/// A folder for results that is known to be writable before the work starts, and that no other process takes meanwhile.
///
/// If nothing was ever written into it, what was made of it (and of its parents) is removed again when dropped.
#[derive(Debug)]
pub struct OutDir {
    path: PathBuf,
    /// Folders that were not there before, the innermost first.
    made: Vec<PathBuf>,
    used: AtomicBool,
    lock: Option<FolderLock>,
}

impl OutDir {
    /// Checks before the work starts that no folder stands where one of these files is to be.
    ///
    /// # Errors
    /// One does.
    pub fn require_free(folder: &Path, names: &[&str]) -> Result<(), DataError> {
        let taken = names.iter().map(|name| folder.join(name)).find(|path| path.is_dir());
        let source = io::Error::from(io::ErrorKind::IsADirectory);
        taken.map_or(Ok(()), |path| Err(DataError::Unwritable { path, source }))
    }

    /// Makes the folder (and its parents) if needed, proves with a probe file that it can be written, and takes it.
    ///
    /// # Errors
    /// The folder cannot be made or written, or another process has it.
    pub fn create(path: impl AsRef<Path>) -> Result<OutDir, DataError> {
        let path = path.as_ref().to_path_buf();
        let fail = |source| DataError::Unwritable { path: path.clone(), source };
        let absent = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
        let made = path.ancestors().take_while(absent).map(Path::to_path_buf).collect();
        let mut out = OutDir { path: path.clone(), made, used: AtomicBool::new(false), lock: None };
        fs::create_dir_all(&path).map_err(fail)?;
        tempfile::Builder::new().prefix(PREFIX).suffix(SUFFIX).tempfile_in(&path).map_err(fail)?;
        out.lock = Some(FolderLock::take(&path)?);
        sweep(&path);
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
    ///
    /// # Errors
    /// A file cannot be written; every file of these names is what it was before.
    pub fn write(&self, files: &[Content]) -> Result<(), DataError> {
        let fail = |(path, source)| DataError::Unwritable { path, source };
        let mut staged = Vec::new();
        for (name, bytes) in files {
            let path = self.file(name);
            match stage(&path, PREFIX, |out| out.write_all(bytes)) {
                Ok(file) => staged.push((path, file)),
                Err(source) => return Err(fail((path, source))),
            }
        }
        // Everything is on the disk: what is left are renames within a folder.
        replace(staged, PREFIX).map_err(fail)?;
        self.used.store(true, Ordering::Relaxed);
        sync_folder(&self.path);
        Ok(())
    }

    /// Removes files that an earlier run has left and this one does not write, so that all of the folder is of one run.
    pub fn forget(&self, names: impl Iterator<Item = &'static str>) {
        // What cannot be removed stays.
        names.for_each(|name| drop(fs::remove_file(self.file(name))));
    }

    /// What must go before the process ends without dropping this.
    pub fn traces(&self) -> Traces {
        let lock = self.lock.as_ref().map(|lock| lock.path().to_path_buf());
        Traces { folder: self.path.clone(), lock, made: self.made.clone() }
    }
}

/// Removes temporary files that a process left which was killed as it wrote.
fn sweep(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        if name.to_str().is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// What a run leaves in its folder, beside results, if it is ended at once.
#[derive(Clone, Debug)]
pub struct Traces {
    folder: PathBuf,
    lock: Option<PathBuf>,
    made: Vec<PathBuf>,
}

impl Traces {
    /// Removes temporary files, the lock, and folders that were made and hold nothing.
    pub fn remove(&self) {
        sweep(&self.folder);
        if let Some(lock) = &self.lock {
            let _ = fs::remove_file(lock);
        }
        for folder in &self.made {
            // Fails, as it should, when there are files.
            let _ = fs::remove_dir(folder);
        }
    }
}

impl Drop for OutDir {
    fn drop(&mut self) {
        // First, because its file stands in the folder.
        drop(self.lock.take());
        if !*self.used.get_mut() {
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
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
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
        drop(out);
        assert!(!folder.path().join("a").exists());
    }

    #[test]
    fn a_rename_that_fails_gives_the_others_back_what_they_held() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("old"), "before").unwrap();
        // A folder stands where the third file is to be.
        fs::create_dir(folder.path().join("state")).unwrap();
        fs::write(folder.path().join("state/kept"), "mine").unwrap();
        let out = OutDir::create(folder.path()).unwrap();
        let files = ["new", "old", "state", "last"].map(|name| (name, b"after".to_vec()));
        let message = out.write(&files).unwrap_err().to_string();
        assert!(message.contains("state") && message.contains("a folder stands where the file is to be"), "{message}");
        drop(out);
        assert_eq!(names(folder.path()), ["old", "state"]);
        assert_eq!(fs::read(folder.path().join("old")).unwrap(), b"before");
        assert_eq!(fs::read(folder.path().join("state/kept")).unwrap(), b"mine");
    }

    #[test]
    fn files_that_are_replaced_leave_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        for content in ["first", "second"] {
            let out = OutDir::create(folder.path()).unwrap();
            out.write(&[("x", content.into()), ("y", content.into())]).unwrap();
            drop(out);
            assert_eq!(names(folder.path()), ["x", "y"]);
            assert_eq!(fs::read_to_string(folder.path().join("y")).unwrap(), content);
        }
    }

    #[test]
    fn one_run_has_the_folder_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let first = OutDir::create(folder.path()).unwrap();
        let message = OutDir::create(folder.path()).unwrap_err().to_string();
        let words = format!("another run (process {}) writes into this folder", std::process::id());
        assert!(message.contains(&words), "{message}");
        drop(first);
        OutDir::create(folder.path()).unwrap();
    }

    #[test]
    fn what_a_dead_process_left_is_no_obstacle() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(".nisp.lock"), "7\n").unwrap();
        fs::write(folder.path().join(".nisp-run-abc.tmp"), "half").unwrap();
        fs::write(folder.path().join(".nisp-abc.tmp"), "of someone else").unwrap();
        let out = OutDir::create(folder.path()).unwrap();
        assert_eq!(names(folder.path()), [".nisp-abc.tmp", ".nisp.lock"]);
        drop(out);
        assert_eq!(names(folder.path()), [".nisp-abc.tmp"]);
    }

    #[test]
    fn traces_are_removed_and_results_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let out = OutDir::create(folder.path().join("a/b")).unwrap();
        out.traces().remove();
        assert!(!folder.path().join("a").exists());
        drop(out);
        let out = OutDir::create(folder.path().join("a")).unwrap();
        out.write(&[("x", b"1".to_vec())]).unwrap();
        out.traces().remove();
        assert_eq!(names(out.path()), ["x"]);
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
