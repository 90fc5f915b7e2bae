//! Parts common to all plots: size, legend, marks, title and note. A drawing is rendered within a
//! page or as a file of its own.

use super::html::{PLOT_STYLE, escape};
use run::format::sentence;
use std::fmt::Write as _;

/// Width of the view box; the page scales the drawing.
pub(super) const WIDTH: f64 = 440.0;
/// Left and right edge of the plotting area in the drawing.
pub(super) const LEFT: f64 = 86.0;
pub(super) const RIGHT: f64 = 426.0;
/// Number of line colours of the page.
pub(super) const COLOURS: usize = 6;
/// Margin around a drawing in a file of its own.
const MARGIN: f64 = 12.0;
/// Height of a line of the title or the legend.
const LINE: f64 = 21.0;
/// Mean width of a letter in a plot.
const LETTER: f64 = 8.4;
/// Mean width of a letter in the title, which is bold.
const TITLE_LETTER: f64 = 8.6;
/// Width of a legend sample and its spacing.
const KEY: f64 = 44.0;
/// Pixels per drawing unit at the natural size of the picture.
const SCALE: f64 = 1.35;

/// Draws a hollow diamond around a position.
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
    /// Class in the style sheet.
    pub(super) class: String,
    pub(super) name: &'a str,
}

/// Renders the legend as a list of names with colours.
fn legend_list(keys: &[Key<'_>]) -> String {
    let item =
        |key: &Key<'_>| format!("<li><i class=\"key {}\"></i>{}</li>", key.class, escape(key.name));
    format!("<ul class=\"legend\">{}</ul>\n", keys.iter().map(item).collect::<String>())
}

/// A drawing, before rendering within a page or as a file of its own.
#[derive(Clone, Debug, Default)]
pub(super) struct Drawing<'a> {
    pub(super) title: &'a str,
    /// Description for readers who cannot see the drawing.
    pub(super) description: String,
    /// Legend; may be empty.
    pub(super) keys: Vec<Key<'a>>,
    /// Width and height of the view box.
    pub(super) size: [f64; 2],
    /// SVG elements.
    pub(super) content: String,
    /// Attributes from which the script of the page reads values, each preceded by a space.
    pub(super) data: String,
    /// Note below the drawing.
    pub(super) note: &'a str,
}

impl Drawing<'_> {
    /// Renders the drawing within a page: title, legend, SVG and note.
    pub(super) fn html(&self) -> String {
        let legend = if self.keys.is_empty() { String::new() } else { legend_list(&self.keys) };
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

    /// Renders the drawing as an SVG file with style, title and legend.
    ///
    /// The file has an opaque background, so that it is readable on light and dark paper. It
    /// follows the reader's preference for light or dark where a browser passes that on to
    /// pictures.
    pub(super) fn standalone(&self) -> String {
        let (inner, [width, height]) = self.with_title();
        let [wide, high] = [width, height].map(|length| SCALE * length);
        format!(
            "<svg class=\"plot\" role=\"img\" width=\"{wide:.0}\" height=\"{high:.0}\" \
             viewBox=\"0 0 {width} {height:.0}\" xmlns=\"http://www.w3.org/2000/svg\">\n\
             <title>{}</title>\n<desc>{}</desc>\n<style>\n{PLOT_STYLE}</style>\n\
             <rect class=\"ground\" width=\"100%\" height=\"100%\" rx=\"8\"/>\n{inner}</svg>\n",
            escape(self.title),
            escape(&self.description),
        )
    }

    /// Title, legend and drawing from top to bottom, and the total width and height.
    pub(super) fn with_title(&self) -> (String, [f64; 2]) {
        let [width, height] = self.size;
        let mut svg = String::new();
        let mut y = MARGIN + 16.0;
        for line in wrapped(&sentence(self.title), width) {
            let text = escape(&line);
            let _ =
                writeln!(svg, "<text class=\"title\" x=\"{MARGIN}\" y=\"{y:.2}\">{text}</text>");
            y += LINE;
        }
        y = legend(&self.keys, width, &mut svg, y);
        let top = y - 8.0;
        let _ = write!(svg, "<g transform=\"translate(0 {top:.2})\">\n{}</g>\n", self.content);
        (svg, [width, top + height])
    }
}

