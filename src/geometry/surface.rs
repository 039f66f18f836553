//! A closed surface of triangles, and which points it encloses.
//!
//! A point is inside if the surface winds around it, or if it lies on the surface. The winding
//! number is the sum over the triangles above the point of the sign of their normal's z component.
//! Signs of determinants are exact (Shewchuk, Discrete Comput. Geom. 18, 1997), and an edge counts
//! for one of its two sides only, so that no column of points passes between two triangles.

use super::stl::Triangle;
use super::{Mistake, place_in_words};
use robust::{Coord, Coord3D, orient2d, orient3d};
use std::collections::HashMap;

/// Columns that a triangle may be listed in, on average.
const LISTED: usize = 12;

/// Most columns along an axis.
const MOST_COLUMNS: usize = 2048;

/// A closed surface.
#[derive(Debug)]
pub struct Surface {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    columns: Columns,
    /// Lower corner \[L\].
    pub lower: [f64; 3],
    /// Upper corner \[L\].
    pub upper: [f64; 3],
}

impl Surface {
    /// The surface of triangles whose corners are in counter-clockwise order seen from outside.
    /// Corners with the same coordinates are one vertex; triangles without area do not count.
    ///
    /// # Errors
    /// An edge whose triangles do not cancel, or nothing enclosed.
    pub fn new(corners: &[Triangle]) -> Result<Self, Mistake> {
        if corners.is_empty() {
            return Err(Mistake::whole("there is no triangle in it"));
        }
        if corners.len() > (u32::MAX / 3) as usize {
            return Err(Mistake::whole("it has more triangles than can be numbered"));
        }
        let (vertices, triangles) = weld(corners);
        check_closed(&vertices, &triangles)?;
        let mut lower = [f64::INFINITY; 3];
        let mut upper = [f64::NEG_INFINITY; 3];
        for vertex in &vertices {
            for axis in 0..3 {
                lower[axis] = lower[axis].min(vertex[axis]);
                upper[axis] = upper[axis].max(vertex[axis]);
            }
        }
        let columns = Columns::new(&vertices, &triangles, lower, upper);
        let surface = Self { vertices, triangles, columns, lower, upper };
        if surface.volume() == 0.0 {
            return Err(Mistake::whole("its surface encloses no volume"));
        }
        Ok(surface)
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Is there no triangle? Never: such a surface is refused.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    fn corners(&self, triangle: u32) -> Triangle {
        self.triangles[triangle as usize].map(|vertex| self.vertices[vertex as usize])
    }

    /// Enclosed volume \[L^3\], negative if the triangles are in clockwise order: sum of
    /// a . (b x c)/6 about the middle of the bounds.
    pub fn volume(&self) -> f64 {
        let middle: [f64; 3] =
            std::array::from_fn(|axis| 0.5 * (self.lower[axis] + self.upper[axis]));
        let six = |triangle: u32| {
            let [a, b, c] = self
                .corners(triangle)
                .map(|corner| std::array::from_fn::<f64, 3, _>(|axis| corner[axis] - middle[axis]));
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        };
        (0..self.triangles.len() as u32).map(six).sum::<f64>() / 6.0
    }

    /// Is the point inside or on the surface?
    pub fn contains(&self, point: [f64; 3]) -> bool {
        let within =
            |axis: usize| point[axis] >= self.lower[axis] && point[axis] <= self.upper[axis];
        if !(within(0) && within(1) && within(2)) {
            return false;
        }
        let mut winding = 0;
        for triangle in self.columns.of(point) {
            let corners = self.corners(*triangle);
            if !spans(&corners, point, 0) || !spans(&corners, point, 1) {
                continue;
            }
            let turns = turns_around(&corners, point);
            let level = spans(&corners, point, 2);
            if turns == 0 && !level {
                continue;
            }
            let side = side_of_plane(&corners, point);
            if level && side == 0.0 && touches(&corners, point) {
                return true;
            }
            if side * f64::from(turns) > 0.0 {
                winding += turns;
            }
        }
        winding != 0
    }
}

/// Does the coordinate lie between those of the corners?
fn spans(corners: &Triangle, point: [f64; 3], axis: usize) -> bool {
    let [a, b, c] = corners.map(|corner| corner[axis]);
    let x = point[axis];
    x >= a.min(b).min(c) && x <= a.max(b).max(c)
}

fn flat(place: [f64; 3], axes: [usize; 2]) -> Coord<f64> {
    Coord { x: place[axes[0]], y: place[axes[1]] }
}

/// How often the projection of the triangle along z turns around the point: 1, 0 or -1. Edges are
/// crossed towards +x, half open in y.
fn turns_around(corners: &Triangle, point: [f64; 3]) -> i32 {
    const PLANE: [usize; 2] = [0, 1];
    let crossing = |a: [f64; 3], b: [f64; 3]| {
        let left = || orient2d(flat(a, PLANE), flat(b, PLANE), flat(point, PLANE));
        match (a[1] <= point[1], b[1] <= point[1]) {
            (true, false) if left() > 0.0 => 1,
            (false, true) if left() < 0.0 => -1,
            _ => 0,
        }
    };
    let [a, b, c] = *corners;
    crossing(a, b) + crossing(b, c) + crossing(c, a)
}

/// Positive if the triangle, seen counter-clockwise from above, lies above the point.
fn side_of_plane(corners: &Triangle, point: [f64; 3]) -> f64 {
    let [a, b, c] = corners.map(|[x, y, z]| Coord3D { x, y, z });
    let [x, y, z] = point;
    orient3d(a, b, c, Coord3D { x, y, z })
}

/// Does the triangle hold a point of its plane that lies within its bounds? It does if all three
/// projections hold it.
fn touches(corners: &Triangle, point: [f64; 3]) -> bool {
    [[0, 1], [1, 2], [2, 0]].into_iter().all(|axes| {
        let [a, b, c] = corners.map(|corner| flat(corner, axes));
        let p = flat(point, axes);
        let sides = [orient2d(a, b, p), orient2d(b, c, p), orient2d(c, a, p)];
        !(sides.iter().any(|side| *side > 0.0) && sides.iter().any(|side| *side < 0.0))
    })
}

/// Vertices and the triangles between them; triangles with two equal corners are left out.
fn weld(corners: &[Triangle]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut known: HashMap<[u64; 3], u32> = HashMap::new();
    let mut vertices = Vec::new();
    let mut triangles = Vec::with_capacity(corners.len());
    for triangle in corners {
        let numbers = triangle.map(|corner| {
            // -0 and 0 are the same place.
            let corner = corner.map(|x| x + 0.0);
            *known.entry(corner.map(f64::to_bits)).or_insert_with(|| {
                vertices.push(corner);
                vertices.len() as u32 - 1
            })
        });
        let [a, b, c] = numbers;
        if a != b && b != c && c != a {
            triangles.push(numbers);
        }
    }
    (vertices, triangles)
}

/// Refuses a surface with an edge that has not as many triangles on one side as on the other.
fn check_closed(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<(), Mistake> {
    // Lower vertex, upper vertex, runs upwards.
    let mut edges: Vec<(u32, u32, bool)> = triangles
        .iter()
        .flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)])
        .map(|(from, to)| (from.min(to), from.max(to), from < to))
        .collect();
    edges.sort_unstable();
    let open = edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).find(|edge| {
        let upwards = edge.iter().filter(|(.., upwards)| *upwards).count();
        2 * upwards != edge.len()
    });
    let Some(open) = open else { return Ok(()) };
    let ends = [open[0].0, open[0].1].map(|end| place_in_words(vertices[end as usize]));
    let reason = match open.len() {
        1 => "has a triangle on one side only".to_string(),
        2 => "has two triangles that are turned against each other".to_string(),
        count => format!("has {count} triangles that do not close"),
    };
    Err(Mistake::whole(format!(
        "the surface is not closed: the edge from {} to {} {reason}",
        ends[0], ends[1]
    )))
}

