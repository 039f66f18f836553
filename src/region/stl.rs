//! The inside of a closed surface of triangles.

use super::{Bounds, BuildRegion, Region};
use crate::geometry::{stl, surface::Surface};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::style::Style;
use std::sync::Arc;

/// The row of the table.
pub const STYLE: Style<BuildRegion> = Style {
    name: "stl",
    usage: "file",
    summary: "the inside of a closed surface of triangles, 3-D",
    manual:
        "ASCII or binary STL. Corners with equal coordinates are one vertex; every edge must have
as many triangles on one side as on the other. A point is inside if the surface winds around it, or
if it lies on it. The file is looked for in the working directory, then beside the script.",
    build: Some(|args, context| {
        if context.dimension != 3 {
            let message = "a surface of triangles needs three dimensions";
            return Err(Diagnostic::error(Code::DimensionMismatch, args.span, message)
                .label(format!("the problem has {}", ["one", "two"][context.dimension - 1])));
        }
        let file = args.word("a file name")?;
        let bytes = (context.read)(&file)?;
        let surface = stl::read(&bytes).and_then(|triangles| Surface::new(&triangles));
        match surface {
            Ok(surface) => Ok(Arc::new(surface)),
            Err(mistake) => {
                Err(Diagnostic::in_file(&file.text, mistake.line, file.span, &mistake.what))
            }
        }
    }),
};

impl Region for Surface {
    fn contains(&self, point: [f64; 3]) -> bool {
        Surface::contains(self, point)
    }

    fn bounds(&self) -> Bounds {
        Bounds { lower: self.lower, upper: self.upper }
    }
}
