//! Contact of particles (language.md 7.4): pairs, momentum, energy, friction.

use super::scene::{domain, linear, momentum};
use super::script::{Played, Script};
use karamelo::fix::contact::minimize_penetration::MinimizePenetration;
use karamelo::fix::contact::{Contact, ContactStyle};
use karamelo::kernel::pairs::{Pair, PairLaw, Pairs, Response};
use karamelo::output::Outputs;
use karamelo::region::sphere::Sphere;
use karamelo::simulation::{Simulation, Until};

fn last(played: &Played, name: &str) -> f64 {
    *played.column(name).last().unwrap()
}

/// Two particles of V = h^d that overlap by a tenth of h; the force of the first step.
fn two_particles(dimension: usize, fix: &str, second: &str) -> Played {
    let limits = ["-1, 1", "-1, 1, -1, 1", "-1, 1, -1, 1, -1, 1"][dimension - 1];
    let block = |x: &str| format!("{x}{}", ", 0, h".repeat(dimension - 1));
    let text = format!(
        "h = 0.1
method(tlmpm, FLIP, linear, 1)
dimension({dimension}, {limits}, h)
region(r1, block, {})
region(r2, block, {})
material(m1, linear, 1000, 5e3, 0.3)
material(m2, {second})
solid(s1, region, r1, 1, m1, h)
solid(s2, region, r2, 1, m2, h)
fix(touch, {fix})
log_modify(custom, time, touch_x, touch_y, touch_s)
set_dt(1e-4)
run(1)
",
        block("0, h"),
        block("0.9*h, 1.9*h")
    );
    Script::new("two particles", &text).play(&[])
}

#[test]
fn a_hertz_pair_has_the_force_of_the_closed_form() {
    let compliance = |young: f64, nu: f64| (1.0 - nu * nu) / young;
    let pen = 0.01f64;
    for (second, other) in [
        ("linear, 2000, 8e3, 0.2", compliance(8e3, 0.2)),
        ("neo-hookean, 2000, 8e3, 0.2", compliance(8e3, 0.2)),
        ("rigid, 2000", 0.0),
    ] {
        for (dimension, factor) in [(2, std::f64::consts::FRAC_PI_4), (3, 4.0 / 3.0)] {
            let modulus = 1.0 / (compliance(5e3, 0.3) + other);
            let exact = factor * modulus * (0.025 * pen.powi(3)).sqrt();
            let played = two_particles(dimension, "contact/hertz, s1, s2", second);
            let force = last(&played, "touch_x");
            // Positions of 0.1 with the round-off of 1e-17 in a penetration of 1e-2.
            assert!((force / exact + 1.0).abs() < 1e-12, "{dimension} {second}: {force} {exact}");
            let swapped = two_particles(dimension, "contact/hertz, s2, s1", second);
            assert_eq!(last(&swapped, "touch_x"), -force);
        }
    }
}

#[test]
fn a_penetration_is_taken_back_with_the_reduced_mass() {
    for (second, heavy) in [("linear, 3000, 8e3, 0.2", false), ("rigid, 1", true)] {
        let played = two_particles(2, "contact/minimize_penetration, s1, s2, 0.5", second);
        let mass = if heavy { 10.0 } else { 10.0 * 30.0 / 40.0 };
        let exact = mass * 0.01 / 1e-8;
        assert!((last(&played, "touch_x") / exact + 1.0).abs() < 1e-12);
        // Nothing slides.
        assert_eq!([last(&played, "touch_y"), last(&played, "touch_s")], [0.0; 2]);
    }
}

/// Force of the first step between two rings of section h^2, or two squares, that overlap by h/10.
fn two_sections(axisymmetric: bool, radius: f64) -> f64 {
    let text = format!(
        "h = 0.1
method(tlmpm, FLIP, linear, 1)
dimension(2, 0, 9, -1, 1, h)
axisymmetric({axisymmetric})
region(r1, block, {radius}, {radius} + h, 0, h)
region(r2, block, {radius}, {radius} + h, 0.9*h, 1.9*h)
material(m1, linear, 1000, 5e3, 0.3)
material(m2, rigid, 1)
solid(s1, region, r1, 1, m1, h)
solid(s2, region, r2, 1, m2, h)
fix(touch, contact/hertz, s1, s2)
log_modify(custom, time, touch_y)
set_dt(1e-4)
run(1)
"
    );
    last(&Script::new("two sections", &text).play(&[]), "touch_y")
}

