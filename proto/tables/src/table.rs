//! Table reader: columns of numbers or words in a text file named by a user. All tables are read
//! here.
//!
//! **Format.** A line is a row; empty lines and text after `#` are ignored. Cells are separated by
//! commas, semicolons, tabs or blanks, as detected in the first line, or as a line `sep=;` above it
//! says. Except with commas as separators, a table may have decimal commas instead of points, in
//! all of its numbers: beside a decimal comma, a point may separate thousands. A cell in double
//! quotes may contain anything except a line break.
//!
//! The first line may name the columns, with units in brackets: `v [km/h]` or `v (km/h)`. A line of
//! units may follow. Columns are then found by name, in any order, and other columns are not
//! parsed. A table without names has the columns of its [`Column`]s in their order.
//!
//! A number without a stated unit is in SI units, as in a case. Messages name the line and the
//! column. They quote contents only of tables with a recognised header, because the file may not
//! belong to the user.

use crate::input_file::{self, InputFileError};
use crate::plausible::Plausible;
use crate::quantity::{Conversion, QuantityError, is_same_unit};
use crate::suggest::{all_of, nearest};
use crate::text::one_line;
use crate::unit::parse_unit;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::path::Path;

/// Maximum length of cell content quoted in a message [characters].
const QUOTED: usize = 20;
/// Maximum length of a column name listed in a message [characters].
const LONGEST_NAME: usize = 40;
/// Maximum number of column names listed in a message.
const LISTED: usize = 20;

/// A column that a reader expects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Name of the column, followed by its aliases.
    pub names: Vec<String>,
    /// SI unit of the returned values.
    pub unit: String,
    /// Unit of the numbers in a table without a header, if different from the SI unit. A header
    /// must then state the unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bare_unit: Option<String>,
    /// The values are temperature differences, for which °C is meaningless.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub difference: bool,
    /// Plausible range of the values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plausible: Option<Plausible>,
}

impl Column {
    /// Returns a column with these names and SI unit.
    #[must_use]
    pub fn new(names: &[&str], unit: &str) -> Self {
        Self {
            names: names.iter().map(|name| (*name).to_owned()).collect(),
            unit: unit.to_owned(),
            bare_unit: None,
            difference: false,
            plausible: None,
        }
    }

    /// Sets the unit of numbers in a table without a header.
    #[must_use]
    pub fn bare(mut self, unit: &str) -> Self {
        self.bare_unit = Some(unit.to_owned());
        self
    }

    /// Marks the values as temperature differences.
    #[must_use]
    pub fn of_differences(mut self) -> Self {
        self.difference = true;
        self
    }

    /// Sets the plausible range of magnitudes and its reason.
    #[must_use]
    pub fn expected(mut self, range: std::ops::RangeInclusive<f64>, why: &str) -> Self {
        self.plausible = Some(Plausible::within(range, why));
        self
    }

    /// Returns `name [unit]`.
    #[must_use]
    pub fn heading(&self) -> String {
        let unit = self.bare_unit.as_ref().unwrap_or(&self.unit);
        format!("{} [{unit}]", self.names[0])
    }

    fn is_called(&self, name: &str) -> bool {
        let plain = |name: &str| name.to_lowercase().replace([' ', '-'], "_");
        self.names.iter().any(|own| plain(own) == plain(name))
    }
}

/// Joins the headings of columns: "`x [m]`, `y [m]` and `z [m]`".
#[must_use]
pub fn headings(columns: &[Column]) -> String {
    let headings: Vec<String> =
        columns.iter().map(|column| format!("`{}`", column.heading())).collect();
    all_of(&headings)
}

