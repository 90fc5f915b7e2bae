//! Comparison of sweeps whose tables must agree except for run times.

use super::Table;
use std::path::Path;

/// Table of a sweep without run times.
pub fn table(out: &Path) -> Table {
    let mut table = Table::read(&out.join("sweep.csv"));
    let wall = table.find("wall_s").unwrap();
    table.head.remove(wall);
    for row in &mut table.rows {
        row.remove(wall);
    }
    table
}

/// Points finished so far, as lines of their file.
pub fn points(folder: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join("points.jsonl")).unwrap_or_default();
    let whole = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
    whole.filter(|line| line.starts_with("{\"point")).map(str::to_owned).collect()
}
