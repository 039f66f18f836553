//! A fix of one's own: a drag force that grows with the velocity of the nodes.
//!
//! `cargo run --release --example new_fix` compares a disk with and without it. In the program a
//! fix is one file under `src/fix` with a `STYLE` row in the table `FIXES`; the trait is the same.

use karamelo::compute::energy::kinetic_energy;
use karamelo::fault::Fault;
use karamelo::fix::Fix;
use karamelo::material::Elastic;
use karamelo::material::linear::Linear;
use karamelo::model::domain::Domain;
use karamelo::model::group::GroupId;
use karamelo::output::Outputs;
use karamelo::region::sphere::Sphere;
use karamelo::simulation::{Simulation, Until};
use karamelo::step::{Stage, Step};
use std::sync::Arc;

/// mb_I -= c p_I with the nodal momentum p_I: viscous drag of rate c \[1/T\].
struct Drag {
    rate: f64,
}

impl Fix for Drag {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::PostParticlesToGrid] // H2: momentum, mass and force are known
    }

    fn apply(&mut self, _stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        let grid = &mut step.world.grid;
        for node in grid.runs.iter().cloned().flatten() {
            let momentum = grid.nodes[node].motion;
            for axis in 0..3 {
                grid.nodes[node].change[axis] -= self.rate * momentum[axis];
            }
        }
        Ok(())
    }
}

/// Kinetic energy left of a flying disk after one unit of time.
fn energy_left(rate: f64) -> Result<f64, Fault> {
    let domain = Domain { dimension: 2, lower: [0.0; 3], upper: [1.0, 1.0, 0.0], cell: 0.05 };
    let mut simulation = Simulation::new(domain, Outputs::silent());
    let law = Arc::new(Linear(Elastic::new(1000.0, 1e4, 0.3)));
    let disk = Sphere { dimension: 2, centre: [0.4, 0.5, 0.0], radius: 0.2 };
    simulation.add_solid("disk", "rubber", law, &disk, 2);
    for velocity in &mut simulation.world.particles.velocity {
        velocity[0] = 0.2;
    }
    simulation.add_fix("drag", Box::new(Drag { rate }));
    let before = kinetic_energy(&simulation.world, GroupId::ALL);
    simulation.run(Until::Time(1.0))?;
    Ok(kinetic_energy(&simulation.world, GroupId::ALL) / before)
}

fn main() -> Result<(), Fault> {
    for rate in [0.0, 0.5, 1.0] {
        let (left, exact) = (energy_left(rate)?, f64::exp(-2.0 * rate));
        println!("c = {rate}: {left:.4} of the energy is left, exp(-2 c) = {exact:.4}");
        assert!((left / exact - 1.0).abs() < 0.02);
    }
    Ok(())
}
