//! What every law must do, and closed forms along paths of one particle.

use super::drucker_prager::{DruckerPrager, Fit};
use super::eos_strength::EosStrength;
use super::granular::{Granular, Strength};
use super::linear::Linear;
use super::mohr_coulomb::MohrCoulomb;
use super::neo_hookean::NeoHookean;
use super::point::Point;
use super::von_mises::VonMises;
use super::{Description, Elastic, Law, MATERIALS, StressRate};
use crate::math::tensor::{Tensor, symmetric};
use crate::model::column::Column;
use crate::{eos, strength};
use std::sync::Arc;

const RATES: [Description; 4] = [
    Description::Updated(StressRate::Jaumann),
    Description::Updated(StressRate::GreenNaghdi),
    Description::Updated(StressRate::Logarithmic),
    Description::Total,
];

const JAUMANN: Description = Description::Updated(StressRate::Jaumann);

impl Point<'_> {
    /// One step with the velocity gradient L at its start: L = dv/dx, or dF/dt = L F.
    fn step_with(&mut self, description: Description, l: &Tensor, dt: f64) {
        let rate = match description {
            Description::Total => l * self.state().deformation(0),
            Description::Updated(_) => *l,
        };
        self.step(&rate, dt);
        assert_eq!(self.failed, None);
        assert!(self.copies_agree(), "all lanes compute the same");
    }

    /// From the present F = I to `f` along the straight path, in `steps` steps.
    fn stretch_to(&mut self, description: Description, f: &Tensor, steps: u32) {
        let dt = 1.0 / f64::from(steps);
        let velocity = f - Tensor::identity();
        for step in 0..steps {
            let here = Tensor::identity() + velocity * (f64::from(step) * dt);
            let l = velocity * here.try_inverse().unwrap();
            self.step_with(description, &l, dt);
        }
    }
}

fn elastic() -> Elastic {
    Elastic::new(1000.0, 2.6e5, 0.3)
}

/// Laws that are elastic for the strains of these tests, one for each row of the table.
fn laws() -> Vec<Box<dyn Law>> {
    let elastic = elastic();
    let Elastic { density, shear, .. } = elastic;
    let composite = EosStrength {
        eos: Arc::new(eos::linear::Linear { density, bulk: elastic.bulk() }),
        strength: Arc::new(strength::linear::Linear { shear }),
        damage: None,
        temperature: None,
    };
    let strong = VonMises { elastic, yield_stress: 1e9, hardening: 0.0 };
    let solid = Strength { cohesion: 1e9, friction: 0.5, dilatancy: 0.1 };
    let (tension, softening) = (f64::INFINITY, None);
    let pyramid = Granular { elastic, surface: MohrCoulomb, strength: solid, tension, softening };
    let surface = DruckerPrager { fit: Fit::Inner };
    let cone = Granular { elastic, surface, strength: solid, tension, softening };
    vec![
        Box::new(Linear(elastic)),
        Box::new(NeoHookean(elastic)),
        Box::new(composite),
        Box::new(strong),
        Box::new(pyramid),
        Box::new(cone),
    ]
}

/// A small strain in the given dimension.
fn small(dimension: usize) -> Tensor {
    let e = Tensor::new(1.0, 0.4, -0.3, 0.4, -0.7, 0.2, -0.3, 0.2, 0.5) * 1e-7;
    Tensor::from_fn(|i, j| if i < dimension && j < dimension { e[(i, j)] } else { 0.0 })
}

#[test]
fn every_row_that_can_be_built_is_tested_here() {
    // A rigid body has no stress: tests/verification/rigid.rs.
    let stressed = |name: &str| name != "rigid";
    let built = MATERIALS.iter().filter(|row| row.build.is_some() && stressed(row.name)).count();
    assert_eq!(built, laws().len());
}

#[test]
fn no_motion_makes_no_stress_and_no_energy() {
    for law in laws() {
        for dimension in 1..=3 {
            for description in RATES {
                let mut point = Point::new(&*law, dimension, description);
                point.step_with(description, &Tensor::zeros(), 0.1);
                assert_eq!((point.stress(), point.stored_energy()), (Tensor::zeros(), 0.0));
                assert_eq!(point.value(Column::J), 1.0);
            }
        }
    }
}

#[test]
fn small_strains_obey_hookes_law_and_store_half_stress_times_strain() {
    let Elastic { lambda, shear, .. } = elastic();
    for law in laws() {
        for dimension in 1..=3 {
            for rate in RATES {
                let mut point = Point::new(&*law, dimension, rate);
                let strain = small(dimension) * 1e3;
                point.step_with(rate, &strain, 1.0);
                let hooke = Tensor::identity() * (lambda * strain.trace()) + strain * (2.0 * shear);
                // The laws differ by the square of the strain, 1e-4, times a small number.
                let bound = 1e-4 * 1e-4 * 20.0 * (lambda + shear);
                assert!((point.stress() - hooke).norm() < bound, "{dimension} {rate:?}");
                let energy = 0.5 * hooke.dot(&strain);
                let error = (point.stored_energy() - energy).abs();
                assert!(error < 1e-3 * energy, "{dimension} {rate:?}");
                assert!((point.elastic_strain() - strain).norm() < 3e-7, "{dimension} {rate:?}");
            }
        }
    }
}

