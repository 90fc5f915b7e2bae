//! Escaping of text, and the style sheet shared by the page and its plots.

/// Style sheet of plots, including the colours of the page.
pub(super) const PLOT_STYLE: &str = include_str!("plot.css");

/// Escapes text for HTML and its attributes; control characters are replaced by a visible sign.
#[must_use]
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\n' | '\t' => out.push(c),
            c if c.is_control() => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_break_the_page_is_escaped() {
        assert_eq!(escape("<a & \"b\">\u{1b}\n"), "&lt;a &amp; &quot;b&quot;&gt;\u{fffd}\n");
    }
}
