//! How particles take velocities from the grid (language.md 6.1).

/// A transfer of velocities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfer {
    /// v_p = (1 - alpha) sum N v* + alpha (v_p + sum N (v* - v)): 1 is FLIP, 0 is PIC.
    pub alpha: f64,
}
