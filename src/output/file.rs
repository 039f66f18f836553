//! Files that are whole or not there.

use crate::fault::Fault;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes a file under a temporary name and renames it when it is complete.
///
/// # Errors
/// The path and the system's reason.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    let temporary = temporary(path);
    let written = fs::write(&temporary, bytes).and_then(|()| fs::rename(&temporary, path));
    written.map_err(|reason| {
        // What cannot be removed either was never made.
        let _ = fs::remove_file(&temporary);
        Fault::file(path, &reason)
    })
}

/// Adds to a file that grows; `first` starts it anew.
///
/// # Errors
/// The path and the system's reason.
pub fn append(path: &Path, bytes: &[u8], first: bool) -> Result<(), Fault> {
    let mut options = OpenOptions::new();
    options.create(true).write(true).truncate(first).append(!first);
    let written = options.open(path).and_then(|mut file| file.write_all(bytes));
    written.map_err(|reason| Fault::file(path, &reason))
}

/// `dir/.name.part` for `dir/name`.
fn temporary(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.part"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_file_replaces_the_old_one_and_leaves_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.txt");
        write_whole(&path, b"one").unwrap();
        write_whole(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_vanished_directory_is_named() {
        let path = Path::new("/nowhere/at/all/a.txt");
        let fault = write_whole(path, b"").unwrap_err();
        assert!(fault.what.contains("/nowhere/at/all/a.txt"), "{}", fault.what);
        assert_eq!(append(path, b"", true).unwrap_err().kind, crate::fault::FaultKind::File);
    }

    #[test]
    fn a_growing_file_starts_anew_and_grows() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("b.txt");
        append(&path, b"old", true).unwrap();
        append(&path, b"one ", true).unwrap();
        append(&path, b"two", false).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one two");
    }
}
