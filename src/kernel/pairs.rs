//! Pairs of particles of two solids that overlap, found by a cell list.
//!
//! A particle is a sphere of radius R = V^(1/d)/2 (language.md 7.4). Only particles where the bodies
//! come within reach of each other are sorted into cells; each of them then sums over its partners
//! on the other side, in the order of the cells and ids. Every particle has one writer and every sum
//! one order: the result has the same bits for any number of threads and processes, each of which
//! knows all particles within reach and sums for its own. A pair is evaluated twice, from
//! either side, with the same numbers, so that its two forces are equal and opposite to the bit.

use super::tiles::SMALLEST_PARALLEL;
use crate::math::exact_sum::VectorSum;
use crate::model::column::Column;
use crate::parallel::Ranks;
use crate::world::World;
use rayon::prelude::*;
use std::ops::Range;

/// Particles per call below which a thread of its own does not pay.
const LEAST_PER_THREAD: usize = 256;

/// A pair of overlapping particles, 1 of the first solid and 2 of the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Unit vector from 2 to 1.
    pub normal: [f64; 3],
    /// R1 + R2 - r > 0 \[L\].
    pub penetration: f64,
    /// R1 and R2 \[L\].
    pub radii: [f64; 2],
    /// m1 m2/(m1 + m2) \[M\]; a rigid partner counts as infinite mass.
    pub reduced_mass: f64,
    /// The smaller mass \[M\].
    pub smallest_mass: f64,
    /// v1 - v2 \[L/T\].
    pub velocity: [f64; 3],
}

/// What a pair does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Response {
    /// Force on 1 \[M L/T^2\]; 2 gets the opposite.
    pub force: [f64; 3],
    /// Power of friction \[M L^2/T^3\], at least 0.
    pub friction: f64,
    /// Largest (stiffness)/(mass) \[1/T^2\] that an explicit step must resolve.
    pub rate: f64,
}

/// A law of contact.
pub trait PairLaw: Sync {
    /// The response of an overlapping pair.
    fn respond(&self, pair: &Pair) -> Response;
}

/// Radius of a particle of volume `size` \[L^d\]: V^(1/d)/2 (language.md 7.4).
pub fn radius(size: f64, dimension: usize) -> f64 {
    0.5 * match dimension {
        1 => size,
        2 => size.sqrt(),
        _ => size.cbrt(),
    }
}

/// What the radius of a particle grows with: its volume V0 J \[L^d\], round an axis its area V/x.
pub fn size(world: &World, p: usize) -> f64 {
    let particles = &world.particles;
    let volume =
        particles.velocity[p][3] * particles.column(Column::J).get(p).copied().unwrap_or(1.0);
    let [x, y, z, _] = particles.position[p];
    volume / world.method.girth([x, y, z])
}

/// A particle as its partners see it.
#[derive(Clone, Copy, Default)]
struct Body {
    place: [f64; 3],
    radius: f64,
    velocity: [f64; 3],
    /// Infinite for rigid bodies.
    mass: f64,
}

/// A particle that may have partners.
#[derive(Clone, Copy)]
struct Found {
    id: u32,
    /// Place in the table; [`FOREIGN`] for a particle of another process.
    place: u32,
    body: Body,
}

/// The particle is not in the table of this process.
const FOREIGN: u32 = u32::MAX;

/// The particles of one solid that may have partners.
#[derive(Default)]
struct Side {
    /// All of them, by id.
    found: Vec<Found>,
    /// Places in the table, cell by cell.
    members: Vec<u32>,
    /// The particles, cell by cell.
    bodies: Vec<Body>,
    /// First body of each cell, and one past the last.
    first: Vec<u32>,
    /// Sums over the partners of each body.
    sums: Vec<Response>,
}

/// Limits of a solid and its largest particle.
#[derive(Clone, Copy)]
struct Extent {
    lower: [f64; 3],
    upper: [f64; 3],
    size: f64,
}

const NOWHERE: Extent =
    Extent { lower: [f64::INFINITY; 3], upper: [f64::NEG_INFINITY; 3], size: 0.0 };

