//! Bodies from files: meshes as Gmsh writes them, surfaces, lists, and files of any bytes.

use karamelo::geometry::surface::Surface;
use karamelo::geometry::{Points, gmsh, list, stl};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// The meshes of the folder `meshes` fill a line, a quadrangle, or the prism above it.
const LINE: [f64; 2] = [-1.0, 1.5];
const QUADRANGLE: [[f64; 2]; 4] = [[0.0, 0.0], [2.0, 0.0], [1.5, 1.0], [0.25, 1.25]];
const HEIGHT: f64 = 0.8;

fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(folder);
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

/// Volume and first moments of the body a mesh fills, by the formula for polygons.
fn exact(dimension: usize) -> [f64; 4] {
    let [low, high] = LINE;
    if dimension == 1 {
        return [high - low, 0.5 * (high * high - low * low), 0.0, 0.0];
    }
    let (mut area, mut x, mut y) = (0.0, 0.0, 0.0);
    for k in 0..4 {
        let ([ax, ay], [bx, by]) = (QUADRANGLE[k], QUADRANGLE[(k + 1) % 4]);
        let cross = ax * by - bx * ay;
        area += 0.5 * cross;
        x += cross * (ax + bx) / 6.0;
        y += cross * (ay + by) / 6.0;
    }
    match dimension {
        2 => [area, x, y, 0.0],
        _ => [HEIGHT * area, HEIGHT * x, HEIGHT * y, 0.5 * HEIGHT * HEIGHT * area],
    }
}

fn sums(points: &Points) -> [f64; 4] {
    let mut sums = [0.0; 4];
    for point in &points.list {
        sums[0] += point.volume;
        for axis in 0..3 {
            sums[axis + 1] += point.volume * point.place[axis];
        }
    }
    sums
}

fn dimension(name: &str) -> usize {
    match name {
        _ if name.starts_with("line") => 1,
        _ if name.starts_with("triangle") || name.starts_with("quadrangle") => 2,
        _ => 3,
    }
}

#[test]
fn every_type_of_element_has_the_exact_volume_and_first_moments() {
    let mut checked = 0;
    for path in files("meshes") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let bytes = std::fs::read(&path).unwrap();
        let dimension = dimension(&name);
        let mesh =
            gmsh::read(&bytes, dimension).unwrap_or_else(|mistake| panic!("{name}: {mistake:?}"));
        let points = mesh.points().unwrap();
        assert!(points.remarks.is_empty(), "{name}: {:?}", points.remarks);
        let (found, exact) = (sums(&points), exact(dimension));
        for (found, exact) in found.iter().zip(exact) {
            // The sums have up to 70 terms, each of them rounded a few times, on average in both
            // directions: 1e-14 of the largest sum, about 45 units in the last place.
            assert!((found - exact).abs() <= 1e-14 * 2.0, "{name}: {found} and not {exact}");
        }
        checked += 1;
        // A broken variant: the mean of the corners in place of the centroid is off by far more.
        if name.starts_with("quadrangle4") {
            let mean = |element| {
                let corners = mesh.corners(element);
                corners.iter().map(|corner| corner[0]).sum::<f64>() / corners.len() as f64
            };
            let volumes = points.list.iter().map(|point| point.volume);
            let wrong: f64 =
                mesh.elements.iter().zip(volumes).map(|(element, v)| v * mean(element)).sum();
            assert!((wrong - exact[1]).abs() > 1e-3, "{wrong}");
        }
    }
    assert!(checked >= 25, "{checked} meshes");
}

