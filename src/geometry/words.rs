//! Words and numbers of a text file, with their lines.

use super::{FARTHEST, Mistake};

/// What is left of a text file.
pub(super) struct Words<'a> {
    rest: &'a [u8],
    /// Line of the word read last, from 1.
    pub line: usize,
    /// Line that comes next.
    next_line: usize,
}

impl<'a> Words<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        Self { rest: bytes, line: 1, next_line: 1 }
    }

    /// Bytes not yet read: no count can be larger.
    pub(super) fn remaining(&self) -> usize {
        self.rest.len()
    }

    fn skip_blanks(&mut self) {
        let blanks = self.rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let (blanks, rest) = self.rest.split_at(blanks);
        self.next_line += blanks.iter().filter(|byte| **byte == b'\n').count();
        self.rest = rest;
    }

    /// The next word, if there is one.
    pub(super) fn next(&mut self) -> Option<&'a [u8]> {
        self.skip_blanks();
        if self.rest.is_empty() {
            return None;
        }
        self.line = self.next_line;
        let length = self.rest.iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        let (word, rest) = self.rest.split_at(length);
        self.rest = rest;
        Some(word)
    }

    /// The rest of the line of the word read last.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let length = self.rest.iter().take_while(|byte| **byte != b'\n').count();
        let (line, rest) = self.rest.split_at(length);
        self.rest = rest;
        line
    }

    /// The next word, or the mistake that the file ends before `what`.
    pub(super) fn word(&mut self, what: &str) -> Result<&'a [u8], Mistake> {
        let last = self.line;
        self.next().ok_or_else(|| Mistake::at(last, format!("the file ends before {what}")))
    }

    /// The word that must come next; case does not matter.
    pub(super) fn expect(&mut self, word: &str) -> Result<(), Mistake> {
        let found = self.word(&format!("`{word}`"))?;
        if found.eq_ignore_ascii_case(word.as_bytes()) {
            return Ok(());
        }
        Err(Mistake::at(self.line, format!("expected `{word}`, found `{}`", shown(found))))
    }

    /// A finite number that is no larger than a coordinate can be.
    pub(super) fn number(&mut self, what: &str) -> Result<f64, Mistake> {
        let word = self.word(what)?;
        number(word, what).map_err(|mistake| Mistake::at(self.line, mistake))
    }

    /// A whole number from 0.
    pub(super) fn whole(&mut self, what: &str) -> Result<u64, Mistake> {
        let word = self.word(what)?;
        let text = std::str::from_utf8(word).ok();
        text.and_then(|text| text.parse().ok()).ok_or_else(|| {
            Mistake::at(self.line, format!("expected {what}, found `{}`", shown(word)))
        })
    }
}

/// Reads a finite number.
pub(super) fn number(word: &[u8], what: &str) -> Result<f64, String> {
    let text = std::str::from_utf8(word).ok();
    match text.and_then(|text| text.parse::<f64>().ok()) {
        Some(value) if value.abs() <= FARTHEST => Ok(value),
        Some(value) => Err(format!("{what} is {value}")),
        None => Err(format!("expected {what}, found `{}`", shown(word))),
    }
}

/// A word cut to a length that fits a message; other characters than ASCII ones are replaced.
pub(super) fn shown(word: &[u8]) -> String {
    const LONGEST: usize = 30;
    let plain = |byte: &u8| if byte.is_ascii_graphic() { char::from(*byte) } else { '?' };
    let text: String = word.iter().take(LONGEST).map(plain).collect();
    if word.len() > LONGEST { format!("{text}...") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_know_their_lines() {
        let mut words = Words::new(b"\xef\xbb\xbf a b\r\n\n c 1e3\n");
        let mut found = Vec::new();
        while let Some(word) = words.next() {
            found.push((words.line, word.to_vec()));
        }
        let expected = [(1, "a"), (1, "b"), (3, "c"), (3, "1e3")];
        assert_eq!(found, expected.map(|(line, word)| (line, word.as_bytes().to_vec())));
    }

    #[test]
    fn numbers_are_finite() {
        for text in ["nan", "inf", "-infinity", "1e400", "1e61", "1,5", "", "0x1", "1d3"] {
            assert!(number(text.as_bytes(), "x").is_err(), "{text}");
        }
        assert_eq!(number(b"-1.5E+1", "x"), Ok(-15.0));
        assert_eq!(number(b"\xff\xfe", "x"), Err("expected x, found `??`".to_string()));
    }
}
