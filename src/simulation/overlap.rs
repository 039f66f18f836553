//! Solids that were filled into the same place.

use crate::world::World;

/// A cell with so many times its volume of matter, of several solids none of which fills it alone,
/// was filled twice; particles cut by the border of a body stay below.
const CROWDED: f64 = 1.5;

/// Pairs of solids of which both have matter in a cell that is too small for them, and the number of
/// such cells. Cells are those of the finest solid.
pub fn overlapping(world: &World) -> Vec<([usize; 2], usize)> {
    let (particles, dimension) = (&world.particles, world.domain.dimension);
    let cell = world.solids.iter().map(|solid| solid.cells.cell).fold(f64::INFINITY, f64::min);
    if world.solids.len() < 2 || !cell.is_finite() {
        return Vec::new();
    }
    let part = |p: usize| {
        let place = world.place(p);
        let number = |axis: usize| match axis < dimension {
            true => ((place[axis] - world.domain.lower[axis]) / cell).floor() as i64,
            false => 0,
        };
        let size = particles.velocity[p][3] / world.method.girth(place);
        ([0, 1, 2].map(number), particles.solid[p], size / cell.powi(dimension as i32))
    };
    let mut parts: Vec<([i64; 3], u16, f64)> = particles.counted().map(part).collect();
    parts.sort_unstable_by_key(|(cell, solid, _)| (*cell, *solid));
    let mut pairs: Vec<([usize; 2], usize)> = Vec::new();
    for cell in parts.chunk_by(|a, b| a.0 == b.0) {
        let solids: Vec<(usize, f64)> = cell
            .chunk_by(|a, b| a.1 == b.1)
            .map(|solid| (usize::from(solid[0].1), solid.iter().map(|part| part.2).sum()))
            .collect();
        for (number, (a, first)) in solids.iter().enumerate() {
            for (b, second) in &solids[number + 1..] {
                if first + second <= CROWDED || first.max(*second) > CROWDED {
                    continue;
                }
                match pairs.iter_mut().find(|(pair, _)| *pair == [*a, *b]) {
                    Some((_, count)) => *count += 1,
                    None => pairs.push(([*a, *b], 1)),
                }
            }
        }
    }
    pairs
}
