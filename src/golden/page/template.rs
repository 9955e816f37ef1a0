//! Templates of pages, and what browsers need to trust them.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

/// A template with its `{{names}}` replaced. Inserted text is not searched for names.
pub(super) fn filled(template: &str, parts: &[(&str, &str)]) -> String {
    let mut page = String::with_capacity(template.len() + parts.iter().map(|(_, part)| part.len()).sum::<usize>());
    let mut left = template;
    while let Some((before, (name, after))) =
        left.split_once("{{").and_then(|(before, rest)| Some((before, rest.split_once("}}")?)))
    {
        page.push_str(before);
        let part = parts.iter().find(|(known, _)| *known == name);
        page.push_str(part.unwrap_or_else(|| panic!("the page asks for {name}")).1);
        left = after;
    }
    page + left
}

/// The hash of an inline style or script for a content security policy.
pub(super) fn hash(text: &str) -> String {
    format!("sha256-{}", BASE64_STANDARD.encode(Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inserted_text_is_not_searched_for_names() {
        assert_eq!(filled("a {{one}} {{two}} }}", &[("one", "{{two}}"), ("two", "{{")]), "a {{two}} {{ }}");
    }
}
