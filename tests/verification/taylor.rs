//! V9: a copper rod hits a rigid wall.

use super::script::Script;
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

#[test]
#[ignore = "ten seconds: cargo test --release -- --ignored"]
fn the_rod_has_the_published_shape_and_keeps_its_energy() {
    let h = 0.5;
    let played = Script::input("taylor-bar/taylor-bar.mpm").play(&[("h", h)]);
    played.end.as_ref().expect("the run is stable");
    let [length, foot, width] = shape(&played.session.simulation, h);
    let kinetic = played.column("Ek");
    println!("V9: length {length:.3}, foot {foot:.3}, width {width:.3}, Ek {:?}", kinetic.last());
    // Karamelo: 16.77, 14.40, 10.45 mm; it iterates on the yield surface in another way.
    assert!((length - 16.77).abs() < 0.17, "{length}");
    assert!((foot - 14.4).abs() < 0.3, "{foot}");
    assert!((width - 10.45).abs() < 0.25, "{width}");
    assert!(*kinetic.last().unwrap() < 0.2);
}

#[test]
#[ignore = "ten seconds: cargo test --release -- --ignored"]
fn a_rod_without_hardening_is_seen_to_fail() {
    let script = Script::input("taylor-bar/taylor-bar.mpm").replace("0.065, 0.356, 0.37", "0.065, 0, 0.37");
    let script = script.replace("run_time(0.0794)", "run_time(0.03)");
    let played = script.play(&[]);
    let shortening = *played.column("shortening").last().unwrap();
    // With hardening it is 5.36 mm after this time.
    println!("V9 without hardening: {shortening:.3} {:?}", played.end);
    assert!(shortening > 5.5 || played.end.is_err(), "{shortening}");
}
