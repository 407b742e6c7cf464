//! Dimensions as people read them.

use std::fmt;

use num_traits::{One, Signed, Zero};

use super::table::look_up;
use super::{BASES, Dimension};
use crate::rational::Rational;

const BASE_SYMBOLS: [&str; BASES] = ["m", "kg", "s", "A", "K", "mol", "cd"];

/// kg first, as physicists write it.
const ORDER: [usize; BASES] = [1, 0, 2, 3, 4, 5, 6];

/// Derived units worth recognising.
const NAMED: [&str; 11] = ["N", "Pa", "J", "W", "V", "C", "F", "Ohm", "H", "T", "Wb"];

/// `N`, `kg m^2/s^2`, `1/s`, `1`: spelled so that the unit parser reads it back.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = NAMED.iter().find(|symbol| look_up(symbol).is_some_and(|found| found.dimension == *self));
        if let Some(symbol) = named {
            return f.write_str(symbol);
        }
        let (above, below): (Vec<usize>, Vec<usize>) =
            ORDER.iter().filter(|&&base| !self.0[base].is_zero()).partition(|&&base| self.0[base].is_positive());
        let write = |bases: &[usize]| -> Vec<String> {
            bases.iter().map(|&base| power_of(BASE_SYMBOLS[base], self.0[base].abs())).collect()
        };
        let (above, below) = (write(&above), write(&below));
        f.write_str(if above.is_empty() { "1" } else { "" })?;
        f.write_str(&above.join(" "))?;
        match below.len() {
            0 => Ok(()),
            1 => write!(f, "/{}", below[0]),
            _ => write!(f, "/({})", below.join(" ")),
        }
    }
}

fn power_of(symbol: &str, exponent: Rational) -> String {
    if exponent.is_one() {
        symbol.to_string()
    } else if exponent.is_integer() {
        format!("{symbol}^{exponent}")
    } else {
        format!("{symbol}^({exponent})")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rational::ratio;

    #[test]
    fn dimensions_read_as_units() {
        let length = Dimension::length();
        let mass = Dimension::base(1);
        let time = Dimension::base(2);
        assert_eq!(Dimension::none().to_string(), "1");
        assert_eq!(length.power(ratio(1, 2)).unwrap().to_string(), "m^(1/2)");
        let force = mass.times(&length).unwrap().over(&time.power(ratio(2, 1)).unwrap()).unwrap();
        assert_eq!(force.to_string(), "N");
        let stiffness = force.over(&length).unwrap();
        assert_eq!(stiffness.to_string(), "kg/s^2");
        assert_eq!(Dimension::none().over(&length).unwrap().over(&time).unwrap().to_string(), "1/(m s)");
    }
}
