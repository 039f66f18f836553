//! Closed forms of the laws of soils along paths of one particle (V22), and what every return to
//! their yield surfaces must do.

use super::drucker_prager::{DruckerPrager, Fit};
use super::granular::{Granular, Softening, Strength};
use super::mohr_coulomb::MohrCoulomb;
use super::point::Point;
use super::von_mises::VonMises;
use super::{Description, Elastic, Law, StressRate};
use crate::math::tensor::Tensor;
use crate::model::column::Column;
use nalgebra::{Rotation3, Vector3};

const JAUMANN: Description = Description::Updated(StressRate::Jaumann);

const COHESION: f64 = 10e3;

/// The soil of V22.
fn elastic() -> Elastic {
    Elastic::new(2100.0, 70e6, 0.3)
}

fn strength(cohesion: f64, phi: f64, psi: f64) -> Strength {
    Strength { cohesion, friction: phi.to_radians(), dilatancy: psi.to_radians() }
}

fn soil<S>(surface: S, strength: Strength) -> Granular<S> {
    Granular { elastic: elastic(), surface, strength, tension: f64::INFINITY, softening: None }
}

fn pyramid(psi: f64) -> Granular<MohrCoulomb> {
    soil(MohrCoulomb, strength(COHESION, 20.0, psi))
}

fn cone(fit: Fit, psi: f64) -> Granular<DruckerPrager> {
    soil(DruckerPrager { fit }, strength(COHESION, 20.0, psi))
}

fn diagonal(a: f64, b: f64, c: f64) -> Tensor {
    Tensor::from_diagonal(&Vector3::new(a, b, c))
}

/// Shear without spin.
fn shear(gamma: f64) -> Tensor {
    Tensor::new(0.0, 0.5 * gamma, 0.0, 0.5 * gamma, 0.0, 0.0, 0.0, 0.0, 0.0)
}

/// A particle under a given stress.
fn under<'a>(law: &'a dyn Law, dimension: usize, stress: &Tensor) -> Point<'a> {
    let mut point = Point::new(law, dimension, JAUMANN);
    use Column::*;
    for (column, place) in
        [(S11, (0, 0)), (S22, (1, 1)), (S33, (2, 2)), (S12, (0, 1)), (S13, (0, 2)), (S23, (1, 2))]
    {
        point.set(column, stress[place]);
    }
    point
}

fn strain_by(point: &mut Point<'_>, strain: &Tensor, steps: u32) {
    for _ in 0..steps {
        point.step(&(strain / f64::from(steps)), 1.0);
        assert!(point.failed.is_none() && point.copies_agree());
    }
}

fn near(found: f64, exact: f64, scale: f64, what: &str) {
    // Digits of the table.
    assert!((found - exact).abs() < 1e-10 * scale + 6e-7, "{what}: {found} for {exact}");
}