impl Extent {
    fn with(mut self, place: [f64; 4], size: f64) -> Self {
        for axis in 0..3 {
            self.lower[axis] = self.lower[axis].min(place[axis]);
            self.upper[axis] = self.upper[axis].max(place[axis]);
        }
        self.size = self.size.max(size);
        self
    }

    fn joined(self, other: Self) -> Self {
        Self {
            lower: std::array::from_fn(|a| self.lower[a].min(other.lower[a])),
            upper: std::array::from_fn(|a| self.upper[a].max(other.upper[a])),
            size: self.size.max(other.size),
        }
    }

    fn grown(self, reach: f64) -> Self {
        Self { lower: self.lower.map(|x| x - reach), upper: self.upper.map(|x| x + reach), ..self }
    }

    fn common(self, other: Self) -> Self {
        Self {
            lower: std::array::from_fn(|a| self.lower[a].max(other.lower[a])),
            upper: std::array::from_fn(|a| self.upper[a].min(other.upper[a])),
            size: self.size.max(other.size),
        }
    }

    fn holds(&self, place: [f64; 4]) -> bool {
        (0..3).all(|a| place[a] >= self.lower[a] && place[a] <= self.upper[a])
    }
}

/// Cells at least as wide as the reach of a pair.
#[derive(Clone, Copy, Debug, Default)]
struct Cells {
    lower: [f64; 3],
    inverse: f64,
    counts: [usize; 3],
}

impl Cells {
    /// Cells between limits, at most about `most` of them.
    fn new(limits: &Extent, reach: f64, dimension: usize, most: usize) -> Self {
        let length = |axis: usize| (limits.upper[axis] - limits.lower[axis]).max(0.0);
        let mut width = reach;
        loop {
            let count =
                |axis: usize| if axis < dimension { length(axis) / width + 1.0 } else { 1.0 };
            if count(0) * count(1) * count(2) <= most as f64 || !width.is_finite() {
                let counts = std::array::from_fn(|axis| (count(axis) as usize).max(1));
                return Self { lower: limits.lower, inverse: 1.0 / width, counts };
            }
            width *= 2.0;
        }
    }

    fn of(&self, place: [f64; 3]) -> [usize; 3] {
        std::array::from_fn(|axis| {
            let cell = ((place[axis] - self.lower[axis]) * self.inverse) as usize;
            cell.min(self.counts[axis] - 1)
        })
    }

    fn number(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * self.counts[1] + j) * self.counts[2] + k
    }

    fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// Calls `visit` with the runs of cells around one.
    #[inline(always)]
    fn around(&self, cell: [usize; 3], mut visit: impl FnMut(Range<usize>)) {
        let low = cell.map(|c| c.saturating_sub(1));
        let high: [usize; 3] =
            std::array::from_fn(|axis| (cell[axis] + 1).min(self.counts[axis] - 1));
        for i in low[0]..=high[0] {
            if self.counts[2] == 1 {
                visit(self.number([i, low[1], 0])..self.number([i, high[1], 0]) + 1);
                continue;
            }
            for j in low[1]..=high[1] {
                visit(self.number([i, j, low[2]])..self.number([i, j, high[2]]) + 1);
            }
        }
    }
}

impl Side {
    /// Lists the particles of a solid inside some limits, those of other processes too.
    fn list(&mut self, world: &World, solid: usize, near: &Extent) {
        let of = world.particles.solid.iter().zip(&world.particles.position).enumerate();
        let inside = of.filter(|(_, (of, place))| **of as usize == solid && near.holds(**place));
        self.found.clear();
        self.found.extend(inside.map(|(p, _)| Found {
            id: world.particles.id[p],
            place: p as u32,
            body: body(world, p),
        }));
        self.found.sort_unstable_by_key(|found| found.id);
        if !world.ranks.is_alone() {
            self.add_others(&world.ranks);
        }
    }