#[test]
fn a_rigid_rotation_turns_the_stress_and_keeps_the_energy() {
    for law in laws() {
        for dimension in 2..=3 {
            for rate in RATES {
                let mut point = Point::new(&*law, dimension, rate);
                point.stretch_to(rate, &(Tensor::identity() + small(dimension) * 1e5), 4);
                let (before, energy) = (point.stress(), point.stored_energy());
                let steps = 4000;
                let angle = 1.3;
                let spin = match dimension {
                    2 => Tensor::new(0.0, -angle, 0.0, angle, 0.0, 0.0, 0.0, 0.0, 0.0),
                    _ => Tensor::new(0.0, -0.5, 0.9, 0.5, 0.0, -0.8, -0.9, 0.8, 0.0),
                };
                for _ in 0..steps {
                    point.step_with(rate, &spin, 1.0 / f64::from(steps));
                }
                let axial = nalgebra::Vector3::new(spin[(2, 1)], spin[(0, 2)], spin[(1, 0)]);
                let q = nalgebra::Rotation3::new(axial).into_inner();
                let expected = q * before * q.transpose();
                // I + dt W stretches by (dt |W|)^2/2 in every step: |W|^2/(2 steps) in all.
                let bound = 6.0 * axial.norm_squared() / f64::from(steps);
                let error = (point.stress() - expected).norm() / before.norm();
                let Elastic { lambda, shear, .. } = elastic();
                let drift = (lambda + 2.0 * shear) / before.norm() * bound;
                assert!(error < bound + drift, "{dimension} {rate:?} {error:e}");
                let change = (point.stored_energy() - energy).abs() / energy;
                assert!(change < 60.0 * bound, "{dimension} {rate:?} {change:e}");
            }
        }
    }
}

#[test]
fn without_an_objective_rate_a_rotation_is_seen_to_fail() {
    let law = Linear(elastic());
    let none = Description::Updated(StressRate::None);
    let mut point = Point::new(&law, 2, none);
    point.stretch_to(none, &(Tensor::identity() + small(2) * 1e5), 4);
    let before = point.stress();
    for _ in 0..1000 {
        let spin = Tensor::new(0.0, -1e-3, 0.0, 1e-3, 0.0, 0.0, 0.0, 0.0, 0.0);
        point.step_with(none, &spin, 1.0);
    }
    // A radian later it stands as it stood: not turned at all.
    assert!((point.stress() - before).norm() < 0.2 * before.norm());
}

