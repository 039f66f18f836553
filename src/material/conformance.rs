//! What every law must do, and closed forms along paths of one particle.

use super::linear::Linear;
use super::neo_hookean::NeoHookean;
use super::{Chunk, Elastic, LANES, Lane, Law, MATERIALS, StressRate, View, deformation, stress};
use crate::math::tensor::{Tensor, symmetric};
use crate::model::column::{COLUMNS, Column};
use crate::model::particles::Particles;

const RATES: [StressRate; 3] =
    [StressRate::Jaumann, StressRate::GreenNaghdi, StressRate::Logarithmic];

/// A few particles of a law that all see the same velocity gradient.
struct Probe<'a> {
    law: &'a dyn Law,
    dimension: usize,
    rate: StressRate,
    particles: Particles,
}

impl<'a> Probe<'a> {
    fn new(law: &'a dyn Law, dimension: usize, rate: StressRate) -> Self {
        let mut particles = Particles::new();
        particles.require(law.columns(dimension, rate));
        // Seven: one block of four and a rest of three.
        (1..=7).for_each(|id| particles.push(id, 0, [0.0; 3], 1.0, 1.0));
        Self { law, dimension, rate, particles }
    }

    /// One step dt with the velocity gradient `l`.
    fn step(&mut self, l: &Tensor, dt: f64) {
        let lanes: [Lane; 9] = std::array::from_fn(|entry| [l[(entry / 3, entry % 3)]; LANES]);
        let mut columns = self.particles.columns.iter_mut();
        let mut chunk = Chunk {
            dimension: self.dimension,
            dt,
            rate: self.rate,
            gradient: lanes.each_ref(),
            columns: std::array::from_fn(|_| columns.next().map_or(&mut [][..], |c| &mut c[..])),
            len: 7,
            failed: None,
        };
        self.law.update(&mut chunk);
        assert_eq!(chunk.failed, None);
    }

    fn view(&self) -> View<'_> {
        let columns: [&[f64]; COLUMNS] =
            std::array::from_fn(|column| &self.particles.columns[column][..]);
        View { dimension: self.dimension, len: 7, columns }
    }

    fn stress(&self) -> Tensor {
        let (first, last) = (stress(&self.view(), 0), stress(&self.view(), 6));
        assert_eq!(first, last, "all lanes compute the same");
        first
    }

    fn energy(&self) -> f64 {
        let mut energy = [0.0; LANES];
        self.law.stored_energy(&self.view(), &mut energy);
        energy[6]
    }

    fn jacobian(&self) -> f64 {
        self.particles.column(Column::J)[6]
    }

    /// From the present F = I to `f` along the straight path, in `steps` steps.
    fn stretch_to(&mut self, f: &Tensor, steps: u32) {
        let dt = 1.0 / f64::from(steps);
        let velocity = f - Tensor::identity();
        for step in 0..steps {
            let here = Tensor::identity() + velocity * (f64::from(step) * dt);
            let l = velocity * here.try_inverse().unwrap();
            self.step(&l, dt);
        }
    }
}

fn elastic() -> Elastic {
    Elastic::new(1000.0, 2.6e5, 0.3)
}

fn laws() -> Vec<Box<dyn Law>> {
    vec![Box::new(Linear(elastic())), Box::new(NeoHookean(elastic()))]
}

/// A small strain in the given dimension.
fn small(dimension: usize) -> Tensor {
    let e = Tensor::new(1.0, 0.4, -0.3, 0.4, -0.7, 0.2, -0.3, 0.2, 0.5) * 1e-7;
    Tensor::from_fn(|i, j| if i < dimension && j < dimension { e[(i, j)] } else { 0.0 })
}

#[test]
fn every_row_that_can_be_built_is_tested_here() {
    let built = MATERIALS.iter().filter(|style| style.build.is_some()).count();
    assert_eq!(built, laws().len());
}

#[test]
fn no_motion_makes_no_stress_and_no_energy() {
    for law in laws() {
        for dimension in 1..=3 {
            let mut probe = Probe::new(&*law, dimension, StressRate::Jaumann);
            probe.step(&Tensor::zeros(), 0.1);
            assert_eq!((probe.stress(), probe.energy()), (Tensor::zeros(), 0.0));
            assert_eq!(probe.jacobian(), 1.0);
        }
    }
}

#[test]
fn small_strains_obey_hookes_law_and_store_half_stress_times_strain() {
    let Elastic { lambda, shear, .. } = elastic();
    for law in laws() {
        for dimension in 1..=3 {
            for rate in RATES {
                let mut probe = Probe::new(&*law, dimension, rate);
                let strain = small(dimension) * 1e3;
                probe.step(&strain, 1.0);
                let hooke = Tensor::identity() * (lambda * strain.trace()) + strain * (2.0 * shear);
                // The laws differ by the square of the strain, 1e-4, times a small number.
                let bound = 1e-4 * 1e-4 * 20.0 * (lambda + shear);
                assert!((probe.stress() - hooke).norm() < bound, "{dimension} {rate:?}");
                let energy = 0.5 * hooke.dot(&strain);
                assert!((probe.energy() - energy).abs() < 1e-3 * energy, "{dimension} {rate:?}");
                let mut lanes = [[0.0; LANES]; 6];
                law.elastic_strain(&probe.view(), &mut lanes);
                for (lane, (i, j)) in
                    lanes.iter().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)])
                {
                    assert!((lane[6] - strain[(i, j)]).abs() < 1e-7, "{dimension} e{i}{j}");
                }
            }
        }
    }
}

