//! Mohr-Coulomb plasticity of soils: a pyramid of six planes in the space of principal stresses.

use super::granular::{CONSTANTS, Granular, Strength, Surface, exists};
use super::state::PLACES;
use super::{BuildMaterial, Elastic};
use crate::math::principal::{Principal, principal};
use crate::math::v4::Wide;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildMaterial> = Style {
    name: "mohr-coulomb",
    usage: "rho, E, nu, c, phi, psi [, sigma_t [, H, c_res, phi_res, psi_res]]",
    summary: "Mohr-Coulomb plasticity of soils: six planes in principal stresses",
    manual: "\
Hooke's law for the rate of the stress (see `linear`); then, with principal stresses
s1 >= s2 >= s3, tension positive, (s1 - s3) + (s1 + s3) sin phi <= 2 c cos phi. The return along
C : dg/dsigma of the same g with psi in place of phi meets the plane of s1 and s3; an edge s1 = s2
or s2 = s3 where the plane would exchange two of them; the apex s1 = s2 = s3 = c cot phi beyond both.
phi = 0: Tresca's law. At last s1 <= sigma_t (default: the apex) by the associated return: s1 flows
and takes lambda/(lambda + 2 G) of its fall from s2 and s3; s2 and s3 do the same when they reach
sigma_t. ep grows by sqrt(2/3) |dev dep|. Softening: c, phi, psi go linearly to c_res, phi_res,
psi_res with the part min(1, H ep/(c - c_res)), solved within the step.
rho [M/L^d], E [P], -1 < nu < 0.5, c, sigma_t, H, c_res >= 0 [P], angles in degrees from 0 below 90,
c_res < c. Wave speed sqrt((K + 4 G/3)/rho). Stored energy V sigma : C^-1 sigma/2.
A volume that tension has opened is not remembered: the material resists as soon as it is pressed.
Source: Koiter 1953; de Souza Neto, Peric and Owen 2008, section 8.2.",
    build: Some(|args, _| Ok(Arc::new(Granular::read(args, |_| false, |_| Ok(MohrCoulomb))?))),
};

/// (s1 - s3) + (s1 + s3) sin phi <= 2 c cos phi.
///
/// # Source  de Souza Neto, Peric and Owen 2008, section 8.2; language.md 9.4
#[derive(Clone, Copy, Debug)]
pub struct MohrCoulomb;

impl Surface for MohrCoulomb {
    /// sin phi, sin psi, c cos phi, the limit of s1, and the scale of the inscribed cone
    /// sqrt(J2) + scale (sm sin phi - c cos phi) = 0.
    fn constants(&self, _: &Elastic, strength: &Strength, limit: f64) -> [f64; CONSTANTS] {
        let Strength { cohesion, friction, dilatancy } = *strength;
        let (sine, cosine) = friction.sin_cos();
        let inscribed = (3.0 / (3.0 + sine * sine)).sqrt();
        [sine, dilatancy.sin(), cohesion * cosine, limit, inscribed]
    }

    /// Inside the inscribed cone, and s1 <= sm + 2 sqrt(J2/3) <= limit.
    #[inline(always)]
    fn may_yield<V: Wide>(
        &[sine, _, cohesion, limit, inscribed]: &[V; CONSTANTS],
        mean: V,
        root: V,
    ) -> bool {
        let largest = V::splat(2.0 / 3f64.sqrt()).mul_add(root, mean);
        let strength = inscribed * (cohesion - sine * mean);
        strength.any_below(root) || limit.any_below(largest)
    }

    #[inline(always)]
    fn resolve<V: Wide, const D: usize>(stress: &[V; 6], _: V, _: V) -> Principal<V> {
        principal::<V, D>(*stress)
    }

    #[inline(always)]
    fn bring_back<V: Wide>(
        elastic: &Elastic,
        constants: &[V; CONSTANTS],
        values: [V; 3],
    ) -> [V; 3] {
        let largest = values[0].larger(values[1]).larger(values[2]);
        let least = values[0].smaller(values[1]).smaller(values[2]);
        // Without round-off: the one that is neither.
        let upper = values[0].larger(values[1]);
        let lower = values[0].smaller(values[1]);
        let middle = upper.smaller(values[2]).larger(lower);
        let trial = [largest, middle, least];
        let to = cut_off(elastic, constants[3], on_pyramid(elastic, constants, trial));
        let mut back = values;
        for n in 0..3 {
            let other = least.below(values[n], to[1], to[2]);
            back[n] = values[n].below(largest, other, to[0]);
        }
        back
    }

