//! Random and damaged input: the program never panics, never hangs, never takes all memory.
//!
//! Every case follows from its number alone, so a failure names what to look at. The number of cases
//! is that of a quick look; `KARAMELO_FUZZ=20 cargo test --release --test fuzz` takes twenty times as
//! many.

mod expressions;
mod files;
mod program;
#[path = "../project/mod.rs"]
mod project;
mod random;
mod scripts;

use std::process::Command;
use std::sync::Once;

/// So many times the cases of a quick look.
fn cases(quick: u64) -> u64 {
    let times = std::env::var("KARAMELO_FUZZ").ok().and_then(|times| times.parse::<u64>().ok());
    quick * times.unwrap_or(1)
}

/// Address space that these tests may take: whatever asks for more ends the process.
const ADDRESSES: u64 = 6_000_000_000;

/// Bounds the memory of this process.
fn bound_memory() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let (process, limit) = (std::process::id().to_string(), format!("--as={ADDRESSES}"));
        let done = Command::new("prlimit").args(["--pid", &process, &limit]).status();
        if !done.is_ok_and(|status| status.success()) {
            println!("the memory of this test is not bounded: there is no prlimit");
        }
    });
}
