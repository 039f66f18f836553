//! Domains of particles for CPDI: which corners a particle has.

use super::{DomainKind, ShapeKind};
use crate::geometry::element::{MOST_CORNERS, SIGNS};
use crate::style::Style;

const fn row(
    name: &'static str,
    summary: &'static str,
    manual: &'static str,
    kind: DomainKind,
) -> Style<ShapeKind> {
    Style { name, usage: "", summary, manual, build: Some(ShapeKind::Corners(kind)) }
}

const PARALLEL: &str = "\
Half edges r_i, at first along the axes: h/(2 ppc); of a quadrangle or hexahedron of a mesh its mean
edges; of other particles those of a square or cube of the volume. r_i follows the material, r <- r + dt L r,
so r = F r0 (`tlcpdi`: r0 for ever). Corners x -+ r_1 -+ r_2 (-+ r_3); the weight of each is 1/2^d, g_c = R^-T s_c/2^d
with r_i as the columns of R and s_c the signs of the corner. In one dimension: two ends.
Source: Sadeghirad, Brannon, Burghardt 2011.";

const FREE: &str = "\
Corners move with the grid, each for itself: x_c += dt sum N(x_c) v* (`tlcpdi`: they stay). Weights and
gradients are means of the finite element functions over the domain, exactly. Domains of neighbours
share their corners' places, so the body has no gaps and no overlaps as long as it moves with the grid.
Gradients over flat triangles and tetrahedra exceed those of the hats, and so does the stiffness: a mesh
with slivers needs a smaller step (`dt_factor`).
Source: Sadeghirad, Brannon, Guilkey 2013; Nguyen et al. 2017.";

/// All domains of CPDI.
pub const DOMAINS: &[Style<ShapeKind>] = &[
    row("R4", "parallelograms, 2-D (in 1-D two ends)", PARALLEL, DomainKind::Parallel),
    row("Q4", "quadrangles with free corners, 2-D", FREE, DomainKind::Quadrangle),
    row("T3", "triangles of a mesh, 2-D", FREE, DomainKind::Quadrangle),
    row("R8", "boxes with parallel edges, 3-D", PARALLEL, DomainKind::Parallel),
    row("H8", "hexahedra with free corners, 3-D", FREE, DomainKind::Hexahedron),
    row("Tet4", "tetrahedra of a mesh, 3-D", FREE, DomainKind::Tetrahedron),
];

/// How many dimensions a domain of the table belongs to.
pub fn dimensions_of(name: &str) -> &'static [usize] {
    match name {
        "R4" => &[1, 2],
        "Q4" | "T3" => &[2],
        _ => &[3],
    }
}

/// Corners that every element of a mesh must have for a domain of the table; `None`: any body will do.
pub fn corners_of(name: &str) -> Option<usize> {
    match name {
        "T3" => Some(3),
        "Tet4" => Some(4),
        _ => None,
    }
}

/// Corner `c` of the domain with the half edges `edges`, one for each dimension, seen from its centre.
#[inline(always)]
pub fn corner_of_parallel(edges: &[[f64; 4]], c: usize) -> [f64; 4] {
    let mut corner = [0.0; 4];
    for axis in 0..edges.len() {
        for k in 0..edges.len() {
            corner[k] += SIGNS[c][axis] * edges[axis][k];
        }
    }
    corner
}

