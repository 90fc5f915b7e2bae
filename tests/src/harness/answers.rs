//! Readers of results: figures of a summary, tables, fields.

use serde_json::Value;
use std::path::Path;

/// Returns a figure of a summary, by its JSON pointer.
pub fn number(value: &Value, pointer: &str) -> f64 {
    let number = value.pointer(pointer).and_then(Value::as_f64);
    number.unwrap_or_else(|| panic!("{pointer} is missing in {value}"))
}

/// Table with a header row.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Names of the columns.
    pub head: Vec<String>,
    /// Cells as text, row by row.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a CSV file.
    pub fn read(path: &Path) -> Self {
        let text = std::fs::read_to_string(path);
        let text = text.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let cells = |line: &str| line.split(',').map(str::to_owned).collect();
        let mut lines = text.lines().map(cells);
        let head = lines.next().unwrap_or_else(|| panic!("{} is empty", path.display()));
        Self { head, rows: lines.collect() }
    }

    /// Returns the index of a column.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.head.iter().position(|head| head == name)
    }

    fn at(&self, name: &str) -> usize {
        self.find(name).unwrap_or_else(|| panic!("no column `{name}` in {:?}", self.head))
    }

    /// Returns a column as text.
    pub fn texts(&self, name: &str) -> Vec<&str> {
        let at = self.at(name);
        self.rows.iter().map(|row| row[at].as_str()).collect()
    }

    /// Returns a column of numbers.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        self.columns([name]).concat()
    }

    /// Returns columns of numbers, row by row.
    pub fn columns<const N: usize>(&self, names: [&str; N]) -> Vec<[f64; N]> {
        let at = names.map(|name| self.at(name));
        self.rows.iter().map(|row| at.map(|column| parsed(&row[column]))).collect()
    }

    /// Returns all numbers of a row.
    pub fn row(&self, index: usize) -> Vec<f64> {
        self.rows[index].iter().map(|cell| parsed(cell)).collect()
    }

    /// Keeps only columns whose name passes `wanted`.
    pub fn of(self, wanted: impl Fn(&str) -> bool) -> Self {
        let keep: Vec<bool> = self.head.iter().map(|name| wanted(name)).collect();
        let pick = |cells: Vec<String>| {
            let kept = cells.into_iter().zip(&keep).filter(|(_, keep)| **keep);
            kept.map(|(cell, _)| cell).collect()
        };
        Self { head: pick(self.head), rows: self.rows.into_iter().map(pick).collect() }
    }
}

fn parsed(cell: &str) -> f64 {
    cell.parse().unwrap_or_else(|_| panic!("`{cell}` is no number"))
}

/// Reads a field with one component from the appended data of an image (`.vti`). The data are raw
/// doubles after their size in bytes, at the offset given by the element with this name.
pub fn field(path: &Path, name: &str) -> Vec<f64> {
    const MARK: &[u8] = b"<AppendedData encoding=\"raw\">\n_";
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mark = bytes.windows(MARK.len()).position(|window| window == MARK).unwrap();
    let head = String::from_utf8(bytes[..mark].to_vec()).unwrap();
    let element = head.lines().find(|line| line.contains(&format!("Name=\"{name} [")));
    let element = element.unwrap_or_else(|| panic!("no `{name}` in {}", path.display()));
    let offset = element.split("offset=\"").nth(1).unwrap().split('"').next().unwrap();
    let data = &bytes[mark + MARK.len() + offset.parse::<usize>().unwrap()..];
    let length = u64::from_le_bytes(*data.first_chunk().unwrap()) as usize;
    data[8..8 + length].as_chunks().0.iter().map(|value| f64::from_le_bytes(*value)).collect()
}

/// Returns all files in `fields` of a result folder, sorted by name; empty if there is no such
/// folder.
pub fn field_files(out: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(out.join("fields")).into_iter().flatten().flatten();
    let read = |entry: std::fs::DirEntry| {
        (entry.file_name().into_string().unwrap(), std::fs::read(entry.path()).unwrap())
    };
    let mut files: Vec<_> = entries.map(read).collect();
    files.sort();
    files
}
