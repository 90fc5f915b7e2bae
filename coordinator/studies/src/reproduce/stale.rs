//! Whether a text that is kept says what a new one says.
//!
//! Words are compared as they are, numbers to one unit of the last digit that is kept: another
//! machine rounds otherwise. What stands between [`MEASURED`] and [`MEASURED_END`] is times, which no
//! two runs share, and is not compared; neither are pictures within pictures, whose values the
//! description tells.

/// Begins a block that is not compared.
pub(crate) const MEASURED: &str = "<!-- measured -->";
/// Ends it.
pub(crate) const MEASURED_END: &str = "<!-- /measured -->";

/// The first line that differs, and what stands there in each text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Difference {
    /// Line of the kept text, from 1.
    pub line: usize,
    /// What is kept.
    pub kept: String,
    /// What it would be now.
    pub new: String,
}

/// Where the kept text does not say what the new one says.
#[must_use]
pub(crate) fn difference(kept: &str, new: &str) -> Option<Difference> {
    let (mut ours, mut theirs) = (compared(kept), compared(new));
    loop {
        let (line, kept, new) = match (ours.next(), theirs.next()) {
            (None, None) => return None,
            (Some((_, kept)), Some((_, new))) if same(kept, new) => continue,
            (Some((line, kept)), new) => (line, kept, new.map_or("", |(_, new)| new)),
            (None, Some((_, new))) => (kept.lines().count() + 1, "", new),
        };
        return Some(Difference { line, kept: kept.to_owned(), new: new.to_owned() });
    }
}

/// The lines that count, with their numbers.
fn compared(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut measured = false;
    let counts = move |(_, line): &(usize, &str)| {
        measured = (measured || line.contains(MEASURED)) && !line.contains(MEASURED_END);
        !measured
    };
    text.lines().enumerate().map(|(n, line)| (n + 1, line)).filter(counts)
}

fn same(kept: &str, new: &str) -> bool {
    let embedded = |line: &str| line.contains("href=\"data:");
    if embedded(kept) && embedded(new) {
        return true;
    }
    let (kept, new) = (pieces(kept), pieces(new));
    kept.len() == new.len() && kept.iter().zip(&new).all(|(kept, new)| kept.is_as(new))
}

/// A number as it is written, or what stands between numbers.
#[derive(Clone, Debug, PartialEq)]
enum Piece<'a> {
    Words(&'a str),
    Number { value: f64, unit: f64 },
}

impl Piece<'_> {
    fn is_as(&self, new: &Self) -> bool {
        match (self, new) {
            (Self::Number { value, unit }, Self::Number { value: other, unit: others }) => {
                // A number of another length is another statement.
                unit == others && (value - other).abs() <= unit * (1.0 + 1e-6)
            }
            (one, other) => one == other,
        }
    }
}

fn pieces(line: &str) -> Vec<Piece<'_>> {
    let part = |c: char| c.is_ascii_digit() || c == '.';
    let mut pieces = Vec::new();
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let digits = part(first);
        let end = rest.find(|c| part(c) != digits).unwrap_or(rest.len());
        let (piece, after) = rest.split_at(end);
        pieces.push(number(piece).unwrap_or(Piece::Words(piece)));
        rest = after;
    }
    pieces
}

/// A number with the unit of its last digit; a sign belongs to the words before it.
fn number(text: &str) -> Option<Piece<'_>> {
    let value: f64 = text.parse().ok()?;
    let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    Some(Piece::Number { value, unit: 10f64.powi(-i32::try_from(decimals).ok()?) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_digit_may_differ_by_one() {
        assert_eq!(difference("at 226.9 K", "at 227.0 K"), None);
        let difference = difference("a\nat 226.9 K", "a\nat 227.1 K").unwrap();
        assert_eq!((difference.line, difference.new.as_str()), (2, "at 227.1 K"));
    }

    #[test]
    fn words_signs_and_lengths_count() {
        for (kept, new) in [
            ("rail 1.0", "wheel 1.0"),
            ("−0.84", "0.84"),
            ("0.84", "0.841"),
            ("one line", "one line\nand one more"),
            ("one line\nand one more", "one line"),
        ] {
            assert!(difference(kept, new).is_some(), "{kept} against {new}");
        }
    }

    #[test]
    fn times_are_not_compared() {
        let text = |time: &str| format!("a\n{MEASURED}\n{time}\n{MEASURED_END}\nb 2.0");
        assert_eq!(difference(&text("0.31 s"), &text("12 s\nand more")), None);
        assert!(difference(&text("0.31 s"), &text("0.31 s").replace("2.0", "3.0")).is_some());
    }
}
