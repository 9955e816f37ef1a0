//! Reading a scene from a file.

use super::error::SceneError;
use super::file::SceneFile;
#[cfg(feature = "render")]
use super::keys::extend;
use super::keys::{BodyLists, SceneKeys};
use super::limits::Limits;
use super::mesh::is_mesh;
use super::resolve::Typed;
use super::schema::SCHEMA;
use super::structure::Checked;
use super::{Mistake, Mistakes, Scene, structure, syntax};
use crate::reading::beside::{in_folders, similar};
use crate::reading::collector::{Collector, mistake};
use crate::reading::setting::{Setting, Wrong};
use crate::reading::source::Source;
#[cfg(feature = "render")]
use serde::Deserialize;
use serde_json::Value;
use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};
#[cfg(feature = "render")]
use toml::{Table, de::Deserializer};

impl Scene {
    /// Reads a scene from a file.
    ///
    /// # Errors
    /// The file gives no scene; see [`SceneError`]. All mistakes in it are reported.
    pub fn load(path: &Path, limits: &Limits) -> Result<Self, SceneError> {
        Self::load_with(path, &[], limits)
    }

    /// Reads a scene from a file, with other values of some keys, as `--set` of the program does.
    ///
    /// # Errors
    /// As [`Self::load`]. A mistake in a setting is reported like one in the file.
    pub fn load_with(path: &Path, settings: &[Setting], limits: &Limits) -> Result<Self, SceneError> {
        if is_mesh(path) && path.is_file() {
            return Err(SceneError::Mesh { path: path.to_owned() });
        }
        let text = text_of(path, limits, FIGURE)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let name = path.display().to_string();
        let scene = Self::read(Document { text: &text, name: &name, settings, lists: None }, folder, limits)?;
        Ok(Self { file: path.canonicalize().ok(), ..scene })
    }

    /// Reads a scene from a text. `name` is the name of the file in messages; its stem is the name of the scene. Files
    /// of bodies and fonts are searched in the current directory.
    ///
    /// # Errors
    /// The text is empty, not TOML, or not a scene. All mistakes in it are reported.
    ///
    /// ```
    /// use localshape::scene::{Limits, Scene};
    /// let text = "
    ///     time.duration = 3
    ///     body.lattice = { cells = [3, 3, 3], side = 0.1 }
    ///     [[run]]
    ///     name = 'Local shape'
    ///     model = { kind = 'shape-based', stiffness = 1e4 }
    /// ";
    /// let scene = Scene::parse(text, "cubes.toml", &Limits::default())?;
    /// assert_eq!((scene.name.as_str(), scene.bodies[0].body.len()), ("cubes", 64));
    ///
    /// let wrong = text.replace("side", "size");
    /// let error = Scene::parse(&wrong, "cubes.toml", &Limits::default()).unwrap_err();
    /// assert!(error.to_string().starts_with("cubes.toml:3:41: unknown key `size` in `body.lattice`"));
    /// # Ok::<(), localshape::scene::SceneError>(())
    /// ```
    pub fn parse(text: &str, name: &str, limits: &Limits) -> Result<Self, SceneError> {
        Self::read(Document { text, name, settings: &[], lists: None }, Path::new(""), limits)
    }

    /// A scene from the keys of a scene file in memory, with other values of some keys. Files that it names are searched in the current
    /// directory. Mistakes have the path of their key as place.
    ///
    /// ```
    /// use localshape::scene::{BodyLists, Limits, Scene, SceneKeys};
    /// let keys = localshape::toml::from_str(
    ///     "time.duration = 1
    ///     run = [{ name = 'One', model = { kind = 'shape-based', stiffness = 1e4 } }]
    ///     [body]",
    /// )?;
    /// let nodes = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(Into::into).to_vec();
    /// let triangle = BodyLists { nodes: Some(nodes), elements: Some(vec![vec![0, 1, 2]]), ..BodyLists::default() };
    /// let keys = SceneKeys::new("triangle", keys, vec![triangle]);
    /// assert_eq!(Scene::from_keys(&keys, &[], &Limits::default())?.bodies[0].body.len(), 3);
    /// let error = Scene::from_keys(&keys, &["run[0].model.stiffness=-1".parse()?], &Limits::default()).unwrap_err();
    /// assert_eq!(error.mistakes()[0].place, "run[0].model.stiffness");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The keys are not those of a scene. All mistakes are reported. A list in memory cannot be set.
    pub fn from_keys(keys: &SceneKeys, settings: &[Setting], limits: &Limits) -> Result<Self, SceneError> {
        let SceneKeys { name, text, lists } = keys;
        if let Some(setting) = keys.of_lists(settings) {
            let place = setting.key().to_owned();
            let message = format!("`{place}` is in memory or contains what is, and cannot be set");
            let help = Some("make a scene with another list".to_owned());
            let found = vec![Mistake { place, ..mistake(None, 0..0, &[], message, help) }];
            return Err(SceneError::Mistakes(Mistakes { file: name.clone(), found, total: 1 }));
        }
        Self::read(Document { text, name, settings, lists: Some(lists) }, Path::new(""), limits)
    }