/// Reason why a table cannot be used. Each message continues a sentence that begins with the path.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] InputFileError),
    /// The table has no rows.
    #[error("has no rows{}", above_only(*.above))]
    Empty {
        /// Lines read as names and as units of the columns, from 1.
        above: [Option<usize>; 2],
    },
    /// Some numbers have a decimal comma, others a decimal point.
    #[error(
        "has a decimal comma in column {} of line {} and a point in column {} of line {}; write all numbers with \
         the same decimal sign, and without separators of thousands",
        .comma[1], .comma[0], .point[1], .point[0]
    )]
    DecimalSigns {
        /// Line and column of the first number with a comma, both from 1.
        comma: [usize; 2],
        /// Line and column of the first number with a point, both from 1.
        point: [usize; 2],
    },
    /// The number of cells differs from that of the first line.
    #[error("has {found} cells in line {line}, where the first line has {expected}")]
    Cells {
        /// Number of the line, from 1.
        line: usize,
        /// Number of cells of the row.
        found: usize,
        /// Number of cells of the first line.
        expected: usize,
    },
    /// A table without a header has the wrong number of columns.
    #[error("has {found} columns and no header; without one its columns are {expected}")]
    Columns {
        /// Number of columns of the table.
        found: usize,
        /// Headings of the expected columns.
        expected: String,
    },
    /// Column names are required, but the first line has numbers.
    #[error("has numbers in line {line}, where the names of the columns are expected")]
    NoHeader {
        /// Number of the line, from 1.
        line: usize,
    },
    /// Numbers are required from the first line on.
    #[error("has no number in line {line}; rows of numbers without names are expected")]
    Header {
        /// Number of the line, from 1.
        line: usize,
    },
    /// No column has this name.
    #[error("has no column `{name}`{}{}", near_hint(.near.as_deref()), listed(.known))]
    NoColumn {
        /// Requested name.
        name: String,
        /// Similar name in the header.
        near: Option<String>,
        /// Names in the header, if certain to be names.
        known: Vec<String>,
    },
    /// Two columns have this name.
    #[error("has two columns `{name}` in line {line}")]
    Twice {
        /// Duplicate name.
        name: String,
        /// Number of the line, from 1.
        line: usize,
    },
    /// The unit of a column cannot be used.
    #[error("has a unit in column `{column}` of line {line} that cannot be used: {error}")]
    Unit {
        /// Name of the column.
        column: String,
        /// Number of the line, from 1.
        line: usize,
        /// Reason why the unit cannot be used.
        error: QuantityError,
    },
    /// Temperature differences are given in degrees Celsius.
    #[error("has °C in column `{0}`, whose values are rises of temperature; write K")]
    Rise(String),
    /// Two places state different units.
    #[error("has the unit {one} in the header of column `{column}`, and {place} says {other}")]
    UnitsDiffer {
        /// Name of the column.
        column: String,
        /// Unit in the header.
        one: String,
        /// Place of the other unit.
        place: String,
        /// Unit stated in the other place.
        other: String,
    },
    /// The header states no unit where one is required.
    #[error("names no unit of column `{column}` in line {line}; write `{example}`")]
    NoUnit {
        /// Name of the column.
        column: String,
        /// Number of the line, from 1.
        line: usize,
        /// Example of a heading with a unit.
        example: String,
    },
    /// A cell is not a finite number.
    #[error("has no number in column {column} of line {line}{}", quoted_content(.content.as_deref()))]
    Cell {
        /// Name or number of the column.
        column: String,
        /// Number of the line, from 1.
        line: usize,
        /// Content of the cell, if its column was found by name.
        content: Option<String>,
    },
    /// Values that must increase do not.
    #[error("does not rise in column `{column}` from line {before} to line {line}")]
    Order {
        /// Name of the column.
        column: String,
        /// Number of the preceding line, from 1.
        before: usize,
        /// Number of the line, from 1.
        line: usize,
    },
}

fn near_hint(near: Option<&str>) -> String {
    near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default()
}

fn listed(known: &[String]) -> String {
    let mut shown: Vec<String> =
        known.iter().take(LISTED).map(|name| format!("`{name}`")).collect();
    match known.len().saturating_sub(LISTED) {
        0 if known.is_empty() => return String::new(),
        0 => {}
        more => shown.push(format!("{more} more")),
    }
    format!("; its columns are {}", all_of(&shown))
}

fn above_only([names, units]: [Option<usize>; 2]) -> String {
    match (names, units) {
        (Some(names), Some(units)) => format!(
            ": line {names} is read as the names of its columns, and line {units}, without a number, as their units"
        ),
        (Some(names), None) => {
            format!(": line {names}, without a number, is read as the names of its columns")
        }
        _ => String::new(),
    }
}

fn quoted_content(content: Option<&str>) -> String {
    content.map(|content| format!(", but {content:?}")).unwrap_or_default()
}

/// Rules for reading a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// Characters that begin a comment.
    comments: &'static [char],
    /// Cells are words. The first line is then a header, no line of units follows, and blanks
    /// belong to a cell.
    words: bool,
}

impl Reading {
    /// Tables of numbers.
    pub const NUMBERS: Self = Self { comments: &['#'], words: false };
    /// Profiles as written by instruments and other programs.
    pub const PROFILE: Self = Self { comments: &['#', '%', '!'], words: false };
    /// Values of keys, as written in a case.
    pub const WORDS: Self = Self { comments: &['#'], words: true };
}

/// Name and unit of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Heading {
    /// Name of the column.
    pub name: String,
    /// Unit beside the name.
    pub unit: Option<String>,
    /// Unit in the line of units.
    unit_below: Option<String>,
}

impl Heading {
    /// Parses `v [km/h]`, `v (km/h)` or `v`. Round brackets without a unit belong to the name.
    fn parse(text: &str) -> Self {
        let split = |open, close| text.strip_suffix(close)?.rsplit_once(open);
        let round = split('(', ')').filter(|(_, unit)| bracketed_unit(unit).is_some());
        let (name, unit) = match split('[', ']').or(round) {
            Some((name, unit)) => (name, Some(unit_text(unit))),
            None => (text, None),
        };
        Self { name: name.trim().to_owned(), unit, unit_below: None }
    }
}

impl Heading {
    /// Returns true if the name is a dotted key of a case, such as `motion.speed`.
    #[must_use]
    pub fn is_dotted_key(&self) -> bool {
        let plain = |part: &str| {
            !part.is_empty()
                && part.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '"'))
        };
        self.name.contains('.') && self.name.split('.').all(plain)
    }
}

fn bracketed_unit(text: &str) -> Option<String> {
    let unit = unit_text(text);
    parse_unit(&unit).is_ok().then_some(unit)
}

/// Returns a unit without surrounding blanks; a dash denotes a dimensionless number.
fn unit_text(text: &str) -> String {
    match text.trim() {
        "-" | "–" | "" => "1".to_owned(),
        unit => unit.to_owned(),
    }
}

/// Separator between cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Separator {
    Character(char),
    Blanks,
}

impl Separator {
    /// Reads a line `sep=;`, as spreadsheets write it above a table.
    fn stated(line: &str) -> Option<Self> {
        let mut rest = line.trim_start().strip_prefix("sep=")?.trim_end_matches(' ').chars();
        match (rest.next(), rest.next()) {
            (Some(character @ (';' | ',' | '\t')), None) => Some(Self::Character(character)),
            _ => None,
        }
    }