    /// Adds what the other processes have found.
    fn add_others(&mut self, ranks: &Ranks) {
        let numbers = |found: &Found| {
            let Body { place: [x, y, z], radius, velocity: [u, v, w], mass } = found.body;
            [f64::from(found.id), x, y, z, radius, u, v, w, mass]
        };
        let all = ranks.share(&self.found.iter().flat_map(numbers).collect::<Vec<f64>>());
        let own = self.found.len();
        for [id, x, y, z, radius, u, v, w, mass] in all.as_chunks::<9>().0.iter().copied() {
            let id = id as u32;
            if self.found[..own].binary_search_by_key(&id, |found| found.id).is_err() {
                let body = Body { place: [x, y, z], radius, velocity: [u, v, w], mass };
                self.found.push(Found { id, place: FOREIGN, body });
            }
        }
        self.found.sort_unstable_by_key(|found| found.id);
    }

    /// Puts the listed particles into cells.
    fn sort(&mut self, cells: &Cells) {
        let Side { found, members, bodies, first, sums } = self;
        let cell_of = |found: &Found| cells.number(cells.of(found.body.place));
        first.clear();
        first.resize(cells.len() + 1, 0);
        for found in found.iter() {
            first[cell_of(found) + 1] += 1;
        }
        for cell in 0..cells.len() {
            first[cell + 1] += first[cell];
        }
        members.resize(found.len(), 0);
        bodies.resize(found.len(), Body::default());
        sums.resize(found.len(), Response::default());
        // Each place in `first` moves on to the one behind its cell, where the next cell begins.
        for found in found.iter() {
            let place = &mut first[cell_of(found)];
            members[*place as usize] = found.place;
            bodies[*place as usize] = found.body;
            *place += 1;
        }
        first.rotate_right(1);
        first[0] = 0;
    }

    /// Sums the responses of every particle of this side and process; it is the first of its pairs,
    /// or the second.
    fn respond<const FIRST: bool>(&mut self, other: &Side, cells: &Cells, law: &impl PairLaw) {
        let one = |((sum, own), place): ((&mut Response, &Body), &u32)| {
            *sum = Response::default();
            if *place == FOREIGN {
                return;
            }
            cells.around(cells.of(own.place), |run| {
                let run = other.first[run.start] as usize..other.first[run.end] as usize;
                for partner in &other.bodies[run] {
                    let pair = if FIRST { pair(own, partner) } else { pair(partner, own) };
                    let Some(pair) = pair else { continue };
                    let response = law.respond(&pair);
                    for (sum, force) in sum.force.iter_mut().zip(response.force) {
                        *sum += if FIRST { force } else { -force };
                    }
                    sum.friction += response.friction;
                    sum.rate = sum.rate.max(response.rate);
                }
            });
        };
        if self.bodies.len() >= 2 * LEAST_PER_THREAD && rayon::current_num_threads() > 1 {
            let sums = self.sums.par_iter_mut().with_min_len(LEAST_PER_THREAD);
            sums.zip(&self.bodies).zip(&self.members).for_each(one);
        } else {
            self.sums.iter_mut().zip(&self.bodies).zip(&self.members).for_each(one);
        }
    }
}

fn body(world: &World, p: usize) -> Body {
    let particles = &world.particles;
    let ([x, y, z, mass], [vx, vy, vz, _]) = (particles.position[p], particles.velocity[p]);
    let rigid = world.solids[particles.solid[p] as usize].rigid;
    Body {
        place: [x, y, z],
        radius: radius(size(world, p), world.domain.dimension),
        velocity: [vx, vy, vz],
        mass: if rigid { f64::INFINITY } else { mass },
    }
}

/// The pair of two particles, if they overlap. Centres at one place have no normal: no pair.
#[inline(always)]
fn pair(first: &Body, second: &Body) -> Option<Pair> {
    let away: [f64; 3] = std::array::from_fn(|axis| first.place[axis] - second.place[axis]);
    let square = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
    let reach = first.radius + second.radius;
    if !(square < reach * reach && square > 0.0) {
        return None;
    }
    let distance = square.sqrt();
    let [one, two] = [first.mass, second.mass];
    let reduced_mass = match (one.is_finite(), two.is_finite()) {
        (true, true) => one * two / (one + two),
        _ => one.min(two),
    };
    Some(Pair {
        normal: away.map(|a| a / distance),
        penetration: reach - distance,
        radii: [first.radius, second.radius],
        reduced_mass,
        smallest_mass: one.min(two),
        velocity: std::array::from_fn(|axis| first.velocity[axis] - second.velocity[axis]),
    })
}

