//! Building the scene: particles of solids, groups.

use super::Simulation;
use super::build::{Parcels, Source};
use super::fill::{self, Filling, touched};
use crate::fault::Fault;
use crate::fix::components::{Components, of_particles};
use crate::geometry::Points;
use crate::material::{Law, StressRate};
use crate::measure::Captured;
use crate::method::Method;
use crate::model::clock::Clock;
use crate::model::column::{Column, ColumnSet};
use crate::model::contact::Contacts;
use crate::model::domain::{Boundary, Domain};
use crate::model::grid::Grid;
use crate::model::group::{Group, GroupId, Groups, Members, NodePart};
use crate::model::lattice::Lattice;
use crate::model::ledger::Ledger;
use crate::model::particles::Particles;
use crate::model::rigid::Rigid;
use crate::output::Outputs;
use crate::parallel::Ranks;
use crate::plan::Plan;
use crate::region::Region;
use crate::scheme::musl::Musl;
use crate::scheme::{Loops, Scheme};
use crate::script::formula::{Board, Instant, Slot};
use crate::script::history::History;
use crate::time_step::Floor;
use crate::transfer::{Transfer, TransferKind};
use crate::world::{Solid, Spreading, World};
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

/// Does any node of the lattice lie in the region?
fn has_node(lattice: &Lattice, region: &dyn Region) -> bool {
    let mut searched = 0;
    let cells = touched(&lattice.cells, &region.bounds(), 0);
    let per_cell = lattice.nodes.map(|count| if count > 1 { lattice.nodes_per_cell() } else { 1 });
    let [across, along, up] = std::array::from_fn(|axis| {
        let (first, last) = (*cells[axis].start(), *cells[axis].end());
        first * per_cell[axis]..=((last + 1) * per_cell[axis]).min(lattice.nodes[axis] - 1)
    });
    across.into_iter().any(|i| {
        along.clone().any(|j| {
            up.clone().any(|k| {
                searched += 1;
                searched > MOST_SEARCHED || region.contains(lattice.place([i, j, k]))
            })
        })
    })
}

/// Lower and upper corner of a box that holds nothing.
const NO_BOX: [[f64; 3]; 2] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

/// Makes a box hold a place too.
fn widen([lower, upper]: &mut [[f64; 3]; 2], place: [f64; 3]) {
    for axis in 0..3 {
        lower[axis] = lower[axis].min(place[axis]);
        upper[axis] = upper[axis].max(place[axis]);
    }
}

