//! Units as headers of tables have them: `m/s^2`, `m s^-2`, `m_s2`, `N_per_m`, `mg/(l s)`.

use num_traits::Signed;

use crate::Dimension;
use crate::frame::{Declared, File, Number, Scale};
use crate::rational::{Rational, ratio};
use crate::table::{Symbol, look_up};

/// More parts than this are no unit.
const MOST_PARTS: usize = 8;

/// A unit as a header has it: symbols with their exponents.
struct Written {
    parts: Vec<(Symbol, Rational)>,
    /// True where signs are not written: `m_s2` is `m/s^2`, and `N_m` is a torque or a stiffness.
    is_loose: bool,
}

/// Scales of temperature that begin elsewhere than the kelvin's: a degree in kelvins, and the scale's zero in kelvins.
const SCALES: [(&str, f64, f64); 8] = [
    ("degC", 1.0, 273.15),
    ("°C", 1.0, 273.15),
    ("℃", 1.0, 273.15),
    ("celsius", 1.0, 273.15),
    ("Celsius", 1.0, 273.15),
    ("degF", 5.0 / 9.0, 459.67 * 5.0 / 9.0),
    ("°F", 5.0 / 9.0, 459.67 * 5.0 / 9.0),
    ("℉", 5.0 / 9.0, 459.67 * 5.0 / 9.0),
];

/// How a number in the unit of a header becomes one in the unit that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    scale: Scale<File, Declared>,
    /// What is added then: 273.15 from degrees Celsius to kelvins, zero but for temperatures.
    shift: Number<Declared>,
}

impl Conversion {
    /// The number in the unit that is asked for; to the bit, sign of zero included, where that is the header's.
    pub fn of(&self, number: Number<File>) -> Number<Declared> {
        let scaled = self.scale.of(number);
        if self.shift == Number::declared(0.0) { scaled } else { scaled + self.shift }
    }
}

/// How numbers in a unit `from` become numbers in a unit `to`, both as headers have them; nothing where one of them is no unit, or
/// where they are of different dimensions. A plain number is written `` or `1`. Degrees Celsius and Fahrenheit can stand alone, in
/// `from`.
///
/// Where underscores part symbols, all but the first have the signs with which the dimensions agree.
pub fn conversion(from: &str, to: &str) -> Option<Conversion> {
    if let Some((degree, zero)) = scale(from) {
        let kelvin = factor("K", to)?;
        return Some(Conversion { scale: Scale::new(degree * kelvin), shift: Number::declared(zero * kelvin) });
    }
    Some(Conversion { scale: Scale::new(factor(from, to)?), shift: Number::declared(0.0) })
}

/// A scale of temperature: a degree and the zero, in kelvins.
fn scale(text: &str) -> Option<(f64, f64)> {
    let found = SCALES.iter().find(|(name, ..)| *name == text.trim())?;
    Some((found.1, found.2))
}

/// How many units `to` one unit `from` is.
fn factor(from: &str, to: &str) -> Option<f64> {
    let (from, to) = (Written::read(from)?, Written::read(to)?);
    to.all().find_map(|to| {
        let from = from.all().find(|from| from.dimension == to.dimension)?;
        let power: f64 = format!("1e{}", from.exponent - to.exponent).parse().ok()?;
        Some(from.coefficient / to.coefficient * power)
    })
}

/// True if a text is a unit, as headers have them.
pub fn is_unit(text: &str) -> bool {
    scale(text).is_some() || Written::read(text).is_some_and(|written| !written.parts.is_empty())
}

impl Written {
    fn read(text: &str) -> Option<Self> {
        let mut parts = Vec::new();
        // The sign of what follows: of one symbol behind `/`, of all between parentheses, of all behind `per`.
        let (mut next, mut within, mut after) = (1, 1, 1);
        for part in split(text) {
            match part {
                "" | " " | "*" | "·" | "." | "_" | "1" => {}
                "/" => next = -1,
                "(" => (within, next) = (next, 1),
                ")" => within = 1,
                "per" => after = -1,
                _ => {
                    let (symbol, exponent) = power(part)?;
                    parts.push((symbol, exponent * ratio(next * within * after, 1)));
                    next = 1;
                }
            }
        }
        let is_loose = text.contains('_') && !text.contains(['/', '^', '-']) && !text.contains("per");
        (parts.len() <= MOST_PARTS).then_some(Self { parts, is_loose })
    }

