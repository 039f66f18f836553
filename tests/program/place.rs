//! The program in a folder of its own.

use assert_cmd::cargo::cargo_bin;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A disk of rubber, 52 particles.
pub const SCENE: &str = "
h = 0.1
method(ulmpm, FLIP, linear, 1)
dimension(2, 0, 1, 0, 1, h)
region(disk, sphere, 0.5, 0.5, 0.2)
material(rubber, linear, 1000, 1e4, 0.3)
solid(ball, region, disk, 2, rubber, h)
group(left, particles, region, disk)
compute(Ek, kinetic_energy, all)
";

/// A folder with the scene in `in.mpm`.
pub struct Place(pub TempDir);

impl Place {
    pub fn new(script: &str) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        std::fs::write(place.0.path().join("in.mpm"), format!("{SCENE}{script}")).unwrap();
        place
    }

    pub fn command(&self) -> Command {
        let mut command = Command::new(cargo_bin!("karamelo-rs"));
        command.current_dir(self.0.path());
        command
    }

    /// A place with this script alone.
    pub fn of(name: &str, script: &str) -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        place.write(name, script);
        place
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).unwrap();
    }

    pub fn run(&self, arguments: &[&str]) -> Output {
        self.command().args(arguments).output().unwrap()
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.path().join(name)).unwrap()
    }

    pub fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name();
        let mut names: Vec<String> =
            entries.map(|entry| name(entry).to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

pub fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}
