//! Surfaces of bodies in contact: nodes that two of them share, normals and gaps there
//! (language.md 7.5).
//!
//! Reads places of particles, writes `outward`, `extents` and the couples of the grid. Couples are
//! found when particles are sorted, normals and gaps once in a step.

use super::by_kind;
use super::ghosts::NodeArray;
use super::pairs::{radius, size};
use super::points::of_one_solid;
use super::shared::Shared;
use super::support::{Footprint, Support};
use super::tiles::Tiles;
use crate::math::v4::Plain;
use crate::model::contact::{CANDIDATES, Couple, Pair, Rule};
use crate::model::grid::Grid;
use crate::world::World;

/// No particle has been seen.
const NOWHERE: [[f64; CANDIDATES]; 2] = [[f64::NEG_INFINITY; CANDIDATES]; 2];

/// Lists the nodes that two bodies of a pair can reach before the next sort, of the nodes that are
/// `reached` if that says more than what is in memory. What the `old` couples know is kept.
pub fn find_couples(grid: &mut Grid, old: &[Couple], pairs: &[Pair], reached: &[bool]) {
    let Grid { lattices, couples, coupled, runs, extents, .. } = grid;
    couples.clear();
    let is_reached = |node: usize| reached.get(node).is_none_or(|reached| *reached);
    for (number, pair) in pairs.iter().enumerate() {
        let [first, second] = pair.lattices.map(|lattice| &lattices[lattice]);
        let own = first.window.places();
        let begin = runs.partition_point(|run| run.end <= own.start);
        let active = runs[begin..].iter().cloned().flatten().take_while(|node| *node < own.end);
        for node in active {
            let index = first.window.node(node);
            let Some(other) = second.window.local(index) else { continue };
            let run = runs.partition_point(|run| run.end <= other);
            let active = runs.get(run).is_some_and(|run| run.start <= other);
            if active && is_reached(node) && is_reached(other) {
                couples.push(Couple {
                    pair: number as u32,
                    nodes: [node as u32, other as u32],
                    number: first.number(index),
                    ..Couple::default()
                });
            }
        }
    }
    let mut known = old.iter().peekable();
    for couple in couples.iter_mut() {
        let key = (couple.pair, couple.number);
        while known.next_if(|old| (old.pair, old.number) < key).is_some() {}
        if let Some(old) = known.next_if(|old| (old.pair, old.number) == key) {
            let Couple { normal, gap, drag, slip, internal, .. } = *old;
            *couple = Couple { normal, gap, drag, slip, internal, ..*couple };
        }
    }
    let touching = pairs.iter().any(|pair| pair.touching);
    extents.clear();
    extents.resize(if touching { couples.len() } else { 0 }, NOWHERE);
    for (number, couple) in couples.iter_mut().enumerate() {
        for side in 0..2 {
            let first = &mut coupled[couple.nodes[side] as usize];
            couple.next[side] = std::mem::replace(first, number as u32 + 1);
        }
    }
}

/// Finds normals and gaps from the places of the particles.
pub fn find(tiles: &mut Tiles, world: &mut World) {
    let Grid { outward, runs, .. } = &mut world.grid;
    for run in runs.iter() {
        outward[run.clone()].fill([0.0; 4]);
    }
    by_kind!(world.domain.dimension, world.method.shape, outward_of, tiles, world);
    find_normals(world);
    if world.contacts.pairs.iter().any(|pair| pair.touching) {
        world.grid.extents.fill(NOWHERE);
        by_kind!(world.domain.dimension, world.method.shape, extents_of, tiles, world);
        choose_normals(world);
    }
    world.contacts.ready = true;
}

/// outward <- (sum w dN/dr, sum w N) at the nodes of couples; w = m, of rigid bodies V, where x is a
/// radius per x: a surface across the axis then has its normal along the axis.
fn outward_of<const D: usize, F: Footprint<D>>(tiles: &mut Tiles, world: &mut World) {
    let World { particles, grid, solids, method, .. } = world;
    let (coupled, outward) = (&grid.coupled, Shared::new(&mut grid.outward));
    let records = F::part(&particles.domain, 0..particles.len());
    tiles.sweep_into(&[&outward], |tile, _| {
        let (frame, places, mut memory) = (tile.frame, &particles.position, F::Memory::default());
        for range in of_one_solid(tile.range, &particles.solid) {
            let rigid = solids[particles.solid[range.start] as usize].rigid;
            for p in range {
                let support = F::at::<Plain, true, false>(&mut memory, frame, places, &records, p);
                let mut met = false;
                support.each(|node, _| met |= coupled[node] != 0);
                if !met {
                    continue;
                }
                let [x, y, z, mass] = places[p];
                let weight = if rigid { particles.velocity[p][3] } else { mass };
                let weight = weight / method.girth([x, y, z]);
                support.each_slope(|node, value, [a, b, c], _| {
                    // SAFETY: tiles of one colour share no node (see `tiles`).
                    let node = unsafe { &mut outward.part(node..node + 1)[0] };
                    for (sum, part) in node.iter_mut().zip([a, b, c, value]) {
                        *sum += weight * part;
                    }
                });
            }
        }
    });
}

