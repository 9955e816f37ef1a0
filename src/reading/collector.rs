//! Collecting mistakes with their positions in the file.

use super::source::Source;
use super::{Mistake, Mistakes};
use std::cell::{Cell, RefCell};
use std::fmt;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// One step of the path from the root of a file to a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PathPart<'a> {
    /// Into a table.
    Key(&'a str),
    /// Into an array.
    Index(usize),
}

impl<'a> From<&'a str> for PathPart<'a> {
    fn from(key: &'a str) -> Self {
        Self::Key(key)
    }
}

impl From<usize> for PathPart<'_> {
    fn from(index: usize) -> Self {
        Self::Index(index)
    }
}

/// The remedy of a mistake, as text or none.
pub(crate) trait Help {
    fn text(self) -> Option<String>;
}

impl Help for &str {
    fn text(self) -> Option<String> {
        Some(self.to_owned())
    }
}

impl Help for String {
    fn text(self) -> Option<String> {
        Some(self)
    }
}

impl Help for Option<String> {
    fn text(self) -> Option<String> {
        self
    }
}

/// The path of a value, as written in messages: `run[1].model.stiffness`.
pub(crate) fn written(path: &[PathPart<'_>]) -> String {
    let mut text = String::new();
    for part in path {
        match part {
            PathPart::Key(key) if text.is_empty() => text.push_str(key),
            PathPart::Key(key) => text.extend([".", key]),
            PathPart::Index(index) => text.push_str(&format!("[{index}]")),
        }
    }
    text
}

/// The number of mistakes that are kept with their text.
const KEPT: usize = 1000;

/// The mistakes and warnings found so far. All parts of a scene report to the same one.
#[derive(Debug)]
pub(crate) struct Collector<'t> {
    /// The text of the file; `None` for a scene made in code.
    source: Option<&'t Source<'t>>,
    root: &'t DeTable<'t>,
    found: RefCell<Vec<Mistake>>,
    total: Cell<usize>,
    warned: RefCell<Vec<Mistake>>,
}

impl<'t> Collector<'t> {
    /// For a file with this text.
    pub(crate) fn new(source: &'t Source<'t>, root: &'t DeTable<'t>) -> Self {
        Self { source: Some(source), ..Self::of_code(root) }
    }

    /// For a scene made in code. Its mistakes have paths in place of lines and columns, and stay in the order in which they are found.
    pub(crate) fn of_code(root: &'t DeTable<'t>) -> Self {
        Self { source: None, root, found: RefCell::default(), total: Cell::new(0), warned: RefCell::default() }
    }

    /// The number of mistakes found so far.
    pub(crate) fn total(&self) -> usize {
        self.total.get()
    }

    /// The whole file.
    pub(crate) fn root(&self) -> Here<'_> {
        Here { path: Vec::new(), report: self }
    }

    /// The place of a key at the top of the file.
    pub(crate) fn to<'a>(&'a self, key: &'a str) -> Here<'a> {
        self.root().to(key)
    }

    /// Counts a mistake and returns true if no more messages are kept. Otherwise the caller writes the message.
    pub(crate) fn only_counted(&self) -> bool {
        let is_full = self.found.borrow().len() >= KEPT;
        self.total.set(self.total.get() + usize::from(is_full));
        is_full
    }

    /// Whether a mistake was found in the line of a byte.
    pub(crate) fn has_mistake_in_line_of(&self, byte: usize) -> bool {
        let line = self.source.map_or(0, |source| source.position(byte).0);
        self.found.borrow().iter().any(|mistake| mistake.line == line)
    }

    /// A mistake at a span of the text, in the value at `path`.
    pub(crate) fn at_span(&self, span: Range<usize>, path: &[PathPart<'_>], message: String, help: Option<String>) {
        self.total.set(self.total.get() + 1);
        let mut found = self.found.borrow_mut();
        if found.len() < KEPT {
            found.push(mistake(self.source, span, path, message, help));
        }
    }

    /// A warning about a span of the text, in the value at `path`: allowed, but probably a mistake.
    pub(crate) fn warn(&self, span: Range<usize>, path: &[PathPart<'_>], message: String, help: Option<String>) {
        self.warned.borrow_mut().push(mistake(self.source, span, path, message, help));
    }

    /// All warnings, in the order of the text.
    pub(crate) fn warnings(&self) -> Vec<Mistake> {
        self.in_order(self.warned.take())
    }

    /// All mistakes, in the order of the text.
    pub(crate) fn finish(self, file: &str) -> Mistakes {
        Mistakes { file: file.into(), found: self.in_order(self.found.take()), total: self.total.get() }
    }

    /// Mistakes in the order of the text. Mistakes in settings of the command line come last and get no position.
    fn in_order(&self, mut found: Vec<Mistake>) -> Vec<Mistake> {
        found.sort_by_key(|mistake| (mistake.line, mistake.column));
        let of_settings =
            found.iter_mut().filter(|mistake| self.source.is_some_and(|source| source.is_setting(mistake.line)));
        of_settings.for_each(|mistake| (mistake.line, mistake.column) = (0, 0));
        found
    }
}

/// A place in a file, where mistakes are reported. It prints as its path.
#[derive(Clone, Debug)]
pub(crate) struct Here<'a> {
    path: Vec<PathPart<'a>>,
    pub(crate) report: &'a Collector<'a>,
}

