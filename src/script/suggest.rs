//! "Did you mean".

/// Longer words are no misspellings, and comparing them would take long.
const LONGEST_WORD: usize = 64;

/// Scripts written by hand know fewer names; those of a generator need no suggestions.
const CANDIDATES: usize = 1000;

/// The nearest of the known words, if one is near.
///
/// Near is an optimal string alignment distance, case ignored, of at most a third of the word's
/// length, but of one at least; a single letter is near only to itself in the other case.
pub fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let length = word.chars().count();
    if length > LONGEST_WORD {
        return None;
    }
    let lower = word.to_lowercase();
    let allowed = if length == 1 { 0 } else { (length / 3).max(1) };
    known
        .take(CANDIDATES)
        .filter(|candidate| {
            candidate.chars().count().abs_diff(length) <= allowed && *candidate != word
        })
        .map(|candidate| {
            let distance = strsim::osa_distance(&lower, &candidate.to_lowercase());
            (distance, strsim::osa_distance(word, candidate), candidate)
        })
        .filter(|(distance, _, _)| *distance <= allowed)
        .min_by_key(|(distance, exact, _)| (*distance, *exact))
        .map(|(_, _, candidate)| candidate)
}

/// A help line: "did you mean `neo-hookean`?" and `otherwise`, or just `otherwise`.
pub fn help<'a>(word: &str, known: impl Iterator<Item = &'a str>, otherwise: &str) -> String {
    match nearest(word, known) {
        Some(near) if otherwise.is_empty() => format!("did you mean `{near}`?"),
        Some(near) => format!("did you mean `{near}`? {otherwise}"),
        None => otherwise.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORDS: [&str; 4] = ["linear", "neo-hookean", "rigid", "ulmpm"];

    #[test]
    fn near_words_are_found() {
        assert_eq!(nearest("neohookean", WORDS.into_iter()), Some("neo-hookean"));
        assert_eq!(nearest("lienar", WORDS.into_iter()), Some("linear"));
        assert_eq!(nearest("uLMPm", WORDS.into_iter()), Some("ulmpm"));
        assert_eq!(nearest("X", ["y", "x"].into_iter()), Some("x"));
    }

    #[test]
    fn far_words_are_not() {
        assert_eq!(nearest("water", WORDS.into_iter()), None);
        assert_eq!(nearest("q", ["x", "y"].into_iter()), None);
        assert_eq!(nearest(&"linear".repeat(20), WORDS.into_iter()), None);
        assert_eq!(nearest("linear", [].into_iter()), None);
    }

    #[test]
    fn help_is_one_line() {
        assert_eq!(
            help("rigit", WORDS.into_iter(), "see the list"),
            "did you mean `rigid`? see the list"
        );
        assert_eq!(help("rigit", WORDS.into_iter(), ""), "did you mean `rigid`?");
        assert_eq!(help("fluid", WORDS.into_iter(), "see the list"), "see the list");
    }
}