    /// Reads a scene from a text. Files of bodies and fonts are searched in `folder`.
    pub(super) fn read(document: Document<'_>, folder: &Path, limits: &Limits) -> Result<Self, SceneError> {
        let name = stem(Path::new(document.name)).unwrap_or_else(|| "scene".into());
        checked(document, &SCHEMA, FIGURE, |checked, report| {
            let mut file = SceneFile::of(&checked, report);
            file.fill(document.lists.unwrap_or_default());
            let typed = Typed {
                file: &file,
                flawed: &checked.flawed,
                is_list: checked.parts.get("body").is_some_and(Value::is_array),
                folder,
                limits,
                report,
            };
            Ok(typed.resolve(&name))
        })
    }
}

/// A file and settings for it.
#[derive(Clone, Copy)]
pub(super) struct Document<'a> {
    /// Its text.
    pub(super) text: &'a str,
    /// Its name, for messages.
    pub(super) name: &'a str,
    /// Values that the command line sets in place of the file's.
    pub(super) settings: &'a [Setting],
    /// The lists of its bodies, if it is not a file but keys in memory.
    pub(super) lists: Option<&'a [BodyLists]>,
}

/// A file of another kind, recognised by any of these keys.
#[derive(Clone, Copy)]
pub(super) struct Other {
    pub(super) keys: &'static [&'static str],
    pub(super) message: &'static str,
}

/// Figure files passed as scenes, and scenes passed as figures.
const FIGURE: Other =
    Other { keys: &["sheet", "forces"], message: "this is a figure, not a scene; `localshape figure` draws it" };
pub(super) const SCENE: Other =
    Other { keys: &["body", "run"], message: "this is a scene, not a figure; `localshape render` draws it" };

/// Whether a file looks like a figure and not like a scene.
#[cfg(feature = "render")]
pub(crate) fn is_figure_file(path: &Path, limits: &Limits) -> bool {
    is_file_of(path, limits, FIGURE)
}

/// Whether a file exists and is of a kind.
fn is_file_of(path: &Path, limits: &Limits, kind: Other) -> bool {
    let is_of = |text: &str| {
        let (root, _) = DeTable::parse_recoverable(text.strip_prefix('\u{feff}').unwrap_or(text));
        kind.keys.iter().any(|key| root.get_ref().contains_key(*key))
    };
    read(path, limits).is_ok_and(|bytes| std::str::from_utf8(&bytes).is_ok_and(is_of))
}

/// Parses TOML, checks it against a schema and resolves it; all mistakes are reported together.
pub(super) fn checked<T>(
    document: Document<'_>,
    schema: &Value,
    other: Other,
    resolve: impl FnOnce(Checked, &Collector<'_>) -> Result<Option<T>, SceneError>,
) -> Result<T, SceneError> {
    let Document { text, name, settings, lists } = document;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let file = || name.to_owned();
    if lists.is_none() && text.lines().all(|line| line.trim_start().is_empty() || line.trim_start().starts_with('#')) {
        return Err(SceneError::Empty { file: file() });
    }
    let (root, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        return Err(SceneError::Syntax(syntax::mistakes(&Source::new(text), &errors, name)));
    }
    // Each setting follows the file as a line, so that every value has a place in one text.
    let mut whole = Cow::Borrowed(text);
    settings.iter().for_each(|setting| whole.to_mut().extend(["\n", OPTION, setting.text()]));
    let source = Source::with_settings(&whole, text.len());
    let (root, wrong) = set(root, settings, &whole, text.len());
    let report = match lists {
        Some(_) => Collector::of_code(root.get_ref()),
        None => Collector::new(&source, root.get_ref()),
    };
    if let Some(key) = other.keys.iter().find(|key| root.get_ref().contains_key(**key)) {
        report.to(key).wrong_key(other.message, None);
        return Err(SceneError::Mistakes(report.finish(name)));
    }
    let checked = structure::check(schema, root.get_ref(), &report);
    wrong.into_iter().for_each(|wrong| wrong.report(&report));
    match resolve(checked, &report)? {
        Some(meaning) if report.total() == 0 => Ok(meaning),
        _ => Err(SceneError::Mistakes(report.finish(name))),
    }
}

/// The keys of a scene in memory with settings, and its whole lists.
#[cfg(feature = "render")]
pub(crate) fn keys_in_memory(keys: &SceneKeys, settings: &[Setting]) -> Table {
    let mut table = keys_of(&keys.text, settings);
    extend(&mut table, &keys.lists, usize::MAX);
    table
}

/// The keys of a scene or figure file with settings; empty for a text with mistakes.
#[cfg(feature = "render")]
pub(crate) fn keys_of(text: &str, settings: &[Setting]) -> Table {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let (root, _) = DeTable::parse_recoverable(text);
    let mut whole = text.to_owned();
    settings.iter().for_each(|setting| whole.extend(["\n", OPTION, setting.text()]));
    let (root, _) = set(root, settings, &whole, text.len());
    Table::deserialize(Deserializer::from(root)).unwrap_or_default()
}

/// The option before a setting.
const OPTION: &str = "--set ";

/// A file with the values of settings in place of its own, and the mistakes in settings. The text of the settings
/// begins at a byte of the whole, after the file.
fn set<'t>(
    root: Spanned<DeTable<'t>>,
    settings: &[Setting],
    whole: &'t str,
    mut at: usize,
) -> (Spanned<DeTable<'t>>, Vec<Wrong>) {
    let span = root.span();
    let mut root = Spanned::new(span.clone(), DeValue::Table(root.into_inner()));
    let mut wrong = Vec::new();
    for setting in settings {
        let start = at + 1 + OPTION.len();
        at = start + setting.text().len();
        wrong.extend(setting.apply(&mut root, &whole[start..at], start).err());
    }
    let DeValue::Table(table) = root.into_inner() else { unreachable!("a key begins every setting") };
    (Spanned::new(span, table), wrong)
}

