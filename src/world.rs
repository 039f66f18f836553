//! What a simulation is about: domain, grid, particles, solids, groups.

use crate::material::{Description, LANES, Law, State, StressRate};
use crate::math::tensor::Tensor;
use crate::method::Method;
use crate::model::column::{Column, ColumnSet};
use crate::model::contact::Contacts;
use crate::model::domain::{Boundary, Domain};
use crate::model::grid::Grid;
use crate::model::group::Groups;
use crate::model::lattice::Lattice;
use crate::model::ledger::Ledger;
use crate::model::particles::Particles;
use crate::model::rigid::Rigid;
use crate::parallel::Ranks;
use crate::region::Bounds;
use crate::shape::ShapeKind;
use crate::shape::corners::corner_of_parallel;
use std::cell::RefCell;
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
    /// Particles per cell and axis; of a body from a mesh or list, in the mean.
    pub particles_per_cell: f64,
    /// The cells its particles were put in: those of the box, in total Lagrangian methods its own.
    pub cells: Domain,
    /// Columns that its law and kinematics read and write.
    pub columns: ColumnSet,
    /// What spreads in it and so limits the time step.
    pub spreading: Spreading,
    /// It keeps its shape and its velocity.
    pub rigid: bool,
    /// Number of its lattice.
    pub lattice: usize,
}

/// Diffusivities \[L^2/T\] of the reference density.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spreading {
    /// Kinematic viscosity mu/rho0.
    pub viscosity: f64,
    /// Thermal diffusivity kappa/(rho0 cp); 0 where heat is not conducted.
    pub heat: f64,
}

impl Spreading {
    /// Of a law, in a run that conducts heat or not.
    pub fn new(law: &dyn Law, conducts_heat: bool) -> Self {
        let heat = if conducts_heat { law.thermal().diffusivity(law.density()) } else { 0.0 };
        Self { viscosity: law.viscosity() / law.density(), heat }
    }
}

/// Everything that has a place.
#[derive(Clone)]
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
    /// The energy ledger; closed unless something reads it.
    pub ledger: Ledger,
    /// The method.
    pub method: Method,
    /// The objective rate of hypoelastic laws.
    pub rate: StressRate,
    /// What happens to particles that leave the box.
    pub boundary: Boundary,
    /// How temperatures pass from nodes to particles: 1 by increments, 0 by interpolation.
    pub thermal_blend: f64,
    /// The particles of rigid solids.
    pub rigid: Rigid,
    /// Multi-field contacts.
    pub contacts: Contacts,
    /// The processes among which particles are dealt out.
    pub ranks: Ranks,
}

thread_local! {
    static STATE: RefCell<Box<State>> = RefCell::default();
}

impl World {
    /// How deformation is described.
    pub fn description(&self) -> Description {
        if self.method.total { Description::Total } else { Description::Updated(self.rate) }
    }

    /// Dimensions of tensors: 3 for bodies of revolution, whose hoop components live.
    pub fn tensor_dimension(&self) -> usize {
        if self.method.axisymmetric { 3 } else { self.domain.dimension }
    }

