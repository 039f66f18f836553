//! Bodies from meshes, lists and rings, and bodies that were moved, against bodies from regions.

use super::script::{Played, Script};
use karamelo::compute::energy::kinetic_energy;
use karamelo::model::group::GroupId;
use karamelo::output::Outputs;
use karamelo::simulation::Until;
use std::fmt::Write;

/// A bar of length 1, held at its left end and set off in its first mode.
const BAR: &str = "
method(METHOD, FLIP, SHAPE, 1)
dimension(2, 0, 1.25, 0, 0.5, 0.0625)
region(shape, block, 0, 1, 0, 0.25)
region(end, block, INF, 0.001, INF, INF)
material(m, linear, 1000, 1e6, 0)
solid(bar, region, shape, 2, m, 0.0625)
group(held, nodes, region, end)
fix(hold, velocity_nodes, held, 0, NULL)
fix(launch, initial_velocity_particles, all, 0.001*sin(PI/2*x0), 0)
compute(Ek, kinetic_energy, all)
compute(Es, strain_energy, all)
compute(v, average_velocity, all)
log_modify(custom, time, Ek, Es, v_x)
set_dt(0.0002)
run_time(0.26)
";

fn bar(method: &str, shape: &str) -> Script {
    Script::new("bar", BAR).replace("METHOD", method).replace("SHAPE", shape)
}

/// A mesh of squares of edge 1/32 from (0, 0) to (length, 1/4), of which each may be cut into two
/// triangles; inner nodes are moved by up to a quarter of the edge.
fn mesh(length: f64, cut: bool, moved: bool) -> String {
    let (nx, ny) = (32, 8);
    let mut text =
        format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", (nx + 1) * (ny + 1));
    for i in 0..=nx {
        for j in 0..=ny {
            let number = i * (ny + 1) + j;
            let inner = i > 0 && i < nx && j > 0 && j < ny && moved;
            let shift = |k: u32| match inner {
                true => {
                    f64::from((number * 2 + k).wrapping_mul(2_654_435_761) >> 16) / 131_072.0 - 0.25
                }
                false => 0.0,
            };
            let x = length * (f64::from(i) + shift(0)) / f64::from(nx);
            let y = 0.25 * (f64::from(j) + shift(1)) / f64::from(ny);
            let _ = writeln!(text, "{} {x} {y} 0", number + 1);
        }
    }
    let mut elements = Vec::new();
    for i in 0..nx {
        for j in 0..ny {
            let node = |i: u32, j: u32| i * (ny + 1) + j + 1;
            let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
            match cut {
                true => elements.extend([format!("2 0 {a} {b} {c}"), format!("2 0 {a} {c} {d}")]),
                false => elements.push(format!("3 0 {a} {b} {c} {d}")),
            }
        }
    }
    let _ = writeln!(text, "$EndNodes\n$Elements\n{}", elements.len());
    for (number, element) in elements.iter().enumerate() {
        let _ = writeln!(text, "{} {element}", number + 1);
    }
    text + "$EndElements\n"
}

/// Plays the script with the bar from a file.
fn from_file(script: Script, form: &str, text: &str) -> Played {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("body");
    std::fs::write(&file, text).unwrap();
    let solid = format!("solid(bar, {form}, \"{}\", m, 0.0625)", file.display());
    script.statement("solid(bar", &solid).play(&[])
}

/// The largest difference of a column, in parts of its largest value.
fn difference(a: &Played, b: &Played, column: &str) -> f64 {
    let (a, b) = (a.column(column), b.column(column));
    assert_eq!(a.len(), b.len());
    let scale = a.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    a.iter().zip(&b).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs())) / scale
}

