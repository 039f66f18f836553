//! Multi-field contact: bodies with lattices of their own exchange momentum where they meet
//! (language.md 7.5).
//!
//! Reads masses and velocities of the nodes of two lattices at one place (a couple), writes their
//! velocities; normals and gaps are those that [`super::surfaces`] has found. Scenes without contact
//! have no couple and never come here.

use super::grid::inverse_mass;
use crate::model::contact::{Contacts, Couple, Rule};
use crate::model::grid::Grid;
use crate::world::World;

/// Which velocities meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Velocities {
    /// Those of the momenta after P2G.
    Momenta,
    /// The same, divided by m already; only strains follow from them (`usf`).
    First,
    /// v* after the update.
    Updated,
    /// Those of the second mapping.
    Mapped,
}

/// A body at a node.
#[derive(Clone, Copy)]
struct Body {
    velocity: [f64; 3],
    /// 1/m; 0 for rigid bodies.
    inverse: f64,
}

/// The body at a node, if there is one.
fn body(grid: &Grid, node: usize, which: Velocities) -> Option<Body> {
    if let Some([x, y, z, weight]) = grid.rigid.get(node)
        && *weight > 0.0
    {
        return Some(Body { velocity: [*x, *y, *z], inverse: 0.0 });
    }
    let inverse = inverse_mass(&grid.nodes[node], grid.mass_cutoff);
    let [x, y, z, _] = match which {
        Velocities::Mapped => grid.mapped[node],
        Velocities::Momenta => grid.nodes[node].motion.map(|momentum| inverse * momentum),
        Velocities::First | Velocities::Updated => grid.nodes[node].motion,
    };
    (inverse > 0.0).then_some(Body { velocity: [x, y, z], inverse })
}

/// v1 - v2.
fn between(a: Body, b: Body) -> [f64; 3] {
    std::array::from_fn(|axis| a.velocity[axis] - b.velocity[axis])
}

/// J = m12 (v12.n - c) n, m12 = m1 m2/(m1 + m2), v12 = v1 - v2, if the bodies approach faster than
/// c; `closing` is the c that closes the gap within the step. Frictional: and min(mu |J|, m12 |v_t|)
/// against the slip v_t. Stick: all of v12 but c n. Welded: m12 v12 always. J goes from the first body
/// to the second \[M L/T\].
fn exchange(rule: Rule, normal: [f64; 3], closing: f64, bodies: [Body; 2]) -> Option<[f64; 3]> {
    let [a, b] = bodies;
    let inverse = a.inverse + b.inverse;
    if inverse == 0.0 {
        return None;
    }
    let reduced = 1.0 / inverse;
    let relative = between(a, b);
    if rule == Rule::Welded {
        return Some(relative.map(|v| reduced * v));
    }
    let along: f64 = (0..3).map(|axis| relative[axis] * normal[axis]).sum();
    if along <= closing {
        return None;
    }
    let push = reduced * (along - closing);
    let slip: [f64; 3] = std::array::from_fn(|axis| relative[axis] - along * normal[axis]);
    let speed = slip.iter().map(|v| v * v).sum::<f64>().sqrt();
    let drag = match rule {
        Rule::Frictional(mu) => (mu * push).min(reduced * speed),
        Rule::Slip => 0.0,
        Rule::Stick | Rule::Welded => reduced * speed,
    };
    let per_speed = if speed > 0.0 { drag / speed } else { 0.0 };
    Some(std::array::from_fn(|axis| push * normal[axis] + per_speed * slip[axis]))
}

