//! Text for a terminal: longer lines continue below, under the column in which they stand.

/// Width of a line.
pub const WIDTH: usize = 80;
/// Largest column under which a line continues.
const FARTHEST: usize = 46;

/// Entries after a head, three spaces apart; entries are not broken.
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

/// Wraps lines with columns that are two spaces or more apart. A line that is too long continues
/// under its last column, or else two characters further than its own indent.
#[must_use]
pub fn columns(text: &str) -> String {
    let lines = text.split('\n').map(|line| match line.chars().count() > WIDTH {
        true => wrapped(line),
        false => line.to_owned(),
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// An item of a list: a name in a column of `width`, and a text beside it. The text begins on the
/// next line if the name is wider than its column.
#[must_use]
pub fn item(name: &str, width: usize, text: &str) -> String {
    let indent = width + 2;
    let (above, line) = match name.chars().count() <= width {
        true => (String::new(), format!("{name:width$}  {text}")),
        false => (format!("{name}\n"), format!("{:indent$}{text}", "")),
    };
    format!("{above}{}\n", wrapped_at(&line, indent, indent))
}

fn wrapped(line: &str) -> String {
    let (kept, indent) = hanging(line);
    wrapped_at(line, kept, indent)
}

/// Wraps a line behind its first `kept` characters, with an indent of the lines below.
fn wrapped_at(line: &str, kept: usize, indent: usize) -> String {
    // The columns before the last one are not broken.
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

/// Start of the last column of a line, and indent of the lines below.
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
    // An indent alone is not a column.
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
    fn a_text_stands_beside_its_name() {
        let words = "word ".repeat(20);
        let beside = item("name", 10, words.trim());
        assert!(beside.lines().all(|line| line.chars().count() <= WIDTH), "{beside}");
        assert!(beside.starts_with("name        word"), "{beside}");
        assert!(beside.lines().nth(1).unwrap().starts_with("            word"), "{beside}");
        assert!(item("a_long_name", 10, "word").ends_with("name\n            word\n"));
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
        // A word longer than a line is not broken.
        assert_eq!(columns(&"x".repeat(90)), "x".repeat(90));
    }
}
