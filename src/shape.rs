//! Shape functions: weights and gradients of the nodes around a particle.
//!
//! The weight of a node in 2-D and 3-D is the product over the axes, its gradient follows by the
//! product rule (language.md 9.7). All axes of a particle are computed together, one per lane.

pub mod bernstein;
pub mod corners;
pub mod cubic;
pub mod gimp;
pub mod linear;
pub mod quadratic;

use crate::geometry::element::MOST_CORNERS;
use crate::math::v4::Wide;
use crate::style::Style;

pub use bernstein::Bernstein;
pub use cubic::Cubic;
pub use linear::Linear;
pub use quadratic::Quadratic;

/// Weights of the `W` nodes that see a particle on each axis; the lanes are the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights<const W: usize> {
    /// The first of the nodes, a whole number.
    pub first: [f64; 4],
    /// Distance of the particle from the first node, in node spacings.
    pub offset: [f64; 4],
    /// N of each node: `value[k][axis]`.
    pub value: [[f64; 4]; W],
    /// dN/dr of each node, r in node spacings: divide by the spacing for dN/dx.
    pub slope: [[f64; 4]; W],
}

impl<const W: usize> Weights<W> {
    /// The moments N (r_I - r_p)/D, D = sum N (r_I - r_p)^2, in place of the slopes: what an
    /// affine field is fitted with. Shapes that reproduce places have sum N (r_I - r_p) = 0, so
    /// that the matrix D_p of language.md 6.1 is diagonal.
    #[inline(always)]
    pub fn moments<V: Wide>(mut self) -> Self {
        let offset = V::load(&self.offset);
        let mut inertia = V::splat(0.0);
        let mut arm = [V::splat(0.0); W];
        for k in 0..W {
            let distance = V::splat(k as f64) - offset;
            arm[k] = V::load(&self.value[k]) * distance;
            inertia = arm[k].mul_add(distance, inertia);
        }
        for k in 0..W {
            (arm[k] / inertia).store(&mut self.slope[k]);
        }
        self
    }
}

/// A shape function with `W` nodes per axis.
pub trait Shape<const W: usize> {
    /// Affine matrices are fitted with the moments of the weights; otherwise with their slopes.
    const MOMENTS: bool;

    /// Weights at `r`, the distance from node 0 in node spacings, on axes whose last node is `last`.
    fn weights<V: Wide>(r: V, last: V) -> Weights<W>;
}

/// Smallest weight of a node whose gradient weight is not zero: a particle exactly on a node then
/// still gives the nodes around it the mass that their gradient weight needs, so that no force is
/// lost to an empty node and free flight makes no strain.
pub const EDGE: f64 = 1e-12;

/// The shape functions of the script language.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShapeKind {
    /// Hats.
    #[default]
    Linear,
    /// Quadratic B-splines.
    Quadratic,
    /// Cubic B-splines.
    Cubic,
    /// Quadratic Bernstein polynomials on cells with mid nodes.
    Bernstein,
    /// Hats averaged over boxes that keep their size.
    Gimp,
    /// Hats averaged over boxes that stretch with the material.
    StretchedGimp,
    /// Hats at the corners of the domains of particles (CPDI).
    Corners(DomainKind),
}

/// The domains of particles in CPDI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DomainKind {
    /// Lines, parallelograms, boxes with parallel edges: `R4`, `R8`.
    Parallel,
    /// Quadrangles, `Q4`; triangles, `T3`, are such with two corners in one place.
    Quadrangle,
    /// Tetrahedra, `Tet4`.
    Tetrahedron,
    /// Hexahedra, `H8`.
    Hexahedron,
}

impl DomainKind {
    /// Does the grid carry its corners along, each for itself?
    pub fn has_free_corners(self) -> bool {
        self != DomainKind::Parallel
    }

    /// Number of corners in so many dimensions.
    pub fn corners(self, dimension: usize) -> usize {
        match self {
            DomainKind::Parallel => 1 << dimension,
            DomainKind::Quadrangle | DomainKind::Tetrahedron => 4,
            DomainKind::Hexahedron => 8,
        }
    }
}

/// The part of its share of the body that a box of GIMP begins with: one that ends on a line of nodes is
/// not carried across it by round-off, as it is 1e9 cells from the origin, to nodes with hardly any mass.
const INSIDE: f64 = 1.0 - 1e-6;

