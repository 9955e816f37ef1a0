//! Mistakes in a file, and how they are printed.

use serde::Serialize;
use std::fmt;
use std::ops::Range;

/// One mistake and its place; [`Mistakes`] print it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Mistake {
    /// Line, counted from 1; 0 in a scene made in code, and in a setting of the command line.
    pub line: usize,
    /// Column in characters, counted from 1; 0 where there is no line.
    pub column: usize,
    /// The key or entry, such as `run[0].model.stiffness`; empty where there is none.
    #[serde(skip)]
    pub place: String,
    /// The found and the expected value.
    pub message: String,
    /// The remedy, unless the message has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub help: Option<String>,
    /// The source line, or a part of it; the option for a setting of the command line; empty in a scene made in code.
    pub excerpt: String,
    /// The characters of the excerpt to mark.
    #[serde(skip)]
    pub marked: Range<usize>,
}

/// All mistakes of one file, in the order of its text.
///
/// They print with the source line and a mark under the place. `annotate-snippets` would replace only the printing, and
/// not the lines, columns and excerpts that programs get.
///
/// ```text
/// drop.toml:12:33: unknown key `stifness` in `run[0].model`
///    12 | model = { kind = "shape-based", stifness = 1e4 }
///       |                                 ^^^^^^^^ did you mean `stiffness`?
/// ```
///
/// Mistakes of a scene made in code print in one line each, with the name of the scene and of the setting:
///
/// ```text
/// drop: `run[0].model.stiffness` is -1.0; expected a number greater than 0
/// ```
///
/// Mistakes in settings of the command line print with the option in place of line and column:
///
/// ```text
/// drop.toml: --set time.duraton=1: unknown key `duraton` in `time`; did you mean `duration`?
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Mistakes {
    /// The file, as named by the caller; the name of a scene made in code.
    pub file: String,
    /// The first thousand mistakes.
    pub found: Vec<Mistake>,
    /// The number of mistakes.
    pub total: usize,
}

/// The number of printed mistakes: a screen or two. More usually have the same cause.
const SHOWN: usize = 20;

impl fmt::Display for Mistakes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, mistake) in self.found.iter().take(SHOWN).enumerate() {
            if number > 0 {
                writeln!(f)?;
            }
            let Mistake { line, column, place, message, help, excerpt, marked } = mistake;
            if *line == 0 {
                write!(f, "{}: ", self.file)?;
                if !excerpt.is_empty() {
                    write!(f, "{excerpt}: ")?;
                } else if !message.contains(&format!("`{place}")) {
                    write!(f, "`{place}`: ")?;
                }
                f.write_str(message)?;
                help.iter().try_for_each(|help| write!(f, "; {help}"))?;
                continue;
            }
            writeln!(f, "{}:{line}:{column}: {message}", self.file)?;
            let gutter = line.to_string().len() + 2;
            writeln!(f, "{line:>gutter$} | {excerpt}")?;
            let (before, mark) = (" ".repeat(marked.start), "^".repeat(marked.len()));
            write!(f, "{:gutter$} | {before}{mark}", "")?;
            if let Some(help) = help {
                // Under the mark when it stands far right or the help is long.
                if marked.end + help.chars().count() > 90 {
                    write!(f, "\n{:gutter$} = {help}", "")?;
                } else {
                    write!(f, " {help}")?;
                }
            }
        }
        match self.total - self.found.len().min(SHOWN) {
            0 => Ok(()),
            more => write!(f, "\n{}: and {more} more", self.file),
        }
    }
}
