//! Suggestions of the nearest valid word ("did you mean").

/// Maximum length of a word that may be a typing error \[bytes\].
const LONGEST: usize = 64;

/// Returns the candidate nearest to `word`, with at most about one error per three letters.
#[must_use]
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.len() > LONGEST {
        return None;
    }
    let plain = normal(word);
    let limit = (plain.chars().count() / 3).max(1);
    candidates
        .into_iter()
        .map(|candidate| (strsim::damerau_levenshtein(&plain, &normal(candidate)), candidate))
        .filter(|(distance, _)| *distance <= limit)
        // Among equally near candidates, prefer one with the same first letter.
        .min_by_key(|(distance, candidate)| {
            (*distance, candidate.chars().next() != word.chars().next())
        })
        .map(|(_, candidate)| candidate)
}

/// Normalises case and separators, which people overlook.
fn normal(word: &str) -> String {
    word.to_lowercase().replace(['-', ' '], "_")
}

/// Joins words as "a, b or c".
#[must_use]
pub fn any_of<S: AsRef<str>>(words: &[S]) -> String {
    join(words, "or")
}

/// Joins words as "a, b and c".
#[must_use]
pub fn all_of<S: AsRef<str>>(words: &[S]) -> String {
    join(words, "and")
}

fn join<S: AsRef<str>>(words: &[S], last: &str) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words.split_last() {
        None => String::new(),
        Some((only, [])) => (*only).to_owned(),
        Some((end, rest)) => format!("{} {last} {end}", rest.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_found_and_strangers_are_not() {
        let words = ["half-space", "hertz-carter", "fastsim", "speed"];
        assert_eq!(nearest("halfspace", words), Some("half-space"));
        assert_eq!(nearest("Half_Space", words), Some("half-space"));
        assert_eq!(nearest("sped", words), Some("speed"));
        assert_eq!(nearest("kNN", ["nN", "kN"]), Some("kN"));
        assert_eq!(nearest("columns", words), None);
        assert_eq!(nearest(&"x".repeat(100_000), words), None);
        assert_eq!(nearest("", words), None);
    }

    #[test]
    fn lists_read_like_sentences() {
        assert_eq!(any_of(&["a", "b", "c"]), "a, b or c");
        assert_eq!(all_of(&["a", "b"]), "a and b");
        assert_eq!(all_of(&["a"]), "a");
        assert_eq!(any_of::<&str>(&[]), "");
    }
}