    /// All units that may be meant, those with every symbol but the first below the line first.
    fn all(&self) -> impl Iterator<Item = Symbol> + '_ {
        let free = if self.is_loose { self.parts.len().saturating_sub(1) } else { 0 };
        (0..1_u32 << free).filter_map(move |above| {
            let mut unit = Symbol { dimension: Dimension::none(), coefficient: 1.0, exponent: 0 };
            for (at, (symbol, exponent)) in self.parts.iter().enumerate() {
                let is_below = self.is_loose && at > 0 && above & 1 << (at - 1) == 0;
                let exponent = if is_below { -*exponent } else { *exponent };
                unit.dimension = unit.dimension.times(&symbol.dimension.power(exponent)?)?;
                let times = i32::try_from(exponent.to_integer()).ok()?;
                unit.coefficient *= symbol.coefficient.powi(times);
                unit.exponent += symbol.exponent * times;
            }
            Some(unit)
        })
    }
}

/// A text at its separators, which are parts too. A point parts what is before a letter, and belongs to numbers elsewhere.
fn split(text: &str) -> impl Iterator<Item = &str> {
    let is_end = move |(at, c): &(usize, char)| match c {
        '.' => text[at + 1..].starts_with(char::is_alphabetic),
        _ => "/*· _()".contains(*c),
    };
    let mut begin = 0;
    let ends = text.char_indices().filter(is_end).map(|(at, c)| at + c.len_utf8()).chain([text.len()]);
    let parts = ends.map(move |end| &text[std::mem::replace(&mut begin, end)..end]);
    parts.flat_map(|part| {
        let end = part
            .char_indices()
            .next_back()
            .filter(|(_, last)| "/*·. _()".contains(*last))
            .map_or(part.len(), |(at, _)| at);
        [&part[..end], &part[end..]]
    })
}

/// A symbol with a whole exponent: `s`, `s2`, `s^2`, `s^-2`, `s-2`, `s²`.
fn power(part: &str) -> Option<(Symbol, Rational)> {
    let symbol = part.trim_end_matches(|c: char| c.is_ascii_digit() || "^-²³".contains(c));
    let exponent = match part[symbol.len()..].trim_start_matches('^') {
        "" => 1,
        "²" => 2,
        "³" => 3,
        digits => digits.parse().ok()?,
    };
    let exponent = ratio(exponent, 1);
    (exponent.abs() < ratio(100, 1)).then_some(())?;
    Some((look_up(symbol)?, exponent))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_one_dimension_convert_and_others_do_not() {
        let found = |from, to| factor(from, to).map(|found| (found * 1e12).round() / 1e12);
        assert_eq!(found("ms", "s"), Some(1e-3));
        assert_eq!(found("m", "mm"), Some(1e3));
        assert_eq!(found("V", "s"), None);
        assert_eq!(found("furlong", "m"), None);
        assert_eq!(found("mm/s", "m/s"), Some(1e-3));
        assert_eq!(found("km/h", "m/s"), Some(0.277_777_777_778));
        assert_eq!(found("mg/l", "kg/m^3"), Some(1e-3));
        assert_eq!(found("J/(kg K)", "kJ kg^-1 K^-1"), Some(1e-3));
        assert_eq!(found("N*m", "J"), Some(1.0));
        assert_eq!(found("N.m", "J"), Some(1.0));
        assert_eq!(found("W.m-2.K-1", "W/(m^2 K)"), Some(1.0));
        assert_eq!(found("%", "1"), Some(0.01));
        assert_eq!(found("1/min", "Hz"), Some(0.016_666_666_667));
    }

    #[test]
    fn underscores_part_symbols_whose_signs_are_those_of_the_other_unit() {
        assert_eq!(factor("mm_s2", "m/s^2"), Some(1e-3));
        assert_eq!(factor("N_m", "N m"), Some(1.0));
        assert_eq!(factor("N_m", "N/m"), Some(1.0));
        assert_eq!(factor("mN_per_m", "N/m"), Some(1e-3));
        assert_eq!(factor("W_m_K", "W/(m K)"), Some(1.0));
        assert_eq!(factor("m_s", "m^2"), None);
    }

    #[test]
    fn temperatures_begin_elsewhere() {
        let converted = |from, to, number| Some(conversion(from, to)?.of(Number::file(number)).as_declared());
        let kelvins = |from, number| Some((converted(from, "K", number)? * 1e9).round() / 1e9);
        assert_eq!(kelvins("degC", -40.0), Some(233.15));
        assert_eq!(kelvins("°F", -40.0), Some(233.15));
        assert_eq!(kelvins("mK", 1.0), Some(1e-3));
        assert_eq!(converted("degC", "mK", 1.0), Some(274_150.0));
        assert!(conversion("degC", "s").is_none() && conversion("degC/s", "K/s").is_none());
    }

    #[test]
    fn words_are_no_units() {
        assert!(is_unit("m_s2") && is_unit("W/(m^2 K)"));
        for text in ["m.1", "m^2.1", "1.1 m", "", "1", "in", "obs", "m_obs", "sigma0.01", "s^x", "m^1000", "left"] {
            assert!(!is_unit(text), "{text}");
        }
    }
}
