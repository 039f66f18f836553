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

impl Domain {
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

    /// Nodes per axis; 1 beyond the dimension.
    pub fn nodes(&self) -> [usize; 3] {
        let cells = self.cells();
        std::array::from_fn(|axis| if axis < self.dimension { cells[axis] + 1 } else { 1 })
    }

    /// Place of a node \[L\].
    pub fn node(&self, index: [usize; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| {
            if axis < self.dimension {
                self.lower[axis] + index[axis] as f64 * self.cell
            } else {
                0.0
            }
        })
    }

    /// Is the point inside the box, borders included?
    pub fn contains(&self, point: [f64; 3]) -> bool {
        (0..self.dimension).all(|a| point[a] >= self.lower[a] && point[a] <= self.upper[a])
    }
}
