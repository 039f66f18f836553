//! Names what went wrong: particle, solid, place, step, time and the likely cause.

use crate::fault::Fault;
use crate::model::checkpoint::Checkpoint;
use crate::model::clock::Clock;
use crate::model::column::Column;
use crate::plan::Trouble;
use crate::world::World;

/// Most neighbours that are named.
const NAMED: usize = 8;

/// "particle 12 of solid `ball` (material `rubber`) at (x, y) with velocity (vx, vy), J = 1, beside the
/// particles 11, 13".
fn describe(world: &World, particle: usize) -> String {
    let dimension = world.domain.dimension;
    let list = |values: &[f64; 4]| {
        let words: Vec<String> = values[..dimension].iter().map(|v| format!("{v:.6e}")).collect();
        words.join(", ")
    };
    let particles = &world.particles;
    let solid = &world.solids[particles.solid[particle] as usize];
    let volume = particles.column(Column::J).get(particle);
    format!(
        "particle {} of solid `{}` (material `{}`) at ({}) with velocity ({}){}{}",
        particles.id[particle],
        solid.name,
        solid.material,
        list(&particles.position[particle]),
        list(&particles.velocity[particle]),
        volume.map_or_else(String::new, |j| format!(", J = {j:.4e}")),
        neighbours(world, particle),
    )
}

/// Ids of the particles of this process in the same cell: the first few, and how many more.
fn neighbours(world: &World, particle: usize) -> String {
    let particles = &world.particles;
    let dimension = world.domain.dimension;
    let solid = particles.solid[particle];
    let cells = match world.method.total {
        true => &world.solids[usize::from(solid)].cells,
        false => &world.domain,
    };
    let places = particles.places(world.method.total);
    let cell = |p: usize| -> [i64; 3] {
        std::array::from_fn(|axis| match axis < dimension {
            true => ((places[p][axis] - cells.lower[axis]) / cells.cell).floor() as i64,
            false => 0,
        })
    };
    let here = cell(particle);
    let beside = |p: &usize| {
        let same_grid = !world.method.total || particles.solid[*p] == solid;
        *p != particle && same_grid && cell(*p) == here
    };
    let mut ids: Vec<u32> = (0..particles.len()).filter(beside).map(|p| particles.id[p]).collect();
    ids.sort_unstable();
    let more = ids.len().saturating_sub(NAMED);
    let words: Vec<String> = ids.iter().take(NAMED).map(u32::to_string).collect();
    match (words.len(), more) {
        (0, _) => ", alone in its cell".to_string(),
        (_, 0) => format!(", in a cell with {}", words.join(", ")),
        _ => format!(", in a cell with {} and {more} more", words.join(", ")),
    }
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
    Fault::step(format!("the velocity is not finite: {who}; {}", when(clock))).because(match wall {
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
    Fault::step(format!("the temperature is not finite: {who}; {}", when(clock))).because(
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
    Fault::step(what).because(match alone_at_a_wall(world, particle, fragile) {
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

/// What is wrong with a particle that `watch` has found, and what may help.
fn symptom(world: &World, particle: usize, trouble: &Trouble) -> (String, &'static str) {
    let particles = &world.particles;
    let volume = particles.column(Column::J).get(particle).copied().unwrap_or(1.0);
    let [x, y, z, _] = particles.velocity[particle];
    let speed = x.hypot(y).hypot(z);
    let solid = &world.solids[usize::from(particles.solid[particle])];
    let wave = solid.law.reference_wave_speed();
    if !(volume * trouble.volume >= 1.0 && volume <= trouble.volume) {
        let how = if volume < 1.0 { "crushed" } else { "blown up" };
        return (
            format!("the material is {how} (J = {volume:.3e})"),
            "the step is too large for the event, or the law cannot bear it; `watch(on, volume, X)` allows more",
        );
    }
    if speed > trouble.speed * wave {
        return (
            format!(
                "the particle flies {:.3e} times as fast as waves of its material",
                speed / wave
            ),
            "the time step is too large, or a force has run away; `watch(on, speed, X)` allows more",
        );
    }
    let stresses = [Column::S11, Column::S22, Column::S33, Column::S12, Column::S13, Column::S23];
    let finite =
        |column| particles.column(column).get(particle).is_none_or(|s: &f64| s.is_finite());
    if !stresses.into_iter().all(finite) {
        return (
            "the stress is not finite".to_string(),
            "the law has left the range where it has a meaning",
        );
    }
    (
        format!("one step strains the particle by more than {}", trouble.strain),
        "the step is too large for the event; `watch(on, strain, X)` allows more",
    )
}

/// A particle is in trouble, though every number is finite.
pub fn troubled(world: &World, particle: usize, trouble: &Trouble, clock: &Clock) -> Fault {
    let (what, cause) = symptom(world, particle, trouble);
    let what = format!("{what}: {}; {}", describe(world, particle), when(clock));
    Fault::step(what).because(cause)
}

/// The kinetic energy runs away: the fastest particle is named.
pub fn runs_away(world: &World, kinetic: f64, clock: &Clock) -> Fault {
    let speed = |p: &usize| {
        let [x, y, z, _] = world.particles.velocity[*p];
        x * x + y * y + z * z
    };
    let fastest = (0..world.particles.len()).max_by(|a, b| speed(a).total_cmp(&speed(b)));
    let who = fastest.map_or_else(|| "a particle".to_string(), |p| describe(world, p));
    let what = format!(
        "the kinetic energy, {kinetic:.4e}, has grown by half in each of {RUN} steps; fastest: {who}; {}",
        when(clock)
    );
    Fault::step(what).because("the time step is too large, or a formula or a force has run away")
}

/// The energy ledger does not close.
pub fn unbalanced(error: f64, residual: f64, limit: f64, clock: &Clock) -> Fault {
    let what = format!(
        "the energy ledger is off by {residual:.4e}, {error:.3e} of its largest term and more than {limit:e}; {}",
        when(clock)
    );
    Fault::step(what).because("the time step is too large, or the motion too rough for the grid")
}

/// Steps in which the energy must grow by half, one after the other, to be called running away.
const RUN: u32 = 8;

/// Growth of the kinetic energy from step to step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Growth {
    last: f64,
    largest: f64,
    count: u32,
}

impl Growth {
    /// Puts it into a checkpoint, or takes it from there.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.number("energy", &mut self.last);
        checkpoint.number("largest", &mut self.largest);
        checkpoint.number("grown", &mut self.count);
    }

    /// Takes the kinetic energy after a step; true if it has grown by half in each of `RUN` steps and is
    /// larger than ever before.
    pub fn runs_away(&mut self, kinetic: f64) -> bool {
        let grows = self.last > 0.0 && kinetic > 1.5 * self.last;
        self.count = if grows { self.count + 1 } else { 0 };
        self.last = kinetic;
        let larger = kinetic > self.largest;
        if !grows {
            self.largest = self.largest.max(kinetic);
        }
        larger && self.count >= RUN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_that_doubles_runs_away_and_that_of_a_fall_does_not() {
        let mut growth = Growth::default();
        assert!((0..1000).all(|n| !growth.runs_away((n as f64).powi(2))));
        let mut growth = Growth::default();
        let found = (0..40).position(|n| growth.runs_away(1e-3 * 2f64.powi(n)));
        assert_eq!(found, Some(RUN as usize));
        // What grows back to where it has been is no news.
        let mut growth = Growth::default();
        growth.runs_away(1e9);
        assert!((0..30).all(|n| !growth.runs_away(2f64.powi(n))));
    }
}
