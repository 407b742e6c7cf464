//! A name with a unit, and the power of ten that makes its numbers easy to read.

use super::text;

/// What an axis or a colour shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Quantity {
    name: String,
    unit: String,
}

/// A quantity as it is printed: divide by `factor` and write `label`.
pub(super) struct Shown {
    pub(super) factor: f64,
    pub(super) label: String,
}

/// Units that take a prefix. Compounds and kilograms do not: they get a power of ten.
const PREFIXABLE: [&str; 9] = ["m", "N", "Pa", "V", "A", "J", "W", "Hz", "rad"];
const PREFIXES: [(i32, &str); 7] = [(-12, "p"), (-9, "n"), (-6, "µ"), (-3, "m"), (3, "k"), (6, "M"), (9, "G")];

impl Quantity {
    /// For instance `Quantity::new("f", "N")`; the unit is empty for a plain number.
    pub fn new(name: &str, unit: &str) -> Quantity {
        Quantity { name: name.to_string(), unit: unit.to_string() }
    }

    /// The name as it is set in a label.
    pub(super) fn symbol(&self) -> String {
        text::symbol(&self.name)
    }

    /// Label without scaling, for logarithmic axes.
    pub(super) fn label(&self) -> String {
        labelled(&self.symbol(), &text::unit(&self.unit))
    }

    /// How to show values up to `largest` in size.
    pub(super) fn shown(&self, largest: f64) -> Shown {
        let power = if largest.is_finite() && largest > 0.0 { engineering(largest) } else { 0 };
        let unit = match PREFIXES.iter().find(|(exponent, _)| *exponent == power) {
            _ if power == 0 => text::unit(&self.unit),
            Some((_, prefix)) if PREFIXABLE.contains(&self.unit.as_str()) => format!("{prefix}{}", self.unit),
            // A plain space after a raised part is lost by some renderers.
            _ => format!("10^{{{}}}\u{a0}{}", power.to_string().replace('-', "−"), text::unit(&self.unit)),
        };
        Shown { factor: 10f64.powi(power), label: labelled(&self.symbol(), unit.trim()) }
    }
}

fn labelled(symbol: &str, unit: &str) -> String {
    if unit.is_empty() { symbol.to_string() } else { format!("{symbol} [{unit}]") }
}

/// The multiple of three that brings `largest` between 1 and 1000; none between 0.1 and 10 000.
fn engineering(largest: f64) -> i32 {
    if (0.1..1e4).contains(&largest) {
        return 0;
    }
    // The nudge keeps 1e-3 from rounding to 1000e-6.
    ((largest.log10() + 1e-9) / 3.0).floor() as i32 * 3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown_in_a_readable_range() {
        let label = |name, unit, largest| Quantity::new(name, unit).shown(largest).label;
        assert_eq!(label("f", "N", 0.074), "f [mN]");
        assert_eq!(label("f", "Pa", 54e3), "f [kPa]");
        assert_eq!(label("q", "m", 0.11), "q [m]");
        assert_eq!(label("a", "m/s^2", 2e-5), "a [10^{−6}\u{a0}m/s^{2}]");
        assert_eq!(label("nu", "", 0.3), "ν");
        assert_eq!(Quantity::new("f", "N").shown(1e-3).factor, 1e-3);
    }
}
