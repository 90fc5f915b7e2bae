//! Drawings as files of their own: an SVG with style, title and legend in it.
//!
//! The file has a ground of its own, so that it can be read on white and on dark paper alike, and
//! follows the reader's preference for light or dark where browsers pass that on to pictures.

use super::canvas::{Drawing, Key, mark};
use super::html::{PLOT_STYLE, escape};
use run::format::sentence;
use std::fmt::Write as _;

/// Margin round the drawing.
const MARGIN: f64 = 12.0;
/// Height of a line of the title or the legend.
const LINE: f64 = 21.0;
/// Mean width of a letter of the plots' font.
const LETTER: f64 = 8.4;
/// And of the title's, which is bold.
const TITLE_LETTER: f64 = 8.6;
/// Width of a key and the space round it.
const KEY: f64 = 44.0;
/// Drawing units a pixel of the picture's natural size.
const SCALE: f64 = 1.35;

/// The file's content.
pub(super) fn svg(of: &Drawing<'_>) -> String {
    let (inner, [width, height]) = whole(of);
    let [wide, high] = [width, height].map(|length| SCALE * length);
    format!(
        "<svg class=\"plot\" role=\"img\" width=\"{wide:.0}\" height=\"{high:.0}\" \
         viewBox=\"0 0 {width} {height:.0}\" xmlns=\"http://www.w3.org/2000/svg\">\n\
         <title>{}</title>\n<desc>{}</desc>\n<style>\n{PLOT_STYLE}</style>\n\
         <rect class=\"ground\" width=\"100%\" height=\"100%\" rx=\"8\"/>\n{inner}</svg>\n",
        escape(of.title),
        escape(&of.description),
    )
}

/// Title, legend and drawing one below the other; width and height of them all.
pub(super) fn whole(of: &Drawing<'_>) -> (String, [f64; 2]) {
    let [width, height] = of.size;
    let mut svg = String::new();
    let mut y = MARGIN + 16.0;
    for line in wrapped(&sentence(of.title), width) {
        let text = escape(&line);
        let _ = writeln!(svg, "<text class=\"title\" x=\"{MARGIN}\" y=\"{y:.2}\">{text}</text>");
        y += LINE;
    }
    y = legend(&of.keys, width, &mut svg, y);
    let top = y - 8.0;
    let _ = write!(svg, "<g transform=\"translate(0 {top:.2})\">\n{}</g>\n", of.content);
    (svg, [width, top + height])
}

/// Draws the legend from `y` on; where it ends.
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

/// What a class looks like, between two places.
fn sample(class: &str, [left, right]: [f64; 2], y: f64) -> String {
    let line = format!("M{left:.2} {y:.2}H{right:.2}");
    match class {
        "mark" => mark([left + 12.0, y]),
        class if class.starts_with("edge") => format!(
            "<path class=\"casing\" d=\"{line}\"/>\n<path class=\"edge {class}\" d=\"{line}\"/>\n"
        ),
        class => format!("<path class=\"line {class}\" d=\"{line}\"/>\n"),
    }
}

/// The title in lines as wide as the drawing.
fn wrapped(title: &str, width: f64) -> Vec<String> {
    let most = ((width - 2.0 * MARGIN) / TITLE_LETTER) as usize;
    let mut lines = vec![String::new()];
    for word in title.split(' ') {
        let line = lines.last_mut().expect("there is one from the start");
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
    fn a_long_title_takes_several_lines() {
        let title = "word ".repeat(30);
        let lines = wrapped(title.trim(), WIDTH);
        assert!(lines.len() > 1 && lines.iter().all(|line| line.len() <= 52), "{lines:?}");
        assert_eq!(lines.join(" "), title.trim());
    }
}