impl<'a> Here<'a> {
    /// A key or an entry in it.
    pub(crate) fn to(&self, part: impl Into<PathPart<'a>>) -> Self {
        Self { path: [&self.path[..], &[part.into()]].concat(), report: self.report }
    }

    /// Goes to another entry beside it.
    pub(crate) fn go_to(&mut self, index: usize) {
        self.path.pop();
        self.path.push(PathPart::Index(index));
    }

    /// Its path.
    pub(crate) fn path(&self) -> &[PathPart<'a>] {
        &self.path
    }

    /// The key at its end, with its place in the file.
    fn key(&self) -> Option<&'a Spanned<DeString<'a>>> {
        let (PathPart::Key(key), before) = self.path.split_last()? else { return None };
        table_at(self.report.root, before)?.get_key_value(*key).map(|(key, _)| key)
    }

    /// Whether the file has the key.
    pub(crate) fn is_typed(&self) -> bool {
        self.key().is_some()
    }

    /// The span of the value, or of its nearest ancestor in the file.
    fn span(&self) -> Range<usize> {
        span_of(self.report.root, &self.path)
    }

    /// Line and column of the value, or of its nearest ancestor in the file. Both are 0 if the command line sets it.
    pub(crate) fn position(&self) -> (usize, usize) {
        let Some(source) = self.report.source else { return (0, 0) };
        let (line, column) = source.position(self.span().start);
        if source.is_setting(line) { (0, 0) } else { (line, column) }
    }

    /// A mistake in the value, or in its nearest ancestor in the file.
    pub(crate) fn wrong(&self, message: impl Into<String>, help: impl Help) {
        self.report.at_span(self.span(), &self.path, message.into(), help.text());
    }

    /// A mistake about the key, or about the table that lacks it.
    pub(crate) fn wrong_key(&self, message: impl Into<String>, help: impl Help) {
        let span = self.key().map_or_else(|| self.span(), Spanned::span);
        self.report.at_span(span, &self.path, message.into(), help.text());
    }

    /// A warning about the value.
    pub(crate) fn warn(&self, message: String, help: impl Help) {
        self.report.warn(self.span(), &self.path, message, help.text());
    }
}

impl fmt::Display for Here<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&written(&self.path))
    }
}

/// A mistake at a span of a text, if there is one, in the value at `path`.
pub(crate) fn mistake(
    source: Option<&Source<'_>>,
    span: Range<usize>,
    path: &[PathPart<'_>],
    message: String,
    help: Option<String>,
) -> Mistake {
    let (line, column) = source.map_or((0, 0), |source| source.position(span.start));
    let (excerpt, marked) = source.map(|source| source.excerpt(&span)).unwrap_or_default();
    Mistake { line, column, place: written(path), message, help, excerpt, marked }
}

/// The span of the value at `path`, or of its innermost ancestor that exists.
fn span_of(root: &DeTable<'_>, path: &[PathPart<'_>]) -> Range<usize> {
    let (first, rest) = match path {
        [PathPart::Key(first), rest @ ..] => (*first, rest),
        _ => return 0..0,
    };
    let Some(mut value) = root.get(first) else { return 0..0 };
    for part in rest {
        let next = match (part, value.get_ref()) {
            (PathPart::Key(key), DeValue::Table(table)) => table.get(*key),
            (PathPart::Index(index), DeValue::Array(items)) => items.get(*index),
            _ => None,
        };
        match next {
            Some(next) => value = next,
            None => break,
        }
    }
    value.span()
}

fn table_at<'a, 't>(root: &'a DeTable<'t>, path: &[PathPart<'_>]) -> Option<&'a DeTable<'t>> {
    let Some((PathPart::Key(first), rest)) = path.split_first() else { return Some(root) };
    let mut value = root.get(*first)?;
    for part in rest {
        value = match part {
            PathPart::Key(key) => value.get_ref().get(*key)?,
            PathPart::Index(index) => value.get_ref().get(*index)?,
        };
    }
    value.get_ref().as_table()
}
