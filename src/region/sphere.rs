//! A sphere; a disk in 2-D, an interval in 1-D.

use super::{Bounds, BuildRegion, Region, or_exterior};
use crate::style::Style;

/// The row of the table.
pub const STYLE: Style<BuildRegion> = Style {
    name: "sphere",
    usage: "cx [, cy [, cz]], R [, exterior]",
    summary: "points within R of a centre",
    manual: "As many coordinates [L] as dimensions; R > 0; inclusive.",
    build: Some(|args, context| {
        let mut centre = [0.0; 3];
        for (axis, centre) in centre.iter_mut().enumerate().take(context.dimension) {
            *centre = args.number(["cx", "cy", "cz"][axis])?.value;
        }
        let radius = args.positive("the radius R")?.value;
        Ok(or_exterior(args, Sphere { dimension: context.dimension, centre, radius }))
    }),
};

/// |x - c| <= R on the axes of the problem.
pub struct Sphere {
    /// 1, 2 or 3.
    pub dimension: usize,
    /// Centre \[L\].
    pub centre: [f64; 3],
    /// Radius \[L\].
    pub radius: f64,
}

impl Region for Sphere {
    fn contains(&self, point: [f64; 3]) -> bool {
        let square: f64 = (0..self.dimension).map(|a| (point[a] - self.centre[a]).powi(2)).sum();
        square <= self.radius * self.radius
    }

    fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::EVERYWHERE;
        for axis in 0..self.dimension {
            bounds.lower[axis] = self.centre[axis] - self.radius;
            bounds.upper[axis] = self.centre[axis] + self.radius;
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_axes_of_the_problem_count() {
        let disk = Sphere { dimension: 2, centre: [1.0, 1.0, 0.0], radius: 1.0 };
        assert!(disk.contains([2.0, 1.0, 99.0]) && !disk.contains([2.0, 1.1, 0.0]));
    }
}