/// All couples exchange momentum, pair by pair. Impulses on the momenta (but of welded bodies) and on
/// v* reach the particles: they enter v* - v and, as their sum over dt, the force on the first body.
pub fn meet(world: &mut World, which: Velocities, dt: f64) {
    let World { grid, contacts, .. } = world;
    let Contacts { list, pairs, .. } = contacts;
    if which == Velocities::Momenta {
        list.iter_mut().for_each(|contact| contact.force.clear());
    }
    let mut couples = std::mem::take(&mut grid.couples);
    for couple in &mut couples {
        let pair = &pairs[couple.pair as usize];
        let [a, b] = couple.nodes.map(|node| node as usize);
        let bodies = body(grid, a, which).zip(body(grid, b, which));
        if which == Velocities::Momenta {
            let heat = begin(couple, bodies);
            if let Some(contact) = pair.contact.filter(|_| grid.counts(a)) {
                list[contact].heat.add(heat);
            }
            warm(grid, [a, b], heat / dt);
        }
        let Some((first, second)) = bodies else { continue };
        if pair.rule != Rule::Welded && couple.normal == [0.0; 3] {
            continue;
        }
        let closing = couple.gap.max(0.0) / dt;
        if let Some(impulse) = exchange(pair.rule, couple.normal, closing, [first, second]) {
            for (node, sign, inverse) in [(a, -1.0, first.inverse), (b, 1.0, second.inverse)] {
                push(grid, node, which, impulse.map(|j| sign * j), inverse);
            }
            // Welded bodies begin the step with one velocity, as on one grid.
            let counts = which == Velocities::Updated
                || which == Velocities::Momenta && pair.rule != Rule::Welded;
            if counts {
                for (sum, impulse) in couple.impulse.iter_mut().zip(impulse) {
                    *sum += impulse;
                }
            }
        }
        if which == Velocities::Updated {
            finish(grid, couple, pair.rule, [first, second], dt);
            if let Some(contact) = pair.contact.filter(|_| grid.counts(a)) {
                list[contact].force.add(couple.impulse.map(|j| -pair.counts * j / dt));
            }
        }
    }
    grid.couples = couples;
}

/// The heat of friction of the step before: its drag times the mean of the slips that the particles
/// had before and after it. Then a new step begins.
fn begin(couple: &mut Couple, bodies: Option<(Body, Body)>) -> f64 {
    let slip = bodies.map_or(couple.slip, |(a, b)| between(a, b));
    let mean = (0..3).map(|axis| 0.5 * couple.drag[axis] * (couple.slip[axis] + slip[axis]));
    let heat = mean.sum();
    (couple.slip, couple.drag, couple.impulse) = (slip, [0.0; 3], [0.0; 3]);
    heat
}

/// Half of the heating power of friction goes to each body that conducts.
fn warm(grid: &mut Grid, nodes: [usize; 2], power: f64) {
    if grid.heating.is_empty() || power == 0.0 {
        return;
    }
    let conducts = nodes.map(|node| grid.temperature[node][3] > 0.0);
    let share = if conducts == [true; 2] { 0.5 } else { 1.0 };
    for (node, conducts) in nodes.into_iter().zip(conducts) {
        if conducts {
            grid.heating[node] += share * power;
        }
    }
}

/// Gives a body momentum.
fn push(grid: &mut Grid, node: usize, which: Velocities, impulse: [f64; 3], inverse: f64) {
    if inverse == 0.0 {
        return;
    }
    for (axis, impulse) in impulse.into_iter().enumerate() {
        match which {
            Velocities::Momenta => grid.nodes[node].motion[axis] += impulse,
            Velocities::Mapped => grid.mapped[node][axis] += inverse * impulse,
            _ => grid.nodes[node].motion[axis] += inverse * impulse,
        }
    }
}

