//! The command line program; see [`karamelo::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    karamelo::cli::main(std::env::args_os().collect())
}
