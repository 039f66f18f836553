//! A step allocates nothing.

use karamelo::compute::energy_ledger::EnergyLedger;
use karamelo::material::linear::Linear;
use karamelo::material::rigid::Rigid;
use karamelo::material::{Elastic, Law, Thermal};
use karamelo::method::Method;
use karamelo::model::contact::{Contact, Rule};
use karamelo::model::domain::Domain;
use karamelo::output::Outputs;
use karamelo::region::Bounds;
use karamelo::region::block::Block;
use karamelo::region::sphere::Sphere;
use karamelo::scheme::{Scheme, musl::Musl, usf::Usf, usl::Usl};
use karamelo::shape::ShapeKind;
use karamelo::simulation::{Simulation, Until};
use karamelo::transfer::{Transfer, TransferKind};
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

/// A shearing disk or torus, run in the given way.
fn disk(
    axisymmetric: bool,
    total: bool,
    shape: ShapeKind,
    transfer: Transfer,
    scheme: &'static dyn Scheme,
) -> Simulation {
    let [lower, upper] = [[0.0; 3], [1.0, 1.0, 0.0]];
    let domain = Domain { dimension: 2, lower, upper, cell: 0.05 };
    let mut simulation = Simulation::new(domain, Outputs::silent());
    let averaged_dilation = shape != ShapeKind::Linear;
    let conducts_heat = true;
    let method = Method { total, shape, averaged_dilation, axisymmetric, conducts_heat };
    simulation.set_method(method);
    simulation.set_scheme(scheme);
    simulation.transfer = transfer;
    let disk = Sphere { dimension: 2, centre: [0.5, 0.5, 0.0], radius: 0.3 };
    let thermal = Thermal { capacity: 10.0, conductivity: 1.0 };
    let law = Arc::new(Linear(Elastic { thermal, ..Elastic::new(1000.0, 1e4, 0.3) }));
    simulation.add_solid("disk", "mat", law, &disk, 2);
    let particles = &mut simulation.world.particles;
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = 0.1 * (x[1] - 0.5);
    }
    simulation
}

#[test]
fn the_energy_ledger_allocates_no_more_in_longer_runs() {
    let transfer = Transfer::new(TransferKind::Flip, 0.99);
    for total in [false, true] {
        let mut simulation = disk(false, total, ShapeKind::Linear, transfer, &Musl);
        simulation.add_compute("W", Box::new(EnergyLedger::default()));
        allocations(&mut simulation, 10);
        let short = allocations(&mut simulation, 10);
        let long = allocations(&mut simulation, 100);
        assert!(simulation.world.ledger.open && long <= short, "{long} > {short}");
    }
}

#[test]
fn longer_runs_allocate_no_more_than_shorter_ones() {
    use TransferKind::{Asflip, Flip, Mls, Xpic};
    let ways: [(bool, ShapeKind, Transfer, &'static dyn Scheme); 5] = [
        (false, ShapeKind::Linear, Transfer::new(Flip, 1.0), &Musl),
        (false, ShapeKind::Cubic, Transfer::new(Mls, 0.0), &Usl),
        (false, ShapeKind::Quadratic, Transfer::new(Xpic(3), 0.0), &Usf),
        (true, ShapeKind::Bernstein, Transfer::new(Asflip, 0.99), &Musl),
        (true, ShapeKind::Linear, Transfer::new(Flip, 1.0), &Musl),
    ];
    for (total, shape, transfer, scheme) in ways {
        for axisymmetric in [false, true] {
            let mut simulation = disk(axisymmetric, total, shape, transfer, scheme);
            allocations(&mut simulation, 10);
            let short = allocations(&mut simulation, 10);
            let long = allocations(&mut simulation, 100);
            println!("{shape:?} {transfer:?}: {short} allocations in 10 steps, {long} in 100");
            assert!(long <= short, "{shape:?} {transfer:?}: {long} > {short}");
        }
    }
}

/// A disk that slides and rolls over a floor, rigid or not, with the ledger.
fn on_a_floor(rigid: bool, transfer: Transfer, scheme: &'static dyn Scheme) -> Simulation {
    let mut simulation = disk(false, false, ShapeKind::Quadratic, transfer, scheme);
    let floor = Block(Bounds { lower: [0.0, 0.1, 0.0], upper: [1.0, 0.2, 0.0] });
    let law: Arc<dyn Law> = match rigid {
        true => Arc::new(Rigid { density: 0.0 }),
        false => Arc::new(Linear(Elastic::new(1000.0, 1e4, 0.3))),
    };
    simulation.add_solid("floor", "other", law, &floor, 2);
    let particles = &mut simulation.world.particles;
    for (v, solid) in particles.velocity.iter_mut().zip(&particles.solid) {
        if *solid == 0 {
            v[1] = -0.02;
        }
    }
    simulation.add_contact(Contact {
        name: "touch".to_string(),
        rule: Rule::Frictional(0.3),
        solids: Some([0, 1]),
        touching: true,
        force: Default::default(),
        heat: Default::default(),
    });
    simulation.add_compute("W", Box::new(EnergyLedger::default()));
    simulation
}

#[test]
fn contact_allocates_no_more_in_longer_runs() {
    let ways: [(Transfer, &'static dyn Scheme); 3] = [
        (Transfer::new(TransferKind::Flip, 0.99), &Musl),
        (Transfer::new(TransferKind::Apic, 0.0), &Usl),
        (Transfer::new(TransferKind::Xpic(2), 0.0), &Usf),
    ];
    for ((transfer, scheme), rigid) in ways.into_iter().flat_map(|way| [(way, false), (way, true)])
    {
        let mut simulation = on_a_floor(rigid, transfer, scheme);
        allocations(&mut simulation, 100);
        let short = allocations(&mut simulation, 10);
        let long = allocations(&mut simulation, 100);
        println!("{transfer:?}, rigid {rigid}: {short} allocations in 10 steps, {long} in 100");
        assert!(!simulation.world.grid.couples.is_empty());
        assert!(long <= short, "{transfer:?}, rigid {rigid}: {long} > {short}");
    }
}
