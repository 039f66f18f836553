//! The manual is true: its links lead somewhere, its reference is what the program says of itself, and its
//! snippets, like those of the README, are run and give what stands below them.
//!
//! `docs/src/about.md` tells readers and writers what is run and how it is compared.

mod compare;
mod links;
mod page;
mod play;

use page::Page;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The files of a folder and its subfolders with a suffix, in a fixed order.
fn files(folder: &Path, suffix: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut entries: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            found.extend(files(&path, suffix));
        } else if path.extension().is_some_and(|end| end == suffix) {
            found.push(path);
        }
    }
    found
}

/// The README, the pages of the manual and those of the scenes.
fn pages() -> Vec<Page> {
    let mut paths = vec![root().join("README.md"), root().join("CHANGELOG.md")];
    paths.extend(files(&root().join("docs/src"), "md"));
    paths.extend(files(&root().join("inputs"), "md"));
    paths.iter().map(|path| Page::read(path)).collect()
}
