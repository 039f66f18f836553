//! V17: shocks in ideal gases, Sod's tube and Noh's implosion.

use super::scene::{domain, energies};
use super::script::{Played, Script};
use karamelo::eos::Eos;
use karamelo::eos::ideal_gas::IdealGas;
use karamelo::material::eos_strength::EosStrength;
use karamelo::material::{Chunk, Lane, State};
use karamelo::model::column::Column;
use karamelo::output::Outputs;
use karamelo::region::Bounds;
use karamelo::region::block::Block;
use karamelo::shape::ShapeKind;
use karamelo::simulation::{Simulation, Until};
use karamelo::strength::fluid::Fluid;
use karamelo::world::World;
use std::sync::Arc;

/// A particle at the end of a run.
struct Parcel {
    /// Distance from the origin, over the first axes.
    place: f64,
    volume: f64,
    mass: f64,
    speed: f64,
    pressure: f64,
    energy: f64,
}

impl Parcel {
    fn density(&self) -> f64 {
        self.mass / self.volume
    }
}

/// The particles, with their distance from the origin.
fn parcels(world: &World) -> Vec<Parcel> {
    let particles = &world.particles;
    let [jacobian, energy] =
        [Column::J, Column::InternalEnergy].map(|column| particles.column(column));
    let each = |p: usize| {
        let [x, y, z, mass] = particles.position[p];
        let [u, v, w, volume] = particles.velocity[p];
        Parcel {
            place: x.hypot(y).hypot(z),
            volume: jacobian[p] * volume,
            mass,
            speed: u.hypot(v).hypot(w),
            pressure: -world.stress(p).trace() / 3.0,
            energy: energy[p] * volume / mass,
        }
    };
    (0..particles.len()).map(each).collect()
}

/// Means by volume of density, pressure, and by mass of speed and specific energy.
fn means(parcels: &[Parcel], range: [f64; 2]) -> [f64; 4] {
    let inside = |parcel: &&Parcel| parcel.place > range[0] && parcel.place < range[1];
    let (mut volume, mut mass, mut sums) = (0.0, 0.0, [0.0; 3]);
    for parcel in parcels.iter().filter(inside) {
        volume += parcel.volume;
        mass += parcel.mass;
        sums[0] += parcel.volume * parcel.pressure;
        sums[1] += parcel.mass * parcel.speed;
        sums[2] += parcel.mass * parcel.energy;
    }
    assert!(volume > 0.0, "no particle between {range:?}");
    [mass / volume, sums[0] / volume, sums[1] / mass, sums[2] / mass]
}

const GAMMA: f64 = 1.4;
/// Where the waves are at t = 0.2: head and tail of the fan, contact, shock.
const WAVES: [f64; 4] = [0.2633568, 0.4859454, 0.6854905, 0.8504311];
/// Density, pressure, speed, specific energy left and right of the contact.
const PLATEAUS: [[f64; 4]; 2] = [
    [0.42631942818, 0.30313017805, 0.92745262005, 1.77760006942],
    [0.26557371171, 0.30313017805, 0.92745262005, 2.85354088799],
];

/// Density of Sod's tube at t = 0.2.
fn density(x: f64) -> f64 {
    let [head, tail, contact, shock] = WAVES;
    if x < head {
        1.0
    } else if x < tail {
        let sound = GAMMA.sqrt();
        let ratio = (2.0 - (GAMMA - 1.0) * (x - 0.5) / (0.2 * sound)) / (GAMMA + 1.0);
        ratio.powf(2.0 / (GAMMA - 1.0))
    } else if x < contact {
        PLATEAUS[0][0]
    } else if x < shock {
        PLATEAUS[1][0]
    } else {
        0.125
    }
}

#[derive(Debug)]
struct Sod {
    /// Largest relative error of the plateaus' means over the inner 60 %.
    plateau: [[f64; 4]; 2],
    /// sum V |rho - exact|.
    density: f64,
    /// Change of the total energy over that of the start.
    energy: f64,
}

