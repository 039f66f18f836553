//! Balls and lines drawn into pixels with depth.
//!
//! Balls are seen along parallel rays: each pixel shows the ball nearest to the eye, the first one
//! of those equally near, so that the picture depends on the order of the balls alone.

use super::canvas::Colour;

/// Pixels per pixel of the picture and axis, averaged in the end.
const FINE: usize = 2;

/// A ball, or a line of dots; in pixels, y downwards, depth towards the eye.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// x, y, depth of the centre.
    pub centre: [f64; 3],
    /// Its radius.
    pub radius: f64,
    /// Its colour.
    pub colour: Colour,
}

/// A picture in pixels, row by row from above.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Their colours.
    pub pixels: Vec<[u8; 3]>,
}

/// What is nothing, and what is a line.
const NOTHING: u32 = u32::MAX;
const LINE: u32 = u32::MAX - 1;

/// A picture being drawn.
pub struct Drawing {
    width: usize,
    height: usize,
    depth: Vec<f32>,
    what: Vec<u32>,
}

impl Drawing {
    /// An empty picture of so many pixels.
    pub fn new(width: usize, height: usize) -> Self {
        let (width, height) = (FINE * width, FINE * height);
        let count = width * height;
        Self { width, height, depth: vec![f32::NEG_INFINITY; count], what: vec![NOTHING; count] }
    }

    /// Draws all balls.
    pub fn balls(&mut self, balls: &[Ball]) {
        for (index, ball) in balls.iter().enumerate() {
            let [x, y, z] = ball.centre.map(|place| place * FINE as f64);
            let radius = (ball.radius * FINE as f64).max(0.71);
            let range = |centre: f64, limit: usize| {
                let low = (centre - radius - 0.5).ceil().max(0.0) as usize;
                let high = (centre + radius - 0.5).floor() + 1.0;
                low..(high.max(0.0) as usize).min(limit)
            };
            if !(x.is_finite() && y.is_finite() && z.is_finite() && radius.is_finite()) {
                continue;
            }
            for row in range(y, self.height) {
                let dy = row as f64 + 0.5 - y;
                for column in range(x, self.width) {
                    let dx = column as f64 + 0.5 - x;
                    let rest = radius * radius - dx * dx - dy * dy;
                    if rest >= 0.0 {
                        let depth = (z + rest.sqrt()) as f32;
                        self.put(row * self.width + column, depth, index as u32);
                    }
                }
            }
        }
    }

    /// Draws a line between two places, hidden by what is in front of it.
    pub fn line(&mut self, from: [f64; 3], to: [f64; 3]) {
        let [a, b] = [from, to].map(|place| place.map(|x| x * FINE as f64));
        let length = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        if !length.is_finite() || length > 1e6 {
            return;
        }
        let steps = length.ceil().max(1.0);
        for step in 0..=steps as usize {
            let part = step as f64 / steps;
            let [x, y, z]: [f64; 3] = std::array::from_fn(|i| a[i] + part * (b[i] - a[i]));
            let (column, row) = (x.floor(), y.floor());
            let inside = column >= 0.0 && row >= 0.0;
            let (column, row) = (column as usize, row as usize);
            if inside && column < self.width && row < self.height {
                self.put(row * self.width + column, z as f32, LINE);
            }
        }
    }

    fn put(&mut self, pixel: usize, depth: f32, what: u32) {
        if depth > self.depth[pixel] {
            self.depth[pixel] = depth;
            self.what[pixel] = what;
        }
    }

    /// Pixel, depth and number of the ball of all pixels that show one.
    pub fn drawn(&self) -> impl Iterator<Item = (usize, f32, usize)> {
        let pixels = self.depth.iter().zip(&self.what).enumerate();
        let balls = pixels.filter(|(_, (_, what))| **what < LINE);
        balls.map(|(pixel, (depth, what))| (pixel, *depth, *what as usize))
    }

    /// Puts a pixel of another drawing in its place; of balls equally near the first one is seen.
    pub fn join(&mut self, pixel: usize, depth: f32, ball: u32) {
        if depth == self.depth[pixel] {
            self.what[pixel] = self.what[pixel].min(ball);
        }
        self.put(pixel, depth, ball);
    }

