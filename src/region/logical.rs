//! Union, intersection and difference of earlier regions.

use super::{Bounds, BuildRegion, Region, RegionContext};
use crate::script::arguments::Args;
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::sync::Arc;

/// The row of `union`.
pub const UNION: Style<BuildRegion> = Style {
    name: "union",
    usage: "region1, region2, ...",
    summary: "points in any of the regions",
    manual: "Two or more earlier regions.",
    build: Some(|args, context| Ok(Arc::new(Union(several(args, context)?)))),
};

/// The row of `intersection`.
pub const INTERSECTION: Style<BuildRegion> = Style {
    name: "intersection",
    usage: "region1, region2, ...",
    summary: "points in all of the regions",
    manual: "Two or more earlier regions.",
    build: Some(|args, context| Ok(Arc::new(Intersection(several(args, context)?)))),
};

/// The row of `difference`.
pub const DIFFERENCE: Style<BuildRegion> = Style {
    name: "difference",
    usage: "region1, region2",
    summary: "points in the first region and not in the second",
    manual: "Two earlier regions.",
    build: Some(|args, context| Ok(Arc::new(Difference(one(args, context)?, one(args, context)?)))),
};

fn one(args: &mut Args<'_>, context: &RegionContext<'_>) -> Result<Arc<dyn Region>, Diagnostic> {
    let name = args.word("a region ID")?;
    (context.find)(&name)
}

fn several(
    args: &mut Args<'_>,
    context: &RegionContext<'_>,
) -> Result<Vec<Arc<dyn Region>>, Diagnostic> {
    let mut regions = vec![one(args, context)?, one(args, context)?];
    while args.remaining() > 0 {
        regions.push(one(args, context)?);
    }
    Ok(regions)
}

/// Points in any of the regions.
pub struct Union(pub Vec<Arc<dyn Region>>);

impl Region for Union {
    fn contains(&self, point: [f64; 3]) -> bool {
        self.0.iter().any(|region| region.contains(point))
    }

    fn bounds(&self) -> Bounds {
        let all = self.0.iter().map(|region| region.bounds());
        all.reduce(Bounds::around).unwrap_or(Bounds::EVERYWHERE)
    }
}

/// Points in all of the regions.
pub struct Intersection(pub Vec<Arc<dyn Region>>);

impl Region for Intersection {
    fn contains(&self, point: [f64; 3]) -> bool {
        self.0.iter().all(|region| region.contains(point))
    }

    fn bounds(&self) -> Bounds {
        self.0.iter().map(|region| region.bounds()).fold(Bounds::EVERYWHERE, Bounds::common)
    }
}

/// Points in the first region and not in the second.
pub struct Difference(pub Arc<dyn Region>, pub Arc<dyn Region>);

impl Region for Difference {
    fn contains(&self, point: [f64; 3]) -> bool {
        self.0.contains(point) && !self.1.contains(point)
    }

    fn bounds(&self) -> Bounds {
        self.0.bounds()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::sphere::Sphere;

    fn interval(centre: f64) -> Arc<dyn Region> {
        Arc::new(Sphere { dimension: 1, centre: [centre, 0.0, 0.0], radius: 1.0 })
    }

    #[test]
    fn the_three_operations_on_overlapping_intervals() {
        let (a, b) = (interval(0.0), interval(1.5));
        let union = Union(vec![a.clone(), b.clone()]);
        let intersection = Intersection(vec![a.clone(), b.clone()]);
        let difference = Difference(a, b);
        for (x, expected) in [
            (-0.5, [true, false, true]),
            (0.75, [true, true, false]),
            (2.0, [true, false, false]),
            (3.0, [false, false, false]),
        ] {
            let point = [x, 0.0, 0.0];
            let found =
                [union.contains(point), intersection.contains(point), difference.contains(point)];
            assert_eq!(found, expected, "at {x}");
        }
        assert_eq!((union.bounds().lower[0], union.bounds().upper[0]), (-1.0, 2.5));
        assert_eq!((intersection.bounds().lower[0], intersection.bounds().upper[0]), (0.5, 1.0));
    }
}
