//! Where solvers of local functions start.

/// Values of all heads in natural sizes: their offsets first, others where a logarithm or a root has no value there.
const LEVELS: [f64; 5] = [0.0, 1.0, -1.0, 0.1, -0.1];
/// How far from a level there must be values too: at the end of a root there is no slope.
const AROUND: f64 = 1e-3;

/// The first level of all heads around which a problem `has_value`; zero if there is none.
pub(crate) fn level(mut has_value: impl FnMut(f64) -> bool) -> f64 {
    let mut is_inside = |level: &f64| has_value(level - AROUND) && has_value(level + AROUND);
    LEVELS.into_iter().find(|level| is_inside(level)).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_root_is_no_start() {
        assert_eq!(level(|x| x.sqrt().is_finite()), 1.0);
        assert_eq!(level(|x| (-x).sqrt().is_finite()), -1.0);
        assert_eq!(level(f64::is_finite), 0.0);
    }
}
