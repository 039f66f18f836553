//! Where the particles of a solid go (language.md 6.3).

use crate::geometry::Points;
use crate::model::domain::Domain;
use crate::region::{Bounds, Region};
use std::ops::{ControlFlow, RangeInclusive};
use std::sync::Arc;

/// What the particles of a solid come from.
#[derive(Clone)]
pub enum Filling {
    /// The cells, so many particles in each per axis, as far as the region reaches.
    Region {
        /// The region.
        region: Arc<dyn Region>,
        /// Particles per cell and axis.
        particles_per_cell: usize,
        /// At even distances, as domains of particles fill a cell without gaps.
        even: bool,
    },
    /// A list.
    Points(Arc<Points>),
}

impl Filling {
    /// A box around the body, on the axes of the problem.
    pub fn bounds(&self) -> Bounds {
        match self {
            Filling::Region { region, .. } => region.bounds(),
            Filling::Points(points) => Bounds { lower: points.lower, upper: points.upper },
        }
    }

    /// Visits place and volume of the particles inside the domain, in the order of their ids,
    /// until told to stop.
    pub fn visit<T>(
        &self,
        domain: &Domain,
        mut each: impl FnMut([f64; 3], f64) -> ControlFlow<T>,
    ) -> ControlFlow<T> {
        match self {
            Filling::Region { region, particles_per_cell, even } => {
                let volume = volume(domain, *particles_per_cell);
                let offsets = offsets(*particles_per_cell, *even);
                visit(domain, region.as_ref(), &offsets, |place| each(place, volume))
            }
            Filling::Points(points) => {
                for point in &points.list {
                    if domain.contains(point.place) {
                        each(point.place, point.volume)?;
                    }
                }
                ControlFlow::Continue(())
            }
        }
    }
}

/// Volume of each particle of a region \[L^d\]: (h/ppc)^d.
pub fn volume(domain: &Domain, particles_per_cell: usize) -> f64 {
    (domain.cell / particles_per_cell as f64).powi(domain.dimension as i32)
}

/// Edge of a square or cube of some volume \[L\].
pub fn edge(volume: f64, dimension: usize) -> f64 {
    match dimension {
        1 => volume,
        2 => volume.sqrt(),
        _ => volume.cbrt(),
    }
}

/// Offsets of the particles of a cell on one axis, in cell sizes (language.md 6.3); three are as far
/// apart as the points of Gauss unless they are to be at `even` distances.
pub fn offsets(particles_per_cell: usize, even: bool) -> Vec<f64> {
    match particles_per_cell {
        1 => vec![0.0],
        2 => vec![-0.25, 0.25],
        3 if even => vec![-1.0 / 3.0, 0.0, 1.0 / 3.0],
        3 => vec![-0.7746 / 2.0, 0.0, 0.7746 / 2.0],
        n => (0..n).map(|i| (i as f64 + 0.5) / n as f64 - 0.5).collect(),
    }
}

/// Cells (or nodes, with `extra` = 1) of the domain that a region's bounds can touch, per axis.
pub fn touched(domain: &Domain, bounds: &Bounds, extra: usize) -> [RangeInclusive<usize>; 3] {
    let cells = domain.cells();
    std::array::from_fn(|axis| {
        if axis >= domain.dimension {
            return 0..=0;
        }
        let last = cells[axis] - 1 + extra;
        let r = |limit: f64| (limit - domain.lower[axis]) / domain.cell;
        let low = (r(bounds.lower[axis]) - 1.0).floor().clamp(0.0, last as f64) as usize;
        let high = (r(bounds.upper[axis]) + 1.0).ceil().clamp(0.0, last as f64) as usize;
        low..=high
    })
}

/// Visits the places of the particles that would fill a region, with these offsets in cells, in the
/// order of their ids, until told to stop.
pub fn visit<T>(
    domain: &Domain,
    region: &dyn Region,
    offsets: &[f64],
    mut visit: impl FnMut([f64; 3]) -> ControlFlow<T>,
) -> ControlFlow<T> {
    visit_cells(domain, region, offsets, touched(domain, &region.bounds(), 0), &mut visit)
}

/// The same in some cells, with the last axis fastest.
pub fn visit_cells<T>(
    domain: &Domain,
    region: &dyn Region,
    offsets: &[f64],
    [across, along, up]: [RangeInclusive<usize>; 3],
    visit: &mut impl FnMut([f64; 3]) -> ControlFlow<T>,
) -> ControlFlow<T> {
    let pattern = |axis: usize| {
        if axis < domain.dimension { offsets } else { &[0.0][..] }
    };
    let place = |axis: usize, cell: usize, offset: f64| {
        if axis < domain.dimension {
            domain.lower[axis] + (cell as f64 + 0.5 + offset) * domain.cell
        } else {
            0.0
        }
    };
    for i in across {
        for j in along.clone() {
            for k in up.clone() {
                for a in pattern(0) {
                    for b in pattern(1) {
                        for c in pattern(2) {
                            let point = [place(0, i, *a), place(1, j, *b), place(2, k, *c)];
                            if domain.contains(point) && region.contains(point) {
                                visit(point)?;
                            }
                        }
                    }
                }
            }
        }
    }
    ControlFlow::Continue(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::block::Block;

    fn places(domain: &Domain, bounds: Bounds, particles_per_cell: usize) -> Vec<[f64; 3]> {
        let mut places = Vec::new();
        let _: ControlFlow<()> =
            visit(domain, &Block(bounds), &offsets(particles_per_cell, false), |place| {
                places.push(place);
                ControlFlow::Continue(())
            });
        places
    }

    #[test]
    fn particles_lie_at_their_offsets_with_the_last_axis_fastest() {
        let domain = Domain { dimension: 2, lower: [0.0; 3], upper: [2.0, 1.0, 0.0], cell: 1.0 };
        let found = places(&domain, Bounds::EVERYWHERE, 2);
        assert_eq!(found.len(), 8);
        assert_eq!(found[1], [0.25, 0.75, 0.0]);
        assert_eq!(found[2], [0.75, 0.25, 0.0]);
        assert_eq!(found[4], [1.25, 0.25, 0.0]);
    }

    #[test]
    fn a_region_outside_the_box_is_empty_and_a_last_cell_is_cut() {
        let domain = Domain { dimension: 1, lower: [0.0; 3], upper: [1.2, 0.0, 0.0], cell: 0.5 };
        let mut far = Bounds::EVERYWHERE;
        far.lower[0] = 5.0;
        assert!(places(&domain, far, 1).is_empty());
        let all: Vec<f64> = places(&domain, Bounds::EVERYWHERE, 2).iter().map(|p| p[0]).collect();
        assert_eq!(all, [0.125, 0.375, 0.625, 0.875, 1.125]);
    }

    #[test]
    fn offsets_of_one_to_four_particles() {
        assert_eq!(offsets(1, false), [0.0]);
        assert_eq!(offsets(2, false), [-0.25, 0.25]);
        assert_eq!(offsets(3, false), [-0.3873, 0.0, 0.3873]);
        assert_eq!(offsets(3, true), [-1.0 / 3.0, 0.0, 1.0 / 3.0]);
        assert_eq!(offsets(4, false), [-0.375, -0.125, 0.125, 0.375]);
    }
}
