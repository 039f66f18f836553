//! Building the scene: particles of solids, groups.

use super::Simulation;
use super::fill::{self, touched};
use crate::material::{Law, StressRate};
use crate::measure::Captured;
use crate::model::clock::Clock;
use crate::model::column::{Column, ColumnSet};
use crate::model::domain::Domain;
use crate::model::grid::Grid;
use crate::model::group::{Group, GroupId, Groups, Members};
use crate::model::particles::Particles;
use crate::output::Outputs;
use crate::plan::Plan;
use crate::region::Region;
use crate::scheme::Loops;
use crate::scheme::musl::Musl;
use crate::script::formula::Board;
use crate::time_step::Floor;
use crate::transfer::Transfer;
use crate::world::{Solid, World};
use std::ops::ControlFlow;
use std::sync::Arc;

/// An empty table with the columns that every particle has.
fn no_particles(dimension: usize) -> Particles {
    let mut particles = Particles::new();
    let mut columns = ColumnSet::default();
    columns.extend(&[Column::X0, Column::Y0, Column::Z0][..dimension]);
    columns.insert(Column::J);
    particles.require(columns);
    particles
}

/// Nodes searched for a first member; a group that is still empty then counts as not empty.
const MOST_SEARCHED: usize = 50_000_000;

/// Does any node of the grid lie in the region?
fn has_node(domain: &Domain, region: &dyn Region) -> bool {
    let mut searched = 0;
    let [across, along, up] = touched(domain, &region.bounds(), 1);
    across.into_iter().any(|i| {
        along.clone().any(|j| {
            up.clone().any(|k| {
                searched += 1;
                searched > MOST_SEARCHED || region.contains(domain.node([i, j, k]))
            })
        })
    })
}

impl Simulation {
    /// A simulation without bodies.
    pub fn new(domain: Domain, outputs: Outputs) -> Self {
        let world = World {
            domain,
            grid: Grid::default(),
            particles: no_particles(domain.dimension),
            solids: Vec::new(),
            groups: Groups::default(),
            rate: StressRate::default(),
        };
        Self {
            world,
            clock: Clock::default(),
            transfer: Transfer { alpha: 1.0 },
            fixed_dt: None,
            dt_factor: 0.9,
            plan: Plan::default(),
            board: Board::default(),
            quantities: Vec::new(),
            fixes: Vec::new(),
            computes: Vec::new(),
            outputs,
            scheme: &Musl,
            loops: Loops::default(),
            captured: Captured::default(),
            started: Vec::new(),
            next: None,
            floor: Floor::default(),
            bits: 0,
        }
    }

    /// Gives a simulation without bodies its box.
    pub fn set_domain(&mut self, domain: Domain) {
        self.world.domain = domain;
        self.world.particles = no_particles(domain.dimension);
    }

    /// Fills a region with particles (language.md 6.3); gives their number.
    pub fn add_solid(
        &mut self,
        name: &str,
        material: &str,
        law: Arc<dyn Law>,
        region: &dyn Region,
        particles_per_cell: usize,
    ) -> usize {
        let domain = self.world.domain;
        let columns = law.columns(domain.dimension, self.world.rate);
        let dimension = domain.dimension as i32;
        let volume = (domain.cell / particles_per_cell as f64).powi(dimension);
        let mass = law.density() * volume;
        let particles = &mut self.world.particles;
        particles.require(columns);
        let before = particles.len();
        let solid = self.world.solids.len() as u16;
        let mut id = particles.id.iter().copied().max().unwrap_or(0);
        let _: ControlFlow<()> = fill::visit(&domain, region, particles_per_cell, |place| {
            id += 1;
            particles.push(id, solid, place, mass, volume);
            ControlFlow::Continue(())
        });
        self.world.solids.push(Solid {
            name: name.to_string(),
            material: material.to_string(),
            law,
            particles_per_cell,
        });
        self.world.particles.len() - before
    }

    /// The group of a name.
    pub fn group(&self, name: &str) -> Option<GroupId> {
        self.world.groups.0.iter().position(|group| group.name == name).map(GroupId)
    }

    /// Adds the particles whose reference position lies in the region, of the listed solids
    /// (`None`: all), to a group; gives the number of members.
    pub fn add_particle_group(
        &mut self,
        name: &str,
        region: &dyn Region,
        solids: Option<&[usize]>,
    ) -> usize {
        let bit = match self.group(name).map(|group| &self.world.groups[group].members) {
            Some(Members::Particles { bit }) => *bit,
            _ => {
                let bit = self.bits;
                self.bits += 1;
                let members = Members::Particles { bit };
                self.world.groups.0.push(Group { name: name.to_string(), members });
                bit
            }
        };
        let particles = &mut self.world.particles;
        for p in 0..particles.len() {
            let listed = solids.is_none_or(|list| list.contains(&(particles.solid[p] as usize)));
            let reference = [Column::X0, Column::Y0, Column::Z0]
                .map(|column| particles.column(column).get(p).copied().unwrap_or(0.0));
            if listed && region.contains(reference) {
                particles.join(p, bit);
            }
        }
        let members = Members::Particles { bit };
        (0..particles.len()).filter(|p| particles.belongs(*p, &members)).count()
    }

    /// Adds the grid nodes inside the region to a group; tells whether it has any member.
    pub fn add_node_group(&mut self, name: &str, region: Arc<dyn Region>) -> bool {
        let domain = self.world.domain;
        let known = self.group(name).map(|group| &mut self.world.groups.0[group.0].members);
        let regions = match known {
            Some(Members::Nodes { regions }) => {
                regions.push(region);
                regions.clone()
            }
            _ => {
                let members = Members::Nodes { regions: vec![region.clone()] };
                self.world.groups.0.push(Group { name: name.to_string(), members });
                vec![region]
            }
        };
        regions.iter().any(|region| has_node(&domain, region.as_ref()))
    }

    /// Sets the objective rate of hypoelastic laws, before the first run.
    pub fn set_rate(&mut self, rate: StressRate) {
        self.world.rate = rate;
    }
}