    /// Detects the separator from the first line.
    fn of(line: &str, reading: Reading) -> Self {
        let has = |character: char| cells(line, Self::Character(character)).nth(1).is_some();
        // A tab after a comma only aligns columns.
        let aligned = || cells(line, Self::Character('\t')).any(|cell| cell.ends_with(','));
        match () {
            () if has(';') => Self::Character(';'),
            () if has('\t') && !aligned() => Self::Character('\t'),
            () if has(',') || reading.words => Self::Character(','),
            () => Self::Blanks,
        }
    }

    fn allows_decimal_comma(self) -> bool {
        self != Self::Character(',')
    }
}

/// Returns the trimmed cells of a line, with quotes.
fn cells(line: &str, separator: Separator) -> Cells<'_> {
    Cells { rest: Some(line), separator }
}

#[derive(Clone, Debug)]
struct Cells<'a> {
    rest: Option<&'a str>,
    separator: Separator,
}

impl<'a> Iterator for Cells<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let rest = self.rest?;
        let start = match self.separator {
            Separator::Blanks => rest.trim_start(),
            Separator::Character(_) => rest.trim_start_matches(' '),
        };
        if self.separator == Separator::Blanks && start.is_empty() {
            self.rest = None;
            return None;
        }
        // A quoted cell ends at the first quote that is not doubled.
        let quoted = if start.starts_with('"') { closing_quote(start) } else { 0 };
        let end = match self.separator {
            Separator::Character(character) => start[quoted..].find(character),
            Separator::Blanks => start[quoted..].find(char::is_whitespace),
        };
        match end {
            Some(end) => {
                let (cell, rest) = start.split_at(quoted + end);
                let mut after = rest.chars();
                after.next();
                self.rest = Some(after.as_str());
                Some(cell.trim())
            }
            None => {
                self.rest = None;
                Some(start.trim())
            }
        }
    }
}

/// Returns the index behind the closing quote of a text that begins with a quote; the end of the
/// text if none closes it.
fn closing_quote(text: &str) -> usize {
    let mut at = 1;
    while let Some(found) = text[at..].find('"') {
        at += found + 1;
        if !text[at..].starts_with('"') {
            return at;
        }
        at += 1;
    }
    text.len()
}

/// Returns the content of a cell without its quotes.
fn unquoted(cell: &str) -> Cow<'_, str> {
    match cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"')) {
        Some(inner) if inner.contains("\"\"") => Cow::Owned(inner.replace("\"\"", "\"")),
        Some(inner) => Cow::Borrowed(inner.trim()),
        None => Cow::Borrowed(cell),
    }
}

/// Returns a line without its comment; a comment character in quotes is ignored.
fn without_comment<'a>(line: &'a str, comments: &[char]) -> &'a str {
    let Some(first) = line.find(comments) else { return line };
    if !line[..first].contains('"') {
        return &line[..first];
    }
    let mut inside = false;
    let end = line.find(|c: char| {
        inside ^= c == '"';
        !inside && comments.contains(&c)
    });
    &line[..end.unwrap_or(line.len())]
}

/// Converts a decimal comma or a Fortran exponent to the usual form; returns `None` for anything
/// else.
fn respelt(cell: &str, comma: bool) -> Option<String> {
    let digits = |c: char| c.is_ascii_digit() || "+-.,eEdD".contains(c);
    if !cell.chars().all(digits) || !cell.contains(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let commas = cell.matches(',').count();
    if commas > 1 || commas == 1 && (!comma || cell.contains('.')) {
        return None;
    }
    Some(cell.replace(',', ".").replace(['d', 'D'], "e"))
}

fn is_number(cell: &str, comma: bool) -> bool {
    let parses = |text: &str| text.parse::<f64>().is_ok();
    parses(cell) || respelt(cell, comma).is_some_and(|text| parses(&text))
}

/// Returns the decimal comma or point of a number, which a unit may follow; `None` for a word, and
/// for a number without digits after a decimal sign.
fn decimal_sign(cell: &str) -> Option<char> {
    let number = cell.split_whitespace().next().filter(|number| is_number(number, true))?;
    let (at, sign) = number.char_indices().find(|(_, c)| matches!(c, ',' | '.'))?;
    number[at + 1..].starts_with(|c: char| c.is_ascii_digit()).then_some(sign)
}

/// A row of a table: its range in the text, and its line number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Row {
    start: usize,
    end: usize,
    line: usize,
}

/// First line of a table, if it has names.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Header {
    line: usize,
    headings: Vec<Heading>,
    /// Line number of the units.
    line_of_units: Option<usize>,
}

/// A table: the positions of its rows and the names of its columns. Values are parsed column by
/// column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    text: String,
    separator: Separator,
    header: Option<Header>,
    rows: Vec<Row>,
    columns: usize,
}

impl Table {
    /// Reads a file of at most `most` bytes.
    ///
    /// # Errors
    /// Fails if the file cannot be read, has no rows, or has rows of different lengths.
    pub fn read(path: &Path, most: u64, reading: Reading) -> Result<Self, TableError> {
        Self::parse(input_file::read_text(path, most)?, reading)
    }

