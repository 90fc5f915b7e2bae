//! Figures of a summary, line by line, according to their descriptions.

use super::extremes::{Extremes, FigureRange};
use crate::format::{Scale, counted, number};
use contract::figure::{ENTRY, FigureSpec, Hidden, Style, value};
use serde_json::Value;

/// Ratio to a reference value below which a value counts as rounding.
const NOTHING: f64 = 1e-6;

/// Key for the name of an entry of a list.
const NAME: &str = "name";

/// A figure with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry<'a> {
    /// Description of the figure.
    pub figure: &'a FigureSpec,
    /// Value in the unit of the figure.
    pub value: f64,
}

/// Figures on one line.
#[derive(Clone, Debug, PartialEq)]
pub struct Line<'a> {
    /// Heading of the line.
    pub name: &'a str,
    /// Figures on the line.
    pub entries: Vec<Entry<'a>>,
}

/// A list of the summary, with one line for each entry.
#[derive(Clone, Debug, PartialEq)]
pub struct List<'a> {
    /// Word for an entry.
    pub name: &'a str,
    /// Figures that at least one entry has.
    pub figures: Vec<&'a FigureSpec>,
    /// Figures of each entry, in the order of the list. Figures of its line come first.
    pub rows: Vec<Vec<Entry<'a>>>,
    /// Name of each entry besides its number; empty if there is none.
    pub names: Vec<String>,
    /// Number of entries, including those that are not listed.
    pub count: usize,
}

/// One line, or a list of lines.
#[derive(Clone, Debug, PartialEq)]
pub enum Group<'a> {
    /// Figures of the run as a whole.
    Line(Line<'a>),
    /// Figures of the entries of a list.
    List(List<'a>),
}

/// Returns the figures of a summary, in their order. `sections` are those of the participants
/// ([`Summary::sections`](super::summary::Summary::sections)).
#[must_use]
pub fn groups<'a>(sections: &Value, figures: &'a [FigureSpec]) -> Vec<Group<'a>> {
    let mut names: Vec<&str> = Vec::new();
    for name in figures.iter().filter_map(|figure| figure.line.as_deref()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let group = |name: &'a str| {
        let own: Vec<_> =
            figures.iter().filter(|figure| figure.line.as_deref() == Some(name)).collect();
        match own[0].is_of_a_list() {
            true => list(sections, name, own, figures).map(Group::List),
            false => line(sections, name, &own).map(Group::Line),
        }
    };
    names.into_iter().filter_map(group).collect()
}

fn line<'a>(sections: &Value, name: &'a str, figures: &[&'a FigureSpec]) -> Option<Line<'a>> {
    let there =
        |&figure: &&'a FigureSpec| Entry::of(figure, value(sections, &figure.key)?, sections);
    let entries: Vec<_> = figures.iter().filter_map(there).collect();
    (!entries.is_empty()).then_some(Line { name, entries })
}

fn list<'a>(
    sections: &Value,
    name: &'a str,
    figures: Vec<&'a FigureSpec>,
    all: &'a [FigureSpec],
) -> Option<List<'a>> {
    let parts = |figure: &'a FigureSpec| figure.key.split_once(&format!(".{ENTRY}."));
    let (path, _) = parts(figures[0])?;
    // Figures without a line are only printed on pages, which have room for them.
    let beside = all.iter().filter(|figure| {
        figure.line.is_none() && parts(figure).is_some_and(|(other, _)| other == path)
    });
    let figures: Vec<&FigureSpec> = figures.into_iter().chain(beside).collect();
    let rows = sections.pointer(&format!("/{}", path.replace('.', "/")))?.as_array()?;
    let row = |row: &Value| {
        let entry = |&figure: &&'a FigureSpec| {
            let value = row.get(parts(figure)?.1)?.as_f64()?;
            Entry::of(figure, value, sections)
        };
        figures.iter().filter_map(entry).collect()
    };
    let counts = |figure: &&FigureSpec| figure.style == Style::Count && figure.short == name;
    let count = all.iter().find(counts).and_then(|figure| value(sections, &figure.key));
    let called = |row: &Value| row.get(NAME).and_then(Value::as_str).unwrap_or_default().to_owned();
    let names = rows.iter().map(called).collect();
    let rows: Vec<Vec<Entry>> = rows.iter().map(row).collect();
    let count = count.map_or(rows.len(), |count| count as usize);
    let known = |figure: &&FigureSpec| rows.iter().flatten().any(|entry| entry.figure == *figure);
    let figures = figures.into_iter().filter(known).collect();
    Some(List { name, figures, rows, names, count })
}

