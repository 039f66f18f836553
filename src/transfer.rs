//! How velocities pass between particles and grid (language.md 6.1).

use crate::style::Style;

/// The transfers of the script language.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TransferKind {
    /// v = sum N v*.
    Pic,
    /// v = (1 - alpha) sum N v* + alpha (v + sum N (v* - v)).
    #[default]
    Flip,
    /// PIC with an affine velocity field around each particle.
    Apic,
    /// FLIP with an affine velocity field.
    Aflip,
    /// AFLIP whose particles move with their own velocity.
    Asflip,
    /// APIC with forces from moments instead of gradients.
    Mls,
    /// PIC with a filter of so many terms in place of its smoothing.
    Xpic(u32),
}

/// A transfer of velocities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfer {
    /// Which one.
    pub kind: TransferKind,
    /// v_p = (1 - alpha) sum N v* + alpha (v_p + sum N (v* - v)): 1 is FLIP, 0 is PIC.
    pub alpha: f64,
    /// alpha = exp(-dt/tau) with this tau \[T\] in place of a constant.
    pub time_constant: Option<f64>,
    /// P2G takes v_p + L_p (x_I - x_p), the second mapping v_p.
    pub gradient_enhanced: bool,
}

impl Transfer {
    /// A transfer with a constant blend.
    pub fn new(kind: TransferKind, alpha: f64) -> Self {
        Self { kind, alpha, time_constant: None, gradient_enhanced: false }
    }

    /// alpha of a step of size dt.
    pub fn blend(&self, dt: f64) -> f64 {
        self.time_constant.map_or(self.alpha, |tau| (-dt / tau).exp())
    }

    /// Particles carry an affine matrix C.
    pub fn is_affine(&self) -> bool {
        use TransferKind::*;
        matches!(self.kind, Apic | Aflip | Asflip | Mls)
    }

    /// Particles carry a matrix that P2G reads: C, or L of `gradient-enhanced`.
    pub fn has_matrix(&self) -> bool {
        self.is_affine() || self.gradient_enhanced
    }

    /// Terms of the filter, if there is one.
    pub fn filter_terms(&self) -> Option<u32> {
        match self.kind {
            TransferKind::Xpic(terms) => Some(terms),
            _ => None,
        }
    }
}

impl TransferKind {
    /// Does the script give alpha?
    pub fn takes_blend(self) -> bool {
        matches!(self, TransferKind::Flip | TransferKind::Aflip | TransferKind::Asflip)
    }
}

const fn row(
    name: &'static str,
    usage: &'static str,
    summary: &'static str,
    manual: &'static str,
    kind: TransferKind,
) -> Style<TransferKind> {
    Style { name, usage, summary, manual, build: Some(kind) }
}

const AFFINE: &str = "\
P2G takes v_p + C_p (x_I - x_p) with C_p = [sum N v* (x) (x_I - x_p)] D_p^-1,
D_p = sum N (x_I - x_p) (x) (x_I - x_p), from the updated velocities at the old places; shapes that
are no splines: C_p = sum v* (x) grad N. The second mapping of `musl` takes the new C_p.";

const BLEND: &str = "\
v = (1 - alpha) sum N v* + alpha (v + sum N (v* - v)), alpha in [0, 1]. Damping by a fixed alpha
depends on dt: half the step damps twice as fast. `time-constant, tau` in place of alpha gives
alpha = exp(-dt/tau) with tau [T], the same damping for any dt.";

/// All transfers.
pub const TRANSFERS: &[Style<TransferKind>] = &[
    row("PIC", "", "velocities from the grid: dissipative", "v = sum N v*.", TransferKind::Pic),
    row(
        "FLIP",
        "alpha | time-constant, tau",
        "velocity changes from the grid",
        BLEND,
        TransferKind::Flip,
    ),
    row(
        "APIC",
        "",
        "PIC that keeps rotation and shear of each particle",
        AFFINE,
        TransferKind::Apic,
    ),
    row(
        "AFLIP",
        "alpha | time-constant, tau",
        "FLIP with an affine field",
        AFFINE,
        TransferKind::Aflip,
    ),
    row(
        "ASFLIP",
        "alpha | time-constant, tau",
        "AFLIP whose particles move with their own velocity, x += dt v",
        AFFINE,
        TransferKind::Asflip,
    ),
    row(
        "MLS",
        "",
        "APIC with moving least squares forces (splines)",
        "\
f_I = -sum V N D_p^-1 sigma (x_I - x_p). P2G and C_p as APIC; strains follow from L_p = C_p (with `usf`
from the same weights on v).",
        TransferKind::Mls,
    ),
    row(
        "XPIC",
        "m",
        "PIC without its smoothing, by a filter of m terms",
        "`method(type, XPIC, m, shape)`, m >= 1. v = sum N (v' + dt a) with
v' = sum_k (-1)^(k+1) C(m, k) (S+ S)^(k-1) S+ V: 1 is PIC, more terms keep more. Every term costs a
gather and a scatter. Source: Hammerquist, Nairn 2017.",
        TransferKind::Xpic(0),
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_constant_damps_alike_for_any_step() {
        let mut flip = Transfer::new(TransferKind::Flip, 0.99);
        assert_eq!(flip.blend(1.0), 0.99);
        flip.time_constant = Some(0.5);
        let [once, twice] = [flip.blend(0.1), flip.blend(0.05).powi(2)];
        assert!((once - twice).abs() < 1e-15 && (once - (-0.2f64).exp()).abs() < 1e-15);
    }
}
