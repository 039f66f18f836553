//! PNG, text in a small bitmap font.

use super::{Anchor, Canvas, Colour, Mark, Raster, font};
use crate::output::SOFTWARE;
use tiny_skia::{FillRule, LineCap, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform};

/// The drawing as PNG; nothing if its size is 0 or too large.
pub fn encode(canvas: &Canvas) -> Vec<u8> {
    let Some(mut map) = Pixmap::new(canvas.width, canvas.height) else {
        return Vec::new();
    };
    map.fill(tiny_skia::Color::WHITE);
    for mark in &canvas.marks {
        add(&mut map, mark);
    }
    let mut bytes = map.encode_png().unwrap_or_default();
    if bytes.len() > HEAD {
        bytes.splice(HEAD..HEAD, text_chunk("Software", SOFTWARE));
    }
    bytes
}

/// Bytes of the signature and of the first chunk, IHDR.
const HEAD: usize = 8 + 25;

/// A chunk tEXt: length, type, keyword, text, CRC-32 of type and data.
fn text_chunk(keyword: &str, text: &str) -> Vec<u8> {
    let data = format!("tEXt{keyword}\0{text}").into_bytes();
    let length = (data.len() - 4) as u32;
    let checksum = crc32fast::hash(&data).to_be_bytes();
    [&length.to_be_bytes()[..], &data, &checksum].concat()
}

/// The pixels of a raster.
fn pixmap(raster: &Raster) -> Option<Pixmap> {
    let mut map = Pixmap::new(raster.width as u32, raster.height as u32)?;
    for (pixel, [r, g, b]) in map.pixels_mut().iter_mut().zip(&raster.pixels) {
        *pixel = tiny_skia::ColorU8::from_rgba(*r, *g, *b, 255).premultiply();
    }
    Some(map)
}

/// A raster as PNG.
pub fn encode_raster(raster: &Raster) -> Vec<u8> {
    pixmap(raster).and_then(|map| map.encode_png().ok()).unwrap_or_default()
}

fn paint(Colour(r, g, b): Colour) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

fn stroke(map: &mut Pixmap, path: Option<Path>, width: f32, colour: Colour) {
    if let Some(path) = path {
        let stroke = Stroke { width, line_cap: LineCap::Round, ..Stroke::default() };
        map.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
    }
}

fn add(map: &mut Pixmap, mark: &Mark) {
    match mark {
        Mark::Lines { segments, width, colour } => {
            let mut path = PathBuilder::new();
            for [[x1, y1], [x2, y2]] in segments {
                path.move_to(*x1, *y1);
                path.line_to(*x2, *y2);
            }
            stroke(map, path.finish(), *width, *colour);
        }
        Mark::Path { points, width, colour } => {
            let mut path = PathBuilder::new();
            for (index, [x, y]) in points.iter().enumerate() {
                if index == 0 { path.move_to(*x, *y) } else { path.line_to(*x, *y) }
            }
            stroke(map, path.finish(), *width, *colour);
        }
        Mark::Dots { centres, radius, colour } => {
            let mut path = PathBuilder::new();
            centres.iter().for_each(|[x, y]| path.push_circle(*x, *y, *radius));
            if let Some(path) = path.finish() {
                let (paint, turn) = (paint(*colour), Transform::identity());
                map.fill_path(&path, &paint, FillRule::Winding, turn, None);
            }
        }
        Mark::Image { place: [x, y], raster } => {
            let (x, y) = (x.round() as i32, y.round() as i32);
            if let Some(image) = pixmap(raster) {
                let paint = tiny_skia::PixmapPaint::default();
                map.draw_pixmap(x, y, image.as_ref(), &paint, Transform::identity(), None);
            }
        }
        Mark::Text { place, size, anchor, text } => write(map, *place, *size, *anchor, text),
    }
}

/// Draws a text, one square for each dot of the font.
fn write(map: &mut Pixmap, [x, y]: [f32; 2], size: f32, anchor: Anchor, text: &str) {
    let dot = (size / 9.0).max(1.0);
    let advance = 6.0 * dot;
    let length = advance * text.chars().count() as f32;
    let start = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - 0.5 * length,
        Anchor::End => x - length,
    };
    let mut path = PathBuilder::new();
    for (index, letter) in text.chars().enumerate() {
        for (column, bits) in font::columns(letter).into_iter().enumerate() {
            for row in (0..7).filter(|row| bits >> row & 1 == 1) {
                let left = start + advance * index as f32 + dot * column as f32;
                let top = y - dot * (7 - row) as f32;
                if let Some(square) = Rect::from_xywh(left, top, dot, dot) {
                    path.push_rect(square);
                }
            }
        }
    }
    if let Some(path) = path.finish() {
        let black = paint(Colour::BLACK);
        map.fill_path(&path, &black, FillRule::Winding, Transform::identity(), None);
    }
}
