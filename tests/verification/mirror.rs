//! A wall is a mirror: half a body at a wall moves like the half of a symmetric body.

use super::script::{Played, Script};
use super::way::Way;
use karamelo::model::column::Column;

/// A bar from `lower` to 1 with a velocity odd about x = 0, and a wall at x = 0 if it is cut there.
fn bar(lower: f64, wall: &str) -> Script {
    let text = format!(
        "
h = 1/8
method(ulmpm, FLIP, linear, 1)
dimension(1, {lower} - 2*h, 1 + 2*h, h)
region(body, block, {lower}, 1)
region(middle, block, -h/8, h/8)
material(rubber, neo-hookean, 1000, 1e5, 0.3)
solid(bar, region, body, 2, rubber, h)
group(cut, nodes, region, middle)
{wall}
fix(launch, initial_velocity_particles, all, 0.5*sin(3*x))
fix(place, check_solution, all, x0)
set_dt(1/1024)
run(100)
"
    );
    Script::new("mirror", &text)
}

/// Places of the particles right of x = 0, by reference place.
fn right_half(played: &Played) -> Vec<f64> {
    let particles = &played.session.simulation.world.particles;
    let places = particles.column(Column::X0).iter().zip(&particles.position);
    let mut right: Vec<(f64, f64)> =
        places.filter(|(x0, _)| **x0 > 0.0).map(|(x0, x)| (*x0, x[0])).collect();
    right.sort_by(|a, b| a.0.total_cmp(&b.0));
    right.into_iter().map(|(_, x)| x).collect()
}

fn difference(way: &Way, wall: &str) -> f64 {
    let [half, whole] = [bar(0.0, wall), bar(-1.0, "")].map(|script| way.of(script).play(&[]));
    let [half, whole] = [half, whole].map(|played| right_half(&played));
    assert_eq!((half.len(), whole.len()), (16, 16));
    half.iter().zip(&whole).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn a_wall_is_a_mirror_for_shapes_that_know_no_border() {
    for way in Way::all().iter().filter(|way| !way.shape.ends_with("spline")) {
        let difference = difference(way, "fix(hold, velocity_nodes, cut, 0)");
        // Round-off of 100 steps; cells are crossed.
        assert!(difference < 1e-11, "{difference:e}: {way}");
    }
}

#[test]
fn a_cut_without_a_wall_is_seen() {
    let way = Way::flip("ulmpm", "linear");
    assert!(difference(&way, "") > 1e-3);
}
