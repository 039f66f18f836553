//! Closed forms of the composite laws along paths of one particle: yield, heat, damage, shocks.

use super::eos_strength::EosStrength;
use super::point::Point;
use super::stages::Stages;
use super::von_mises::VonMises;
use super::{Chunk, Description, Elastic, Law, NOTHING, State, StressRate, Thermal};
use crate::damage::Damage;
use crate::damage::damage_johnson_cook::DamageJohnsonCook;
use crate::eos::{self, Eos, shock::Shock};
use crate::math::tensor::Tensor;
use crate::model::column::Column;
use crate::strength::johnson_cook::JohnsonCook;
use crate::strength::plastic::Plastic;
use crate::strength::swift::Swift;
use crate::strength::{self, Strength};
use crate::temperature::Temperature;
use crate::temperature::plastic_work::PlasticWork;
use std::sync::Arc;

const DESCRIPTIONS: [Description; 2] =
    [Description::Updated(StressRate::Jaumann), Description::Total];

/// Copper of V11, in Pa, m, s, K.
const SHEAR: f64 = 47.7e9;
const COPPER: JohnsonCook = JohnsonCook {
    shear: SHEAR,
    initial: 90e6,
    hardening: 292e6,
    exponent: 0.31,
    reference_rate: 1.0,
    sensitivity: 0.025,
    softening: 1.09,
    reference: 298.0,
    melting: 1356.0,
};

fn shock() -> Shock {
    Shock {
        density: 8960.0,
        bulk: 100e9,
        sound: 3940.0,
        slope: 1.489,
        gamma: 2.02,
        heat_capacity: 0.0,
        reference: 298.0,
        quadratic: 0.0,
        linear: 0.0,
    }
}

fn heat() -> PlasticWork {
    PlasticWork {
        part: 0.9,
        thermal: Thermal { capacity: 383.0, conductivity: 0.0 },
        expansion: 0.0,
        initial: 298.0,
        melting: 1356.0,
    }
}

fn of(eos: impl Eos + 'static, strength: impl Strength + 'static) -> EosStrength {
    EosStrength {
        eos: Arc::new(eos),
        strength: Arc::new(strength),
        damage: None,
        temperature: None,
    }
}

fn soft(bulk: f64) -> eos::linear::Linear {
    eos::linear::Linear { density: 8960.0, bulk }
}

fn equivalent(sigma: &Tensor) -> f64 {
    (sigma - Tensor::identity() * (sigma.trace() / 3.0)).norm() * 1.5f64.sqrt()
}

/// Simple shear at a rate.
fn shear(rate: f64) -> Tensor {
    Tensor::new(0.0, rate, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
}

/// One step of shear on a particle of given plastic strain and temperature.
fn sheared(law: &dyn Law, strain: f64, temperature: f64, rate: f64, dt: f64) -> Point<'_> {
    let mut point = Point::new(law, 3, DESCRIPTIONS[0]);
    point.set(Column::PlasticStrain, strain);
    point.set(Column::Temperature, temperature);
    point.step(&shear(rate), dt);
    assert!(point.copies_agree());
    point
}

/// The flow stress as the formula says it, in MPa.
fn johnson_cook(law: &JohnsonCook, strain: f64, rate: f64, temperature: f64) -> f64 {
    let ratio = (rate / law.reference_rate).max(1.0);
    let heat = ((temperature - law.reference) / (law.melting - law.reference)).clamp(0.0, 1.0);
    let hardened = law.initial + law.hardening * strain.powf(law.exponent);
    let softened = if law.softening > 0.0 { 1.0 - heat.powf(law.softening) } else { 1.0 };
    hardened * (1.0 + law.sensitivity * ratio.ln()) * softened
}

