//! V9: a copper rod hits a rigid wall.

use super::script::{Played, Script};
use karamelo::model::column::Column;
use karamelo::simulation::Simulation;

/// Length, largest diameter at the foot, width at a height of 5.08 mm \[mm\]: particles and half a
/// cell beyond them, as the reference measures them.
fn shape(simulation: &Simulation, h: f64) -> [f64; 3] {
    let particles = &simulation.world.particles;
    let reference = particles.column(Column::X0);
    let end = reference.iter().copied().fold(0.0, f64::max);
    let radius = |p: usize| particles.position[p][1].hypot(particles.position[p][2]);
    let all = || 0..particles.len();
    let top: Vec<f64> = all()
        .filter(|p| reference[*p] > end - 0.1 * h)
        .map(|p| particles.position[p][0] + 0.5 * h * particles.column(Column::F11)[p])
        .collect();
    let length = top.iter().sum::<f64>() / top.len() as f64;
    let foot = all().filter(|p| reference[*p] < h).map(radius).fold(0.0, f64::max);
    let at_height = |p: &usize| (particles.position[*p][0] - 5.08).abs() < h;
    let width = all().filter(at_height).map(radius).fold(0.0, f64::max);
    [length, 2.0 * (foot + 0.5 * h), 2.0 * (width + 0.5 * h)]
}

const SCENE: &str = "taylor-bar/taylor-bar.mpm";

/// Plays the rod with cells of `h` up to a time; the scene, the shape of the rod, its kinetic energy.
fn play(script: &Script, h: f64, end: f64) -> (Played, [f64; 3], f64) {
    let played = script.play(&[("h", h), ("end", end)]);
    played.end.as_ref().expect("the run is stable");
    let shape = shape(&played.session.simulation, h);
    let kinetic = *played.column("Ek").last().unwrap();
    println!("V9: h = {h}, {end} ms: length, foot, width {shape:.3?}, Ek {kinetic:.3}");
    (played, shape, kinetic)
}

/// Plastic work, that and what the transfer has lost, both over Ek0 - Ek - Es.
fn losses(played: &Played) -> [f64; 2] {
    let last = |name: &str| *played.column(name).last().unwrap();
    let spent = played.column("Ek")[0] - last("Ek") - last("Es");
    let found = [last("W_plastic"), last("W_plastic") + last("W_numerical")];
    let parts = found.map(|work| work / spent);
    println!(
        "V9: plastic work {:.4}, with the transfer {:.4} of the energy spent",
        parts[0], parts[1]
    );
    parts
}

/// The rod as the reference plays it with cells of 0.5 mm: a quarter of the stable step. FLIP 0.99 damps
/// the more the shorter the step.
fn coarse() -> Script {
    Script::input(SCENE).statement("dt_factor", "dt_factor(0.25)")
}

/// The same without its energy ledger, which takes time.
fn quick() -> Script {
    coarse().statement("compute(W", "").replace(", W_plastic, W_error", "")
}

/// The rod with the losses in its log.
fn with_losses() -> Script {
    Script::input(SCENE).replace("W_plastic, W_error", "W_plastic, W_numerical, W_error")
}

/// `A, B, n` of the flow stress \[GPa\].
const FLOW: &str = "0.065, 0.356, 0.37";

#[test]
fn the_rod_is_slowed_by_its_wall_as_fast_as_in_the_reference() {
    // Karamelo, h = 0.5, after 14.325 us: length 22.793, Ek 130.43 J. It iterates on the yield surface
    // in another way: 1 %, as the list allows for lengths.
    let stopped = |script: &Script| {
        let (_, [length, ..], kinetic) = play(script, 0.5, 0.014325);
        assert!((length / 22.793 - 1.0).abs() < 0.01, "{length}");
        (kinetic / 130.43 - 1.0).abs() < 0.01
    };
    assert!(stopped(&quick()));
    // Broken variants: flow with another exponent, without hardening; no wall.
    assert!(!stopped(&quick().replace(FLOW, "0.065, 0.356, 1")));
    assert!(!stopped(&quick().replace(FLOW, "0.065, 0, 0.37")));
    let free = "fix(stop, velocity_nodes, wall, NULL, NULL, NULL)";
    assert!(!stopped(&quick().statement("fix(stop", free)));
}

/// Length, foot and width of the reference \[mm\] within 1 to 2 %; nothing moves any more.
fn assert_shape([length, foot, width]: [f64; 3], reference: [f64; 3], kinetic: f64) {
    assert!((length - reference[0]).abs() < 0.17, "{length}");
    assert!((foot - reference[1]).abs() < 0.3, "{foot}");
    assert!((width - reference[2]).abs() < 0.25, "{width}");
    assert!(kinetic < 0.2, "{kinetic}");
}

#[test]
#[ignore = "half a minute: cargo test --release -- --ignored"]
fn the_rod_has_the_published_shape() {
    let (_, shape, kinetic) = play(&quick(), 0.5, 0.0794);
    assert_shape(shape, [16.77, 14.4, 10.45], kinetic);
}

#[test]
#[ignore = "half a minute: cargo test --release -- --ignored"]
fn the_energy_of_the_rod_becomes_plastic_work() {
    // FLIP 0.99 loses 1 % of the difference between particles and nodes in each of 7000 steps.
    let [plastic, both] = losses(&play(&with_losses(), 0.5, 0.0794).0);
    assert!((both - 1.0).abs() < 0.03 && plastic < 0.97, "{plastic} {both}");
    let keeping = with_losses().replace("FLIP, linear, 0.99", "FLIP, linear, 1");
    let [plastic, _] = losses(&play(&keeping, 0.5, 0.0794).0);
    assert!((plastic - 1.0).abs() < 0.03, "{plastic}");
}

#[test]
#[ignore = "minutes: cargo test --release -- --ignored"]
fn finer_cells_shorten_the_rod_as_published() {
    let (_, coarse, _) = play(&quick(), 0.5, 0.0794);
    let (played, fine, kinetic) = play(&with_losses(), 0.25, 0.0794);
    assert_shape(fine, [16.43, 14.77, 10.17], kinetic);
    let step = coarse[0] - fine[0];
    assert!((step - 0.34).abs() < 0.1, "{step}");
    let [_, both] = losses(&played);
    assert!((both - 1.0).abs() < 0.03, "{both}");
}

#[test]
#[ignore = "a minute: cargo test --release -- --ignored"]
fn rods_that_flow_in_another_way_are_seen_to_fail() {
    for flow in ["0.065, 0.356, 1", "0.065, 0, 0.37", "0.065, 0.178, 0.37"] {
        let played = quick().replace(FLOW, flow).play(&[("end", 0.0794)]);
        let [length, foot, width] = shape(&played.session.simulation, 0.5);
        println!("V9 with {flow}: {length:.3} {foot:.3} {width:.3} {:?}", played.end);
        assert!(played.end.is_err() || (length - 16.77).abs() > 0.17 || (foot - 14.4).abs() > 0.3);
    }
}
