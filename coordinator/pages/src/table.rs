//! Tables of text and numbers.

use super::html::escape;

/// A table with a heading; the first column names the row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Headings of the columns.
    pub head: Vec<String>,
    /// Rows, each as long as the heading.
    pub rows: Vec<Vec<String>>,
    /// Index of the first column with numbers, which are aligned to the right.
    pub figures_from: usize,
}

impl Table {
    /// Returns a table without rows, with numbers from column `figures_from` onwards.
    #[must_use]
    pub fn new<const N: usize>(head: [&str; N], figures_from: usize) -> Self {
        Self { head: head.map(str::to_owned).to_vec(), rows: Vec::new(), figures_from }
    }

    /// Adds a row.
    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.to_vec());
    }

    /// Renders the table as HTML, with a scroll bar if wider than the page.
    #[must_use]
    pub fn html(&self) -> String {
        let class = |n: usize| if n >= self.figures_from { " class=\"figure\"" } else { "" };
        let head = self.head.iter().enumerate();
        let head =
            head.map(|(n, text)| format!("<th scope=\"col\"{}>{}</th>", class(n), escape(text)));
        let cell = |(n, text): (usize, &String)| match n {
            0 => format!("<th scope=\"row\">{}</th>", escape(text)),
            _ => format!("<td{}>{}</td>", class(n), escape(text)),
        };
        let row = |row: &Vec<String>| {
            format!("<tr>{}</tr>\n", row.iter().enumerate().map(cell).collect::<String>())
        };
        format!(
            "<div class=\"wide\"><table>\n<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody>\n</table></div>\n",
            head.collect::<String>(),
            self.rows.iter().map(row).collect::<String>()
        )
    }

    /// Renders the table in Markdown, without a newline after the last row.
    #[must_use]
    pub fn markdown(&self) -> String {
        let plain = |cell: &String| cell.replace('|', "\\|").replace('\n', " ");
        let line = |cells: &[String]| {
            format!("| {} |\n", cells.iter().map(plain).collect::<Vec<_>>().join(" | "))
        };
        let rule = |n: usize| if n < self.figures_from { "---" } else { "---:" }.to_owned();
        let rule: Vec<String> = (0..self.head.len()).map(rule).collect();
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        line(&self.head) + &line(&rule) + rows.trim_end()
    }
}