#[test]
fn johnson_cook_has_the_published_flow_stresses() {
    // V11: plastic strain, rate, temperature, flow stress in MPa.
    let table = [
        (0.1, 1.0, 298.0, 233.015416),
        (0.5, 1.0, 298.0, 325.539394),
        (0.5, 1e5, 298.0, 419.237163),
        (0.5, 1e5, 600.0, 312.337099),
        (1.0, 1e6, 900.0, 235.978554),
    ];
    for (strain, rate, temperature, exact) in table {
        // The formula in its textbook form has the numbers; the law solves that formula.
        let formula = johnson_cook(&COPPER, strain, rate, temperature) * 1e-6;
        assert!((formula - exact).abs() < 1e-6, "{formula} for {exact}");
        let law = EosStrength { temperature: None, ..of(shock(), COPPER) };
        for dt in [1e-9, 1e-8, 1e-7] {
            // Elastic strain to the yield surface first, then flow at about the rate.
            let gamma = 3f64.sqrt() * (rate * dt) + formula * 1e6 / (3f64.sqrt() * SHEAR);
            let point = sheared(&law, strain, temperature, gamma / dt, dt);
            let increment = point.value(Column::PlasticStrain) - strain;
            let rate = point.value(Column::PlasticStrainRate);
            let exact = johnson_cook(&COPPER, strain + increment, rate, temperature);
            let found = equivalent(&point.stress());
            assert!((found / exact - 1.0).abs() < 1e-11, "{found} for {exact}");
        }
    }
    // V12, machining: no rate, no heat.
    let steel = JohnsonCook {
        initial: 980e6,
        hardening: 2000e6,
        exponent: 0.83,
        sensitivity: 0.0,
        softening: 0.0,
        ..COPPER
    };
    for (strain, exact) in [(0.1, 1275.821678), (0.5, 2105.058485)] {
        assert!((johnson_cook(&steel, strain, 0.0, 0.0) * 1e-6 - exact).abs() < 1e-6);
        let law = of(soft(1e11), steel);
        let point = sheared(&law, strain, 0.0, 1e5, 1e-6);
        let strain = point.value(Column::PlasticStrain);
        let exact = johnson_cook(&steel, strain, 0.0, 0.0);
        assert!((equivalent(&point.stress()) / exact - 1.0).abs() < 1e-11);
    }
}

#[test]
fn the_plastic_increment_solves_its_equation_from_any_start() {
    let swift = Swift { shear: SHEAR, initial: 1e8, hardening: 5e8, plateau: 0.01, exponent: 0.4 };
    let law_of = |strain: f64| 1e8 + 5e8 * (strain - 0.01).max(0.0).powf(0.4);
    for strain in [0.0, 1e-9, 0.004, 0.0099999, 0.01, 0.3] {
        for gamma in [1e-3, 0.005, 0.02, 0.3] {
            let law = of(soft(1e11), swift);
            let point = sheared(&law, strain, 0.0, gamma / 1e-6, 1e-6);
            let new = point.value(Column::PlasticStrain);
            let [found, exact] = [equivalent(&point.stress()), law_of(new)];
            assert!(found <= exact * (1.0 + 1e-11), "{strain} {gamma}");
            if new > strain {
                assert!((found / exact - 1.0).abs() < 1e-11, "{strain} {gamma}: {found} {exact}");
            }
        }
        for gamma in [1e-4, 0.01, 0.3] {
            for temperature in [298.0, 800.0, 1300.0] {
                let law = of(shock(), COPPER);
                let point = sheared(&law, strain, temperature, gamma / 1e-7, 1e-7);
                let new = point.value(Column::PlasticStrain);
                let rate = point.value(Column::PlasticStrainRate);
                let exact = johnson_cook(&COPPER, new, rate, temperature);
                let found = equivalent(&point.stress());
                assert!(found <= exact * (1.0 + 1e-11));
                if new > strain {
                    assert!((found / exact - 1.0).abs() < 1e-11, "{strain} {gamma} {temperature}");
                }
            }
        }
    }
}

#[test]
fn particles_are_solved_whatever_their_neighbours_do() {
    let law = of(shock(), COPPER);
    let rates = [0.0, 1e3, 1e5, 1e6, 3e6, 1e7, 5e5];
    let mut together = Point::new(&law, 3, DESCRIPTIONS[0]);
    together.set(Column::Temperature, 400.0);
    for _ in 0..5 {
        together.step_each(&rates.map(shear), 1e-8);
    }
    for (p, rate) in rates.into_iter().enumerate() {
        let mut alone = Point::new(&law, 3, DESCRIPTIONS[0]);
        alone.set(Column::Temperature, 400.0);
        for _ in 0..5 {
            alone.step(&shear(rate), 1e-8);
        }
        for column in law.columns(3).iter() {
            let [a, b] = [together.state().value(column, p), alone.value(column)];
            assert_eq!(a.to_bits(), b.to_bits(), "{column:?} of {p}");
        }
    }
}

#[test]
fn molten_and_strengthless_matter_carries_no_deviator() {
    let law = of(shock(), COPPER);
    let point = sheared(&law, 0.1, 1356.0, 1e6, 1e-8);
    assert_eq!(equivalent(&point.stress()), 0.0);
    let law = of(soft(1e9), Plastic { shear: 1e9, yield_stress: 0.0 });
    let point = sheared(&law, 0.0, 0.0, 1.0, 0.1);
    assert_eq!(equivalent(&point.stress()), 0.0);
    let still = sheared(&law, 0.0, 0.0, 0.0, 0.1);
    assert_eq!(still.stress(), Tensor::zeros());
}