/// A sum of slopes below this part of the weights around a node shows no surface: round-off.
const NO_SURFACE: f64 = 1e-9;

/// A unit vector along a sum of slopes; zero where there is no surface.
fn unit(slopes: [f64; 4], around: f64) -> [f64; 3] {
    let [x, y, z, _] = slopes;
    let size = (x * x + y * y + z * z).sqrt();
    if size > NO_SURFACE * around { [x, y, z].map(|slope| slope / size) } else { [0.0; 3] }
}

/// What may be the normal out of the first body: along g1 - g2, g1 and -g2. A rigid body is infinitely
/// heavy: beside it g1 - g2 is its own.
fn candidates([first, second]: [[f64; 4]; 2], rigid: [bool; 2]) -> [[f64; 3]; CANDIDATES] {
    let difference = std::array::from_fn(|axis| first[axis] - second[axis]);
    let around = first[3].abs() + second[3].abs();
    let (out, back) = (unit(first, first[3].abs()), unit(second, second[3].abs()).map(|n| -n));
    match rigid {
        [true, false] => [out, back, out],
        [false, true] => [back, out, back],
        _ => [unit(difference, around), out, back],
    }
}

/// The candidates of every couple; n out of the first body is the first that shows a surface, gap 0.
fn find_normals(world: &mut World) {
    let World { grid, contacts, .. } = world;
    let Grid { couples, outward, rigid, .. } = grid;
    for couple in couples.iter_mut() {
        (couple.normal, couple.gap) = ([0.0; 3], 0.0);
        let nodes = couple.nodes.map(|node| node as usize);
        let there = nodes.iter().all(|node| outward[*node][3] != 0.0);
        if there && contacts.pairs[couple.pair as usize].rule != Rule::Welded {
            let rigid = nodes.map(|node| rigid.get(node).is_some_and(|rigid| rigid[3] > 0.0));
            couple.candidates = candidates(nodes.map(|node| outward[node]), rigid);
            let shown = couple.candidates.into_iter().find(|normal| *normal != [0.0; 3]);
            couple.normal = shown.unwrap_or_default();
        }
    }
}

/// extents[couple][side] <- for each candidate the farthest that the particles around the node reach
/// beyond it along the normal (side 0) or against it (side 1).
fn extents_of<const D: usize, F: Footprint<D>>(tiles: &mut Tiles, world: &mut World) {
    let mut extents = std::mem::take(&mut world.grid.extents);
    let shared = Shared::new(extents.as_flattened_mut());
    let World { particles, grid, contacts, .. } = &*world;
    let Grid { coupled, couples, .. } = grid;
    let cell = world.domain.cell;
    let records = F::part(&particles.domain, 0..particles.len());
    let array = Extents { extents: shared, coupled, couples, most: grid.lattices.len() - 1 };
    tiles.sweep_into(&[&array], |tile, _| {
        let (frame, places, mut memory) = (tile.frame, &particles.position, F::Memory::default());
        for p in tile.range {
            let support = F::at::<Plain, true, false>(&mut memory, frame, places, &records, p);
            support.each_slope(|node, _, _, away| {
                let mut next = coupled[node];
                while next != 0 {
                    let number = next as usize - 1;
                    let couple = &couples[number];
                    let side = usize::from(couple.nodes[0] as usize != node);
                    next = couple.next[side];
                    let touching = contacts.pairs[couple.pair as usize].touching;
                    if !touching || couple.normal == [0.0; 3] {
                        continue;
                    }
                    let place = 2 * number + side;
                    // SAFETY: a side belongs to one node, and tiles of one colour share none.
                    let extents = unsafe { shared.part(place..place + 1) };
                    let away = away.map(|r| r * tile.frame.spacing);
                    let radius = radius(size(world, p), D);
                    let sign = if side == 0 { 1.0 } else { -1.0 };
                    for (extent, normal) in extents[0].iter_mut().zip(couple.candidates) {
                        let out = normal.map(|n| sign * n);
                        *extent = extent.max(reach(away, out, radius, cell));
                    }
                }
            });
        }
    });
    world.grid.extents = extents;
}

/// The extents of the couples of a node, as an array over nodes: of each couple one side is its own.
struct Extents<'a> {
    extents: Shared<'a, [f64; CANDIDATES]>,
    coupled: &'a [u32],
    couples: &'a [Couple],
    /// Most couples of a node.
    most: usize,
}

