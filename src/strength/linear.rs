//! Elastic deviator.

use super::{BuildStrength, Strength};
use crate::material::Chunk;
use crate::material::stages::{Stages, trial};
use crate::model::column::Column;
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildStrength> = Style {
    name: "linear",
    usage: "G",
    summary: "elastic deviator",
    manual: "\
s <- s + 2 G (1 - D) dt dev D; it never yields. G [P].
Source: de Vaucorbeil et al. 2020.",
    build: Some(|args| Ok(Arc::new(Linear { shear: args.positive("the shear modulus G")?.value }))),
};

/// s <- s + 2 G (1 - D) dt dev D.
///
/// # Source  language.md 9.3
#[derive(Clone, Copy, Debug)]
pub struct Linear {
    /// G \[P\].
    pub shear: f64,
}

impl Strength for Linear {
    fn shear(&self) -> f64 {
        self.shear
    }

    fn columns(&self) -> &'static [Column] {
        &[]
    }

    fn deviator(&self, damaged: bool, chunk: &mut Chunk<'_>, stages: &mut Stages) {
        trial(self.shear, damaged, chunk, stages);
    }
}