#[test]
fn uniaxial_strain_of_a_perfectly_plastic_solid_has_its_closed_form() {
    let (bulk, shear, yield_stress) = (1e11, 5e10, 3e8);
    let law = of(soft(bulk), Plastic { shear, yield_stress });
    let lambda = bulk - 2.0 / 3.0 * shear;
    let elastic = Elastic { density: 8960.0, lambda, shear, thermal: Thermal::default() };
    let hardening = 2e9;
    let hard = VonMises { elastic, yield_stress, hardening };
    for dimension in 1..=3 {
        for description in DESCRIPTIONS {
            for compression in [-1.0, 1.0] {
                let [mut point, mut hard] =
                    [&law as &dyn Law, &hard].map(|l| Point::new(l, dimension, description));
                let steps = 200;
                let mut l = Tensor::zeros();
                for _ in 0..steps {
                    let stretch = point.value(Column::J);
                    // In total Lagrangian descriptions the rate is dF/dt.
                    l[(0, 0)] = match description {
                        Description::Total => -compression * 0.01,
                        Description::Updated(_) => -compression * 0.01 / stretch,
                    };
                    point.step(&l, 1.0 / f64::from(steps));
                    hard.step(&l, 1.0 / f64::from(steps));
                    assert!(point.copies_agree() && hard.copies_agree());
                }
                let j = 1.0 - 0.01 * compression;
                assert!((point.value(Column::J) - j).abs() < 1e-13);
                let exact = -bulk * (1.0 - j) - compression * 2.0 / 3.0 * yield_stress;
                let found = point.stress()[(0, 0)];
                // Round-off of J, times K over the stress.
                assert!((found / exact - 1.0).abs() < 1e-10, "{dimension} {description:?}");
                // q = 2 G |e| up to Y, so ep = 2/3 |e| - Y/(3 G), e the logarithmic strain; sums of
                // increments l dt in place of ln J, to half the step.
                let strain = j.ln().abs();
                let exact = 2.0 / 3.0 * strain - yield_stress / (3.0 * shear);
                let bound = 1e-4 / f64::from(steps);
                assert!((point.value(Column::PlasticStrain) - exact).abs() < bound);
                let exact = (2.0 * shear * strain - yield_stress) / (3.0 * shear + hardening);
                assert!((hard.value(Column::PlasticStrain) - exact).abs() < bound);
                let q = equivalent(&hard.stress());
                let exact = yield_stress + hardening * hard.value(Column::PlasticStrain);
                assert!((q / exact - 1.0).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn shock_pressures_are_the_published_ones() {
    // V11: eta, GPa.
    let table =
        [(0.98, -2.728750), (1.02, 2.836483), (1.05, 7.303889), (1.1, 15.360791), (1.2, 34.107929)];
    for (eta, exact) in table {
        let found = pressure(&shock(), 1.0 / eta) * 1e-9;
        assert!((found - exact).abs() < 6e-7, "{found} for {exact}");
    }
    // V17: Gamma = 0 is the Hugoniot itself: GPa at two densities.
    let hugoniot = Shock { gamma: 0.0, ..shock() };
    for (density, exact) in [(10030.61775600, 20.98656), (10983.03002935, 48.64384)] {
        let found = pressure(&hugoniot, 8960.0 / density) * 1e-9;
        assert!((found - exact).abs() < 1e-8, "{found} for {exact}");
    }
}

/// Seven particles at rest with one value of a column, in the hands of `act`.
fn seven_with(column: Column, value: f64, act: impl FnOnce(&mut Chunk<'_>)) -> State {
    let mut state = State::default();
    (state.dimension, state.len) = (3, 7);
    (0..7).for_each(|p| state.set_value(column, p, value));
    act(&mut Chunk {
        state: &mut state,
        dt: 1.0,
        gradient: &mut [NOTHING; 9],
        rotation: &mut [NOTHING; 9],
        before: &mut { NOTHING },
        cell: 1.0,
        failed: None,
        clipped: 0,
    });
    state
}

/// p of a volume ratio.
fn pressure(eos: &dyn Eos, j: f64) -> f64 {
    let mut lane = NOTHING;
    seven_with(Column::J, j, |chunk| eos.pressure(chunk, false, &mut lane));
    lane[1][2]
}

#[test]
fn pressures_and_stiffnesses_are_tangent_and_go_on_beyond_the_pole() {
    let fluid = eos::fluid::Fluid { density: 1000.0, bulk: 3e5, exponent: 7.0 };
    assert!((pressure(&fluid, 1.0 / 1.01) / (3e5 * (1.01f64.powi(7) - 1.0)) - 1.0).abs() < 1e-12);
    let curve = Shock { bulk: 1.0, ..shock() };
    let all: [&dyn Eos; 2] = [&curve, &fluid];
    for eos in all {
        for j in [0.5, 0.8, 1.0, 1.1] {
            let h = 1e-5;
            let slope = -(pressure(eos, j + h) - pressure(eos, j - h)) / (2.0 * h) * j;
            let mut state = State::default();
            (state.dimension, state.len) = (3, 1);
            state.set_value(Column::J, 0, j);
            let mut lane = NOTHING;
            eos.stiffness(&state, &mut lane);
            assert!((lane[0][0] / slope - 1.0).abs() < 1e-6, "{j}: {} {slope}", lane[0][0]);
        }
    }
    let pole = 1.489 / 0.489;
    let last = 0.98 * pole;
    let at = |eta: f64| pressure(&curve, 1.0 / eta);
    let h = 1e-6;
    let [before, after] = [(at(last) - at(last - h)) / h, (at(last + h) - at(last)) / h];
    assert!((before / after - 1.0).abs() < 1e-3, "{before} {after}");
    assert!((at(4.0 * pole) - at(last)) / (after * (4.0 * pole - last)) - 1.0 < 1e-3);
    let law = of(curve, strength::fluid::Fluid { viscosity: 0.0 });
    let mut point = Point::new(&law, 1, DESCRIPTIONS[0]);
    let mut l = Tensor::zeros();
    l[(0, 0)] = 1.0 / (2.0 * pole) - 1.0;
    point.step(&l, 1.0);
    assert_eq!((point.failed, point.clipped), (None, 7));
}

#[test]
fn a_viscous_fluid_is_newtonian_and_keeps_no_deviator() {
    let law = of(soft(1e6), strength::fluid::Fluid { viscosity: 3.0 });
    for dimension in 2..=3 {
        let mut point = Point::new(&law, dimension, DESCRIPTIONS[0]);
        point.step(&shear(5.0), 1e-3);
        assert!((point.stress()[(0, 1)] - 15.0).abs() < 1e-12);
        point.step(&Tensor::zeros(), 1e-3);
        assert!(equivalent(&point.stress()) < 1e-12);
        assert!(point.stored_energy().is_finite());
    }
    assert_eq!(law.viscosity(), 3.0);
}

#[test]
fn artificial_viscosity_acts_in_compression_only() {
    let viscous = Shock { quadratic: 2.0, linear: 0.2, ..shock() };
    let law = of(viscous, strength::fluid::Fluid { viscosity: 0.0 });
    let calm = of(shock(), strength::fluid::Fluid { viscosity: 0.0 });
    for rate in [-1e4, 1e4] {
        let [mut point, mut without] =
            [&law as &dyn Law, &calm].map(|l| Point::new(l, 1, DESCRIPTIONS[0]));
        (point.cell, without.cell) = (1e-3, 1e-3);
        let mut l = Tensor::zeros();
        l[(0, 0)] = rate;
        point.step(&l, 1e-7);
        without.step(&l, 1e-7);
        let j = 1.0 + rate * 1e-7;
        let exact = match rate < 0.0 {
            true => {
                let h = 1e-3;
                8960.0 / j * h * (2.0 * h * rate * rate - 0.2 * 3940.0 * j.sqrt() * rate)
            }
            false => 0.0,
        };
        let found = (without.stress() - point.stress()).trace() / 3.0;
        assert!((found - exact).abs() < 1e-9 * (1.0 + without.stress().norm()), "{found} {exact}");
    }
}

#[test]
fn plastic_work_heats_and_heat_presses() {
    let heating = PlasticWork { expansion: 1.7e-5, ..heat() };
    let mut law = of(soft(1e11), Plastic { shear: SHEAR, yield_stress: 3e8 });
    law.temperature = Some(Arc::new(heating));
    let mut point = Point::new(&law, 3, DESCRIPTIONS[0]);
    assert_eq!(point.value(Column::Temperature), 298.0);
    for _ in 0..50 {
        point.step(&shear(1e5), 1e-7);
    }
    let work = 3e8 * point.value(Column::PlasticStrain);
    let warmer = point.value(Column::Temperature) - 298.0;
    let exact = 0.9 * work / (8960.0 * 383.0);
    // The shape is kept: J = 1 to the square of the increments.
    assert!((warmer / exact - 1.0).abs() < 1e-3 && warmer > 1.0, "{warmer} {exact}");
    let j = point.value(Column::J);
    let before = point.value(Column::Temperature);
    point.step(&Tensor::zeros(), 1e-7);
    let pressure = -point.stress().trace() / 3.0;
    let exact = 1e11 * (1.0 - j) + 3.0 * 1e11 * 1.7e-5 * (before - 298.0);
    assert!((pressure / exact - 1.0).abs() < 1e-9, "{pressure} {exact}");
    point.set(Column::Temperature, 1400.0);
    point.step(&shear(1e6), 1e-7);
    assert_eq!(point.value(Column::Temperature), 1400.0, "no heating above Tm");
    assert_eq!(heating.power(1400.0, 1.0, 1.0), 0.0);
}

fn failure(d: [f64; 5]) -> DamageJohnsonCook {
    DamageJohnsonCook { d, reference_rate: 1.0, reference: 298.0, melting: 1356.0 }
}

#[test]
fn failure_strains_are_the_published_ones() {
    // V11 and V12: triaxiality, failure strain.
    let copper = failure([0.54, 4.89, -3.03, 0.014, 1.12]);
    let steel = failure([0.05, 0.8, -0.44, 0.0, 0.0]);
    let table = [
        (copper, 0.0, 5.43),
        (copper, 1.0 / 3.0, 2.32103081),
        (steel, -1.0, 1.29216577),
        (steel, 0.0, 0.85),
        (steel, 1.0 / 3.0, 0.740865433),
    ];
    for (law, triaxiality, exact) in table {
        let mut stages = Stages::default();
        for group in 0..2 {
            stages.pressure[group] = [-triaxiality * 7.0; 4];
            stages.equivalent[group] = [7.0; 4];
            stages.increment[group] = [0.5; 4];
        }
        let state = seven_with(Column::Temperature, 298.0, |chunk| law.grow(chunk, &mut stages));
        let found = 0.5 / state.value(Column::DamageInitiation, 6);
        assert!((found / exact - 1.0).abs() < 5e-9, "{found} for {exact}");
        assert_eq!(state.value(Column::Damage, 6), 0.0);
    }
}

#[test]
fn damage_grows_from_initiation_to_failure_and_failed_particles_carry_nothing() {
    let mut law = of(soft(1e11), Plastic { shear: SHEAR, yield_stress: 3e8 });
    law.damage = Some(Arc::new(failure([0.05, 0.0, 0.0, 0.0, 0.0])));
    for description in DESCRIPTIONS {
        let mut point = Point::new(&law, 3, description);
        let mut last = [0.0; 2];
        for _ in 0..400 {
            point.step(&shear(1e5), 2e-8);
            assert_eq!(point.failed, None);
            assert!(point.stored_energy() >= 0.0 && point.elastic_strain().norm() < 1.0);
            let [begun, damage] =
                [Column::DamageInitiation, Column::Damage].map(|c| point.value(c));
            assert!(begun >= last[0] && damage >= last[1] && damage <= 1.0);
            let exact = point.value(Column::PlasticStrain) / 0.05;
            assert!((begun - exact).abs() < 1e-9, "{begun} {exact}");
            assert!((damage - (10.0 * (begun - 1.0)).clamp(0.0, 1.0)).abs() < 1e-12);
            let q = equivalent(&point.stress());
            assert!(q <= 3e8 * (1.0 - last[1]) * (1.0 + 1e-9));
            last = [begun, damage];
        }
        assert_eq!((last[1], point.stress()), (1.0, Tensor::zeros()));
        assert_eq!((point.wave_speed(), point.stored_energy()), (0.0, 0.0));
        let j = point.value(Column::J);
        point.step(&(Tensor::identity() * -1e9), 1.0);
        assert_eq!((point.failed, point.value(Column::J)), (None, j), "turned inside out");
    }
}

#[test]
fn tension_is_damaged_once_and_compression_is_not() {
    let mut law = of(soft(1e9), strength::linear::Linear { shear: 1e9 });
    law.damage = Some(Arc::new(failure([1.0, 0.0, 0.0, 0.0, 0.0])));
    for (rate, factor) in [(1e-3, 0.75), (-1e-3, 1.0)] {
        let mut point = Point::new(&law, 3, DESCRIPTIONS[0]);
        point.set(Column::Damage, 0.25);
        point.step(&(Tensor::identity() * rate), 1.0);
        let exact = factor * 1e9 * (point.value(Column::J) - 1.0);
        assert!((point.stress()[(0, 0)] / exact - 1.0).abs() < 1e-9);
        assert!((point.stress() - Tensor::identity() * exact).norm() < 1e-9 * exact.abs());
    }
}
