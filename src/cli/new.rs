//! `karamelo-rs new NAME`: a commented script to start from.

use super::arguments::{NewWords, Template};
use super::{DONE, FILES};
use std::fs::OpenOptions;
use std::io::Write;
use std::path::PathBuf;

impl Template {
    fn text(self) -> &'static str {
        match self {
            Template::Drop => include_str!("new/drop.mpm"),
            Template::Impact => include_str!("new/impact.mpm"),
            Template::Tension => include_str!("new/tension.mpm"),
        }
    }
}

/// Writes the script and says what to do with it; a file that is there stays as it is.
pub fn run(words: &NewWords) -> u8 {
    let mut path: PathBuf = words.name.clone();
    if path.extension().is_none() {
        path.set_extension("mpm");
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    // Words of the script may not have these letters in them unless quoted.
    if stem.is_empty() || stem.contains(|c: char| " ,()\"#*".contains(c)) {
        eprintln!(
            "error: `{}` is no name for a script: letters, digits, - and _ are",
            words.name.display()
        );
        return super::WRONG;
    }
    let text = words.template.text().replace("NAME", &stem);
    let created = OpenOptions::new().write(true).create_new(true).open(&path);
    match created.and_then(|mut file| file.write_all(text.as_bytes())) {
        Ok(()) => {
            let script = path.display();
            super::show(Ok(format!(
                "wrote {script}\n\
                 karamelo-rs check {script}    what it would do\n\
                 karamelo-rs {script}          runs it, some seconds\n\
                 karamelo-rs styles            everything that may stand in a script\n"
            )));
            DONE
        }
        Err(reason) => {
            eprintln!("error: cannot write `{}`: {reason}", path.display());
            FILES
        }
    }
}
