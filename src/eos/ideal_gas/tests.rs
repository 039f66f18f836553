//! Closed forms of a particle of gas.

use super::*;
use crate::material::eos_strength::EosStrength;
use crate::material::point::Point;
use crate::material::{Description, Law, NOTHING, StressRate};
use crate::math::tensor::Tensor;
use crate::strength::Strength;
use crate::strength::fluid::Fluid;
use crate::strength::plastic::Plastic;

const DESCRIPTIONS: [Description; 2] =
    [Description::Updated(StressRate::Jaumann), Description::Total];

fn air(pressure: f64, [quadratic, linear]: [f64; 2]) -> IdealGas {
    IdealGas { density: 1.2, exponent: 1.4, pressure, quadratic, linear }
}

fn material(gas: IdealGas, strength: impl Strength + 'static) -> EosStrength {
    EosStrength {
        eos: Arc::new(gas),
        strength: Arc::new(strength),
        damage: None,
        temperature: None,
    }
}

fn inviscid(gas: IdealGas) -> EosStrength {
    material(gas, Fluid { viscosity: 0.0 })
}

/// The rate that brings F from `from` to `to` in a time of 1: L, or dF/dt.
fn rate(description: Description, from: &Tensor, to: &Tensor) -> Tensor {
    match description {
        Description::Total => to - from,
        Description::Updated(_) => to * from.try_inverse().unwrap() - Tensor::identity(),
    }
}

/// F = diag(J, 1, 1).
fn flattened(j: f64) -> Tensor {
    let mut f = Tensor::identity();
    f[(0, 0)] = j;
    f
}

fn pressure(point: &Point<'_>) -> f64 {
    -point.stress().trace() / 3.0
}

#[test]
fn a_new_particle_has_its_pressure_its_energy_and_its_sound_speed() {
    let law = inviscid(air(1e5, [0.0, 0.0]));
    let point = Point::new(&law, 2, DESCRIPTIONS[0]);
    assert_eq!(point.stress(), Tensor::identity() * -1e5);
    assert!((point.stored_energy() / 2.5e5 - 1.0).abs() < 1e-15);
    assert_eq!(law.internal_energy(point.state(), 6), point.stored_energy());
    let sound = (1.4f64 * 1e5 / 1.2).sqrt();
    assert!((point.wave_speed() / sound - 1.0).abs() < 1e-15);
    assert!((law.reference_wave_speed() / sound - 1.0).abs() < 1e-15);
    assert!((law.moduli()[0] - 1.4e5).abs() < 1e-9);
}

/// ln(p J^gamma/p0) after the volume has been halved in so many steps.
fn entropy_error(description: Description, dimension: usize, steps: u32) -> f64 {
    let law = inviscid(air(1e5, [0.0, 0.0]));
    let mut point = Point::new(&law, dimension, description);
    let j = |step: u32| 1.0 - 0.5 * f64::from(step) / f64::from(steps);
    for step in 0..steps {
        let [from, to] = [j(step), j(step + 1)].map(flattened);
        point.step(&rate(description, &from, &to), 1.0);
        assert!(point.copies_agree() && point.failed.is_none());
    }
    assert!((point.value(Column::J) - 0.5).abs() < 1e-12);
    (pressure(&point) / 1e5).ln() + 1.4 * 0.5f64.ln()
}

#[test]
fn a_slow_compression_is_adiabatic_to_second_order() {
    // A step dJ/J = x errs by -a (1 + a)(1 + 2 a) x^3/3 in the logarithm, a = (gamma - 1)/2; the
    // sum of |x|^3 over the path is 0.375/n^2.
    let a: f64 = 0.2;
    let exact = a * (1.0 + a) * (1.0 + 2.0 * a) / 3.0 * 0.375;
    for description in DESCRIPTIONS {
        for dimension in 1..=3 {
            let [coarse, fine] = [40, 80].map(|steps| entropy_error(description, dimension, steps));
            let order = (coarse / fine).log2();
            assert!((order - 2.0).abs() < 0.05, "{description:?} {dimension} order {order}");
            let found = fine * 6400.0;
            assert!((found / exact - 1.0).abs() < 0.05, "{found} for {exact}");
        }
    }
}