    /// Parses a text.
    ///
    /// # Errors
    /// Fails if the text has no rows, or rows of different lengths.
    pub fn parse(text: String, reading: Reading) -> Result<Self, TableError> {
        let mut rows = Vec::new();
        let mut offset = 0;
        for (line, number) in text.split('\n').zip(1..) {
            let content = without_comment(line, reading.comments);
            let content = content.trim_end_matches([' ', '\r']);
            if !content.trim().is_empty() {
                rows.push(Row { start: offset, end: offset + content.len(), line: number });
            }
            offset += line.len() + 1;
        }
        let stated = rows.first().and_then(|row| Separator::stated(&text[row.start..row.end]));
        if stated.is_some() {
            rows.remove(0);
        }
        let mut lines = rows.iter().map(|row| (row, &text[row.start..row.end]));
        let Some((first, content)) = lines.next() else {
            return Err(TableError::Empty { above: [None; 2] });
        };
        let separator = stated.unwrap_or_else(|| Separator::of(content, reading));
        let comma = separator.allows_decimal_comma();
        let number = |cell: &str| is_number(&unquoted(cell), comma);
        let (mut header, mut columns) = (None, cells(content, separator).count());
        if reading.words || !cells(content, separator).any(number) {
            let headings = header_cells(content, separator);
            columns = headings.len();
            let mut found = Header {
                line: first.line,
                headings: headings.iter().map(|cell| Heading::parse(cell)).collect(),
                line_of_units: None,
            };
            if let Some((row, content)) = lines.next().filter(|_| !reading.words) {
                let cells: Vec<&str> = cells(content, separator).collect();
                if cells.len() == columns && is_line_of_units(&cells, comma) {
                    found.line_of_units = Some(row.line);
                    for (heading, cell) in found.headings.iter_mut().zip(cells) {
                        heading.unit_below = unit_of_cell(&unquoted(cell));
                    }
                }
            }
            header = Some(found);
        }
        let above =
            header.as_ref().map_or(0, |header| 1 + usize::from(header.line_of_units.is_some()));
        rows.drain(..above);
        let table = Self { text, separator, header, rows, columns };
        if table.rows.is_empty() {
            let header = table.header.as_ref();
            let names = header.map(|header| header.line);
            return Err(TableError::Empty {
                above: [names, header.and_then(|header| header.line_of_units)],
            });
        }
        table.check_cells()?;
        table.check_decimal_signs()?;
        Ok(table)
    }

    /// Checks that all numbers have the same decimal sign.
    fn check_decimal_signs(&self) -> Result<(), TableError> {
        let has = |sign: char| (0..self.rows()).any(|row| self.content(row).contains(sign));
        if !self.separator.allows_decimal_comma() || !has(',') || !has('.') {
            return Ok(());
        }
        let (mut comma, mut point) = (None, None);
        for row in 0..self.rows() {
            for (column, cell) in cells(self.content(row), self.separator).enumerate() {
                let first = match decimal_sign(&unquoted(cell)) {
                    Some(',') => &mut comma,
                    Some(_) => &mut point,
                    None => continue,
                };
                first.get_or_insert([self.line(row), column + 1]);
                if let (Some(comma), Some(point)) = (comma, point) {
                    return Err(TableError::DecimalSigns { comma, point });
                }
            }
        }
        Ok(())
    }

    /// Checks that every row has as many cells as the first line, apart from an empty last cell.
    fn check_cells(&self) -> Result<(), TableError> {
        let last_is_nameless = self
            .header
            .as_ref()
            .and_then(|header| header.headings.last())
            .is_some_and(|last| last.name.is_empty());
        for row in &self.rows {
            let content = &self.text[row.start..row.end];
            let found = match self.separator {
                Separator::Character(separator) if !content.contains('"') => {
                    let separator = separator as u8;
                    1 + content.bytes().filter(|byte| *byte == separator).count()
                }
                separator => cells(content, separator).count(),
            };
            let expected = self.columns;
            let extra_is_empty =
                || found == expected + 1 && cells(content, self.separator).last() == Some("");
            if found != expected
                && !extra_is_empty()
                && !(last_is_nameless && found + 1 == expected)
            {
                return Err(TableError::Cells { line: row.line, found, expected });
            }
        }
        Ok(())
    }

    /// Returns the number of rows, at least one.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// Returns the line number of a row, from 1.
    #[must_use]
    pub fn line(&self, row: usize) -> usize {
        self.rows[row].line
    }

    /// Returns the headings, if the table has a header.
    #[must_use]
    pub fn headings(&self) -> Option<&[Heading]> {
        self.header.as_ref().map(|header| header.headings.as_slice())
    }

