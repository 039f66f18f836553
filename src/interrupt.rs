//! The user's wish to stop.

use std::sync::atomic::{AtomicI32, Ordering};

/// The signal that asks for it; 0: none.
static REQUESTED: AtomicI32 = AtomicI32::new(0);

/// Asks the run to stop after the step under way; true if it had been asked before.
pub fn request(signal: i32) -> bool {
    REQUESTED.swap(signal, Ordering::Relaxed) != 0
}

/// Has somebody asked the run to stop?
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed) != 0
}

/// The exit code that tells which signal it was: 130 for SIGINT, 143 for SIGTERM.
pub fn exit_code(signal: i32) -> u8 {
    128u8.wrapping_add(signal as u8)
}

/// The exit code of the signal that asked for it; SIGINT if another process has got it.
pub fn exit_code_now() -> u8 {
    const SIGINT: i32 = 2;
    match REQUESTED.load(Ordering::Relaxed) {
        0 => exit_code(SIGINT),
        signal => exit_code(signal),
    }
}
