//! Material point method simulator driven by Karamelo-style scripts.

pub mod error;
pub mod fault;
pub mod script;
pub mod style;
