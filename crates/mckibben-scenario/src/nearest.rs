//! The nearest known word to a misspelt one, for "did you mean".
//!
//! The distance is the number of letters inserted, left out, replaced or swapped with their neighbour (optimal string
//! alignment). Case and the choice between `_` and `-` cost less than a letter, so that `PSI` finds `psi` and
//! `gauge-pressure` finds `gauge_pressure`.

/// Words longer than this are not compared: no mistyped unit has 64 letters, and the cost grows with the square.
const LONGEST: usize = 64;

/// Cost of one wrong letter. Costs are whole numbers; a wrong case costs 1.
const LETTER: usize = 4;

/// Costs of making `from` into `to`, in quarters of a letter.
fn distance(from: &[char], to: &[char]) -> usize {
    let fold = |c: char| if c == '-' { '_' } else { c.to_ascii_lowercase() };
    let replace = |a: char, b: char| match (a == b, fold(a) == fold(b)) {
        (true, _) => 0,
        (false, true) => 1,
        (false, false) => LETTER,
    };
    // Three rows of the usual table: two back for swapped letters, one back, and the one in the making.
    let mut before: Vec<usize> = vec![0; to.len() + 1];
    let mut last: Vec<usize> = (0..=to.len()).map(|j| j * LETTER).collect();
    for i in 1..=from.len() {
        let mut row = vec![i * LETTER; to.len() + 1];
        for j in 1..=to.len() {
            let mut best =
                (last[j - 1] + replace(from[i - 1], to[j - 1])).min(last[j] + LETTER).min(row[j - 1] + LETTER);
            if i > 1 && j > 1 && fold(from[i - 1]) == fold(to[j - 2]) && fold(from[i - 2]) == fold(to[j - 1]) {
                best = best.min(before[j - 2] + LETTER);
            }
            row[j] = best;
        }
        before = std::mem::replace(&mut last, row);
    }
    last[to.len()]
}

/// The candidate nearest to `word`, or `None` when all of them are too far to have been meant.
///
/// One wrong letter in three is allowed, and at least one. Of equals the first wins.
pub(crate) fn nearest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let word: Vec<char> = word.chars().take(LONGEST + 1).collect();
    if word.is_empty() || word.len() > LONGEST {
        return None;
    }
    let allowed = LETTER * (word.len() / 3).max(1);
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        let letters: Vec<char> = candidate.chars().collect();
        let cost = distance(&word, &letters);
        // A candidate that shares no letter with the word is no suggestion, however short both are.
        let related = cost < LETTER * word.len().max(letters.len());
        if cost <= allowed && related && best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// The candidates nearest to `word`, at most `most` of them, the nearest first: those that contain it before the others.
pub fn nearest_few<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>, most: usize) -> Vec<&'c str> {
    let letters: Vec<char> = word.chars().take(LONGEST).collect();
    let cost = |candidate: &str| {
        let others: Vec<char> = candidate.chars().take(LONGEST).collect();
        (word.is_empty() || !candidate.contains(word), distance(&letters, &others))
    };
    let mut ranked: Vec<((bool, usize), &str)> = candidates.into_iter().map(|of| (cost(of), of)).collect();
    ranked.sort_by_key(|(cost, _)| *cost);
    ranked.into_iter().take(most).map(|(_, candidate)| candidate).collect()
}

#[cfg(test)]
mod tests {
    use super::{nearest, nearest_few};

    #[test]
    fn ranks_what_contains_the_word_first() {
        let names = ["velocity.max", "length.max", "gauge_pressure.max", "length.final"];
        assert_eq!(nearest_few("pressure.max", names, 1), ["gauge_pressure.max"]);
        assert_eq!(nearest_few("lenght.final", names, 2), ["length.final", "length.max"]);
    }

    #[test]
    fn finds_what_was_meant() {
        let units = ["psi", "Pa", "kPa", "in", "min", "MPa", "mPa"];
        assert_eq!(nearest("PSI", units), Some("psi"));
        assert_eq!(nearest("psgi", units), Some("psi"));
        assert_eq!(nearest("kpa", units), Some("kPa"));
        let keys = ["thread_length", "turns", "gauge_pressure"];
        assert_eq!(nearest("thread-lenght", keys), Some("thread_length"));
        assert_eq!(nearest("trns", keys), Some("turns"));
    }

    #[test]
    fn is_silent_when_nothing_is_near() {
        assert_eq!(nearest("q", ["psi", "m"]), None);
        assert_eq!(nearest("colour", ["psi", "turns"]), None);
        assert_eq!(nearest("", ["psi"]), None);
        assert_eq!(nearest(&"x".repeat(1000), ["psi"]), None);
    }
}
