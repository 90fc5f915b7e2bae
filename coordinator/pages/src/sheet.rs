//! Arranges several drawings on one sheet, as a self-contained SVG. Colours are written out instead
//! of style-sheet variables, which many programs do not support.

use super::html::{PLOT_STYLE, escape};
use super::maps::FieldDrawing;
use std::collections::HashMap;
use std::fmt::Write as _;

/// Space between drawings.
const GAP: f64 = 16.0;

/// Colour scheme of the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// Dark on light, for paper.
    Light,
    /// Light on dark, for slides.
    Dark,
}

/// Arranges the drawings in rows of `columns`.
#[must_use]
pub fn sheet(title: &str, maps: &[FieldDrawing], columns: usize, ground: Ground) -> String {
    let mut inner = String::new();
    let (mut right, mut top) = (0.0f64, GAP);
    for row in maps.chunks(columns.max(1)) {
        let (mut left, mut height) = (GAP, 0.0f64);
        for map in row {
            let (svg, size) = map.drawing().with_title();
            let _ = write!(inner, "<g transform=\"translate({left} {top:.2})\">\n{svg}</g>\n");
            left += size[0] + GAP;
            height = height.max(size[1]);
        }
        right = right.max(left);
        top += height + GAP;
    }
    format!(
        "<svg class=\"plot\" role=\"img\" width=\"{right:.0}\" height=\"{top:.0}\" \
         viewBox=\"0 0 {right:.0} {top:.0}\" xmlns=\"http://www.w3.org/2000/svg\">\n<title>{}</title>\n\
         <style>\n{}</style>\n<rect class=\"ground\" width=\"100%\" height=\"100%\"/>\n{inner}</svg>\n",
        escape(title),
        resolved(PLOT_STYLE, ground)
    )
}

/// Replaces the variables of a style sheet by their values, and drops media queries.
fn resolved(style: &str, ground: Ground) -> String {
    let mut values = HashMap::new();
    let mut rules: Vec<(&str, &str)> = Vec::new();
    let mut rest = style;
    while let Some((selector, after)) = rest.split_once('{') {
        let end = closing(after);
        let (selector, body) = (selector.trim(), &after[..end]);
        rest = after.get(end + 1..).unwrap_or_default();
        match (selector, ground) {
            (":root", _) => values.extend(declarations(body)),
            (other, Ground::Dark) if other.starts_with("@media") && other.contains("dark") => {
                let inner = body.split_once('{').map_or("", |(_, inner)| inner);
                values.extend(declarations(inner.trim_end().trim_end_matches('}')));
            }
            (other, _) if other.starts_with('@') => {}
            _ => rules.push((selector, body)),
        }
    }
    // Classes that set a variable, with the name and value of the variable.
    let given: Vec<(&str, &str, &str)> = rules
        .iter()
        .flat_map(|(selector, body)| {
            declarations(body).filter(|(n, _)| n.starts_with("--")).map(|(n, v)| (*selector, n, v))
        })
        .collect();
    let mut out = String::new();
    for (selector, body) in &rules {
        let setters = given.iter().filter(|(_, name, _)| body.contains(&format!("var({name})")));
        let mut setters = setters.peekable();
        if setters.peek().is_none() && !body.trim_start().starts_with("--") {
            let _ = writeln!(out, "{selector} {{{}}}", with_values(body, &values));
        }
        for (class, name, value) in setters {
            let each: Vec<String> =
                selector.split(',').map(|part| format!("{}{class}", part.trim())).collect();
            let body = body.replace(&format!("var({name})"), value);
            let _ = writeln!(out, "{} {{{}}}", each.join(", "), with_values(&body, &values));
        }
    }
    out
}

/// Index of the closing brace that matches the open one.
fn closing(text: &str) -> usize {
    let mut depth = 1;
    let at = text.char_indices().find(|(_, c)| {
        depth += i32::from(*c == '{') - i32::from(*c == '}');
        depth == 0
    });
    at.map_or(text.len(), |(n, _)| n)
}

/// Names and values of the declarations in a rule.
fn declarations(body: &str) -> impl Iterator<Item = (&str, &str)> {
    body.split(';').filter_map(|one| one.split_once(':')).map(|(n, v)| (n.trim(), v.trim()))
}

fn with_values(body: &str, values: &HashMap<&str, &str>) -> String {
    let mut text = body.to_owned();
    for (name, value) in values {
        text = text.replace(&format!("var({name})"), value);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    const STYLE: &str = ":root { color-scheme: light dark; --ink: #111; --s0: #00f; --s1: #f00; }\n\
        @media (prefers-color-scheme: dark) { :root { --ink: #eee; --s0: #aaf; } }\n\
        .line { stroke: var(--c); fill: none; } .dot, .piece { fill: var(--c); }\n\
        .tick { fill: var(--ink); } .s0 { --c: var(--s0); } .s1 { --c: var(--s1); }";

    #[test]
    fn variables_are_written_out() {
        let light = resolved(STYLE, Ground::Light);
        for rule in [".line.s0 { stroke: #00f; fill: none; }", ".tick { fill: #111; }"] {
            assert!(light.contains(rule), "{light}");
        }
        assert!(light.contains(".dot.s1, .piece.s1 { fill: #f00; }"), "{light}");
        assert!(!light.contains("var(") && !light.contains("media"), "{light}");
        let dark = resolved(STYLE, Ground::Dark);
        assert!(
            dark.contains(".tick { fill: #eee; }") && dark.contains(".line.s0 { stroke: #aaf;")
        );
    }

    #[test]
    fn the_style_of_plots_has_no_variable_left() {
        for ground in [Ground::Light, Ground::Dark] {
            let style = resolved(PLOT_STYLE, ground);
            assert!(!style.contains("var(") && !style.contains("--"), "{style}");
            assert!(style.contains(".line.s5") && style.contains(".edge1"), "{style}");
        }
    }
}