impl ShapeKind {
    /// Nodes per axis that see a particle.
    pub fn width(self) -> usize {
        match self {
            ShapeKind::Linear | ShapeKind::Corners(_) => 2,
            ShapeKind::Quadratic
            | ShapeKind::Bernstein
            | ShapeKind::Gimp
            | ShapeKind::StretchedGimp => 3,
            ShapeKind::Cubic => 4,
        }
    }

    /// Nodes per cell and axis.
    pub fn nodes_per_cell(self) -> usize {
        if self == ShapeKind::Bernstein { 2 } else { 1 }
    }

    /// Is it a B-spline?
    pub fn is_spline(self) -> bool {
        matches!(self, ShapeKind::Quadratic | ShapeKind::Cubic)
    }

    /// Do weights depend on the domain of the particle, beside its place?
    pub fn has_domains(self) -> bool {
        matches!(self, ShapeKind::Gimp | ShapeKind::StretchedGimp | ShapeKind::Corners(_))
    }

    /// Do domains follow the material or the grid in updated Lagrangian methods?
    pub fn has_moving_domains(self) -> bool {
        matches!(self, ShapeKind::StretchedGimp | ShapeKind::Corners(_))
    }

    /// Records of the domain of a particle in so many dimensions.
    pub fn records(self, dimension: usize) -> usize {
        match self {
            ShapeKind::Gimp | ShapeKind::StretchedGimp => 1,
            ShapeKind::Corners(DomainKind::Parallel) => dimension,
            ShapeKind::Corners(kind) => kind.corners(dimension),
            _ => 0,
        }
    }

    /// The records of the domain of a particle at `place`; `corners` are those of its element, none
    /// where it is a square or cube with the half edge `half`, of a solid with cells of size `cell`.
    pub fn domain_of(
        self,
        dimension: usize,
        place: [f64; 3],
        corners: &[[f64; 3]],
        half: f64,
        cell: f64,
    ) -> [[f64; 4]; MOST_CORNERS] {
        match self {
            ShapeKind::Gimp | ShapeKind::StretchedGimp => {
                [[INSIDE * half.min(0.5 * cell); 4]; MOST_CORNERS]
            }
            ShapeKind::Corners(kind) => kind.records(dimension, place, corners, half),
            _ => [[0.0; 4]; MOST_CORNERS],
        }
    }

    /// Cells of nodes that lattices have around the box.
    pub fn layers(self) -> usize {
        usize::from(self.has_domains())
    }

    /// First and last node that particles anywhere in a cell can see, on an axis whose last node
    /// is `last`; the corners of their domains lie at most `corners` cells away from them.
    pub fn reach(self, cell: usize, last: usize, corners: usize) -> [usize; 2] {
        let width = self.width();
        match self {
            ShapeKind::Linear => [cell, cell + 1],
            ShapeKind::Corners(_) => [cell.saturating_sub(corners), (cell + 1 + corners).min(last)],
            ShapeKind::Gimp | ShapeKind::StretchedGimp => {
                [cell.saturating_sub(1), (cell + 2).min(last)]
            }
            ShapeKind::Bernstein => [2 * cell, 2 * cell + 2],
            ShapeKind::Quadratic | ShapeKind::Cubic => [
                cell.saturating_sub(1).min((last + 1).saturating_sub(width)),
                (cell + 2).max(width - 1).min(last),
            ],
        }
    }

    /// Fewest nodes that an axis must have.
    pub fn fewest_nodes(self) -> usize {
        if self.is_spline() { 4 } else { 2 }
    }
}

const fn row(
    name: &'static str,
    summary: &'static str,
    manual: &'static str,
    kind: ShapeKind,
) -> Style<ShapeKind> {
    Style { name, usage: "", summary, manual, build: Some(kind) }
}

/// All shape functions.
pub const SHAPES: &[Style<ShapeKind>] = &[
    row("linear", linear::SUMMARY, linear::MANUAL, ShapeKind::Linear),
    row("quadratic-spline", quadratic::SUMMARY, quadratic::MANUAL, ShapeKind::Quadratic),
    row("cubic-spline", cubic::SUMMARY, cubic::MANUAL, ShapeKind::Cubic),
    row("Bernstein-quadratic", bernstein::SUMMARY, bernstein::MANUAL, ShapeKind::Bernstein),
    row("gimp", gimp::SUMMARY, gimp::MANUAL, ShapeKind::Gimp),
    row("cpgimp", gimp::STRETCHED_SUMMARY, gimp::STRETCHED_MANUAL, ShapeKind::StretchedGimp),
];

#[cfg(test)]
mod conformance;
