//! One error type for everything that comes in or goes out. Each message is one line and says what to do next.

use std::io;
use std::path::{Path, PathBuf};

/// Why data could not be read, understood or written.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// The file is not there.
    #[error("{}: no such file; check the path (it is taken from {})", .path.display(), working_folder())]
    NotFound {
        /// The path as given.
        path: PathBuf,
    },
    /// The file is there and cannot be read.
    #[error("{}: cannot be read: {source}", .path.display())]
    Unreadable {
        /// The path as given.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The bytes are not text.
    #[error("{}: not UTF-8 text (byte {byte}); save it as UTF-8", .path.display())]
    NotUtf8 {
        /// The path as given.
        path: PathBuf,
        /// Where the first bad byte stands.
        byte: usize,
    },
    /// A format fault at a known place.
    #[error("{}: line {line}: {what}", .path.display())]
    Line {
        /// The path as given.
        path: PathBuf,
        /// Line in the file, counted from one.
        line: usize,
        /// What is wrong and what to do.
        what: String,
    },
    /// A format fault of the file as a whole.
    #[error("{}: {what}", .path.display())]
    File {
        /// The path as given.
        path: PathBuf,
        /// What is wrong and what to do.
        what: String,
    },
    /// A cell that should hold a finite number.
    #[error("{}: line {line}, column `{column}`: {what}", .path.display())]
    Cell {
        /// The path as given.
        path: PathBuf,
        /// Line in the file, counted from one.
        line: usize,
        /// The column's header.
        column: String,
        /// What stands there and what to do.
        what: String,
    },
    /// No column, or no single column, fits the name asked for.
    #[error("{}: {what}", .path.display())]
    Column {
        /// The path as given.
        path: PathBuf,
        /// Which name, the nearest ones, and how to choose.
        what: String,
    },
    /// A file or folder cannot be written.
    #[error("{}: cannot be written: {}", .path.display(), explain_write(.source))]
    Unwritable {
        /// The path as given.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// A folder that another process writes into.
    #[error("{}: another run{process} writes into this folder; wait until it ends, or choose another with --out", .path.display())]
    Busy {
        /// The folder.
        path: PathBuf,
        /// Which process, if it says so, as ` (process 7)`.
        process: String,
    },
    /// A value that the caller passed makes no sense.
    #[error("{0}")]
    Invalid(String),
}

impl DataError {
    /// Tells "not there" from "there and unreadable".
    pub(crate) fn reading(path: &Path, source: io::Error) -> DataError {
        let path = path.to_path_buf();
        match source.kind() {
            io::ErrorKind::NotFound => DataError::NotFound { path },
            _ => DataError::Unreadable { path, source },
        }
    }

    /// Bytes that are no text.
    pub(crate) fn not_utf8(path: &Path, error: std::str::Utf8Error) -> DataError {
        DataError::NotUtf8 { path: path.to_path_buf(), byte: error.valid_up_to() }
    }

    /// A fault of the whole file.
    pub(crate) fn file(path: &Path, what: impl Into<String>) -> DataError {
        DataError::File { path: path.to_path_buf(), what: what.into() }
    }

    /// A fault at a line.
    pub(crate) fn line(path: &Path, line: usize, what: impl Into<String>) -> DataError {
        DataError::Line { path: path.to_path_buf(), line, what: what.into() }
    }

    /// A fault of something the caller passed.
    pub(crate) fn invalid(what: impl Into<String>) -> DataError {
        DataError::Invalid(what.into())
    }
}

fn working_folder() -> String {
    std::env::current_dir().map_or_else(|_| "the working folder".into(), |folder| folder.display().to_string())
}

fn explain_write(source: &io::Error) -> String {
    match source.kind() {
        io::ErrorKind::PermissionDenied => "permission denied; choose another folder with --out".into(),
        io::ErrorKind::StorageFull => "the disk is full; nothing was left half-written".into(),
        io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only; choose another folder with --out".into(),
        io::ErrorKind::IsADirectory => {
            "a folder stands where the file is to be; move it, or choose another with --out".into()
        }
        io::ErrorKind::NotFound => "the folder is gone or cannot be made; choose another folder with --out".into(),
        io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists => {
            "a file stands where a folder is needed; choose another folder with --out".into()
        }
        _ => source.to_string(),
    }
}
