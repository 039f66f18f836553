//! One run of a script in a process of its own, in a folder of its own.

use super::log::{self, Logged};
use crate::command::setting::Setting;
use crate::script::syntax::Statement;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use wait4::Wait4;

/// What to run.
#[derive(Clone, Debug)]
pub struct Job {
    /// The script, absolute.
    pub script: PathBuf,
    /// `-var`.
    pub variables: Vec<(String, String)>,
    /// `--set`.
    pub settings: Vec<Setting>,
    /// `--threads`.
    pub threads: usize,
    /// `--measure`.
    pub measure: String,
}

/// What a run took and gave.
#[derive(Clone, Debug)]
pub struct Finished {
    /// Seconds by the clock, start and set-up included.
    pub wall: f64,
    /// Seconds of all cores, start and set-up included.
    pub cpu: f64,
    /// Largest memory in bytes.
    pub memory: f64,
    /// What the log says.
    pub logged: Logged,
}

/// How a run ended.
#[derive(Clone, Debug)]
pub enum Ending {
    /// As it should.
    Done(Finished),
    /// With this message.
    Failed(String),
    /// By the user.
    Interrupted,
}

/// A folder that is removed with its files.
pub struct Scratch(PathBuf);

impl Scratch {
    /// A new folder in the system's folder for temporary files.
    ///
    /// # Errors
    /// The system's reason.
    pub fn new() -> io::Result<Self> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        loop {
            let number = COUNT.fetch_add(1, Ordering::Relaxed);
            let name = format!("karamelo-rs-{}-{number}", std::process::id());
            let path = std::env::temp_dir().join(name);
            match fs::create_dir(&path) {
                Err(reason) if reason.kind() == io::ErrorKind::AlreadyExists => {}
                other => return other.map(|()| Self(path)),
            }
        }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What cannot be removed is left to the system.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Relative paths among the words of a script: files that are there, and folders to write to.
pub fn files_of(statements: &[Statement], folder: &Path) -> (Vec<PathBuf>, Vec<PathBuf>) {
    let (mut files, mut folders) = (Vec::new(), Vec::new());
    for statement in statements {
        let Statement::Call { name, arguments, .. } = statement else { continue };
        // A file of an earlier run that a dump would write again is none to read.
        let reads = ["solid", "region"].contains(&name.text.as_str());
        for word in arguments {
            let path = PathBuf::from(word.text.trim());
            let inside = path.components().all(|c| matches!(c, std::path::Component::Normal(_)));
            if path.as_os_str().is_empty() || !inside {
                continue;
            }
            if reads && folder.join(&path).is_file() {
                files.push(path);
            } else if let Some(parent) = path.parent().filter(|p| !p.as_os_str().is_empty())
                && folder.join(parent).is_dir()
            {
                folders.push(parent.to_path_buf());
            }
        }
    }
    (files, folders)
}

/// Lets a scratch folder look like the working directory, as far as a script asks.
fn furnish(scratch: &Path, statements: &[Statement], folder: &Path) -> io::Result<()> {
    let (files, folders) = files_of(statements, folder);
    for inside in folders {
        fs::create_dir_all(scratch.join(inside))?;
    }
    for file in files {
        let to = scratch.join(&file);
        if let Some(parent) = to.parent() {
            fs::create_dir_all(parent)?;
        }
        if to.exists() {
            continue;
        }
        #[cfg(unix)]
        std::os::unix::fs::symlink(folder.join(&file), to)?;
        #[cfg(not(unix))]
        fs::copy(folder.join(&file), to)?;
    }
    Ok(())
}

impl Job {
    /// The words of the command line, without the program.
    pub fn words(&self) -> Vec<String> {
        let mut words = vec![self.script.display().to_string()];
        for (name, value) in &self.variables {
            words.extend(["-var".to_string(), name.clone(), value.clone()]);
        }
        for setting in &self.settings {
            words.extend(["--set".to_string(), setting.text()]);
        }
        words.extend(["--threads".to_string(), self.threads.to_string()]);
        words
    }

    /// Runs it. `started` gets the number of the process, `None` when it has ended.
    ///
    /// # Errors
    /// The program cannot be started, or the folder not be written.
    pub fn play(
        &self,
        statements: &[Statement],
        started: impl Fn(Option<u32>),
    ) -> io::Result<Ending> {
        let scratch = Scratch::new()?;
        furnish(scratch.path(), statements, &std::env::current_dir()?)?;
        let said = scratch.path().join(".stderr");
        let mut command = Command::new(std::env::current_exe()?);
        command.args(self.words()).args(["--quiet", "--log", ".log", "--measure", &self.measure]);
        command.current_dir(scratch.path()).stdin(Stdio::null()).stdout(Stdio::null());
        command.stderr(fs::File::create(&said)?);
        let clock = Instant::now();
        let mut child = command.spawn()?;
        started(Some(child.id()));
        let ended = child.wait4();
        let wall = clock.elapsed().as_secs_f64();
        started(None);
        let ended = ended?;
        let text = fs::read(&said).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        match ended.status.code() {
            Some(0) => {}
            Some(130) => return Ok(Ending::Interrupted),
            code => return Ok(Ending::Failed(reason(&text.unwrap_or_default(), code))),
        }
        let log = fs::read_to_string(scratch.path().join(".log"))?;
        Ok(match log::read(&log) {
            Some(logged) => Ending::Done(Finished {
                wall,
                cpu: (ended.rusage.utime + ended.rusage.stime).as_secs_f64(),
                memory: ended.rusage.maxrss as f64,
                logged,
            }),
            None => Ending::Failed("the log has no rows".to_string()),
        })
    }
}

/// The first error of a program, in one line.
fn reason(said: &str, code: Option<i32>) -> String {
    let error = said.lines().find_map(|line| line.strip_prefix("error"));
    match (error, code) {
        (Some(error), _) => {
            let message = error.split_once(": ").map_or(error, |(_, message)| message);
            message.trim().to_string()
        }
        (None, Some(code)) => format!("ended with code {code}"),
        (None, None) => "ended by a signal".to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reasons_are_the_first_error_without_its_code() {
        assert_eq!(reason("warning: a\nerror[E0301]: `MLS` needs\n --> x", Some(2)), "`MLS` needs");
        assert_eq!(reason("error: particle 3 left\n", Some(1)), "particle 3 left");
        assert_eq!(reason("", Some(7)), "ended with code 7");
        assert_eq!(reason("", None), "ended by a signal");
    }

    #[test]
    fn only_what_a_script_reads_is_put_into_its_folder() {
        let scratch = Scratch::new().unwrap();
        std::fs::create_dir(scratch.path().join("out")).unwrap();
        for name in ["part.stl", "p.dump"] {
            std::fs::write(scratch.path().join(name), "x").unwrap();
        }
        let text = "region(r, stl, part.stl)\ndump(p, all, particle, 1, p.dump, x)\n\
                    save_plot(out/plot.svg)\n";
        let source = crate::script::source::Source::new("in.mpm", text);
        let (statements, _) = crate::script::syntax::parse(&source);
        let (files, folders) = files_of(&statements, scratch.path());
        assert_eq!(files, [PathBuf::from("part.stl")]);
        assert_eq!(folders, [PathBuf::from("out")]);
    }

    #[test]
    fn a_scratch_folder_goes_with_its_files() {
        let scratch = Scratch::new().unwrap();
        let path = scratch.path().to_path_buf();
        std::fs::write(path.join("a"), "b").unwrap();
        drop(scratch);
        assert!(!path.exists());
    }
}