/// The whole impulse of the step enters v* - v, and the force on a rigid body waits for its
/// particles. What is left of the gap when the nodes have moved is what the second mapping sees.
fn finish(grid: &mut Grid, couple: &mut Couple, rule: Rule, bodies: [Body; 2], dt: f64) {
    if matches!(rule, Rule::Frictional(_)) {
        let Couple { impulse, normal, .. } = *couple;
        let along: f64 = (0..3).map(|axis| impulse[axis] * normal[axis]).sum();
        couple.drag = std::array::from_fn(|axis| impulse[axis] - along * normal[axis]);
    }
    for side in 0..2 {
        let node = couple.nodes[side] as usize;
        let sign = if side == 0 { -1.0 } else { 1.0 };
        for axis in 0..3 {
            let impulse = sign * couple.impulse[axis];
            match bodies[side].inverse {
                // Until the gathering the second mapping has no other use.
                0.0 => grid.mapped[node][axis] += impulse / (dt * grid.rigid[node][3]),
                inverse => grid.nodes[node].change[axis] += inverse * impulse,
            }
        }
    }
    let [a, b] = couple.nodes.map(|node| body(grid, node as usize, Velocities::Updated));
    if let Some((a, b)) = a.zip(b) {
        let apart = between(a, b);
        let closed: f64 = (0..3).map(|axis| apart[axis] * couple.normal[axis]).sum();
        couple.gap -= dt * closed;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: [f64; 3] = [0.0, 1.0, 0.0];

    fn bodies(first: [f64; 3], inverse: [f64; 2]) -> [Body; 2] {
        let [a, b] = inverse;
        [Body { velocity: first, inverse: a }, Body { velocity: [0.0; 3], inverse: b }]
    }

    #[test]
    fn bodies_that_part_exchange_nothing_unless_welded() {
        let parting = bodies([1.0, -0.5, 0.0], [1.0, 0.5]);
        for rule in [Rule::Stick, Rule::Slip, Rule::Frictional(0.3)] {
            assert_eq!(exchange(rule, UP, 0.0, parting), None);
        }
        let welded = exchange(Rule::Welded, [0.0; 3], 0.0, parting).unwrap();
        // m12 = 2/3.
        assert_eq!(welded.map(|j| 1.5 * j), [1.0, -0.5, 0.0]);
    }

    #[test]
    fn slip_takes_what_is_beyond_the_closing_of_the_gap() {
        let met = exchange(Rule::Slip, UP, 0.25, bodies([3.0, 1.0, 4.0], [0.5, 0.5])).unwrap();
        assert_eq!(met, [0.0, 0.75, 0.0]);
        assert_eq!(exchange(Rule::Slip, UP, 1.0, bodies([3.0, 1.0, 4.0], [0.5, 0.5])), None);
    }

    #[test]
    fn friction_is_coulombs_until_the_slip_stops() {
        // m12 = 1, slip 5 along (0.6, 0, 0.8).
        let sliding = bodies([3.0, 2.0, 4.0], [0.5, 0.5]);
        let met = exchange(Rule::Frictional(0.5), UP, 0.0, sliding).unwrap();
        assert!((met[0] - 0.6).abs() < 1e-15 && (met[2] - 0.8).abs() < 1e-15 && met[1] == 2.0);
        let stopped = exchange(Rule::Frictional(5.0), UP, 0.0, sliding);
        assert_eq!(stopped, Some([3.0, 2.0, 4.0]));
        assert_eq!(stopped, exchange(Rule::Stick, UP, 0.0, sliding));
    }

    #[test]
    fn heat_is_drag_times_the_mean_slip_of_the_particles() {
        let slip = [5.0, -1.0, 0.0];
        let mut couple = Couple { drag: [2.0, 0.0, 0.0], slip, ..Couple::default() };
        let [a, b] = bodies([3.0, 0.0, 0.0], [1.0, 1.0]);
        assert_eq!(begin(&mut couple, Some((a, b))), 8.0);
        assert_eq!((couple.slip, couple.drag), ([3.0, 0.0, 0.0], [0.0; 3]));
        couple.drag = [2.0, 0.0, 0.0];
        // A body that has left the node: the last slip that is known.
        assert_eq!(begin(&mut couple, None), 6.0);
    }

    #[test]
    fn rigid_bodies_are_infinitely_heavy() {
        let met = exchange(Rule::Slip, UP, 0.0, bodies([0.0, 3.0, 0.0], [0.5, 0.0])).unwrap();
        assert_eq!(met, [0.0, 6.0, 0.0]);
        assert_eq!(exchange(Rule::Slip, UP, 0.0, bodies([0.0, 3.0, 0.0], [0.0; 2])), None);
    }
}
