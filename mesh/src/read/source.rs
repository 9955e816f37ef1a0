//! Bytes read one number or word after the other, as text or as binary numbers.

mod numbers;
mod words;

use super::ReadError;
pub(super) use numbers::{Scalar, vector};
pub(super) use words::{comma, integer, quoted};

/// The remedy for a file that ends early.
pub(super) const CUT: &str = "the file is incomplete: copy, download or write it again";
pub(super) const DAMAGED: &str = "the file is damaged: copy, download or write it again";

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coding {
    Text,
    Little,
    Big,
}

/// Bytes, and a place in them.
#[derive(Clone, Debug)]
pub(super) struct Source<'b> {
    /// The whole file.
    bytes: &'b [u8],
    /// The place of the next byte.
    pub(super) at: usize,
    /// The end of what is read: of the file, or of a line.
    end: usize,
    pub(super) coding: Coding,
    /// Whether a line that ends in a backslash goes on in the next.
    pub(super) continues: bool,
    /// What begins a comment up to the end of the line before a word or in it, if anything does.
    pub(super) comment: Option<u8>,
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t'..=b'\r')
}

impl<'b> Source<'b> {
    /// A text, without its byte order mark.
    pub(super) fn text(bytes: &'b [u8]) -> Self {
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { bytes, at, end: bytes.len(), coding: Coding::Text, continues: true, comment: None }
    }

    pub(super) fn part(bytes: &'b [u8], start: usize, end: usize) -> Self {
        Self { bytes, at: start, end, coding: Coding::Text, continues: true, comment: None }
    }

    pub(super) fn binary(bytes: &'b [u8], coding: Coding) -> Self {
        Self { coding, ..Self::part(bytes, 0, bytes.len()) }
    }

    pub(super) fn rest(&self) -> &'b [u8] {
        &self.bytes[self.at..self.end]
    }

    /// A place in words: a line of a text, or a byte.
    pub(super) fn place(&self, at: usize) -> String {
        match self.coding {
            Coding::Text => {
                let before = at.min(self.bytes.len());
                format!("in line {}", 1 + (0..before).filter(|&at| self.ends_line(at)).count())
            }
            _ => format!("at byte {at}"),
        }
    }

    /// Whether a byte is the last of the end of a line: a line feed, a carriage return, or both.
    fn ends_line(&self, at: usize) -> bool {
        self.bytes[at] == b'\n' || self.bytes[at] == b'\r' && self.bytes.get(at + 1) != Some(&b'\n')
    }

    fn skip_space(&mut self) {
        while self.at < self.end {
            match self.bytes[self.at] {
                byte if is_space(byte) => self.at += 1,
                // A line that is continued in the next.
                b'\\' if self.continues && matches!(self.rest(), [b'\\', b'\n' | b'\r', ..]) => self.at += 1,
                byte if self.comment == Some(byte) => drop(self.line()),
                _ => break,
            }
        }
    }

    /// Whether nothing is left, except space after a text.
    pub(super) fn is_done(&mut self) -> bool {
        if self.coding == Coding::Text {
            self.skip_space();
        }
        self.at == self.end
    }

    /// The next word, empty at the end.
    pub(super) fn word(&mut self) -> &'b [u8] {
        self.skip_space();
        let rest = self.rest();
        // Windows writes `1.#QNAN`, `1.#IND` and `1.#INF` for what is no number.
        let is_in_number =
            |at: usize| rest[..at].ends_with(b"1.") && matches!(rest.get(at + 1), Some(b'Q' | b'I' | b'S'));
        let ends = |&at: &usize| is_space(rest[at]) || self.comment == Some(rest[at]) && !is_in_number(at);
        let length = (0..rest.len()).find(ends).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    /// The next word, without going on.
    pub(super) fn peek(&mut self) -> &'b [u8] {
        let at = self.at;
        let word = self.word();
        self.at = at;
        word
    }

    /// The rest of the line, and goes to the next.
    pub(super) fn line(&mut self) -> &'b [u8] {
        let rest = self.rest();
        let is_end = |&byte: &u8| byte <= b'\r' && (byte == b'\n' || byte == b'\r');
        let length = rest.iter().position(is_end).unwrap_or(rest.len());
        let end = if rest[length..].starts_with(b"\r\n") { 2 } else { 1 };
        self.at += (length + end).min(rest.len());
        &rest[..length]
    }

    /// The next line that is not empty and not a comment, with the lines that continue it. Nothing continues a comment: paths of folders
    /// end in backslashes, too.
    pub(super) fn next_line(&mut self) -> Option<Self> {
        if self.is_done() {
            return None;
        }
        let (start, comment) = (self.at, self.comment);
        let may_begin = |before: u8| is_space(before) || before.is_ascii_digit() || b"./".contains(&before);
        let begins = |pair: &[u8]| may_begin(pair[0]) && Some(pair[1]) == comment;
        let has_comment =
            |line: &[u8]| comment.is_some() && line.first() == comment.as_ref() || line.windows(2).any(begins);
        loop {
            let line = self.line();
            if !(self.continues && line.ends_with(b"\\")) || has_comment(line) || self.at == self.end {
                return Some(Self { at: start, end: self.at, ..self.clone() });
            }
        }
    }

    /// The fields of a line between commas that are not blank, with their numbers.
    pub(super) fn fields(&self) -> impl Iterator<Item = (usize, Self)> {
        let (bytes, continues, mut next) = (self.bytes, self.continues, self.at);
        let parts = self.rest().split(|&byte| byte == b',').map(move |part| {
            let start = next;
            next += part.len() + 1;
            Self { continues, ..Self::part(bytes, start, start + part.len()) }
        });
        parts.enumerate().filter(|(_, part)| !part.rest().trim_ascii().is_empty())
    }

    pub(super) fn take(&mut self, count: usize, expected: &str) -> Result<&'b [u8], ReadError> {
        let rest = self.rest();
        if count > rest.len() {
            return Err(self.ends(expected));
        }
        self.at += count;
        Ok(&rest[..count])
    }

    /// The error of a word that was just read, or of the end.
    pub(super) fn wrong(&self, word: &[u8], expected: &str) -> ReadError {
        if word.is_empty() { self.ends(expected) } else { self.found(&quoted(word), self.at - word.len(), expected) }
    }

    pub(super) fn found(&self, found: &str, at: usize, expected: &str) -> ReadError {
        let found = if found.starts_with('`') { found.to_owned() } else { format!("`{found}`") };
        ReadError::new(format!("has {found} {}; expected {expected}", self.place(at)), DAMAGED)
    }

    pub(super) fn ends(&self, expected: &str) -> ReadError {
        if self.end < self.bytes.len() {
            let place = self.place(self.end.saturating_sub(1));
            return ReadError::new(format!("has nothing more {place}; expected {expected}"), DAMAGED);
        }
        ReadError::new(format!("ends {}; expected {expected}", self.place(self.bytes.len())), CUT)
    }
}
