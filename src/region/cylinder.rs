//! A disk in 2-D, a cylinder along an axis in 3-D.

use super::{Bounds, BuildRegion, Region, or_exterior};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::style::Style;

/// The row of the table.
pub const STYLE: Style<BuildRegion> = Style {
    name: "cylinder",
    usage: "2-D: cx, cy, R; 3-D: x|y|z, c1, c2, R, lo, hi; [, exterior]",
    summary: "a disk, or a cylinder along an axis",
    manual: "(c1, c2) = (y, z), (x, z), (x, y) for the axes x, y, z; R > 0; limits inclusive.",
    build: Some(|args, context| {
        if context.dimension == 1 {
            let message = "a cylinder needs two or three dimensions";
            return Err(Diagnostic::error(Code::DimensionMismatch, args.span, message)
                .label("the problem has one dimension"));
        }
        let cylinder = if context.dimension == 2 {
            let centre = [args.number("cx")?.value, args.number("cy")?.value];
            let radius = args.positive("the radius R")?.value;
            let ends = [f64::NEG_INFINITY, f64::INFINITY];
            Cylinder { axis: 2, centre, radius, ends }
        } else {
            let axis = args.choice("the axis", &["x", "y", "z"])?;
            let centre = [args.number("c1")?.value, args.number("c2")?.value];
            let radius = args.positive("the radius R")?.value;
            let low = args.number("the lower end lo")?;
            let high = args.number("the upper end hi")?;
            if low.value > high.value {
                return Err(args.out_of_range(&low, "the lower end lies above the upper one"));
            }
            Cylinder { axis, centre, radius, ends: [low.value, high.value] }
        };
        Ok(or_exterior(args, cylinder))
    }),
};

/// Points within the radius of an axis, between two ends.
pub struct Cylinder {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Centre on the two other axes, in order \[L\].
    pub centre: [f64; 2],
    /// Radius \[L\].
    pub radius: f64,
    /// Ends along the axis \[L\].
    pub ends: [f64; 2],
}

impl Cylinder {
    fn across(&self) -> [usize; 2] {
        [[1, 2], [0, 2], [0, 1]][self.axis]
    }
}

impl Region for Cylinder {
    fn contains(&self, point: [f64; 3]) -> bool {
        let [a, b] = self.across();
        let (da, db) = (point[a] - self.centre[0], point[b] - self.centre[1]);
        let along = point[self.axis];
        da * da + db * db <= self.radius * self.radius
            && along >= self.ends[0]
            && along <= self.ends[1]
    }

    fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::EVERYWHERE;
        for (axis, centre) in self.across().into_iter().zip(self.centre) {
            bounds.lower[axis] = centre - self.radius;
            bounds.upper[axis] = centre + self.radius;
        }
        bounds.lower[self.axis] = self.ends[0];
        bounds.upper[self.axis] = self.ends[1];
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cylinder_along_y_has_its_ends_and_its_rim() {
        let cylinder = Cylinder { axis: 1, centre: [1.0, -1.0], radius: 0.5, ends: [0.0, 2.0] };
        assert!(cylinder.contains([1.5, 0.0, -1.0]) && cylinder.contains([1.0, 2.0, -0.5]));
        assert!(!cylinder.contains([1.5, -1e-9, -1.0]) && !cylinder.contains([1.4, 1.0, -0.6]));
        assert_eq!(cylinder.bounds().lower, [0.5, 0.0, -1.5]);
    }
}
