//! Templates of pages, and what browsers need to trust them.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

/// A page with its parts, and the policy that lets browsers run only the scripts and styles of the template, between these `tags`,
/// whatever text files and runs have for names.
pub(super) fn filled_page(template: &str, tags: &[&str], parts: &[(&str, &str)]) -> String {
    // Browsers hash the text between the tags with LF line ends.
    let page = template.replace("\r\n", "\n");
    let source = |tag: &&str| {
        let rest = page.split(&format!("<{tag}>")).nth(1).expect("the page has one");
        let inside = rest.split(&format!("</{tag}>")).next().unwrap_or_default();
        format!("{tag}-src 'sha256-{}'; ", BASE64_STANDARD.encode(Sha256::digest(inside.as_bytes())))
    };
    let sources: String = tags.iter().map(source).collect();
    let policy = format!("default-src 'none'; img-src data:; {sources}base-uri 'none'; form-action 'none'");
    filled(&page, &[&[("policy", &*policy)], parts].concat())
}

/// A template with its `{{names}}` replaced. Inserted text is not searched for names.
fn filled(template: &str, parts: &[(&str, &str)]) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inserted_text_is_not_searched_for_names() {
        assert_eq!(filled("a {{one}} {{two}} }}", &[("one", "{{two}}"), ("two", "{{")]), "a {{two}} {{ }}");
    }
}
