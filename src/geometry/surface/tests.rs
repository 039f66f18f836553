//! Surfaces whose inside is known.

use super::*;

/// The box from `lower` to `upper`, outside seen from outside.
fn cuboid(lower: [f64; 3], upper: [f64; 3]) -> Vec<Triangle> {
    let corner = |bits: usize| -> [f64; 3] {
        std::array::from_fn(|axis| if bits >> axis & 1 == 0 { lower[axis] } else { upper[axis] })
    };
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    faces
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
        .map(|triangle| triangle.map(corner))
        .collect()
}

/// A torus around z: `count` x `count` squares, each of two triangles.
fn torus(count: usize, large: f64, small: f64) -> Vec<Triangle> {
    let place = |i: usize, j: usize| {
        let angle = |k: usize| std::f64::consts::TAU * (k % count) as f64 / count as f64;
        let ring = large + small * angle(j).cos();
        [ring * angle(i).cos(), ring * angle(i).sin(), small * angle(j).sin()]
    };
    let square = |i: usize, j: usize| {
        let [a, b] = [place(i, j), place(i + 1, j)];
        let [c, d] = [place(i + 1, j + 1), place(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..count * count).flat_map(|k| square(k / count, k % count)).collect()
}

fn reversed(triangles: &[Triangle]) -> Vec<Triangle> {
    triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect()
}

#[test]
fn a_box_is_closed_at_faces_edges_and_corners() {
    // The lattice meets every face, diagonal, edge and corner exactly.
    let surface = Surface::new(&cuboid([0.0; 3], [1.0, 2.0, 3.0])).expect("closed");
    assert_eq!(surface.volume(), 6.0);
    for i in -1..=5 {
        for j in -1..=9 {
            for k in -1..=13 {
                let place = [i, j, k].map(|n| 0.25 * f64::from(n));
                let inside = (0..=4).contains(&i) && (0..=8).contains(&j) && (0..=12).contains(&k);
                assert_eq!(surface.contains(place), inside, "{place:?}");
            }
        }
    }
    for far in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(!surface.contains([0.5, far, 0.5]) && !surface.contains([0.5, 0.5, far]));
    }
    let above = 1.0f64.next_up();
    assert!(!surface.contains([above, 1.0, 1.0]) && surface.contains([1.0, 1.0, 1.0]));
}

#[test]
fn a_point_on_a_slanted_face_is_told_from_its_neighbours() {
    let tetrahedron = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let surface = Surface::new(&faces.map(|face| face.map(|k: usize| tetrahedron[k]))).unwrap();
    for [x, y] in [[0.25, 0.5], [0.125, 0.0], [0.0, 0.75], [1.0, 0.0]] {
        let z: f64 = 1.0 - x - y;
        assert!(surface.contains([x, y, z]), "on the face");
        assert!(!surface.contains([x, y, z.next_up()]), "above ({x}, {y})");
        assert!(surface.contains([x, y, z.next_down().max(0.0)]), "below ({x}, {y})");
    }
}

#[test]
fn holes_bodies_inside_each_other_and_inverted_surfaces() {
    let outer = cuboid([0.0; 3], [4.0; 3]);
    let inner = cuboid([1.0; 3], [3.0; 3]);
    let hollow = Surface::new(&[outer.clone(), reversed(&inner)].concat()).expect("closed");
    let both = Surface::new(&[outer.clone(), inner].concat()).expect("closed");
    let inverted = Surface::new(&reversed(&outer)).expect("closed");
    assert_eq!((hollow.volume(), inverted.volume()), (56.0, -64.0));
    for (place, expected) in
        [([2.0; 3], [false, true, true]), ([0.5; 3], [true; 3]), ([5.0; 3], [false; 3])]
    {
        let found = [&hollow, &both, &inverted].map(|surface| surface.contains(place));
        assert_eq!(found, expected, "{place:?}");
    }
    // Two boxes that share an edge have four triangles there.
    let touching = [cuboid([0.0; 3], [1.0; 3]), cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0])].concat();
    let touching = Surface::new(&touching).expect("closed");
    assert!(touching.contains([1.5; 3].map(|x| x - 1.0)) && touching.contains([1.5, 1.5, 0.5]));
    assert!(!touching.contains([1.5, 0.5, 0.5]) && touching.contains([1.0, 1.0, 0.5]));
}

