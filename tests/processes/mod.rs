//! The program in several threads or processes.

use assert_cmd::cargo::cargo_bin;
use std::process::Command;

/// The program in so many threads (`2`), or in processes of one thread each (`3 processes`).
pub fn program(how: &str) -> Command {
    let binary = cargo_bin!("karamelo-rs");
    let Some(count) = how.strip_suffix(" processes") else {
        let mut command = Command::new(binary);
        command.args(["--threads", how]);
        return command;
    };
    let mut command = Command::new("mpirun");
    // Containers run as root.
    command.envs([("OMPI_ALLOW_RUN_AS_ROOT", "1"), ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")]);
    command.args(["--oversubscribe", "--bind-to", "none", "-np", count]);
    command.arg(binary).args(["--threads", "1"]);
    command
}
