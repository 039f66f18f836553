//! Bodies that have come apart because the grid no longer joins their particles.

use super::Simulation;
use crate::model::column::Column;
use crate::shape::ShapeKind;

/// A particle that is stretched beyond what its shape bridges.
pub(super) struct Torn {
    /// Its id.
    pub id: u32,
    /// Its largest stretch.
    pub stretch: f64,
    /// How far away its neighbours are then, in cells.
    pub distance: f64,
    /// How far its shape reaches, in cells.
    pub reach: f64,
}

/// Cells within which two particles have a node in common wherever they are, `half` the half size of
/// a box of GIMP in cells; infinite where particles hear of their first neighbours for ever.
fn bridged(shape: ShapeKind, half: f64) -> f64 {
    match shape {
        ShapeKind::Linear => 1.0,
        ShapeKind::Quadratic => 2.0,
        ShapeKind::Cubic => 3.0,
        ShapeKind::Gimp => 1.0 + 2.0 * half,
        ShapeKind::StretchedGimp => 2.0,
        ShapeKind::Bernstein | ShapeKind::Corners(_) => f64::INFINITY,
    }
}

impl Torn {
    /// How far beyond its reach.
    fn excess(&self) -> f64 {
        self.distance / self.reach
    }

    /// The worse of two; of two alike the one with the smaller id.
    fn worse(self, other: Torn) -> Torn {
        let (own, others) = (self.excess(), other.excess());
        if own > others || (own == others && self.id < other.id) { self } else { other }
    }
}

impl Simulation {
    /// The particle of an elastic body, on any process, that is stretched most beyond what its shape
    /// bridges. Laws without F tell the stretch by the change of volume alone, which may be less.
    pub(super) fn torn(&self) -> Option<Torn> {
        let here = self.torn_here();
        let numbers: Vec<f64> = here
            .iter()
            .flat_map(|torn| [f64::from(torn.id), torn.stretch, torn.distance, torn.reach])
            .collect();
        let all = self.world.ranks.share(&numbers);
        let each = all.as_chunks::<4>().0.iter().copied();
        let torn = |[id, stretch, distance, reach]: [f64; 4]| Torn {
            id: id as u32,
            stretch,
            distance,
            reach,
        };
        each.map(torn).reduce(Torn::worse)
    }

    fn torn_here(&self) -> Option<Torn> {
        let world = &self.world;
        let (particles, shape) = (&world.particles, world.method.shape);
        if world.method.total {
            return None;
        }
        let (volumes, damage) = (particles.column(Column::J), particles.column(Column::Damage));
        let mut worst: Option<Torn> = None;
        for p in particles.counted() {
            let solid = &world.solids[usize::from(particles.solid[p])];
            let [_, shear] = solid.law.moduli();
            let failed = damage.get(p).is_some_and(|damage| *damage >= 1.0);
            if solid.rigid || failed || shear <= 0.0 {
                continue;
            }
            let reach = bridged(shape, 0.5 / solid.particles_per_cell);
            let torn = |stretch: f64| {
                let distance = stretch / solid.particles_per_cell;
                Torn { id: particles.id[p], stretch, distance, reach }
            };
            let least = worst.as_ref().map_or(1.0, Torn::excess);
            // No stretch is larger than sqrt(F : F); most particles are judged by that.
            let has_deformation = solid.columns.contains(Column::F11);
            let most = match has_deformation {
                true => world.deformation(p).norm(),
                false => volumes[p],
            };
            if torn(most).excess() < least {
                continue;
            }
            let stretch = match has_deformation {
                true => world.deformation(p).singular_values()[0],
                false => most,
            };
            if torn(stretch).excess() > 1.0 {
                worst = worst.into_iter().chain([torn(stretch)]).reduce(Torn::worse);
            }
        }
        worst
    }
}
