//! Builds and runs a scene without a script.
//!
//! `cargo run --release --example run_from_code` throws a disk against a wall and prints its
//! energies.

use karamelo::compute::energy::{kinetic_energy, strain_energy};
use karamelo::fault::Fault;
use karamelo::fix::components::Components;
use karamelo::fix::velocity_nodes::VelocityNodes;
use karamelo::material::Elastic;
use karamelo::material::neo_hookean::NeoHookean;
use karamelo::model::domain::Domain;
use karamelo::model::group::GroupId;
use karamelo::output::Outputs;
use karamelo::region::Bounds;
use karamelo::region::block::Block;
use karamelo::region::sphere::Sphere;
use karamelo::script::formula::Formula;
use karamelo::simulation::{Simulation, Until};
use std::sync::Arc;

fn main() -> Result<(), Fault> {
    let h = 0.05;
    let domain = Domain { dimension: 2, lower: [0.0; 3], upper: [1.0, 1.0, 0.0], cell: h };
    let mut simulation = Simulation::new(domain, Outputs::silent());

    let law = Arc::new(NeoHookean(Elastic::new(1000.0, 1e4, 0.3)));
    let disk = Sphere { dimension: 2, centre: [0.4, 0.5, 0.0], radius: 0.2 };
    let particles = simulation.add_solid("disk", "rubber", law, &disk, 2);
    for velocity in &mut simulation.world.particles.velocity {
        velocity[0] = -0.5;
    }

    let mut wall = Bounds::EVERYWHERE;
    wall.upper[0] = 0.25 * h;
    simulation.add_node_group("wall", Arc::new(Block(wall)), None);
    let still = Components::new("wall", [Some(Formula::constant(0.0)), None, None]);
    simulation.add_fix("wall", Box::new(VelocityNodes::new(GroupId(1), still)));

    println!("{particles} particles");
    for _ in 0..10 {
        simulation.run(Until::Time(0.1))?;
        let world = &simulation.world;
        let kinetic = kinetic_energy(world, GroupId::ALL);
        let stored = strain_energy(world, GroupId::ALL);
        println!("t = {:.1}  Ek = {kinetic:.4}  Es = {stored:.4}", simulation.clock.time);
    }
    Ok(())
}