#[test]
fn a_mesh_of_squares_is_the_body_of_the_region() {
    // Each square is one particle of the region: places and volumes are exact in binary.
    for (method, shape) in
        [("tlmpm", "linear"), ("tlmpm", "cubic-spline"), ("ulmpm", "quadratic-spline")]
    {
        let script = bar(method, shape);
        let region = script.clone().play(&[]);
        let meshed = from_file(script.clone(), "mesh", &mesh(1.0, false, false));
        let mut list = String::from("# x y volume\n");
        for i in 0..32 {
            for j in 0..8 {
                let place = |k: i32| (f64::from(k) + 0.5) / 32.0;
                let _ = writeln!(list, "{} {} {}", place(i), place(j), 1.0 / 1024.0);
            }
        }
        let listed = from_file(script.clone(), "file", &list);
        let longer = from_file(script, "mesh", &mesh(1.0 + 1e-6, false, false));
        for column in ["Ek", "Es", "v_x"] {
            // 1300 steps with ids in another order: sums differ by their rounding, 1e-16 each.
            assert!(difference(&region, &meshed, column) < 1e-11, "{method} {shape} {column}");
            assert!(difference(&region, &listed, column) < 1e-11, "{method} {shape} {column}");
            // A broken variant: a millionth too long.
            assert!(difference(&region, &longer, column) > 1e-8, "{method} {shape} {column}");
        }
    }
}

