//! Files in the folder of a scene, such as bodies and fonts.

use super::words::{nearest, size};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// A message about a file, and the remedy.
pub(crate) type Wrong = (String, Option<String>);

/// The bytes of a file, at most `longest`. A file with one of the `endings` is suggested for a missing one. Messages
/// call the file `what` and end with `expected`.
pub(crate) fn bytes(path: &Path, endings: &[&str], longest: u64, what: &str, expected: &str) -> Result<Vec<u8>, Wrong> {
    if !path.exists() {
        return Err(missing(path, endings));
    }
    // Reading a pipe could block for ever.
    if !path.is_file() {
        let kind = if path.is_dir() { "a folder" } else { "not a regular file" };
        return Err((format!("is {kind}; {expected}"), None));
    }
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(longest.saturating_add(1)).read_to_end(&mut bytes));
    read.map_err(|error| (format!("cannot be read: {error}"), None))?;
    match bytes.len() as u64 > longest {
        true => Err((format!("is larger than {}, the most that {what} may have", size(longest.into())), None)),
        false => Ok(bytes),
    }
}

/// The ending of a file in small letters; empty if it has none.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// The name of a file without its folder.
pub(crate) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The paths of all files in a folder.
///
/// # Errors
/// The folder cannot be read.
pub(crate) fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path())).collect()
}

/// The files in a folder whose names have a number between `before` and `after`, in the order of their numbers. `after` may be in
/// capital letters or not. Other words may stand before the number, the same in all names, and a bracket may close behind it, as in
/// `frame (7).png`. A minus before it is the sign of the number if another of the files has the number 0 without it.
///
/// # Errors
/// The folder cannot be read, or has several such sequences, or the numbers are not whole.
pub(crate) fn numbered(folder: &Path, before: &str, after: &str) -> Result<Vec<(i64, PathBuf)>, Wrong> {
    let split = |path: PathBuf| {
        let inner = path.file_name()?.to_str()?.strip_prefix(before)?;
        let (inner, end) = inner.split_at_checked(inner.len().checked_sub(after.len())?)?;
        if !end.eq_ignore_ascii_case(after) {
            return None;
        }
        let inner = inner.strip_suffix(')').unwrap_or(inner);
        let stem = inner.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned();
        Some((stem.clone(), inner[stem.len()..].parse::<i64>().ok()?, path))
    };
    let all = entries(folder)
        .map_err(|error| (format!("cannot be read: {error} (looked for {})", folder.display()), None))?;
    let mut found: Vec<_> = all.into_iter().filter_map(split).collect();
    let end = |(stem, _, path): &&(String, i64, PathBuf)| {
        let digits = name_of(path).len().checked_sub(before.len() + stem.len() + after.len());
        is_fraction(&format!("{before}{stem}"), digits.unwrap_or_default())
    };
    if let Some((.., path)) = found.iter().find(end) {
        let message = format!("has numbers that are not whole, such as that of {}", name_of(path));
        return Err((message, Some("number the files in their order".to_owned())));
    }
    let middle = found.iter().filter(|(_, number, _)| *number == 0).map(|(stem, ..)| stem).min().cloned();
    for (stem, number, _) in &mut found {
        if middle.as_ref().is_some_and(|middle| stem.strip_suffix('-') == Some(middle)) {
            stem.pop();
            *number = -*number;
        }
    }
    found.sort_by(|one, other| (one.1, &one.2).cmp(&(other.1, &other.2)));
    if let Some(pair) = found.windows(2).find(|pair| pair[0].0 != pair[1].0) {
        let [one, other] = [&pair[0].0, &pair[1].0].map(|stem| format!("{before}{stem}…"));
        return Err((
            format!("has several sequences, {} and {}; expected one", one.clone().min(other.clone()), one.max(other)),
            None,
        ));
    }
    if let Some(pair) = found.windows(2).find(|pair| pair[0].1 == pair[1].1) {
        let [one, other] = [&pair[0].2, &pair[1].2].map(|path| name_of(path));
        return Err((format!("has two files of one number, {one} and {other}; expected one"), None));
    }
    Ok(found.into_iter().map(|(_, number, path)| (number, path)).collect())
}

/// Whether some digits behind the rest of a name are the last ones of a number that is not whole: `0.25`, `0,5`, `1p5`, `1e-3`. Frames of a
/// version have any number of them, `v2.8`, and others four or more.
fn is_fraction(head: &str, digits: usize) -> bool {
    let is_digit = |c: char| c.is_ascii_digit();
    let Some(whole) = head.trim_end_matches('-').strip_suffix(['.', ',', 'p', 'e']) else { return false };
    let before = whole.trim_end_matches(is_digit);
    digits < 4 && before.len() < whole.len() && !before.ends_with(['v', 'V'])
}

/// The message for a missing file. One with one of the `endings` is suggested.
pub(crate) fn missing(path: &Path, endings: &[&str]) -> Wrong {
    let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let similar = || similar(path, endings).map(|near| format!("did you mean {near:?}?"));
    (format!("is not there (looked for {})", full.display()), backslash(path).or_else(similar))
}

/// The remedy for a missing path whose folders are separated as on Windows.
pub(crate) fn backslash(path: &Path) -> Option<String> {
    let has_some = !std::path::is_separator('\\') && path.to_string_lossy().contains('\\');
    has_some.then(|| "write / between folders, not \\, which is a part of a name here".to_owned())
}

/// The file in the folder of a missing one with the most similar name and one of the `endings`.
pub(crate) fn similar(path: &Path, endings: &[&str]) -> Option<String> {
    let stem = |name: &Path| name.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = fs::read_dir(folder).ok()?.flatten().take(10_000);
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let has_ending = |name: &String| endings.contains(&&*ending(Path::new(name)));
    let mut similar: Vec<(String, String)> =
        names.filter(has_ending).filter_map(|name| Some((stem(Path::new(&name))?, name))).collect();
    similar.sort();
    let stems: Vec<&str> = similar.iter().map(|(stem, _)| stem.as_str()).collect();
    let near = nearest(&stem(path)?, &stems)?;
    Some(similar[stems.iter().position(|&stem| stem == near)?].1.clone())
}

/// The files with the name of a missing one, in order, from the folders beside it, or if its folder is missing too,
/// from the folders beside that. A name without an ending gets `ending`.
pub(crate) fn in_folders(path: &Path, ending: &str) -> Vec<PathBuf> {
    let Some(name) = path.file_name() else { return Vec::new() };
    let name = if path.extension().is_none() { Path::new(name).with_extension(ending) } else { name.into() };
    let is_there = |folder: &&Path| folder.as_os_str().is_empty() || folder.is_dir();
    let Some(folder) = path.ancestors().skip(1).take(2).find(is_there) else { return Vec::new() };
    let seen = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = fs::read_dir(seen).into_iter().flatten().flatten().take(10_000);
    let mut found: Vec<_> = entries.map(|entry| folder.join(entry.file_name()).join(&name)).collect();
    found.retain(|file| file.is_file());
    found.sort();
    found
}