#[test]
fn simple_shear_has_its_closed_forms() {
    let shear = elastic().shear;
    let (gamma, steps): (f64, u32) = (1.5, 20_000);
    let law = Linear(elastic());
    let l = Tensor::new(0.0, gamma, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let beta = (gamma / 2.0).atan();
    let c = (2.0 * beta).cos();
    // Jaumann: G sin(gamma). Green-Naghdi, also total Lagrangian: Dienes 1979. Logarithmic:
    // Hencky's strain of the path, G asinh(gamma/2)/sqrt(1 + gamma^2/4) times 2.
    let naghdi =
        2.0 * shear * c * (2.0 * beta - 2.0 * (2.0 * beta).tan() * beta.cos().ln() - beta.tan());
    let hencky = 2.0 * shear * (gamma / 2.0).asinh() / (1.0 + gamma * gamma / 4.0).sqrt();
    for dimension in 2..=3 {
        let exact = [shear * gamma.sin(), naghdi, hencky, naghdi];
        for (rate, exact) in RATES.into_iter().zip(exact) {
            let mut point = Point::new(&law, dimension, rate);
            for _ in 0..steps {
                point.step_with(rate, &l, 1.0 / f64::from(steps));
            }
            let found = point.stress()[(0, 1)];
            // The increment of a step is not turned by half the step: gamma/steps.
            let bound = 2.0 * shear * gamma * gamma / f64::from(steps);
            assert!((found - exact).abs() < bound, "{rate:?} {dimension}: {found} for {exact}");
        }
    }
}

#[test]
fn the_neo_hookean_stress_is_the_derivative_of_its_energy() {
    let law = NeoHookean(elastic());
    let f = Tensor::new(1.3, 0.2, -0.1, 0.15, 0.8, 0.3, 0.05, -0.2, 1.1);
    for description in RATES {
        let at = |f: &Tensor| {
            let mut point = Point::new(&law, 3, description);
            point.step_with(description, &(f - Tensor::identity()), 1.0);
            assert!((point.state().deformation(6) - f).norm() < 1e-15);
            point
        };
        let point = at(&f);
        let first_piola =
            point.stress() * f.try_inverse().unwrap().transpose() * point.value(Column::J);
        let h = 1e-5;
        for i in 0..3 {
            for j in 0..3 {
                let mut shift = Tensor::zeros();
                shift[(i, j)] = h;
                let [above, below] = [f + shift, f - shift].map(|f| at(&f).stored_energy());
                let slope = (above - below) / (2.0 * h);
                // Central differences: h^2 and round-off of the energy.
                assert!((slope - first_piola[(i, j)]).abs() < 1e-6 * first_piola.norm(), "{i}{j}");
            }
        }
    }
}

#[test]
fn neo_hookean_work_along_a_closed_path_is_nothing() {
    let law = NeoHookean(elastic());
    let mut point = Point::new(&law, 3, JAUMANN);
    let steps = 20_000;
    let (mut work, mut largest) = (0.0, 0.0f64);
    let path = |t: f64| {
        let (s, c) = ((std::f64::consts::TAU * t).sin(), 1.0 - (std::f64::consts::TAU * t).cos());
        Tensor::identity()
            + Tensor::new(0.2 * s, 0.3 * c, 0.0, -0.1 * c, 0.1 * s, 0.2 * c, 0.1 * s, 0.0, -0.2 * c)
    };
    for step in 0..steps {
        let [here, next] = [step, step + 1].map(|k| path(f64::from(k) / f64::from(steps)));
        let before = point.stress() * point.value(Column::J);
        let increment = next * here.try_inverse().unwrap() - Tensor::identity();
        point.step_with(JAUMANN, &increment, 1.0);
        let after = point.stress() * point.value(Column::J);
        work += 0.5 * (before + after).dot(&symmetric(&increment));
        largest = largest.max(point.stored_energy());
    }
    assert!(work.abs() < 1e-3 * largest, "{work} of {largest}");
    assert!(point.stored_energy() < 1e-10 * largest);
}

#[test]
fn uniaxial_strain_has_its_closed_forms_in_every_dimension() {
    let Elastic { lambda, shear, .. } = elastic();
    let stretch: f64 = 1.2;
    for dimension in 1..=3 {
        for description in RATES {
            let mut f = Tensor::identity();
            f[(0, 0)] = stretch;
            let law = NeoHookean(elastic());
            let mut point = Point::new(&law, dimension, description);
            point.stretch_to(description, &f, 10);
            let pressure = lambda * stretch.ln() / stretch;
            let s11 = shear * (stretch - 1.0 / stretch) + pressure;
            assert!((point.stress()[(0, 0)] - s11).abs() < 1e-9 * s11);
            assert!((point.stress()[(2, 2)] - pressure).abs() < 1e-9 * s11);

            let law = Linear(elastic());
            let mut point = Point::new(&law, dimension, description);
            let steps = 10_000;
            point.stretch_to(description, &f, steps);
            let exact = (lambda + 2.0 * shear) * stretch.ln();
            // A sum in place of an integral: the square of the stretch over twice the steps.
            let bound = (lambda + 2.0 * shear) * (stretch - 1.0).powi(2) / f64::from(steps);
            assert!((point.stress()[(0, 0)] - exact).abs() < bound);
        }
    }
}

#[test]
fn wave_speeds_are_those_of_the_manual() {
    let Elastic { density, lambda, shear, .. } = elastic();
    let exact = ((lambda + 2.0 * shear) / density).sqrt();
    for law in laws() {
        assert!((law.reference_wave_speed() - exact).abs() < 1e-12 * exact);
        let point = Point::new(&*law, 3, JAUMANN);
        assert!((point.wave_speed() - exact).abs() < 1e-12 * exact);
    }
    let law = NeoHookean(elastic());
    let mut point = Point::new(&law, 1, JAUMANN);
    let mut l = Tensor::zeros();
    l[(0, 0)] = 0.5;
    point.step_with(JAUMANN, &l, 1.0);
    // F = 1.5: sqrt((G (1 + 2.25) + lambda (1 - ln 1.5))/rho0).
    let exact = ((3.25 * shear + lambda * (1.0 - 1.5f64.ln())) / density).sqrt();
    assert!((point.wave_speed() - exact).abs() < 1e-12 * exact);
}

#[test]
fn a_chunk_turned_inside_out_names_its_particle() {
    for law in laws() {
        for description in RATES {
            let mut point = Point::new(&*law, 1, description);
            let mut rates = [Tensor::zeros(); 7];
            rates[4][(0, 0)] = -1.5;
            point.step_each(&rates, 1.0);
            assert_eq!(point.failed, Some(4));
        }
    }
}
