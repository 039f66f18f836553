//! Files that a script reads.

use crate::memory;
use crate::script::arguments::Name;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::source::Source;
use crate::script::suggest;
use std::path::{Path, PathBuf};

/// Entries of a directory that are searched for a similar name.
const MOST_ENTRIES: usize = 1000;

/// The directory of a script.
pub fn folder(source: &Source) -> PathBuf {
    Path::new(&source.name).parent().map(Path::to_path_buf).unwrap_or_default()
}

/// The bytes of a file, which is looked for in the working directory, then beside the script.
///
/// # Errors
/// There is no such file, it is no regular one, it cannot be read, or it is larger than the memory.
pub fn read(name: &Name, folder: &Path) -> Result<Vec<u8>, Diagnostic> {
    let here = PathBuf::from(&name.text);
    let beside = folder.join(&here);
    let path = if !here.exists() && beside.exists() { beside } else { here };
    let error = |reason: String| {
        Diagnostic::error(
            Code::FileSystem,
            name.span,
            format!("cannot read `{}`: {reason}", name.text),
        )
        .label("this file cannot be read")
    };
    let entry = std::fs::metadata(&path)
        .map_err(|reason| error(reason.to_string()).help(similar(name, folder)))?;
    // Devices and pipes may never end.
    if !entry.is_file() {
        return Err(error("it is no regular file".to_string()));
    }
    if entry.len() as f64 > memory::available() {
        let message =
            format!("`{}` has {}, more than is free", name.text, memory::text(entry.len() as f64));
        return Err(Diagnostic::error(Code::TooLarge, name.span, message).label("too large"));
    }
    std::fs::read(&path).map_err(|reason| error(reason.to_string()))
}

/// Proposes a file of a similar name.
fn similar(name: &Name, folder: &Path) -> String {
    let wanted = Path::new(&name.text);
    let inside = wanted.parent().unwrap_or(Path::new(""));
    let file = wanted.file_name().map(|file| file.to_string_lossy().into_owned());
    let here = Path::new(".").join(inside);
    let entries = [here, folder.join(inside)].into_iter().filter_map(|path| path.read_dir().ok());
    let names: Vec<String> = entries
        .flatten()
        .take(MOST_ENTRIES)
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    let otherwise = "it is looked for in the working directory, then beside the script";
    suggest::help(&file.unwrap_or_default(), names.iter().map(String::as_str), otherwise)
}