/// Returns whether a value is a rounding error of the figures that bound it, and stands for 0.
#[must_use]
pub fn is_rounding(figure: &FigureSpec, number: f64, sections: &Value) -> bool {
    let Hidden::Below(keys) = &figure.hidden else { return false };
    let bound: f64 = keys.iter().map(|key| value(sections, key).unwrap_or(0.0)).product();
    number.abs() <= NOTHING * bound.abs()
}

impl<'a> Entry<'a> {
    /// Returns a figure with its value, unless it is hidden.
    fn of(figure: &'a FigureSpec, number: f64, sections: &Value) -> Option<Self> {
        let other = |key: &String| value(sections, key);
        let hidden = match &figure.hidden {
            Hidden::Never => figure.style == Style::Count && number <= 1.0,
            Hidden::Zero => number == 0.0,
            Hidden::Below(_) => is_rounding(figure, number, sections),
            Hidden::Several(key) => other(key).is_some_and(|count| count > 1.0),
        };
        (!hidden).then_some(Self { figure, value: number })
    }

    /// Formats the value with its unit, to `digits` digits at most.
    #[must_use]
    pub fn number(&self, digits: usize) -> String {
        let Self { figure: FigureSpec { unit, digits: own, style, .. }, value } = *self;
        let digits = digits.min(*own);
        let plain = || Scale::of(unit, value).show(value, digits);
        match style {
            Style::Number => plain(),
            Style::Percent => format!("{}\u{a0}%", number(100.0 * value, digits)),
            Style::Signed if value < 0.0 => plain(),
            Style::Signed => format!("+{}", plain()),
            Style::Place => format!("{:.3}\u{a0}mm", 1e3 * value).replace('-', "−"),
            Style::Count => format!("{value}"),
        }
    }

    /// Formats the value with its name.
    #[must_use]
    pub fn text(&self, digits: usize) -> String {
        let FigureSpec { short, style, .. } = self.figure;
        match style {
            Style::Count => counted(self.value as u64, short),
            _ if short.is_empty() => self.number(digits),
            _ => format!("{short} {}", self.number(digits)),
        }
    }
}

/// Smallest and largest value of a figure over the windows of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Extreme<'a> {
    /// Description of the figure.
    pub figure: &'a FigureSpec,
    /// Smallest and largest value.
    pub values: [f64; 2],
    /// Windows of these values.
    pub windows: [u64; 2],
    /// Ends of these windows \[s\].
    pub times: [f64; 2],
    /// Word for a window.
    pub word: &'static str,
}

impl<'a> Extreme<'a> {
    /// Returns all extremes of a run, in the order of the figures.
    #[must_use]
    pub fn all(extremes: Option<&Extremes>, figures: &'a [FigureSpec]) -> Vec<Self> {
        let Some(extremes) = extremes else { return Vec::new() };
        let extreme = |figure: &'a FigureSpec| {
            let FigureRange { least, most, .. } = extremes.of(&figure.key)?;
            Some(Self {
                figure,
                values: [least.value, most.value],
                windows: [least.window, most.window],
                times: [least.end, most.end],
                word: extremes.word(),
            })
        };
        figures.iter().filter_map(extreme).collect()
    }

    /// Formats both values with their places, to `digits` digits at most. Rows need not have times.
    #[must_use]
    pub fn said(&self, digits: usize) -> [String; 2] {
        [0, 1].map(|n| {
            let value = Entry { figure: self.figure, value: self.values[n] }.number(digits);
            let (word, window, time) = (self.word, self.windows[n], self.times[n]);
            match (word, time) {
                ("row", 0.0) => format!("{value} in row {window}"),
                _ => {
                    let time = Scale::of("s", time).show(time, 4);
                    format!("{value} at {time} ({word} {window})")
                }
            }
        })
    }
}

