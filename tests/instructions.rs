//! Instructions per particle-step: a measure of speed without noise.
//!
//! Counted by valgrind where it is installed.

#[path = "../benches/table/callgrind.rs"]
mod callgrind;
#[path = "../benches/table/input.rs"]
mod input;

use assert_cmd::cargo::cargo_bin;

/// A scene, the line of its input that chooses the method, what stands there instead, cells along
/// an edge, particles, and the budget of instructions per particle-step.
struct Case(&'static str, &'static str, u32, u64, u64);

const CASES: [Case; 7] = [
    Case("block.mpm", "ulmpm, FLIP, linear, 1", 10, 8000, 550),
    Case("block.mpm", "ulmpm, FLIP, cubic-spline, 1", 8, 4096, 2300),
    Case("square.mpm", "ulmpm, FLIP, linear, 1", 45, 8100, 325),
    Case("square.mpm", "ulmpm, FLIP, cubic-spline, 1", 30, 3600, 800),
    Case("block.mpm", "tlmpm, FLIP, linear, 1", 10, 8000, 1150),
    Case("copper-block.mpm", "ulmpm, FLIP, linear, 1", 10, 8000, 900),
    Case("sand-block.mpm", "ulmpm, FLIP, linear, 1", 10, 8000, 900),
];

fn per_particle_step(case: &Case) -> Option<u64> {
    let Case(file, method, cells, particles, _) = case;
    let script = |steps| input::text(file, *cells, steps).replace("ulmpm, FLIP, linear, 1", method);
    callgrind::per_particle_step(cargo_bin!("karamelo-rs"), *particles, script)
}

#[test]
fn elastic_steps_stay_within_their_budget() {
    if cfg!(debug_assertions) {
        println!("not tested: instructions are counted in release builds");
        return;
    }
    for case in &CASES {
        let Case(input, method, .., budget) = case;
        match per_particle_step(case) {
            Some(found) => {
                println!("{input}, {method}: {found} instructions per particle-step of {budget}");
                assert!(found <= *budget, "{input}, {method}: {found} > {budget}");
            }
            None => println!("not tested: valgrind is not installed"),
        }
    }
}

/// A ball that flies through a box with walls at so many times its size.
fn bullet(size: u32, steps: u32) -> String {
    format!(
        "method(ulmpm, FLIP, linear, 1)\n\
         dimension(3, -{size}, {size}, -{size}, {size}, -{size}, {size}, 1/8)\n\
         region(ball, sphere, 0, 0, 0, 0.7)\n\
         material(lead, linear, 1000, 1e5, 0.3)\n\
         solid(ball, region, ball, 2, lead, 1/8)\n\
         fix(fly, initial_velocity_particles, all, 0.3, 0.2, 0.1)\n\
         run({steps})\n"
    )
}

#[test]
fn a_box_a_hundred_times_larger_costs_nothing() {
    if cfg!(debug_assertions) {
        println!("not tested: instructions are counted in release builds");
        return;
    }
    let count = |size| {
        callgrind::per_particle_step(cargo_bin!("karamelo-rs"), 5896, |steps| bullet(size, steps))
    };
    let (Some(small), Some(large)) = (count(1), count(100)) else {
        println!("not tested: valgrind is not installed");
        return;
    };
    println!("{small} instructions per particle-step in the small box, {large} in the large one");
    assert!(large as f64 <= 1.05 * small as f64);
}
