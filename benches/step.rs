//! Time of a step: `cargo bench`. Elements are particle-steps.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use karamelo::material::Elastic;
use karamelo::material::linear::Linear;
use karamelo::model::domain::Domain;
use karamelo::output::Outputs;
use karamelo::region::Bounds;
use karamelo::region::block::Block;
use karamelo::simulation::{Simulation, Until};
use std::sync::Arc;

/// An elastic square or cube of `cells` cells along an edge, shaken by a shear.
fn block(dimension: usize, cells: usize) -> Simulation {
    let h = 1.0 / cells as f64;
    let corner = |x: f64| std::array::from_fn(|a| if a < dimension { x } else { 0.0 });
    let domain =
        Domain { dimension, lower: corner(-4.0 * h), upper: corner(1.0 + 4.0 * h), cell: h };
    let mut simulation = Simulation::new(domain, Outputs::silent());
    let law = Arc::new(Linear(Elastic::new(1000.0, 1000.0, 0.3)));
    let body = Block(Bounds { lower: corner(0.0), upper: corner(1.0) });
    simulation.add_solid("block", "elastic", law, &body, 2);
    let particles = &mut simulation.world.particles;
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        for axis in 0..dimension {
            v[axis] = 0.02 * (3.0 * x[(axis + 1) % dimension]).sin();
        }
    }
    simulation
}

fn steps(criterion: &mut Criterion) {
    const STEPS: u64 = 10;
    let mut group = criterion.benchmark_group("ten steps");
    group.sample_size(10);
    for (name, dimension, cells) in [("2-D, 74 k", 2, 136), ("3-D, 74 k", 3, 21)] {
        let mut simulation = block(dimension, cells);
        group.throughput(Throughput::Elements(STEPS * simulation.world.particles.len() as u64));
        group.bench_function(name, |bencher| {
            bencher.iter(|| simulation.run(Until::Steps(STEPS)));
        });
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
