//! The text of a file, with lines and columns.

use std::ops::Range;

/// A text that converts byte offsets to lines and columns.
#[derive(Debug)]
pub(crate) struct Source<'t> {
    text: &'t str,
    /// The first byte of each line.
    lines: Vec<usize>,
    /// The number of lines of the file. Settings of the command line follow.
    of_file: usize,
}

/// The longest excerpt under a message (characters).
const WIDEST_EXCERPT: usize = 110;

impl<'t> Source<'t> {
    pub(crate) fn new(text: &'t str) -> Self {
        let starts = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n').map(|(at, _)| at + 1);
        let lines: Vec<_> = std::iter::once(0).chain(starts).collect();
        Self { text, of_file: lines.len(), lines }
    }

    /// A text in which settings of the command line follow the file that ends at a byte.
    pub(crate) fn with_settings(text: &'t str, end: usize) -> Self {
        let whole = Self::new(text);
        Self { of_file: whole.lines.partition_point(|&start| start <= end), ..whole }
    }

    /// Whether a line, counted from 1, is a setting of the command line.
    pub(crate) fn is_setting(&self, line: usize) -> bool {
        line > self.of_file
    }

    pub(crate) fn text(&self) -> &'t str {
        self.text
    }

    /// The last character boundary up to a byte offset.
    fn boundary(&self, byte: usize) -> usize {
        let byte = byte.min(self.text.len());
        (0..=byte).rev().find(|&at| self.text.is_char_boundary(at)).unwrap_or(0)
    }

    /// Line and column of a byte offset, counted from 1, the column in characters.
    pub(crate) fn position(&self, byte: usize) -> (usize, usize) {
        let byte = self.boundary(byte);
        let line = self.lines.partition_point(|&start| start <= byte).max(1);
        (line, self.text[self.lines[line - 1]..byte].chars().count() + 1)
    }

    /// The line in which a span begins, cut to a readable width, and the columns of the span in it (characters).
    /// Control characters such as tabs become spaces, so that the mark is aligned.
    pub(crate) fn excerpt(&self, span: &Range<usize>) -> (String, Range<usize>) {
        let (line, column) = self.position(span.start);
        let start = self.lines[line - 1];
        let end = self.lines.get(line).map_or(self.text.len(), |next| next - 1);
        let marked = self.text
            [self.boundary(span.start)..self.boundary(span.end.clamp(span.start, end)).max(self.boundary(span.start))]
            .chars()
            .count()
            .max(1);
        let shown = self.text[start..end].trim_end();
        // Long lines, such as lists of nodes, are cut so that the place is near the left end.
        let long = shown.chars().nth(WIDEST_EXCERPT).is_some();
        let first = if long && column > WIDEST_EXCERPT / 2 { column - 1 - WIDEST_EXCERPT / 4 } else { 0 };
        let clean = |c: char| if c.is_control() { ' ' } else { c };
        let mut excerpt: String = shown.chars().skip(first).take(WIDEST_EXCERPT).map(clean).collect();
        let mut from = column - 1 - first;
        let mut to = (from + marked).min(WIDEST_EXCERPT).max(from + 1);
        if first > 0 {
            excerpt.insert_str(0, "… ");
            from += 2;
            to += 2;
        }
        if shown.chars().nth(first + WIDEST_EXCERPT).is_some() {
            excerpt.push_str(" …");
        }
        (excerpt, from..to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_lines_and_characters_from_one() {
        let source = Source::new("é = 1\n\nlast");
        assert_eq!(source.position(0), (1, 1));
        assert_eq!(source.position(1), (1, 1), "inside a character");
        assert_eq!(source.position(2), (1, 2));
        assert_eq!(source.position(7), (2, 1));
        assert_eq!(source.position(8), (3, 1));
        assert_eq!(source.position(12), (3, 5));
        assert_eq!(source.position(999), (3, 5));
        assert_eq!(Source::new("").position(0), (1, 1));
    }

    #[test]
    fn long_lines_are_cut_around_the_place() {
        let text = format!("nodes = [{}99, 1]", "1, ".repeat(400));
        let at = text.find("99").unwrap();
        let (excerpt, marked) = Source::new(&text).excerpt(&(at..at + 2));
        assert!(excerpt.chars().count() <= WIDEST_EXCERPT + 4, "{excerpt}");
        assert_eq!(excerpt.chars().skip(marked.start).take(marked.len()).collect::<String>(), "99");
    }
}