    /// The components of F that change.
    pub fn deformation_columns(&self) -> &'static [Column] {
        match self.method.axisymmetric {
            true => Column::ROUND_DEFORMATION,
            false => Column::deformation(self.domain.dimension),
        }
    }

    /// Columns that a law and its kinematics need.
    pub fn columns_of(&self, law: &dyn Law) -> ColumnSet {
        let mut columns = self.description().columns(law, self.domain.dimension);
        if columns.contains(Column::F11) || self.method.shape == ShapeKind::StretchedGimp {
            columns.extend(self.deformation_columns());
        }
        columns
    }

    /// The cells that the particles of a solid are put in: those of the box, in total Lagrangian
    /// methods those of size `cell` from the lower corner of the body.
    pub fn cells_between(&self, bounds: &Bounds, cell: f64) -> Domain {
        let lower = self.method.lower_limits(bounds.lower);
        match self.method.total {
            true => self.domain.of_limits(lower, bounds.upper, cell),
            false => self.domain,
        }
    }

    /// Do rigid solids carry nodes along (updated Lagrangian)?
    pub fn has_rigid_nodes(&self) -> bool {
        !self.method.total && self.solids.iter().any(|solid| solid.rigid)
    }

    /// The lattices that the method needs: one for each solid, or one for all but those that a
    /// contact names.
    pub fn make_lattices(&self) -> Vec<Lattice> {
        let shape = self.method.shape;
        let lattice =
            |cells: Domain| Lattice::new(cells.widened(shape.layers()), shape.nodes_per_cell());
        if self.method.total {
            return self.solids.iter().map(|solid| lattice(solid.cells)).collect();
        }
        let fields = self.solids.iter().map(|solid| solid.lattice + 1).max().unwrap_or(1);
        vec![lattice(self.domain); fields]
    }

    /// Gives each solid its lattice, and groups of nodes of single solids theirs.
    pub fn assign_lattices(&mut self) {
        let fields: Vec<usize> = match self.method.total {
            true => (0..self.solids.len()).collect(),
            false => self.contacts.fields(self.solids.len()),
        };
        for (solid, lattice) in self.solids.iter_mut().zip(&fields) {
            solid.lattice = *lattice;
        }
        self.groups.bind(&fields);
        if !self.method.total {
            self.contacts.pair_up(&fields);
        }
    }

    /// Calls `visit(range, solid, state)` for the particles that this process counts, in storage
    /// order, in chunks of at most [`LANES`] particles of one solid.
    pub fn each_chunk(&self, mut visit: impl FnMut(Range<usize>, &Solid, &State)) {
        let of = &self.particles.solid[self.particles.counted()];
        STATE.with_borrow_mut(|state| {
            let mut start = 0;
            while let Some(first) = of.get(start) {
                let limit = of.len().min(start + LANES);
                let end = (start..limit).find(|p| of[*p] != *first).unwrap_or(limit);
                let range = start..end;
                let solid = &self.solids[*first as usize];
                self.load(state, solid, range.clone());
                visit(range, solid, state);
                start = end;
            }
        });
    }

    fn load(&self, state: &mut State, solid: &Solid, range: Range<usize>) {
        let particles = &self.particles;
        let set = particles.present.common(solid.columns);
        state.load(self.tensor_dimension(), range.len(), set, |column| {
            &particles.column(column)[range.clone()]
        });
    }

    /// Something about one particle's state.
    pub fn of_particle<T>(&self, particle: usize, about: impl FnOnce(&Solid, &State) -> T) -> T {
        STATE.with_borrow_mut(|state| {
            let solid = &self.solids[self.particles.solid[particle] as usize];
            self.load(state, solid, particle..particle + 1);
            about(solid, state)
        })
    }

    /// Cauchy stress of a particle in space axes \[P\].
    pub fn stress(&self, particle: usize) -> Tensor {
        let description = self.description();
        self.of_particle(particle, |solid, state| description.stress(&*solid.law, state, 0))
    }

    /// Where a particle is \[L\].
    pub fn place(&self, particle: usize) -> [f64; 3] {
        let [x, y, z, _] = self.particles.position[particle];
        [x, y, z]
    }

    /// Where the corners of the domain of a particle are \[L\] (CPDI; none for other methods). In
    /// total Lagrangian methods they follow its F.
    pub fn corners(&self, particle: usize) -> Vec<[f64; 3]> {
        let ShapeKind::Corners(kind) = self.method.shape else { return Vec::new() };
        let dimension = self.domain.dimension;
        let records = &self.particles.domain;
        let place = self.place(particle);
        let own: Vec<[f64; 4]> =
            records.iter().filter_map(|record| record.get(particle).copied()).collect();
        let corner = |c: usize| {
            let [x, y, z, _] = match kind.has_free_corners() {
                true => own[c],
                false => corner_of_parallel(&own, c),
            };
            [x, y, z]
        };
        let deformation = self.method.total.then(|| self.deformation(particle));
        let moved = |offset: [f64; 3]| match &deformation {
            Some(f) => std::array::from_fn(|i| (0..3).map(|j| f[(i, j)] * offset[j]).sum::<f64>()),
            None => offset,
        };
        let at = |offset: [f64; 3]| std::array::from_fn(|axis| place[axis] + offset[axis]);
        (0..kind.corners(dimension)).map(|c| at(moved(corner(c)))).collect()
    }

    /// F of a particle; the identity where the scene does not have it.
    pub fn deformation(&self, particle: usize) -> Tensor {
        self.of_particle(particle, |_, state| state.deformation(0))
    }
}