    /// Returns the contents of the cells of a row; numbers get a decimal point.
    pub fn words(&self, row: usize) -> impl Iterator<Item = Cow<'_, str>> {
        let comma = self.separator.allows_decimal_comma();
        let word = move |cell| match unquoted(cell) {
            Cow::Borrowed(word) if comma && word.contains(',') => with_point(word),
            word => word,
        };
        cells(self.content(row), self.separator).take(self.columns).map(word)
    }

    /// Returns the column with this name in the SI unit `si`. The unit of its numbers is that of
    /// the header, or `unit` from the case.
    ///
    /// # Errors
    /// Fails if there is no such column or two of them, if a cell is not a number, if the unit
    /// cannot be converted, or if header and case state different units.
    pub fn column(&self, name: &str, unit: Option<&str>, si: &str) -> Result<Vec<f64>, TableError> {
        let header = self.header()?;
        let index = find(header, name, |own| own == name)?.ok_or_else(|| {
            let known = self.listed_names();
            let near = nearest(name, known.iter().map(String::as_str)).map(str::to_owned);
            TableError::NoColumn { name: name.to_owned(), near, known }
        })?;
        let stated = stated_unit(header, index)?;
        if let (Some(one), Some(other)) = (&stated, unit)
            && !is_same_unit(one, other)
        {
            return Err(TableError::UnitsDiffer {
                column: name.to_owned(),
                one: one.clone(),
                place: "the case".to_owned(),
                other: other.to_owned(),
            });
        }
        let unit = stated.as_deref().or(unit).unwrap_or(si);
        self.converted(index, unit, si)
    }

    /// Returns columns in SI units, found by name, or by order in a table without a header.
    ///
    /// # Errors
    /// Fails like [`Table::column`], or if a table without a header has another number of columns.
    pub fn columns(&self, wanted: &[Column]) -> Result<Vec<Vec<f64>>, TableError> {
        let places = self.places(wanted)?;
        wanted.iter().zip(places).map(|(column, index)| self.numbers(column, index)).collect()
    }

    /// Returns the numbers of one of the columns.
    ///
    /// # Errors
    /// Fails like [`Table::columns`].
    pub fn numbers_of(&self, wanted: &[Column], which: usize) -> Result<Vec<f64>, TableError> {
        self.numbers(&wanted[which], self.places(wanted)?[which])
    }

    /// Returns the numbers of the column with this index.
    fn numbers(&self, column: &Column, index: usize) -> Result<Vec<f64>, TableError> {
        let Some(header) = &self.header else {
            let unit = column.bare_unit.as_ref().unwrap_or(&column.unit);
            return self.converted(index, unit, &column.unit);
        };
        let name = header.headings[index].name.clone();
        let unit = match (stated_unit(header, index)?, &column.bare_unit) {
            (Some(unit), _) => unit,
            (None, None) => column.unit.clone(),
            (None, Some(_)) => {
                let (line, example) = (header.line, column.heading());
                return Err(TableError::NoUnit { column: name, line, example });
            }
        };
        let celsius = Conversion::new(&unit, &column.unit).is_ok_and(|to| to.has_offset());
        if column.difference && celsius {
            return Err(TableError::Rise(name));
        }
        self.converted(index, &unit, &column.unit)
    }

    /// Returns the indices of the columns.
    ///
    /// # Errors
    /// Fails if a column is missing or duplicate, or if a table without a header has another number
    /// of columns.
    fn places(&self, wanted: &[Column]) -> Result<Vec<usize>, TableError> {
        let Some(header) = &self.header else {
            return match self.columns == wanted.len() {
                true => Ok((0..wanted.len()).collect()),
                false => {
                    let (found, expected) = (self.columns, headings(wanted));
                    Err(TableError::Columns { found, expected })
                }
            };
        };
        let place = |column: &Column| {
            find(header, &column.names[0], |own| column.is_called(own))?.ok_or_else(|| {
                TableError::NoColumn { name: column.heading(), near: None, known: Vec::new() }
            })
        };
        wanted.iter().map(place).collect()
    }

    /// Returns the number of columns and all numbers of a table without a header, row by row.
    ///
    /// # Errors
    /// Fails if there is a header, or a cell that is not a number.
    pub fn matrix(&self) -> Result<(usize, Vec<f64>), TableError> {
        if let Some(header) = &self.header {
            return Err(TableError::Header { line: header.line });
        }
        let plain = Conversion::new("1", "1").expect("a plain number");
        let mut values = Vec::with_capacity(self.rows.len() * self.columns);
        let mut scratch = String::new();
        for row in 0..self.rows.len() {
            let cells = cells(self.content(row), self.separator).take(self.columns);
            for (index, cell) in cells.enumerate() {
                values.push(self.number(row, index, cell, &plain, &mut scratch)?);
            }
        }
        Ok((self.columns, values))
    }

    /// Returns the words of one of the columns.
    ///
    /// # Errors
    /// Fails like [`Table::columns`].
    pub fn words_of(
        &self,
        wanted: &[Column],
        which: usize,
    ) -> Result<Vec<Cow<'_, str>>, TableError> {
        let index = self.places(wanted)?[which];
        let word = |row| cells(self.content(row), self.separator).nth(index).unwrap_or_default();
        Ok((0..self.rows.len()).map(|row| unquoted(word(row))).collect())
    }

    /// Checks that the values of a column increase from row to row, or do not decrease if they
    /// `may_stay`.
    ///
    /// # Errors
    /// Fails with the first two lines that violate the order.
    pub fn check_rising(
        &self,
        name: &str,
        values: &[f64],
        may_stay: bool,
    ) -> Result<(), TableError> {
        let wrong = |pair: &[f64]| if may_stay { pair[1] < pair[0] } else { pair[1] <= pair[0] };
        match values.windows(2).position(wrong) {
            None => Ok(()),
            Some(row) => Err(TableError::Order {
                column: name.to_owned(),
                before: self.line(row),
                line: self.line(row + 1),
            }),
        }
    }

    fn header(&self) -> Result<&Header, TableError> {
        self.header.as_ref().ok_or(TableError::NoHeader { line: self.rows[0].line })
    }

    fn content(&self, row: usize) -> &str {
        let Row { start, end, .. } = self.rows[row];
        &self.text[start..end]
    }

    /// Returns the names of the header, if they look like names and the row below has numbers.
    fn listed_names(&self) -> Vec<String> {
        let plain = |c: char| c.is_alphanumeric() || " _.-/%°()[]^*·".contains(c);
        let is_name = |heading: &Heading| {
            heading.name.chars().count() <= LONGEST_NAME && heading.name.chars().all(plain)
        };
        let comma = self.separator.allows_decimal_comma();
        let mut first = cells(self.content(0), self.separator);
        let headings = self.headings().unwrap_or_default();
        if headings.iter().all(is_name) && first.any(|cell| is_number(&unquoted(cell), comma)) {
            let named = headings.iter().filter(|heading| !heading.name.is_empty());
            named.map(|heading| heading.name.clone()).collect()
        } else {
            Vec::new()
        }
    }

    fn converted(&self, index: usize, unit: &str, si: &str) -> Result<Vec<f64>, TableError> {
        let conversion = Conversion::new(unit, si).map_err(|error| {
            let header = self.header.as_ref();
            TableError::Unit {
                column: header
                    .map_or_else(String::new, |header| header.headings[index].name.clone()),
                line: header.map_or(1, |header| header.line_of_units.unwrap_or(header.line)),
                error,
            }
        })?;
        let mut scratch = String::new();
        let cell = |row| cells(self.content(row), self.separator).nth(index).unwrap_or_default();
        (0..self.rows.len())
            .map(|row| self.number(row, index, cell(row), &conversion, &mut scratch))
            .collect()
    }

    fn number(
        &self,
        row: usize,
        index: usize,
        cell: &str,
        conversion: &Conversion,
        scratch: &mut String,
    ) -> Result<f64, TableError> {
        let content = unquoted(cell);
        let value = conversion.apply(&content, scratch).or_else(|| {
            let text = respelt(&content, self.separator.allows_decimal_comma())?;
            conversion.apply(&text, scratch)
        });
        value.ok_or_else(|| {
            let name = self.header.as_ref().map(|header| &header.headings[index].name);
            let shown = |content: &str| {
                let shown: String = one_line(content).chars().take(QUOTED).collect();
                if shown.len() < content.len() { format!("{shown}…") } else { shown }
            };
            TableError::Cell {
                column: name.map_or_else(|| (index + 1).to_string(), |name| format!("`{name}`")),
                line: self.line(row),
                content: name.map(|_| shown(&content)),
            }
        })
    }
}

