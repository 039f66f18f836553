//! The figure of all curves (`plot`, `save_plot`).

use super::canvas::{Anchor, Canvas, Colour, Mark, round_step};
use super::{file, number};
use crate::fault::Fault;
use std::fmt::Write;
use std::path::Path;

/// A curve to draw.
pub struct Curve<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// Names of x and y.
    pub axes: [&'a str; 2],
    /// Its points.
    pub points: &'a [[f64; 2]],
}

/// Writes the figure in the format of the suffix: `.pdf`, `.png`, `.svg`, or `.csv` with columns.
///
/// # Errors
/// The path and the system's reason.
pub fn save(path: &Path, curves: &[Curve<'_>]) -> Result<(), Fault> {
    let bytes = match path.extension().and_then(|suffix| suffix.to_str()) {
        Some("csv") => columns(curves).into_bytes(),
        _ => draw(curves).encode(path),
    };
    file::write_whole(path, &bytes)
}

/// Two columns for each curve; shorter curves end in empty fields.
fn columns(curves: &[Curve<'_>]) -> String {
    let mut text = String::new();
    let names: Vec<String> = curves
        .iter()
        .map(|curve| format!("{}:{},{}:{}", curve.name, curve.axes[0], curve.name, curve.axes[1]))
        .collect();
    let _ = writeln!(text, "{}", names.join(","));
    let longest = curves.iter().map(|curve| curve.points.len()).max().unwrap_or(0);
    for row in 0..longest {
        let field = |curve: &Curve<'_>| match curve.points.get(row) {
            Some([x, y]) => format!("{},{}", number::text(*x), number::text(*y)),
            None => ",".to_string(),
        };
        let _ = writeln!(text, "{}", curves.iter().map(field).collect::<Vec<_>>().join(","));
    }
    text
}

const SIZE: [u32; 2] = [900, 600];
const LEFT: f64 = 90.0;
const RIGHT: f64 = 150.0;
const TOP: f64 = 20.0;
const BOTTOM: f64 = 60.0;

/// Smallest and largest finite value on an axis; a little room if they are equal.
fn range(curves: &[Curve<'_>], axis: usize) -> [f64; 2] {
    let values = curves.iter().flat_map(|curve| curve.points).map(|point| point[axis]);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values.filter(|value| value.is_finite()) {
        low = low.min(value);
        high = high.max(value);
    }
    if low > high {
        return [0.0, 1.0];
    }
    let margin = if high > low { 0.04 * (high - low) } else { low.abs().max(1.0) * 0.5 };
    let margin = if axis == 0 && high > low { 0.0 } else { margin };
    [low - margin, high + margin]
}

fn draw(curves: &[Curve<'_>]) -> Canvas {
    let mut canvas = Canvas::new(SIZE[0], SIZE[1]);
    let ranges = [range(curves, 0), range(curves, 1)];
    let room = [f64::from(SIZE[0]) - LEFT - RIGHT, f64::from(SIZE[1]) - TOP - BOTTOM];
    let pixel = |[x, y]: [f64; 2]| {
        let part = |value: f64, axis: usize| {
            let [low, high]: [f64; 2] = ranges[axis];
            (value - low) / (high - low)
        };
        [(LEFT + room[0] * part(x, 0)) as f32, (TOP + room[1] * (1.0 - part(y, 1))) as f32]
    };
    ticks(&mut canvas, ranges, &pixel);
    for (number, curve) in curves.iter().enumerate() {
        let finite = |point: &&[f64; 2]| point.iter().all(|value| value.is_finite());
        let points: Vec<[f32; 2]> = curve.points.iter().filter(finite).map(|p| pixel(*p)).collect();
        canvas.marks.push(Mark::Path { points, width: 1.8, colour: Colour::of(number) });
        let y = TOP as f32 + 20.0 + 20.0 * number as f32;
        let x = SIZE[0] as f32 - RIGHT as f32 + 15.0;
        let segments = vec![[[x, y - 4.0], [x + 30.0, y - 4.0]]];
        canvas.marks.push(Mark::Lines { segments, width: 1.8, colour: Colour::of(number) });
        canvas.text([x + 38.0, y], 14.0, Anchor::Start, curve.name);
    }
    if let Some(first) = curves.first() {
        let middle = (LEFT + 0.5 * room[0]) as f32;
        canvas.text([middle, SIZE[1] as f32 - 14.0], 14.0, Anchor::Middle, first.axes[0]);
    }
    canvas
}

/// Border, grid lines and numbers.
fn ticks(canvas: &mut Canvas, ranges: [[f64; 2]; 2], pixel: &dyn Fn([f64; 2]) -> [f32; 2]) {
    let [[x0, x1], [y0, y1]] = ranges;
    let mut segments = Vec::new();
    let mut labels = Vec::new();
    for axis in 0..2 {
        let [low, high] = ranges[axis];
        let step = round_step(high - low, 6.0);
        let last = (high / step + 1e-9).floor() as i64;
        for tick in (low / step - 1e-9).ceil() as i64..=last {
            let value = tick as f64 * step;
            let (from, to) =
                if axis == 0 { ([value, y0], [value, y1]) } else { ([x0, value], [x1, value]) };
            segments.push([pixel(from), pixel(to)]);
            labels.push((axis, pixel(from), number::brief(value)));
        }
    }
    canvas.marks.push(Mark::Lines { segments, width: 0.6, colour: Colour::GREY });
    for (axis, [x, y], label) in labels {
        match axis {
            0 => canvas.text([x, y + 18.0], 12.0, Anchor::Middle, label),
            _ => canvas.text([x - 6.0, y + 4.0], 12.0, Anchor::End, label),
        }
    }
    let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]];
    let points = corners.map(pixel).to_vec();
    canvas.marks.push(Mark::Path { points, width: 1.0, colour: Colour::BLACK });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_has_the_points_in_columns() {
        let curves = [
            Curve { name: "a", axes: ["time", "Ek"], points: &[[0.0, 2.6], [0.1, 0.25]] },
            Curve { name: "b", axes: ["time", "Es"], points: &[[0.0, 1e-9]] },
        ];
        assert_eq!(columns(&curves), "a:time,a:Ek,b:time,b:Es\n0,2.6,0,1e-9\n0.1,0.25,,\n");
    }

    #[test]
    fn ranges_ignore_what_is_not_finite_and_are_never_empty() {
        let points = [[0.0, f64::NAN], [1.0, 3.0], [f64::INFINITY, 5.0]];
        let curve = [Curve { name: "a", axes: ["x", "y"], points: &points }];
        assert_eq!(range(&curve, 0), [0.0, 1.0]);
        assert!(range(&curve, 1)[0] < 3.0 && range(&curve, 1)[1] > 5.0);
        assert_eq!(range(&[], 0), [0.0, 1.0]);
    }
}
