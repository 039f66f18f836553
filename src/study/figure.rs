//! Error against seconds, both by their logarithm: a curve for each setting, from grid to grid.

use super::{Cost, Study};
use crate::fault::Fault;
use crate::output::canvas::{Anchor, Canvas, Colour, Mark};
use crate::output::{file, number};
use std::path::Path;

const SIZE: [f64; 2] = [960.0, 560.0];
const LEFT: f64 = 90.0;
const RIGHT: f64 = 300.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 60.0;
const LIGHT: Colour = Colour(225, 225, 225);

/// Writes the figure in the format of the suffix: `.svg`, `.png`, everything else PDF.
///
/// # Errors
/// The path and the system's reason.
pub fn save(path: &Path, study: &Study, title: &str) -> Result<(), Fault> {
    file::write_whole(path, &draw(study, title).encode(path))
}

/// Limits of an axis by their logarithm, with room around; whole decades apart at least a part.
fn limits(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values.filter(|value| *value > 0.0 && value.is_finite()) {
        low = low.min(value.log10());
        high = high.max(value.log10());
    }
    if low > high {
        return [-1.0, 1.0];
    }
    let room = (0.06 * (high - low)).max(0.1);
    [low - room, high + room]
}

struct Axes {
    limits: [[f64; 2]; 2],
}

impl Axes {
    /// Pixels of a point; `None` without logarithms.
    fn place(&self, [x, y]: [f64; 2]) -> Option<[f32; 2]> {
        let part = |value: f64, axis: usize| {
            let [low, high] = self.limits[axis];
            (value.log10() - low) / (high - low)
        };
        let finite = x > 0.0 && y > 0.0 && x.is_finite() && y.is_finite();
        finite.then(|| {
            let x = LEFT + (SIZE[0] - LEFT - RIGHT) * part(x, 0);
            let y = TOP + (SIZE[1] - TOP - BOTTOM) * (1.0 - part(y, 1));
            [x as f32, y as f32]
        })
    }

    /// Round values on an axis: 1, 2, 5 times powers of ten, or powers alone on long axes.
    fn ticks(&self, axis: usize) -> Vec<f64> {
        let [low, high] = self.limits[axis];
        let factors: &[f64] = if high - low < 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let powers = low.floor() as i32..=high.ceil() as i32;
        let values = powers.flat_map(|p| factors.iter().map(move |f| f * 10f64.powi(p)));
        values.filter(|v| (low..=high).contains(&v.log10())).collect()
    }

    fn frame(&self, canvas: &mut Canvas, names: [&str; 2]) {
        let corner =
            |x: usize, y: usize| [10f64.powf(self.limits[0][x]), 10f64.powf(self.limits[1][y])];
        let [[x0, y0], [x1, y1]] = [corner(0, 0), corner(1, 1)];
        let mut segments = Vec::new();
        for axis in 0..2 {
            for value in self.ticks(axis) {
                let ends = match axis {
                    0 => [[value, y0], [value, y1]],
                    _ => [[x0, value], [x1, value]],
                };
                let [Some(from), Some(to)] = ends.map(|end| self.place(end)) else { continue };
                segments.push([from, to]);
                let [x, y] = from;
                let label = number::brief(value);
                match axis {
                    0 => canvas.text([x, y + 18.0], 12.0, Anchor::Middle, label),
                    _ => canvas.text([x - 6.0, y + 4.0], 12.0, Anchor::End, label),
                }
            }
        }
        canvas.marks.push(Mark::Lines { segments, width: 0.6, colour: LIGHT });
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]];
        let points = corners.iter().filter_map(|corner| self.place(*corner)).collect();
        canvas.marks.push(Mark::Path { points, width: 1.0, colour: Colour::BLACK });
        let middle = (LEFT + 0.5 * (SIZE[0] - LEFT - RIGHT)) as f32;
        let below = SIZE[1] as f32 - 14.0;
        canvas.text([middle, below], 14.0, Anchor::Middle, names[0]);
        canvas.text([12.0, TOP as f32 - 12.0], 14.0, Anchor::Start, names[1]);
    }
}

/// Dots of a curve; a second round of colours has rings.
fn dots(canvas: &mut Canvas, centres: Vec<[f32; 2]>, number: usize) {
    canvas.marks.push(Mark::Dots {
        centres: centres.clone(),
        radius: 4.5,
        colour: Colour::of(number),
    });
    if number >= 7 {
        canvas.marks.push(Mark::Dots { centres, radius: 2.2, colour: Colour(255, 255, 255) });
    }
}

