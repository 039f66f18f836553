//! What a simulation is about: domain, grid, particles, solids, groups.

use crate::material::{LANES, Law, StressRate, View};
use crate::model::domain::Domain;
use crate::model::grid::Grid;
use crate::model::group::Groups;
use crate::model::particles::Particles;
use std::ops::Range;
use std::sync::Arc;

/// A body.
#[derive(Clone)]
pub struct Solid {
    /// Its ID in the script.
    pub name: String,
    /// ID of its material.
    pub material: String,
    /// Its law.
    pub law: Arc<dyn Law>,
    /// Particles per cell and axis.
    pub particles_per_cell: usize,
}

/// Everything that has a place.
pub struct World {
    /// The box and its cells.
    pub domain: Domain,
    /// The grid.
    pub grid: Grid,
    /// All particles.
    pub particles: Particles,
    /// All solids, in order of definition.
    pub solids: Vec<Solid>,
    /// All groups.
    pub groups: Groups,
    /// The objective rate of hypoelastic laws.
    pub rate: StressRate,
}

impl World {
    /// The particles in storage order, in chunks of at most [`LANES`] particles of one solid.
    pub fn chunks(&self) -> impl Iterator<Item = (Range<usize>, &Solid)> {
        let solid = &self.particles.solid;
        let mut start = 0;
        std::iter::from_fn(move || {
            let first = *solid.get(start)?;
            let limit = solid.len().min(start + LANES);
            let end = (start..limit).find(|p| solid[*p] != first).unwrap_or(limit);
            let range = start..end;
            start = end;
            Some((range, &self.solids[first as usize]))
        })
    }

    /// The state of a chunk of particles, for its law to read.
    pub fn view(&self, range: Range<usize>) -> View<'_> {
        View {
            dimension: self.domain.dimension,
            len: range.len(),
            columns: std::array::from_fn(|column| {
                self.particles.columns[column].get(range.clone()).unwrap_or(&[])
            }),
        }
    }
}
