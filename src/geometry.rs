//! Shapes from files: closed surfaces, meshes and lists of particles.
//!
//! Readers take the bytes of a whole file. Counts in a file are never trusted: memory grows with
//! what has been read.

pub mod element;
pub mod gmsh;
pub mod list;
pub mod stl;
pub mod surface;
mod words;

use element::MOST_CORNERS;

/// Coordinates beyond this \[L\] are refused, so that products of three of them stay finite.
const FARTHEST: f64 = 1e60;

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    /// The line, from 1; `None` for binary files and for mistakes of the whole.
    pub line: Option<usize>,
    /// What is wrong.
    pub what: String,
}

impl Mistake {
    fn whole(what: impl Into<String>) -> Self {
        Self { line: None, what: what.into() }
    }

    fn at(line: usize, what: impl Into<String>) -> Self {
        Self { line: Some(line), what: what.into() }
    }
}

/// Where a particle goes and how much space it fills.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Its place \[L\]; 0 on axes beyond the dimension.
    pub place: [f64; 3],
    /// Its volume \[L^d\].
    pub volume: f64,
}

/// The corners of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corners {
    places: [[f64; 3]; MOST_CORNERS],
    count: usize,
}

impl Corners {
    /// From their places \[L\], at most as many as a hexahedron has.
    pub fn new(corners: &[[f64; 3]]) -> Self {
        let mut places = [[0.0; 3]; MOST_CORNERS];
        places[..corners.len()].copy_from_slice(corners);
        Self { places, count: corners.len() }
    }

    /// Their places \[L\].
    pub fn places(&self) -> &[[f64; 3]] {
        &self.places[..self.count]
    }
}

/// The particles of a body, as a file gives them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// The particles.
    pub list: Vec<Point>,
    /// Corners of the elements that particles are made of; empty where there are no elements.
    pub corners: Vec<Corners>,
    /// Lower corner of the body \[L\].
    pub lower: [f64; 3],
    /// Upper corner of the body \[L\].
    pub upper: [f64; 3],
    /// What is odd about the file, in words.
    pub remarks: Vec<String>,
}

impl Points {
    /// The corners of the element of a particle; none if it has no element.
    pub fn corners_of(&self, number: usize) -> &[[f64; 3]] {
        self.corners.get(number).map_or(&[], Corners::places)
    }

    /// Edge of a square or cube of the mean volume \[L\].
    pub fn spacing(&self, dimension: usize) -> f64 {
        let volume: f64 = self.list.iter().map(|point| point.volume).sum();
        (volume / self.list.len().max(1) as f64).powf(1.0 / dimension as f64)
    }
}

/// A coordinate in words, as short as it is exact.
fn place_in_words(place: [f64; 3]) -> String {
    format!("({}, {}, {})", place[0], place[1], place[2])
}
