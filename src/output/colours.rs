//! Colours of numbers.

use super::canvas::{Anchor, Canvas, Colour, Mark, round_step};
use super::number;
use super::raster::Raster;

/// A row of colours from the lowest to the highest number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// The word in the script.
    pub name: &'static str,
    stops: &'static [Colour],
}

/// All maps; the first one is the default. Both rise evenly in lightness, or fall from a light
/// middle, also for colour-blind readers.
///
/// # Source  viridis: van der Walt and Smith 2015 (CC0), every tenth; cool-warm: Moreland 2009, five colours
pub const MAPS: [Map; 2] = [
    Map {
        name: "viridis",
        stops: &[
            Colour(68, 1, 84),
            Colour(72, 40, 120),
            Colour(62, 74, 137),
            Colour(49, 104, 142),
            Colour(38, 130, 142),
            Colour(31, 158, 137),
            Colour(53, 183, 121),
            Colour(109, 205, 89),
            Colour(180, 222, 44),
            Colour(253, 231, 37),
        ],
    },
    Map {
        name: "cool-warm",
        stops: &[
            Colour(59, 76, 192),
            Colour(141, 176, 254),
            Colour(221, 221, 221),
            Colour(244, 152, 122),
            Colour(180, 4, 38),
        ],
    },
];

/// The colour of what is not a number.
pub const UNKNOWN: Colour = Colour(120, 120, 120);

impl Map {
    /// The colour of a part of the range, 0 to 1; what is beyond has the colour of the end.
    pub fn of(&self, part: f64) -> Colour {
        if part.is_nan() {
            return UNKNOWN;
        }
        let last = self.stops.len() - 1;
        let place = part.clamp(0.0, 1.0) * last as f64;
        let low = (place as usize).min(last - 1);
        let (Colour(r, g, b), Colour(s, h, c)) = (self.stops[low], self.stops[low + 1]);
        let rest = place - low as f64;
        let between = |a: u8, b: u8| {
            let (a, b) = (f64::from(a), f64::from(b));
            (a + rest * (b - a) + 0.5) as u8
        };
        Colour(between(r, s), between(g, h), between(b, c))
    }

    /// A bar of the colours of a range with numbers, right of `x`, between two heights.
    pub fn bar(
        &self,
        canvas: &mut Canvas,
        name: &str,
        range: [f64; 2],
        x: f64,
        [top, bottom]: [f64; 2],
    ) {
        const WIDTH: f64 = 18.0;
        let height = (bottom - top).max(2.0).round() as usize;
        let colour = |row: usize| {
            let Colour(r, g, b) = self.of(1.0 - (row as f64 + 0.5) / height as f64);
            [[r, g, b]; WIDTH as usize]
        };
        let pixels = (0..height).flat_map(colour).collect();
        let raster = Raster { width: WIDTH as usize, height, pixels };
        let place = [x as f32, top as f32];
        canvas.marks.push(Mark::Image { place, raster });
        let [low, high] = range;
        let y = |value: f64| (bottom - (bottom - top) * (value - low) / (high - low)) as f32;
        let (left, right) = (x as f32, (x + WIDTH) as f32);
        let corners =
            [[left, y(low)], [right, y(low)], [right, y(high)], [left, y(high)], [left, y(low)]];
        canvas.marks.push(Mark::Path {
            points: corners.to_vec(),
            width: 0.8,
            colour: Colour::BLACK,
        });
        let step = round_step(high - low, 6.0);
        let mut segments = Vec::new();
        for tick in (low / step - 1e-9).ceil() as i64..=(high / step + 1e-9).floor() as i64 {
            let value = tick as f64 * step;
            segments.push([[right, y(value)], [right + 4.0, y(value)]]);
            canvas.text([right + 7.0, y(value) + 4.0], 12.0, Anchor::Start, number::short(value));
        }
        canvas.marks.push(Mark::Lines { segments, width: 0.8, colour: Colour::BLACK });
        canvas.text([left, top as f32 - 10.0], 14.0, Anchor::Start, name);
    }
}

/// Smallest and largest number; infinite without numbers.
pub fn limits(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values.filter(|value| value.is_finite()) {
        low = low.min(value);
        high = high.max(value);
    }
    [low, high]
}

/// The range between limits; a little room if there is none between them.
pub fn range([low, high]: [f64; 2]) -> [f64; 2] {
    match (low <= high, high > low) {
        (false, _) => [0.0, 1.0],
        (true, true) => [low, high],
        (true, false) => {
            let room = if low == 0.0 { 1.0 } else { 0.01 * low.abs() };
            [low - room, low + room]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_meet_at_the_stops_and_end_there() {
        let [viridis, _] = MAPS;
        assert_eq!(viridis.of(0.0), Colour(68, 1, 84));
        assert_eq!(viridis.of(1.0), Colour(253, 231, 37));
        assert_eq!(viridis.of(7.0), viridis.of(1.0));
        assert_eq!(viridis.of(-1.0), viridis.of(0.0));
        assert_eq!(viridis.of(f64::NAN), UNKNOWN);
        assert_eq!(MAPS[1].of(0.5), Colour(221, 221, 221));
        assert_eq!(MAPS[1].of(0.125), Colour(100, 126, 223));
    }

    #[test]
    fn a_range_is_never_empty() {
        let range = |values: &[f64]| range(limits(values.iter().copied()));
        assert_eq!(range(&[3.0, f64::NAN, -1.0, f64::INFINITY]), [-1.0, 3.0]);
        assert_eq!(range(&[]), [0.0, 1.0]);
        assert_eq!(range(&[0.0]), [-1.0, 1.0]);
        let [low, high] = range(&[200.0]);
        assert!(low < 200.0 && 200.0 < high);
    }
}
