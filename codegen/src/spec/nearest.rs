//! Which of the known names did the user mean?

/// The candidate within a few typing slips of `word`; the first one of the nearest.
pub(super) fn nearest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let slips = (word.chars().count() / 3).clamp(1, 4);
    candidates
        .into_iter()
        .map(|c| (distance(word, c), c))
        .filter(|&(d, c)| d <= slips || is_abbreviation(word, c))
        .min_by_key(|&(d, _)| d)
        .map(|(_, c)| c)
}

/// `pos` for `position`, `fore_left_leg` for `fore_left`: three letters or more that open the other word.
fn is_abbreviation(word: &str, candidate: &str) -> bool {
    let (word, candidate) = (word.to_lowercase(), candidate.to_lowercase());
    let shorter = word.len().min(candidate.len());
    shorter >= 3 && (word.starts_with(&candidate) || candidate.starts_with(&word))
}

/// Insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b`; case is free.
fn distance(a: &str, b: &str) -> usize {
    // Words beyond any key's length differ by their length already; keeps the work bounded.
    let letters = |s: &str| s.to_lowercase().chars().take(64).collect::<Vec<_>>();
    let (a, b) = (letters(a), letters(b));
    let mut before_last: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for (i, &x) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, &y) in b.iter().enumerate() {
            let mut best = (last[j] + usize::from(x != y)).min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && x == b[j - 1] && a[i - 1] == y {
                best = best.min(before_last[j - 1] + 1);
            }
            row.push(best);
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_counts_slips() {
        for (a, b, d) in [
            ("", "", 0),
            ("mass", "mass", 0),
            ("mass", "Mass", 0),
            ("mas", "mass", 1),
            ("msas", "mass", 1),
            ("lenght", "length", 1),
            ("thigh", "shin", 3),
            ("", "ab", 2),
        ] {
            assert_eq!(distance(a, b), d, "{a} {b}");
            assert_eq!(distance(b, a), d, "{b} {a}");
        }
    }

    #[test]
    fn nearest_is_silent_where_nothing_is_near() {
        let keys = ["mass", "length", "com", "inertia"];
        assert_eq!(nearest("lenght", keys), Some("length"));
        assert_eq!(nearest("len", keys), Some("length"));
        assert_eq!(nearest("colour", keys), None);
        assert_eq!(nearest("", keys), None);
    }
}