fn draw(study: &Study, title: &str) -> Canvas {
    let mut canvas = Canvas::new(SIZE[0] as u32, SIZE[1] as u32);
    let point = |index: &usize| match &study.cases[*index].state {
        super::State::Done(measured) => Some([study.seconds(measured), measured.error]),
        _ => None,
    };
    let curves = study.curves();
    let all: Vec<[f64; 2]> = curves.iter().flatten().filter_map(point).collect();
    let of = |axis: usize| all.iter().map(move |point| point[axis]);
    let axes = Axes { limits: [limits(of(0)), limits(of(1))] };
    let seconds = match study.cost {
        Cost::Cpu => "seconds of CPU time",
        Cost::Wall => "seconds by the clock",
    };
    let error = if study.relative { "relative error" } else { "error" };
    axes.frame(&mut canvas, [seconds, error]);
    canvas.text([LEFT as f32 + 120.0, TOP as f32 - 12.0], 14.0, Anchor::Start, title);
    front(&mut canvas, study, &axes);
    for (number, curve) in curves.iter().enumerate() {
        let points: Vec<[f32; 2]> =
            curve.iter().filter_map(point).filter_map(|p| axes.place(p)).collect();
        let colour = Colour::of(number);
        canvas.marks.push(Mark::Path { points: points.clone(), width: 1.6, colour });
        dots(&mut canvas, points, number);
    }
    legend(&mut canvas, study, &curves);
    canvas
}

/// The settings of each curve, below the names of what varies.
fn legend(canvas: &mut Canvas, study: &Study, curves: &[Vec<usize>]) {
    let x = (SIZE[0] - RIGHT + 18.0) as f32;
    let mut y = TOP as f32 + 12.0;
    let names = study.varied().collect::<Vec<_>>().join(" ");
    canvas.text([x + 32.0, y], 12.0, Anchor::Start, names);
    for (number, curve) in curves.iter().enumerate() {
        y += 18.0;
        let first = curve.first().map(|index| study.setting(&study.cases[*index]));
        let name = first.filter(|name| !name.is_empty()).unwrap_or_else(|| "all".to_string());
        let (segments, colour) = (vec![[[x, y - 4.0], [x + 24.0, y - 4.0]]], Colour::of(number));
        canvas.marks.push(Mark::Lines { segments, width: 1.6, colour });
        dots(canvas, vec![[x + 12.0, y - 4.0]], number);
        canvas.text([x + 32.0, y], 12.0, Anchor::Start, name);
    }
    y += 18.0;
    let segments = vec![[[x, y - 4.0], [x + 24.0, y - 4.0]]];
    canvas.marks.push(Mark::Lines { segments, width: 7.0, colour: LIGHT });
    canvas.text([x + 32.0, y], 12.0, Anchor::Start, "Pareto front");
}

/// A broad grey line below the curves through what nothing beats.
fn front(canvas: &mut Canvas, study: &Study, axes: &Axes) {
    let best = study.done().filter(|(_, measured)| measured.pareto);
    let mut points: Vec<[f64; 2]> =
        best.map(|(_, measured)| [study.seconds(measured), measured.error]).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let points: Vec<[f32; 2]> = points.into_iter().filter_map(|p| axes.place(p)).collect();
    canvas.marks.push(Mark::Path { points: points.clone(), width: 7.0, colour: LIGHT });
    canvas.marks.push(Mark::Dots { centres: points, radius: 9.0, colour: LIGHT });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_logarithmic_with_round_ticks() {
        let axes =
            Axes { limits: [limits([0.01, 10.0].into_iter()), limits([2.0, 3.0].into_iter())] };
        assert_eq!(axes.ticks(0), [0.01, 0.1, 1.0, 10.0]);
        assert_eq!(axes.ticks(1), [2.0]);
        let [low, middle, high] =
            [0.01, 0.316_227_766, 10.0].map(|x| axes.place([x, 2.5]).unwrap());
        assert!((low[0] + high[0] - 2.0 * middle[0]).abs() < 0.01);
        assert_eq!(axes.place([0.0, 1.0]), None);
        assert_eq!(limits(std::iter::empty()), [-1.0, 1.0]);
    }
}
