//! Drawings: a list of marks, written as PNG, PDF or SVG.
//!
//! Places are in pixels from the upper left corner.

mod font;
mod pdf;
mod png;
mod svg;

use super::raster::Raster;
use std::path::Path;

/// Red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    /// Black.
    pub const BLACK: Colour = Colour(0, 0, 0);
    /// A light grey, for grids.
    pub const GREY: Colour = Colour(190, 190, 190);

    /// The colour of the n-th curve or solid (Okabe and Ito's palette, safe for colour-blind
    /// readers), starting again after the last one.
    pub fn of(number: usize) -> Colour {
        const PALETTE: [Colour; 7] = [
            Colour(0, 114, 178),
            Colour(213, 94, 0),
            Colour(0, 158, 115),
            Colour(204, 121, 167),
            Colour(86, 180, 233),
            Colour(230, 159, 0),
            Colour(90, 90, 90),
        ];
        PALETTE[number % PALETTE.len()]
    }
}

/// Where a text stands about its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins there.
    Start,
    /// The text is centred there.
    Middle,
    /// The text ends there.
    End,
}

/// Something drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// Line segments of one colour and width.
    Lines { segments: Vec<[[f32; 2]; 2]>, width: f32, colour: Colour },
    /// A polyline.
    Path { points: Vec<[f32; 2]>, width: f32, colour: Colour },
    /// Filled disks of one colour.
    Dots { centres: Vec<[f32; 2]>, radius: f32, colour: Colour },
    /// Pixels; the place is that of the upper left corner.
    Image { place: [f32; 2], raster: Raster },
    /// A text; the place is on its baseline.
    Text { place: [f32; 2], size: f32, anchor: Anchor, text: String },
}

/// A drawing of some size.
#[derive(Clone, Debug)]
pub struct Canvas {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// What is on it, from the back to the front.
    pub marks: Vec<Mark>,
}

impl Canvas {
    /// A white drawing.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, marks: Vec::new() }
    }

    /// Adds a text.
    pub fn text(&mut self, place: [f32; 2], size: f32, anchor: Anchor, text: impl Into<String>) {
        self.marks.push(Mark::Text { place, size, anchor, text: text.into() });
    }

    /// The file in the format of its suffix: `.png`, `.svg`, everything else PDF.
    pub fn encode(&self, path: &Path) -> Vec<u8> {
        match path.extension().and_then(|suffix| suffix.to_str()) {
            Some("png") => png::encode(self),
            Some("svg") => svg::encode(self),
            _ => pdf::encode(self),
        }
    }
}

/// Width of a text in units of its size, about that of Helvetica.
fn text_width(text: &str) -> f32 {
    0.55 * text.chars().count() as f32
}

/// Step of round numbers (1, 2, 5 x 10^n) that divides a range into about `count` parts.
pub fn round_step(range: f64, count: f64) -> f64 {
    let raw = range / count;
    let power = 10f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * power >= raw);
    factor.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing() -> Canvas {
        let mut canvas = Canvas::new(60, 40);
        let centres = vec![[30.0, 20.0]];
        canvas.marks.push(Mark::Dots { centres, radius: 5.0, colour: Colour(255, 0, 0) });
        let segments = vec![[[0.0, 39.0], [59.0, 39.0]]];
        canvas.marks.push(Mark::Lines { segments, width: 2.0, colour: Colour::BLACK });
        canvas.text([30.0, 10.0], 8.0, Anchor::Middle, "a<b");
        let raster = Raster { width: 2, height: 1, pixels: vec![[0, 9, 200], [7; 3]] };
        canvas.marks.push(Mark::Image { place: [50.0, 30.0], raster });
        canvas
    }

    #[test]
    fn a_png_has_the_pixels_drawn() {
        let bytes = drawing().encode(Path::new("a.png"));
        let map = tiny_skia::Pixmap::decode_png(&bytes).unwrap();
        assert_eq!((map.width(), map.height()), (60, 40));
        let told = b"tEXtSoftware\0karamelo-rs";
        assert!(bytes.windows(told.len()).any(|part| part == told));
        let pixel = map.pixel(30, 20).unwrap();
        assert_eq!((pixel.red(), pixel.green(), pixel.blue()), (255, 0, 0));
        assert_eq!(map.pixel(2, 2).unwrap().red(), 255);
        assert_eq!(map.pixel(30, 39).unwrap().red(), 0);
        let pixel = map.pixel(50, 30).unwrap();
        assert_eq!((pixel.red(), pixel.green(), pixel.blue()), (0, 9, 200));
    }

    #[test]
    fn svg_escapes_text_and_pdf_is_framed() {
        let svg = String::from_utf8(drawing().encode(Path::new("a.svg"))).unwrap();
        assert!(svg.contains("a&lt;b") && svg.contains("<circle"));
        assert!(
            svg.contains("width=\"2\" height=\"1\" xlink:href=\"data:image/png;base64,iVBORw0KGgo")
        );
        let pdf = drawing().encode(Path::new("a.pdf"));
        assert!(pdf.starts_with(b"%PDF-") && pdf.ends_with(b"%%EOF"));
    }

    #[test]
    fn steps_are_round() {
        for (range, step) in [(1.0, 0.2), (3.5, 1.0), (0.07, 0.02), (1234.0, 500.0)] {
            assert!((round_step(range, 5.0) / step - 1.0).abs() < 1e-12, "{range}");
        }
    }
}