/// Limits of two solids and the sizes of their largest particles, over all processes.
fn extents(world: &World, solids: [usize; 2]) -> [Extent; 2] {
    let here = solids.map(|solid| extent(world, solid));
    let numbers =
        |Extent { lower: [a, b, c], upper: [x, y, z], size }: Extent| [-a, -b, -c, x, y, z, size];
    let [one, two] = here.map(numbers);
    let most = world.ranks.largest(std::array::from_fn::<f64, 14, _>(|k| match k {
        0..7 => one[k],
        _ => two[k - 7],
    }));
    let (each, _) = most.as_chunks::<7>();
    [0, 1].map(|side| {
        let [a, b, c, x, y, z, size] = each[side];
        Extent { lower: [-a, -b, -c], upper: [x, y, z], size }
    })
}

/// Limits of a solid and the size of its largest particle, of those of this process.
fn extent(world: &World, solid: usize) -> Extent {
    let particles = &world.particles;
    let add = |extent: Extent, p: usize| match particles.solid[p] as usize == solid {
        true => extent.with(particles.position[p], size(world, p)),
        false => extent,
    };
    if particles.len() >= SMALLEST_PARALLEL && rayon::current_num_threads() > 1 {
        let all = (0..particles.len()).into_par_iter().with_min_len(SMALLEST_PARALLEL / 2);
        all.fold(|| NOWHERE, add).reduce(|| NOWHERE, Extent::joined)
    } else {
        (0..particles.len()).fold(NOWHERE, add)
    }
}

/// The search for pairs of two solids; its memory is kept from step to step.
#[derive(Default)]
pub struct Pairs {
    sides: [Side; 2],
}

/// Sums over all pairs whose first particle is in this process.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Totals {
    /// Force on the first solid \[M L/T^2\].
    pub force: VectorSum,
    /// Largest rate of all pairs \[1/T^2\].
    pub rate: f64,
    /// Number of particles of the first solid that a partner pushes, over all processes.
    pub pushed: usize,
}

impl Pairs {
    /// Finds all overlapping pairs of two solids and sums the responses of each particle.
    pub fn sum(&mut self, world: &World, solids: [usize; 2], law: &impl PairLaw) -> Totals {
        let dimension = world.domain.dimension;
        let [first, second] = &mut self.sides;
        let extents = extents(world, solids);
        let reach = radius(extents[0].size, dimension) + radius(extents[1].size, dimension);
        let limits = extents.map(|extent| extent.grown(reach));
        first.list(world, solids[0], &limits[1]);
        second.list(world, solids[1], &limits[0]);
        // Cells need a width; without extent nothing touches.
        if reach <= 0.0 || first.found.is_empty() || second.found.is_empty() {
            first.sums.clear();
            second.sums.clear();
            return Totals::default();
        }
        let most = 64 + 2 * (first.found.len() + second.found.len());
        let cells = &Cells::new(&limits[0].common(limits[1]), reach, dimension, most);
        first.sort(cells);
        second.sort(cells);
        first.respond::<true>(second, cells, law);
        second.respond::<false>(first, cells, law);
        let mut totals = Totals::default();
        for sum in &first.sums {
            totals.force.add(sum.force);
            totals.pushed += usize::from(sum.force != [0.0; 3]);
            totals.rate = totals.rate.max(sum.rate);
        }
        [totals.pushed] = world.ranks.count([totals.pushed]);
        totals
    }

    /// Place in the table and sum of every particle of a side (0 or 1) and this process that may
    /// have partners.
    pub fn of_side(&self, side: usize) -> impl Iterator<Item = (usize, &Response)> {
        let Side { members, sums, .. } = &self.sides[side];
        let all = members.iter().zip(sums).filter(|(place, _)| **place != FOREIGN);
        all.map(|(place, sum)| (*place as usize, sum))
    }
}