/// Period from the zero crossings of the mean velocity.
fn period(played: &Played) -> f64 {
    let (time, v) = (played.column("Time"), played.column("v_x"));
    let crossings: Vec<f64> = (1..v.len())
        .filter(|k| v[k - 1] * v[*k] < 0.0)
        .map(|k| time[k - 1] + (time[k] - time[k - 1]) * v[k - 1] / (v[k - 1] - v[k]))
        .collect();
    assert!(crossings.len() >= 3, "{crossings:?}");
    2.0 * (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64
}

#[test]
fn a_bar_of_irregular_triangles_vibrates_as_it_must() {
    // T = 4 L/c, c^2 = E/rho. Cells resolve a quarter of a wave with 16 of them: lumped masses
    // slow the first mode by (PI/32)^2/24 = 0.04 %; irregular particles integrate the masses of
    // nodes with a scatter of a few percent, which enters the period in second order.
    let exact = 4.0 / (1e6f64 / 1000.0).sqrt();
    for (method, shape) in
        [("tlmpm", "linear"), ("tlmpm", "quadratic-spline"), ("ulmpm", "cubic-spline")]
    {
        let measure = |length: f64| {
            let played = from_file(bar(method, shape), "mesh", &mesh(length, true, true));
            let particles = &played.session.simulation.world.particles;
            let mass: f64 = particles.position.iter().map(|position| position[3]).sum();
            assert_eq!(particles.len(), 512);
            assert!((mass / (250.0 * length) - 1.0).abs() < 1e-14, "{mass}");
            period(&played) / exact - 1.0
        };
        let error = measure(1.0);
        assert!(error.abs() < 0.005, "{method} {shape}: {error}");
        // A broken variant: a bar that is one percent longer.
        assert!(measure(1.01).abs() > 0.005, "{method} {shape}");
    }
}

#[test]
fn a_moved_body_is_the_body_made_there() {
    // Total Lagrangian: the grid goes along, whatever the distance; updated: by one cell.
    for (method, shape, by) in [
        ("tlmpm", "linear", 0.02),
        ("tlmpm", "cubic-spline", 0.3),
        ("ulmpm", "quadratic-spline", 0.0625),
    ] {
        let there = format!("0, 1, {by}, {})", 0.25 + by);
        let there = bar(method, shape).replace("0, 1, 0, 0.25)", &there);
        let moved = |dx: &str| {
            let line = format!(
                "translate_particles(all, region, shape, {dx}, {by})\n\
                 group(held, nodes, region, end)"
            );
            bar(method, shape).statement("group(held", &line)
        };
        let [there, moved, wrong] =
            [there, moved("0"), moved("0.001*x")].map(|script| script.play(&[]));
        for column in ["Ek", "Es", "v_x"] {
            // Places are rounded at 1e-17, 2e-16 of a cell, in each of 1300 steps.
            assert!(difference(&there, &moved, column) < 1e-10, "{method} {column}");
            // A broken variant: stretched by a thousandth.
            assert!(difference(&there, &wrong, column) > 1e-5, "{method} {column}");
        }
    }
}

/// The 32 x 8 particles of the bar, their places along it changed.
fn list(place: impl Fn(f64) -> f64) -> String {
    let mut text = String::from("# x y volume\n");
    for i in 0..32 {
        for j in 0..8 {
            let [x, y] = [i, j].map(|k| (f64::from(k) + 0.5) / 32.0);
            let _ = writeln!(text, "{} {y} {}", place(x), 1.0 / 1024.0);
        }
    }
    text
}

#[test]
fn parts_moved_together_are_the_body_they_make() {
    // Total Lagrangian: cells stay when a part is moved, and grow when all of it is drawn apart.
    let there = |shape: &str| from_file(bar("tlmpm", shape), "file", &list(|x| x));
    let pressed = list(|x| (x - 1.0 / 64.0) / 1.25 + 1.0 / 64.0);
    let apart = list(|x| if x < 0.5 { x } else { x + 0.1 });
    let join =
        "region(tail, block, 0.55, INF, INF, INF)\ntranslate_particles(all, region, tail, -0.1, 0)";
    let draw = "translate_particles(all, region, shape, 0.25*(x - 1/64), 0)";
    let moved = |shape: &str, line: &str| {
        let line = format!("{line}\ngroup(held, nodes, region, end)");
        bar("tlmpm", shape).statement("group(held", &line)
    };
    for (shape, line, text) in
        [("linear", join, &apart), ("linear", draw, &pressed), ("cubic-spline", draw, &pressed)]
    {
        let there = there(shape);
        let moved = from_file(moved(shape, line), "file", text);
        for column in ["Ek", "Es", "v_x"] {
            // Places are rounded at 1e-17, 2e-16 of a cell, in each of 1300 steps.
            let difference = difference(&there, &moved, column);
            assert!(difference < 1e-10, "{shape} {line} {column}: {difference}");
        }
    }
    // Broken variants: the gap left open; cells that have gone along with a part.
    let gap = from_file(bar("tlmpm", "linear"), "file", &apart);
    assert!(difference(&there("linear"), &gap, "Ek") > 1e-3);
    let [right, wrong] = [0.0, -0.1].map(|by| {
        let script = moved("linear", join).replace("run_time(0.26)", "run(0)");
        let mut simulation = from_file(script, "file", &apart).session.simulation;
        simulation.world.solids[0].cells.shift([by, 0.0, 0.0]);
        simulation.outputs = Outputs::silent();
        let ended = simulation.run(Until::Steps(200));
        ended.map_or(f64::NAN, |()| kinetic_energy(&simulation.world, GroupId::ALL))
    });
    let apart = wrong.is_nan() || (wrong / right - 1.0).abs() > 1e-6;
    assert!(right.is_finite() && apart, "{right} {wrong}");
}

#[test]
fn rings_have_the_mass_of_the_disk_and_swing_alike() {
    // A disk in its breathing motion: v = r, free rim.
    let script = "
method(tlmpm, FLIP, cubic-spline, 1)
dimension(2, -1, 1, -1, 1, 0.05)
region(disk, sphere, 0, 0, 0.5)
material(m, linear, 1000, 1e6, 0.3)
solid(s, region, disk, 2, m, 0.05)
# rings
fix(launch, initial_velocity_particles, all, 0.01*x0, 0.01*y0)
compute(Es, strain_energy, all)
log_modify(custom, time, Es)
set_dt(0.0002)
run_time(0.03)
";
    let cells = Script::new("disk", script).play(&[]);
    let rings = |radius: f64, outwards: u32| {
        let rings =
            format!("populate_cylindrical_coordinates(s, disk, 0, 0, {radius}, {outwards}, 64, 0)");
        Script::new("disk", script).replace("# rings", &rings).play(&[])
    };
    let right = rings(0.5, 20);
    let mass = |played: &Played| -> f64 {
        played.session.simulation.world.particles.position.iter().map(|x| x[3]).sum()
    };
    let exact = 250.0 * std::f64::consts::PI;
    assert!((mass(&right) / exact - 1.0).abs() < 1e-13);
    // Squares of edge h/2 = 0.025 fill a disk of 1257 of them to within sqrt(1257)/1257.
    assert!((mass(&cells) / exact - 1.0).abs() < 0.03);
    let peak = |played: &Played| {
        let (time, energy) = (played.column("Time"), played.column("Es"));
        let best = (0..energy.len()).max_by(|a, b| energy[*a].total_cmp(&energy[*b]));
        time[best.expect("rows")]
    };
    // The largest strain after a quarter of the breathing period, about 0.01.
    let difference = peak(&right) / peak(&cells) - 1.0;
    assert!(difference.abs() < 0.04, "{difference}");
    // A broken variant: a smaller disk of rings swings faster.
    assert!((peak(&rings(0.45, 20)) / peak(&cells) - 1.0).abs() > 0.04);
}
