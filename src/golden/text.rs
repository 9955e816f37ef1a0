//! A comparison as text, for terminals and messages of tests.

use super::side::Kind;
use super::{Compared, Comparison};
use std::collections::BTreeMap;
use std::fmt;

/// Number of pictures that are listed one by one.
const MOST_LISTED: usize = 12;

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(true))
    }
}

impl Comparison {
    /// The result as text; with the command that accepts what is there, on request.
    pub(crate) fn text(&self, with_command: bool) -> String {
        let mut text = String::new();
        self.write(&mut text).expect("writing to a string");
        if let Some(command) = self.command_to_accept().filter(|_| with_command) {
            let what = if self.sides[0].kind == Kind::Absent { "make it with" } else { "accept with" };
            text += &format!("{what}: {command}\n");
        } else if let (Kind::Absent, Some(why)) = (self.sides[0].kind, self.unfit().filter(|_| with_command)) {
            text += &format!("it cannot be made: {why}\n");
        }
        text
    }

    fn write(&self, f: &mut impl fmt::Write) -> fmt::Result {
        if self.sides[0].kind == Kind::Absent {
            let what = match self.sides[1].kind {
                Kind::Picture => "picture",
                Kind::Folder => "folder",
                Kind::Golden | Kind::Absent | Kind::Drawn => "golden",
            };
            writeln!(f, "the {what} {} is missing", self.sides[0].origin.display())?;
            return self.write_notes(f);
        }
        // For two single pictures the first frame is unknown.
        let are_pictures = self.sides.iter().all(|side| side.kind == Kind::Picture);
        for moved in self.moved.iter().filter(|_| !are_pictures) {
            writeln!(f, "state moved: {moved}")?;
        }
        let wrong: Vec<_> = self.pictures.iter().filter(|picture| !picture.verdict.passes()).collect();
        for Compared { name, verdict, .. } in wrong.iter().take(MOST_LISTED) {
            writeln!(f, "{name}: {verdict}")?;
        }
        if wrong.len() > MOST_LISTED {
            writeln!(f, "and {} more", wrong.len() - MOST_LISTED)?;
        }
        for (run, step) in
            self.moved.iter().filter_map(|moved| Some((&moved.run, moved.step?))).filter(|_| are_pictures)
        {
            writeln!(f, "{run}: {step}")?;
        }
        if let ([only], true) = (&self.pictures[..], wrong.is_empty()) {
            // A single picture that passes is listed, too.
            writeln!(f, "{}: {}", only.name, only.verdict)?;
        }
        if self.pictures.len() > 1 {
            match self.failures() {
                None => writeln!(f, "{}", self.pass())?,
                Some(failures) => writeln!(f, "{}: {failures}", self.verdict())?,
            }
        }
        if let Some(moved) = self.first_moved().filter(|_| self.pictures.len() > 1) {
            writeln!(f, "the first picture whose state moved is {}", moved.name)?;
        }
        if let (states @ 1.., true) = (self.states_compared(), self.moved.is_empty() && self.sides[0].record.is_some())
        {
            writeln!(f, "{states} states are the same")?;
        }
        self.write_notes(f)
    }

    /// How many pictures failed, in words; `None` if all passed.
    pub(super) fn failures(&self) -> Option<String> {
        let failed = self.pictures.iter().filter(|picture| !picture.verdict.passes()).count();
        match (failed, self.pictures.len()) {
            (0, _) => None,
            (1, 1) => Some("The picture is not as expected".to_owned()),
            (1, all) => Some(format!("1 of {all} pictures is not as expected")),
            (failed, all) => Some(format!("{failed} of {all} pictures are not as expected")),
        }
    }

    /// The verdicts on pictures that all pass, counted, in words.
    pub(super) fn pass(&self) -> String {
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for picture in &self.pictures {
            *counts.entry(picture.verdict.kind()).or_default() += 1;
        }
        let counts: Vec<_> = counts.into_iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        let distances = self.pictures.iter().filter_map(|picture| Some((picture.verdict.distance()?, &picture.name)));
        let nearest = distances.max_by(|one, other| one.0.of_limit().total_cmp(&other.0.of_limit()));
        let nearest = nearest.map_or_else(String::new, |(distance, name)| {
            format!("; nearest to its limit is {name} with {:.0} % of it", 100.0 * distance.of_limit())
        });
        match &self.pictures[..] {
            [only] => format!("1 picture: {}", only.verdict),
            all => format!("{} pictures: {}{nearest}", all.len(), counts.join(", ")),
        }
    }

    fn write_notes(&self, f: &mut impl fmt::Write) -> fmt::Result {
        if self.same_scene == Some(false) {
            writeln!(f, "the scene files are not the same")?;
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "{note}"))
    }
}
