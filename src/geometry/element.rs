//! Elements of a mesh: volume, centroid, and whether their edges are straight.

/// Families of elements; the corners come first in every list of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// A point.
    Point,
    /// Two corners.
    Line,
    /// Three corners.
    Triangle,
    /// Four corners in order around it.
    Quadrangle,
    /// Four corners.
    Tetrahedron,
    /// Eight corners: four around the bottom, four above them.
    Hexahedron,
    /// Six corners: three around the bottom, three above them.
    Prism,
    /// Five corners: four around the bottom, the tip.
    Pyramid,
}

/// Most corners of an element.
pub const MOST_CORNERS: usize = 8;

/// Signs of the corners of a cube, counter-clockwise from (-, -, -), the lower four first.
pub const SIGNS: [[f64; 3]; MOST_CORNERS] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

impl Family {
    /// Its dimension.
    pub fn dimension(self) -> usize {
        match self {
            Family::Point => 0,
            Family::Line => 1,
            Family::Triangle | Family::Quadrangle => 2,
            Family::Tetrahedron | Family::Hexahedron | Family::Prism | Family::Pyramid => 3,
        }
    }

    /// Number of corners.
    pub fn corners(self) -> usize {
        match self {
            Family::Point => 1,
            Family::Line => 2,
            Family::Triangle => 3,
            Family::Quadrangle | Family::Tetrahedron => 4,
            Family::Pyramid => 5,
            Family::Prism => 6,
            Family::Hexahedron => 8,
        }
    }

    /// Corners at the ends of the edges, in the order in which Gmsh lists the nodes between them.
    pub fn edges(self) -> &'static [[usize; 2]] {
        match self {
            Family::Point => &[],
            Family::Line => &[[0, 1]],
            Family::Triangle => &[[0, 1], [1, 2], [2, 0]],
            Family::Quadrangle => &[[0, 1], [1, 2], [2, 3], [3, 0]],
            Family::Tetrahedron => &[[0, 1], [1, 2], [2, 0], [3, 0], [3, 2], [3, 1]],
            Family::Hexahedron => &[
                [0, 1],
                [0, 3],
                [0, 4],
                [1, 2],
                [1, 5],
                [2, 3],
                [2, 6],
                [3, 7],
                [4, 5],
                [4, 7],
                [5, 6],
                [6, 7],
            ],
            Family::Prism => {
                &[[0, 1], [0, 2], [0, 3], [1, 2], [1, 4], [2, 5], [3, 4], [3, 5], [4, 5]]
            }
            Family::Pyramid => &[[0, 1], [0, 3], [0, 4], [1, 2], [1, 4], [2, 3], [2, 4], [3, 4]],
        }
    }
}

/// A type of element of Gmsh's file format.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Its number in files.
    pub number: u64,
    /// Its family.
    pub family: Family,
    /// Polynomial order: `order - 1` nodes lie on each edge between its corners.
    pub order: usize,
    /// Number of nodes.
    pub nodes: usize,
}

const fn kind(number: u64, family: Family, order: usize, nodes: usize) -> Kind {
    Kind { number, family, order, nodes }
}

/// Types of elements (Gmsh reference manual, MSH file format).
pub const KINDS: &[Kind] = {
    use Family::*;
    &[
        kind(1, Line, 1, 2),
        kind(2, Triangle, 1, 3),
        kind(3, Quadrangle, 1, 4),
        kind(4, Tetrahedron, 1, 4),
        kind(5, Hexahedron, 1, 8),
        kind(6, Prism, 1, 6),
        kind(7, Pyramid, 1, 5),
        kind(8, Line, 2, 3),
        kind(9, Triangle, 2, 6),
        kind(10, Quadrangle, 2, 9),
        kind(11, Tetrahedron, 2, 10),
        kind(12, Hexahedron, 2, 27),
        kind(13, Prism, 2, 18),
        kind(14, Pyramid, 2, 14),
        kind(15, Point, 1, 1),
        kind(16, Quadrangle, 2, 8),
        kind(17, Hexahedron, 2, 20),
        kind(18, Prism, 2, 15),
        kind(19, Pyramid, 2, 13),
        kind(20, Triangle, 3, 9),
        kind(21, Triangle, 3, 10),
        kind(22, Triangle, 4, 12),
        kind(23, Triangle, 4, 15),
        kind(24, Triangle, 5, 15),
        kind(25, Triangle, 5, 21),
        kind(26, Line, 3, 4),
        kind(27, Line, 4, 5),
        kind(28, Line, 5, 6),
        kind(29, Tetrahedron, 3, 20),
        kind(30, Tetrahedron, 4, 35),
        kind(31, Tetrahedron, 5, 56),
        kind(36, Quadrangle, 3, 16),
        kind(37, Quadrangle, 4, 25),
        kind(38, Quadrangle, 5, 36),
        kind(39, Quadrangle, 3, 12),
        kind(40, Quadrangle, 4, 16),
        kind(41, Quadrangle, 5, 20),
        kind(90, Prism, 3, 40),
        kind(91, Prism, 4, 75),
        kind(92, Hexahedron, 3, 64),
        kind(93, Hexahedron, 4, 125),
        kind(118, Pyramid, 3, 30),
        kind(119, Pyramid, 4, 55),
    ]
};

