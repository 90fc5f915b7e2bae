//! Colours on a terminal: of outcomes, and of the names at the beginning of lines.

use clap::ColorChoice;
use std::ffi::OsString;
use std::io::IsTerminal;
use std::sync::OnceLock;

/// Condition for colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Colours {
    /// On a terminal, unless NO_COLOR is set.
    #[default]
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

static CHOSEN: OnceLock<Colours> = OnceLock::new();

/// Sets the choice of the whole process. Later calls have no effect.
pub fn choose(colours: Colours) {
    let _ = CHOSEN.set(colours);
}

/// Returns the choice for help and errors of the command line, which are printed before the options
/// are parsed.
#[must_use]
pub fn of_help(arguments: impl Iterator<Item = OsString>) -> ColorChoice {
    let words: Vec<String> = arguments.map(|word| word.to_string_lossy().into_owned()).collect();
    let apart = words.windows(2).filter(|pair| pair[0] == "--color").map(|pair| pair[1].as_str());
    let joined = words.iter().filter_map(|word| word.strip_prefix("--color="));
    match apart.chain(joined).next() {
        Some("always") => ColorChoice::Always,
        Some("never") => ColorChoice::Never,
        _ => ColorChoice::Auto,
    }
}

/// Returns true if text for this stream is coloured.
#[must_use]
pub fn on(stream: &impl IsTerminal) -> bool {
    match CHOSEN.get().copied().unwrap_or_default() {
        Colours::Always => true,
        Colours::Never => false,
        Colours::Auto => stream.is_terminal() && !no_color(),
    }
}

/// Returns true if the user wants no colours (no-color.org).
fn no_color() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
}

const GOOD: &str = "32";
const BAD: &str = "1;31";
const WARNING: &str = "33";
const NAME: &str = "36";
const TITLE: &str = "1";

/// Returns a text in a colour.
#[must_use]
fn paint(text: &str, code: &str) -> String {
    format!("\x1b[{code}m{text}\x1b[0m")
}

/// Returns the word `error` that precedes a message.
#[must_use]
pub fn error(coloured: bool) -> String {
    if coloured { paint("error", BAD) } else { "error".to_owned() }
}

/// Colours the title in the first line, and the name at the beginning of each further line.
#[must_use]
pub fn named_lines(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 256);
    for (n, line) in text.split_inclusive('\n').enumerate() {
        let (line, end) = line.strip_suffix('\n').map_or((line, ""), |line| (line, "\n"));
        out += &if n == 0 { paint(line, TITLE) } else { named(line) };
        out += end;
    }
    out
}

fn named(line: &str) -> String {
    let indent = line.len() - line.trim_start().len();
    let rest = &line[indent..];
    let word = rest.split([' ', ':']).next().unwrap_or_default();
    let code = match word {
        "warning" => WARNING,
        "completed" | "converged" => GOOD,
        "failed" => BAD,
        // A name stands at the beginning of a line, before two spaces.
        _ if indent <= 2 && rest[word.len()..].starts_with("  ") => NAME,
        _ => return line.to_owned(),
    };
    format!("{}{}{}", &line[..indent], paint(word, code), &rest[word.len()..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_names_are_coloured_and_the_text_stays() {
        let text = "case · title\n  completed: done\n  contact   a 8 mm\n            more\n";
        let coloured = named_lines(text);
        for part in
            ["\x1b[1mcase · title\x1b[0m", "\x1b[32mcompleted\x1b[0m:", "\x1b[36mcontact\x1b[0m "]
        {
            assert!(coloured.contains(part), "{coloured:?}");
        }
        let mut plain = coloured.clone();
        for code in ["0", TITLE, GOOD, NAME] {
            plain = plain.replace(&format!("\x1b[{code}m"), "");
        }
        assert_eq!(plain, text);
    }
}
