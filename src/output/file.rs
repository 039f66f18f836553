//! Files that are whole or not there.

use crate::fault::Fault;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// A file that is being written part by part. Unless it is finished, all is as before.
pub struct Writer {
    path: PathBuf,
    file: File,
    kind: Kind,
    /// Bytes that the file has.
    length: u64,
}

/// How the parts become a file.
enum Kind {
    /// It gets its name when it is complete; until then it has this one.
    Whole(PathBuf),
    /// A device or pipe takes the bytes itself: nothing may take its name.
    Device,
    /// So many bytes stood there before.
    Growing(u64),
    /// It is complete.
    Finished,
}

impl Writer {
    /// A file that replaces what has its name.
    ///
    /// # Errors
    /// The path and the system's reason.
    pub fn whole(path: &Path) -> Result<Self, Fault> {
        let device = fs::metadata(path).is_ok_and(|entry| !entry.is_file() && !entry.is_dir());
        let temporary = temporary(path);
        let opened = File::create(if device { path } else { &temporary });
        let file = opened.map_err(|reason| Fault::file(path, &reason))?;
        let kind = if device { Kind::Device } else { Kind::Whole(temporary) };
        Ok(Self { path: path.to_path_buf(), file, kind, length: 0 })
    }

    /// Adds to a file of which the first `length` bytes stay; 0 begins it anew.
    ///
    /// # Errors
    /// The path and the system's reason, or that the file has fewer bytes than that.
    pub fn growing(path: &Path, length: u64) -> Result<Self, Fault> {
        let fault = |reason: &std::io::Error| Fault::file(path, reason);
        let mut options = OpenOptions::new();
        let file = options.create(true).append(true).open(path).map_err(|e| fault(&e))?;
        let found = file.metadata().map_err(|e| fault(&e))?.len();
        // A file that is gone or empty begins anew.
        let length = if found == 0 { 0 } else { length };
        if found < length {
            let reason = format!("it has {found} bytes where {length} were written before");
            return Err(fault(&std::io::Error::other(reason)));
        }
        file.set_len(length).map_err(|e| fault(&e))?;
        Ok(Self { path: path.to_path_buf(), file, kind: Kind::Growing(length), length })
    }

    /// Adds a part.
    ///
    /// # Errors
    /// The path and the system's reason.
    pub fn put(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        self.file.write_all(bytes).map_err(|reason| Fault::file(&self.path, &reason))?;
        self.length += bytes.len() as u64;
        Ok(())
    }

    /// The file is complete; gives its length.
    ///
    /// # Errors
    /// The path and the system's reason.
    pub fn finish(mut self) -> Result<u64, Fault> {
        if let Kind::Whole(temporary) = &self.kind {
            let renamed = fs::rename(temporary, &self.path);
            renamed.map_err(|reason| Fault::file(&self.path, &reason))?;
        }
        self.kind = Kind::Finished;
        Ok(self.length)
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        // Nothing can be done about what cannot be undone.
        let _ = match &self.kind {
            Kind::Whole(temporary) => fs::remove_file(temporary),
            Kind::Growing(before) => self.file.set_len(*before),
            Kind::Device | Kind::Finished => Ok(()),
        };
    }
}

/// Writes a file under a temporary name and renames it when it is complete.
///
/// # Errors
/// The path and the system's reason.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Fault> {
    let mut file = Writer::whole(path)?;
    file.put(bytes)?;
    file.finish().map(|_| ())
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
    fn devices_are_written_to_and_not_replaced() {
        write_whole(Path::new("/dev/null"), b"all of it").unwrap();
        let full = Path::new("/dev/full");
        if full.exists() {
            assert!(
                write_whole(full, b"all").unwrap_err().what.contains("cannot write `/dev/full`")
            );
            assert!(!fs::metadata(full).unwrap().is_file());
        }
    }

    #[test]
    fn a_file_that_is_not_finished_leaves_all_as_before() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("d.txt");
        write_whole(&path, b"before").unwrap();
        for open in [Writer::whole, |path: &Path| Writer::growing(path, 6)] {
            let mut file = open(&path).unwrap();
            file.put(b"after").unwrap();
            drop(file);
            assert_eq!(fs::read(&path).unwrap(), b"before");
            assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
        }
    }

    #[test]
    fn a_vanished_directory_is_named() {
        let path = Path::new("/nowhere/at/all/a.txt");
        let fault = write_whole(path, b"").unwrap_err();
        assert!(fault.what.contains("/nowhere/at/all/a.txt"), "{}", fault.what);
        assert_eq!(append(path, b"", true).unwrap_err().kind, crate::fault::FaultKind::File);
    }

    #[test]
    fn what_stands_beyond_the_known_length_is_written_once_more() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("c.txt");
        let grow = |path: &Path, bytes: &[u8], length: u64| {
            let mut file = Writer::growing(path, length)?;
            file.put(bytes)?;
            file.finish()
        };
        let length = grow(&path, b"one ", 0).unwrap();
        assert_eq!(grow(&path, b"two ", length).unwrap(), 8);
        assert_eq!(grow(&path, b"2 ", length).unwrap(), 6);
        assert_eq!(fs::read(&path).unwrap(), b"one 2 ");
        let fault = grow(&path, b"three", 7).unwrap_err();
        assert!(fault.what.contains("has 6 bytes where 7"), "{}", fault.what);
        fs::remove_file(&path).unwrap();
        assert_eq!(grow(&path, b"anew", 6).unwrap(), 4);
        assert_eq!(grow(&path, b"again", 0).unwrap(), 5);
        assert_eq!(fs::read(&path).unwrap(), b"again");
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