impl List<'_> {
    /// Returns the indices of the entries with the largest headline figure, in ascending order.
    #[must_use]
    pub fn foremost(&self, most: usize) -> Vec<usize> {
        let weight = |row: usize| {
            let ranks = |entry: &&Entry| entry.figure.headline;
            self.rows[row].iter().find(ranks).map_or(0.0, |entry| entry.value)
        };
        let mut places: Vec<usize> = (0..self.rows.len()).collect();
        places.sort_by(|&a, &b| weight(b).total_cmp(&weight(a)));
        places.truncate(most);
        places.sort_unstable();
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::extremes::WindowValue;
    use serde_json::json;

    fn texts(entries: &[Entry]) -> Vec<String> {
        entries.iter().map(|entry| entry.text(9).replace('\u{a0}', " ")).collect()
    }

    #[test]
    fn a_line_has_what_is_more_than_nothing() {
        let figure =
            |key: &str, unit, short| FigureSpec::new(key, unit, "a figure").on("friction", short);
        let figures = [
            figure("contact.x_n", "N", "F_x").unless_below(&["contact.n_n"]),
            figure("contact.y_n", "N", "F_y").unless_below(&["contact.n_n"]),
            figure("contact.moment_nm", "Nm", "M_z").unless_below(&["contact.n_n", "contact.a_m"]),
            figure("contact.xi", "1", "ξ").style(Style::Percent).digits(4),
            figure("contact.eta", "1", "η").unless_zero(),
            figure("contact.rise_k", "K", "").style(Style::Signed),
            figure("contact.x_m", "m", "x").style(Style::Place),
            figure("contact.absent", "1", "absent"),
        ];
        let summary = json!({"contact": {
            "x_n": -2e-9, "y_n": -39642.9, "moment_nm": 7.981, "n_n": 134e3, "a_m": 8e-3,
            "xi": -0.002, "eta": 0.0, "rise_k": 298.2, "x_m": -3e-20,
        }});
        let groups = groups(&summary, &figures);
        let [Group::Line(line)] = &groups[..] else { panic!("{groups:?}") };
        assert_eq!(line.name, "friction");
        let expected =
            ["F_y −39.643 kN", "M_z 7.9810 N·m", "ξ −0.2000 %", "+298.20 K", "x −0.000 mm"];
        assert_eq!(texts(&line.entries), expected);
        assert_eq!(line.entries[0].number(3), "−39.6\u{a0}kN");
    }

    #[test]
    fn extremes_of_rows_name_the_rows() {
        let figures = [FigureSpec::new("contact.a_m", "m", "semi-axis").headline()];
        let told = |word: &str, times: [f64; 2]| {
            let [least, most] = [(6e-3, 1, times[0]), (8e-3, 2, times[1])]
                .map(|(value, window, end)| WindowValue { value, window, end });
            let range = FigureRange { key: "contact.a_m".to_owned(), least, most };
            let extremes = Extremes { rows: word == "row", windows: 3, figures: vec![range] };
            let all = Extreme::all(Some(&extremes), &figures);
            all[0].said(3).map(|text| text.replace('\u{a0}', " "))
        };
        assert_eq!(told("row", [0.0; 2]), ["6.00 mm in row 1", "8.00 mm in row 2"]);
        assert_eq!(
            told("row", [2.0, 3.0]),
            ["6.00 mm at 2.000 s (row 1)", "8.00 mm at 3.000 s (row 2)"]
        );
        assert_eq!(
            told("window", [0.0, 0.5]),
            ["6.00 mm at 0 s (window 1)", "8.00 mm at 500.0 ms (window 2)"]
        );
    }

    #[test]
    fn several_have_a_line_each() {
        let single = FigureSpec::new("contact.a_m", "m", "size").on("contact", "a");
        let figures = [
            FigureSpec::new("contact.count", "1", "number")
                .on("contact", "part")
                .style(Style::Count),
            single.unless_several("contact.count"),
            FigureSpec::new("contact.each.#.n_n", "N", "load").on("part", "N").headline(),
        ];
        let parts: Vec<Value> =
            [1.0, 3.0, 2.0].map(|load| json!({"name": "left", "n_n": load})).to_vec();
        let summary = json!({"contact": {"count": 5, "a_m": 1.0, "each": parts}});
        let all = groups(&summary, &figures);
        let [Group::Line(line), Group::List(list)] = &all[..] else { panic!("{all:?}") };
        assert_eq!(texts(&line.entries), ["5 parts"]);
        assert_eq!((list.name, list.count, list.foremost(2)), ("part", 5, vec![1, 2]));
        assert_eq!(texts(&list.rows[1]), ["N 3.0000 N"]);
        assert_eq!(list.names, ["left"; 3]);
        let one = json!({"contact": {"count": 1, "a_m": 1.0}});
        let all = groups(&one, &figures);
        let [Group::Line(line)] = &all[..] else { panic!("{all:?}") };
        assert_eq!(texts(&line.entries), ["a 1000.0 mm"]);
    }
}
