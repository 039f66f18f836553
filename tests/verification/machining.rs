//! V12: a wedge cuts a chip off a slab of steel.

use super::scene::momentum;
use super::script::{Played, Script};
use karamelo::model::column::Column;
use std::collections::BTreeSet;

fn script() -> Script {
    let log = "log_modify(custom, dt, tool_x, tool_y, tool_s, W_external, W_residual)";
    Script::input("machining/machining.mpm")
        .statement("log_modify", log)
        .statement("set_output", "set_output(1)")
}

fn play(script: &Script, rows: f64, travel: f64) -> Played {
    let played = script.play(&[("rows", rows), ("travel", travel)]);
    played.end.as_ref().expect("the run is stable");
    played
}

fn last(played: &Played, name: &str) -> f64 {
    *played.column(name).last().unwrap()
}

/// Sizes of the sets of particles with D < 1 that share nodes, largest first: with hats and one
/// particle in the middle of each cell those of neighbouring cells, also across corners.
fn pieces(played: &Played) -> Vec<usize> {
    let world = &played.session.simulation.world;
    let cell = world.solids[0].cells.cell;
    let places = world.particles.reference.iter();
    let damage = world.particles.column(Column::Damage);
    let alive = places.zip(damage).filter(|(_, d)| **d < 1.0);
    let place = |x: f64| (x / cell).floor() as i64;
    let mut left: BTreeSet<[i64; 2]> = alive.map(|(x, _)| [place(x[0]), place(x[1])]).collect();
    let mut sizes = Vec::new();
    while let Some(first) = left.pop_first() {
        let (mut stack, mut size) = (vec![first], 0);
        while let Some([i, j]) = stack.pop() {
            size += 1;
            for neighbour in (-1..=1).flat_map(|di| (-1..=1).map(move |dj| [i + di, j + dj])) {
                if left.remove(&neighbour) {
                    stack.push(neighbour);
                }
            }
        }
        sizes.push(size);
    }
    sizes.sort_by(|a, b| b.cmp(a));
    sizes
}

/// The balances of a cut; gives the sizes of the pieces.
fn assert_balances(played: &Played) -> Vec<usize> {
    let world = &played.session.simulation.world;
    let [work, booked] = ["tool_s", "W_external"].map(|name| last(played, name));
    let residual = played.column("W_residual").iter().fold(0.0f64, |a, b| a.max(b.abs()));
    let ledger = residual / booked;
    println!("work {work:.5} J, in the ledger {booked:.5}, ledger off by {ledger:.1e}");
    // The tool follows the ways of single particles, which swing about their nodes.
    assert!((work / booked - 1.0).abs() < 0.005 && ledger < 0.01);

    for (x, v) in world.particles.position.iter().zip(&world.particles.velocity) {
        assert!(x.iter().chain(v).all(|number| number.is_finite()), "{x:?} {v:?}");
    }
    let damage = world.particles.column(Column::Damage);
    let failed = damage.iter().filter(|damage| **damage == 1.0).count();
    let pieces = pieces(played);
    println!("{failed} of {} particles failed, pieces {pieces:?}", damage.len());
    assert!(failed > 0);
    pieces
}

/// Momentum of a slab that nothing holds less the impulse of the tool, relative.
fn imbalance(script: &Script, tool: [&str; 2]) -> [f64; 2] {
    let played = play(script, 12.0, 0.2);
    let given = momentum(&played.session.simulation);
    let dt = played.column("dt");
    let pushed = tool.map(|name| {
        let force = played.column(name);
        force.iter().zip(&dt).skip(1).map(|(f, dt)| f * dt).sum::<f64>()
    });
    println!("impulse of the tool {pushed:.6?}, momentum of the slab {given:.6?}");
    [0, 1].map(|axis| given[axis] / pushed[axis] - 1.0)
}

#[test]
fn the_impulse_of_the_tool_is_that_of_the_slab() {
    let free = script().statement("fix(foot", "");
    // Sums of the same numbers over some thousand steps: round-off.
    for error in imbalance(&free, ["tool_x", "tool_y"]) {
        assert!(error.abs() < 1e-10, "{error:.1e}");
    }
    // A slab whose foot is held has another momentum; the axes are not the same either.
    assert!(imbalance(&script(), ["tool_x", "tool_y"])[0].abs() > 0.1);
    assert!(imbalance(&free, ["tool_y", "tool_x"])[0].abs() > 0.1);
}

#[test]
fn a_chip_separates_and_the_work_of_the_tool_is_in_the_ledger() {
    let played = play(&script(), 24.0, 0.3);
    assert_eq!(played.session.simulation.world.particles.len(), 80 * 24);
    let pieces = assert_balances(&played);
    // A column of the layer that is cut off has 12 particles.
    assert!(pieces[1] > 24, "{pieces:?}");

    let tough = script().replace("johnson_cook, 0.05, 0.8,", "johnson_cook, 50, 0.8,");
    let whole = self::pieces(&play(&tough, 12.0, 0.1));
    assert_eq!(whole, [40 * 12]);
}

#[test]
#[ignore = "minutes: cargo test --release -- --ignored"]
fn teeth_come_off_on_finer_cells() {
    let paper = play(&script(), 96.0, 0.0);
    assert_eq!(paper.session.simulation.world.particles.len(), 30_720);
    let played = play(&script(), 48.0, 0.6);
    let pieces = assert_balances(&played);
    // A column of the layer that is cut off has 24 particles.
    assert!(pieces[1] > 48, "{pieces:?}");
}
