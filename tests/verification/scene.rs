//! Small scenes, built from code.

use karamelo::compute::energy;
use karamelo::material::linear::Linear;
use karamelo::material::{Elastic, Law, StressRate};
use karamelo::model::domain::Domain;
use karamelo::model::group::GroupId;
use karamelo::output::Outputs;
use karamelo::region::sphere::Sphere;
use karamelo::simulation::{Simulation, Until};
use std::sync::Arc;

/// A box from `lower` to `upper` on the first axes.
pub fn domain(dimension: usize, lower: f64, upper: f64, cell: f64) -> Domain {
    let corner = |value: f64| std::array::from_fn(|a| if a < dimension { value } else { 0.0 });
    Domain { dimension, lower: corner(lower), upper: corner(upper), cell }
}

/// A hypoelastic law.
pub fn linear(density: f64, young: f64, poisson: f64) -> Arc<dyn Law> {
    Arc::new(Linear(Elastic::new(density, young, poisson)))
}

/// The paper's two disks on `cells` x `cells` cells.
pub fn two_disks(cells: usize, rate: StressRate, dt: f64, law: Arc<dyn Law>) -> Simulation {
    let domain = domain(2, -0.5, 0.5, 1.0 / cells as f64);
    let mut simulation = Simulation::new(domain, Outputs::silent());
    simulation.set_rate(rate);
    simulation.fixed_dt = Some(dt);
    for (name, side) in [("ball1", -1.0), ("ball2", 1.0)] {
        let centre = [0.3 * side, 0.3 * side, 0.0];
        let disk = Sphere { dimension: 2, centre, radius: 0.2 };
        simulation.add_solid(name, "mat", law.clone(), &disk, 2);
    }
    let particles = &mut simulation.world.particles;
    for (velocity, solid) in particles.velocity.iter_mut().zip(&particles.solid) {
        let speed = if *solid == 0 { 0.1 } else { -0.1 };
        velocity[..2].fill(speed);
    }
    simulation
}

/// Runs so many steps.
pub fn steps(simulation: &mut Simulation, count: u64) {
    simulation.run(Until::Steps(count)).expect("the run is stable");
}

/// Kinetic and stored energy of everything.
pub fn energies(simulation: &Simulation) -> [f64; 2] {
    let world = &simulation.world;
    [energy::kinetic_energy(world, GroupId::ALL), energy::strain_energy(world, GroupId::ALL)]
}

/// Total momentum.
pub fn momentum(simulation: &Simulation) -> [f64; 3] {
    let particles = &simulation.world.particles;
    let mut sum = [0.0; 3];
    for (position, velocity) in particles.position.iter().zip(&particles.velocity) {
        for (sum, v) in sum.iter_mut().zip(velocity) {
            *sum += position[3] * v;
        }
    }
    sum
}
