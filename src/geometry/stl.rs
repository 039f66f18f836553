//! Triangles of STL files, ASCII and binary.

use super::words::{Words, shown};
use super::{FARTHEST, Mistake};

/// Corners of a triangle \[L\].
pub type Triangle = [[f64; 3]; 3];

/// Bytes before the triangles of a binary file: a header of 80 and the number of triangles.
const HEADER: usize = 84;

/// Bytes of a triangle: normal, three corners, an attribute.
const RECORD: usize = 50;

/// Reads the triangles of a file; its normals are ignored, as the order of the corners tells them.
///
/// # Errors
/// Bytes that are no STL file; a coordinate that is not finite.
pub fn read(bytes: &[u8]) -> Result<Vec<Triangle>, Mistake> {
    // Some programs begin binary files with `solid`, so the size decides first.
    let count = bytes.get(80..HEADER).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let size = count.map(|count| HEADER as u64 + RECORD as u64 * u64::from(count));
    if size == Some(bytes.len() as u64) {
        return binary(&bytes[HEADER..]);
    }
    let start = bytes.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
    let begins = bytes[start..].get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    if begins && !bytes.iter().take(1024).any(|byte| *byte == 0) {
        return ascii(bytes);
    }
    Err(Mistake::whole(match (count, size) {
        (Some(count), Some(size)) => format!(
            "neither ASCII nor binary STL: a binary file of {count} triangles has {size} bytes, \
             this one has {}",
            bytes.len()
        ),
        _ => "no STL file: it is shorter than the header of a binary one".to_string(),
    }))
}

fn binary(records: &[u8]) -> Result<Vec<Triangle>, Mistake> {
    let (records, _) = records.as_chunks::<RECORD>();
    let mut triangles = Vec::with_capacity(records.len());
    for (index, record) in records.iter().enumerate() {
        let number = |corner: usize, axis: usize| {
            let at = 12 + 12 * corner + 4 * axis;
            f64::from(f32::from_le_bytes([
                record[at],
                record[at + 1],
                record[at + 2],
                record[at + 3],
            ]))
        };
        let triangle: Triangle =
            std::array::from_fn(|corner| std::array::from_fn(|axis| number(corner, axis)));
        if triangle.as_flattened().iter().any(|x| !x.is_finite() || x.abs() > FARTHEST) {
            let what = format!("triangle {} has a coordinate that is not finite", index + 1);
            return Err(Mistake::whole(what));
        }
        triangles.push(triangle);
    }
    Ok(triangles)
}

fn ascii(bytes: &[u8]) -> Result<Vec<Triangle>, Mistake> {
    let mut words = Words::new(bytes);
    let mut triangles = Vec::new();
    words.expect("solid")?;
    words.rest_of_line();
    loop {
        let word = words.word("`endsolid`")?;
        if word.eq_ignore_ascii_case(b"endsolid") {
            words.rest_of_line();
            match words.next() {
                None => return Ok(triangles),
                Some(word) if word.eq_ignore_ascii_case(b"solid") => words.rest_of_line(),
                Some(word) => {
                    let what = format!("expected `solid` or the end, found `{}`", shown(word));
                    return Err(Mistake::at(words.line, what));
                }
            };
        } else if word.eq_ignore_ascii_case(b"facet") {
            triangles.push(facet(&mut words)?);
        } else {
            let what = format!("expected `facet` or `endsolid`, found `{}`", shown(word));
            return Err(Mistake::at(words.line, what));
        }
    }
}

fn facet(words: &mut Words<'_>) -> Result<Triangle, Mistake> {
    words.expect("normal")?;
    for _ in 0..3 {
        words.word("a component of the normal")?;
    }
    words.expect("outer")?;
    words.expect("loop")?;
    let mut triangle = [[0.0; 3]; 3];
    for corner in &mut triangle {
        words.expect("vertex")?;
        for (coordinate, name) in corner.iter_mut().zip(["x", "y", "z"]) {
            *coordinate = words.number(name)?;
        }
    }
    words.expect("endloop")?;
    words.expect("endfacet")?;
    Ok(triangle)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: Triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.5, -0.25]];

    fn as_binary(header: &[u8], triangles: &[Triangle]) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, 0);
        bytes.extend((triangles.len() as u32).to_le_bytes());
        for triangle in triangles {
            bytes.extend([0; 12]);
            for x in triangle.as_flattened() {
                bytes.extend((*x as f32).to_le_bytes());
            }
            bytes.extend([0; 2]);
        }
        bytes
    }

    const TEXT: &str = "solid a b c\n facet normal 0 0 nan\n outer loop\n vertex 0 0 0\n \
        vertex 1 0 0\n vertex 0 .5 -.25\n endloop\n endfacet\nendsolid a b c\n";

    #[test]
    fn both_kinds_give_the_same_triangles() {
        assert_eq!(read(TEXT.as_bytes()), Ok(vec![TRIANGLE]));
        assert_eq!(read(TEXT.to_uppercase().as_bytes()), Ok(vec![TRIANGLE]));
        assert_eq!(read(&[TEXT, TEXT].concat().into_bytes()), Ok(vec![TRIANGLE; 2]));
        for header in ["a part", "solid says a program that writes binary"] {
            assert_eq!(read(&as_binary(header.as_bytes(), &[TRIANGLE; 3])), Ok(vec![TRIANGLE; 3]));
        }
    }

    #[test]
    fn broken_files_are_refused() {
        let mut huge = as_binary(b"part", &[TRIANGLE]);
        huge[80..84].copy_from_slice(&[0xff; 4]);
        let whole = as_binary(b"solid part", &[TRIANGLE; 2]);
        let mut infinite = whole.clone();
        infinite[84 + 50 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
        for (bytes, words) in [
            (&b""[..], "no STL file"),
            (b"no such thing", "no STL file"),
            (&huge, "neither ASCII nor binary STL: a binary file of 4294967295 triangles has"),
            (&whole[..whole.len() - 1], "neither ASCII nor binary STL"),
            (&infinite, "triangle 2 has a coordinate"),
        ] {
            let mistake = read(bytes).expect_err(words);
            assert!(mistake.line.is_none() && mistake.what.starts_with(words), "{}", mistake.what);
        }
        for (old, new, line, words) in [
            ("vertex 1", "vertex NaN", 5, "x is NaN"),
            ("vertex 1 0 0\n", "", 6, "expected `vertex`, found `endloop`"),
            ("-.25", "\u{e9}", 6, "expected z, found `??`"),
            ("endfacet\nendsolid a b c\n", "", 7, "the file ends before `endfacet`"),
            ("facet n", "fact n", 2, "expected `facet` or `endsolid`, found `fact`"),
            ("endsolid a b c\n", "endsolid\nx", 10, "expected `solid` or the end"),
        ] {
            let mistake = read(TEXT.replacen(old, new, 1).as_bytes()).expect_err(new);
            assert_eq!(mistake.line, Some(line), "{}", mistake.what);
            assert!(mistake.what.starts_with(words), "{}", mistake.what);
        }
    }
}