impl Extents<'_> {
    /// Places of the extents of a node, in an order that all processes share.
    fn each(&self, node: usize) -> impl Iterator<Item = usize> {
        let mut next = self.coupled[node];
        std::iter::from_fn(move || {
            let number = (next as usize).checked_sub(1)?;
            let couple = &self.couples[number];
            let side = usize::from(couple.nodes[0] as usize != node);
            next = couple.next[side];
            Some(2 * number + side)
        })
    }
}

impl NodeArray for Extents<'_> {
    /// Room for the couples of the node with most; the last ones may be unused.
    fn width(&self) -> usize {
        CANDIDATES * self.most
    }

    unsafe fn put(&self, node: usize, out: &mut Vec<f64>) {
        let end = out.len() + self.width();
        for place in self.each(node) {
            // SAFETY: a side belongs to one node, and the caller promises that nobody writes to it.
            out.extend_from_slice(unsafe { &self.extents.part(place..place + 1)[0] });
        }
        out.resize(end, 0.0);
    }

    unsafe fn take(&self, node: usize, numbers: &[f64]) {
        for (place, numbers) in self.each(node).zip(numbers.as_chunks::<CANDIDATES>().0) {
            // SAFETY: a side belongs to one node, and the caller promises that nobody uses it.
            unsafe { self.extents.part(place..place + 1)[0] = *numbers };
        }
    }
}

/// n <- the candidate along which the bodies lie farthest apart, gap <- their distance along it. At
/// the corner of a body g1 - g2 points anywhere between two faces; the face that lies between the
/// bodies is the one that parts them. Any preference for g1 - g2 tilts the normals at the edges of a
/// flat contact, where the pressure is highest, and drags the body back without friction.
fn choose_normals(world: &mut World) {
    let World { grid, contacts, .. } = world;
    for (couple, [first, second]) in grid.couples.iter_mut().zip(&grid.extents) {
        if !contacts.pairs[couple.pair as usize].touching || couple.normal == [0.0; 3] {
            continue;
        }
        let mut widest = f64::NEG_INFINITY;
        for (number, normal) in couple.candidates.into_iter().enumerate() {
            let gap = -(first[number] + second[number]);
            if normal != [0.0; 3] && gap > widest {
                (couple.normal, couple.gap) = (normal, gap);
                widest = gap;
            }
        }
    }
}

/// How far a particle reaches along `out` as seen from a node \[L\]: r.out + R - d^2/(2 h), d the
/// distance beside the node beyond the radius R. The parabola follows curved faces to the place of
/// the node; faces that particles of radius R cover are flat for it.
fn reach(away: [f64; 3], out: [f64; 3], radius: f64, cell: f64) -> f64 {
    let along: f64 = (0..3).map(|axis| away[axis] * out[axis]).sum();
    let square: f64 = (0..3).map(|axis| (away[axis] - along * out[axis]).powi(2)).sum();
    let beside = (square.sqrt() - radius).max(0.0);
    along + radius - 0.5 * beside * beside / cell
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rigid_body_shows_its_own_surface_and_a_body_inside_none() {
        let (up, down, inside) =
            ([0.0, 2.0, 0.0, 4.0], [0.0, -3.0, 0.0, 4.0], [1e-16, 0.0, 0.0, 4.0]);
        let aslant = [3.0, -3.0, 0.0, 4.0];
        assert_eq!(candidates([up, down], [false; 2]), [[0.0, 1.0, 0.0]; 3]);
        let tilted = std::f64::consts::FRAC_1_SQRT_2;
        let [own, first, second] = candidates([aslant, up], [false, true]);
        assert_eq!((own, second), ([0.0, -1.0, 0.0], [0.0, -1.0, 0.0]));
        assert!((first[0] - tilted).abs() < 1e-15 && (first[1] + tilted).abs() < 1e-15);
        assert_eq!(candidates([up, inside], [false, true]), [[0.0; 3], [0.0, 1.0, 0.0], [0.0; 3]]);
    }

    #[test]
    fn flat_faces_are_flat_and_curved_ones_are_followed() {
        // Particles 1/2 apart on a face at the height 0 (or on a circle of radius 10 above it), seen
        // from nodes 1 apart.
        for (x, curvature) in [(0.0, 0.0), (0.25, 0.0), (0.5, 0.0), (1.5, 0.1f64)] {
            let farthest = (-6..7).map(|k| {
                let along = 0.5 * f64::from(k) + 0.25;
                let height = 0.5 * curvature * along * along + 0.25;
                reach([along - x, height, 0.0], [0.0, -1.0, 0.0], 0.25, 1.0)
            });
            let gap = -farthest.fold(f64::NEG_INFINITY, f64::max);
            let exact = 0.5 * curvature * x * x;
            // A particle is flat over its width: the slope 0.15 over a radius of 1/4.
            assert!((gap - exact).abs() <= 0.15 * 0.25 + 1e-15, "{x}: {gap} {exact}");
        }
    }
}
