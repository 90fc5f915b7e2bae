//! Damaged configurations: no text leads to a panic, and every case is valid TOML.

use crate::texts::{FULL, SMALL};
use precice_config::{Configuration, ImportOptions, case_of};
use proptest::prelude::*;

/// A change of a text at a place between 0 and 1.
#[derive(Clone, Debug)]
enum Change {
    Delete(f64, usize),
    Insert(f64, &'static str),
    Repeat(f64, usize),
    Swap(f64, f64, usize),
}

const PIECES: [&str; 20] = [
    "<",
    ">",
    "/>",
    "\"",
    "'",
    "&",
    "<!--",
    "-->",
    "<![CDATA[",
    "]]>",
    "<?",
    ":",
    "x:",
    " ",
    "\n",
    "-1",
    "1e400",
    "ä\u{202e}",
    "\0",
    "xmlns:data=\"\"",
];

fn change() -> impl Strategy<Value = Change> {
    let place = || 0.0..1.0;
    prop_oneof![
        (place(), 1_usize..40).prop_map(|(at, length)| Change::Delete(at, length)),
        (place(), prop::sample::select(PIECES.to_vec())).prop_map(|(at, p)| Change::Insert(at, p)),
        (place(), 1_usize..200).prop_map(|(at, length)| Change::Repeat(at, length)),
        (place(), place(), 1_usize..20).prop_map(|(a, b, length)| Change::Swap(a, b, length)),
    ]
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
fn changed(text: &mut Vec<char>, change: &Change) {
    let count = text.len();
    let place = |share: f64| (share * count as f64) as usize;
    match *change {
        Change::Delete(at, length) => {
            let start = place(at);
            text.drain(start..count.min(start + length));
        }
        Change::Insert(at, piece) => {
            let start = place(at);
            text.splice(start..start, piece.chars());
        }
        Change::Repeat(at, length) => {
            let start = place(at);
            let part = text[start..count.min(start + length)].to_vec();
            text.splice(start..start, part);
        }
        Change::Swap(a, b, length) => {
            let (a, b) = (place(a), place(b));
            let most = count - a.max(b);
            (0..length.min(most)).for_each(|offset| text.swap(a + offset, b + offset));
        }
    }
}

fn import(text: &str) -> Result<(), TestCaseError> {
    let Ok(configuration) = Configuration::parse(text) else { return Ok(()) };
    let options = ImportOptions {
        name: "damaged".to_owned(),
        path: "a\"b.xml".to_owned(),
        ..ImportOptions::default()
    };
    let Ok(import) = case_of(&configuration, &options) else { return Ok(()) };
    let parsed = import.text.parse::<toml::Table>();
    prop_assert!(parsed.is_ok(), "{parsed:?}\n{}", import.text);
    let lines = text.matches('\n').count() + 1;
    let known =
        import.notes.iter().all(|note| note.lines.iter().all(|line| (1..=lines).contains(line)));
    prop_assert!(known, "{:?}", import.notes);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_damaged_text_is_read_or_refused(
        full in any::<bool>(),
        changes in prop::collection::vec(change(), 1..5),
    ) {
        let mut text: Vec<char> = if full { FULL } else { SMALL }.chars().collect();
        changes.iter().for_each(|change| changed(&mut text, change));
        import(&text.into_iter().collect::<String>())?;
    }

    /// Attributes with wrong values leave the text XML, so that reading goes on behind it.
    #[test]
    fn a_wrong_value_is_read_or_refused(
        place in 0.0..1.0,
        value in prop::sample::select(vec![
            "", "-1", "0", "1e300", "1e-300", "9223372036854775807", "true", "Force", "Point",
            "Left", "ä", "&#10;", "first-participant",
        ]),
    ) {
        let parts: Vec<&str> = FULL.split('"').collect();
        let values = parts.len() / 2;
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, clippy::cast_precision_loss)]
        let chosen = 2 * ((place * values as f64) as usize) + 1;
        let mut parts = parts;
        parts[chosen] = value;
        import(&parts.join("\""))?;
    }
}
