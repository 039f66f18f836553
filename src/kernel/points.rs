//! Velocity gradients, stress and movement of the particles, and P2G.

use super::by_space;
use super::chunk::{SCRATCH, Scratch, stresses};
use super::domains;
use super::ghosts::NodeArray;
use super::scatter::Parcel;
use super::shared::Shared;
use super::stencil::Frame;
use super::support::{Footprint, Records, Support};
use super::tiles::{Report, Tile, Tiles};
use super::trouble;
use super::work::advance_and_book;
use crate::material::kinematics::thinnest;
use crate::material::state::copy;
use crate::material::{Description, GROUPS, LANES, NOTHING};
use crate::math::v4::{Plain, Sweep, Wide, dispatch, splats};
use crate::math::wide::{in_space, rotation};
use crate::model::column::{COLUMNS, Column, ColumnSet};
use crate::model::grid::Node;
use crate::model::ledger::Share;
use crate::model::particles::DOMAIN_RECORDS;
use crate::plan::Trouble;
use crate::shape::{DomainKind, ShapeKind};
use crate::world::{Solid, World};
use std::marker::PhantomData;
use std::ops::Range;

/// What the sweep does.
#[derive(Clone, Copy, Debug, Default)]
pub struct Points {
    /// Size of the step \[T\].
    pub dt: f64,
    /// Line 15 of language.md 7.1: L from the nodal velocities; F, J, stress.
    pub stress: bool,
    /// The adaptive dt needs wave speeds and rates.
    pub time_step: bool,
    /// The trace of L is replaced by its average over the grid.
    pub averaged_dilation: bool,
    /// L is kept for the coming P2G (`gradient-enhanced`).
    pub keep_gradient: bool,
    /// x += dx.
    pub advance: bool,
    /// Mass and momentum go to the nodes.
    pub motion: bool,
    /// Internal forces go to the nodes.
    pub force: bool,
    /// Momentum is that of v_p + A_p (x_I - x_p).
    pub affine: bool,
    /// Forces and L come from moments in place of gradients (MLS).
    pub moments: bool,
    /// Particles are watched.
    pub trouble: Option<Trouble>,
    /// L is the matrix C_p that the gathering left (MLS after v*).
    pub matrix_is_gradient: bool,
}

impl Points {
    /// What is left of it for rigid bodies: they move.
    fn of_rigid(self) -> Self {
        Self { advance: self.advance, ..Self::default() }
    }
}

/// Does what `points` says for every particle, in chunks of one law: L = sum v (x) grad N at the
/// old place, the law, movement, and P2G (line 5) at the new place.
pub fn sweep(tiles: &mut Tiles, world: &mut World, points: Points) -> Report {
    let (method, dimension) = (world.method, world.domain.dimension);
    by_space!(method.axisymmetric, dimension, method.shape, sweep_of, tiles, world, points)
}