/// The text of a file that must not be of another kind. For a missing file, the message suggests one with this name in
/// a folder beside, or one with a similar name.
pub(super) fn text_of(path: &Path, limits: &Limits, other: Other) -> Result<String, SceneError> {
    let bytes = read(path, limits).map_err(|error| match error {
        SceneError::Missing { path, .. } => {
            let in_folder = in_folders(&path, "toml").into_iter().find(|found| !is_file_of(found, limits, other));
            let nearest = in_folder.or_else(|| similar(&path, &["toml"]).map(|name| path.with_file_name(name)));
            SceneError::Missing { path, nearest }
        }
        error => error,
    })?;
    if path.file_name().is_some_and(|name| stem(Path::new(name)).is_none()) {
        return Err(SceneError::Nameless { path: path.into() });
    }
    Ok(as_text(&bytes, &path.display().to_string())?.to_owned())
}

/// The name of a scene from its file's name; `None` if no folder could have it.
pub(super) fn stem(file: &Path) -> Option<String> {
    let stem = file.file_stem()?.to_string_lossy().into_owned();
    (!["", ".", ".."].contains(&stem.trim())).then_some(stem)
}

/// The bytes of a file.
fn read(path: &Path, limits: &Limits) -> Result<Vec<u8>, SceneError> {
    if path.is_dir() {
        return Err(SceneError::Folder { path: path.into(), scenes: scenes_in(path) });
    }
    let mut bytes = Vec::new();
    // One byte more than allowed is read, to detect files that are too long.
    let outcome = File::open(path).and_then(|file| file.take(limits.file.saturating_add(1)).read_to_end(&mut bytes));
    match outcome {
        Ok(_) if bytes.len() as u64 > limits.file => Err(SceneError::TooLong { path: path.into(), limit: limits.file }),
        Ok(_) => Ok(bytes),
        // A slash behind the name of a file asks for a folder.
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            Err(SceneError::Missing { path: path.into(), nearest: None })
        }
        Err(source) => Err(SceneError::Unreadable { path: path.into(), source }),
    }
}

/// The bytes as text, or the kind of file that they seem to be.
fn as_text<'b>(bytes: &'b [u8], file: &str) -> Result<&'b str, SceneError> {
    let known = [
        (&b"\x89PNG"[..], "this is a PNG picture"),
        (b"PK\x03\x04", "this is a ZIP archive, as .npz files are"),
        (b"\x93NUMPY", "this is a NumPy array"),
        (b"\xff\xfe", "this text is in UTF-16"),
        (b"\xfe\xff", "this text is in UTF-16"),
    ];
    let not_text = |offset, what: &str| Err(SceneError::NotText { file: file.into(), offset, what: what.into() });
    if let Some((_, what)) = known.iter().find(|(start, _)| bytes.starts_with(start)) {
        return not_text(0, what);
    }
    match (std::str::from_utf8(bytes), bytes.iter().position(|&byte| byte == 0)) {
        (Ok(_), Some(offset)) => not_text(offset, "this is not text: it contains a zero byte"),
        (Ok(text), None) => Ok(text),
        (Err(error), zero) => {
            let offset = error.valid_up_to().min(zero.unwrap_or(usize::MAX));
            let byte = bytes.get(offset).copied().unwrap_or_default();
            not_text(offset, &format!("this is not text: the byte 0x{byte:02x} is not UTF-8 here"))
        }
    }
}

/// The scene files in a folder, in order.
fn scenes_in(folder: &Path) -> Vec<PathBuf> {
    // Folders of results can have very many files; folders of scenes have few.
    #[expect(clippy::disallowed_methods, reason = "a scene names files beside it")]
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().take(10_000).map(|entry| entry.path());
    let mut scenes: Vec<_> = entries.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    scenes.sort();
    scenes
}