fn measure(played: &Played) -> Sod {
    if let Err(end) = &played.end {
        panic!("{end}");
    }
    let parcels = parcels(&played.session.simulation.world);
    let relative = |side: usize| {
        let (from, to) = (WAVES[side + 1], WAVES[side + 2]);
        let inner = [from + 0.2 * (to - from), to - 0.2 * (to - from)];
        let found = means(&parcels, inner);
        std::array::from_fn(|k| found[k] / PLATEAUS[side][k] - 1.0)
    };
    let error = |parcel: &Parcel| parcel.volume * (parcel.density() - density(parcel.place)).abs();
    let total = played.column("E");
    Sod {
        plateau: [relative(0), relative(1)],
        density: parcels.iter().map(error).sum(),
        energy: total.last().unwrap() / total[0] - 1.0,
    }
}

fn tube(cells: f64) -> Sod {
    measure(&Script::input("shock-tube/shock-tube.mpm").play(&[("cells", cells)]))
}

/// Largest relative error of the plateaus.
fn worst(sod: &Sod) -> f64 {
    sod.plateau.iter().flatten().fold(0.0, |worst: f64, error| worst.max(error.abs()))
}

#[test]
fn sods_plateaus_and_the_order_of_the_density() {
    let [coarse, middle, fine] = [100.0, 200.0, 400.0].map(tube);
    println!("V17 Sod on 200 cells: {middle:.4?}");
    assert!(worst(&middle) < 0.02, "{middle:?}");
    let orders =
        [(&coarse, &middle), (&middle, &fine)].map(|(a, b)| (a.density / b.density).log2());
    println!(
        "V17 Sod L1 {:.2e}, {:.2e}, {:.2e}; orders {orders:.2?}",
        coarse.density, middle.density, fine.density
    );
    // At contact and shock the error is a jump over a number of cells: 1; the contact spreads.
    assert!((coarse.density / fine.density).log2() / 2.0 > 0.7, "{orders:?}");
    // The step is of first order in the energy: a shock of strength 3 in 20 cells.
    assert!(middle.energy.abs() < 2e-3, "{middle:?}");
}

#[test]
fn the_ledger_of_the_tube_closes_and_holds_its_internal_energy() {
    let played = Script::input("shock-tube/shock-tube.mpm").with_ledger().play(&[]);
    let last = |name: &str| *played.column(name).last().unwrap();
    let internal = energies(&played.session.simulation)[1];
    let booked = last("W_stored") + last("W_viscous") + last("W_plastic");
    println!(
        "V17 Sod: ledger error {:.1e}, viscous {:.3e}, stored and lost {booked:.5} of {internal:.5}",
        last("W_error"),
        last("W_viscous")
    );
    // Both are sums over steps of a centred force times a rate of one end: first order in dt.
    assert!(last("W_error").abs() < 0.01 && last("W_viscous") > 0.0);
    assert!((booked / internal - 1.0).abs() < 0.01, "{booked} {internal}");
}

#[test]
fn hats_that_cross_cells_miss_sods_plateaus() {
    let script = Script::input("shock-tube/shock-tube.mpm")
        .statement("method(", "method(ulmpm, FLIP, linear, 1)");
    let found = measure(&script.play(&[]));
    assert!(worst(&found) > 0.1, "{found:?}");
}

/// An ideal gas whose energy is not fed by its viscosity.
struct Unfed(IdealGas);

impl Eos for Unfed {
    fn density(&self) -> f64 {
        self.0.density()
    }

    fn bulk(&self) -> f64 {
        self.0.bulk()
    }

    fn initial_energy(&self) -> Option<f64> {
        self.0.initial_energy()
    }

    fn pressure(&self, chunk: &mut Chunk<'_>, heated: bool, pressure: &mut Lane) {
        IdealGas { quadratic: 0.0, linear: 0.0, ..self.0 }.pressure(chunk, heated, pressure);
        for p in 0..chunk.state.len {
            let rate = (-chunk.velocity_gradient(p).trace()).max(0.0);
            let scale = self.0.density / chunk.state.value(Column::J, p) * chunk.cell * rate;
            pressure[p / 4][p % 4] += scale * self.0.quadratic * chunk.cell * rate;
        }
    }

    fn stiffness(&self, state: &State, stiffness: &mut Lane) {
        self.0.stiffness(state, stiffness);
    }

    fn stiffen(&self, chunk: &Chunk<'_>, speed: &mut Lane) {
        self.0.stiffen(chunk, speed);
    }
}