#[test]
fn viscosity_feeds_the_energy_of_a_cold_gas_in_compression_alone() {
    // From E = 0: E' = -q dJ/(1 + (gamma - 1)/2 dJ/J'), p = (gamma - 1) E'/J' + q.
    let law = inviscid(air(0.0, [2.0, 0.2]));
    for description in DESCRIPTIONS {
        let mut point = Point::new(&law, 1, description);
        point.cell = 0.5;
        point.step(&rate(description, &Tensor::identity(), &flattened(0.9)), 1.0);
        // L of updated Lagrangian methods belongs to the start, D of the others to the end.
        let trace: f64 = if description == Description::Total { 0.1 / 0.9 } else { 0.1 };
        let q = 1.2 / 0.9 * 2.0 * 0.25 * trace * trace;
        let energy = q * 0.1 / (1.0 - 0.2 * 0.1 / 0.9);
        assert!((point.value(Column::InternalEnergy) / energy - 1.0).abs() < 1e-12);
        assert!((pressure(&point) / (0.4 * energy / 0.9 + q) - 1.0).abs() < 1e-12);
        // Expansion: nothing is added, and the gas works along its adiabat.
        point.step(&rate(description, &flattened(0.9), &flattened(1.0)), 1.0);
        let kept = energy * (1.0 - 0.2 * 0.1 / 0.9) / (1.0 + 0.2 * 0.1);
        assert!((point.value(Column::InternalEnergy) / kept - 1.0).abs() < 1e-12);
        assert!((pressure(&point) / (0.4 * kept) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn work_against_the_viscosity_of_the_fluid_heats_it() {
    let (viscosity, shear) = (0.3, 0.02);
    let law = material(air(1.0, [0.0, 0.0]), Fluid { viscosity });
    for description in DESCRIPTIONS {
        let mut point = Point::new(&law, 2, description);
        let mut to = Tensor::identity();
        to[(0, 1)] = shear;
        point.step(&rate(description, &Tensor::identity(), &to), 1.0);
        let energy = 2.5 + viscosity * shear * shear;
        assert!((point.value(Column::InternalEnergy) - energy).abs() < 1e-15);
        assert!((pressure(&point) - 0.4 * energy).abs() < 1e-15);
        assert!((point.stress()[(0, 1)] - viscosity * shear).abs() < 1e-15);
    }
}

#[test]
fn plastic_work_heats_a_gas_that_has_strength() {
    let (shear, yield_stress) = (10.0, 0.05);
    let law = material(air(1.0, [0.0, 0.0]), Plastic { shear, yield_stress });
    let mut point = Point::new(&law, 2, DESCRIPTIONS[0]);
    let mut l = Tensor::zeros();
    l[(0, 1)] = 0.01;
    (0..3).for_each(|_| point.step(&l, 1.0));
    let plastic = yield_stress * point.value(Column::PlasticStrain);
    assert!(plastic > 0.0);
    assert!((point.value(Column::InternalEnergy) - 2.5 - plastic).abs() < 1e-14);
    // What is stored besides: tau^2/(2 G), tau = Y/sqrt(3).
    let elastic = yield_stress * yield_stress / (6.0 * shear);
    assert!((point.stored_energy() - 2.5 - plastic - elastic).abs() < 1e-12);
}

#[test]
fn the_stiffness_is_the_slope_of_the_adiabat() {
    let law = inviscid(air(2.0, [0.0, 0.0]));
    let at = |j: f64| {
        let mut point = Point::new(&law, 1, DESCRIPTIONS[1]);
        point.step(&(flattened(j) - Tensor::identity()), 1.0);
        point
    };
    let h = 1e-5;
    let slope = -(pressure(&at(1.0 + h)) - pressure(&at(1.0 - h))) / (2.0 * h);
    let point = Point::new(&law, 1, DESCRIPTIONS[1]);
    let mut stiffness = NOTHING;
    air(2.0, [0.0, 0.0]).stiffness(point.state(), &mut stiffness);
    // Central differences: h^2.
    assert!((slope - 2.8).abs() < 1e-8 && (stiffness[1][2] - 2.8).abs() < 1e-14, "{slope}");
}

#[test]
fn a_rotation_leaves_a_gas_alone() {
    let law = inviscid(air(1e5, [0.0, 0.0]));
    let rates = [StressRate::None, StressRate::GreenNaghdi, StressRate::Logarithmic];
    for description in rates.map(Description::Updated).into_iter().chain(DESCRIPTIONS) {
        let mut point = Point::new(&law, 2, description);
        let (sin, cos) = 0.05f64.sin_cos();
        let turn = Tensor::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        let mut f = Tensor::identity();
        for _ in 0..40 {
            let to = turn * f;
            point.step(&rate(description, &f, &to), 1.0);
            f = to;
        }
        assert!((point.value(Column::J) - 1.0).abs() < 1e-12);
        assert!((pressure(&point) / 1e5 - 1.0).abs() < 1e-12, "{description:?}");
        assert!(point.stress()[(0, 1)].abs() < 1e-7);
    }
}

#[test]
fn a_step_that_asks_for_more_energy_than_there_is_names_its_particle() {
    let gas = IdealGas { exponent: 3.0, ..air(1.0, [0.0, 0.0]) };
    let law = inviscid(gas);
    let mut point = Point::new(&law, 1, DESCRIPTIONS[1]);
    let mut rates = [Tensor::zeros(); 7];
    rates[5][(0, 0)] = -0.6;
    point.step_each(&rates, 1.0);
    assert_eq!(point.failed, Some(5));
}

#[test]
fn viscosity_shortens_the_step() {
    // Q + sqrt(Q^2 + c^2), Q = Q1 h |tr D| + Q2 c.
    let gas = air(1e5, [2.0, 0.2]);
    let law = inviscid(gas);
    let mut state = State::default();
    (state.dimension, state.len) = (1, 4);
    let mut gradient = [NOTHING; 9];
    gradient[0][0] = [-1e3, 0.0, 1e3, -2e3];
    let chunk = Chunk {
        state: &mut state,
        dt: 0.0,
        gradient: &mut gradient,
        rotation: &mut [NOTHING; 9],
        before: &mut { NOTHING },
        cell: 0.1,
        failed: None,
        clipped: 0,
    };
    let mut speed = [[300.0; 4]; crate::material::GROUPS];
    law.stiffen(&chunk, &mut speed);
    let raised = |q: f64| q + (q * q + 9e4).sqrt();
    let exact = [raised(260.0), 300.0, 300.0, raised(460.0)];
    for (found, exact) in speed[0].iter().zip(exact) {
        assert!((found - exact).abs() < 1e-10, "{found} for {exact}");
    }
}