fn principal(sigma: &Tensor) -> [f64; 3] {
    let mut values: [f64; 3] = sigma.symmetric_eigenvalues().into();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// sm and sqrt(J2).
fn invariants(sigma: &Tensor) -> [f64; 2] {
    let mean = sigma.trace() / 3.0;
    [mean, ((sigma - Tensor::identity() * mean).norm_squared() / 2.0).sqrt()]
}

#[test]
fn oedometer_paths_are_piecewise_linear_whatever_the_steps() {
    // Axial and lateral pressure at strains of 1e-3 and 5e-3.
    let table: [(&dyn Law, [f64; 4]); 4] = [
        (&pyramid(0.0), [94230.769231, 40384.615385, 455930.968475, 209534.515762]),
        (&pyramid(20.0), [94230.769231, 40384.615385, 469412.859052, 216144.559936]),
        (&cone(Fit::Inner, 0.0), [93459.514477, 40770.242761, 422309.567264, 226345.216368]),
        (&cone(Fit::Inner, 20.0), [94027.821590, 41090.946914, 458300.983849, 246655.707810]),
    ];
    for (law, exact) in table {
        for dimension in 1..=3 {
            for steps in [1, 7, 1000] {
                for (strain, exact) in [(1e-3, &exact[..2]), (5e-3, &exact[2..])] {
                    let mut point = Point::new(law, dimension, JAUMANN);
                    strain_by(&mut point, &diagonal(-strain, 0.0, 0.0), steps);
                    let sigma = point.stress();
                    let what = format!("{dimension} {steps}");
                    near(-sigma[(0, 0)], exact[0], exact[0], &what);
                    near(-sigma[(1, 1)], exact[1], exact[0], &what);
                    near(-sigma[(2, 2)], exact[1], exact[0], &what);
                }
            }
        }
    }
}

/// Axial stress at the end of a triaxial test whose cell pressure is held at 50 kPa: the lateral
/// strain follows the plastic flow `ratio` and a correction that dies out if the ratio is right.
fn triaxial(law: &dyn Law, axial: f64, ratio: f64) -> [f64; 2] {
    let cell = -50e3;
    let Elastic { lambda, shear, .. } = elastic();
    let mut point = under(law, 3, &(Tensor::identity() * cell));
    for _ in 0..400 {
        let sigma = point.stress();
        let correction = (cell - sigma[(1, 1)]) / (2.0 * (lambda + shear));
        let lateral = axial * ratio + correction;
        point.step(&diagonal(axial, lateral, lateral), 1.0);
    }
    let sigma = point.stress();
    [sigma[(0, 0)], sigma[(1, 1)]]
}

#[test]
fn triaxial_strengths_and_dilatancies_are_those_of_the_closed_forms() {
    for psi in [0.0f64, 10.0, 20.0] {
        let sine = psi.to_radians().sin();
        let edge = [-0.5 * (1.0 + sine) / (1.0 - sine), -0.5 * (1.0 - sine) / (1.0 + sine)];
        let ratio = |fit: Fit| {
            let [b, _] = fit.cone(psi.to_radians());
            let root = 3f64.sqrt();
            [-1.0, 1.0].map(|way| (b / 3.0 - way * 0.5 / root) / (b / 3.0 + way / root))
        };
        let (mohr, outer, inner) = (pyramid(psi), cone(Fit::Outer, psi), cone(Fit::Inner, psi));
        let laws: [(&dyn Law, [f64; 2], [f64; 2]); 3] = [
            (&mohr, edge, [130543.296593, 10510.379064]),
            (&outer, ratio(Fit::Outer), [130543.296593, 2427.695398]),
            (&inner, ratio(Fit::Inner), [109815.201325, 10510.379064]),
        ];
        for (law, ratios, exact) in laws {
            for way in 0..2 {
                let axial = [-1e-4, 1e-4][way];
                let [found, cell] = triaxial(law, axial, ratios[way]);
                near(-found, exact[way], 130e3, "axial stress");
                near(-cell, 50e3, 130e3, "cell pressure");
                // Another dilatancy is seen: the cell pressure cannot be held.
                let [_, cell] = triaxial(law, axial, 0.9 * ratios[way]);
                assert!((cell / -50e3 - 1.0).abs() > 1e-3, "{psi} {way} {cell}");
            }
        }
    }
}

#[test]
fn plane_strain_shear_has_its_closed_forms() {
    let laws: [(&dyn Law, f64); 3] = [
        (&pyramid(0.0), 26497.933374),
        (&cone(Fit::Inner, 0.0), 27465.882868),
        (&cone(Fit::PlaneStrain, 0.0), 25995.955094),
    ];
    for (law, exact) in laws {
        for dimension in 2..=3 {
            for steps in [1, 50] {
                let mut point = under(law, dimension, &(Tensor::identity() * -50e3));
                strain_by(&mut point, &shear(4e-3), steps);
                near(point.stress()[(0, 1)], exact, exact, "shear");
                near(-point.stress()[(1, 1)], 50e3, 50e3, "pressure");
            }
        }
    }
}

#[test]
fn tension_ends_at_the_apex_or_at_the_cut_off() {
    let apex = 27474.774195;
    for psi in [0.0, 20.0] {
        for dimension in 1..=3 {
            for limit in [f64::INFINITY, 5e3, 0.0] {
                let mohr = Granular { tension: limit, ..pyramid(psi) };
                let drucker = Granular { tension: limit, ..cone(Fit::Outer, psi) };
                for law in [&mohr as &dyn Law, &drucker] {
                    let mut point = Point::new(law, 3, JAUMANN);
                    strain_by(&mut point, &diagonal(1e-2, 1e-2, 1e-2), 3);
                    let exact = Tensor::identity() * limit.min(apex);
                    assert!((point.stress() - exact).norm() < 1e-5);
                    // All directions of strain, with shear: nothing beyond the limit.
                    let mut point = Point::new(law, dimension, JAUMANN);
                    strain_by(&mut point, &(diagonal(1e-3, -2e-4, 0.0) + shear(1e-3)), 5);
                    assert!(point.stress().trace() / 3.0 <= limit * (1.0 + 1e-14) + 1e-9);
                }
            }
        }
        // Uniaxial strain: the stress stops at the cut-off, Poisson's part of it at the sides.
        let law = Granular { tension: 5e3, ..pyramid(psi) };
        let Elastic { lambda, shear, .. } = elastic();
        for dimension in 1..=3 {
            let mut point = Point::new(&law, dimension, JAUMANN);
            strain_by(&mut point, &diagonal(1e-3, 0.0, 0.0), 9);
            let lateral = lambda / (lambda + 2.0 * shear) * 5e3;
            let exact = diagonal(5e3, lateral, lateral);
            assert!((point.stress() - exact).norm() < 1e-7, "{dimension} {}", point.stress());
        }
        // Two directions: they pull together, and the third gets both their parts.
        let mut point = Point::new(&law, 3, JAUMANN);
        strain_by(&mut point, &diagonal(5e-4, 5e-4, 0.0), 9);
        let exact = diagonal(5e3, 5e3, lambda / (lambda + shear) * 5e3);
        assert!((point.stress() - exact).norm() < 1e-7, "{}", point.stress());
    }
}

#[test]
fn pressed_sand_at_rest_has_the_lateral_pressure_of_its_friction_or_of_hookes_law() {
    // Elastic K0 = nu/(1 - nu) = 3/7; less than the active (1 - sin phi)/(1 + sin phi) cannot be.
    for (phi, exact) in [(40.0, 3.0 / 7.0), (20.0, 1.0 / 2.03960673)] {
        let law = soil(MohrCoulomb, strength(0.0, phi, 0.0));
        let mut point = Point::new(&law, 2, JAUMANN);
        strain_by(&mut point, &diagonal(0.0, -1e-3, 0.0), 10);
        let found = point.stress()[(0, 0)] / point.stress()[(1, 1)];
        assert!((found / exact - 1.0).abs() < 2e-9, "{found} for {exact}");
        assert_eq!(point.value(Column::PlasticStrain) > 0.0, phi == 20.0);
    }
}

/// Numbers between -1 and 1 that look random (Knuth's linear congruential generator).
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A symmetric tensor about an axis of pressure.
fn stress(next: &mut impl FnMut() -> f64, pressure: f64, size: f64) -> Tensor {
    let a = Tensor::from_fn(|_, _| size * next());
    (a + a.transpose()) * 0.5 - Tensor::identity() * pressure
}

/// Elastic strain.
fn hooke(strain: &Tensor) -> Tensor {
    let Elastic { lambda, shear, .. } = elastic();
    strain * (2.0 * shear) + Tensor::identity() * (lambda * strain.trace())
}

fn hooke_inverse(sigma: &Tensor) -> Tensor {
    let elastic = elastic();
    let [mean, _] = invariants(sigma);
    (sigma - Tensor::identity() * mean) / (2.0 * elastic.shear)
        + Tensor::identity() * (mean / (3.0 * elastic.bulk()))
}

/// Stress and plastic strain after one step from no stress to an elastic trial stress.
fn returned(law: &dyn Law, trial: &Tensor) -> (Tensor, Tensor) {
    let mut point = Point::new(law, 3, JAUMANN);
    point.step(&hooke_inverse(trial), 1.0);
    assert!(point.copies_agree());
    let sigma = point.stress();
    let dep = hooke_inverse(&(trial - sigma));
    let deviator = dep - Tensor::identity() * (dep.trace() / 3.0);
    let exact = (2.0f64 / 3.0).sqrt() * deviator.norm();
    assert!((point.value(Column::PlasticStrain) - exact).abs() < 1e-13, "ep is sqrt(2/3) |dev|");
    (sigma, dep)
}

#[test]
fn returns_to_the_pyramid_end_on_it_and_flow_along_the_normals_of_its_potential() {
    let mut next = numbers(1);
    let mut kinds = [0; 4];
    for n in 0..4000 {
        let psi = [0.0, 7.0, 20.0][n % 3];
        let law = pyramid(psi);
        let trial = match n % 10 {
            // Two equal principal stresses, and an axis.
            0 => diagonal(-40e3, -40e3, -10e3 + 300e3 * next()),
            1 => diagonal(-20e3, 100e3 * next(), -20e3),
            _ => stress(&mut next, [20e3, 60e3, -10e3][n / 10 % 3], 60e3),
        };
        let (sigma, dep) = returned(&law, &trial);
        let [s1, s2, s3] = principal(&sigma);
        let (sine, cosine) = 20f64.to_radians().sin_cos();
        let f = |s1: f64, s3: f64| (s1 - s3) + (s1 + s3) * sine - 2.0 * COHESION * cosine;
        let scale = trial.norm();
        assert!(f(s1, s3) < 1e-10 * scale, "outside by {}", f(s1, s3));
        let size = dep.norm();
        if size < 1e-14 {
            assert!(sigma == trial || (sigma - trial).norm() < 1e-9);
            kinds[0] += 1;
            continue;
        }
        assert!(f(s1, s3) > -1e-10 * scale, "inside by {}", f(s1, s3));
        // Stress, trial stress and plastic strain share their axes.
        assert!((sigma * dep - dep * sigma).norm() < 1e-10 * size * scale);
        let [e1, e2, e3] = principal(&dep);
        let (zero, same) = (1e-9 * size, 1e-7 * scale);
        let least = psi.to_radians().sin() * (e1.abs() + e2.abs() + e3.abs());
        if s1 - s3 < same {
            assert!((s1 - COHESION * cosine / sine).abs() < 1e-9 * scale);
            // Beyond what the edges can take: at least their volume.
            assert!(dep.trace() > least - zero);
            kinds[3] += 1;
            continue;
        }
        // Every plane flows with the volume sin psi per sum of absolute strains.
        assert!((dep.trace() - least).abs() < zero, "{} for {least}", dep.trace());
        if s1 - s2 > same && s2 - s3 > same {
            assert!(e2.abs() < zero && e1 > 0.0 && e3 < 0.0, "plane: {e1} {e2} {e3}");
            kinds[1] += 1;
        } else {
            // No multiplier is negative: the equal pair flows one way, the third the other.
            match s1 - s2 <= same {
                true => assert!(e2 > -zero && e3 < 0.0, "s1 = s2: {e1} {e2} {e3}"),
                false => assert!(e2 < zero && e1 > 0.0, "s2 = s3: {e1} {e2} {e3}"),
            }
            kinds[2] += 1;
        }
        assert!(sigma.dot(&dep) > -1e-9 * size * scale, "dissipation is never negative");
    }
    assert!(kinds.iter().all(|count| *count > 100), "elastic, plane, edge, apex: {kinds:?}");
}

#[test]
fn returns_to_the_cone_end_on_it_and_flow_along_the_normals_of_its_potential() {
    let mut next = numbers(2);
    let mut kinds = [0; 3];
    for n in 0..2000 {
        let psi = [0.0, 7.0, 20.0][n % 3];
        let fit = [Fit::Outer, Fit::Inner, Fit::PlaneStrain][n / 3 % 3];
        let law = cone(fit, psi);
        let trial = stress(&mut next, [20e3, 60e3, -10e3][n / 9 % 3], 60e3);
        let (sigma, dep) = returned(&law, &trial);
        let ([a, scale_of_k], [b, _]) = (fit.cone(20f64.to_radians()), fit.cone(psi.to_radians()));
        let k = scale_of_k * COHESION * 20f64.to_radians().cos();
        let [mean, root] = invariants(&sigma);
        let f = root + a * mean - k;
        let scale = trial.norm();
        assert!(f < 1e-11 * scale);
        if dep.norm() < 1e-14 {
            kinds[0] += 1;
            continue;
        }
        assert!(f > -1e-11 * scale);
        let shear = (dep - Tensor::identity() * (dep.trace() / 3.0)).norm() * 2f64.sqrt();
        if root < 1e-9 * scale {
            assert!(dep.trace() >= b * shear * (1.0 - 1e-9));
            kinds[2] += 1;
        } else {
            // Volume b dg, shear dg along s.
            assert!((dep.trace() - b * shear).abs() < 1e-9 * dep.norm());
            let s = sigma - Tensor::identity() * mean;
            assert!((s.dot(&dep) - s.norm() * shear / 2f64.sqrt()).abs() < 1e-9 * s.norm() * shear);
            kinds[1] += 1;
        }
        assert!(sigma.dot(&dep) > -1e-9 * dep.norm() * scale);
    }
    assert!(kinds.iter().all(|count| *count > 40), "elastic, cone, apex: {kinds:?}");
}

#[test]
fn turning_the_path_turns_the_stress() {
    let mut next = numbers(3);
    for law in [&pyramid(7.0) as &dyn Law, &cone(Fit::Outer, 7.0)] {
        for _ in 0..200 {
            let axis = Vector3::new(next(), next(), next()) * 3.0;
            let q = Rotation3::new(axis).into_inner();
            let path = [10e3, 150e3, 80e3].map(|size| stress(&mut next, 0.3 * size, size));
            let [mut point, mut turned] = [0; 2].map(|_| Point::new(law, 3, JAUMANN));
            for trial in path {
                let strain = hooke_inverse(&trial);
                point.step(&strain, 1.0);
                turned.step(&(q * strain * q.transpose()), 1.0);
            }
            let exact = q * point.stress() * q.transpose();
            assert!((turned.stress() - exact).norm() < 1e-12 * 300e3);
        }
    }
}

#[test]
fn without_friction_they_are_tresca_and_von_mises() {
    let mut next = numbers(4);
    let cohesion = COHESION;
    let tresca = soil(MohrCoulomb, strength(cohesion, 0.0, 0.0));
    // The outer cone has k = 2 c/sqrt3: sigma_y = 2 c.
    let cone = soil(DruckerPrager { fit: Fit::Outer }, strength(cohesion, 0.0, 0.0));
    let exact = VonMises { elastic: elastic(), yield_stress: 2.0 * cohesion, hardening: 0.0 };
    for _ in 0..300 {
        let path = [30e3, 80e3].map(|size| {
            let pressure = 0.5 * size * next();
            stress(&mut next, pressure, size)
        });
        let [mut mohr, mut drucker, mut mises] =
            [&tresca as &dyn Law, &cone, &exact].map(|law| Point::new(law, 3, JAUMANN));
        for trial in path {
            for point in [&mut mohr, &mut drucker, &mut mises] {
                point.step(&hooke_inverse(&trial), 1.0);
            }
        }
        assert!((drucker.stress() - mises.stress()).norm() < 1e-10 * 300e3);
        let [found, exact] = [&drucker, &mises].map(|point| point.value(Column::PlasticStrain));
        assert!((found - exact).abs() < 1e-12);
        let [s1, _, s3] = principal(&mohr.stress());
        assert!(s1 - s3 < 2.0 * cohesion * (1.0 + 1e-10));
        assert!((mohr.stress().trace() - mises.stress().trace()).abs() < 1e-9 * 300e3);
    }
}

#[test]
fn matter_without_cohesion_carries_no_tension_and_without_friction_no_shear() {
    for phi in [0.0, 30.0] {
        let mohr = soil(MohrCoulomb, strength(0.0, phi, 0.0));
        let drucker = soil(DruckerPrager { fit: Fit::Inner }, strength(0.0, phi, 0.0));
        for law in [&mohr as &dyn Law, &drucker] {
            for dimension in 1..=3 {
                for strain in [
                    Tensor::zeros(),
                    diagonal(1e-3, 0.0, 0.0),
                    diagonal(-1e-3, 0.0, 0.0),
                    shear(1e-3),
                    diagonal(1e-3, 1e-3, 0.0),
                    diagonal(1e-300, 0.0, 0.0),
                    diagonal(-1e-300, 0.0, 0.0),
                ] {
                    let mut point = Point::new(law, dimension, JAUMANN);
                    strain_by(&mut point, &strain, 3);
                    let sigma = point.stress();
                    assert!(sigma.iter().all(|value| value.is_finite()), "{sigma}");
                    let [mean, root] = invariants(&sigma);
                    match phi > 0.0 {
                        true => assert!(mean <= 1e-11 && root < 1.2 * -mean + 1e-10),
                        false => assert!(root < 1e-10, "{root}"),
                    }
                }
            }
        }
    }
}

/// The soil of V22 in plane shear, whose strength falls along.
fn softened(
    law: Granular<impl super::granular::Surface + 'static>,
    softening: Softening,
    gamma: f64,
    steps: u32,
) -> [f64; 2] {
    let law = Granular { softening: Some(softening), ..law };
    let mut point = under(&law, 2, &(Tensor::identity() * -50e3));
    strain_by(&mut point, &shear(gamma), steps);
    [point.stress()[(0, 1)], point.value(Column::PlasticStrain)]
}

#[test]
fn softening_paths_are_piecewise_linear_whatever_the_steps() {
    let (pressure, shear) = (50e3, elastic().shear);
    let (sine, cosine) = 20f64.to_radians().sin_cos();
    let [a, scale] = Fit::Inner.cone(20f64.to_radians());
    for modulus in [1e6, 20e6, 1e9] {
        let softening =
            Softening { span: 6e3 / modulus, residual: strength(COHESION - 6e3, 20.0, 0.0) };
        for (slope, friction, kind) in
            [(cosine, pressure * sine, "mohr"), (scale * cosine, pressure * a, "drucker")]
        {
            for gamma in [1.2e-3, 2e-3, 2e-2] {
                // tau = G (gamma - g) = slope c(ep) + friction, g = sqrt3 ep.
                let fall = slope * modulus / 3f64.sqrt();
                let at_peak = slope * COHESION + friction;
                let at_rest = slope * (COHESION - 6e3) + friction;
                let g = (shear * gamma - at_peak) / (shear - fall);
                let falls = fall < shear && g < 3f64.sqrt() * softening.span;
                let exact = if falls { at_peak - fall * g } else { at_rest };
                for steps in [1, 7, 1000] {
                    let [tau, strain] = match kind {
                        "mohr" => softened(pyramid(0.0), softening, gamma, steps),
                        _ => softened(cone(Fit::Inner, 0.0), softening, gamma, steps),
                    };
                    assert!((tau / exact - 1.0).abs() < 1e-10, "{kind} {modulus} {gamma} {tau}");
                    let exact = (gamma - exact / shear) / 3f64.sqrt();
                    assert!((strain / exact - 1.0).abs() < 1e-9, "{strain} for {exact}");
                }
            }
        }
    }
}

#[test]
fn a_falling_angle_is_solved_within_the_step() {
    let residual = strength(2e3, 8.0, 0.0);
    let softening = Softening { span: 4e-3, residual };
    for (gamma, steps) in [(2e-3, 1), (4e-3, 3), (6e-3, 40), (1.0, 2)] {
        let [tau, strain] =
            softened(soil(MohrCoulomb, strength(COHESION, 20.0, 0.0)), softening, gamma, steps);
        let part = (strain / softening.span).min(1.0);
        let phi = (20.0 - 12.0 * part).to_radians();
        let exact = (COHESION - 8e3 * part) * phi.cos() + 50e3 * phi.sin();
        assert!((tau / exact - 1.0).abs() < 1e-11, "{tau} for {exact}");
        assert_eq!(gamma == 1.0, part == 1.0);
    }
}

#[test]
fn particles_return_whatever_their_neighbours_do() {
    let softening = Some(Softening { span: 4e-3, residual: strength(2e3, 8.0, 0.0) });
    let mohr = Granular { softening, ..pyramid(7.0) };
    let drucker = Granular { softening, ..cone(Fit::Inner, 7.0) };
    let mut next = numbers(5);
    for law in [&mohr as &dyn Law, &pyramid(7.0), &drucker] {
        let paths: [[Tensor; 7]; 4] = std::array::from_fn(|_| {
            std::array::from_fn(|p| hooke_inverse(&stress(&mut next, 20e3, 5e3 * (1 << p) as f64)))
        });
        let mut together = Point::new(law, 3, JAUMANN);
        paths.iter().for_each(|rates| together.step_each(rates, 1.0));
        for p in 0..7 {
            let mut alone = Point::new(law, 3, JAUMANN);
            paths.iter().for_each(|rates| alone.step(&rates[p], 1.0));
            for column in law.columns(3).iter() {
                let [a, b] = [together.state().value(column, p), alone.value(column)];
                assert_eq!(a.to_bits(), b.to_bits(), "{column:?} of {p}");
            }
        }
    }
}

#[test]
fn total_lagrangian_and_objective_rates_shear_to_the_same_strength() {
    // Simple shear at constant volume without dilatancy: the pressure stays, the axes turn.
    let descriptions = [
        JAUMANN,
        Description::Updated(StressRate::GreenNaghdi),
        Description::Updated(StressRate::Logarithmic),
        Description::Total,
    ];
    for (law, exact) in [
        (&pyramid(0.0) as &dyn Law, [-50e3 + 26497.933374, -50e3 - 26497.933374]),
        (&cone(Fit::Inner, 0.0), [-50e3 + 27465.882868, -50e3 - 27465.882868]),
    ] {
        for description in descriptions {
            let mut point = Point::new(law, 2, description);
            for column in [Column::S11, Column::S22, Column::S33] {
                point.set(column, -50e3);
            }
            let mut rate = Tensor::zeros();
            rate[(0, 1)] = 1e-3;
            // F of simple shear: dF/dt = L F = L.
            (0..600).for_each(|_| point.step(&rate, 1.0));
            let [s1, _, s3] = principal(&point.stress());
            near(s1, exact[0], 50e3, "s1");
            near(s3, exact[1], 50e3, "s3");
            // In the end stress and rate of strain share their axes, up to what turning within a
            // strain of tau/G leaves.
            assert!((point.stress()[(0, 1)] / (0.5 * (s1 - s3)) - 1.0).abs() < 1e-3);
        }
    }
}

#[test]
fn hookes_law_is_its_own_inverse_here() {
    let strain = diagonal(1e-3, -2e-3, 5e-4) + shear(1e-3);
    assert!((hooke_inverse(&hooke(&strain)) - strain).norm() < 1e-17);
}
