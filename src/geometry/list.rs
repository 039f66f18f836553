//! Particles as a text file lists them: `x [y [z]] volume`, one a line, `#` starts a comment.

use super::words::{number, shown};
use super::{Mistake, Point, Points};

/// Reads the particles of a body of `dimension` axes.
///
/// The body reaches half an edge of a square or cube of its volume beyond each particle.
///
/// # Errors
/// A line of another form, a number that is not finite, a volume that is not above 0.
pub fn read(bytes: &[u8], dimension: usize) -> Result<Points, Mistake> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut points = Points::default();
    points.lower[..dimension].fill(f64::INFINITY);
    points.upper[..dimension].fill(f64::NEG_INFINITY);
    for (index, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
        let line = line.split(|byte| *byte == b'#').next().unwrap_or_default();
        let mut words = line.split(|b| b.is_ascii_whitespace()).filter(|word| !word.is_empty());
        let Some(first) = words.next() else { continue };
        let mistake = |what: String| Mistake::at(index + 1, what);
        let mut values = [0.0; 4];
        let names = [&["x", "y", "z"][..dimension], &["the volume"]].concat();
        let mut word = Some(first);
        for (value, name) in values.iter_mut().zip(&names) {
            let found = word.ok_or_else(|| {
                mistake(format!("{name} is missing: a line is `{}`", form(dimension)))
            })?;
            *value = number(found, name).map_err(&mistake)?;
            word = words.next();
        }
        if let Some(surplus) = word {
            let form = form(dimension);
            return Err(mistake(format!("`{}` is too much: a line is `{form}`", shown(surplus))));
        }
        let mut place = values;
        let volume = std::mem::take(&mut place[dimension]);
        if volume <= 0.0 {
            return Err(mistake(format!("the volume must be above 0, it is {volume}")));
        }
        let half = 0.5 * volume.powf(1.0 / dimension as f64);
        for axis in 0..dimension {
            points.lower[axis] = points.lower[axis].min(place[axis] - half);
            points.upper[axis] = points.upper[axis].max(place[axis] + half);
        }
        points.list.push(Point { place: [place[0], place[1], place[2]], volume });
    }
    if points.list.is_empty() {
        return Err(Mistake::whole("there is no particle in it"));
    }
    Ok(points)
}

fn form(dimension: usize) -> &'static str {
    ["x volume", "x y volume", "x y z volume"][dimension - 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_blank_lines_do_not_count() {
        let points = read(b"# x y volume\r\n\n 0.5 1 0.04 # first\n-1 0 4", 2).expect("good");
        assert_eq!(points.list[0], Point { place: [0.5, 1.0, 0.0], volume: 0.04 });
        assert_eq!(points.list[1], Point { place: [-1.0, 0.0, 0.0], volume: 4.0 });
        assert_eq!((points.lower, points.upper), ([-2.0, -1.0, 0.0], [0.6, 1.1, 0.0]));
    }

    #[test]
    fn mistakes_name_their_line() {
        for (text, dimension, line, words) in [
            ("1 2\n1 2 3", 1, Some(2), "`3` is too much"),
            ("1 2\n", 2, Some(1), "the volume is missing"),
            ("\n0 0 0 0", 3, Some(2), "the volume must be above 0"),
            ("0 nan 1", 2, Some(1), "y is NaN"),
            ("0,5 1", 1, Some(1), "expected x, found `0,5`"),
            ("# nothing", 1, None, "there is no particle"),
        ] {
            let mistake = read(text.as_bytes(), dimension).expect_err(text);
            assert_eq!(mistake.line, line, "{text}");
            assert!(mistake.what.starts_with(words), "{text}: {}", mistake.what);
        }
    }
}
