//! The loops over particles and nodes: rayon and four-wide numbers live here only.
//!
//! A step is two sweeps over the particles with two passes over the nodes between them:
//!
//! | loop | reads | writes |
//! | --- | --- | --- |
//! | [`grid::update`] | momentum, mass, force | v*, v* - v |
//! | [`gather::sweep`] | v*, v* - v | v, dx of particles; momentum of the second mapping |
//! | [`grid::divide_and_clear`] and its kin | second mapping, mass | nodal velocity |
//! | [`points::sweep`] | nodal velocity | F, J, stress; x += dx; mass, momentum, force of the next step |
//!
//! Bodies with lattices of their own exchange momentum before and after the update ([`contact`]).
//! Weights belong to the place of a particle (updated Lagrangian) or to its reference place (total
//! Lagrangian). Particles are sorted by tile ([`tiles`]); tiles of one colour share no node, so
//! they run in parallel and every sum has one order for any number of threads.

pub mod chunk;
pub mod cloud;
pub mod conduction;
pub mod contact;
pub mod deal;
pub mod dilation;
pub mod domains;
pub mod filter;
pub mod gather;
pub mod ghosts;
pub mod grid;
pub mod ledger;
pub mod pairs;
pub mod patch;
pub mod points;
pub mod rigid;
pub mod scatter;
pub mod shared;
pub mod sort;
pub mod stencil;
pub mod support;
pub mod surfaces;
pub mod survey;
pub mod tensor;
pub mod tiles;
pub mod trouble;
pub mod walls;
pub mod work;

/// Runs a generic kernel for the dimension and shape function of the scene:
/// `by_kind!(d, shape, kernel, args...)` calls `kernel::<2, Tensor<4, Cubic>>(args...)` and so on.
macro_rules! by_kind {
    ($dimension:expr, $shape:expr, $kernel:ident, $($argument:expr),+) => {{
        use $crate::kernel::cloud::Corners;
        use $crate::kernel::support::{Boxed, Tensor};
        use $crate::shape::{Bernstein, Cubic, DomainKind, Linear, Quadratic, ShapeKind};
        match ($dimension, $shape) {
            (1, ShapeKind::Linear) => $kernel::<1, Tensor<2, Linear>>($($argument),+),
            (2, ShapeKind::Linear) => $kernel::<2, Tensor<2, Linear>>($($argument),+),
            (_, ShapeKind::Linear) => $kernel::<3, Tensor<2, Linear>>($($argument),+),
            (1, ShapeKind::Quadratic) => $kernel::<1, Tensor<3, Quadratic>>($($argument),+),
            (2, ShapeKind::Quadratic) => $kernel::<2, Tensor<3, Quadratic>>($($argument),+),
            (_, ShapeKind::Quadratic) => $kernel::<3, Tensor<3, Quadratic>>($($argument),+),
            (1, ShapeKind::Cubic) => $kernel::<1, Tensor<4, Cubic>>($($argument),+),
            (2, ShapeKind::Cubic) => $kernel::<2, Tensor<4, Cubic>>($($argument),+),
            (_, ShapeKind::Cubic) => $kernel::<3, Tensor<4, Cubic>>($($argument),+),
            (1, ShapeKind::Bernstein) => $kernel::<1, Tensor<3, Bernstein>>($($argument),+),
            (2, ShapeKind::Bernstein) => $kernel::<2, Tensor<3, Bernstein>>($($argument),+),
            (_, ShapeKind::Bernstein) => $kernel::<3, Tensor<3, Bernstein>>($($argument),+),
            (1, ShapeKind::Gimp | ShapeKind::StretchedGimp) => $kernel::<1, Boxed>($($argument),+),
            (2, ShapeKind::Gimp | ShapeKind::StretchedGimp) => $kernel::<2, Boxed>($($argument),+),
            (_, ShapeKind::Gimp | ShapeKind::StretchedGimp) => $kernel::<3, Boxed>($($argument),+),
            (dimension, ShapeKind::Corners(kind)) => match (dimension, kind) {
                (1, _) => $kernel::<1, Corners<2, 3, false>>($($argument),+),
                (2, DomainKind::Quadrangle) => $kernel::<2, Corners<4, 9, true>>($($argument),+),
                (2, _) => $kernel::<2, Corners<4, 9, false>>($($argument),+),
                (_, DomainKind::Tetrahedron) => $kernel::<3, Corners<4, 1, true>>($($argument),+),
                (_, DomainKind::Hexahedron) => $kernel::<3, Corners<8, 1, true>>($($argument),+),
                _ => $kernel::<3, Corners<8, 27, false>>($($argument),+),
            },
        }
    }};
}
pub(crate) use by_kind;