/// Noh's cold gas.
fn cold() -> IdealGas {
    IdealGas { density: 1.0, exponent: 5.0 / 3.0, pressure: 0.0, quadratic: 2.0, linear: 0.5 }
}

/// Two cold streams that meet at x = 0 with speed 1, at t = 0.6: density and pressure in the outer
/// half of the shocked region over the exact ones, 4 and 4/3; change of the energy over 1/2.
fn streams(
    eos: impl Eos + 'static,
    (total, shape): (bool, ShapeKind),
    dt_factor: f64,
) -> Option<[f64; 3]> {
    let cells = 200.0;
    let mut simulation = Simulation::new(domain(1, -1.0, 1.0, 1.0 / cells), Outputs::silent());
    let mut method = simulation.world.method;
    (method.total, method.shape) = (total, shape);
    simulation.set_method(method);
    simulation.dt_factor = dt_factor;
    let law = EosStrength {
        eos: Arc::new(eos),
        strength: Arc::new(Fluid { viscosity: 0.0 }),
        damage: None,
        temperature: None,
    };
    simulation.add_solid("gas", "gas", Arc::new(law), &Block(Bounds::EVERYWHERE), 2);
    let particles = &mut simulation.world.particles;
    for (velocity, position) in particles.velocity.iter_mut().zip(&particles.position) {
        velocity[0] = -position[0].signum();
    }
    let before: f64 = energies(&simulation).iter().sum();
    simulation.run(Until::Time(0.6)).ok()?;
    let found = means(&parcels(&simulation.world), [0.1, 0.2]);
    let after: f64 = energies(&simulation).iter().sum();
    Some([found[0] / 4.0 - 1.0, found[1] * 0.75 - 1.0, after / before - 1.0])
}

#[test]
fn two_cold_streams_stop_each_other_as_noh_says() {
    for way in [(false, ShapeKind::Quadratic), (false, ShapeKind::Cubic)] {
        let found = streams(cold(), way, 0.3).expect("the run is stable");
        println!("V17 Noh 1-D, total and shape {way:?}: rho, p, energy {found:.4?}");
        assert!(found[0].abs() < 0.05 && found[1].abs() < 0.05, "{found:?}");
    }
}

#[test]
fn the_energy_a_step_adds_to_a_cold_shock_falls_with_the_step() {
    // Viscosity is taken at the end of a step, forces at its start: first order.
    let [coarse, fine] = [0.6, 0.15]
        .map(|factor| streams(cold(), (false, ShapeKind::Quadratic), factor).unwrap()[2]);
    println!("V17 Noh 1-D energy: {coarse:.4}, {fine:.4} with a quarter of the step");
    assert!(fine.abs() < 0.5 * coarse.abs(), "{coarse} {fine}");
}

#[test]
fn a_gas_whose_viscosity_does_not_heat_it_collapses() {
    // Nothing but viscosity resists: the streams pile up at the origin, ever denser, and no shock
    // reaches the place of the plateau.
    let found = streams(Unfed(cold()), (false, ShapeKind::Quadratic), 0.3);
    println!("V17 Noh 1-D without heat: {found:.4?}");
    assert!(found.is_none_or(|[density, ..]| density.abs() > 0.05), "{found:?}");
}

/// Noh's implosion of a unit cylinder or sphere of cold gas; `shape` is its region.
fn implosion(dimension: u8, box_and_shape: &str, velocity: &str) -> Script {
    let walls = ["-INF, h/4", "INF, INF, -INF, h/4", "INF, INF, INF, INF, -INF, h/4"];
    let walls: String = (0..usize::from(dimension))
        .map(|axis| {
            let zeros: Vec<&str> =
                (0..3).map(|other| if other == axis { "0" } else { "NULL" }).collect();
            let all = format!("{}{}", walls[axis], ", INF".repeat(4 - 2 * axis));
            let name = ["wx", "wy", "wz"][axis];
            format!(
                "region({name}, block, {all})\ngroup({name}, nodes, region, {name}, all)\n\
                 fix({name}, velocity_nodes, {name}, {})\n",
                zeros[..usize::from(dimension)].join(", ")
            )
        })
        .collect();
    let text = format!(
        "cells = 100\nh = 1/cells\nQ1 = 1\nQ2 = 0.2\nmethod(ulmpm, FLIP, quadratic-spline, 1)\n\
         {box_and_shape}\neos(gas, ideal-gas, 1, 5/3, 0, Q1, Q2)\nstrength(none, fluid, 0)\n\
         material(gas, eos-strength, gas, none)\nsolid(gas, region, all, 2, gas, h)\n{walls}\
         fix(v, initial_velocity_particles, all, {velocity})\nset_output(0)\n\
         dt_factor(0.3)\nrun_time(0.6)\n"
    );
    Script::new("noh.mpm", &text)
}

