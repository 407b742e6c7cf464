//! The units that can be written, as data.

use super::{BASES, Dimension};
use crate::rational::ratio;

/// A unit symbol's meaning: `coefficient * 10^exponent` of the SI unit of a dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbol {
    /// Its dimension.
    pub dimension: Dimension,
    /// Kept apart from the power of ten, so that `mg` and `uPa` come out correctly rounded.
    pub coefficient: f64,
    /// The power of ten.
    pub exponent: i32,
}

struct Row {
    symbol: &'static str,
    coefficient: f64,
    exponent: i32,
    prefixes: bool,
    /// Exponents of m, kg, s, A, K, mol, cd.
    bases: [i8; BASES],
}

const fn row(symbol: &'static str, coefficient: f64, exponent: i32, prefixes: bool, bases: [i8; BASES]) -> Row {
    Row { symbol, coefficient, exponent, prefixes, bases }
}

#[rustfmt::skip]
const UNITS: &[Row] = &[
    //                                         m  kg  s  A  K mol cd
    row("m",   1.0, 0, true,                  [1, 0, 0, 0, 0, 0, 0]),
    row("g",   1.0, -3, true,                 [0, 1, 0, 0, 0, 0, 0]),
    row("s",   1.0, 0, true,                  [0, 0, 1, 0, 0, 0, 0]),
    row("A",   1.0, 0, true,                  [0, 0, 0, 1, 0, 0, 0]),
    row("K",   1.0, 0, true,                  [0, 0, 0, 0, 1, 0, 0]),
    row("mol", 1.0, 0, true,                  [0, 0, 0, 0, 0, 1, 0]),
    row("cd",  1.0, 0, true,                  [0, 0, 0, 0, 0, 0, 1]),
    row("N",   1.0, 0, true,                  [1, 1, -2, 0, 0, 0, 0]),
    row("Pa",  1.0, 0, true,                  [-1, 1, -2, 0, 0, 0, 0]),
    row("J",   1.0, 0, true,                  [2, 1, -2, 0, 0, 0, 0]),
    row("W",   1.0, 0, true,                  [2, 1, -3, 0, 0, 0, 0]),
    row("V",   1.0, 0, true,                  [2, 1, -3, -1, 0, 0, 0]),
    row("C",   1.0, 0, true,                  [0, 0, 1, 1, 0, 0, 0]),
    row("F",   1.0, 0, true,                  [-2, -1, 4, 2, 0, 0, 0]),
    row("Ohm", 1.0, 0, true,                  [2, 1, -3, -2, 0, 0, 0]),
    row("ohm", 1.0, 0, true,                  [2, 1, -3, -2, 0, 0, 0]),
    row("Ω",   1.0, 0, true,                  [2, 1, -3, -2, 0, 0, 0]),
    row("S",   1.0, 0, true,                  [-2, -1, 3, 2, 0, 0, 0]),
    row("H",   1.0, 0, true,                  [2, 1, -2, -2, 0, 0, 0]),
    row("T",   1.0, 0, true,                  [0, 1, -2, -1, 0, 0, 0]),
    row("Wb",  1.0, 0, true,                  [2, 1, -2, -1, 0, 0, 0]),
    row("Hz",  1.0, 0, true,                  [0, 0, -1, 0, 0, 0, 0]),
    row("lm",  1.0, 0, true,                  [0, 0, 0, 0, 0, 0, 1]),
    row("lx",  1.0, 0, true,                  [-2, 0, 0, 0, 0, 0, 1]),
    row("rad", 1.0, 0, true,                  [0, 0, 0, 0, 0, 0, 0]),
    row("sr",  1.0, 0, true,                  [0, 0, 0, 0, 0, 0, 0]),
    row("deg", std::f64::consts::PI / 180.0, 0, false, [0, 0, 0, 0, 0, 0, 0]),
    row("%",   1.0, -2, false,                [0, 0, 0, 0, 0, 0, 0]),
    row("min", 60.0, 0, false,                [0, 0, 1, 0, 0, 0, 0]),
    row("h",   3600.0, 0, false,              [0, 0, 1, 0, 0, 0, 0]),
    row("d",   86400.0, 0, false,             [0, 0, 1, 0, 0, 0, 0]),
    // Of 365.25 days.
    row("year", 31557600.0, 0, false,         [0, 0, 1, 0, 0, 0, 0]),
    row("yr",  31557600.0, 0, false,          [0, 0, 1, 0, 0, 0, 0]),
    row("week", 604800.0, 0, false,           [0, 0, 1, 0, 0, 0, 0]),
    row("day", 86400.0, 0, false,             [0, 0, 1, 0, 0, 0, 0]),
    row("L",   1.0, -3, true,                 [3, 0, 0, 0, 0, 0, 0]),
    row("l",   1.0, -3, true,                 [3, 0, 0, 0, 0, 0, 0]),
    row("t",   1.0, 3, true,                  [0, 1, 0, 0, 0, 0, 0]),
    row("bar", 1.0, 5, true,                  [-1, 1, -2, 0, 0, 0, 0]),
    row("atm", 101_325.0, 0, false,           [-1, 1, -2, 0, 0, 0, 0]),
    row("psi", 6_894.757_293_168_361, 0, false, [-1, 1, -2, 0, 0, 0, 0]),
    row("mmHg", 133.322_387_415, 0, false,    [-1, 1, -2, 0, 0, 0, 0]),
    row("Torr", 101_325.0 / 760.0, 0, false,  [-1, 1, -2, 0, 0, 0, 0]),
    row("P",   1.0, -1, true,                 [-1, 1, -1, 0, 0, 0, 0]),
    row("M",   1.0, 3, true,                  [-3, 0, 0, 0, 0, 1, 0]),
    row("cal", 4.184, 0, true,                [2, 1, -2, 0, 0, 0, 0]),
    row("kgf", 9.806_65, 0, false,            [1, 1, -2, 0, 0, 0, 0]),
    row("lbf", 4.448_221_615_260_5, 0, false, [1, 1, -2, 0, 0, 0, 0]),
    row("lb",  0.453_592_37, 0, false,        [0, 1, 0, 0, 0, 0, 0]),
    row("inch", 25.4, -3, false,              [1, 0, 0, 0, 0, 0, 0]),
    row("ft",  0.3048, 0, false,              [1, 0, 0, 0, 0, 0, 0]),
    // An angle in a time: 2 pi radians a minute.
    row("rpm", std::f64::consts::PI / 30.0, 0, false, [0, 0, -1, 0, 0, 0, 0]),
    row("ppm", 1.0, -6, false,                [0, 0, 0, 0, 0, 0, 0]),
    row("ppb", 1.0, -9, false,                [0, 0, 0, 0, 0, 0, 0]),
    row("mph", 0.447_04, 0, false,            [1, 0, -1, 0, 0, 0, 0]),
    // Of 550 foot-pounds in a second.
    row("hp",  745.699_871_582_270_2, 0, false, [2, 1, -3, 0, 0, 0, 0]),
    row("eV",  1.602_176_634, -19, true,      [2, 1, -2, 0, 0, 0, 0]),
];

