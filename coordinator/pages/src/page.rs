//! The page: head, style and sections, as HTML that is also well-formed XML.

use super::bars::Bars;
use super::canvas::figure;
use super::html::{PLOT_STYLE, escape};
use super::lanes::Lanes;
use super::map::Heatmap;
use super::plot::Figure;
use super::table::Table;
use std::fmt::{Display, Formatter, Result};

/// Style sheet of the page.
const STYLE: &str = include_str!("style.css");
/// Script that reads values from the drawings; the page is complete without the script.
const SCRIPT: &str = include_str!("page.js");

/// Content security policy: a browser may load only resources embedded in the page.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:";

/// Addition to the policy for a page that requests its contents from the server it came from.
const REQUESTS: &str = "; connect-src 'self'";

/// Additions to a page that is more than a report.
#[derive(Clone, Copy, Debug, Default)]
pub struct Addition<'a> {
    /// HTML above the sections.
    pub body: &'a str,
    /// Style sheet.
    pub style: &'a str,
    /// Script, run after that of the page.
    pub script: &'a str,
    /// Whether the script may send requests to the server of the page.
    pub requests: bool,
}

/// One prominent figure of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Headline {
    /// Name of the figure.
    pub name: String,
    /// Number and unit.
    pub value: String,
    /// Additional text in small print.
    pub more: String,
}

/// A part of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// Large figures in a row.
    Headlines(Vec<Headline>),
    /// A plot of lines.
    Figure(Figure),
    /// A map of colours over a plane.
    Heatmap(Heatmap),
    /// Work of the processes over time.
    Lanes(Lanes),
    /// A bar chart.
    Bars(Bars),
    /// A table.
    Table(Table),
    /// A small titled table among the drawings.
    Card(String, Table),
    /// Active effects, each with its reason and law.
    Effects(Vec<(String, String)>),
    /// Verbatim text with a title.
    Verbatim(String, String),
    /// A table folded under a title.
    Folded(String, Table),
}

impl Block {
    /// Returns whether the block is a drawing; drawings stand side by side where space allows.
    fn is_drawing(&self) -> bool {
        matches!(
            self,
            Self::Figure(_) | Self::Heatmap(_) | Self::Lanes(_) | Self::Bars(_) | Self::Card(..)
        )
    }

    fn html(&self) -> String {
        match self {
            Self::Text(text) => format!("<p>{}</p>\n", escape(text)),
            Self::Headlines(all) => headlines(all),
            Self::Figure(plot) => plot.html(),
            Self::Heatmap(map) => map.html(),
            Self::Lanes(lanes) => lanes.html(),
            Self::Bars(bars) => bars.html(),
            Self::Table(table) => table.html(),
            Self::Card(title, table) => figure(title, &table.html(), ""),
            Self::Effects(all) => effects(all),
            Self::Verbatim(title, text) => {
                format!("<h3>{}</h3>\n<pre tabindex=\"0\">{}</pre>\n", escape(title), escape(text))
            }
            Self::Folded(title, table) => format!(
                "<details><summary>{}</summary>\n{}</details>\n",
                escape(title),
                table.html()
            ),
        }
    }
}

fn headlines(all: &[Headline]) -> String {
    let one = |h: &Headline| {
        format!(
            "<div><dt>{}</dt><dd>{}<small>{}</small></dd></div>\n",
            escape(&h.name),
            escape(&h.value),
            escape(&h.more)
        )
    };
    format!("<dl class=\"headlines\">\n{}</dl>\n", all.iter().map(one).collect::<String>())
}

fn effects(all: &[(String, String)]) -> String {
    let one = |(name, what): &(String, String)| {
        format!(
            "<li><b>on</b> <span>{}</span> <small>{}</small></li>\n",
            escape(name),
            escape(what)
        )
    };
    format!("<ul class=\"effects\">\n{}</ul>\n", all.iter().map(one).collect::<String>())
}

/// A heading and its blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The heading.
    pub title: String,
    /// Blocks under the heading.
    pub blocks: Vec<Block>,
}

