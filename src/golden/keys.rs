//! Keys of scenes and their values, and the keys that changed.

use serde::Serialize;
#[cfg(feature = "render")]
use std::collections::BTreeMap;
use std::fmt;

/// A key of a scene file, by its path, such as `run[0].model.stiffness`, and its value.
pub(super) type Key = (String, String);

/// A key whose value changed; `None` where the scene does not have it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct ChangedKey {
    /// Its path, such as `run[0].model.stiffness`.
    pub(crate) key: String,
    pub(crate) before: Option<String>,
    pub(crate) after: Option<String>,
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
    let [old, new]: [BTreeMap<_, _>; 2] = [before, after].map(|keys| keys.iter().cloned().collect());
    let gone = before.iter().filter(|(path, _)| !new.contains_key(path));
    let all = after.iter().chain(gone).map(|(path, _)| path);
    let all =
        all.map(|path| ChangedKey { key: path.clone(), before: old.get(path).cloned(), after: new.get(path).cloned() });
    all.filter(|key| key.before != key.after).collect()
}