#[test]
fn round_an_axis_a_particle_is_as_large_as_its_section() {
    // R = sqrt(V/x)/2 = h/2, whatever the radius of the ring: the overlap is that of squares.
    let exact = two_sections(false, 0.5);
    assert!(exact < 0.0);
    for radius in [0.0, 0.5, 2.0, 8.0] {
        let force = two_sections(true, radius);
        // Positions of 10 with the round-off of 1e-15 in a penetration of 1e-2.
        assert!((force / exact - 1.0).abs() < 1e-11, "{radius}: {force} for {exact}");
    }
    // With sqrt(V)/2 rings of radius 0.05 would not touch and those of 8.05 be 28 times as large.
    let of_volume = |x: f64| karamelo::kernel::pairs::radius(0.01 * x, 2);
    assert!(2.0 * of_volume(0.05) < 0.09 && of_volume(8.05) > 2.0 * of_volume(1.0));
}

/// Counts pairs along x, sums what tells them apart along y and z.
struct Count;

impl PairLaw for Count {
    fn respond(&self, pair: &Pair) -> Response {
        Response { force: [1.0, pair.penetration, pair.normal[0]], friction: 0.0, rate: 0.0 }
    }
}

#[test]
fn the_cell_list_finds_the_pairs_of_all_with_all() {
    let mut random = 1u64;
    let mut number = move || {
        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (random >> 11) as f64 / (1u64 << 53) as f64
    };
    for dimension in 1..=3 {
        let mut simulation = Simulation::new(domain(dimension, 0.0, 1.0, 0.05), Outputs::silent());
        for name in ["one", "two"] {
            let ball = Sphere { dimension, centre: [0.5; 3], radius: 0.2 };
            simulation.add_solid(name, "mat", linear(1.0, 1.0, 0.3), &ball, 2);
        }
        let particles = &mut simulation.world.particles;
        for (place, v) in particles.position.iter_mut().zip(&mut particles.velocity) {
            for x in &mut place[..dimension] {
                *x = 0.3 + 0.4 * number();
            }
            v[3] *= 0.5 + number();
        }
        // Debris far away makes a list of equal cells huge.
        particles.position[0][0] = 1e9;
        let world = &simulation.world;
        let radius = |p: usize| 0.5 * world.particles.velocity[p][3].powf(1.0 / dimension as f64);
        let of =
            |solid| (0..world.particles.len()).filter(move |p| world.particles.solid[*p] == solid);
        let mut all = [0.0; 3];
        for p in of(0) {
            for q in of(1) {
                let (a, b) = (world.particles.position[p], world.particles.position[q]);
                let away: [f64; 3] = std::array::from_fn(|axis| a[axis] - b[axis]);
                let distance = away.iter().map(|x| x * x).sum::<f64>().sqrt();
                let pen = radius(p) + radius(q) - distance;
                if pen > 0.0 {
                    all = [all[0] + 1.0, all[1] + pen, all[2] + away[0] / distance];
                }
            }
        }
        let mut pairs = Pairs::default();
        let found = world.ranks.vector(&pairs.sum(world, [0, 1], &Count).force);
        println!("{dimension}-D: {} pairs", all[0]);
        assert!(all[0] > 10.0);
        assert_eq!(found[0], all[0]);
        // Sums of some thousand terms below 1.
        assert!((found[1] - all[1]).abs() < 1e-11 && (found[2] - all[2]).abs() < 1e-10);
        let other: f64 = pairs.of_side(1).map(|(_, response)| response.force[0]).sum();
        assert_eq!(other, -all[0]);
    }
}

