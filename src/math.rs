//! Small mathematics: tensors, polar decomposition, four-wide numbers.

pub mod exact_sum;
pub mod principal;
pub mod tensor;
pub mod transcendental;
pub mod v4;
pub mod wide;
