//! A table of runs, defined once and rendered for the terminal, for a page and as CSV.
//!
//! A study defines the cell of each column for one row. By default a column appears on the terminal
//! and on the page; CSV contains the columns that have a CSV name.

use run::format;

const GAP: &str = "  ";

/// Content of one cell.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cell {
    /// Text for people.
    shown: String,
    /// Text for programs.
    raw: String,
}

impl Cell {
    /// A word, the same for people and programs.
    #[must_use]
    pub fn text(text: impl ToString) -> Self {
        Self { shown: text.to_string(), raw: text.to_string() }
    }

    /// A number, and its formatted text for people.
    #[must_use]
    pub fn number(value: impl ToString, shown: impl Into<String>) -> Self {
        Self { shown: shown.into(), raw: value.to_string() }
    }

    /// A number that may be missing; a missing number leaves the cell empty.
    #[must_use]
    pub fn optional(value: Option<&f64>, show: impl Fn(f64) -> String) -> Self {
        value.map(|value| Self::number(value, show(*value))).unwrap_or_default()
    }

    /// A time \[s\].
    #[must_use]
    pub fn seconds(value: f64) -> Self {
        Self::number(value, format::seconds(value))
    }

    /// A memory size \[byte\].
    #[must_use]
    pub fn bytes(value: u64) -> Self {
        Self::number(value, format::bytes(value))
    }
}

/// A run that failed and has no quantities.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Word shown in place of the first quantity.
    pub word: &'static str,
    /// Name of the run and the reason, shown below the table.
    pub remark: String,
}

/// A function of a row.
type Ask<'a, R, T> = Box<dyn Fn(&R) -> T + 'a>;

/// One column of a table.
pub struct Column<'a, R> {
    on_terminal: Option<String>,
    on_page: Option<String>,
    in_csv: Option<String>,
    /// Whether the column identifies the row. Such columns are shown even if the run failed.
    names: bool,
    /// Whether to align to the left.
    left: bool,
    /// Minimum width on the terminal.
    width: usize,
    cell: Ask<'a, R, Cell>,
}

impl<'a, R> Column<'a, R> {
    /// A quantity of each row, aligned to the right.
    pub fn quantity(head: impl Into<String>, cell: impl Fn(&R) -> Cell + 'a) -> Self {
        let head = head.into();
        Self {
            on_terminal: Some(head.clone()),
            on_page: Some(head),
            in_csv: None,
            names: false,
            left: false,
            width: 0,
            cell: Box::new(cell),
        }
    }

    /// Text about each row, aligned to the left.
    pub fn text(head: impl Into<String>, text: impl Fn(&R) -> String + 'a) -> Self {
        let column = Self::quantity(head, move |row| Cell::text(text(row)));
        Self { left: true, ..column }
    }

    /// A column that appears in CSV only.
    pub fn csv_only(name: impl Into<String>, cell: impl Fn(&R) -> String + 'a) -> Self {
        let column = Self::quantity("", move |row| Cell::text(cell(row)));
        column.not_on_terminal().not_on_page().csv(name)
    }

    /// Marks the column as identifying the row.
    #[must_use]
    pub fn naming(self) -> Self {
        Self { names: true, ..self }
    }

    /// Sets the heading on the page.
    #[must_use]
    pub fn on_page(self, head: impl Into<String>) -> Self {
        Self { on_page: Some(head.into()), ..self }
    }

    /// Hides the column on the page.
    #[must_use]
    pub fn not_on_page(self) -> Self {
        Self { on_page: None, ..self }
    }

    /// Hides the column on the terminal.
    #[must_use]
    pub fn not_on_terminal(self) -> Self {
        Self { on_terminal: None, ..self }
    }

    /// Includes the column in CSV under this name.
    #[must_use]
    pub fn csv(self, name: impl Into<String>) -> Self {
        Self { in_csv: Some(name.into()), ..self }
    }

    /// Sets the minimum width on the terminal.
    #[must_use]
    pub fn width(self, width: usize) -> Self {
        Self { width, ..self }
    }
}

