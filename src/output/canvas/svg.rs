//! SVG by hand.

use super::{Anchor, Canvas, Colour, Mark};
use std::fmt::Write;

fn colour(Colour(r, g, b): Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The drawing as SVG text.
pub fn encode(canvas: &Canvas) -> Vec<u8> {
    let (w, h) = (canvas.width, canvas.height);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" \
         viewBox=\"0 0 {w} {h}\">\n<rect width=\"{w}\" height=\"{h}\" fill=\"white\"/>\n"
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
