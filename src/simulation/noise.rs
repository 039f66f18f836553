//! What brings noise into a run, for its warnings: hats that particles cross, `usl` at the surface of a fluid.

use super::Simulation;
use crate::scheme::SchemeKind;
use crate::shape::ShapeKind;
use crate::world::Solid;

/// Cells beyond which every second particle has crossed a node, wherever it began.
const HALF: f64 = 0.5;

impl Simulation {
    /// The name of a solid without stiffness in shear that `usl` strains, if there is one: strains from v*
    /// see nodes at a free surface with hardly any mass, and a fluid has nothing that holds its drops back.
    pub(super) fn fluid_under_usl(&self) -> Option<&str> {
        let is_fluid = |solid: &&Solid| !solid.rigid && solid.law.moduli()[1] == 0.0;
        let fluid = self.world.solids.iter().find(is_fluid)?;
        (self.scheme.kind() == SchemeKind::Usl).then_some(&fluid.name)
    }

    /// How far a particle of a deformable body, on any process, has gone at most along one axis since
    /// it was made, in cells, if that is more than half a cell with a shape whose slope jumps there.
    pub(super) fn crossed(&self) -> Option<f64> {
        let world = &self.world;
        if world.method.total || world.method.shape != ShapeKind::Linear {
            return None;
        }
        let particles = &world.particles;
        let mut farthest = 0.0f64;
        for p in particles.counted() {
            let solid = &world.solids[usize::from(particles.solid[p])];
            if solid.rigid {
                continue;
            }
            let cell = world.grid.lattices[solid.lattice].cells.cell;
            let (place, start) = (particles.position[p], particles.reference_place(p));
            for (x, x0) in place.iter().zip(start) {
                farthest = farthest.max((x - x0).abs() / cell);
            }
        }
        let [farthest] = world.ranks.largest([farthest]);
        (farthest > HALF).then_some(farthest)
    }
}
