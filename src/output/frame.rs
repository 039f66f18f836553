//! Where places of a scene are in a picture, and the axes around it.

use super::canvas::{Anchor, Canvas, Colour, Mark, round_step};
use super::number;
use crate::model::domain::Domain;

/// Room around a picture, for numbers and names \[pixels\].
pub const MARGIN: f64 = 50.0;

/// From places \[L\] to pixels: equal scale on both axes, x to the right, y upwards.
pub struct Frame {
    /// Lower limits of x and y \[L\].
    pub lower: [f64; 2],
    /// Upper limits of x and y \[L\].
    pub upper: [f64; 2],
    /// Pixels per length.
    pub scale: f64,
    origin: [f64; 2],
}

/// Limits of x and y that a picture of a box shows; a line gets two cells of height.
pub fn limits(domain: &Domain) -> [[f64; 2]; 2] {
    let [mut lower, mut upper] = [domain.lower, domain.upper].map(|c| [c[0], c[1]]);
    if domain.dimension == 1 {
        (lower[1], upper[1]) = (-domain.cell, domain.cell);
    }
    [lower, upper]
}

impl Frame {
    /// Limits in the middle of so many pixels, with margins.
    pub fn new([lower, upper]: [[f64; 2]; 2], width: f64, height: f64) -> Self {
        let size = [upper[0] - lower[0], upper[1] - lower[1]];
        let room = [width, height].map(|side| (side - 2.0 * MARGIN).max(8.0));
        let scale = (room[0] / size[0]).min(room[1] / size[1]);
        let middle = [0, 1].map(|a| 0.5 * (lower[a] + upper[a]));
        let origin = [0.5 * width - scale * middle[0], 0.5 * height + scale * middle[1]];
        Self { lower, upper, scale, origin }
    }

    /// The pixel of a place.
    pub fn pixel(&self, x: f64, y: f64) -> [f32; 2] {
        let [x, y] = self.place(x, y);
        [x as f32, y as f32]
    }

    /// The same, exactly.
    pub fn place(&self, x: f64, y: f64) -> [f64; 2] {
        [self.origin[0] + self.scale * x, self.origin[1] - self.scale * y]
    }

    /// The border of the box with ticks at round numbers.
    pub fn axes(&self, canvas: &mut Canvas) {
        let ([x0, y0], [x1, y1]) = (self.lower, self.upper);
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]];
        let points = corners.map(|[x, y]| self.pixel(x, y)).to_vec();
        canvas.marks.push(Mark::Path { points, width: 1.0, colour: Colour::BLACK });
        for axis in 0..2 {
            let (low, high) = (self.lower[axis], self.upper[axis]);
            let step = round_step(high - low, 5.0);
            let first = (low / step).ceil() as i64;
            let last = (high / step + 1e-9).floor() as i64;
            for tick in first..=last {
                let value = tick as f64 * step;
                let label = number::brief(value);
                if axis == 0 {
                    let [x, y] = self.pixel(value, y0);
                    canvas.text([x, y + 16.0], 12.0, Anchor::Middle, label);
                } else {
                    let [x, y] = self.pixel(x0, value);
                    canvas.text([x - 6.0, y + 4.0], 12.0, Anchor::End, label);
                }
            }
        }
    }
}
