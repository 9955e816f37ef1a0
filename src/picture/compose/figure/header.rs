//! The title and the caption of a figure without columns.

use crate::picture::caption::Writer;
use crate::picture::layout::tree::{self, Node};
use crate::picture::layout::{Part, Wanted, baselines, page};
use crate::scene::figure::Figure;

/// Writes title and caption. Returns the last baseline (px), 0 if nothing is written.
pub(super) fn write(writer: &mut Writer<'_>, figure: &Figure) -> f64 {
    let (scale, [width, height]) = (writer.scale, figure.size.map(f64::from));
    let (margin, mut last) = (scale.margin(), 0.0);
    let titles = writer.titles(scale, [&figure.title, &figure.caption], width - 2.0 * margin);
    let wanted = Wanted { titles: titles.each_ref().map(Vec::len), is_figure: true, ..Wanted::default() };
    let rest = Node::new(Part::Row, f64::INFINITY).least(0.5 * height);
    let page = tree::column(&page(scale, wanted, std::iter::once(rest)), [0.0, 0.0, width, height]);
    for (part, lines) in [Part::Title, Part::Caption].into_iter().zip(&titles) {
        writer.lines(&page, part, scale, lines, margin);
        last = baselines(&page, part, scale).last().unwrap_or(last);
    }
    last
}