    #[inline(always)]
    fn flow<V: Wide>(elastic: &Elastic, from: [V; 3], to: [V; 3]) -> V {
        let change = [from[0] - to[0], from[1] - to[1], from[2] - to[2]];
        let mean = V::splat(1.0 / 3.0) * (change[0] + change[1] + change[2]);
        let mut square = V::splat(0.0);
        for n in 0..3 {
            let s = change[n] - mean;
            square = s.mul_add(s, square);
        }
        V::splat((2f64 / 3.0).sqrt() / (2.0 * elastic.shear)) * square.sqrt()
    }

    /// sigma + sum (to - value) n (x) n.
    #[inline(always)]
    fn assemble<V: Wide, const D: usize>(
        stress: &[V; 6],
        Principal { values, directions }: &Principal<V>,
        to: [V; 3],
    ) -> [V; 6] {
        let mut changed = *stress;
        for n in 0..6 {
            let (i, j) = PLACES[n];
            if i >= D {
                changed[n] = changed[n] + (to[i] - values[i]);
            } else if exists::<D>(n) {
                for k in 0..D {
                    let both = directions[3 * i + k] * directions[3 * j + k];
                    changed[n] = both.mul_add(to[k] - values[k], changed[n]);
                }
            }
        }
        changed
    }
}

/// The return of ordered principal stresses to the pyramid: to its plane, to the edge that the
/// return to the plane would cross first, or to the apex.
///
/// With the flow m = (1 + sin psi, 0, -(1 - sin psi)) of the plane of s1 and s3, C m = volume +
/// 2 G m; two equal stresses share the flows of the two planes that meet in their edge.
#[inline(always)]
fn on_pyramid<V: Wide>(
    elastic: &Elastic,
    &[sin_phi, sin_psi, cohesion, apex, _]: &[V; CONSTANTS],
    trial: [V; 3],
) -> [V; 3] {
    let [s1, s2, s3] = trial;
    let (zero, one, half) = (V::splat(0.0), V::splat(1.0), V::splat(0.5));
    let (lambda, shear) = (V::splat(2.0 * elastic.lambda), V::splat(2.0 * elastic.shear));
    let (up, down) = (one + sin_phi, one - sin_phi);
    let strength = cohesion + cohesion;
    let volume = lambda * sin_psi;
    let (rise, fall) = (shear * (one + sin_psi), shear * (one - sin_psi));
    let common = (sin_phi + sin_phi) * volume;
    let plane = common + up * rise + down * fall;

    let beyond = up * s1 - down * s3 - strength;
    let step = beyond.larger(zero) / plane;
    let on_plane = [s1 - step * (volume + rise), s2 - step * volume, s3 - step * (volume - fall)];

    // s1 = s2: the plane of s2 and s3 joins in.
    let step = (beyond + (up * s2 - down * s3 - strength)) / (plane + common + down * fall);
    let high = half * (s1 + s2) - step * (volume + half * rise);
    let compression = [high, high, s3 - step * (volume - fall)];

    // s2 = s3: the plane of s1 and s2 joins in.
    let step = (beyond + (up * s1 - down * s2 - strength)) / (plane + common + up * rise);
    let low = half * (s2 + s3) - step * (volume - half * fall);
    let extension = [s1 - step * (volume + rise), low, low];

    let side = fall * s1 - (rise + fall) * s2 + rise * s3;
    let mut back = trial;
    let crossed = (on_plane[1] - on_plane[0]).larger(on_plane[2] - on_plane[1]);
    let edge = side.below(zero, compression[0], extension[0]);
    for n in 0..3 {
        let on_edge = side.below(zero, compression[n], extension[n]);
        // Beyond the apex, s1 sin phi > c cos phi on both edges.
        let on_edge = cohesion.below(edge * sin_phi, apex, on_edge);
        let returned = zero.below(crossed, on_edge, on_plane[n]);
        back[n] = zero.below(beyond, returned, trial[n]);
    }
    back
}

/// s1 <= limit by the associated flow of s1, of s1 and s2, or of all three.
#[inline(always)]
fn cut_off<V: Wide>(elastic: &Elastic, limit: V, [s1, s2, s3]: [V; 3]) -> [V; 3] {
    let zero = V::splat(0.0);
    let Elastic { lambda, shear, .. } = *elastic;
    let (beyond, next) = ((s1 - limit).larger(zero), s2 - limit);
    let fall = V::splat(lambda / (lambda + 2.0 * shear)) * beyond;
    // Where s2 reaches the limit too, the two flow together.
    let both = V::splat(0.5 * lambda / (lambda + shear)) * (beyond + next);
    let fall_of_third = fall.below(next, both, fall);
    [s1.smaller(limit), (s2 - fall).smaller(limit), (s3 - fall_of_third).smaller(limit)]
}
