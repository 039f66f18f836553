//! Names what went wrong: particle, solid, place, step, time and the likely cause.

use crate::fault::Fault;
use crate::model::clock::Clock;
use crate::model::column::Column;
use crate::world::World;

/// "particle 12 of solid `ball` at (x, y) with velocity (vx, vy)".
fn describe(world: &World, particle: usize) -> String {
    let dimension = world.domain.dimension;
    let list = |values: &[f64; 4]| {
        let words: Vec<String> = values[..dimension].iter().map(|v| format!("{v:.6e}")).collect();
        words.join(", ")
    };
    let particles = &world.particles;
    format!(
        "particle {} of solid `{}` at ({}) with velocity ({})",
        particles.id[particle],
        world.solids[particles.solid[particle] as usize].name,
        list(&particles.position[particle]),
        list(&particles.velocity[particle]),
    )
}

fn when(clock: &Clock) -> String {
    format!("step {}, time {:.6e}, dt {:.3e}", clock.step, clock.end(), clock.dt)
}

/// Does a particle stand where no time step is stable for one that is alone? `fragile`: `usl`, or an
/// affine transfer.
///
/// In the last cell before a wall of the box splines end like hats: a node has the weight xi of a
/// particle at a distance xi h, and the gradient 1/h, so that h^2 sum |grad N|^2/N grows as 1/xi.
fn alone_at_a_wall(world: &World, particle: usize, fragile: bool) -> bool {
    let domain = &world.domain;
    let place = world.particles.position[particle];
    let near = |axis: usize| {
        let [low, high] = [domain.lower[axis], domain.upper[axis]];
        place[axis] < low + domain.cell || place[axis] > high - domain.cell
    };
    fragile && !world.method.total && (0..domain.dimension).any(near)
}

const AT_A_WALL: &str = "with `usl` or an affine transfer no step is stable for a particle that is alone \
     in the last cell before a wall of the box; use `musl` with FLIP, a larger box or `boundary(delete)`";

/// Some velocity is not a finite number.
pub fn not_finite(world: &World, fragile: bool, clock: &Clock) -> Fault {
    let lost = world.particles.velocity.iter().position(|v| v[..3].iter().any(|x| !x.is_finite()));
    let who = lost.map_or_else(|| "a particle".to_string(), |p| describe(world, p));
    let wall = lost.is_some_and(|p| alone_at_a_wall(world, p, fragile));
    Fault::run(format!("the velocity is not finite: {who}; {}", when(clock))).because(match wall {
        true => AT_A_WALL,
        false => {
            "the time step is too large, or a formula or a stiffness has run away; try a smaller \
             `set_dt` or `dt_factor`"
        }
    })
}

/// Some temperature is not a finite number.
pub fn too_hot(world: &World, clock: &Clock) -> Fault {
    let lost = world.particles.column(Column::Temperature).iter().position(|t| !t.is_finite());
    let who = lost.map_or_else(|| "a particle".to_string(), |p| describe(world, p));
    Fault::run(format!("the temperature is not finite: {who}; {}", when(clock))).because(
        "the time step is too large for the conductivity; try a smaller `set_dt` or `dt_factor`",
    )
}

/// A law reports det F <= 0, a stress that is not finite, or a negative energy.
pub fn inverted(world: &World, particle: usize, fragile: bool, clock: &Clock) -> Fault {
    let energies = world.particles.column(Column::InternalEnergy);
    let how = match energies.get(particle).is_some_and(|energy| *energy < 0.0) {
        true => "the gas has lost more energy in a step than it had",
        false => "the material is turned inside out (det F <= 0)",
    };
    let what = format!("{how}: {}; {}", describe(world, particle), when(clock));
    Fault::run(what).because(match alone_at_a_wall(world, particle, fragile) {
        true => AT_A_WALL,
        false => {
            "the body is crushed within one step; try a smaller `set_dt` or `dt_factor`, or a finer \
             grid"
        }
    })
}

/// A particle is outside the box.
pub fn escaped(world: &World, particle: usize, clock: &Clock) -> Fault {
    let what = format!("a particle left the box: {}; {}", describe(world, particle), when(clock));
    Fault::run(what).because("make the box of `dimension` larger, hold the body with fixes, or choose `boundary(delete)` or `boundary(bounce)`")
}

/// The last particle has left the box.
pub fn all_gone(clock: &Clock) -> Fault {
    Fault::run(format!("every particle has left the box and was removed; {}", when(clock)))
        .because("make the box of `dimension` larger, or end the run earlier")
}

/// The energy ledger does not close.
pub fn unbalanced(error: f64, residual: f64, limit: f64, clock: &Clock) -> Fault {
    let what = format!(
        "the energy ledger is off by {residual:.4e}, {error:.3e} of its largest term and more than {limit:e}; {}",
        when(clock)
    );
    Fault::run(what).because("the time step is too large, or the motion too rough for the grid")
}
