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

/// What the word for a method says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodKind {
    /// Total Lagrangian.
    pub total: bool,
    /// Nodes are seen through the corners of the domains of particles.
    pub corners: bool,
}

const fn kind(total: bool, corners: bool) -> Option<MethodKind> {
    Some(MethodKind { total, corners })
}

/// All methods.
pub const METHODS: &[Style<MethodKind>] = &[
    Style {
        name: "ulmpm",
        usage: "sub, shape [, alpha] [, option ...]",
        summary: "updated Lagrangian: one grid for all bodies, weights from current places",
        manual: "\
Bodies that meet share nodes, which makes contact without slip; `contact` lets them slide. Shapes: linear, quadratic-spline,
cubic-spline. Source: Sulsky, Chen, Schreyer 1994.",
        build: kind(false, false),
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
        build: kind(true, false),
    },
    Style {
        name: "ulcpdi",
        usage: "sub, linear [, alpha] [, R4|Q4|T3|R8|H8|Tet4] [, option ...]",
        summary: "updated Lagrangian with particle domains (CPDI)",
        manual: "\
A particle sees the nodes through the corners of its domain: N_I = sum_c w_c N(x_c), grad N_I = sum_c g_c
N(x_c), N the hats. No noise of cell crossing, and a body that stretches stays in one piece, since
domains stretch with it. Domains: `R4` (default; `R8` in 3-D), `Q4`, `T3`, `H8`, `Tet4`: see `karamelo-rs styles
domain`. The lattice has one more layer of nodes around the box; a corner beyond it, or more than 8
cells away from its particle, is moved to the nearest place within, for the weights of that step: the
run says so once. Nodes held at a border must lie in the region too (`INF` reaches the layer).
Source: Sadeghirad, Brannon, Burghardt 2011.",
        build: kind(false, true),
    },
    Style {
        name: "tlcpdi",
        usage: "sub, linear [, alpha] [, R4|Q4|T3|R8|H8|Tet4] [, option ...]",
        summary: "total Lagrangian with particle domains (CPDI)",
        manual: "\
As `tlmpm`, with weights through the corners that the domains had at the start: see `ulcpdi`.
Source: de Vaucorbeil et al. 2020.",
        build: kind(true, true),
    },
];