#[test]
fn a_rigid_rotation_turns_the_stress_and_keeps_the_energy() {
    for law in laws() {
        for dimension in 2..=3 {
            for rate in RATES {
                let mut probe = Probe::new(&*law, dimension, rate);
                probe.stretch_to(&(Tensor::identity() + small(dimension) * 1e5), 4);
                let (before, energy) = (probe.stress(), probe.energy());
                let steps = 4000;
                let angle = 1.3;
                let spin = match dimension {
                    2 => Tensor::new(0.0, -angle, 0.0, angle, 0.0, 0.0, 0.0, 0.0, 0.0),
                    _ => Tensor::new(0.0, -0.5, 0.9, 0.5, 0.0, -0.8, -0.9, 0.8, 0.0),
                };
                for _ in 0..steps {
                    probe.step(&spin, 1.0 / f64::from(steps));
                }
                let axial = nalgebra::Vector3::new(spin[(2, 1)], spin[(0, 2)], spin[(1, 0)]);
                let q = nalgebra::Rotation3::new(axial).into_inner();
                let expected = q * before * q.transpose();
                // I + dt W stretches by (dt |W|)^2/2 in every step: |W|^2/(2 steps) in all.
                let bound = 6.0 * axial.norm_squared() / f64::from(steps);
                let error = (probe.stress() - expected).norm() / before.norm();
                let drift = elastic().shear / before.norm() * bound;
                assert!(error < bound + drift, "{dimension} {rate:?} {error:e}");
                let change = (probe.energy() - energy).abs() / energy;
                assert!(change < 60.0 * bound, "{dimension} {rate:?} {change:e}");
            }
        }
    }
}

#[test]
fn without_an_objective_rate_a_rotation_is_seen_to_fail() {
    let law = Linear(elastic());
    let mut probe = Probe::new(&law, 2, StressRate::None);
    probe.stretch_to(&(Tensor::identity() + small(2) * 1e5), 4);
    let before = probe.stress();
    for _ in 0..1000 {
        probe.step(&Tensor::new(0.0, -1e-3, 0.0, 1e-3, 0.0, 0.0, 0.0, 0.0, 0.0), 1.0);
    }
    let expected = before.component_mul(&Tensor::identity()); // not turned at all: far off
    assert!((probe.stress() - before).norm() < 0.2 * before.norm(), "{expected}");
}

