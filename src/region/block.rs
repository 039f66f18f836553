//! A box.

use super::{Bounds, BuildRegion, Region, or_exterior};
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::style::Style;

/// The row of the table.
pub const STYLE: Style<BuildRegion> = Style {
    name: "block",
    usage: "xlo, xhi [, ylo, yhi [, zlo, zhi]] [, exterior]",
    summary: "a box; INF, -INF, +INF and EDGE stand for no limit",
    manual: "All limits [L] are inclusive; axes beyond the dimension are ignored.",
    build: Some(|args, context| {
        let block = read(args, context.dimension)?;
        let region = or_exterior(args, block);
        drop_old_words(args);
        Ok(region)
    }),
};

/// lower <= x <= upper on every axis.
pub struct Block(pub Bounds);

impl Region for Block {
    fn contains(&self, point: [f64; 3]) -> bool {
        (0..3).all(|a| point[a] >= self.0.lower[a] && point[a] <= self.0.upper[a])
    }

    fn bounds(&self) -> Bounds {
        self.0
    }
}

fn read(args: &mut Args<'_>, dimension: usize) -> Result<Block, Diagnostic> {
    let mut bounds = Bounds::EVERYWHERE;
    for axis in 0..3 {
        let words = ["exterior", "op", "op2"];
        if axis >= dimension && args.peek().is_none_or(|word| words.contains(&word)) {
            break;
        }
        let name = ["x", "y", "z"][axis];
        let start = args.next_span();
        let lower = limit(args, &format!("the lower {name} limit"), f64::NEG_INFINITY)?;
        let upper = limit(args, &format!("the upper {name} limit"), f64::INFINITY)?;
        if lower > upper {
            let message = format!("the lower {name} limit {lower} is above the upper one, {upper}");
            return Err(
                Diagnostic::error(Code::Range, start, message).label("above the upper limit")
            );
        }
        if axis < dimension {
            bounds.lower[axis] = lower;
            bounds.upper[axis] = upper;
        }
    }
    Ok(Block(bounds))
}

/// A number, or no limit: `EDGE` on either side, `INF` above and `-INF` below (and, as old
/// scripts write it, `INF` below as well).
fn limit(args: &mut Args<'_>, what: &str, unbounded: f64) -> Result<f64, Diagnostic> {
    let word = args.peek().map(str::to_string).unwrap_or_default();
    if ["INF", "+INF", "-INF", "EDGE"].contains(&word.as_str()) {
        args.word(what)?;
        return Ok(unbounded);
    }
    Ok(args.number(what)?.value)
}

fn drop_old_words(args: &mut Args<'_>) {
    for word in ["op", "op2"] {
        let span = args.next_span();
        if args.keyword(word) {
            args.remarks.push(
                Diagnostic::warning(Code::Compatibility, span, format!("`{word}` is ignored"))
                    .label("an old form: delete it"),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_inclusive_and_may_be_missing() {
        let mut bounds = Bounds::EVERYWHERE;
        (bounds.lower[0], bounds.upper[0]) = (-1.0, 2.0);
        let block = Block(bounds);
        assert!(block.contains([-1.0, 1e300, -1e300]) && block.contains([2.0, 0.0, 0.0]));
        assert!(!block.contains([2.0 + 4e-16, 0.0, 0.0]) && !block.contains([f64::NAN, 0.0, 0.0]));
    }
}