/// Returns the cells of a header. With blanks as separators, a name and its following brackets are
/// one cell.
fn header_cells(content: &str, separator: Separator) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut open = false;
    for cell in cells(content, separator) {
        match found.last_mut() {
            Some(last)
                if separator == Separator::Blanks && (open || cell.starts_with(['[', '('])) =>
            {
                last.push(' ');
                last.push_str(cell);
            }
            _ => found.push(unquoted(cell).into_owned()),
        }
        open = found.last().is_some_and(|cell| {
            cell.rfind('[') > cell.rfind(']') || cell.rfind('(') > cell.rfind(')')
        });
    }
    found
}

/// Returns true for a line of units. It has no numbers, except `1` for dimensionless columns if all
/// other cells are valid units.
fn is_line_of_units(cells: &[&str], comma: bool) -> bool {
    let words: Vec<Cow<'_, str>> = cells.iter().map(|cell| unquoted(cell)).collect();
    let numbers = words.iter().filter(|word| is_number(word, comma)).count();
    let is_unit = |word: &Cow<'_, str>| {
        unit_of_cell(word).is_none_or(|unit| unit == "1" || parse_unit(&unit).is_ok())
    };
    let named = words.iter().filter(|word| !word.is_empty()).count();
    named > numbers && (numbers == 0 || words.iter().all(is_unit))
}

/// Returns the unit in a cell of a line of units.
fn unit_of_cell(cell: &str) -> Option<String> {
    let inner = |open, close| cell.strip_prefix(open)?.strip_suffix(close);
    let bare = inner('[', ']').or_else(|| inner('(', ')')).unwrap_or(cell);
    (!cell.is_empty()).then(|| unit_text(bare))
}

/// Returns the index of the matching column.
fn find(
    header: &Header,
    name: &str,
    fits: impl Fn(&str) -> bool,
) -> Result<Option<usize>, TableError> {
    let mut found = header.headings.iter().enumerate().filter(|(_, own)| fits(&own.name));
    match (found.next(), found.next()) {
        (Some(_), Some(_)) => Err(TableError::Twice { name: name.to_owned(), line: header.line }),
        (first, _) => Ok(first.map(|(index, _)| index)),
    }
}

/// Returns the unit that a header states for a column, beside the name or below.
fn stated_unit(header: &Header, index: usize) -> Result<Option<String>, TableError> {
    let heading = &header.headings[index];
    match (&heading.unit, &heading.unit_below) {
        (Some(one), Some(other)) if !is_same_unit(one, other) => Err(TableError::UnitsDiffer {
            column: heading.name.clone(),
            one: one.clone(),
            place: format!("line {}", header.line_of_units.unwrap_or(header.line)),
            other: other.clone(),
        }),
        (one, other) => Ok(one.clone().or_else(|| other.clone())),
    }
}

