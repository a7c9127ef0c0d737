//! Words and lines of a text format, with the line number at hand.

use crate::error::{LoadError, Place};

/// What differs between text formats.
#[derive(Clone, Copy, Default)]
pub(crate) struct Dialect {
    /// A word that starts with this byte starts a comment, to the end of the line.
    pub(crate) comment: Option<u8>,
    /// A backslash before the end of a line joins it to the next.
    pub(crate) continuation: bool,
}

/// Walks over bytes word by word and line by line. Lines end with LF, CR LF or CR.
pub(crate) struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    dialect: Dialect,
}

impl<'a> Scanner<'a> {
    pub(crate) fn new(bytes: &'a [u8], dialect: Dialect) -> Self {
        Self { bytes, at: 0, line: 1, dialect }
    }

    /// Where the next byte to read is.
    pub(crate) fn offset(&self) -> usize {
        self.at
    }

    /// How many bytes are left.
    pub(crate) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// The line of the next byte, counted from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    pub(crate) fn place(&self) -> Place {
        Place::line(self.line)
    }

    /// The next word of this line.
    pub(crate) fn word(&mut self) -> Option<&'a [u8]> {
        loop {
            match *self.bytes.get(self.at)? {
                b' ' | b'\t' | 0x0b | 0x0c => self.at += 1,
                b'\n' | b'\r' => return None,
                byte if Some(byte) == self.dialect.comment => return None,
                _ if self.is_continued(self.at) => {
                    self.at += 1;
                    self.end_line();
                }
                _ => return Some(self.take_word()),
            }
        }
    }

    /// The next word, on this line or a later one.
    pub(crate) fn word_anywhere(&mut self) -> Option<&'a [u8]> {
        loop {
            if let Some(word) = self.word() {
                return Some(word);
            }
            if !self.next_line() {
                return None;
            }
        }
    }

    /// Goes to the start of the next line; false when there is none.
    pub(crate) fn next_line(&mut self) -> bool {
        while self.bytes.get(self.at).is_some_and(|byte| !is_line_end(*byte)) {
            self.at += 1;
        }
        self.end_line();
        self.at < self.bytes.len()
    }

    fn take_word(&mut self) -> &'a [u8] {
        let start = self.at;
        while let Some(byte) = self.bytes.get(self.at) {
            if byte.is_ascii_whitespace() || *byte == 0x0b || self.is_continued(self.at) {
                break;
            }
            self.at += 1;
        }
        &self.bytes[start..self.at]
    }

    /// Whether a backslash at `at` joins this line to the next.
    fn is_continued(&self, at: usize) -> bool {
        self.dialect.continuation
            && self.bytes[at] == b'\\'
            && self.bytes.get(at + 1).is_some_and(|byte| is_line_end(*byte))
    }

    /// Steps over one line end.
    fn end_line(&mut self) {
        match &self.bytes[self.at..] {
            [b'\r', b'\n', ..] => self.at += 2,
            [_, ..] => self.at += 1,
            [] => return,
        }
        self.line += 1;
    }
}

fn is_line_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

/// The number that `word` is: decimal, with an optional sign, point and exponent; `inf` and `nan` too.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The coordinate that `word` must be.
pub(crate) fn coordinate(word: Option<&[u8]>, place: Place) -> Result<f64, LoadError> {
    let Some(word) = word else {
        return Err(LoadError::malformed(place, "a coordinate is missing"));
    };
    number(word)
        .ok_or_else(|| LoadError::malformed(place, format!("{} is not a number", quoted(word))))
}

/// `word` in quotes for a message: the first part of it, with odd bytes escaped.
pub(crate) fn quoted(word: &[u8]) -> String {
    const LONGEST: usize = 40;
    let dots = if word.len() > LONGEST { "..." } else { "" };
    format!("\"{}{dots}\"", word[..word.len().min(LONGEST)].escape_ascii())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_lines_comments_and_continuations() {
        let dialect = Dialect { comment: Some(b'#'), continuation: true };
        let mut scanner = Scanner::new(b"f 1\\\r\n2 \\\n 3#4 # rest\rg\n\n", dialect);
        let mut words = Vec::new();
        while let Some(word) = scanner.word() {
            words.push(word);
        }
        assert_eq!(words, [&b"f"[..], b"1", b"2", b"3#4"]);
        assert_eq!(scanner.line(), 3);
        assert!(scanner.next_line());
        assert_eq!((scanner.word(), scanner.line()), (Some(&b"g"[..]), 4));
        assert_eq!(scanner.word_anywhere(), None);
        assert_eq!(scanner.left(), 0);
    }
}