#[test]
fn simple_shear_has_its_closed_forms() {
    let shear = elastic().shear;
    let (gamma, steps): (f64, u32) = (1.5, 20_000);
    let law = Linear(elastic());
    let l = Tensor::new(0.0, gamma, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let beta = (gamma / 2.0).atan();
    let (c, s) = ((2.0 * beta).cos(), (2.0 * beta).sin());
    // Jaumann: G sin(gamma). Green-Naghdi: Dienes 1979. Logarithmic: Hencky's strain of the
    // path, G asinh(gamma/2)/sqrt(1 + gamma^2/4) times 2.
    let naghdi =
        2.0 * shear * c * (2.0 * beta - 2.0 * (2.0 * beta).tan() * beta.cos().ln() - beta.tan());
    let hencky = 2.0 * shear * (gamma / 2.0).asinh() / (1.0 + gamma * gamma / 4.0).sqrt();
    for dimension in 2..=3 {
        for (rate, exact) in RATES.into_iter().zip([shear * gamma.sin(), naghdi, hencky]) {
            let mut probe = Probe::new(&law, dimension, rate);
            for _ in 0..steps {
                probe.step(&l, 1.0 / f64::from(steps));
            }
            let found = probe.stress()[(0, 1)];
            // The increment of a step is not turned by half the step: gamma/steps.
            let bound = 2.0 * shear * gamma * gamma / f64::from(steps);
            assert!((found - exact).abs() < bound, "{rate:?} {dimension}: {found} for {exact} {s}");
        }
    }
}

#[test]
fn the_neo_hookean_stress_is_the_derivative_of_its_energy() {
    let law = NeoHookean(elastic());
    let f = Tensor::new(1.3, 0.2, -0.1, 0.15, 0.8, 0.3, 0.05, -0.2, 1.1);
    let at = |f: &Tensor| {
        let mut probe = Probe::new(&law, 3, StressRate::Jaumann);
        probe.step(&(f - Tensor::identity()), 1.0);
        assert!((deformation(&probe.view(), 6) - f).norm() < 1e-15);
        probe
    };
    let probe = at(&f);
    let first_piola = probe.stress() * f.try_inverse().unwrap().transpose() * probe.jacobian();
    let h = 1e-5;
    for i in 0..3 {
        for j in 0..3 {
            let mut shift = Tensor::zeros();
            shift[(i, j)] = h;
            let slope = (at(&(f + shift)).energy() - at(&(f - shift)).energy()) / (2.0 * h);
            // Central differences: h^2 and round-off of the energy.
            assert!((slope - first_piola[(i, j)]).abs() < 1e-6 * first_piola.norm(), "{i}{j}");
        }
    }
}

#[test]
fn neo_hookean_work_along_a_closed_path_is_nothing() {
    let law = NeoHookean(elastic());
    let mut probe = Probe::new(&law, 3, StressRate::Jaumann);
    let steps = 20_000;
    let (mut work, mut largest) = (0.0, 0.0f64);
    let path = |t: f64| {
        let (s, c) = ((std::f64::consts::TAU * t).sin(), 1.0 - (std::f64::consts::TAU * t).cos());
        Tensor::identity()
            + Tensor::new(0.2 * s, 0.3 * c, 0.0, -0.1 * c, 0.1 * s, 0.2 * c, 0.1 * s, 0.0, -0.2 * c)
    };
    for step in 0..steps {
        let [here, next] = [step, step + 1].map(|k| path(f64::from(k) / f64::from(steps)));
        let before = probe.stress() * probe.jacobian();
        let increment = next * here.try_inverse().unwrap() - Tensor::identity();
        probe.step(&increment, 1.0);
        let after = probe.stress() * probe.jacobian();
        work += 0.5 * (before + after).dot(&symmetric(&increment));
        largest = largest.max(probe.energy());
    }
    assert!(work.abs() < 1e-3 * largest, "{work} of {largest}");
    assert!(probe.energy() < 1e-10 * largest);
}

#[test]
fn uniaxial_strain_has_its_closed_forms_in_every_dimension() {
    let Elastic { lambda, shear, .. } = elastic();
    let stretch: f64 = 1.2;
    for dimension in 1..=3 {
        let mut f = Tensor::identity();
        f[(0, 0)] = stretch;
        let law = NeoHookean(elastic());
        let mut probe = Probe::new(&law, dimension, StressRate::Jaumann);
        probe.stretch_to(&f, 10);
        let pressure = lambda * stretch.ln() / stretch;
        let s11 = shear * (stretch - 1.0 / stretch) + pressure;
        assert!((probe.stress()[(0, 0)] - s11).abs() < 1e-9 * s11);
        assert!((probe.stress()[(2, 2)] - pressure).abs() < 1e-9 * s11);

        let law = Linear(elastic());
        let mut probe = Probe::new(&law, dimension, StressRate::Jaumann);
        let steps = 10_000;
        probe.stretch_to(&f, steps);
        let exact = (lambda + 2.0 * shear) * stretch.ln();
        // A sum in place of an integral: the square of the stretch over twice the steps.
        let bound = (lambda + 2.0 * shear) * (stretch - 1.0).powi(2) / f64::from(steps);
        assert!((probe.stress()[(0, 0)] - exact).abs() < bound);
    }
}

#[test]
fn wave_speeds_are_those_of_the_manual() {
    let Elastic { density, lambda, shear } = elastic();
    let exact = ((lambda + 2.0 * shear) / density).sqrt();
    for law in laws() {
        assert!((law.reference_wave_speed() - exact).abs() < 1e-12 * exact);
        let probe = Probe::new(&*law, 3, StressRate::Jaumann);
        let mut speed = [0.0; LANES];
        law.wave_speed(&probe.view(), &mut speed);
        assert!((speed[6] - exact).abs() < 1e-12 * exact);
    }
    let law = NeoHookean(elastic());
    let mut probe = Probe::new(&law, 1, StressRate::Jaumann);
    probe.step(&Tensor::new(0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 1.0);
    let mut speed = [0.0; LANES];
    law.wave_speed(&probe.view(), &mut speed);
    // F = 1.5: sqrt((G (1 + 2.25) + lambda (1 - ln 1.5))/rho0).
    let exact = ((3.25 * shear + lambda * (1.0 - 1.5f64.ln())) / density).sqrt();
    assert!((speed[6] - exact).abs() < 1e-12 * exact);
}

#[test]
fn a_chunk_turned_inside_out_names_its_particle() {
    for law in laws() {
        let mut particles = Particles::new();
        particles.require(law.columns(1, StressRate::Jaumann));
        (1..=3).for_each(|id| particles.push(id, 0, [0.0; 3], 1.0, 1.0));
        let zero = [0.0; LANES];
        let mut crush = [0.0; LANES];
        crush[1] = -1.5;
        let mut columns = particles.columns.iter_mut();
        let mut chunk = Chunk {
            dimension: 1,
            dt: 1.0,
            rate: StressRate::None,
            gradient: std::array::from_fn(|entry| if entry == 0 { &crush } else { &zero }),
            columns: std::array::from_fn(|_| columns.next().map_or(&mut [][..], |c| &mut c[..])),
            len: 3,
            failed: None,
        };
        law.update(&mut chunk);
        assert_eq!(chunk.failed, Some(1));
    }
}
