//! Where solvers of local functions start.

/// Values of all heads in natural sizes: their offsets first, others where a logarithm or a root has no value there.
const LEVELS: [f64; 5] = [0.0, 1.0, -1.0, 0.1, -0.1];

/// The first level of all heads at which a problem `has_value`; zero if there is none.
pub(crate) fn level(mut has_value: impl FnMut(f64) -> bool) -> f64 {
    LEVELS.into_iter().find(|&level| has_value(level)).unwrap_or(0.0)
}