#[test]
fn a_torus_agrees_with_the_solid_angle() {
    let triangles = torus(24, 1.0, 0.4);
    let surface = Surface::new(&triangles).expect("closed");
    let mut differences = 0;
    for n in 0..4000_u32 {
        let random =
            |k: u32| f64::from((n * 3 + k).wrapping_mul(2_654_435_761) >> 8) / 2f64.powi(24);
        let place = [2.9 * (random(0) - 0.5), 2.9 * (random(1) - 0.5), random(2) - 0.5];
        let wound = solid_angle(&triangles, place) / (4.0 * std::f64::consts::PI);
        differences += i32::from(surface.contains(place) != (wound.abs() > 0.5));
    }
    assert_eq!(differences, 0);
    // Columns through vertices and edges: on the axes of the ring.
    assert!(!surface.contains([0.0; 3]) && surface.contains([1.0, 0.0, 0.0]));
    assert!(surface.contains([1.4, 0.0, 0.0]), "a vertex");
}

#[test]
fn a_vertex_beside_the_point_counts_once() {
    let [a, b, c, d] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let tip = [0.5, 0.25, 1.0];
    let pyramid =
        [[a, b, tip], [b, c, tip], [c, d, tip], [d, a, tip], [a, c, b], [a, d, c]].to_vec();
    let hollow = [cuboid([-2.0; 3], [2.0; 3]), reversed(&pyramid)].concat();
    let surface = Surface::new(&hollow).expect("closed");
    // The ray towards +x that finds the triangles around the point runs into the tip.
    assert!(!surface.contains([-0.5, 0.25, 0.1]) && surface.contains([-0.5, 0.25, -0.1]));
}

/// Solid angle of the triangles seen from a point (van Oosterom and Strackee, IEEE Trans. Biomed.
/// Eng. 30, 1983).
fn solid_angle(triangles: &[Triangle], from: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let angle = |triangle: &Triangle| {
        let [a, b, c] =
            triangle.map(|corner| std::array::from_fn::<f64, 3, _>(|k| corner[k] - from[k]));
        let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
        let cross =
            [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        let below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        2.0 * dot(a, cross).atan2(below)
    };
    triangles.iter().map(angle).sum()
}

#[test]
fn open_surfaces_name_an_edge() {
    let mut triangles = cuboid([0.0; 3], [1.0; 3]);
    let gone = triangles.pop().expect("a triangle");
    let mistake = Surface::new(&triangles).expect_err("open").what;
    assert!(mistake.starts_with("the surface is not closed: the edge from ("), "{mistake}");
    assert!(mistake.ends_with("has a triangle on one side only"), "{mistake}");
    let [a, b, c] = gone;
    triangles.push([a, c, b]);
    let mistake = Surface::new(&triangles).expect_err("turned").what;
    assert!(mistake.ends_with("turned against each other"), "{mistake}");
    triangles.pop();
    triangles.push([a, b, c.map(|x| x + 1e-9)]);
    assert!(Surface::new(&triangles).is_err(), "a gap");
    assert_eq!(Surface::new(&[]).expect_err("empty").what, "there is no triangle in it");
    let sheet = [[a, b, c], [a, c, b]];
    assert!(Surface::new(&sheet).expect_err("flat").what.ends_with("encloses no volume"));
}

#[test]
fn needles_do_not_fill_the_memory() {
    // Each of the long triangles touches all columns along an axis.
    let count = 4000;
    let mut triangles = Vec::new();
    for k in 0..count {
        let y = f64::from(k);
        triangles.extend(cuboid([0.0, y, 0.0], [1e4, y + 1.0, 1.0]));
    }
    let surface = Surface::new(&triangles).expect("closed");
    assert!(surface.columns.list.len() <= LISTED * surface.len());
    assert!(surface.contains([5e3, 100.5, 0.5]) && !surface.contains([5e3, 100.5, 1.5]));
}