/// The two disks of the paper in total Lagrangian form, with any contact.
fn disks<S: ContactStyle + 'static>(style: S, cells: usize) -> Simulation {
    let mut simulation = super::scene::two_disks(
        cells,
        Default::default(),
        0.02 / cells as f64,
        linear(1000.0, 1000.0, 0.3),
    );
    let mut total = Simulation::new(domain(2, -0.5, 0.5, 1.0 / cells as f64), Outputs::silent());
    total.set_method(karamelo::method::Method { total: true, ..total.world.method });
    total.fixed_dt = simulation.fixed_dt;
    for (name, side) in [("ball1", -1.0), ("ball2", 1.0)] {
        let centre = [0.3 * side, 0.3 * side, 0.0];
        let disk = Sphere { dimension: 2, centre, radius: 0.2 };
        total.add_solid(name, "mat", linear(1000.0, 1000.0, 0.3), &disk, 2);
    }
    let particles = &mut total.world.particles;
    for (velocity, solid) in particles.velocity.iter_mut().zip(&particles.solid) {
        velocity[..2].fill(if *solid == 0 { 0.1 } else { -0.1 });
    }
    simulation.delete_fix("none");
    total.add_fix("touch", Box::new(Contact::of_solids([0, 1], style)));
    total
}

#[test]
fn momentum_stays_with_friction() {
    let mut simulation = disks(MinimizePenetration { friction: 0.3 }, 20);
    let particles = &mut simulation.world.particles;
    for ((x, v), solid) in
        particles.position.iter().zip(&mut particles.velocity).zip(&particles.solid)
    {
        let (side, spin) = if *solid == 0 { (-0.3, 1.0) } else { (0.3, 1.0) };
        v[0] -= spin * (x[1] - side);
        v[1] += spin * (x[0] - side);
    }
    let momentum_before = momentum(&simulation);
    simulation.run(Until::Time(2.5)).unwrap();
    let momentum_after = momentum(&simulation);
    let results = simulation.fixes[0].1.results(&simulation.world);
    println!("heat of friction {}", results[3]);
    let scale = 1000.0 * 0.13 * 0.1;
    for axis in 0..2 {
        let change = momentum_after[axis] - momentum_before[axis];
        assert!(change.abs() < 1e-12 * scale, "{change}");
    }
    assert!(results[3] > 0.0);
}

#[test]
fn an_impact_of_balls_takes_energy_and_gives_none() {
    // An adaptive dt falls by more than a half while the balls are squeezed together.
    let text = "h = 0.05
method(tlmpm, FLIP, linear, 1)
dimension(3, -1, 1, -1, 1, -1, 1, h)
region(r1, sphere, -0.22, 0, 0, 0.2)
region(r2, sphere, 0.22, h/4, h/5, 0.2)
material(m, linear, 1000, 1e3, 0.3)
solid(s1, region, r1, 2, m, h)
solid(s2, region, r2, 2, m, h)
group(g1, particles, region, r1, solid, s1)
group(g2, particles, region, r2, solid, s2)
fix(v1, initial_velocity_particles, g1, v, 0, 0)
fix(v2, initial_velocity_particles, g2, -v, 0, 0)
fix(touch, contact/minimize_penetration, s1, s2, 0)
compute(W, energy_ledger, all)
log_modify(custom, time, dt, touch_x, W_kinetic, W_external)
set_output(1)
dt_factor(0.5)
run_time(0.2/v)
";
    for speed in [0.1, 0.2, 0.3] {
        let played = Script::new("balls", &format!("v = {speed}\n{text}")).play(&[]);
        played.end.as_ref().expect("the run is stable");
        let [dt, work] = ["dt", "W_external"].map(|name| played.column(name));
        let before = played.column("W_kinetic")[0];
        let largest = work.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b)) / before;
        let end = work[work.len() - 1] / before;
        println!("v = {speed}: contact gives at most {largest:.1e}, takes {:.3}", -end);
        let shortest = dt.iter().skip(1).fold(f64::INFINITY, |a, b| a.min(*b));
        assert!(shortest < 0.75 * dt[1] && end < 0.0);
        // Springs that only soften take energy while they are pressed and never give more back.
        // Springs that stiffen as dt falls gave 0.027 of it at v = 0.1 and 0.86 at 0.3.
        assert!(largest < 1e-6, "{speed}: {largest}");
    }
}
