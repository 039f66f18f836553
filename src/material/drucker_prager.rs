//! Drucker-Prager plasticity of soils: a cone about the axis of pressure.

use super::granular::{CONSTANTS, Granular, Strength, Surface, exists};
use super::{BuildMaterial, Elastic};
use crate::math::principal::Principal;
use crate::math::v4::Wide;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildMaterial> = Style {
    name: "drucker-prager",
    usage: "rho, E, nu, c, phi, psi [, sigma_t [, H, c_res, phi_res, psi_res]] [, inner|plane-strain]",
    summary: "Drucker-Prager plasticity of soils: a cone about the axis of pressure",
    manual: "\
Hooke's law for the rate of the stress (see `linear`); then sqrt(J2) + a sm <= k with
sm = tr sigma/3, tension positive: dg = f/(G + K a b), sqrt(J2) -= G dg, sm -= K b dg, at the least
the apex s = 0, sm = c cot phi; at last sm <= sigma_t (default: the apex). The cone meets that of
`mohr-coulomb` in triaxial compression: a = 6 sin phi/(sqrt3 (3 - sin phi)),
k = 6 c cos phi/(sqrt3 (3 - sin phi)); with `inner` in triaxial extension: 3 + sin phi in both
denominators; with `plane-strain` in plane strain without dilatancy: a = 3 tan phi/w, k = 3 c/w,
w = sqrt(9 + 12 tan^2 phi); `outer` names the default. b is a of psi: the plastic strain grows by
dg (s/(2 sqrt(J2)) + b I/3), ep by dg/sqrt3 = sqrt(2/3) |dev dep|. Softening: c, phi, psi go
linearly to c_res, phi_res, psi_res with the part min(1, H ep/(c - c_res)), solved within the step.
rho [M/L^d], E [P], -1 < nu < 0.5, c, sigma_t, H, c_res >= 0 [P], angles in degrees from 0 below 90,
c_res < c. Wave speed sqrt((K + 4 G/3)/rho). Stored energy V sigma : C^-1 sigma/2.
A volume that tension has opened is not remembered: the material resists as soon as it is pressed.
Source: Drucker and Prager 1952; de Souza Neto, Peric and Owen 2008, section 8.3.",
    build: Some(|args, _| {
        let is_last_word = |word: &str| FITS.iter().any(|fit| fit.0 == word);
        let law = Granular::read(args, is_last_word, |args| {
            let given = FITS.iter().find(|fit| args.keyword(fit.0));
            Ok(DruckerPrager { fit: given.map_or(Fit::Outer, |fit| fit.1) })
        })?;
        Ok(Arc::new(law))
    }),
};

/// Words of the fits.
const FITS: [(&str, Fit); 3] =
    [("outer", Fit::Outer), ("inner", Fit::Inner), ("plane-strain", Fit::PlaneStrain)];

/// Where the cone meets the pyramid of Mohr and Coulomb.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// In triaxial compression.
    Outer,
    /// In triaxial extension.
    Inner,
    /// In plane strain without dilatancy: the inscribed cone.
    PlaneStrain,
}

impl Fit {
    /// a, and k/(c cos phi), of an angle of friction.
    pub fn cone(self, friction: f64) -> [f64; 2] {
        let sine = friction.sin();
        let root = 3f64.sqrt();
        let scale = match self {
            Fit::Outer => 6.0 / (root * (3.0 - sine)),
            Fit::Inner => 6.0 / (root * (3.0 + sine)),
            // 3/(w cos phi) with w = sqrt(9 + 12 tan^2 phi).
            Fit::PlaneStrain => root / (3.0 + sine * sine).sqrt(),
        };
        [scale * sine, scale]
    }
}

/// sqrt(J2) + a sm <= k.
///
/// # Source  de Souza Neto, Peric and Owen 2008, section 8.3; language.md 9.4
#[derive(Clone, Copy, Debug)]
pub struct DruckerPrager {
    /// Which cone.
    pub fit: Fit,
}

impl Surface for DruckerPrager {
    /// a, k, the limit of sm, and what a unit of f takes off sqrt(J2) and sm.
    fn constants(&self, elastic: &Elastic, strength: &Strength, limit: f64) -> [f64; CONSTANTS] {
        let [a, scale] = self.fit.cone(strength.friction);
        let [b, _] = self.fit.cone(strength.dilatancy);
        let (bulk, shear) = (elastic.bulk(), elastic.shear);
        let inverse = 1.0 / (shear + bulk * a * b);
        let k = scale * strength.cohesion * strength.friction.cos();
        [a, k, limit, shear * inverse, bulk * b * inverse]
    }

    #[inline(always)]
    fn may_yield<V: Wide>(&[a, k, limit, ..]: &[V; CONSTANTS], mean: V, root: V) -> bool {
        k.any_below(a.mul_add(mean, root)) || limit.any_below(mean)
    }

    #[inline(always)]
    fn resolve<V: Wide, const D: usize>(_: &[V; 6], mean: V, root: V) -> Principal<V> {
        let zero = V::splat(0.0);
        Principal { values: [mean, root, zero], directions: [zero; 9] }
    }

    /// Beyond the apex sqrt(J2) would become negative, and sm greater than that of the apex.
    #[inline(always)]
    fn bring_back<V: Wide>(
        _: &Elastic,
        &[a, k, limit, shear, volume]: &[V; CONSTANTS],
        [mean, root, rest]: [V; 3],
    ) -> [V; 3] {
        let zero = V::splat(0.0);
        let beyond = (a.mul_add(mean, root) - k).larger(zero);
        let mean = (mean - volume * beyond).smaller(limit);
        [mean, (root - shear * beyond).larger(zero), rest]
    }

    #[inline(always)]
    fn flow<V: Wide>(elastic: &Elastic, [_, from, _]: [V; 3], [_, to, _]: [V; 3]) -> V {
        V::splat(1.0 / (3f64.sqrt() * elastic.shear)) * (from - to)
    }

    #[inline(always)]
    fn assemble<V: Wide, const D: usize>(
        stress: &[V; 6],
        resolved: &Principal<V>,
        [to_mean, to_root, _]: [V; 3],
    ) -> [V; 6] {
        let [mean, root, _] = resolved.values;
        let scale = to_root / root.larger(V::splat(f64::MIN_POSITIVE));
        let mut changed = *stress;
        for n in 0..6 {
            if exists::<D>(n) {
                let new = if n < 3 {
                    scale.mul_add(stress[n] - mean, to_mean)
                } else {
                    scale * stress[n]
                };
                let kept = to_mean.below(mean, new, stress[n]);
                changed[n] = to_root.below(root, new, kept);
            }
        }
        changed
    }
}
