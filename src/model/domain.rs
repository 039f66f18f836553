//! The box of the simulation and its cells.

/// The box and the cell size, as `dimension(...)` gives them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// 1, 2 or 3.
    pub dimension: usize,
    /// Lower corner \[L\]; 0 on axes beyond the dimension.
    pub lower: [f64; 3],
    /// Upper corner \[L\]; 0 on axes beyond the dimension.
    pub upper: [f64; 3],
    /// Cell size h \[L\].
    pub cell: f64,
}

/// What happens to a particle whose centre leaves the box of updated Lagrangian methods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Boundary {
    /// The run stops.
    #[default]
    Error,
    /// It is removed.
    Delete,
    /// It is reflected.
    Bounce,
}

impl Domain {
    /// A box that holds nothing yet.
    pub fn nothing(dimension: usize) -> Self {
        let [mut lower, mut upper] = [[0.0; 3]; 2];
        lower[..dimension].fill(f64::INFINITY);
        upper[..dimension].fill(f64::NEG_INFINITY);
        Self { dimension, lower, upper, cell: 1.0 }
    }

    /// The smallest box around this one and another, with the cell size of this one.
    pub fn around(&self, other: &Domain) -> Self {
        Self {
            lower: std::array::from_fn(|axis| self.lower[axis].min(other.lower[axis])),
            upper: std::array::from_fn(|axis| self.upper[axis].max(other.upper[axis])),
            ..*self
        }
    }

    /// Cells of another size between other limits.
    pub fn of_limits(&self, lower: [f64; 3], upper: [f64; 3], cell: f64) -> Self {
        let corner = |limits: [f64; 3]| {
            std::array::from_fn(|axis| if axis < self.dimension { limits[axis] } else { 0.0 })
        };
        Self { lower: corner(lower), upper: corner(upper), cell, ..*self }
    }

    /// Cells per axis: ceil(L/h - 1e-6), so the last one may pass the box; 1 beyond the dimension.
    pub fn cells(&self) -> [usize; 3] {
        std::array::from_fn(|axis| {
            if axis >= self.dimension {
                return 1;
            }
            let length = self.upper[axis] - self.lower[axis];
            ((length / self.cell - 1e-6).ceil() as usize).max(1)
        })
    }

    /// The box with so many cells more around it.
    pub fn widened(&self, cells: usize) -> Self {
        let width = cells as f64 * self.cell;
        let corner = |limits: [f64; 3], by: f64| {
            std::array::from_fn(|axis| if axis < self.dimension { limits[axis] + by } else { 0.0 })
        };
        Self { lower: corner(self.lower, -width), upper: corner(self.upper, width), ..*self }
    }

    /// Moves all of it.
    pub fn shift(&mut self, by: [f64; 3]) {
        for axis in 0..self.dimension {
            self.lower[axis] += by[axis];
            self.upper[axis] += by[axis];
        }
    }

    /// Grows by whole cells until all places are inside.
    pub fn cover(&mut self, places: impl Iterator<Item = [f64; 3]>) {
        for place in places {
            for axis in 0..self.dimension {
                let below = ((self.lower[axis] - place[axis]) / self.cell).ceil();
                if below > 0.0 {
                    self.lower[axis] -= below * self.cell;
                }
                self.upper[axis] = self.upper[axis].max(place[axis]);
            }
        }
    }

    /// Is the point inside the box, borders included?
    pub fn contains(&self, point: [f64; 3]) -> bool {
        (0..self.dimension).all(|a| point[a] >= self.lower[a] && point[a] <= self.upper[a])
    }
}