/// Triangles by the column of points, along z, that their bounds touch.
#[derive(Debug)]
struct Columns {
    count: [usize; 2],
    lower: [f64; 2],
    /// Columns per length.
    scale: [f64; 2],
    /// Where each column begins in `list`.
    start: Vec<u32>,
    list: Vec<u32>,
}

impl Columns {
    fn new(
        vertices: &[[f64; 3]],
        triangles: &[[u32; 3]],
        lower: [f64; 3],
        upper: [f64; 3],
    ) -> Self {
        let mut side = ((triangles.len() as f64).sqrt().ceil() as usize).clamp(1, MOST_COLUMNS);
        loop {
            let scale = |axis: usize| side as f64 / (upper[axis] - lower[axis]);
            let mut columns = Self {
                count: [side; 2],
                lower: [lower[0], lower[1]],
                scale: [scale(0), scale(1)],
                start: vec![0; side * side + 1],
                list: Vec::new(),
            };
            // One column holds everything; more of them only where that does not cost much.
            if columns.listed(vertices, triangles) <= LISTED * triangles.len() || side == 1 {
                columns.fill(vertices, triangles);
                return columns;
            }
            side /= 2;
        }
    }

    fn number(&self, x: f64, axis: usize) -> usize {
        (((x - self.lower[axis]) * self.scale[axis]) as usize).min(self.count[axis] - 1)
    }

    /// The columns that a triangle touches, first and last per axis.
    fn touched(&self, vertices: &[[f64; 3]], triangle: &[u32; 3]) -> [[usize; 2]; 2] {
        std::array::from_fn(|axis| {
            let [a, b, c] =
                triangle.map(|vertex| self.number(vertices[vertex as usize][axis], axis));
            [a.min(b).min(c), a.max(b).max(c)]
        })
    }

    fn listed(&self, vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> usize {
        let of = |triangle: &[u32; 3]| {
            let [x, y] = self.touched(vertices, triangle);
            (x[1] - x[0] + 1) * (y[1] - y[0] + 1)
        };
        triangles.iter().map(of).fold(0, usize::saturating_add)
    }

    fn fill(&mut self, vertices: &[[f64; 3]], triangles: &[[u32; 3]]) {
        let each = |columns: &Self, visit: &mut dyn FnMut(usize, usize)| {
            for (number, triangle) in triangles.iter().enumerate() {
                let [x, y] = columns.touched(vertices, triangle);
                for i in x[0]..=x[1] {
                    for j in y[0]..=y[1] {
                        visit(i * columns.count[1] + j, number);
                    }
                }
            }
        };
        let mut start = std::mem::take(&mut self.start);
        each(self, &mut |column, _| start[column + 1] += 1);
        for column in 1..start.len() {
            start[column] += start[column - 1];
        }
        let mut next = start.clone();
        let mut list = vec![0; start[start.len() - 1] as usize];
        each(self, &mut |column, triangle| {
            list[next[column] as usize] = triangle as u32;
            next[column] += 1;
        });
        (self.start, self.list) = (start, list);
    }

    /// The triangles that a point may see above or below it.
    fn of(&self, point: [f64; 3]) -> &[u32] {
        let column = self.number(point[0], 0) * self.count[1] + self.number(point[1], 1);
        &self.list[self.start[column] as usize..self.start[column + 1] as usize]
    }
}

#[cfg(test)]
mod tests;
