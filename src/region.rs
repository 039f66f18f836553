//! Regions: tests on points (language.md 6.3).

pub mod block;
pub mod cylinder;
pub mod logical;
pub mod sphere;
pub mod stl;

use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::Diagnostic;
use crate::style::Style;
use std::sync::Arc;

/// Bounds of a region, per axis lower and upper \[L\]; infinite where unbounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub lower: [f64; 3],
    /// Upper corner.
    pub upper: [f64; 3],
}

impl Bounds {
    /// All of space.
    pub const EVERYWHERE: Bounds =
        Bounds { lower: [f64::NEG_INFINITY; 3], upper: [f64::INFINITY; 3] };

    /// The smallest box around both.
    pub fn around(self, other: Bounds) -> Bounds {
        Bounds {
            lower: std::array::from_fn(|a| self.lower[a].min(other.lower[a])),
            upper: std::array::from_fn(|a| self.upper[a].max(other.upper[a])),
        }
    }

    /// What both have in common.
    pub fn common(self, other: Bounds) -> Bounds {
        Bounds {
            lower: std::array::from_fn(|a| self.lower[a].max(other.lower[a])),
            upper: std::array::from_fn(|a| self.upper[a].min(other.upper[a])),
        }
    }
}

/// A set of points; all limits are inclusive.
pub trait Region: Send + Sync {
    /// Is the point in the region?
    fn contains(&self, point: [f64; 3]) -> bool;

    /// A box around the region, on the axes of the problem.
    fn bounds(&self) -> Bounds;
}

/// Finds an earlier region by its ID.
pub type FindRegion<'a> = dyn Fn(&Name) -> Result<Arc<dyn Region>, Diagnostic> + 'a;

/// Reads a file that a script names.
pub type ReadFile<'a> = dyn Fn(&Name) -> Result<Vec<u8>, Diagnostic> + 'a;

/// What a region's arguments may refer to.
pub struct RegionContext<'a> {
    /// 1, 2 or 3.
    pub dimension: usize,
    /// Finds an earlier region.
    pub find: &'a FindRegion<'a>,
    /// Reads a file.
    pub read: &'a ReadFile<'a>,
}

/// Builds a region from its arguments.
pub type BuildRegion = fn(&mut Args<'_>, &RegionContext<'_>) -> Result<Arc<dyn Region>, Diagnostic>;

/// All region styles.
pub const REGIONS: &[Style<BuildRegion>] = &[
    block::STYLE,
    cylinder::STYLE,
    sphere::STYLE,
    logical::UNION,
    logical::INTERSECTION,
    logical::DIFFERENCE,
    stl::STYLE,
];

/// The points outside a region.
pub struct Exterior(pub Arc<dyn Region>);

impl Region for Exterior {
    fn contains(&self, point: [f64; 3]) -> bool {
        !self.0.contains(point)
    }

    fn bounds(&self) -> Bounds {
        Bounds::EVERYWHERE
    }
}

/// The region, or its outside if the next argument is `exterior`.
fn or_exterior(args: &mut Args<'_>, region: impl Region + 'static) -> Arc<dyn Region> {
    let region = Arc::new(region);
    if args.keyword("exterior") { Arc::new(Exterior(region)) } else { region }
}
