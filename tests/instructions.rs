//! Instructions per particle-step: a measure of speed without noise.
//!
//! Counted by valgrind where it is installed.

#[path = "../benches/table/callgrind.rs"]
mod callgrind;
#[path = "../benches/table/input.rs"]
mod input;

use assert_cmd::cargo::cargo_bin;
use std::fmt::Write as _;

/// A scene, what chooses the method in its input, cells along an edge, particles, and the budget of
/// instructions per particle-step.
struct Case(&'static str, &'static str, u32, u64, u64);

const CASES: [Case; 7] = [
    Case("block.mpm", "ulmpm, FLIP, linear, 1", 10, 8000, 550),
    Case("block.mpm", "ulmpm, FLIP, cubic-spline, 1", 8, 4096, 2300),
    Case("square.mpm", "ulmpm, FLIP, linear, 1", 45, 8100, 327),
    Case("square.mpm", "ulmpm, FLIP, cubic-spline, 1", 30, 3600, 800),
    Case("block.mpm", "tlmpm, FLIP, linear, 1", 10, 8000, 1150),
    Case("copper-block.mpm", "ulmpm, FLIP, linear, 1", 10, 8000, 900),
    Case("sand-block.mpm", "ulmpm, FLIP, linear, 1", 10, 8000, 900),
];

/// Domains of particles: what was counted, and 5 %.
const DOMAINS: [Case; 8] = [
    Case("square.mpm", "ulmpm, FLIP, gimp, 1", 30, 3600, 550),
    Case("square.mpm", "ulcpdi, FLIP, linear, 1, R4", 30, 3600, 955),
    Case("square.mpm", "ulcpdi, FLIP, linear, 1, Q4", 30, 3600, 1290),
    Case("square.mpm", "ulcpdi, FLIP, linear, 1, T3", 30, 1800, 1365),
    Case("block.mpm", "ulmpm, FLIP, gimp, 1", 6, 1728, 1145),
    Case("block.mpm", "ulcpdi, FLIP, linear, 1, R8", 6, 1728, 3090),
    Case("block.mpm", "ulcpdi, FLIP, linear, 1, H8", 6, 1728, 4870),
    Case("block.mpm", "ulcpdi, FLIP, linear, 1, Tet4", 6, 1296, 2420),
];

fn per_particle_step(case: &Case) -> Option<u64> {
    let Case(file, method, cells, particles, _) = case;
    let folder = tempfile::tempdir().expect("a folder for the mesh");
    let mesh = folder.path().join("mesh.msh");
    let simplices = method.ends_with("T3") || method.ends_with("Tet4");
    if simplices {
        let dimension = if *file == "square.mpm" { 2 } else { 3 };
        std::fs::write(&mesh, simplex_mesh(dimension, *cells as usize)).expect("a mesh is written");
    }
    let script = |steps| {
        let text = input::text(file, *cells, steps).replace("ulmpm, FLIP, linear, 1", method);
        let line = |line: &str| match line.split_once(", region, body, 2, ") {
            Some((solid, rest)) if simplices => {
                format!("{solid}, mesh, {}, {rest}\n", mesh.display())
            }
            _ => format!("{line}\n"),
        };
        text.lines().map(line).collect()
    };
    callgrind::per_particle_step(cargo_bin!("karamelo-rs"), *particles, script)
}

/// The unit square or cube in `cells` cells along an edge, each cut in two triangles or six
/// tetrahedra, as Gmsh 2.2.
fn simplex_mesh(dimension: usize, cells: usize) -> String {
    let counts = [0, 1, 2].map(|axis| if axis < dimension { cells + 1 } else { 1 });
    let number = |at: [usize; 3]| 1 + (at[2] * counts[1] + at[1]) * counts[0] + at[0];
    let orders: &[&[usize]] = match dimension {
        2 => &[&[0, 1], &[1, 0]],
        _ => &[&[0, 1, 2], &[1, 2, 0], &[2, 0, 1], &[0, 2, 1], &[1, 0, 2], &[2, 1, 0]],
    };
    let (mut nodes, mut elements) = (String::new(), Vec::new());
    for place in 0..counts.iter().product() {
        let at = [place % counts[0], place / counts[0] % counts[1], place / counts[0] / counts[1]];
        let [x, y, z] = at.map(|index| index as f64 / cells as f64);
        let _ = writeln!(nodes, "{} {x} {y} {z}", number(at));
        if (0..dimension).any(|axis| at[axis] == cells) {
            continue;
        }
        // The way along the edges of the cell to its far corner, one for each order of the axes.
        for order in orders {
            let mut corner = at;
            let mut corners = vec![number(corner).to_string()];
            for axis in *order {
                corner[*axis] += 1;
                corners.push(number(corner).to_string());
            }
            elements.push(corners.join(" "));
        }
    }
    let kind = if dimension == 2 { 2 } else { 4 };
    let mut text = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n{nodes}$EndNodes\n$Elements\n{}\n",
        nodes.lines().count(),
        elements.len()
    );
    for (index, corners) in elements.iter().enumerate() {
        let _ = writeln!(text, "{} {kind} 2 0 1 {corners}", index + 1);
    }
    text + "$EndElements\n"
}

#[test]
fn elastic_steps_stay_within_their_budget() {
    stay_within_their_budget(&CASES);
}

#[test]
fn steps_with_domains_stay_within_their_budget() {
    stay_within_their_budget(&DOMAINS);
}

fn stay_within_their_budget(cases: &[Case]) {
    if cfg!(debug_assertions) {
        println!("not tested: instructions are counted in release builds");
        return;
    }
    for case in cases {
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