/// The same for kernels with loops of their own where x is a radius:
/// `by_space!(axisymmetric, d, shape, kernel, args...)` calls `kernel::<2, true, Tensor<4, Cubic>>(args...)`
/// or `kernel::<2, false, Tensor<4, Cubic>>(args...)`. CPDI knows no such loops.
macro_rules! by_space {
    ($axisymmetric:expr, $dimension:expr, $shape:expr, $kernel:ident, $($argument:expr),+) => {{
        use $crate::kernel::cloud::Corners;
        use $crate::kernel::support::{Boxed, Tensor};
        use $crate::shape::{Bernstein, Cubic, DomainKind, Linear, Quadratic, ShapeKind};
        match ($axisymmetric, $dimension, $shape) {
            (true, _, ShapeKind::Linear) => $kernel::<2, true, Tensor<2, Linear>>($($argument),+),
            (true, _, ShapeKind::Quadratic) => $kernel::<2, true, Tensor<3, Quadratic>>($($argument),+),
            (true, _, ShapeKind::Cubic) => $kernel::<2, true, Tensor<4, Cubic>>($($argument),+),
            (true, _, ShapeKind::Bernstein) => $kernel::<2, true, Tensor<3, Bernstein>>($($argument),+),
            (_, 1, ShapeKind::Linear) => $kernel::<1, false, Tensor<2, Linear>>($($argument),+),
            (_, 2, ShapeKind::Linear) => $kernel::<2, false, Tensor<2, Linear>>($($argument),+),
            (_, _, ShapeKind::Linear) => $kernel::<3, false, Tensor<2, Linear>>($($argument),+),
            (_, 1, ShapeKind::Quadratic) => $kernel::<1, false, Tensor<3, Quadratic>>($($argument),+),
            (_, 2, ShapeKind::Quadratic) => $kernel::<2, false, Tensor<3, Quadratic>>($($argument),+),
            (_, _, ShapeKind::Quadratic) => $kernel::<3, false, Tensor<3, Quadratic>>($($argument),+),
            (_, 1, ShapeKind::Cubic) => $kernel::<1, false, Tensor<4, Cubic>>($($argument),+),
            (_, 2, ShapeKind::Cubic) => $kernel::<2, false, Tensor<4, Cubic>>($($argument),+),
            (_, _, ShapeKind::Cubic) => $kernel::<3, false, Tensor<4, Cubic>>($($argument),+),
            (_, 1, ShapeKind::Bernstein) => $kernel::<1, false, Tensor<3, Bernstein>>($($argument),+),
            (_, 2, ShapeKind::Bernstein) => $kernel::<2, false, Tensor<3, Bernstein>>($($argument),+),
            (_, _, ShapeKind::Bernstein) => $kernel::<3, false, Tensor<3, Bernstein>>($($argument),+),
            (true, _, ShapeKind::Gimp | ShapeKind::StretchedGimp) => {
                $kernel::<2, true, Boxed>($($argument),+)
            }
            (_, 1, ShapeKind::Gimp | ShapeKind::StretchedGimp) => {
                $kernel::<1, false, Boxed>($($argument),+)
            }
            (_, 2, ShapeKind::Gimp | ShapeKind::StretchedGimp) => {
                $kernel::<2, false, Boxed>($($argument),+)
            }
            (_, _, ShapeKind::Gimp | ShapeKind::StretchedGimp) => {
                $kernel::<3, false, Boxed>($($argument),+)
            }
            (_, dimension, ShapeKind::Corners(kind)) => match (dimension, kind) {
                (1, _) => $kernel::<1, false, Corners<2, 3, false>>($($argument),+),
                (2, DomainKind::Quadrangle) => $kernel::<2, false, Corners<4, 9, true>>($($argument),+),
                (2, _) => $kernel::<2, false, Corners<4, 9, false>>($($argument),+),
                (_, DomainKind::Tetrahedron) => $kernel::<3, false, Corners<4, 1, true>>($($argument),+),
                (_, DomainKind::Hexahedron) => $kernel::<3, false, Corners<8, 1, true>>($($argument),+),
                _ => $kernel::<3, false, Corners<8, 27, false>>($($argument),+),
            },
        }
    }};
}
pub(crate) use by_space;
