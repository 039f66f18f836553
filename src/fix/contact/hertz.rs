//! Contact of particles as elastic spheres.

use super::{Contact, ContactStyle};
use crate::fix::BuildFix;
use crate::kernel::pairs::{Pair, PairLaw, Response};
use crate::style::Style;
use crate::world::Solid;
use std::f64::consts::FRAC_PI_4;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "contact/hertz",
    usage: "s1, s2",
    summary: "Hertzian contact of the particles of two solids",
    manual: "\
H1, for particles of s1 and s2 that overlap: R = V^(1/d)/2, pen = R1 + R2 - r > 0. Force on 1 along
n from 2 to 1: (4/3) E* sqrt(R1 R2/(R1 + R2) pen^3), in one and two dimensions with PI/4 in place of
4/3; 1/E* = sum (1 - nu^2)/E, 0 for a rigid solid. Limits an adaptive dt to 0.2 sqrt(m/k), m the
smaller mass, k = dF/dpen.
Publishes the force on s1 in ID_x, ID_y, ID_z. Source: Hertz 1882.",
    build: Some(|_, target| {
        Ok(Box::new(Contact::new(target, Hertz { dimension: target.dimension })))
    }),
};

/// F = c E* sqrt(R1 R2/(R1 + R2) pen^3).
#[derive(Clone, Copy, Debug)]
pub struct Hertz {
    /// 1, 2 or 3.
    pub dimension: usize,
}

impl ContactStyle for Hertz {
    type Law = HertzLaw;

    fn law(&self, solids: [&Solid; 2], _dt: f64, _longest: f64) -> HertzLaw {
        let compliance: f64 = solids.iter().map(|solid| compliance(solid.law.moduli())).sum();
        let factor = if self.dimension == 3 { 4.0 / 3.0 } else { FRAC_PI_4 };
        HertzLaw { stiffness: factor / compliance }
    }
}

/// (1 - nu^2)/E = (3 K + 4 G)/(4 G (3 K + G)); 0 for a rigid body, infinite for a fluid.
fn compliance([bulk, shear]: [f64; 2]) -> f64 {
    match (bulk.is_finite(), shear > 0.0) {
        (true, true) => (3.0 * bulk + 4.0 * shear) / (4.0 * shear * (3.0 * bulk + shear)),
        (true, false) => f64::INFINITY,
        (false, _) => 0.0,
    }
}

/// The law of a pair.
#[derive(Clone, Copy, Debug)]
pub struct HertzLaw {
    /// c E* \[P\].
    pub stiffness: f64,
}

impl PairLaw for HertzLaw {
    fn respond(&self, pair: &Pair) -> Response {
        let [one, two] = pair.radii;
        let root = (one * two / (one + two) * pair.penetration).sqrt();
        let force = self.stiffness * root * pair.penetration;
        Response {
            force: pair.normal.map(|n| n * force),
            friction: 0.0,
            rate: 1.5 * self.stiffness * root / pair.smallest_mass,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_compliance_is_that_of_youngs_modulus() {
        let (young, nu) = (211.0, 0.33);
        let moduli = [young / (3.0 * (1.0 - 2.0 * nu)), young / (2.0 * (1.0 + nu))];
        let exact = (1.0 - nu * nu) / young;
        assert!((compliance(moduli) / exact - 1.0).abs() < 1e-14);
        assert_eq!(compliance([f64::INFINITY; 2]), 0.0);
    }

    #[test]
    fn fluids_do_not_push() {
        assert_eq!(1.0 / compliance([2e6, 0.0]), 0.0);
        assert_eq!(1.0 / compliance([0.0, 0.0]), 0.0);
    }
}
