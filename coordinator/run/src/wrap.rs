//! Text for people in lines of a terminal's width: what is longer goes on below, under the column in
//! which it stands.

/// Width of a line.
pub const WIDTH: usize = 80;
/// The farthest to the right that a line goes on.
const FARTHEST: usize = 46;

/// A head and what it is about, with three spaces between entries; entries stay whole.
#[must_use]
pub fn entries(head: &str, all: &[&str]) -> String {
    let mut out = head.to_owned();
    let indent = head.chars().count();
    let mut column = indent;
    for (n, entry) in all.iter().enumerate() {
        let length = entry.chars().count();
        if n > 0 && column + 3 + length > WIDTH {
            out.push('\n');
            out += &" ".repeat(indent);
            column = indent;
        } else if n > 0 {
            out += "   ";
            column += 3;
        }
        out += entry;
        column += length;
    }
    out
}

/// A text whose lines have columns, two spaces or more apart: a line that is too long goes on under its
/// last column, or under its beginning.
#[must_use]
pub fn columns(text: &str) -> String {
    let lines = text.split('\n').map(|line| match line.chars().count() > WIDTH {
        true => wrapped(line),
        false => line.to_owned(),
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn wrapped(line: &str) -> String {
    let (kept, indent) = hanging(line);
    // What stands before the last column stays as it is.
    let mut out: String = line.chars().take(kept).collect();
    let mut column = kept;
    let rest: String = line.chars().skip(kept).collect();
    for (n, word) in rest.split(' ').enumerate() {
        let length = word.chars().count();
        if n > 0 && column + 1 + length > WIDTH && column > indent {
            out.push('\n');
            out += &" ".repeat(indent);
            column = indent;
        } else if n > 0 {
            out.push(' ');
            column += 1;
        }
        out += word;
        column += length;
    }
    out
}

/// Where the last column of a line begins, and where the line goes on.
fn hanging(line: &str) -> (usize, usize) {
    let mut found = None;
    let mut spaces = 0;
    for (n, c) in line.chars().enumerate().take(FARTHEST) {
        if c != ' ' && spaces > 1 {
            found = Some(n);
        }
        spaces = if c == ' ' { spaces + 1 } else { 0 };
    }
    let indent = line.chars().take_while(|c| *c == ' ').count();
    // An indent alone is no column.
    found.filter(|at| *at > indent).map_or((indent, indent + 2), |at| (at, at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_stay_whole() {
        let entry = "x".repeat(30);
        let text = entries("  head      ", &[&entry, &entry, &entry]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], format!("  head      {entry}   {entry}"));
        assert_eq!(lines[1], format!("{}{entry}", " ".repeat(12)));
    }

    #[test]
    fn a_line_goes_on_under_its_last_column() {
        let words = "word ".repeat(20);
        let text = columns(&format!("effects    on  name    {}\nshort", words.trim()));
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines.iter().all(|line| line.chars().count() <= WIDTH), "{text}");
        assert!(lines[1].starts_with(&format!("{}word", " ".repeat(23))), "{text}");
        assert_eq!(lines.last(), Some(&"short"));
        let plain = columns(words.trim());
        assert!(plain.lines().nth(1).is_some_and(|line| line.starts_with("  word")), "{plain}");
        // One word that is longer than a line stays.
        assert_eq!(columns(&"x".repeat(90)), "x".repeat(90));
    }
}
