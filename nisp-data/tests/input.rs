//! What is no file is not read, and no file without end.

use std::fs::File;
use std::path::Path;

use nisp_data::input::{MOST_BYTES, read_bytes, read_text};
use nisp_data::{Cloud, Table};

#[track_caller]
fn refused(path: &Path, words: &str) {
    let messages = [
        read_bytes(path, MOST_BYTES).unwrap_err().to_string(),
        read_text(path).unwrap_err().to_string(),
        Table::read(path).unwrap_err().to_string(),
        Cloud::read(path).unwrap_err().to_string(),
    ];
    for message in messages {
        assert!(message.contains(words) && !message.contains('\n'), "{message}");
    }
}

#[cfg(unix)]
#[test]
fn devices_and_pipes() {
    for device in ["/dev/zero", "/dev/null", "/dev/urandom"] {
        refused(Path::new(device), "a device or a pipe");
    }
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    refused(&pipe, "a device or a pipe");
}

#[test]
fn large_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.csv");
    // A file of zeros that takes no room on the disk.
    File::create(&path).unwrap().set_len(MOST_BYTES + 1).unwrap();
    refused(&path, "larger than 256 MiB");
    assert!(read_bytes(&path, MOST_BYTES + 1).is_ok());
    refused(folder.path(), "is a folder");
}
