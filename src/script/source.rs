//! Script text with its name and places in it.

use super::diagnostic::{Code, Diagnostic};

/// A part of a source, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Span {
    /// The bytes from `start` to before `end`.
    pub const fn new(start: usize, end: usize) -> Self {
        Self { start, end }
    }
}

/// A script's text.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// Name as the user gave it.
    pub name: String,
    /// The whole text, without a BOM.
    pub text: String,
}

impl Source {
    /// A script from text; a byte order mark at its start is skipped.
    pub fn new(name: impl Into<String>, text: &str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        Self { name: name.into(), text: text.to_string() }
    }

    /// A script from the bytes of a file.
    ///
    /// # Errors
    /// Bytes that are not UTF-8 are replaced by U+FFFD; the second value points at the first one.
    pub fn from_bytes(name: impl Into<String>, bytes: &[u8]) -> (Self, Option<Diagnostic>) {
        let source = Self::new(name, &String::from_utf8_lossy(bytes));
        let mistake = std::str::from_utf8(bytes).err().map(|error| {
            let marked = bytes.starts_with("\u{feff}".as_bytes());
            let start = error.valid_up_to() - if marked { '\u{feff}'.len_utf8() } else { 0 };
            let span = Span::new(start, start + '\u{fffd}'.len_utf8());
            Diagnostic::error(Code::Encoding, span, "the script is not UTF-8 text")
                .label("this byte belongs to no character")
                .help("save the file as UTF-8")
        });
        (source, mistake)
    }

    /// Line and column (both from 1, columns in characters) of a byte.
    pub fn position(&self, byte: usize) -> (usize, usize) {
        let before = &self.text[..self.boundary(byte)];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = before.bytes().filter(|byte| *byte == b'\n').count() + 1;
        (line, before[line_start..].chars().count() + 1)
    }

    /// The line, without its end, in which a byte lies.
    pub fn line_span(&self, byte: usize) -> Span {
        let byte = self.boundary(byte);
        let start = self.text[..byte].rfind('\n').map_or(0, |newline| newline + 1);
        let end = self.text[byte..].find('\n').map_or(self.text.len(), |length| byte + length);
        let line = self.text[start..end].strip_suffix('\r').unwrap_or(&self.text[start..end]);
        Span::new(start, start + line.len())
    }

    /// The nearest start of a character at or before a byte.
    pub fn boundary(&self, byte: usize) -> usize {
        let mut byte = byte.min(self.text.len());
        while !self.text.is_char_boundary(byte) {
            byte -= 1;
        }
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn byte_order_mark_does_not_count() {
        let source = Source::new("a", "\u{feff}ab");
        assert_eq!(source.text, "ab");
        assert_eq!(source.position(1), (1, 2));
    }

    #[test]
    fn columns_are_characters_and_lines_end_with_lf_or_crlf() {
        let source = Source::new("a", "é\tx\r\n\u{1d6d1}y\n");
        assert_eq!(source.position(3), (1, 3));
        assert_eq!(source.position(6), (2, 1));
        assert_eq!(source.position(10), (2, 2));
        assert_eq!(source.position(8), (2, 1), "inside a character");
        assert_eq!(source.position(1000), (3, 1));
        assert_eq!(&source.text[source.line_span(0).start..source.line_span(0).end], "é\tx");
        assert_eq!(source.line_span(12), Span::new(12, 12));
        assert_eq!(source.line_span(7), Span::new(6, 11));
    }

    #[test]
    fn bytes_that_are_no_text_are_found() {
        let (source, mistake) = Source::from_bytes("a", b"\xef\xbb\xbfab\xffc");
        assert_eq!(source.text, "ab\u{fffd}c");
        assert_eq!(mistake.expect("a mistake").span, Span::new(2, 5));
        assert!(Source::from_bytes("a", "é".as_bytes()).1.is_none());
    }
}