/// The box around those of all processes.
fn joined(ranks: &Ranks, [lower, upper]: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    [ranks.largest(lower.map(|x| -x)).map(|x| -x), ranks.largest(upper)]
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
            ledger: Ledger::default(),
            method: Method::default(),
            rate: StressRate::default(),
            boundary: Boundary::default(),
            thermal_blend: 0.99,
            rigid: Rigid::default(),
            contacts: Contacts::default(),
            ranks: Ranks::default(),
        };
        Self {
            world,
            clock: Clock::default(),
            transfer: Transfer::new(TransferKind::Flip, 1.0),
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
            bound: None,
            floor: Floor::default(),
            watch: None,
            rescue: Default::default(),
            alarmed: false,
            progress: None,
            history: History::default(),
            bits: 0,
            interrupted: false,
        }
    }

    /// Deals particles out to several processes from the first run on.
    pub fn set_ranks(&mut self, ranks: Ranks) {
        self.world.particles.counted_elsewhere = !ranks.is_first();
        self.world.ranks = ranks;
    }

    /// Gives a simulation without bodies its box.
    pub fn set_domain(&mut self, domain: Domain) {
        self.world.domain = domain;
        self.world.particles = no_particles(domain.dimension);
        self.world.particles.counted_elsewhere = !self.world.ranks.is_first();
    }

    /// Fills a region with particles on cells of the size of the grid's; gives the number of those that
    /// this process has.
    pub fn add_solid(
        &mut self,
        name: &str,
        material: &str,
        law: Arc<dyn Law>,
        region: &dyn Region,
        particles_per_cell: usize,
    ) -> usize {
        let cell = self.world.domain.cell;
        self.add_solid_of_cell(name, material, law, region, particles_per_cell, cell)
    }

    /// Fills a region with particles (language.md 6.3); gives the number of those that this process
    /// has. In total Lagrangian methods the region must be bounded, and `cell` is the cell size of the
    /// solid's own lattice.
    pub fn add_solid_of_cell(
        &mut self,
        name: &str,
        material: &str,
        law: Arc<dyn Law>,
        region: &dyn Region,
        particles_per_cell: usize,
        cell: f64,
    ) -> usize {
        let domain = self.world.cells_between(&region.bounds(), cell);
        let even = self.world.method.shape.has_domains();
        let source = Source::of_region(region, &domain, particles_per_cell, even);
        self.add_body(name, material, law, domain, particles_per_cell as f64, &source)
    }

    /// Adds a solid from what its particles come from, on cells of size `cell`; gives the number of
    /// those that this process has.
    pub fn add_filled_solid(
        &mut self,
        name: &str,
        material: &str,
        law: Arc<dyn Law>,
        filling: &Filling,
        cell: f64,
    ) -> usize {
        let domain = self.world.cells_between(&filling.bounds(), cell);
        let particles_per_cell = match filling {
            Filling::Region { particles_per_cell, .. } => *particles_per_cell as f64,
            Filling::Points(points) => cell / points.spacing(domain.dimension),
        };
        let source = Source::of(filling, &domain);
        self.add_body(name, material, law, domain, particles_per_cell, &source)
    }

    /// Adds a solid with the particles of a source.
    fn add_body(
        &mut self,
        name: &str,
        material: &str,
        law: Arc<dyn Law>,
        domain: Domain,
        particles_per_cell: f64,
        source: &Source<'_>,
    ) -> usize {
        let columns = self.world.columns_of(&*law);
        self.world.particles.require(columns);
        let temperature = law.initial_temperature();
        let rigid = law.is_rigid();
        self.world.solids.push(Solid {
            name: name.to_string(),
            material: material.to_string(),
            law,
            particles_per_cell,
            cells: domain,
            columns,
            spreading: Spreading::default(),
            rigid,
            lattice: 0,
        });
        self.world.assign_lattices();
        let number = self.world.solids.len() - 1;
        let count = self.push_particles(number, source);
        self.heat_solid(number, temperature);
        count
    }

    /// Gives a solid the particles of a source; gives the number of those that this process has.
    fn push_particles(&mut self, solid: usize, source: &Source<'_>) -> usize {
        let World { particles, solids, method, domain, ranks, .. } = &mut self.world;
        let (dimension, cells) = (domain.dimension, &solids[solid].cells);
        let density = solids[solid].law.density();
        let values = solids[solid].law.initial_values();
        let before = particles.len();
        let [last] = ranks.largest([f64::from(particles.id.iter().copied().max().unwrap_or(0))]);
        // Nothing lies on the axis or behind it.
        let volume = |place, area: f64| Some(area * method.girth(place)).filter(|v| *v > 0.0);
        let mut id = last as u32;
        let mut push = |id: &mut u32, place, area, corners: &[[f64; 3]]| {
            if let Some(volume) = volume(place, area) {
                *id += 1;
                particles.push(*id, solid as u16, place, density * volume, volume);
                let half = 0.5 * fill::edge(area, dimension);
                let records = method.shape.domain_of(dimension, place, corners, half, cells.cell);
                particles.add_domains(method.shape.records(dimension), |_, _| records);
            }
        };
        let parcels = Parcels::new(source, cells, method.shape);
        match ranks.exchange() {
            None => (0..parcels.len()).for_each(|parcel| {
                parcels
                    .visit(parcel, &mut |place, area, corners| push(&mut id, place, area, corners));
            }),
            Some(exchange) => {
                let exists = |place, area| volume(place, area).is_some();
                for (parcel, earlier) in parcels.deal(exchange, before, exists) {
                    let mut id = id + earlier as u32;
                    parcels.visit(parcel, &mut |place, area, corners| {
                        push(&mut id, place, area, corners);
                    });
                }
            }
        }
        for (column, value) in values {
            particles.column_mut(column)[before..].fill(value);
        }
        particles.len() - before
    }

    /// Replaces the particles of a solid before the first run.
    pub fn replace_particles(&mut self, solid: usize, points: &Points) {
        let keep: Vec<bool> =
            self.world.particles.solid.iter().map(|other| *other as usize != solid).collect();
        self.world.particles.retain(&keep);
        self.push_particles(solid, &Source::Points { points, cut: false });
        let dimension = self.world.domain.dimension;
        let body = &mut self.world.solids[solid];
        body.particles_per_cell = body.cells.cell / points.spacing(dimension);
        if self.world.method.total {
            let cells = &mut self.world.solids[solid].cells;
            cells.cover(points.list.iter().map(|point| point.place));
            cells.lower = self.world.method.lower_limits(cells.lower);
        }
    }

    /// Moves places and reference places of the particles of a solid (`None`: of all) that are
    /// inside the region now; tells whether all of them are still in the box.
    ///
    /// # Errors
    /// A formula that is not finite.
    pub fn translate_particles(
        &mut self,
        solid: Option<usize>,
        region: &dyn Region,
        by: &Components,
    ) -> Result<bool, Fault> {
        self.board.values.resize(self.quantities.len(), 0.0);
        let slots: Vec<Slot> = by.formulas().iter().flat_map(|f| f.slots().to_vec()).collect();
        self.refresh(&slots);
        let World { particles, solids, domain, method, ranks, .. } = &mut self.world;
        let inside = |p: &usize| {
            let [x, y, z, _] = particles.position[*p];
            solid.is_none_or(|solid| solid == particles.solid[*p] as usize)
                && region.contains([x, y, z])
        };
        let members: Vec<usize> = (0..particles.len()).filter(inside).collect();
        let place = of_particles(&particles.position, &particles.columns);
        let now = Instant::start(&self.clock);
        let mut moves = Vec::with_capacity(members.len());
        let done = by.each(&self.board, &now, members.into_iter(), place, |p, by| {
            moves.push((p, by.map(Option::unwrap_or_default)));
        });
        ranks.agree(done.err(), &mut [])?;
        // Of each solid the number of particles moved, and the least and the most by which.
        let mut moved = vec![(0, NO_BOX); solids.len()];
        for (p, by) in moves {
            let (count, limits) = &mut moved[particles.solid[p] as usize];
            *count += 1;
            widen(limits, by);
            let girth = method.girth(particles.reference_place(p));
            for (axis, column) in [Column::X0, Column::Y0, Column::Z0].into_iter().enumerate() {
                particles.position[p][axis] += by[axis];
                if let Some(reference) = particles.column_mut(column).get_mut(p) {
                    *reference += by[axis];
                }
            }
            let growth = method.girth(particles.reference_place(p)) / girth;
            particles.position[p][3] *= growth;
            particles.velocity[p][3] *= growth;
        }
        particles.reference.clear();
        let place = |p: usize| std::array::from_fn(|axis| particles.position[p][axis]);
        if !method.total {
            return Ok(!ranks.any(!(0..particles.len()).all(|p| domain.contains(place(p)))));
        }
        // Such bodies move before the first run only.
        for (number, (solid, (count, by))) in solids.iter_mut().zip(moved).enumerate() {
            let own = particles.counted().filter(|p| particles.solid[*p] as usize == number);
            let mut limits = NO_BOX;
            own.clone().for_each(|p| widen(&mut limits, place(p)));
            let [count, all] = ranks.count([count, own.count()]);
            let [[least, most], limits] = [by, limits].map(|limits| joined(ranks, limits));
            if all > 0 && count == all && least == most {
                solid.cells.shift(most);
            } else if all > 0 {
                solid.cells.cover(limits.into_iter());
            }
            solid.cells.lower = method.lower_limits(solid.cells.lower);
        }
        Ok(!ranks.any(!(0..particles.len()).all(|p| method.girth(place(p)) > 0.0)))
    }

    /// Removes the particles of a solid (`None`: of all) whose reference place is inside the region;
    /// tells whether every solid has a particle left.
    pub fn delete_particles(&mut self, solid: Option<usize>, region: &dyn Region) -> bool {
        let World { particles, ranks, solids, .. } = &mut self.world;
        let chosen = |p: usize| solid.is_none_or(|solid| solid == particles.solid[p] as usize);
        let keep: Vec<bool> = (0..particles.len())
            .map(|p| !(chosen(p) && region.contains(particles.reference_place(p))))
            .collect();
        particles.retain(&keep);
        let here = |solid: u16| particles.solid.contains(&solid);
        (0..solids.len() as u16).all(|solid| ranks.any(here(solid)))
    }

    /// Gives the solid added last its temperature \[K\].
    pub fn heat_last_solid(&mut self, temperature: f64) {
        self.heat_solid(self.world.solids.len().saturating_sub(1), temperature);
    }

    /// Gives a solid its temperature \[K\].
    pub fn heat_solid(&mut self, number: usize, temperature: f64) {
        let particles = &mut self.world.particles;
        let mut column = ColumnSet::default();
        column.insert(Column::Temperature);
        if temperature != 0.0 {
            particles.require(column);
        }
        let solids = std::mem::take(&mut particles.solid);
        for (value, solid) in particles.column_mut(Column::Temperature).iter_mut().zip(&solids) {
            if *solid as usize == number {
                *value = temperature;
            }
        }
        particles.solid = solids;
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
        let World { particles, ranks, .. } = &mut self.world;
        particles.require_mask(bit);
        for p in 0..particles.len() {
            let listed = solids.is_none_or(|list| list.contains(&(particles.solid[p] as usize)));
            let reference = particles.reference_place(p);
            if listed && region.contains(reference) {
                particles.join(p, bit);
            }
        }
        let members = Members::Particles { bit };
        let [count] =
            ranks.count([particles.counted().filter(|p| particles.belongs(*p, &members)).count()]);
        count
    }

    /// Adds the nodes inside the region (in total Lagrangian methods those of the listed solids;
    /// `None`: all) to a group; tells whether it has any member.
    pub fn add_node_group(
        &mut self,
        name: &str,
        region: Arc<dyn Region>,
        solids: Option<&[usize]>,
    ) -> bool {
        let part = NodePart { region, solids: solids.map(<[usize]>::to_vec), lattices: Vec::new() };
        let group = self.group(name).unwrap_or_else(|| {
            let members = Members::Nodes { parts: Vec::new() };
            self.world.groups.0.push(Group { name: name.to_string(), members });
            GroupId(self.world.groups.0.len() - 1)
        });
        if let Members::Nodes { parts } = &mut self.world.groups.0[group.0].members {
            parts.push(part);
        }
        self.world.assign_lattices();
        let found = self.world.make_lattices();
        let Members::Nodes { parts } = &self.world.groups.0[group.0].members else {
            return false;
        };
        let mut pairs =
            parts.iter().flat_map(|part| found.iter().enumerate().map(move |l| (part, l)));
        pairs.any(|(part, (number, lattice))| {
            part.includes(number) && has_node(lattice, part.region.as_ref())
        })
    }

    /// Sets the method, before the first solid.
    pub fn set_method(&mut self, method: Method) {
        self.world.method = method;
    }

    /// Sets the scheme, before the first run.
    pub fn set_scheme(&mut self, scheme: &'static dyn Scheme) {
        self.scheme = scheme;
    }

    /// Sets the objective rate of hypoelastic laws, before the first run.
    pub fn set_rate(&mut self, rate: StressRate) {
        self.world.rate = rate;
    }
}