/// Replaces the decimal comma of a number at the start of a word by a point.
fn with_point(word: &str) -> Cow<'_, str> {
    let number = word.trim_start_matches(['+', '-']);
    let digits = number.len() - number.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let after = number[digits..].strip_prefix(',');
    let decimal =
        digits > 0 && after.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    match decimal && word.matches(',').count() == 1 && !number[..digits].contains('.') {
        true => Cow::Owned(word.replacen(',', ".", 1)),
        false => Cow::Borrowed(word),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn table(text: &str) -> Result<Table, TableError> {
        Table::parse(text.to_owned(), Reading::NUMBERS)
    }

    fn column(text: &str, name: &str, unit: Option<&str>, si: &str) -> Result<Vec<f64>, String> {
        let table = table(text).map_err(|error| error.to_string())?;
        table.column(name, unit, si).map_err(|error| error.to_string())
    }

    fn points() -> [Column; 3] {
        ["x", "y", "z"].map(|name| Column::new(&[name], "m"))
    }

    fn three(text: &str) -> Result<Vec<Vec<f64>>, String> {
        let table = table(text).map_err(|error| error.to_string())?;
        table.columns(&points()).map_err(|error| error.to_string())
    }

    const TABLE: &str = "# measured\nt [s], Q [kN], xi\n0, 80, -0.001\n0.1, 90.5, 2e-3\n";

    #[test]
    fn columns_have_the_unit_of_their_head_or_of_the_case_and_both_must_agree() {
        assert_eq!(column(TABLE, "Q", None, "N"), Ok(vec![80e3, 90.5e3]));
        assert_eq!(column(TABLE, "Q", Some("kN"), "N"), Ok(vec![80e3, 90.5e3]));
        assert_eq!(column(TABLE, "xi", None, "1"), Ok(vec![-0.001, 0.002]));
        assert_eq!(column(TABLE, "xi", Some("%"), "1"), Ok(vec![-1e-5, 2e-5]));
        let differ = column("v [km/h]\n72\n", "v", Some("m/s"), "m/s").unwrap_err();
        assert!(differ.contains("km/h") && differ.contains("the case says m/s"), "{differ}");
    }

    /// Variants as written by vehicle dynamics programs: each must give the same numbers.
    #[test]
    fn one_table_in_many_dresses() {
        for text in [
            "t [s],v [km/h],state\n0,72,run\n1.5,90,brake\n",
            "\u{feff}t,v,state\r\ns,km/h,-\r\n0,72,run\r\n1.5,90,brake\r\n",
            "t;v;state\n[s];[km/h];\n0;72;run\n1,5;90;brake\n",
            "state\tv (km/h)\tt (s)\nrun\t72\t0\nbrake\t90,0\t1,5\n",
            "t [s]   v [km/h]   state\n 0   72   run\n 1.5  90   \"full brake\"\n",
            "t [s], v [km/h], state,\n0, 72, run,\n1.5, 90, brake,\n",
            "\"t [s]\", \"v [km/h]\", \"state, of the driver\"\n0, 72, \"run, fast\"\n1.5D0, 90, x # now\n",
            "t,v,n\ns,km/h,1\n0,72,1\n1.5,90,2\n",
        ] {
            let text = input_file::into_text(text.as_bytes().to_vec()).unwrap();
            assert_eq!(column(&text, "t", None, "s"), Ok(vec![0.0, 1.5]), "{text}");
            assert_eq!(column(&text, "v", None, "m/s"), Ok(vec![20.0, 25.0]), "{text}");
        }
    }

    #[test]
    fn faults_name_line_and_column() {
        let fault = |text: &str, name: &str, si: &str| column(text, name, None, si).unwrap_err();
        assert!(
            fault(TABLE, "q", "N").contains("did you mean `Q`?; its columns are `t`, `Q` and `xi`")
        );
        assert!(fault(TABLE, "Q", "m").contains("column `Q` of line 2"));
        assert!(fault("a,b\n1,2\n3,x\n", "b", "1").contains("column `b` of line 3, but \"x\""));
        assert_eq!(
            column("a,b\n1,2\n3,x\n", "a", None, "1"),
            Ok(vec![1.0, 3.0]),
            "only what is named"
        );
        assert!(fault("a,b\n1,2\n1\n", "a", "1").contains("1 cells in line 3"));
        assert!(fault("a,b\n", "a", "1").contains("has no rows: line 1, without a number"));
        assert!(fault("a,b\n0x10,1_0\n", "a", "1").contains("line 2, without a number, as their"));
        let wide: Vec<String> = (0..3000).map(|k| format!("c{k}")).collect();
        let wide = format!("{}\n{}\n", wide.join(","), vec!["1"; 3000].join(","));
        assert!(fault(&wide, "x", "1").ends_with("`c19` and 2980 more"));
        assert!(fault("a\nNaN\n", "a", "1").contains("line 2"));
        assert!(fault("1,2\n", "a", "1").contains("numbers in line 1"));
        assert!(fault("a,b,a\n1,2,3\n", "a", "1").contains("two columns `a` in line 1"));
        assert!(fault("a,b\n1,5,2\n", "a", "1").contains("3 cells in line 2"));
        assert!(fault("a [kN]\n[N]\n1\n", "a", "N").contains("line 2 says N"));
        assert!(fault("v\nkmh\n1\n", "v", "m/s").contains("did you mean `km/h`"));
        assert!(fault("t;v\n1.234,5;2\n", "t", "s").contains("column `t` of line 2"));
    }

    #[test]
    fn named_columns_come_in_any_order_and_units_are_obeyed() {
        let expected = Ok(vec![vec![1e-3], vec![2e-3], vec![-3.0]]);
        assert_eq!(three("1e-3, 2e-3, -3\n"), expected);
        assert_eq!(three("x [mm], y [mm], z [m]\n1, 2, -3\n"), expected);
        assert_eq!(three("name; Z; Y [mm]; X [mm]\np; -3; 2,0; 1\n"), expected);
        assert!(three("x, y\n1, 2\n").unwrap_err().contains("no column `z [m]`"));
        assert!(three("1, 2\n").unwrap_err().contains("2 columns and no header"));
        assert!(three("1, 2, x\n").unwrap_err().contains("column 3 of line 1"));
        let rise = [Column::new(&["rise"], "K").of_differences()];
        let of = |text: &str| table(text).unwrap().columns(&rise);
        assert!(matches!(of("rise [°C]\n20\n"), Err(TableError::Rise(_))));
        assert_eq!(of("rise [K]\n20\n").unwrap(), [vec![20.0]]);
        let bare = [Column::new(&["y"], "m").bare("mm")];
        let of = |text: &str| table(text).unwrap().columns(&bare);
        assert_eq!(of("20\n").unwrap(), [vec![0.02]]);
        assert!(matches!(of("y\n20\n"), Err(TableError::NoUnit { .. })));
    }

    /// A number with a point beside one with a comma could have a separator of thousands: 134.000
    /// is 134 or 134 000. Words and quoted lists are no numbers.
    #[test]
    fn all_numbers_of_a_table_have_the_same_decimal_sign() {
        let fault = |text: &str| table(text).unwrap_err().to_string();
        let mixed = fault("t;Q;xi\n0;134.000;-0,001\n");
        assert!(mixed.contains("comma in column 3 of line 2 and a point in column 2"), "{mixed}");
        assert!(fault("t\tQ\n0\t56,060\n1\t56.060\n").contains("column 2 of line 3"));
        // A comma at the end of a cell is no decimal sign.
        assert!(table("200 50 419.5\n400, 48, 450 \n").is_ok());
        // Commas separate cells here, and `5 1.5` is no number.
        assert!(three("0,5 1.5,2\n").is_err());
        let words = |text: &str| Table::parse(text.to_owned(), Reading::WORDS);
        assert!(words("load;set\n60,5 kN;\"[1.5, 2]\"\n").is_ok());
        assert!(words("load;mu\n134.000 N;0,3\n").is_err());
        let german = "t;Q;state\n0,5;134;v1.2\n1,5;134000;run, fast.\n";
        assert_eq!(column(german, "t", None, "s"), Ok(vec![0.5, 1.5]));
        assert_eq!(column("t,Q\n0.5,2\n", "t", None, "s"), Ok(vec![0.5]));
    }

    #[test]
    fn a_line_of_a_spreadsheet_names_the_separator() {
        assert_eq!(column("sep=;\nt;Q\n0,5;2\n", "t", None, "s"), Ok(vec![0.5]));
        assert_eq!(column("sep=,\r\nt,Q\r\n0.5,2\r\n", "Q", None, "s"), Ok(vec![2.0]));
        assert_eq!(column("sep=\tm\n1\t2\n", "m", None, "1"), Ok(vec![2.0]));
    }

    #[test]
    fn order_is_named_by_its_lines() {
        let table = table("t\n0\n# pause\n2\n1\n").unwrap();
        let times = table.column("t", None, "s").unwrap();
        let error = table.check_rising("t", &times, false).unwrap_err().to_string();
        assert!(error.contains("from line 4 to line 5"), "{error}");
    }

    #[test]
    fn words_and_matrices() {
        let read = |text: &str| Table::parse(text.to_owned(), Reading::WORDS).unwrap();
        let words = read("load [kN]; mech.model\n60,5; fastsim\n");
        assert_eq!(words.words(0).collect::<Vec<_>>(), ["60.5", "fastsim"]);
        let listed = read("load,set\n60 kN,\"[1, 2]\"\n");
        assert_eq!(listed.words(0).collect::<Vec<_>>(), ["60 kN", "[1, 2]"]);
        assert_eq!(read("load\n60 kN\n").words(0).collect::<Vec<_>>(), ["60 kN"]);
        assert_eq!(table("1 2\n3 4\n").unwrap().matrix().unwrap(), (2, vec![1.0, 2.0, 3.0, 4.0]));
        assert!(matches!(
            table("a b\n3 4\n").unwrap().matrix(),
            Err(TableError::Header { line: 1 })
        ));
    }

    /// No content of a file that is not a table reaches a message.
    #[test]
    fn contents_of_other_files_are_not_quoted() {
        let shadow = "root:*:20228:0:99999:7:::\ndaemon:*:20228:0:99999:7:::\n";
        let key = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef\n";
        for text in [shadow, key, "PASSWORD=secret word\nUSER=root\n", "secret, 1\nsecret, 2\n"] {
            for error in [column(text, "t", None, "s").unwrap_err(), three(text).unwrap_err()] {
                for word in ["root", "daemon", "20228", "abcdef", "secret", "PASSWORD", "USER"] {
                    assert!(!error.contains(word), "{error}");
                }
            }
        }
    }

    proptest! {
        /// Any text is parsed or refused.
        #[test]
        fn any_text(text in "[-0-9eEdDinfaxyzmk.,;:#%!\"() \\[\\]\t\r\n]{0,200}", words: bool, profile: bool) {
            let reading = match (words, profile) {
                (true, _) => Reading::WORDS,
                (false, true) => Reading::PROFILE,
                _ => Reading::NUMBERS,
            };
            if let Ok(table) = Table::parse(text, reading) {
                let _ = (table.matrix(), table.columns(&points()), table.column("x", Some("mm"), "m"));
                for row in 0..table.rows() {
                    prop_assert!(table.words(row).count() <= table.columns);
                }
                if let Ok(found) = table.columns(&points()) {
                    prop_assert!(found.iter().all(|column| column.len() == table.rows()));
                    prop_assert!(found.iter().flatten().all(|value| value.is_finite()));
                }
            }
        }

        #[test]
        fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            if let Ok(text) = input_file::into_text(bytes) {
                let _ = Table::parse(text, Reading::NUMBERS).map(|table| table.columns(&points()).is_ok());
            }
        }
    }
}
