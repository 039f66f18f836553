//! PDF, text in Helvetica.

use super::{Anchor, Canvas, Colour, Mark, Raster, text_width};
use crate::output::SOFTWARE;
use flate2::{Compression, write::ZlibEncoder};
use pdf_writer::types::LineCapStyle;
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::io::Write;

const CATALOG: Ref = Ref::new(1);
const PAGES: Ref = Ref::new(2);
const PAGE: Ref = Ref::new(3);
const CONTENT: Ref = Ref::new(4);
const FONT: Ref = Ref::new(5);
const INFO: Ref = Ref::new(6);
const FONT_NAME: Name<'static> = Name(b"F1");

/// The drawing as one page of its size.
pub fn encode(canvas: &Canvas) -> Vec<u8> {
    let mut content = Content::new();
    content.set_line_cap(LineCapStyle::RoundCap);
    let mut images = Vec::new();
    for mark in &canvas.marks {
        add(&mut content, mark, canvas.height as f32, &mut images);
    }
    let stream = compressed(&content.finish());
    let mut pdf = Pdf::new();
    pdf.catalog(CATALOG).pages(PAGES);
    pdf.pages(PAGES).kids([PAGE]).count(1);
    let mut page = pdf.page(PAGE);
    page.media_box(Rect::new(0.0, 0.0, canvas.width as f32, canvas.height as f32));
    page.parent(PAGES).contents(CONTENT);
    let mut resources = page.resources();
    resources.fonts().pair(FONT_NAME, FONT);
    let names = (0..images.len()).map(image_name);
    let mut objects = resources.x_objects();
    for (number, name) in names.enumerate() {
        objects.pair(Name(name.as_bytes()), image_ref(number));
    }
    objects.finish();
    resources.finish();
    page.finish();
    for (number, raster) in images.iter().enumerate() {
        let bytes = compressed(raster.pixels.as_flattened());
        let mut image = pdf.image_xobject(image_ref(number), &bytes);
        image.filter(pdf_writer::Filter::FlateDecode);
        image.width(raster.width as i32).height(raster.height as i32);
        image.color_space().device_rgb();
        image.bits_per_component(8);
    }
    pdf.document_info(INFO).producer(TextStr(SOFTWARE));
    pdf.type1_font(FONT).base_font(Name(b"Helvetica"));
    pdf.stream(CONTENT, &stream).filter(pdf_writer::Filter::FlateDecode);
    let mut bytes = pdf.finish();
    bytes.truncate(bytes.trim_ascii_end().len());
    bytes
}

/// Name and object of an image.
fn image_name(number: usize) -> String {
    format!("I{number}")
}

fn image_ref(number: usize) -> Ref {
    Ref::new(7 + number as i32)
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
fn add<'a>(content: &mut Content, mark: &'a Mark, height: f32, images: &mut Vec<&'a Raster>) {
    match mark {
        Mark::Image { place: [x, y], raster } => {
            let size = [raster.width as f32, raster.height as f32];
            content.save_state();
            content.transform([size[0], 0.0, 0.0, size[1], *x, height - y - size[1]]);
            content.x_object(Name(image_name(images.len()).as_bytes()));
            content.restore_state();
            images.push(raster);
        }
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
