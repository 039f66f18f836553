//! Material point method simulator driven by Karamelo-style scripts.

pub mod damage;
pub mod eos;
pub mod error;
pub mod fault;
pub mod interrupt;
pub mod material;
pub mod math;
pub mod memory;
pub mod model;
pub mod plan;
pub mod region;
pub mod script;
pub mod shape;
pub mod step;
pub mod strength;
pub mod style;
pub mod temperature;
pub mod timing;
pub mod transfer;
pub mod world;
