//! A surrogate evaluates to the sum of its terms, and a damaged file is refused or evaluated.

use crate::*;
use proptest::prelude::*;

/// A power law of two keys, and a polynomial of a quotient.
fn document() -> Document {
    let key = |key: &str, from, to| Key { key: key.to_owned(), unit: "N".to_owned(), from, to };
    let held = |measure| HeldOutError { measure, largest: 0.01, rms: 0.002 };
    let [e, p] = [1.0f64.exp(), 2.0f64.exp()];
    Document {
        schema: SCHEMA,
        origin: Origin { case: "small".to_owned(), points: 30, ..Origin::default() },
        keys: vec![key("load.a", e, p), key("load.b", 1.0, 4.0)],
        coordinates: vec![
            Coordinate { key: "load.a".to_owned(), per: None, from: e, to: p },
            Coordinate {
                key: "load.b".to_owned(),
                per: Some("load.a".to_owned()),
                from: 0.25,
                to: 1.25,
            },
        ],
        figures: vec![
            FittedFigure {
                key: "contact.law".to_owned(),
                words: "law".to_owned(),
                held: held(Measure::Relative),
                scale: Scale::Log,
                negative: true,
                scales: vec![Scale::Log, Scale::Linear],
                // s = 2 ln a - 3, and ln y = 3/2 + s/2 = ln a.
                degrees: vec![vec![0, 0], vec![1, 0]],
                coefficients: vec![1.5, 0.5],
            },
            FittedFigure {
                key: "contact.square".to_owned(),
                words: "square".to_owned(),
                held: held(Measure::Absolute),
                scale: Scale::Linear,
                negative: false,
                scales: vec![Scale::Log, Scale::Linear],
                // T_2 (T_1 of a's logarithm).
                degrees: vec![vec![1, 2]],
                coefficients: vec![3.0],
            },
        ],
    }
}

#[test]
fn figures_are_the_sums_of_their_terms() {
    let surrogate = Surrogate::new(&document()).unwrap();
    let mut room = surrogate.room();
    let (a, b) = (4.0f64, 2.5f64);
    let found = surrogate.ask(&[a, b], &mut room).unwrap();
    let (s, t) = (2.0 * a.ln() - 3.0, 2.0 * (b / a) - 1.5);
    // Rounding of a few operations.
    assert!((found[0] + a).abs() < 1e-14 * a, "{found:?}");
    assert!((found[1] - 3.0 * s * (2.0 * t * t - 1.0)).abs() < 1e-14, "{found:?}");
    assert_eq!(surrogate.figures()[0].held.bound(found[0]), 0.01 * -found[0]);
    assert_eq!(surrogate.figures()[1].held.bound(found[1]), 0.01);
    let square = document().only(&["contact.square"]).unwrap();
    let alone = Surrogate::new(&square).unwrap();
    let both = found[1];
    assert_eq!(alone.ask(&[a, b], &mut alone.room()), Ok([both].as_slice()));
    assert_eq!(document().only(&["contact.cube"]).unwrap_err(), "contact.cube");
}

#[test]
fn a_point_outside_is_refused_with_its_bounds() {
    let surrogate = Surrogate::new(&document()).unwrap();
    let told = |at: &[f64]| surrogate.admit(at).unwrap_err().to_string();
    assert_eq!(told(&[4.0, 4.5]), "load.b = 4.5 N is outside 1 to 4 N, the range of the surrogate");
    assert!(told(&[4.0, f64::NAN]).contains("load.b = NaN N is outside"));
    assert!(
        told(&[3.0, 4.0]).contains("load.b/load.a = 1.3333333333333333 is outside 0.25 to 1.25")
    );
    assert!(told(&[3.0]).contains("1 values, but the surrogate has 2 keys"));
    assert_eq!(surrogate.admit(&[4.0, 4.0]), Ok(()));
}

/// The coefficients are finite, but their exponential is not.
#[test]
fn a_figure_that_overflows_is_refused() {
    let mut document = document();
    document.figures[0].coefficients = vec![800.0, 0.0];
    let surrogate = Surrogate::new(&document).unwrap();
    let refused = surrogate.ask(&[4.0, 2.0], &mut surrogate.room()).unwrap_err();
    assert_eq!(refused, Refused::NotFinite { figure: "contact.law".to_owned() });
    assert!(refused.to_string().contains("contact.law has no finite value here"), "{refused}");
}

#[test]
fn a_file_is_what_was_written() {
    let text = serde_json::to_vec(&document()).unwrap();
    assert_eq!(Document::read(&text).unwrap(), document());
    let long = vec![b' '; LONGEST + 1];
    assert!(matches!(Document::read(&long), Err(Fault::Long(_))));
    let newer = String::from_utf8(text).unwrap().replace("\"schema\":1", "\"schema\":2");
    assert!(matches!(Document::read(newer.as_bytes()), Err(Fault::Version(2))));
}