    /// The pixels; balls in space are lit from the upper left, and darker where something near them
    /// stands out.
    pub fn finish(&self, balls: &[Ball], lit: bool) -> Raster {
        let [width, height] = [self.width, self.height].map(|count| count / FINE);
        let mut pixels = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let mut sum = [0.0; 3];
                for (i, j) in (0..FINE * FINE).map(|k| (k / FINE, k % FINE)) {
                    let colour = self.colour(FINE * row + i, FINE * column + j, balls, lit);
                    sum.iter_mut().zip(colour).for_each(|(sum, part)| *sum += part);
                }
                pixels.push(sum.map(|part| (part / (FINE * FINE) as f64 + 0.5) as u8));
            }
        }
        Raster { width, height, pixels }
    }

    fn colour(&self, row: usize, column: usize, balls: &[Ball], lit: bool) -> [f64; 3] {
        const PAPER: [f64; 3] = [255.0; 3];
        const INK: [f64; 3] = [120.0; 3];
        let pixel = row * self.width + column;
        let Some(ball) = balls.get(self.what[pixel] as usize) else {
            return if self.what[pixel] == LINE { INK } else { PAPER };
        };
        let Colour(r, g, b) = ball.colour;
        let shade = if lit { self.light(row, column, ball) } else { 1.0 };
        [r, g, b].map(|part| (f64::from(part) * shade).min(255.0))
    }

    /// Light on a ball at a pixel.
    fn light(&self, row: usize, column: usize, ball: &Ball) -> f64 {
        /// Direction of the lamp: to the left, above, towards the eye.
        const LAMP: [f64; 3] = [-0.42, -0.5, 0.757];
        let radius = (ball.radius * FINE as f64).max(0.71);
        let x = (column as f64 + 0.5 - ball.centre[0] * FINE as f64) / radius;
        let y = (row as f64 + 0.5 - ball.centre[1] * FINE as f64) / radius;
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let diffuse = (LAMP[0] * x + LAMP[1] * y + LAMP[2] * z).max(0.0);
        (0.45 + 0.6 * diffuse) * (-0.35 * self.hidden(row, column, radius)).exp()
    }

    /// How much the surroundings of a pixel stand out, in radii of balls: the mean over eight
    /// directions and two distances, at most 2 for each.
    ///
    /// # Source  Boucheny 2009, eye-dome lighting
    fn hidden(&self, row: usize, column: usize, radius: f64) -> f64 {
        let here = self.depth[row * self.width + column];
        let mut sum = 0.0;
        for reach in [3, 9] {
            for (down, right) in
                [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)]
            {
                let (r, c) = (row as isize + down * reach, column as isize + right * reach);
                if r < 0 || c < 0 || r >= self.height as isize || c >= self.width as isize {
                    continue;
                }
                let other = r as usize * self.width + c as usize;
                if self.what[other] < LINE {
                    let rise = f64::from(self.depth[other] - here) / radius;
                    sum += (rise - 0.25).clamp(0.0, 4.0);
                }
            }
        }
        sum / 8.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Colour = Colour(255, 0, 0);
    const BLUE: Colour = Colour(0, 0, 255);

    fn ball(x: f64, depth: f64, colour: Colour) -> Ball {
        Ball { centre: [x, 10.0, depth], radius: 5.0, colour }
    }

    #[test]
    fn the_nearest_ball_is_seen_whatever_the_order() {
        for balls in [
            [ball(10.0, 0.0, RED), ball(12.0, 3.0, BLUE)],
            [ball(12.0, 3.0, BLUE), ball(10.0, 0.0, RED)],
        ] {
            let mut drawing = Drawing::new(20, 20);
            drawing.balls(&balls);
            let raster = drawing.finish(&balls, false);
            assert_eq!(raster.pixels[10 * 20 + 11], [0, 0, 255]);
            assert_eq!(raster.pixels[10 * 20 + 6], [255, 0, 0]);
            assert_eq!(raster.pixels[0], [255; 3]);
        }
    }

    #[test]
    fn a_line_is_hidden_by_a_ball_in_front_of_it() {
        for (depth, hidden) in [(-20.0, true), (20.0, false)] {
            let balls = [ball(10.0, 0.0, RED)];
            let mut drawing = Drawing::new(20, 20);
            drawing.balls(&balls);
            drawing.line([0.0, 10.0, depth], [19.0, 10.0, depth]);
            let raster = drawing.finish(&balls, false);
            assert_eq!(raster.pixels[10 * 20 + 10] == [255, 0, 0], hidden);
        }
    }

    #[test]
    fn what_is_not_a_place_or_outside_is_left_out() {
        let balls = [ball(f64::NAN, 0.0, RED), ball(-100.0, 0.0, RED), ball(1e300, 0.0, RED)];
        let mut drawing = Drawing::new(8, 8);
        drawing.balls(&balls);
        drawing.line([f64::INFINITY, 0.0, 0.0], [1.0, 1.0, 0.0]);
        assert!(drawing.finish(&balls, true).pixels.iter().all(|pixel| *pixel == [255; 3]));
    }

    #[test]
    fn a_ball_is_brightest_towards_the_lamp() {
        let balls = [ball(10.0, 0.0, Colour(200, 200, 200))];
        let mut drawing = Drawing::new(20, 20);
        drawing.balls(&balls);
        let raster = drawing.finish(&balls, true);
        let at = |x: usize, y: usize| raster.pixels[y * 20 + x][0];
        assert!(at(8, 7) > at(10, 10) && at(10, 10) > at(13, 12) && at(13, 12) > 0);
    }
}
