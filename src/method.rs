//! Methods: where the weights of a particle belong to (language.md 5, 6.2).

use crate::shape::ShapeKind;
use crate::style::Style;

/// How bodies and grid go together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Method {
    /// Total Lagrangian: a lattice for each solid, weights from reference places; otherwise
    /// updated Lagrangian: one lattice, weights from current places.
    pub total: bool,
    /// The shape function.
    pub shape: ShapeKind,
    /// F-bar: the volumetric part of L is averaged over the grid.
    pub averaged_dilation: bool,
    /// `thermo-mechanical`: heat is conducted on the nodes.
    pub conducts_heat: bool,
    /// Two-dimensional bodies of revolution: x is the radius, y lies along the axis, and masses
    /// and volumes are those of one radian.
    pub axisymmetric: bool,
}

impl Method {
    /// The region that bodies can fill: where x is a radius they begin at the axis.
    pub fn lower_limits(&self, lower: [f64; 3]) -> [f64; 3] {
        match self.axisymmetric {
            true => [lower[0].max(0.0), lower[1], lower[2]],
            false => lower,
        }
    }

    /// The factor that a radius gives to areas in the plane: volumes are those of one radian.
    pub fn girth(&self, place: [f64; 3]) -> f64 {
        if self.axisymmetric { place[0] } else { 1.0 }
    }
}

/// All methods; the value says whether it is total Lagrangian.
pub const METHODS: &[Style<bool>] = &[
    Style {
        name: "ulmpm",
        usage: "sub, shape [, alpha] [, option ...]",
        summary: "updated Lagrangian: one grid for all bodies, weights from current places",
        manual: "\
Bodies that meet share nodes, which makes contact without slip; `contact` lets them slide. Shapes: linear, quadratic-spline,
cubic-spline. Source: Sulsky, Chen, Schreyer 1994.",
        build: Some(false),
    },
    Style {
        name: "tlmpm",
        usage: "sub, shape [, alpha] [, option ...]",
        summary: "total Lagrangian: a grid for each solid, weights from reference places",
        manual: "\
No particle crosses a cell and no body tears by itself; bodies do not see each other without a
contact fix. Hypoelastic laws act on the stress turned back by R of F = R U (Green-Naghdi); the
forces are -sum V0 P grad0 N with P = J sigma F^-T. The increment of strain is taken with the new F
and so counts (dt omega)^2/2 per step too much in a body that spins with omega: take dt small, or
`neo-hookean`, whose stress has no memory, for bodies that spin fast. Shapes: linear, quadratic-spline, cubic-spline,
Bernstein-quadratic. Source: de Vaucorbeil, Nguyen, Hutchinson 2020.",
        build: Some(true),
    },
    Style {
        name: "ulcpdi",
        usage: "sub, shape [, alpha] [, option ...]",
        summary: "updated Lagrangian with particle domains",
        manual: "",
        build: None,
    },
    Style {
        name: "tlcpdi",
        usage: "sub, shape [, alpha] [, option ...]",
        summary: "total Lagrangian with particle domains",
        manual: "",
        build: None,
    },
];