impl Section {
    /// Returns a section; `None` if it would be empty.
    #[must_use]
    pub fn of(title: &str, blocks: Vec<Block>) -> Option<Self> {
        (!blocks.is_empty()).then(|| Self { title: title.to_owned(), blocks })
    }

    /// Renders the section as HTML.
    #[must_use]
    pub fn html(&self) -> String {
        let (title, blocks) = (escape(&self.title), html(&self.blocks));
        format!("<section>\n<h2>{title}</h2>\n{blocks}</section>\n")
    }
}

/// Renders blocks as HTML, with drawings in a grid.
#[must_use]
pub fn html(blocks: &[Block]) -> String {
    let mut out = String::new();
    for group in blocks.chunk_by(|a, b| a.is_drawing() == b.is_drawing()) {
        let inner: String = group.iter().map(Block::html).collect();
        match group[0].is_drawing() {
            true => {
                let all_maps = group.iter().all(|block| matches!(block, Block::Heatmap(_)));
                let class = if all_maps { "plots maps" } else { "plots" };
                out += &format!("<div class=\"{class}\">\n{inner}</div>\n");
            }
            false => out += &inner,
        }
    }
    out
}

/// Outcome of a run, which sets the colour of the status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunStatus {
    /// The run finished.
    Good,
    /// The run failed.
    Bad,
    /// The end of the run is missing.
    Open,
}

/// A complete page.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Name of the case.
    pub name: String,
    /// Title of the case.
    pub title: String,
    /// Status, a single word.
    pub status: String,
    /// Outcome.
    pub mood: RunStatus,
    /// Reason for the status.
    pub reason: String,
    /// Sections, from top to bottom.
    pub sections: Vec<Section>,
}

impl Display for Page {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_str(&self.with(&Addition::default()))
    }
}

impl Page {
    /// Renders the page with an addition.
    #[must_use]
    pub fn with(&self, addition: &Addition<'_>) -> String {
        let policy = POLICY.to_owned() + if addition.requests { REQUESTS } else { "" };
        let window_title = escape(&self.window_title());
        let (Addition { body, style, script, .. }, head) = (addition, self.head());
        let sections: String = self.sections.iter().map(Section::html).collect();
        // The policy blocks all other requests, whatever the contents of the page. An embedded icon
        // keeps the browser from requesting one, and the CDATA marker keeps the page well-formed
        // XML.
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <meta name=\"color-scheme\" content=\"light dark\"/>\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\"/>\n\
             <link rel=\"icon\" href=\"data:,\"/>\n\
             <title>{window_title}</title>\n<style>\n{PLOT_STYLE}{STYLE}{style}</style>\n\
             </head>\n<body>\n<main>\n{head}{body}{sections}</main>\n\
             <script>//<![CDATA[\n{SCRIPT}{script}//]]></script>\n</body>\n</html>\n"
        )
    }

    /// Returns the title of the browser window: name and status.
    #[must_use]
    pub fn window_title(&self) -> String {
        format!("{} · {}", self.name, self.status)
    }

    /// Renders name, title and status of the run.
    #[must_use]
    pub fn head(&self) -> String {
        let mood = match self.mood {
            RunStatus::Good => "good",
            RunStatus::Bad => "bad",
            RunStatus::Open => "open",
        };
        let [name, title, status, reason] =
            [&self.name, &self.title, &self.status, &self.reason].map(|text| escape(text));
        let reason = quoted(&reason);
        format!(
            "<header>\n<h1>{name}</h1>\n<p class=\"title\">{title}</p>\n\
             <p class=\"status {mood}\"><b>{status}</b> {reason}</p>\n</header>\n"
        )
    }
}

/// Marks text between two backticks as code.
fn quoted(escaped: &str) -> String {
    let mut parts = escaped.split('`');
    let mut out = parts.next().unwrap_or_default().to_owned();
    while let Some(code) = parts.next() {
        match parts.next() {
            Some(after) => out += &format!("<code>{code}</code>{after}"),
            None => out += &format!("`{code}"),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_is_marked_and_a_lone_backtick_stays() {
        assert_eq!(quoted("`a` and `b` or `c"), "<code>a</code> and <code>b</code> or `c");
        assert_eq!(quoted("none"), "none");
    }
}
