//! What all plots have in common: the width of the paper, legend, marks, title and note.

use super::html::escape;

/// Width of a plot's view box; the page scales it.
pub(super) const WIDTH: f64 = 440.0;
/// Where the plot's own area begins and ends on the paper.
pub(super) const LEFT: f64 = 86.0;
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
fn legend(keys: &[Key<'_>]) -> String {
    let item =
        |key: &Key<'_>| format!("<li><i class=\"key {}\"></i>{}</li>", key.class, escape(key.name));
    format!("<ul class=\"legend\">{}</ul>\n", keys.iter().map(item).collect::<String>())
}

/// A drawing, before it is part of a page or a file of its own.
#[derive(Clone, Debug, Default)]
pub(super) struct Drawing<'a> {
    /// What is shown.
    pub(super) title: &'a str,
    /// For readers who cannot see it.
    pub(super) description: String,
    /// What tells lines apart; empty where there is nothing to tell.
    pub(super) keys: Vec<Key<'a>>,
    /// Width and height of the view box.
    pub(super) size: [f64; 2],
    /// The elements.
    pub(super) content: String,
    /// Attributes that the page's script reads values from, with a space before each.
    pub(super) data: String,
    /// A sentence below it.
    pub(super) note: &'a str,
}

impl Drawing<'_> {
    /// The drawing within a page: title, legend, an SVG, note.
    pub(super) fn html(&self) -> String {
        let legend = if self.keys.is_empty() { String::new() } else { legend(&self.keys) };
        let [width, height] = self.size;
        let svg = format!(
            "<svg class=\"plot\" role=\"img\" viewBox=\"0 0 {width:.0} {height:.0}\"{} \
             xmlns=\"http://www.w3.org/2000/svg\">\n<title>{}</title>\n<desc>{}</desc>\n{}</svg>\n",
            self.data,
            escape(self.title),
            escape(&self.description),
            self.content
        );
        figure(self.title, &(legend + &svg), self.note)
    }
}

/// A drawing with its title above and its note below.
pub(super) fn figure(title: &str, drawing: &str, note: &str) -> String {
    let note = match note {
        "" => String::new(),
        note => format!("<p class=\"note\">{}</p>\n", escape(note)),
    };
    format!("<figure>\n<figcaption>{}</figcaption>\n{drawing}{note}</figure>\n", escape(title))
}
