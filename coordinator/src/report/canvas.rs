//! What all plots have in common: the width of the paper, legend, marks, title and note.

use super::html::escape;

/// Width of every plot's view box; the page scales it.
pub(super) const WIDTH: f64 = 440.0;
/// Where the plot's own area begins and ends on the paper.
pub(super) const LEFT: f64 = 76.0;
pub(super) const RIGHT: f64 = 426.0;
/// Number of line colours of the page.
pub(super) const COLOURS: usize = 6;

/// A hollow square on its corner round a place.
pub(super) fn mark([x, y]: [f64; 2]) -> String {
    let [left, right, top, bottom] = [x - 5.0, x + 5.0, y - 5.0, y + 5.0];
    format!(
        "<path class=\"mark\" d=\"M{left:.2} {y:.2}L{x:.2} {top:.2}L{right:.2} {y:.2}L{x:.2} \
         {bottom:.2}Z\"/>\n"
    )
}

/// One entry of a legend.
#[derive(Clone, Debug)]
pub(super) struct Key<'a> {
    /// Class of the style sheet.
    pub(super) class: String,
    /// What it is.
    pub(super) name: &'a str,
}

/// The names of lines, with their colours.
pub(super) fn legend(keys: &[Key<'_>]) -> String {
    let item =
        |key: &Key<'_>| format!("<li><i class=\"key {}\"></i>{}</li>", key.class, escape(key.name));
    format!("<ul class=\"legend\">{}</ul>\n", keys.iter().map(item).collect::<String>())
}

/// An SVG with a title and a description for readers who cannot see it.
pub(super) fn view(title: &str, description: &str, height: f64, content: &str) -> String {
    format!(
        "<svg class=\"plot\" role=\"img\" viewBox=\"0 0 {WIDTH} {height:.0}\" \
         xmlns=\"http://www.w3.org/2000/svg\">\n<title>{}</title>\n<desc>{}</desc>\n{content}</svg>\n",
        escape(title),
        escape(description)
    )
}

/// A drawing with its title above and its note below.
pub(super) fn figure(title: &str, drawing: &str, note: &str) -> String {
    let note = match note {
        "" => String::new(),
        note => format!("<p class=\"note\">{}</p>\n", escape(note)),
    };
    format!("<figure>\n<figcaption>{}</figcaption>\n{drawing}{note}</figure>\n", escape(title))
}
