//! Bodies that do not deform.

use super::{BuildMaterial, Chunk, Lane, Law, NOTHING, State};
use crate::model::column::ColumnSet;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildMaterial> = Style {
    name: "rigid",
    usage: "[rho]",
    summary: "prescribed motion: the body carries the nodes it touches along",
    manual: "\
Particles keep their velocity (`initial_velocity_particles` and `velocity_particles` set it) and
move by dt v. Updated Lagrangian: nodes with weight from a rigid particle have
v = v* = sum N V v_p/sum N V over rigid particles, anew in every step; other masses and forces are
ignored there. `velocity_particles` on a rigid body publishes the force it takes against the
material: its impulse is the momentum that the material gains. Total Lagrangian: it acts through contact fixes only. No limit on dt.
rho [M/L^d] only adds kinetic energy (old form: left out, 0).
Source: Karamelo's rule.",
    build: Some(|args, _| {
        if args.remaining() > 0 {
            let density = args.within("the density rho", 0.0, f64::INFINITY)?.value;
            return Ok(Arc::new(Rigid { density }));
        }
        args.old_form("material(ID, rigid, 0)");
        Ok(Arc::new(Rigid { density: 0.0 }))
    }),
};

/// No stress and no strain: the kernels leave its particles alone.
///
/// # Source  language.md 6.4, 7.3
#[derive(Clone, Copy, Debug)]
pub struct Rigid {
    /// rho \[M/L^d\].
    pub density: f64,
}

impl Law for Rigid {
    fn columns(&self, _dimension: usize) -> ColumnSet {
        ColumnSet::default()
    }

    fn is_incremental(&self) -> bool {
        true
    }

    fn is_rigid(&self) -> bool {
        true
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn moduli(&self) -> [f64; 2] {
        [f64::INFINITY; 2]
    }

    fn reference_wave_speed(&self) -> f64 {
        0.0
    }

    fn update(&self, _chunk: &mut Chunk<'_>) {}

    fn wave_speed(&self, _state: &State, out: &mut Lane) {
        *out = NOTHING;
    }

    fn stored_energy(&self, _state: &State, out: &mut Lane) {
        *out = NOTHING;
    }

    fn elastic_strain(&self, _state: &State, out: &mut [Lane; 6]) {
        *out = [NOTHING; 6];
    }

    fn accepts_initial_stress(&self) -> bool {
        false
    }
}
