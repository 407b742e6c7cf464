//! The name somebody probably meant.

/// Names less alike than this are no help.
const ALIKE: f64 = 0.7;

/// The candidate most like `name`, if any is alike enough to be what was meant.
pub fn nearest_name<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let scored = candidates.into_iter().map(|candidate| (likeness(candidate, name), candidate));
    scored.filter(|(score, _)| *score >= ALIKE).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, candidate)| candidate)
}

/// From 0 (nothing in common) to 1 (the same but for capitals).
pub(crate) fn likeness(a: &str, b: &str) -> f64 {
    strsim::jaro_winkler(&a.to_lowercase(), &b.to_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_understood_and_a_stranger_is_not() {
        let names = ["pendulum", "rlc", "plate"];
        assert_eq!(nearest_name("pendullum", names), Some("pendulum"));
        assert_eq!(nearest_name("RLC", names), Some("rlc"));
        assert_eq!(nearest_name("xyz", names), None);
    }
}
