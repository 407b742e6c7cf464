//! The name that a misspelt one was probably meant to be.

/// Names longer than this are not compared: distances cost the product of lengths.
const LONGEST: usize = 40;

/// The candidate with the fewest edits, if they are few for its length; ties go to the first.
pub(crate) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let length = name.chars().count();
    if length > LONGEST {
        return None;
    }
    let allowed = match length {
        0 | 1 => 0,
        2..=3 => 1,
        4..=8 => 2,
        _ => 3,
    };
    let close = candidates.into_iter().map(|candidate| (edits(name, candidate), candidate));
    let best = close.filter(|(distance, _)| *distance <= allowed).min_by_key(|(distance, _)| *distance);
    best.map(|(_, candidate)| candidate)
}

/// Levenshtein distance, with a change of case for free.
fn edits(from: &str, to: &str) -> usize {
    let lower = |text: &str| text.to_lowercase().chars().collect::<Vec<_>>();
    let (from, to) = (lower(from), lower(to));
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (index, a) in from.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = index + 1;
        for (column, b) in to.iter().enumerate() {
            let changed = diagonal + usize::from(a != b);
            diagonal = row[column + 1];
            row[column + 1] = changed.min(row[column] + 1).min(diagonal + 1);
        }
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn typing_errors_find_their_name_and_strangers_do_not() {
        assert_eq!(nearest("lamda", ["mu", "lambda"]), Some("lambda"));
        assert_eq!(nearest("E_BB", ["E_bb"]), Some("E_bb"));
        assert_eq!(nearest("q", ["f", "t"]), None);
        assert_eq!(nearest("pressure", ["E", "nu"]), None);
    }
}
