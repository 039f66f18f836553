//! A step allocates nothing.

use karamelo::material::Elastic;
use karamelo::material::linear::Linear;
use karamelo::model::domain::Domain;
use karamelo::output::Outputs;
use karamelo::region::sphere::Sphere;
use karamelo::simulation::{Simulation, Until};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

struct Counting;

thread_local! {
    /// Calls of this thread; the test's own harness allocates on others.
    static CALLS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        CALLS.set(CALLS.get() + 1);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, start: *mut u8, layout: Layout) {
        unsafe { System.dealloc(start, layout) }
    }
    unsafe fn realloc(&self, start: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        CALLS.set(CALLS.get() + 1);
        unsafe { System.realloc(start, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(simulation: &mut Simulation, steps: u64) -> usize {
    let before = CALLS.get();
    simulation.run(Until::Steps(steps)).unwrap();
    CALLS.get() - before
}

#[test]
fn longer_runs_allocate_no_more_than_shorter_ones() {
    let [lower, upper] = [[0.0; 3], [1.0, 1.0, 0.0]];
    let domain = Domain { dimension: 2, lower, upper, cell: 0.05 };
    let mut simulation = Simulation::new(domain, Outputs::silent());
    let disk = Sphere { dimension: 2, centre: [0.5, 0.5, 0.0], radius: 0.3 };
    let law = Arc::new(Linear(Elastic::new(1000.0, 1e4, 0.3)));
    simulation.add_solid("disk", "mat", law, &disk, 2);
    for (v, x) in
        simulation.world.particles.velocity.iter_mut().zip(&simulation.world.particles.position)
    {
        v[0] = 0.1 * (x[1] - 0.5);
    }
    allocations(&mut simulation, 10);
    let short = allocations(&mut simulation, 10);
    let long = allocations(&mut simulation, 100);
    println!("allocations: {short} in a run of 10 steps, {long} in a run of 100");
    assert!(long <= short);
}