/// The cylinder as a wedge of three rows of cells round the axis.
fn cylinder() -> Script {
    let shape = "dimension(2, 0, 1, 0, 3*h, h)\naxisymmetric(true)\nregion(all, block, 0, 1, 0, 3*h)\n\
                 region(top, block, INF, INF, 3*h - h/4, INF)";
    implosion(2, shape, "-1, 0").replace(
        "set_output(0)\n",
        "group(top, nodes, region, top, all)\nfix(top, velocity_nodes, top, NULL, 0)\nset_output(0)\n",
    )
}

/// Errors of density and pressure in the outer half of the shocked region.
fn outer_half(played: &Played, exact: f64, cylinder: bool) -> [f64; 2] {
    if let Err(end) = &played.end {
        panic!("{end}");
    }
    let mut parcels = parcels(&played.session.simulation.world);
    if cylinder {
        let position = &played.session.simulation.world.particles.position;
        parcels.iter_mut().zip(position).for_each(|(parcel, x)| parcel.place = x[0]);
    }
    let found = means(&parcels, [0.1, 0.2]);
    [found[0] / exact - 1.0, 3.0 * found[1] / exact - 1.0]
}

#[test]
fn a_cold_cylinder_implodes_as_noh_says() {
    let [coarse, middle, fine] = [100.0, 200.0, 400.0]
        .map(|cells| outer_half(&cylinder().play(&[("cells", cells)]), 16.0, true));
    println!("V17 Noh, cylinder: rho, p {coarse:.4?} {middle:.4?} {fine:.4?}");
    // Viscosity heats the gas that streams in too, by a part that falls with h.
    assert!(fine[0].abs() < 0.05 && fine[1].abs() < 0.05, "{fine:?}");
    assert!((coarse[0] / fine[0]).abs() > 2.0, "{coarse:?} {fine:?}");
}

/// The unit sphere, as a body of revolution or as an octant.
fn sphere(dimension: u8) -> Script {
    let [shape, velocity] = match dimension {
        2 => [
            "dimension(2, 0, 1, 0, 1, h)\naxisymmetric(true)\nregion(all, sphere, 0, 0, 1)",
            "-x/hypot(x, y), -y/hypot(x, y)",
        ],
        _ => [
            "dimension(3, 0, 1, 0, 1, 0, 1, h)\nregion(all, sphere, 0, 0, 0, 1)\n\
             r = hypot(hypot(x, y), z)",
            "-x/r, -y/r, -z/r",
        ],
    };
    implosion(dimension, shape, velocity)
}

#[test]
#[ignore = "half a minute: 31 thousand particles, 3500 steps"]
fn a_cold_sphere_implodes_as_noh_says_in_the_limit() {
    let [coarse, fine] =
        [100.0, 200.0].map(|cells| outer_half(&sphere(2).play(&[("cells", cells)]), 64.0, false));
    let order = (coarse[0] / fine[0]).log2();
    println!("V17 Noh, sphere: rho, p {coarse:.4?} {fine:.4?}, order {order:.2}");
    // What streams in is heated by viscosity before the shock; the error is of first order in h.
    assert!(order > 0.7, "{order}");
    let limit = 2.0 * fine[0] - coarse[0];
    assert!(limit.abs() < 0.1, "{limit}");
}

#[test]
#[ignore = "half a minute: 113 thousand particles"]
fn an_octant_implodes_as_the_sphere_of_revolution_does() {
    let [turned, octant] =
        [2, 3].map(|d| outer_half(&sphere(d).play(&[("cells", 30.0)]), 64.0, false));
    println!("V17 Noh on 30 cells: of revolution {turned:.4?}, octant {octant:.4?}");
    // Six cells across the shocked region do not resolve it: both miss the plateau alike.
    let ratio = (1.0 + turned[0]) / (1.0 + octant[0]);
    assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
}
