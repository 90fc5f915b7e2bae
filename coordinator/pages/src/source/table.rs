//! A table of numbers with a head, from CSV.

/// Columns of numbers; an empty or foreign cell is not a number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    /// The table in this text. A last line that is cut off is left out.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let mut lines = text.lines();
        let head = lines.next().unwrap_or_default();
        let names: Vec<String> = head.split(',').map(str::to_owned).collect();
        let numbers = |line: &str| -> Vec<f64> {
            line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
        };
        let rows = lines.map(numbers).filter(|row| row.len() == names.len()).collect();
        Self { names, rows }
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// There is no row.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Names of the columns.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    /// The values of a column.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let at = self.names.iter().position(|other| other == name)?;
        Some(self.rows.iter().map(|row| row[at]).collect())
    }

    /// The names of the columns that end so, without the ending.
    pub fn ending<'a>(&'a self, ending: &'a str) -> impl Iterator<Item = &'a str> {
        self.names().filter_map(move |name| name.strip_suffix(ending))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_line_is_left_out_and_an_empty_cell_is_no_number() {
        let table = Table::parse("a,b_s\n1,2e-3\n,4\n5");
        assert_eq!(table.len(), 2);
        assert_eq!(table.column("b_s").unwrap(), [2e-3, 4.0]);
        assert!(table.column("a").unwrap()[1].is_nan());
        assert_eq!(table.ending("_s").collect::<Vec<_>>(), ["b"]);
        assert!(Table::parse("").is_empty());
    }
}