/// Memory that the tiles write, each its part.
struct Lent<'a> {
    position: Shared<'a, [f64; 4]>,
    domain: [Shared<'a, [f64; 4]>; DOMAIN_RECORDS],
    carried: [Shared<'a, [f64; 4]>; DOMAIN_RECORDS],
    matrix: [Shared<'a, [f64; 4]>; 3],
    columns: [Shared<'a, f64>; COLUMNS],
    nodes: Shared<'a, Node>,
    /// What the particles of each tile do, if the energy ledger is open.
    shares: Shared<'a, Share>,
}

/// What the tiles read.
struct Seen<'a> {
    velocity: &'a [[f64; 4]],
    displacement: &'a [[f64; 4]],
    reference: &'a [[f64; 4]],
    solid: &'a [u16],
    mapped: &'a [[f64; 4]],
    dilation: &'a [f64],
    shape: ShapeKind,
    solids: &'a [Solid],
    present: ColumnSet,
    description: Description,
}

fn sweep_of<const D: usize, const ROUND: bool, F: Footprint<D>>(
    tiles: &mut Tiles,
    world: &mut World,
    points: Points,
) -> Report {
    let description = world.description();
    let World { particles, grid, solids, ledger, method, .. } = world;
    let seen = Seen {
        velocity: &particles.velocity,
        displacement: &particles.displacement,
        reference: &particles.reference,
        solid: &particles.solid,
        mapped: &grid.mapped,
        dilation: &grid.dilation,
        shape: method.shape,
        solids,
        present: particles.present,
        description,
    };
    let mut columns = particles.columns.iter_mut();
    let mut matrix = particles.matrix.iter_mut();
    let lent = Lent {
        position: Shared::new(&mut particles.position),
        domain: particles.domain.each_mut().map(|record| Shared::new(record)),
        carried: particles.carried.each_mut().map(|record| Shared::new(record)),
        matrix: std::array::from_fn(|_| Shared::new(matrix.next().map_or(&mut [], |c| c))),
        columns: std::array::from_fn(|_| Shared::new(columns.next().map_or(&mut [], |c| c))),
        nodes: Shared::new(&mut grid.nodes),
        shares: Shared::new(&mut ledger.shares),
    };
    let nodes = lent.nodes;
    let adds = points.motion || points.force;
    let arrays: &[&dyn NodeArray] = if adds { &[&nodes] } else { &[] };
    tiles.sweep_into(arrays, |tile: Tile<'_>, report| {
        SCRATCH.with_borrow_mut(|scratch| {
            for range in of_one_solid(tile.range, seen.solid) {
                let solid = &seen.solids[seen.solid[range.start] as usize];
                let part = Part::<'_, D, ROUND, F> {
                    solid,
                    range,
                    tile: tile.number,
                    seen: &seen,
                    lent: &lent,
                    scratch,
                    frame: *tile.frame,
                    points: if solid.rigid { points.of_rigid() } else { points },
                    report,
                    footprint: PhantomData,
                };
                dispatch(part);
            }
        })
    })
}

/// Cuts a range into chunks of at most [`LANES`] particles of one solid.
pub fn of_one_solid(range: Range<usize>, solid: &[u16]) -> impl Iterator<Item = Range<usize>> {
    let mut start = range.start;
    std::iter::from_fn(move || {
        if start == range.end {
            return None;
        }
        let limit = range.end.min(start + LANES);
        // Within a tile the particles are sorted by solid.
        let first = solid[start];
        let end = start + solid[start..limit].partition_point(|other| *other == first);
        let chunk = start..end;
        start = end;
        Some(chunk)
    })
}

/// One chunk; `ROUND`: x is a radius.
struct Part<'a, const D: usize, const ROUND: bool, F> {
    solid: &'a Solid,
    range: Range<usize>,
    tile: usize,
    seen: &'a Seen<'a>,
    lent: &'a Lent<'a>,
    scratch: &'a mut Scratch,
    frame: Frame,
    points: Points,
    report: &'a mut Report,
    footprint: PhantomData<F>,
}

impl<const D: usize, const ROUND: bool, F: Footprint<D>> Sweep for Part<'_, D, ROUND, F> {
    type Output = ();

    #[inline(always)]
    fn run<V: Wide>(mut self) {
        let Points { stress, advance, motion, force, .. } = self.points;
        let set = self.solid.columns.common(self.seen.present);
        self.load::<V>(set);
        if stress {
            match (self.points.matrix_is_gradient, self.points.moments) {
                (true, _) => self.take_matrix(),
                (false, true) if F::MOMENTS => self.gradients::<V, true>(),
                (false, _) => self.gradients::<V, false>(),
            }
            self.update::<V>();
            self.store::<V>(set);
            if F::RECORDS > 0 && self.seen.description != Description::Total {
                self.stretch_domains::<V>();
            }
        }
        if advance {
            self.advance::<V>();
            if F::RECORDS > 0 && self.seen.description != Description::Total {
                self.advance_domains::<V>();
            }
        }
        if force {
            if !stress {
                let law = &*self.solid.law;
                self.seen.description.turn(law, &mut self.scratch.chunk(0.0));
            }
            let factor = -self.frame.inverse_spacing;
            stresses(self.seen.description, &*self.solid.law, factor, self.scratch);
        }
        match (motion, force, self.points.affine) {
            // With domains one piece of code serves all cases: what is not asked for is 0.
            (true, _, true) if F::RECORDS > 0 => self.scatter::<V, true, true, true>(),
            (true, _, _) | (_, true, _) if F::RECORDS > 0 => self.scatter::<V, true, true, false>(),
            _ if F::RECORDS > 0 => {}
            (true, true, false) => self.scatter::<V, true, true, false>(),
            (true, true, true) => self.scatter::<V, true, true, true>(),
            (true, false, false) => self.scatter::<V, true, false, false>(),
            (true, false, true) => self.scatter::<V, true, false, true>(),
            (false, true, _) => self.scatter::<V, false, true, false>(),
            (false, false, _) => {}
        }
    }
}

