//! A regular lattice of nodes: the grid of the box, or of one solid in total Lagrangian methods.

use super::domain::Domain;

/// Window of nodes in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Window {
    /// Index of its first node in the whole lattice.
    pub lower: [usize; 3],
    /// Nodes per axis.
    pub size: [usize; 3],
    /// Place in memory of its first node.
    pub start: usize,
}

impl Window {
    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.size.iter().product()
    }

    /// Is there no node?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Places in memory.
    pub fn places(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.len()
    }

    /// Place in memory of a node of the whole lattice, if the window holds it.
    pub fn local(&self, node: [usize; 3]) -> Option<usize> {
        let mut local = 0;
        for axis in 0..3 {
            let offset = node[axis].checked_sub(self.lower[axis])?;
            if offset >= self.size[axis] {
                return None;
            }
            local = local * self.size[axis] + offset;
        }
        Some(self.start + local)
    }

    /// The node of the whole lattice at a place in memory.
    pub fn node(&self, place: usize) -> [usize; 3] {
        let local = place - self.start;
        let [_, ny, nz] = self.size;
        let node = [local / (ny * nz), local / nz % ny, local % nz];
        std::array::from_fn(|axis| node[axis] + self.lower[axis])
    }
}

/// Nodes numbered (i ny + j) nz + k with z fastest, of which a window is in memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Its cells.
    pub cells: Domain,
    /// Nodes per axis; 1 beyond the dimension.
    pub nodes: [usize; 3],
    /// Distance between nodes \[L\]: the cell size, or half of it where cells have mid nodes.
    pub spacing: f64,
    /// Which nodes are in memory.
    pub window: Window,
}

impl Lattice {
    /// The lattice of the cells of a domain with `nodes_per_cell` nodes per cell and axis.
    pub fn new(cells: Domain, nodes_per_cell: usize) -> Self {
        let counts = cells.cells();
        let nodes = std::array::from_fn(|axis| match axis < cells.dimension {
            true => nodes_per_cell * counts[axis] + 1,
            false => 1,
        });
        let spacing = cells.cell / nodes_per_cell as f64;
        Self { cells, nodes, spacing, window: Window::default() }
    }

    /// Nodes per cell and axis.
    pub fn nodes_per_cell(&self) -> usize {
        (self.cells.cell / self.spacing).round() as usize
    }

    /// Place of a node \[L\].
    pub fn place(&self, node: [usize; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| match axis < self.cells.dimension {
            true => self.cells.lower[axis] + node[axis] as f64 * self.spacing,
            false => 0.0,
        })
    }

    /// Places in memory of the nodes at x = 0 and below, if the lattice has some (two dimensions).
    pub fn axis(&self) -> std::ops::Range<usize> {
        let below = 1.0 - self.cells.lower[0] / self.spacing;
        let rows = ((below + 1e-9).floor().max(0.0) as usize)
            .saturating_sub(self.window.lower[0])
            .min(self.window.size[0]);
        self.window.start..self.window.start + rows * self.window.size[1]
    }

    /// Number of a node, from 0.
    pub fn number(&self, node: [usize; 3]) -> u64 {
        let [_, ny, nz] = self.nodes;
        ((node[0] * ny + node[1]) * nz + node[2]) as u64
    }

    /// Number of all nodes, in memory or not.
    pub fn count(&self) -> u64 {
        self.nodes.iter().map(|count| *count as u64).product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_are_numbered_with_the_last_axis_fastest() {
        let cells =
            Domain { dimension: 2, lower: [-1.0, 0.0, 0.0], upper: [1.0, 0.5, 0.0], cell: 0.5 };
        let lattice = Lattice::new(cells, 1);
        assert_eq!(lattice.nodes, [5, 2, 1]);
        assert_eq!((lattice.number([1, 0, 0]), lattice.count()), (2, 10));
        assert_eq!(lattice.place([3, 1, 0]), [0.5, 0.5, 0.0]);
        let fine = Lattice::new(cells, 2);
        assert_eq!((fine.nodes, fine.spacing), ([9, 3, 1], 0.25));
    }

    #[test]
    fn the_axis_is_where_x_is_zero_if_the_window_holds_it() {
        let [lower, upper] = [[0.0; 3], [1.0, 0.5, 0.0]];
        let cells = Domain { dimension: 2, lower, upper, cell: 0.25 };
        let mut lattice = Lattice::new(cells, 1);
        lattice.window = Window { lower: [0, 1, 0], size: [3, 2, 1], start: 7 };
        assert_eq!(lattice.axis(), 7..9);
        lattice.window.lower[0] = 1;
        assert!(lattice.axis().is_empty());
        let hollow = Lattice::new(Domain { lower: [0.25, 0.0, 0.0], ..cells }, 1);
        assert!(hollow.axis().is_empty());
        // A layer of nodes behind the axis.
        let mut wide = Lattice::new(cells.widened(1), 1);
        wide.window = Window { lower: [0, 1, 0], size: [3, 2, 1], start: 7 };
        assert_eq!(wide.axis(), 7..11);
    }

    #[test]
    fn a_window_finds_its_nodes_and_no_others() {
        let window = Window { lower: [2, 0, 1], size: [3, 1, 2], start: 10 };
        assert_eq!(window.places(), 10..16);
        assert_eq!(window.local([3, 0, 2]), Some(13));
        assert_eq!(window.node(13), [3, 0, 2]);
        assert_eq!(window.local([1, 0, 1]), None);
        assert_eq!(window.local([2, 0, 3]), None);
    }
}
