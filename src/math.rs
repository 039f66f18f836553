//! Small mathematics: tensors, polar decomposition, four-wide numbers.

pub mod principal;
pub mod tensor;
pub mod transcendental;
pub mod v4;
pub mod wide;
