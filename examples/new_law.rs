//! A law of one's own: St. Venant-Kirchhoff elasticity, the simplest law of the whole strain.
//!
//! `cargo run --release --example new_law` holds it to a closed form and to its own energy, and plays a
//! disk that swings. The manual's chapter "Adding a law" takes this file into the program.

use karamelo::compute::energy::{kinetic_energy, strain_energy};
use karamelo::fault::Fault;
use karamelo::material::point::Point;
use karamelo::material::state::{PLACES, STRESS};
use karamelo::material::{Chunk, Description, Elastic, Lane, Law, State, StressRate, write_strain};
use karamelo::math::tensor::Tensor;
use karamelo::model::column::{Column, ColumnSet};
use karamelo::model::domain::Domain;
use karamelo::model::group::GroupId;
use karamelo::output::Outputs;
use karamelo::region::sphere::Sphere;
use karamelo::simulation::{Simulation, Until};
use std::sync::Arc;

/// sigma = F S F^T/J with S = lambda tr E I + 2 G E and E = (F^T F - I)/2.
///
/// # Source  Bonet and Wood 2008, section 6.4.1
struct SaintVenantKirchhoff(Elastic);

/// E = (F^T F - I)/2 of particle `p`.
fn strain(state: &State, p: usize) -> Tensor {
    let f = state.deformation(p);
    (f.transpose() * f - Tensor::identity()) * 0.5
}

impl Law for SaintVenantKirchhoff {
    fn columns(&self, dimension: usize) -> ColumnSet {
        let mut columns = ColumnSet::default();
        columns.extend(Column::stress(dimension));
        columns
    }

    fn is_incremental(&self) -> bool {
        false // the stress follows from F: no rate has to turn it
    }

    fn density(&self) -> f64 {
        self.0.density
    }

    fn moduli(&self) -> [f64; 2] {
        [self.0.bulk(), self.0.shear]
    }

    fn reference_wave_speed(&self) -> f64 {
        self.0.wave_speed()
    }

    fn update(&self, chunk: &mut Chunk<'_>) {
        let Elastic { lambda, shear, .. } = self.0;
        let state = &mut *chunk.state;
        for p in 0..state.len {
            let (e, f) = (strain(state, p), state.deformation(p));
            let s = Tensor::identity() * (lambda * e.trace()) + e * (2.0 * shear);
            let sigma = f * s * f.transpose() / state.value(Column::J, p);
            for (column, place) in STRESS.into_iter().zip(PLACES) {
                if state.has(column) {
                    state.set_value(column, p, sigma[place]);
                }
            }
        }
    }

    /// At most sqrt(s^2 ((lambda + 2 G)(3 s^2 - 1)/2 + lambda (s^2 - 1))/rho0), s the largest singular
    /// value of F, at least 1: the tangent along it, with the others as large.
    fn wave_speed(&self, state: &State, out: &mut Lane) {
        let Elastic { density, lambda, shear, .. } = self.0;
        for p in 0..state.len {
            let square = f64::max(1.0, state.deformation(p).singular_values()[0].powi(2));
            let tangent = (lambda + 2.0 * shear) * (1.5 * square - 0.5) + lambda * (square - 1.0);
            out[p / 4][p % 4] = (square * tangent / density).sqrt();
        }
    }

    /// W = lambda/2 (tr E)^2 + G E : E.
    fn stored_energy(&self, state: &State, out: &mut Lane) {
        for p in 0..state.len {
            let e = strain(state, p);
            out[p / 4][p % 4] = 0.5 * self.0.lambda * e.trace().powi(2) + self.0.shear * e.dot(&e);
        }
    }

    fn elastic_strain(&self, state: &State, out: &mut [Lane; 6]) {
        write_strain(state, out, |p| strain(state, p));
    }

    fn accepts_initial_stress(&self) -> bool {
        false
    }
}

/// One particle at the deformation `f`.
fn at<'a>(law: &'a SaintVenantKirchhoff, f: &Tensor) -> Point<'a> {
    let mut point = Point::new(law, 3, Description::Updated(StressRate::Jaumann));
    point.step(&(f - Tensor::identity()), 1.0);
    point
}

/// A uniaxial stretch a: s11 = a (lambda + 2 G)(a^2 - 1)/2.
fn closed_form(law: &SaintVenantKirchhoff) -> String {
    let Elastic { lambda, shear, .. } = law.0;
    let mut f = Tensor::identity();
    f[(0, 0)] = 1.2;
    let found = at(law, &f).stress()[(0, 0)];
    let exact = 1.2 * (lambda + 2.0 * shear) * (1.2 * 1.2 - 1.0) / 2.0;
    assert!((found / exact - 1.0).abs() < 1e-14);
    format!("s11 = {found:.6} at a stretch of 1.2, closed form {exact:.6}")
}

/// The stress is the derivative of the energy: P = dW/dF, by central differences.
fn derivative(law: &SaintVenantKirchhoff) -> String {
    let f = Tensor::new(1.3, 0.2, -0.1, 0.15, 0.8, 0.3, 0.05, -0.2, 1.1);
    let point = at(law, &f);
    let exact = point.stress() * f.try_inverse().unwrap().transpose() * point.value(Column::J);
    let mut largest = 0.0f64;
    for entry in 0..9 {
        let mut shift = Tensor::zeros();
        shift[entry] = 1e-5;
        let [above, below] = [f + shift, f - shift].map(|f| at(law, &f).stored_energy());
        largest = largest.max(((above - below) / 2e-5 - exact[entry]).abs());
    }
    let bound = 1e-8; // h^2 of the differences and round-off of W
    assert!(largest < bound * exact.norm());
    format!("dW/dF is P within {bound:e}")
}

/// Kinetic and stored energy of a disk that was stretched and let go.
fn swing(law: SaintVenantKirchhoff) -> Result<String, Fault> {
    let domain = Domain { dimension: 2, lower: [0.0; 3], upper: [1.0, 1.0, 0.0], cell: 0.05 };
    let mut simulation = Simulation::new(domain, Outputs::silent());
    let disk = Sphere { dimension: 2, centre: [0.5, 0.5, 0.0], radius: 0.2 };
    simulation.add_solid("disk", "svk", Arc::new(law), &disk, 2);
    let particles = &mut simulation.world.particles;
    for (velocity, place) in particles.velocity.iter_mut().zip(&particles.position) {
        velocity[0] = 0.2 * (place[0] - 0.5);
    }
    let total = |simulation: &Simulation| {
        let world = &simulation.world;
        kinetic_energy(world, GroupId::ALL) + strain_energy(world, GroupId::ALL)
    };
    let before = total(&simulation);
    simulation.run(Until::Time(0.5))?;
    let left = total(&simulation) / before;
    assert!((left - 1.0).abs() < 0.01);
    Ok(format!("a swinging disk has {left:.4} of its energy after 0.5"))
}

/// What the law does, in three lines.
pub fn report() -> Result<String, Fault> {
    let law = SaintVenantKirchhoff(Elastic::new(1000.0, 1e4, 0.3));
    Ok([closed_form(&law), derivative(&law), swing(law)?].join("\n"))
}

fn main() -> Result<(), Fault> {
    println!("{}", report()?);
    Ok(())
}
