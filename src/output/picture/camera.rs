//! Where a scene in space is seen from.

use crate::output::canvas::{Anchor, Canvas, Colour, Mark};

/// A direction to look from, far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// From the scene to the eye, before turning the axis upwards.
    eye: [f64; 3],
    right: [f64; 3],
    above: [f64; 3],
    /// Number of the axis that points upwards.
    pub up: usize,
}

impl Camera {
    /// Degrees about z from x towards y, and above the horizon.
    pub fn new(azimuth: f64, elevation: f64) -> Self {
        let (sin_a, cos_a) = sin_cos(azimuth);
        let (sin_e, cos_e) = sin_cos(elevation);
        Self {
            eye: [cos_e * cos_a, cos_e * sin_a, sin_e],
            right: [-sin_a, cos_a, 0.0],
            above: [-sin_e * cos_a, -sin_e * sin_a, cos_e],
            up: 2,
        }
    }

    /// To the right, upwards, towards the eye.
    pub fn seen(&self, place: [f64; 3]) -> [f64; 3] {
        let turned: [f64; 3] = std::array::from_fn(|axis| place[(axis + self.up + 1) % 3]);
        let along = |a: [f64; 3]| a[0] * turned[0] + a[1] * turned[1] + a[2] * turned[2];
        [along(self.right), along(self.above), along(self.eye)]
    }

    /// Draws the three axes about a place.
    pub fn axes(&self, canvas: &mut Canvas, [x, y]: [f32; 2]) {
        const LENGTH: f64 = 28.0;
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let mut unit = [0.0; 3];
            unit[axis] = LENGTH;
            let [right, up, _] = self.seen(unit);
            let end = |part: f32| [x + part * right as f32, y - part * up as f32];
            let segments = vec![[[x, y], end(1.0)]];
            canvas.marks.push(Mark::Lines { segments, width: 1.5, colour: Colour::BLACK });
            if right.hypot(up) > 0.2 * LENGTH {
                let [x, y] = end(1.35);
                canvas.text([x, y + 4.0], 12.0, Anchor::Middle, name);
            }
        }
    }
}

/// Sine and cosine of degrees, exact at right angles.
fn sin_cos(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_views_show_the_usual_axes() {
        let place = [1.0, 2.0, 3.0];
        assert_eq!(Camera::new(-90.0, 0.0).seen(place), [1.0, 3.0, -2.0]);
        assert_eq!(Camera::new(-90.0, 90.0).seen(place), [1.0, 2.0, 3.0]);
        assert_eq!(Camera::new(0.0, 0.0).seen(place), [2.0, 3.0, 1.0]);
        let upwards = Camera { up: 1, ..Camera::new(0.0, 0.0) };
        assert_eq!(upwards.seen(place), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn lengths_are_kept() {
        for (azimuth, elevation) in [(-60.0, 20.0), (10.0, -80.0), (200.0, 45.0)] {
            let seen = Camera::new(azimuth, elevation).seen([1.0, -2.0, 3.0]);
            let length: f64 = seen.iter().map(|x| x * x).sum();
            assert!((length - 14.0).abs() < 1e-14, "{length}");
        }
    }
}
