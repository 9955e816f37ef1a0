//! Points that were measured elsewhere, from a file of comma-separated values beside the scene.

use super::file::PointsFile;
use crate::reading::beside::{Wrong, bytes};
use crate::reading::report::{Report, Way};
use crate::reading::words::{list, quoted};
use csv::{ReaderBuilder, StringRecord, Trim};
use glam::DVec3;
use sha2::{Digest, Sha256};
use std::path::Path;
use std::sync::Arc;

/// The longest file that is read (bytes), with some 200 000 points.
const LONGEST: u64 = 8 << 20;
/// What such files are called.
const ENDINGS: [&str; 1] = ["csv"];
/// The columns: a time (s) and a place (m).
const COLUMNS: [&str; 4] = ["time", "x", "y", "z"];

/// The points of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct PointsRead {
    /// Whether there is a third coordinate.
    pub(super) has_z: bool,
    /// Times (s), rising, and places (m).
    pub(super) samples: Arc<[(f64, DVec3)]>,
    digest: String,
}

impl PointsRead {
    /// The digest of the file, which stands for its name in that of a scene.
    pub(crate) fn digest(&self) -> &str {
        &self.digest
    }
}

/// The points of a scene, looked for in its folder, or `None` after reporting what is wrong with them.
pub(crate) fn read(folder: &Path, typed: &PointsFile, report: &mut Report<'_>) -> Option<PointsRead> {
    let path = [Way::Key("view"), Way::Key("points"), Way::Key("file")];
    let expected = "expected comma-separated values";
    let found = bytes(&folder.join(&typed.file), &ENDINGS, LONGEST, "points", expected).and_then(|bytes| parse(&bytes));
    found.map_err(|(message, help)| report.at(&path, format!("`{}` {message}", typed.file), help)).ok()
}

fn parse(bytes: &[u8]) -> Result<PointsRead, Wrong> {
    let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(bytes);
    let broken = |error: csv::Error| (format!("is no table of comma-separated values: {error}"), None);
    let headers = reader.headers().map_err(broken)?.clone();
    let place = |name: &str| headers.iter().position(|header| header == name);
    let places = COLUMNS.map(place);
    let [Some(time), Some(x), Some(y), z] = places else {
        let all: Vec<_> = headers.iter().collect();
        let found =
            if all.is_empty() { "no columns".to_owned() } else { format!("the columns {}", list(&all, "and", quoted)) };
        if let [one] = all[..]
            && let Some((sign, name)) =
                [(';', "semicolons"), ('\t', "tabs")].into_iter().find(|(sign, _)| one.contains(*sign))
        {
            let help = format!("write commas in place of `{}`, and points in decimal numbers", sign.escape_default());
            return Err((format!("separates its columns with {name}; expected commas"), Some(help)));
        }
        let help = "write `time,x,y,z`, or `time,x,y` for the plane, in the first line (s and m)".to_owned();
        return Err((format!("has {found}; expected time, x and y, and z in space"), Some(help)));
    };
    let mut samples = Vec::new();
    for record in reader.records() {
        let record = record.map_err(broken)?;
        let [x, y, z] = [Some(x), Some(y), z].map(|column| column.map_or(Ok(0.0), |at| number(&record, &headers, at)));
        samples.push((number(&record, &headers, time)?, DVec3::new(x?, y?, z?)));
    }
    if samples.is_empty() {
        return Err(("has no points below its first line".to_owned(), None));
    }
    samples.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    let digest = Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    Ok(PointsRead { has_z: z.is_some(), samples: samples.into(), digest })
}

/// A number of a line.
fn number(record: &StringRecord, headers: &StringRecord, at: usize) -> Result<f64, Wrong> {
    let text = record.get(at).unwrap_or_default();
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
        let line = record.position().map_or(0, csv::Position::line);
        let column = headers.get(at).unwrap_or_default();
        (format!("has {} as `{column}` in line {line}; expected a number", quoted(text)), None)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_in_the_order_of_time_whatever_that_of_columns_and_lines() {
        let read = parse(b"# a camera\n y , time, x\n 2, 0.5, 1\n\n4, 0.25, 3\n").expect("good");
        assert_eq!(*read.samples, [(0.25, DVec3::new(3.0, 4.0, 0.0)), (0.5, DVec3::new(1.0, 2.0, 0.0))]);
        assert!(!read.has_z && parse(b"time,x,y,z\n0,1,2,3\n").expect("good").has_z);
    }

    #[test]
    fn other_tables_are_told_apart() {
        for (text, expected) in [
            ("", "has no columns; expected time, x and y"),
            ("t,x,y\n0,0,0\n", "has the columns \"t\", \"x\" and \"y\"; expected time, x and y, and z in space"),
            ("time;x;y\n0;0,5;0\n", "separates its columns with semicolons; expected commas"),
            ("time,x,y\n", "has no points"),
            ("time,x,y\n0,1,2\n0.1,one,2\n", "has \"one\" as `x` in line 3; expected a number"),
            ("time,x,y\n0,1,inf\n", "has \"inf\" as `y` in line 2"),
            ("time,x,y\n0,1\n", "is no table of comma-separated values"),
            ("time,x,y\n0,1,\n", "has \"\" as `y` in line 2"),
        ] {
            let (message, _) = parse(text.as_bytes()).expect_err(text);
            assert!(message.contains(expected), "{message}");
        }
    }
}
