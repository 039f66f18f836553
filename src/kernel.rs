//! The loops over particles and nodes: rayon and four-wide numbers live here only.
//!
//! A step is two sweeps over the particles with two passes over the nodes between them:
//!
//! | loop | reads | writes |
//! | --- | --- | --- |
//! | [`grid::update`] | momentum, mass, force | v*, v* - v |
//! | [`gather::sweep`] | v*, v* - v at x | v, dx of particles; momentum of the second mapping |
//! | [`grid::divide`] | second mapping, mass | nodal velocity |
//! | [`stress::sweep`] | nodal velocity at x | F, J, stress; x += dx; mass, momentum, force at the new x |
//!
//! Particles are sorted by tile ([`tiles`]); tiles of one colour share no node, so they run in
//! parallel and every sum has one order for any number of threads.

pub mod gather;
pub mod grid;
pub mod scatter;
pub mod shared;
pub mod sort;
pub mod stencil;
pub mod stress;
pub mod tiles;

/// Runs a generic kernel for the dimension of the scene: `by_dimension!(d, kernel, args...)` calls
/// `kernel::<1, 2, Linear>(args...)` and so on.
macro_rules! by_dimension {
    ($dimension:expr, $kernel:ident, $($argument:expr),+) => {
        match $dimension {
            1 => $kernel::<1, 2, $crate::shape::Linear>($($argument),+),
            2 => $kernel::<2, 2, $crate::shape::Linear>($($argument),+),
            _ => $kernel::<3, 2, $crate::shape::Linear>($($argument),+),
        }
    };
}
pub(crate) use by_dimension;