impl DomainKind {
    /// Pairs of corners that an edge joins.
    pub fn edges(self, dimension: usize) -> &'static [[usize; 2]] {
        match (self, dimension) {
            (_, 1) => &[[0, 1]],
            (DomainKind::Tetrahedron, _) => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
            (_, 2) => &[[0, 1], [1, 2], [2, 3], [3, 0]],
            _ => &[
                [0, 1],
                [1, 2],
                [2, 3],
                [3, 0],
                [4, 5],
                [5, 6],
                [6, 7],
                [7, 4],
                [0, 4],
                [1, 5],
                [2, 6],
                [3, 7],
            ],
        }
    }

    /// The records of a particle at `place` in so many dimensions: half edges, or corners seen from
    /// it. `corners` are those of its element, none where it is a square or cube with the half
    /// edge `half` \[L\].
    pub fn records(
        self,
        dimension: usize,
        place: [f64; 3],
        corners: &[[f64; 3]],
        half: f64,
    ) -> [[f64; 4]; MOST_CORNERS] {
        let mut records = [[0.0; 4]; MOST_CORNERS];
        if self == DomainKind::Parallel {
            for (axis, record) in records.iter_mut().enumerate().take(dimension) {
                *record = edge(dimension, axis, corners, half);
            }
            return records;
        }
        let corners = self.spread(corners);
        for (c, record) in records.iter_mut().enumerate().take(self.corners(dimension)) {
            for axis in 0..dimension {
                record[axis] = match corners.get(c) {
                    Some(corner) => corner[axis] - place[axis],
                    None => half * SIGNS[c][axis],
                };
            }
        }
        records
    }

    /// Corners of an element, some of them more than once if it has fewer than the domain.
    fn spread(self, corners: &[[f64; 3]]) -> Vec<[f64; 3]> {
        match (self, corners) {
            (DomainKind::Quadrangle, [a, b, c]) => vec![*a, *b, *c, *c],
            (DomainKind::Hexahedron, [a, b, c, d]) => vec![*a, *b, *c, *c, *d, *d, *d, *d],
            (DomainKind::Hexahedron, [a, b, c, d, e]) => vec![*a, *b, *c, *d, *e, *e, *e, *e],
            (DomainKind::Hexahedron, [a, b, c, d, e, f]) => {
                vec![*a, *b, *c, *c, *d, *e, *f, *f]
            }
            _ => corners.to_vec(),
        }
    }
}

/// Half edge of a parallel domain along one of its axes: sum s_c x_c/2^d over the corners of a
/// quadrangle or hexahedron, scaled to its volume; otherwise `half` along the axis.
fn edge(dimension: usize, axis: usize, corners: &[[f64; 3]], half: f64) -> [f64; 4] {
    let mut edge = [0.0; 4];
    if dimension == 1 || corners.len() != 1 << dimension {
        edge[axis] = half;
        return edge;
    }
    let edges: Vec<[f64; 3]> = (0..dimension)
        .map(|axis| {
            let mut sum = [0.0; 3];
            for (corner, signs) in corners.iter().zip(SIGNS) {
                for k in 0..dimension {
                    sum[k] += signs[axis] * corner[k] / corners.len() as f64;
                }
            }
            sum
        })
        .collect();
    let [a, b] = [edges[0], edges[1]];
    let c = edges.get(2).copied().unwrap_or([0.0, 0.0, 1.0]);
    let volume = a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0]);
    let scale = half / volume.abs().powf(1.0 / dimension as f64);
    for k in 0..dimension {
        edge[k] = scale * edges[axis][k];
    }
    edge
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_and_parallelograms_of_a_mesh_keep_their_edges() {
        let kind = DomainKind::Parallel;
        let records = kind.records(2, [1.0, 2.0, 0.0], &[], 0.25);
        assert_eq!(records[..2], [[0.25, 0.0, 0.0, 0.0], [0.0, 0.25, 0.0, 0.0]]);
        // Edges (2, 0) and (1, 1): area 2, half edge of the square sqrt(2)/2.
        let corners = [[0.0; 3], [2.0, 0.0, 0.0], [3.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        let records = kind.records(2, [1.5, 0.5, 0.0], &corners, 0.5 * 2f64.sqrt());
        for (record, expected) in records.iter().zip([[1.0, 0.0], [0.5, 0.5]]) {
            assert!((record[0] - expected[0]).abs() < 1e-15, "{records:?}");
            assert!((record[1] - expected[1]).abs() < 1e-15, "{records:?}");
        }
    }

    #[test]
    fn elements_with_fewer_corners_fill_the_domain() {
        let corners = [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]];
        let place = [1.0, 1.0, 0.0];
        let records = DomainKind::Quadrangle.records(2, place, &corners, 1.0);
        assert_eq!(records[2], records[3]);
        assert_eq!(records[0], [-1.0, -1.0, 0.0, 0.0]);
    }
}
