//! PDF, text in Helvetica.

use super::{Anchor, Canvas, Colour, Mark, text_width};
use flate2::{Compression, write::ZlibEncoder};
use pdf_writer::types::LineCapStyle;
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, Str};
use std::io::Write;

const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const FONT: Ref = Ref::new(5);
const FONT_NAME: Name<'static> = Name(b"F1");

/// The drawing as one page of its size.
pub fn encode(canvas: &Canvas) -> Vec<u8> {
    let mut content = Content::new();
    content.set_line_cap(LineCapStyle::RoundCap);
    for mark in &canvas.marks {
        add(&mut content, mark, canvas.height as f32);
    }
    let stream = compressed(&content.finish());
    let mut pdf = Pdf::new();
    pdf.catalog(CATALOG).pages(PAGES);
    pdf.pages(PAGES).kids([PAGE]).count(1);
    let mut page = pdf.page(PAGE);
    page.media_box(Rect::new(0.0, 0.0, canvas.width as f32, canvas.height as f32));
    page.parent(PAGES).contents(CONTENT);
    page.resources().fonts().pair(FONT_NAME, FONT);
    page.finish();
    pdf.type1_font(FONT).base_font(Name(b"Helvetica"));
    pdf.stream(CONTENT, &stream).filter(pdf_writer::Filter::FlateDecode);
    let mut bytes = pdf.finish();
    bytes.truncate(bytes.trim_ascii_end().len());
    bytes
}

/// The content in zlib's format; writing to memory does not fail.
fn compressed(content: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    let written = encoder.write_all(content).and_then(|()| encoder.finish());
    written.unwrap_or_default()
}

fn rgb(Colour(r, g, b): Colour) -> [f32; 3] {
    [r, g, b].map(|part| f32::from(part) / 255.0)
}

/// PDF counts upwards.
fn add(content: &mut Content, mark: &Mark, height: f32) {
    match mark {
        Mark::Lines { segments, width, colour } => {
            let [r, g, b] = rgb(*colour);
            content.set_stroke_rgb(r, g, b).set_line_width(*width);
            for [[x1, y1], [x2, y2]] in segments {
                content.move_to(*x1, height - y1).line_to(*x2, height - y2);
            }
            content.stroke();
        }
        Mark::Path { points, width, colour } => {
            let [r, g, b] = rgb(*colour);
            content.set_stroke_rgb(r, g, b).set_line_width(*width);
            for (index, [x, y]) in points.iter().enumerate() {
                match index {
                    0 => content.move_to(*x, height - y),
                    _ => content.line_to(*x, height - y),
                };
            }
            content.stroke();
        }
        Mark::Dots { centres, radius, colour } => {
            // A line of no length with round ends is a disk.
            let [r, g, b] = rgb(*colour);
            content.set_stroke_rgb(r, g, b).set_line_width(2.0 * radius);
            for [x, y] in centres {
                content.move_to(*x, height - y).line_to(*x, height - y);
            }
            content.stroke();
        }
        Mark::Text { place: [x, y], size, anchor, text } => {
            let shift = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => -0.5 * size * text_width(text),
                Anchor::End => -size * text_width(text),
            };
            let latin: Vec<u8> =
                text.chars().map(|c| u8::try_from(c as u32).unwrap_or(b'?')).collect();
            content.begin_text().set_font(FONT_NAME, *size).set_fill_rgb(0.0, 0.0, 0.0);
            content.next_line(x + shift, height - y).show(Str(&latin)).end_text();
        }
    }
}