impl<'a, const D: usize, const ROUND: bool, F: Footprint<D>> Part<'a, D, ROUND, F> {
    /// Dimensions of tensors: hoop components live.
    const TENSOR: usize = if ROUND { 3 } else { D };

    /// The places the weights belong to.
    #[inline(always)]
    fn places(&self) -> &'a [[f64; 4]] {
        let (seen, lent) = (self.seen, self.lent);
        match seen.description {
            Description::Total => &seen.reference[self.range.clone()],
            // SAFETY: the ranges of the tiles do not overlap, so each particle has one user.
            Description::Updated(_) => unsafe { lent.position.part(self.range.clone()) },
        }
    }

    /// The records of the domains that the weights depend on.
    #[inline(always)]
    fn domains(&self) -> Records<'a> {
        let mut records: Records<'a> = [&[]; DOMAIN_RECORDS];
        for number in 0..F::RECORDS {
            // SAFETY: as in `places`.
            records[number] = unsafe { self.lent.domain[number].part(self.range.clone()) };
        }
        records
    }

    /// The state of the chunk into the scratch memory.
    #[inline(always)]
    fn load<V: Wide>(&mut self, set: ColumnSet) {
        let (range, columns) = (self.range.clone(), &self.lent.columns);
        self.scratch.state.load_wide::<V>(Self::TENSOR, range.len(), set, |column| {
            // SAFETY: as in `places`.
            unsafe { columns[column as usize].part(range.clone()) }
        });
    }

    /// And back.
    #[inline(always)]
    fn store<V: Wide>(&mut self, set: ColumnSet) {
        for column in set.iter() {
            // SAFETY: as in `places`.
            let slice = unsafe { self.lent.columns[column as usize].part(self.range.clone()) };
            copy::<V>(self.scratch.state.values(column), slice);
        }
    }

    /// L of every particle at its old place, in velocity per node spacing.
    #[inline(always)]
    fn gradients<V: Wide, const MOMENTS: bool>(&mut self) {
        let (frame, mapped, places) = (self.frame, self.seen.mapped, self.places());
        let domains = self.domains();
        let Scratch { records, numbers, .. } = &mut *self.scratch;
        let len = places.len().min(LANES);
        let mut memory = F::Memory::default();
        for p in 0..len {
            let mut support = F::at::<V, true, false>(&mut memory, &frame, places, &domains, p);
            if MOMENTS {
                support = F::affine::<V>(support);
            }
            let (columns, value) = support.gradient_and_value::<V>(mapped);
            for j in 0..D {
                columns[j].store(&mut records[j][p]);
            }
            if ROUND {
                numbers[p / 4][p % 4] = frame.hoop_rate(value.array()[0], places[p][0]);
            }
        }
    }

    /// Kinematics and law; then what the time step needs.
    #[inline(always)]
    fn update<V: Wide>(&mut self) {
        let groups = self.scratch.state.groups().end;
        // The lanes that fill up the last group have no gradient.
        let len = self.range.len().min(LANES);
        for column in self.scratch.records.iter_mut().take(D) {
            column[len..(4 * groups).clamp(len, LANES)].fill([0.0; 4]);
        }
        let scale = match self.points.matrix_is_gradient {
            true => 1.0,
            false => self.frame.inverse_spacing,
        };
        self.scratch.spread::<V, D>(scale, groups);
        if ROUND {
            self.scratch.spread_hoop(len);
        }
        if self.points.keep_gradient {
            self.keep_gradient();
        }
        if self.points.averaged_dilation {
            self.average_dilation::<V>();
        }
        let law = &*self.solid.law;
        let has_deformation = self.scratch.state.has(Column::F11);
        self.scratch.cell = self.solid.cells.cell;
        let mut chunk = self.scratch.chunk(self.points.dt);
        if self.lent.shares.is_empty() {
            self.seen.description.advance(law, has_deformation, &mut chunk);
            law.update(&mut chunk);
        } else {
            // SAFETY: each tile has one worker.
            let share = unsafe { &mut self.lent.shares.part(self.tile..self.tile + 1)[0] };
            let velocity = &self.seen.velocity[self.range.clone()];
            let description = self.seen.description;
            advance_and_book(description, law, has_deformation, &mut chunk, velocity, share);
        }
        if let Some(failed) = chunk.failed {
            self.report.failed.get_or_insert(self.range.start + failed);
        }
        self.report.clipped += chunk.clipped;
        if let Some(bounds) = &self.points.trouble {
            let velocity = &self.seen.velocity[self.range.clone()];
            let wave = law.reference_wave_speed();
            let found = trouble::first(self.scratch, velocity, bounds, wave, self.points.dt);
            let found = found.map(|p| self.range.start + p);
            self.report.troubled = self.report.troubled.or(found);
        }
        if self.points.time_step {
            self.time_step::<V>();
        }
    }

    /// L_p <- C_p.
    fn take_matrix(&mut self) {
        for (axis, records) in self.scratch.records.iter_mut().enumerate().take(D) {
            // SAFETY: as in `places`.
            let matrix = unsafe { self.lent.matrix[axis].part(self.range.clone()) };
            records[..matrix.len()].copy_from_slice(matrix);
        }
        if ROUND {
            // What moves the particle stretches its hoop: F33 = r/r0.
            let displacement = &self.seen.displacement[self.range.clone()];
            let places = self.places();
            for (p, (dx, place)) in displacement.iter().zip(places).take(LANES).enumerate() {
                let rate = self.frame.hoop_rate(dx[0] / self.points.dt, place[0]);
                self.scratch.numbers[p / 4][p % 4] = rate;
            }
        }
    }

    /// A_p <- L_p.
    fn keep_gradient(&mut self) {
        for (axis, records) in self.scratch.records.iter().enumerate().take(D) {
            // SAFETY: as in `places`.
            let matrix = unsafe { self.lent.matrix[axis].part(self.range.clone()) };
            let scale = self.frame.inverse_spacing;
            for (matrix, [x, y, z, _]) in matrix.iter_mut().zip(records) {
                *matrix = [scale * x, scale * y, scale * z, 0.0];
            }
        }
    }

    /// L <- L + (theta - tr L)/d I, theta the average over the grid; in total Lagrangian methods
    /// the same with L = dF/dt F^-1.
    #[inline(always)]
    fn average_dilation<V: Wide>(&mut self) {
        let (frame, places, domains) = (self.frame, self.places(), self.domains());
        let len = places.len().min(LANES);
        // The lanes that fill up the last group must have no gradient afterwards either: the largest
        // rate is taken over all of them.
        self.scratch.numbers.as_flattened_mut()[len..].fill(0.0);
        let mut memory = F::Memory::default();
        for p in 0..len {
            let support = F::at::<V, false, false>(&mut memory, &frame, places, &domains, p);
            self.scratch.numbers[p / 4][p % 4] = support.sum_of_numbers(self.seen.dilation);
        }
        match ROUND {
            true => super::dilation::replace::<V, 3>(self.scratch, self.seen.description),
            false => super::dilation::replace::<V, D>(self.scratch, self.seen.description),
        }
    }

    /// The fastest wave, the largest rate and the smallest stretch of the chunk.
    #[inline(always)]
    fn time_step<V: Wide>(&mut self) {
        let law = &*self.solid.law;
        let mut speed = self.scratch.numbers;
        law.wave_speed(&self.scratch.state, &mut speed);
        law.stiffen(&self.scratch.chunk(self.points.dt), &mut speed);
        let Scratch { state, gradient, .. } = &mut *self.scratch;
        self.report.spread(self.solid.spreading, state);
        let mut fastest = V::splat(self.report.fastest);
        let velocity = &self.seen.velocity[self.range.clone()];
        for (wave, v) in speed.as_flattened().iter().zip(velocity) {
            fastest = (V::load(v).absolute() + V::splat(*wave)).larger(fastest);
        }
        self.report.fastest = fastest.array()[..D].iter().fold(0.0, |a, b| a.max(*b));
        let mut largest = V::splat(0.0);
        for group in 0..state.groups().end.min(GROUPS) {
            let mut square = V::splat(0.0);
            for entry in 0..9 {
                if in_space::<D>(entry) || (ROUND && entry == 8) {
                    let rate = V::load(&gradient[entry][group]);
                    square = rate.mul_add(rate, square);
                }
            }
            largest = square.larger(largest);
        }
        self.report.rate = largest.array().into_iter().fold(self.report.rate, f64::max);
        if self.seen.description == Description::Total {
            self.report.thinnest = self.report.thinnest.min(thinnest(state));
        }
    }

    /// x += dx.
    #[inline(always)]
    fn advance<V: Wide>(&mut self) {
        let (lower, upper) = (V::load(&self.frame.walls[0]), V::load(&self.frame.walls[1]));
        // SAFETY: as in `places`.
        let position = unsafe { self.lent.position.part(self.range.clone()) };
        let displacement = &self.seen.displacement[self.range.clone()];
        let (mut least, mut largest) = (upper, lower);
        for (position, dx) in position.iter_mut().zip(displacement) {
            let place = V::load(position);
            let place = (place + V::load(dx)).with_last(place);
            place.store(position);
            (least, largest) = (least.smaller(place), largest.larger(place));
        }
        if !(least.inside(lower, upper) && largest.inside(lower, upper)) {
            let outside = |place: &[f64; 4]| {
                !Plain::load(place)
                    .inside(Plain::load(&self.frame.walls[0]), Plain::load(&self.frame.walls[1]))
            };
            self.report.escaped = position.iter().position(outside).map(|p| self.range.start + p);
        }
    }

    /// What domains that follow the material change by: half edges by dt L r, half sizes to l U_ii, at
    /// most h/2.
    #[inline(always)]
    fn stretch_domains<V: Wide>(&mut self) {
        let range = self.range.clone();
        let lent = self.lent;
        match self.seen.shape {
            ShapeKind::Corners(DomainKind::Parallel) => {
                for number in 0..F::RECORDS.min(D) {
                    // SAFETY: as in `places`.
                    let (edges, changes) = unsafe {
                        (
                            lent.domain[number].part(range.clone()),
                            lent.carried[number].part(range.clone()),
                        )
                    };
                    self.stretch_edges::<V>(edges, changes);
                }
            }
            ShapeKind::StretchedGimp => {
                // SAFETY: as in `places`.
                let (sizes, changes) =
                    unsafe { (lent.domain[0].part(range.clone()), lent.carried[0].part(range)) };
                self.stretch_boxes::<V>(sizes, changes);
            }
            _ => {}
        }
    }

    /// changes <- dt L r for the half edges r.
    #[inline(always)]
    fn stretch_edges<V: Wide>(&self, edges: &[[f64; 4]], changes: &mut [[f64; 4]]) {
        let (dt, gradient) = (V::splat(self.points.dt), &self.scratch.gradient);
        let (groups, zero) = (edges.chunks(4).zip(changes.chunks_mut(4)), V::splat(0.0));
        for (group, (edges, changes)) in groups.enumerate().take(GROUPS) {
            let mut columns = [[zero; 4]; D];
            for j in 0..D {
                let mut rows = [zero; 4];
                for i in 0..D {
                    rows[i] = dt * V::load(&gradient[3 * i + j][group]);
                }
                columns[j] = V::transpose(rows);
            }
            for (lane, (edge, change)) in edges.iter().zip(changes).enumerate().take(4) {
                let mut sum = V::splat(edge[0]) * columns[0][lane];
                for j in 1..D {
                    sum = V::splat(edge[j]).mul_add(columns[j][lane], sum);
                }
                sum.store(change);
            }
        }
    }

    /// changes <- l U_ii - l_i, with U = R^T F and l U_ii at most h/2; the records hold l_i and l.
    #[inline(always)]
    fn stretch_boxes<V: Wide>(&self, sizes: &[[f64; 4]], changes: &mut [[f64; 4]]) {
        let [zero, one, most]: [V; 3] = splats([0.0, 1.0, 0.5 * self.frame.spacing]);
        let groups = sizes.chunks(4).zip(changes.chunks_mut(4)).enumerate().take(GROUPS);
        for (group, (sizes, changes)) in groups {
            let deformation = self.scratch.state.deformation_of_four::<V>(group);
            let turn = rotation::<V, D>(&deformation);
            let mut stretch = [one; 4];
            for axis in 0..D {
                stretch[axis] = zero;
                for k in 0..D {
                    let entry = 3 * k + axis;
                    stretch[axis] = turn[entry].mul_add(deformation[entry], stretch[axis]);
                }
            }
            let stretch = V::transpose(stretch);
            for (lane, (size, change)) in sizes.iter().zip(changes).enumerate().take(4) {
                let new = (V::splat(size[3]) * stretch[lane]).smaller(most);
                (new - V::load(size)).with_last(zero).store(change);
            }
        }
    }

    /// Domains change with the places of their particles; then how far corners reach.
    #[inline(always)]
    fn advance_domains<V: Wide>(&mut self) {
        let (range, lent) = (self.range.clone(), self.lent);
        if lent.carried[0].is_empty() || (F::FREE && self.solid.rigid) {
            return;
        }
        let displacement = &self.seen.displacement[range.clone()];
        for number in 0..F::RECORDS {
            // SAFETY: as in `places`.
            let (records, changes) = unsafe {
                (lent.domain[number].part(range.clone()), lent.carried[number].part(range.clone()))
            };
            for ((record, change), dx) in records.iter_mut().zip(changes).zip(displacement) {
                let mut change = V::load(change);
                if F::FREE {
                    // Free corners were carried by the grid, their particle by dx.
                    change = change - V::load(dx);
                }
                let old = V::load(record);
                (old + change).with_last(old).store(record);
            }
        }
        if matches!(self.seen.shape, ShapeKind::Corners(_)) {
            self.measure_domains::<V>();
        }
    }

    /// How far the corners of domains reach, and whether any must be moved.
    #[inline(always)]
    fn measure_domains<V: Wide>(&mut self) {
        let (records, places) = (self.domains(), self.places());
        let len = places.len();
        let (mut least, mut largest) = (V::splat(f64::INFINITY), V::splat(f64::NEG_INFINITY));
        let mut widest = V::splat(0.0);
        for p in 0..len {
            let mut extent = V::load(&records[0][p]).absolute();
            for number in 1..F::RECORDS {
                let size = V::load(&records[number][p]).absolute();
                extent = if F::FREE { extent.larger(size) } else { extent + size };
            }
            let place = V::load(&places[p]);
            (least, largest) = (least.smaller(place - extent), largest.larger(place + extent));
            widest = widest.larger(extent);
        }
        let [x, y, z, _] = widest.array();
        self.report.reach = self.report.reach.max(self.frame.inverse_spacing * x.max(y).max(z));
        if !self.frame.holds(least, largest, widest) {
            let cut = |p: &usize| {
                let extent = domains::extent(&records, self.seen.shape, *p);
                self.frame.cuts(&places[*p], extent, D)
            };
            let cut = (0..len).find(cut).map(|p| self.range.start + p);
            self.report.cut = self.report.cut.or(cut);
        }
    }

    /// P2G of mass and momentum, and of forces.
    #[inline(always)]
    fn scatter<V: Wide, const MOTION: bool, const FORCE: bool, const AFFINE: bool>(&mut self) {
        if self.report.escaped.is_some() {
            return;
        }
        let (frame, nodes) = (self.frame, self.lent.nodes);
        let spacing = V::splat(frame.spacing);
        let moments = FORCE && F::MOMENTS && self.points.moments;
        if F::RECORDS > 0 && !self.points.force {
            self.scratch.records = [[[0.0; 4]; LANES]; 3];
        }
        let carried = F::RECORDS > 0 && !self.points.motion;
        let records = &self.scratch.records;
        // Indices below LANES and slices of one length: the loop needs no further checks.
        let len = self.range.len().min(LANES);
        let (places, domains) = (&self.places()[..len], self.domains());
        let velocity = &self.seen.velocity[self.range.clone()][..len];
        let mut memory = F::Memory::default();
        for p in 0..len {
            let (place, v) = (&places[p], &velocity[p]);
            let mut support = F::at::<V, true, false>(&mut memory, &frame, places, &domains, p);
            let mass = V::splat(if carried { 0.0 } else { place[3] });
            let mut parcel = Parcel {
                motion: mass * V::load(v).with_last(V::splat(1.0)),
                spread: [V::splat(0.0); D],
                force: [V::splat(0.0); D],
                hoop: V::splat(0.0),
            };
            if AFFINE {
                for axis in 0..D {
                    // SAFETY: as in `places`.
                    let matrix = unsafe { self.lent.matrix[axis].part(self.range.clone()) };
                    parcel.spread[axis] = mass * spacing * V::load(&matrix[p]);
                }
            }
            if FORCE {
                let volume = V::splat(v[3]);
                for axis in 0..D {
                    parcel.force[axis] = volume * V::load(&records[axis][p]);
                }
                if ROUND {
                    // The records hold -P/h.
                    let stress = frame.spacing * records[2][p][2];
                    let force = v[3] * stress * frame.inverse_radius(place[0]);
                    parcel.hoop = V::load(&[force, 0.0, 0.0, 0.0]);
                }
                if moments {
                    support = F::affine::<V>(support);
                }
            }
            support.scatter::<V, ROUND, MOTION, FORCE, AFFINE>(parcel, nodes);
        }
    }
}

/// What limits the time step in the present state, by lattice: before the first step of a run.
pub fn at_rest(world: &World) -> Vec<Report> {
    let lattices = if world.method.total { world.solids.len() } else { 1 };
    let mut reports = vec![Report::default(); lattices];
    let mut speed = NOTHING;
    world.each_chunk(|range, solid, state| {
        if solid.rigid {
            return;
        }
        let number = world.particles.solid[range.start] as usize;
        let report = &mut reports[if world.method.total { number } else { 0 }];
        solid.law.wave_speed(state, &mut speed);
        report.spread(solid.spreading, state);
        let inverse_cell = 1.0 / solid.cells.cell;
        for (speed, v) in speed.as_flattened().iter().zip(&world.particles.velocity[range]) {
            let fastest = v[0].abs().max(v[1].abs()).max(v[2].abs());
            report.fastest = report.fastest.max(speed + fastest);
            if solid.law.reads_volume_before() {
                // A gas can be slower than what hits it: all of its speed may end in one cell.
                report.rate = report.rate.max((fastest * inverse_cell).powi(2));
            }
        }
        if world.method.total {
            report.thinnest = report.thinnest.min(thinnest(state));
        }
    });
    reports
}
