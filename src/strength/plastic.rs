//! Perfect plasticity.

use super::linear_flow::{LinearFlow, flow_linearly};
use super::{BuildStrength, Strength};
use crate::material::Chunk;
use crate::material::stages::Stages;
use crate::model::column::Column;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildStrength> = Style {
    name: "plastic",
    usage: "G, sigma_y",
    summary: "von Mises plasticity without hardening",
    manual: "\
Y = sigma_y (1 - D); q = sqrt(3/2) |s| of the elastic trial is brought back to Y along s.
G [P], sigma_y >= 0 [P].
Source: Wilkins 1964 (radial return).",
    build: Some(|args| {
        let shear = args.positive("the shear modulus G")?.value;
        let yield_stress = args.within("the yield stress sigma_y", 0.0, f64::INFINITY)?.value;
        Ok(Arc::new(Plastic { shear, yield_stress }))
    }),
};

/// Y = sigma_y (1 - D).
///
/// # Source  Wilkins 1964; language.md 9.3
#[derive(Clone, Copy, Debug)]
pub struct Plastic {
    /// G \[P\].
    pub shear: f64,
    /// sigma_y \[P\].
    pub yield_stress: f64,
}

impl Strength for Plastic {
    fn shear(&self) -> f64 {
        self.shear
    }

    fn columns(&self) -> &'static [Column] {
        &[Column::PlasticStrain, Column::PlasticStrainRate]
    }

    fn deviator(&self, damaged: bool, chunk: &mut Chunk<'_>, stages: &mut Stages) {
        let law = LinearFlow { yield_stress: self.yield_stress, hardening: 0.0 };
        flow_linearly(law, self.shear, damaged, chunk, stages);
    }
}