/// The columns of a table, and the rules for marked and failed rows.
pub struct Table<'a, R> {
    columns: Vec<Column<'a, R>>,
    mark: Option<(&'static str, Ask<'a, R, bool>)>,
    failure: Ask<'a, R, Option<Failure>>,
}

impl<'a, R> Table<'a, R> {
    /// Returns a table with these columns.
    #[must_use]
    pub fn new(columns: Vec<Column<'a, R>>) -> Self {
        Self { columns, mark: None, failure: Box::new(|_| None) }
    }

    /// Marks some rows: before the row on the terminal, in the first cell on the page.
    #[must_use]
    pub fn mark(self, mark: &'static str, marked: impl Fn(&R) -> bool + 'a) -> Self {
        Self { mark: Some((mark, Box::new(marked))), ..self }
    }

    /// Declares which rows failed and have no quantities.
    #[must_use]
    pub fn failure(self, failure: impl Fn(&R) -> Option<Failure> + 'a) -> Self {
        Self { failure: Box::new(failure), ..self }
    }

    /// Renders the table for the terminal, with its remarks below.
    #[must_use]
    pub fn terminal(&self, rows: &[&R]) -> String {
        let mut lines = vec![self.terminal_head()];
        lines.extend(rows.iter().map(|row| self.terminal_cells(row)));
        let mut widths: Vec<usize> = self.terminal_widths();
        for line in &lines {
            for (width, cell) in widths.iter_mut().zip(line) {
                *width = (*width).max(cell.chars().count());
            }
        }
        let table: String = lines.iter().map(|line| self.line(line, &widths)).collect();
        let remarks = self.remarks(rows).map(|remark| format!("  {remark}\n"));
        table + &remarks.collect::<String>()
    }

    /// Renders the heading alone, for rows that are printed one by one.
    #[must_use]
    pub fn head(&self) -> String {
        self.line(&self.terminal_head(), &self.terminal_widths())
    }

    /// Renders one row, with columns of their minimum width.
    #[must_use]
    pub fn row(&self, row: &R) -> String {
        self.line(&self.terminal_cells(row), &self.terminal_widths())
    }

    /// Renders the table for a page.
    #[must_use]
    pub fn page(&self, rows: &[&R]) -> pages::table::Table {
        let shown = || self.columns.iter().filter(|column| column.on_page.is_some());
        let last_left = shown().collect::<Vec<_>>().iter().rposition(|column| column.left);
        let row = |row: &&R| {
            let mut cells = self.cells(row, &shown().collect::<Vec<_>>());
            if let (Some(first), Some((mark, true))) = (cells.first_mut(), self.marked(row)) {
                *first += &format!(" {mark}");
            }
            cells
        };
        pages::table::Table {
            head: shown().filter_map(|column| column.on_page.clone()).collect(),
            rows: rows.iter().map(row).collect(),
            figures_from: last_left.map_or(1, |last| last + 1),
        }
    }

    /// Remarks on the failed rows: name and reason.
    pub fn remarks<'b>(&'b self, rows: &'b [&R]) -> impl Iterator<Item = String> + 'b {
        rows.iter().filter_map(|row| (self.failure)(row)).map(|failure| failure.remark)
    }

    /// Renders the table as CSV, with the text for programs.
    #[must_use]
    pub fn csv(&self, rows: &[&R]) -> String {
        let named = || self.columns.iter().filter(|column| column.in_csv.is_some());
        let mut out = csv::Writer::from_writer(Vec::new());
        let head = named().filter_map(|column| column.in_csv.as_ref());
        let written = out.write_record(head).and_then(|()| {
            rows.iter()
                .try_for_each(|row| out.write_record(named().map(|column| (column.cell)(row).raw)))
        });
        written.expect("writing to a vector succeeds");
        let bytes = out.into_inner().expect("writing to a vector succeeds");
        String::from_utf8(bytes).expect("only text was written")
    }

    fn marked(&self, row: &R) -> Option<(&'static str, bool)> {
        self.mark.as_ref().map(|(mark, marked)| (*mark, marked(row)))
    }

