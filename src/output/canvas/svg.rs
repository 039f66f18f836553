//! SVG by hand.

use super::{Anchor, Canvas, Colour, Mark, png};
use crate::output::SOFTWARE;
use std::fmt::Write;

fn colour(Colour(r, g, b): Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The drawing as SVG text.
pub fn encode(canvas: &Canvas) -> Vec<u8> {
    let (w, h) = (canvas.width, canvas.height);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" \
         xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"{w}\" height=\"{h}\" \
         viewBox=\"0 0 {w} {h}\">\n<desc>{SOFTWARE}</desc>\n<rect width=\"{w}\" height=\"{h}\" fill=\"white\"/>\n"
    );
    for mark in &canvas.marks {
        // Writing to a string does not fail.
        let _ = add(&mut svg, mark);
    }
    svg.push_str("</svg>\n");
    svg.into_bytes()
}

fn add(svg: &mut String, mark: &Mark) -> std::fmt::Result {
    match mark {
        Mark::Lines { segments, width, colour: paint } => {
            write!(svg, "<path stroke=\"{}\" stroke-width=\"{width}\" d=\"", colour(*paint))?;
            for [[x1, y1], [x2, y2]] in segments {
                write!(svg, "M{x1:.2} {y1:.2}L{x2:.2} {y2:.2}")?;
            }
            svg.push_str("\"/>\n");
        }
        Mark::Path { points, width, colour: paint } => {
            let paint = colour(*paint);
            write!(
                svg,
                "<polyline fill=\"none\" stroke=\"{paint}\" stroke-width=\"{width}\" points=\""
            )?;
            for [x, y] in points {
                write!(svg, "{x:.2},{y:.2} ")?;
            }
            svg.push_str("\"/>\n");
        }
        Mark::Dots { centres, radius, colour: paint } => {
            writeln!(svg, "<g fill=\"{}\">", colour(*paint))?;
            for [x, y] in centres {
                writeln!(svg, "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\"/>")?;
            }
            svg.push_str("</g>\n");
        }
        Mark::Image { place: [x, y], raster } => {
            let (width, height) = (raster.width, raster.height);
            let pixels = base64(&png::encode_raster(raster));
            writeln!(
                svg,
                "<image x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width}\" height=\"{height}\" \
                 xlink:href=\"data:image/png;base64,{pixels}\"/>"
            )?;
        }
        Mark::Text { place: [x, y], size, anchor, text } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let text = text.replace('&', "&amp;").replace('<', "&lt;");
            writeln!(
                svg,
                "<text x=\"{x:.2}\" y=\"{y:.2}\" font-family=\"sans-serif\" font-size=\"{size}\" \
                 text-anchor=\"{anchor}\">{text}</text>"
            )?;
        }
    }
    Ok(())
}

/// Bytes as text, RFC 4648.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |place: usize| u32::from(three.get(place).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place) & 63) as usize];
            text.push(if place <= three.len() { char::from(letter) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::base64;

    #[test]
    fn base64_of_the_standard() {
        for (bytes, text) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }
}
