//! Units that a header may carry instead of the one asked for: multiples of it.

/// Symbol, what it is a multiple of, and how many of that it is.
const MULTIPLES: [(&str, &str, f64); 28] = [
    ("m", "m", 1.0),
    ("mm", "m", 1e-3),
    ("cm", "m", 1e-2),
    ("um", "m", 1e-6),
    ("km", "m", 1e3),
    ("s", "s", 1.0),
    ("ms", "s", 1e-3),
    ("us", "s", 1e-6),
    ("min", "s", 60.0),
    ("h", "s", 3600.0),
    ("kg", "kg", 1.0),
    ("g", "kg", 1e-3),
    ("N", "N", 1.0),
    ("mN", "N", 1e-3),
    ("kN", "N", 1e3),
    ("Pa", "Pa", 1.0),
    ("kPa", "Pa", 1e3),
    ("MPa", "Pa", 1e6),
    ("GPa", "Pa", 1e9),
    ("V", "V", 1.0),
    ("mV", "V", 1e-3),
    ("kV", "V", 1e3),
    ("A", "A", 1.0),
    ("mA", "A", 1e-3),
    ("Hz", "Hz", 1.0),
    ("kHz", "Hz", 1e3),
    ("rad", "rad", 1.0),
    ("deg", "rad", std::f64::consts::PI / 180.0),
];

/// How many `to` one `from` is, where both are multiples of one unit.
pub(super) fn factor(from: &str, to: &str) -> Option<f64> {
    let find = |symbol: &str| MULTIPLES.iter().find(|(name, _, _)| *name == symbol.trim());
    let ((_, base, size), (_, wanted, per)) = (find(from)?, find(to)?);
    (base == wanted).then(|| size / per)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_of_one_unit_convert_and_others_do_not() {
        assert_eq!(factor("ms", "s"), Some(1e-3));
        assert_eq!(factor("m", "mm"), Some(1e3));
        assert_eq!(factor("V", "s"), None);
        assert_eq!(factor("furlong", "m"), None);
    }
}