/// Each change invalidates the document and is reported.
#[test]
fn what_cannot_be_is_refused() {
    type Change = fn(&mut Document);
    let wrong: [(Change, &str); 12] = [
        (|d| d.keys.clear(), "keys: there are 0"),
        (|d| d.figures.clear(), "figures: there are 0"),
        (|d| d.keys[1].key = "load.a".to_owned(), "load.a: defined twice"),
        (|d| d.keys[0].from = d.keys[0].to, "not an interval"),
        (|d| d.keys[0].from = f64::NAN, "not an interval"),
        (|d| d.coordinates[0].key = "load.c".to_owned(), "which does not exist"),
        (|d| d.keys[0].from = -1.0, "load.a: its range includes 0"),
        (|d| d.coordinates[0].from = 0.0, "logarithm of a coordinate"),
        (|d| d.figures[0].scales.truncate(1), "its number of scales differs"),
        (|d| d.figures[0].coefficients.truncate(1), "needs a coefficient"),
        (|d| d.figures[1].degrees[0][1] = LARGEST_DEGREE + 1, "a degree is above"),
        (|d| d.figures[1].held.rms = -1.0, "an error is negative"),
    ];
    for (change, words) in wrong {
        let mut document = document();
        change(&mut document);
        let told = Surrogate::new(&document).unwrap_err().to_string();
        assert!(told.contains(words), "{words}: {told}");
    }
}

/// Evaluates the sum of the terms directly.
fn plainly(document: &Document, at: &[f64]) -> Vec<f64> {
    let x = |one: &Coordinate| {
        let value = |key: &str| at[document.place(key).unwrap()];
        one.per.as_ref().map_or(value(&one.key), |per| value(&one.key) / value(per))
    };
    let factor = |(n, degree): (usize, &u8), scales: &[Scale]| {
        let one = &document.coordinates[n];
        let scaled = |x: f64| if scales[n] == Scale::Log { x.ln() } else { x };
        let [x, from, to] = [x(one), one.from, one.to].map(scaled);
        // T_n = cos(n arccos s).
        (f64::from(*degree) * ((2.0 * x - from - to) / (to - from)).clamp(-1.0, 1.0).acos()).cos()
    };
    let figure = |one: &FittedFigure| {
        let term = |degrees: &Vec<u8>| {
            degrees.iter().enumerate().map(|each| factor(each, &one.scales)).product::<f64>()
        };
        let sum: f64 = one.degrees.iter().zip(&one.coefficients).map(|(d, c)| c * term(d)).sum();
        let sign = if one.negative { -1.0 } else { 1.0 };
        if one.scale == Scale::Log { sign * sum.exp() } else { sum }
    };
    document.figures.iter().map(figure).collect()
}

prop_compose! {
    fn figures()(
        scales in prop::collection::vec(prop::bool::ANY, 2),
        log in prop::bool::ANY,
        terms in prop::collection::vec(([0u8..6, 0u8..6], -1.0..1.0), 1..9),
    ) -> FittedFigure {
        let scale = |log: &bool| if *log { Scale::Log } else { Scale::Linear };
        let (degrees, coefficients) = terms.into_iter().map(|(d, c)| (d.to_vec(), c)).unzip();
        let scales = scales.iter().map(scale).collect();
        FittedFigure { scale: scale(&log), negative: false, scales, degrees, coefficients, ..document().figures[0].clone() }
    }
}

/// Overwrites bytes at places given as a fraction of the length.
fn edited(text: &[u8], edits: &[(f64, Vec<u8>)]) -> Vec<u8> {
    let mut text = text.to_vec();
    for (part, bytes) in edits {
        let from = (part * text.len() as f64) as usize;
        let to = (from + bytes.len()).min(text.len());
        text.splice(from..to, bytes.iter().copied());
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(fuzz_cases()))]

    /// Shared products give the same values as separate ones. The arc cosine loses some digits at
    /// the ends.
    #[test]
    fn shared_products_change_nothing(all in prop::collection::vec(figures(), 1..5), a in 0.0..1.0, b in 0.0..1.0) {
        let named = |(n, one): (usize, FittedFigure)| FittedFigure { key: n.to_string(), ..one };
        let document = Document { figures: all.into_iter().enumerate().map(named).collect(), ..document() };
        let surrogate = Surrogate::new(&document).unwrap();
        let between = |key: &Key, part: f64| key.from + part * (key.to - key.from);
        let at = [between(&document.keys[0], a), between(&document.keys[1], b)];
        if let Ok(found) = surrogate.ask(&at, &mut surrogate.room()) {
            for (found, plain) in found.iter().zip(plainly(&document, &at)) {
                prop_assert!((found - plain).abs() <= 1e-6 * plain.abs().max(1.0), "{found} {plain}");
            }
        }
    }

    #[test]
    fn any_bytes_are_refused_or_evaluated(
        edits in prop::collection::vec((0.0..1.0, prop::collection::vec(prop::sample::select(&b"0123456789.eE-+[]{}\",:\xff\0 nulltrue"[..]), 1..5)), 0..4)
    ) {
        let text = edited(&serde_json::to_vec(&document()).unwrap(), &edits);
        if let Ok(surrogate) = Surrogate::read(&text) {
            let at: Vec<f64> = surrogate.keys().iter().map(|key| 0.5 * (key.from + key.to)).collect();
            let mut room = surrogate.room();
            let _ = surrogate.ask(&at, &mut room);
        }
    }
}

/// Number of fuzz cases: 400, or the value of `FUZZ_CASES`.
fn fuzz_cases() -> u32 {
    std::env::var("FUZZ_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(400)
}
