//! Keys of scenes and their values, and the keys that changed.

use serde::Serialize;
#[cfg(feature = "render")]
use std::collections::BTreeMap;
use std::fmt;

/// A key of a scene file and its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Key {
    /// Its path, such as `run[0].model.stiffness`.
    pub(super) path: String,
    pub(super) value: String,
}

/// A key whose value changed; `None` where the scene does not have it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct ChangedKey {
    /// Its path, such as `run[0].model.stiffness`.
    pub(crate) key: String,
    pub(crate) before: Option<String>,
    pub(crate) after: Option<String>,
}

impl Key {
    /// Reads a line of a record.
    pub(super) fn parse(line: &str) -> Self {
        let (path, value) = line.split_once(" = ").unwrap_or((line, ""));
        Self { path: path.to_owned(), value: value.to_owned() }
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}", self.path, self.value)
    }
}

impl fmt::Display for ChangedKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = |value: &Option<String>| value.clone().unwrap_or_else(|| "not given".to_owned());
        write!(f, "{}: {} → {}", self.key, value(&self.before), value(&self.after))
    }
}

/// The keys that changed.
#[cfg(feature = "render")]
pub(super) fn changed(before: &[Key], after: &[Key]) -> Vec<ChangedKey> {
    let [old, new] = [before, after]
        .map(|keys| keys.iter().map(|key| (key.path.as_str(), key.value.clone())).collect::<BTreeMap<_, _>>());
    let gone = before.iter().filter(|key| !new.contains_key(key.path.as_str()));
    let all = after.iter().chain(gone).map(|key| key.path.as_str());
    let all =
        all.map(|key| ChangedKey { key: key.to_owned(), before: old.get(key).cloned(), after: new.get(key).cloned() });
    all.filter(|key| key.before != key.after).collect()
}