/// Space an element fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// Length, area or volume \[L^d\] between straight edges; negative if it is turned over.
    pub volume: f64,
    /// Centroid \[L\].
    pub centroid: [f64; 3],
    /// It covers some places twice, or with both signs.
    pub folded: bool,
}

type Place = [f64; 3];

fn minus(a: Place, b: Place) -> Place {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

/// The third component of a x b.
fn cross(a: Place, b: Place) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn determinant(a: Place, b: Place, c: Place) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

fn mean(corners: &[Place]) -> Place {
    std::array::from_fn(|axis| {
        corners.iter().map(|corner| corner[axis]).sum::<f64>() / corners.len() as f64
    })
}

/// Volume and centroid of an element of the problem's dimension, from its corners. Faces of
/// hexahedra, prisms and pyramids are the bilinear ones through their corners.
pub fn measure(family: Family, corners: &[Place]) -> Measure {
    let simple = |volume: f64| Measure { volume, centroid: mean(corners), folded: false };
    match *corners {
        [a, b] => simple(b[0] - a[0]),
        [a, b, c] => simple(0.5 * cross(minus(b, a), minus(c, a))),
        [a, b, c, d] if family == Family::Tetrahedron => {
            simple(determinant(minus(b, a), minus(c, a), minus(d, a)) / 6.0)
        }
        [a, b, c, d] => quadrangle(a, [minus(b, a), minus(c, a), minus(d, a)]),
        [a, b, c, d, e] => hexahedron([a, b, c, d, e, e, e, e]),
        [a, b, c, d, e, f] => hexahedron([a, b, c, c, d, e, f, f]),
        [a, b, c, d, e, f, g, h] => hexahedron([a, b, c, d, e, f, g, h]),
        _ => simple(0.0),
    }
}

/// Two triangles: a with the first two, and with the last two of the others.
fn quadrangle(a: Place, [b, c, d]: [Place; 3]) -> Measure {
    let (first, second) = (0.5 * cross(b, c), 0.5 * cross(c, d));
    let volume = first + second;
    let centroid = std::array::from_fn(|axis| {
        let moment = first * (b[axis] + c[axis]) + second * (c[axis] + d[axis]);
        a[axis] + moment / (3.0 * volume)
    });
    // One corner may point inwards; two do where edges cross.
    let turns = [
        cross(b, d),
        cross(b, minus(c, b)),
        cross(minus(c, b), minus(d, c)),
        cross(minus(d, c), minus(a, add(a, d))),
    ];
    let inwards = turns.iter().filter(|turn| **turn < 0.0).count();
    Measure { volume, centroid, folded: inwards == 2 }
}

fn add(a: Place, b: Place) -> Place {
    std::array::from_fn(|axis| a[axis] + b[axis])
}

/// The image of a cube under the trilinear map. Its Jacobian is of degree 2 along each axis and
/// the moment of degree 3, which two Gauss points per axis integrate exactly; elements with fewer
/// corners are images with corners that coincide.
fn hexahedron(corners: [Place; MOST_CORNERS]) -> Measure {
    let gauss = (1.0f64 / 3.0).sqrt();
    let origin = corners[0];
    let arms = corners.map(|corner| minus(corner, origin));
    let (mut volume, mut moment) = (0.0, [0.0; 3]);
    let mut jacobians = [0.0; MOST_CORNERS];
    for (jacobian, signs) in jacobians.iter_mut().zip(SIGNS) {
        let at = signs.map(|sign| sign * gauss);
        let mut place = [0.0; 3];
        let mut slope = [[0.0; 3]; 3];
        for (arm, s) in arms.iter().zip(SIGNS) {
            let factor: Place = std::array::from_fn(|axis| 1.0 + s[axis] * at[axis]);
            for k in 0..3 {
                place[k] += 0.125 * factor[0] * factor[1] * factor[2] * arm[k];
                slope[0][k] += 0.125 * s[0] * factor[1] * factor[2] * arm[k];
                slope[1][k] += 0.125 * s[1] * factor[2] * factor[0] * arm[k];
                slope[2][k] += 0.125 * s[2] * factor[0] * factor[1] * arm[k];
            }
        }
        *jacobian = determinant(slope[0], slope[1], slope[2]);
        volume += *jacobian;
        for k in 0..3 {
            moment[k] += *jacobian * place[k];
        }
    }
    let centroid = std::array::from_fn(|k| origin[k] + moment[k] / volume);
    let folded = jacobians.iter().any(|j| *j > 0.0) && jacobians.iter().any(|j| *j < 0.0);
    Measure { volume, centroid, folded }
}

/// Nodes may lie this part of an edge's length off it.
const STRAIGHT: f64 = 1e-6;

/// Do the nodes between the corners lie on the straight edges?
pub fn is_straight(kind: &Kind, nodes: &[Place]) -> bool {
    let per_edge = kind.order - 1;
    let between = nodes.get(kind.family.corners()..).unwrap_or(&[]);
    if per_edge == 0 {
        return true;
    }
    kind.family.edges().iter().zip(between.chunks(per_edge)).all(|([from, to], between)| {
        let along = minus(nodes[*to], nodes[*from]);
        let square: f64 = along.iter().map(|x| x * x).sum();
        between.iter().all(|node| {
            let arm = minus(*node, nodes[*from]);
            let part = (0..3).map(|k| arm[k] * along[k]).sum::<f64>() / square;
            let off: f64 = (0..3).map(|k| (arm[k] - part * along[k]).powi(2)).sum();
            off <= STRAIGHT * STRAIGHT * square
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: Measure, volume: f64, centroid: Place) {
        assert!((found.volume - volume).abs() <= 1e-15 * volume.abs(), "{found:?}");
        for (a, b) in found.centroid.iter().zip(centroid) {
            assert!((a - b).abs() < 1e-15, "{found:?}");
        }
    }

    const CUBE: [Place; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];

    #[test]
    fn every_family_has_its_volume_and_centroid() {
        let c = CUBE;
        close(measure(Family::Line, &[c[0], [2.5, 0.0, 0.0]]), 2.5, [1.25, 0.0, 0.0]);
        close(measure(Family::Triangle, &c[..3]), 0.5, [2.0 / 3.0, 1.0 / 3.0, 0.0]);
        close(measure(Family::Quadrangle, &c[..4]), 1.0, [0.5, 0.5, 0.0]);
        close(measure(Family::Tetrahedron, &[c[0], c[1], c[3], c[4]]), 1.0 / 6.0, [0.25; 3]);
        close(measure(Family::Hexahedron, &c), 1.0, [0.5; 3]);
        let third = 1.0 / 3.0;
        close(
            measure(Family::Prism, &[c[0], c[1], c[3], c[4], c[5], c[7]]),
            0.5,
            [third, third, 0.5],
        );
        close(
            measure(Family::Pyramid, &[c[0], c[1], c[2], c[3], c[4]]),
            third,
            [0.375, 0.375, 0.25],
        );
    }

    #[test]
    fn a_trapezoid_and_a_twisted_hexahedron_are_exact() {
        // Parallel sides 4 and 2, height 3: area 9, height of the centroid 3 (4 + 2*2)/(3 (4 + 2)).
        let trapezoid = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [3.0, 3.0, 0.0], [1.0, 3.0, 0.0]];
        close(measure(Family::Quadrangle, &trapezoid), 9.0, [2.0, 4.0 / 3.0, 0.0]);
        // z = 1 + xy on top of the unit square: volume 1 + 1/4, moment of x 1/2 + 1/6, of z
        // (1 + 2/4 + 1/9)/2.
        let mut hexahedron = CUBE;
        hexahedron[6][2] = 2.0;
        let x = (0.5 + 1.0 / 6.0) / 1.25;
        let z = 0.5 * (1.0 + 0.5 + 1.0 / 9.0) / 1.25;
        close(measure(Family::Hexahedron, &hexahedron), 1.25, [x, x, z]);
    }

    #[test]
    fn turned_and_folded_elements_are_seen() {
        let turned = measure(Family::Triangle, &[CUBE[0], CUBE[3], CUBE[1]]);
        assert!(turned.volume == -0.5 && !turned.folded);
        let arrow = [CUBE[0], CUBE[1], [0.25, 0.25, 0.0], CUBE[3]];
        assert!(!measure(Family::Quadrangle, &arrow).folded);
        assert!(!measure(Family::Quadrangle, &CUBE[..4]).folded);
        let bow = [CUBE[0], CUBE[2], CUBE[1], [0.0, 2.0, 0.0]];
        assert!(measure(Family::Quadrangle, &bow).folded);
        let mut folded = CUBE;
        folded[6] = [-1.0, -1.0, -1.0];
        assert!(measure(Family::Hexahedron, &folded).folded);
    }

    #[test]
    fn nodes_off_an_edge_are_seen() {
        let kind = KINDS.iter().find(|kind| kind.number == 9).expect("a triangle of order 2");
        let mut nodes = vec![CUBE[0], CUBE[1], CUBE[3]];
        nodes.extend([[0.5, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 0.5, 0.0]]);
        assert!(is_straight(kind, &nodes));
        nodes[4] = [0.6, 0.6, 0.0];
        assert!(!is_straight(kind, &nodes));
    }

    #[test]
    fn types_have_room_for_corners_and_edges() {
        for kind in KINDS {
            let edges = kind.family.edges();
            let least = kind.family.corners() + edges.len() * (kind.order - 1);
            assert!(kind.nodes >= least, "{kind:?}");
            assert!(edges.as_flattened().iter().all(|end| *end < kind.family.corners()));
        }
    }
}
