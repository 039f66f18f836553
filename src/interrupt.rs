//! The user's wish to stop.

use std::sync::atomic::{AtomicBool, Ordering};

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Asks the run to stop after the step under way; true if it had been asked before.
pub fn request() -> bool {
    REQUESTED.swap(true, Ordering::Relaxed)
}

/// Has somebody asked the run to stop?
pub fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