/// A sphere: the faces of an octahedron divided `count` times, blown up onto the sphere.
fn sphere(count: usize) -> Vec<stl::Triangle> {
    let mut triangles = Vec::new();
    for face in 0..8_u32 {
        let sign: [f64; 3] =
            std::array::from_fn(|axis| if face >> axis & 1 == 0 { 1.0 } else { -1.0 });
        let place = |i: usize, j: usize| {
            let k = count - i - j;
            let raw = [i as f64 * sign[0], j as f64 * sign[1], k as f64 * sign[2]];
            let length = raw.iter().map(|x| x * x).sum::<f64>().sqrt();
            raw.map(|x| x / length)
        };
        let mut add = |a, b, c| {
            triangles.push(if sign[0] * sign[1] * sign[2] > 0.0 { [a, b, c] } else { [a, c, b] });
        };
        for i in 0..count {
            for j in 0..count - i {
                add(place(i, j), place(i + 1, j), place(i, j + 1));
                if i + j + 2 <= count {
                    add(place(i + 1, j), place(i + 1, j + 1), place(i, j + 1));
                }
            }
        }
    }
    triangles
}

#[test]
fn the_volume_of_a_faceted_sphere_converges_with_order_two() {
    let exact = 4.0 / 3.0 * std::f64::consts::PI;
    let error = |count: usize| exact - Surface::new(&sphere(count)).unwrap().volume();
    let errors = [8, 16, 32, 64].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        // Facets lie inside by l^2/8 of their edge l; the next term is l^4.
        assert!((order - 2.0).abs() < 0.03, "{errors:?}");
    }
}

#[test]
fn particles_fill_a_faceted_sphere_as_they_fill_the_round_one() {
    let count = 48;
    let surface = Surface::new(&sphere(count)).unwrap();
    let cells = 40;
    let h = 2.0 / cells as f64;
    let (mut in_facets, mut in_sphere, mut between) = (0, 0, 0);
    for n in 0..cells * cells * cells {
        let place =
            [n / (cells * cells), n / cells % cells, n % cells].map(|k| (k as f64 + 0.5) * h - 1.0);
        let round = place.iter().map(|x| x * x).sum::<f64>().sqrt();
        let inside = surface.contains(place);
        in_facets += usize::from(inside);
        in_sphere += usize::from(round <= 1.0);
        // No facet is deeper than 1 - cos(l/2 sqrt(4/3)) with its longest edge l below 1.8/count
        // times sqrt 2.
        let depth = (2.55 / count as f64).powi(2) / 6.0;
        between += usize::from(inside != (round <= 1.0) && !(1.0 - depth..=1.0).contains(&round));
    }
    assert_eq!(between, 0, "only places between facets and sphere may differ");
    assert!(in_facets <= in_sphere && in_facets > in_sphere * 99 / 100);
    // About 4 pi/h^2 cells are cut, each wrong by up to half of h^3 in either direction.
    let volume = in_facets as f64 * h.powi(3);
    let expected = (4.0 * std::f64::consts::PI).sqrt() * h * h;
    assert!((volume - surface.volume()).abs() < 4.0 * expected);
}

fn read_all(bytes: &[u8]) {
    let _ =
        stl::read(bytes).map(|triangles| Surface::new(&triangles).map(|s| s.contains([0.5; 3])));
    for dimension in 1..=3 {
        let _ = gmsh::read(bytes, dimension).map(|mesh| mesh.points());
        let _ = list::read(bytes, dimension);
    }
}

/// All small files to break.
fn seeds() -> Vec<Vec<u8>> {
    let all = files("meshes").into_iter().chain(files("script/files"));
    let texts = all.map(|path| std::fs::read(path).unwrap());
    texts.filter(|bytes| bytes.len() < 3000).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn mutated_files_never_panic(
        seed in 0usize..1000,
        cuts in prop::collection::vec(
            (0.0..1.0f64, 0usize..40, prop::collection::vec(any::<u8>(), 0..6)), 1..4),
        digits in "[0-9eE.+-]{0,20}",
        length in 0.0..1.5f64,
    ) {
        let seeds = seeds();
        let mut bytes = seeds[seed % seeds.len()].clone();
        for (place, count, new) in cuts {
            let start = (place * bytes.len() as f64) as usize;
            let end = (start + count).min(bytes.len());
            bytes.splice(start..end, new);
        }
        let start = bytes.len() / 2;
        bytes.splice(start..start, digits.into_bytes());
        bytes.truncate((length * bytes.len() as f64) as usize);
        read_all(&bytes);
    }

    #[test]
    fn any_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        read_all(&bytes);
    }
}
