//! Text within a page, and the colours of the page and its plots.

/// Colours of the page and its plots, and what plots need.
pub(super) const PLOT_STYLE: &str = include_str!("plot.css");

/// Text as it may stand in HTML and its attributes; control characters are shown, not sent.
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
