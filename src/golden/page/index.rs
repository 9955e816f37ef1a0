//! The page of several comparisons: a row for each, with a link to its own page. The file `index.html` has its text and style.

use super::template::filled_page;
use crate::reading::words::escaped;

const TEMPLATE: &str = include_str!("index.html");

/// A comparison that has a page.
pub struct Listed {
    /// The name of the scene or test.
    pub title: String,
    /// The address of its page, relative to the page of all.
    pub page: String,
    /// Whether everything is as expected.
    pub passes: bool,
    /// The overall verdict.
    pub verdict: String,
    /// The findings, line by line.
    pub words: String,
}

/// The whole HTML document, those first that are not as expected.
pub fn index(all: &[Listed]) -> String {
    let (good, bad): (Vec<&Listed>, Vec<&Listed>) = all.iter().partition(|one| one.passes);
    let outcome = match (all.len(), bad.len()) {
        (0, _) => "nothing was compared".to_owned(),
        (all, 0) => format!("{all} as expected"),
        (all, bad) => format!("{bad} of {all} not as expected"),
    };
    let rows: String = bad.iter().chain(&good).map(|one| one.row()).collect();
    let passed = if bad.is_empty() { "passed" } else { "failed" };
    filled_page(TEMPLATE, &["style"], &[("passed", passed), ("outcome", &outcome), ("rows", &rows)])
}

impl Listed {
    fn row(&self) -> String {
        let Self { title, page, passes, verdict, words } = self;
        let class = if *passes { "passed" } else { "failed" };
        let [title, page, verdict] = [title, page, verdict].map(|text| escaped(text));
        // Of those as expected, one line tells all.
        let lines: Vec<_> = words.lines().take(if *passes { 1 } else { usize::MAX }).map(escaped).collect();
        format!(
            "<tr class=\"{class}\"><td><a href=\"{page}\">{title}</a></td><td>{verdict}</td><td>{}</td></tr>\n",
            lines.join("<br>")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_not_as_expected_come_first() {
        let listed = |title: &str, passes, verdict: &str| Listed {
            title: title.to_owned(),
            page: format!("{title}.html"),
            passes,
            verdict: verdict.to_owned(),
            words: "1 < 2\nsecond".to_owned(),
        };
        let html = index(&[listed("sound", true, "identical"), listed("wrong & \"bad\"", false, "state moved")]);
        assert!(html.contains("1 of 2 not as expected") && html.contains("class=\"failed\""), "{html}");
        let row = "<tr class=\"failed\"><td><a href=\"wrong &amp; &quot;bad&quot;.html\">wrong &amp; &quot;bad&quot;</a></td>\
                   <td>state moved</td><td>1 &lt; 2<br>second</td></tr>\n<tr class=\"passed\"><td><a href=\"sound.html\">";
        assert!(html.contains(row) && html.matches("<br>second").count() == 1, "{html}");
        assert!(index(&[]).contains("nothing was compared"));
    }
}
