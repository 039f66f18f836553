//! Scripts of the project.

use std::path::{Path, PathBuf};

/// The scripts of a folder and of those in it.
pub fn scripts_below(folder: &str) -> Vec<PathBuf> {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    let mut scripts = Vec::new();
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|suffix| suffix == "mpm") {
                scripts.push(path);
            }
        }
    }
    scripts.sort();
    scripts
}