    /// Text of these columns for a row. A failed row shows its name and the word of the failure.
    fn cells(&self, row: &R, columns: &[&Column<'a, R>]) -> Vec<String> {
        let failure = (self.failure)(row);
        let mut word = failure.as_ref().map(|failure| failure.word);
        let shown = |column: &&Column<'a, R>| match failure.is_some() && !column.names {
            true => word.take().unwrap_or_default().to_owned(),
            false => (column.cell)(row).shown,
        };
        columns.iter().map(shown).collect()
    }

    fn on_terminal(&self) -> Vec<&Column<'a, R>> {
        self.columns.iter().filter(|column| column.on_terminal.is_some()).collect()
    }

    fn terminal_head(&self) -> Vec<String> {
        let heads = self.columns.iter().filter_map(|column| column.on_terminal.clone());
        self.mark.iter().map(|_| String::new()).chain(heads).collect()
    }

    fn terminal_cells(&self, row: &R) -> Vec<String> {
        let mark = self.marked(row).map(|(mark, marked)| if marked { mark } else { "" });
        let cells = self.cells(row, &self.on_terminal());
        mark.into_iter().map(str::to_owned).chain(cells).collect()
    }

    fn terminal_widths(&self) -> Vec<usize> {
        let columns = self.on_terminal();
        self.mark.iter().map(|_| 1).chain(columns.iter().map(|column| column.width)).collect()
    }

    /// Formats cells in columns; a mark stands one place before them.
    fn line(&self, cells: &[String], widths: &[usize]) -> String {
        let columns = self.on_terminal();
        let left = self.mark.iter().map(|_| true).chain(columns.iter().map(|column| column.left));
        let padded = cells.iter().zip(widths).zip(left).map(|((cell, width), left)| match left {
            true => format!("{cell:width$}"),
            false => format!("{cell:>width$}"),
        });
        let line = padded.collect::<Vec<_>>().join(GAP);
        let indent = if self.mark.is_some() { " " } else { GAP };
        format!("{indent}{}\n", line.trim_end())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Run {
        name: &'static str,
        seconds: Option<f64>,
    }

    fn table<'a>() -> Table<'a, Run> {
        Table::new(vec![
            Column::text("", |run: &Run| run.name.to_owned()).naming().on_page("run").csv("name"),
            Column::quantity("time", |run: &Run| {
                Cell::optional(run.seconds.as_ref(), format::seconds)
            })
            .csv("time_s"),
            Column::quantity("memory", |_| Cell::bytes(8)).not_on_page(),
            Column::csv_only("failed", |run: &Run| run.seconds.is_none().to_string()),
        ])
        .failure(|run| {
            let remark = || format!("{}: no time", run.name);
            run.seconds.is_none().then(|| Failure { word: "failed", remark: remark() })
        })
    }

    const RUNS: [Run; 2] =
        [Run { name: "one", seconds: Some(0.0125) }, Run { name: "another", seconds: None }];

    #[test]
    fn the_same_rows_are_lines_a_page_and_csv() {
        let (table, rows) = (table(), RUNS.iter().collect::<Vec<_>>());
        assert_eq!(
            table.terminal(&rows),
            "              time  memory\n  one      12.5 ms     8 B\n  another   failed\n  \
             another: no time\n"
        );
        let page = table.page(&rows);
        assert_eq!(
            (page.head.as_slice(), page.figures_from),
            (&["run", "time"].map(String::from)[..], 1)
        );
        assert_eq!(page.rows[1], ["another", "failed"]);
        assert_eq!(table.csv(&rows), "name,time_s,failed\none,0.0125,false\nanother,,true\n");
    }

    #[test]
    fn marked_rows_stand_out() {
        let table = table().mark("*", |run| run.name == "one");
        let rows: Vec<&Run> = RUNS.iter().collect();
        assert!(table.terminal(&rows).contains("\n *  one "), "{}", table.terminal(&rows));
        assert_eq!(table.page(&rows).rows[0][0], "one *");
    }

    #[test]
    fn rows_one_by_one_keep_their_widths() {
        let table = Table::new(vec![
            Column::text("a", |text: &&str| (*text).to_owned()).width(4),
            Column::quantity("b", |text: &&str| Cell::text(text.len())).width(3),
        ]);
        assert_eq!(table.head() + &table.row(&"xyz"), "  a       b\n  xyz     3\n");
    }
}