/// Wraps a drawing in a figure, with its title above and its note below.
pub(super) fn figure(title: &str, drawing: &str, note: &str) -> String {
    let note = match note {
        "" => String::new(),
        note => format!("<p class=\"note\">{}</p>\n", escape(note)),
    };
    format!("<figure>\n<figcaption>{}</figcaption>\n{drawing}{note}</figure>\n", escape(title))
}

/// Draws the legend from `y` downwards and returns its lower end.
fn legend(keys: &[Key<'_>], wide: f64, svg: &mut String, mut y: f64) -> f64 {
    let mut x = MARGIN;
    for (n, key) in keys.iter().enumerate() {
        let width = KEY + LETTER * key.name.chars().count() as f64;
        if n > 0 && x + width > wide - MARGIN {
            (x, y) = (MARGIN, y + LINE);
        }
        let middle = y - 5.0;
        *svg += &sample(&key.class, [x, x + 24.0], middle);
        let (at, name) = (x + 31.0, escape(key.name));
        let _ = writeln!(svg, "<text class=\"label\" x=\"{at:.2}\" y=\"{y:.2}\">{name}</text>");
        x += width;
    }
    if keys.is_empty() { y } else { y + LINE }
}

/// Draws the legend sample of a class between two positions.
fn sample(class: &str, [left, right]: [f64; 2], y: f64) -> String {
    let line = format!("M{left:.2} {y:.2}H{right:.2}");
    match class {
        "mark" => mark([0.5 * (left + right), y]),
        class if class.starts_with("edge") => format!(
            "<path class=\"casing\" d=\"{line}\"/>\n<path class=\"edge {class}\" d=\"{line}\"/>\n"
        ),
        class => format!("<path class=\"line {class}\" d=\"{line}\"/>\n"),
    }
}

/// Breaks the title into lines as wide as the drawing.
fn wrapped(title: &str, width: f64) -> Vec<String> {
    let most = ((width - 2.0 * MARGIN) / TITLE_LETTER) as usize;
    let mut lines = vec![String::new()];
    for word in title.split(' ') {
        let line = lines.last_mut().expect("the list is never empty");
        if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > most {
            lines.push(word.to_owned());
            continue;
        }
        if !line.is_empty() {
            line.push(' ');
        }
        *line += word;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::super::canvas::WIDTH;
    use super::super::plot::Figure;
    use super::*;

    #[test]
    fn a_file_has_all_that_it_needs() {
        let line = vec![[0.0, 1.0], [1.0, 3.0]];
        let figure = Figure::new("a title", "x", "y").with("ours", line.clone());
        let svg = figure.with_marks("printed", line).standalone();
        for part in ["<style>", "class=\"ground\"", ">A title</text>", ">ours</text>"] {
            assert!(svg.contains(part), "`{part}` is missing in {svg}");
        }
        // Two in the plot, one in the legend.
        assert_eq!(svg.matches("class=\"mark\"").count(), 3);
        assert!(!svg.contains("href") && svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    }

    #[test]
    fn a_mark_of_the_legend_is_in_the_middle_of_its_sample() {
        assert_eq!(sample("mark", [10.0, 40.0], 7.0), mark([25.0, 7.0]));
    }

    #[test]
    fn a_long_title_takes_several_lines() {
        let title = "word ".repeat(30);
        let lines = wrapped(title.trim(), WIDTH);
        assert!(lines.len() > 1 && lines.iter().all(|line| line.len() <= 52), "{lines:?}");
        assert_eq!(lines.join(" "), title.trim());
    }
}