const PREFIXES: &[(&str, i32)] = &[
    ("da", 1),
    ("T", 12),
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("h", 2),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("n", -9),
    ("p", -12),
    ("f", -15),
];

/// What a unit symbol means: the symbol as it stands first (`min`, `Pa`), then prefix and symbol (`mm`).
pub fn look_up(text: &str) -> Option<Symbol> {
    if let Some(row) = UNITS.iter().find(|row| row.symbol == text) {
        return Some(scaled(row, 0));
    }
    PREFIXES.iter().find_map(|(prefix, exponent)| {
        let rest = text.strip_prefix(prefix)?;
        let row = UNITS.iter().find(|row| row.prefixes && row.symbol == rest)?;
        Some(scaled(row, *exponent))
    })
}

/// All symbols without prefixes, for suggestions.
pub fn known_symbols() -> impl Iterator<Item = &'static str> {
    UNITS.iter().map(|row| row.symbol)
}

fn scaled(row: &Row, exponent: i32) -> Symbol {
    Symbol {
        dimension: Dimension(row.bases.map(|base| ratio(i128::from(base), 1))),
        coefficient: row.coefficient,
        exponent: row.exponent + exponent,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_symbol_wins_over_a_prefix() {
        assert_eq!(look_up("min").unwrap().coefficient, 60.0);
        assert_eq!(look_up("kg").unwrap().exponent, 0);
        assert_eq!(look_up("Pa").unwrap().exponent, 0);
        assert_eq!(look_up("mT").unwrap().exponent, -3);
        assert_eq!(look_up("kdeg"), None);
    }
}
