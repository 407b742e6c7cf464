//! Frames of numbers: a number's type says in which units it is.
//!
//! | frame | units |
//! |---|---|
//! | [`File`] | those that the header of a column names |
//! | [`Declared`] | those that an equation declares for a quantity |
//! | [`Si`] | SI |
//! | [`Engine`] | those of a solved problem, in which its numbers are of the order of one |
//!
//! A number is put into a frame where it is known to be in it ([`Number::declared`]), and leaves it where plain numbers of that
//! frame are wanted ([`Number::as_engine`]). Between frames lead scales alone. A number that is converted twice, or not at all,
//! or in the wrong direction, does not compile:
//!
//! ```
//! use nisp_units::frame::{Declared, Number, Scale, Si};
//! let millimetre: Scale<Declared, Si> = Scale::new(1e-3);
//! let length = millimetre.of(Number::declared(5.0));
//! assert_eq!(length + Number::si(1.0), Number::si(1.005));
//! assert_eq!(millimetre.back(length).as_declared(), 5.0);
//! ```
//!
//! Numbers of two frames have no sum, and no order:
//!
//! ```compile_fail,E0308
//! use nisp_units::frame::Number;
//! let sum = Number::si(1.0) + Number::declared(5.0);
//! ```
//!
//! A scale takes no number that it has scaled already:
//!
//! ```compile_fail,E0308
//! use nisp_units::frame::{Declared, Number, Scale, Si};
//! let millimetre: Scale<Declared, Si> = Scale::new(1e-3);
//! let twice = millimetre.of(millimetre.of(Number::declared(5.0)));
//! ```
//!
//! It takes none in the wrong direction, and what it gives is not taken for a number of another frame:
//!
//! ```compile_fail,E0308
//! use nisp_units::frame::{Declared, Number, Scale, Si};
//! let millimetre: Scale<Declared, Si> = Scale::new(1e-3);
//! let wrong = millimetre.back(Number::declared(5.0));
//! ```
//!
//! ```compile_fail,E0599
//! use nisp_units::frame::{Declared, Number, Scale, Si};
//! let millimetre: Scale<Declared, Si> = Scale::new(1e-3);
//! let unconverted = millimetre.of(Number::declared(5.0)).as_engine();
//! ```

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Add, Sub};

/// In the unit that the header of a file's column names.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub enum File {}

/// In the unit that an equation declares for a quantity, or that somebody asks a table for.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub enum Declared {}

/// In SI units.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub enum Si {}

/// In the units of a solved problem.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub enum Engine {}

/// A number in a frame.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
#[repr(transparent)]
pub struct Number<Frame> {
    value: f64,
    frame: PhantomData<Frame>,
}

/// How numbers of one frame become numbers of another: they are multiplied by a factor. Standard deviations are scaled as values
/// are.
#[derive(Clone, Copy, PartialEq)]
#[repr(transparent)]
pub struct Scale<From, To> {
    factor: f64,
    frames: PhantomData<(From, To)>,
}

impl<Frame> Number<Frame> {
    const fn new(value: f64) -> Self {
        Self { value, frame: PhantomData }
    }
}

impl Number<File> {
    /// A number as it stands in a file.
    pub const fn file(value: f64) -> Self {
        Self::new(value)
    }
}

impl Number<Declared> {
    /// A number in its declared unit.
    pub const fn declared(value: f64) -> Self {
        Self::new(value)
    }

    /// The plain number, which is in the declared unit.
    pub const fn as_declared(self) -> f64 {
        self.value
    }
}

impl Number<Si> {
    /// A number in SI units.
    pub const fn si(value: f64) -> Self {
        Self::new(value)
    }

    /// The plain number, which is in SI units.
    pub const fn as_si(self) -> f64 {
        self.value
    }
}

impl Number<Engine> {
    /// A number in the engine's units.
    pub const fn engine(value: f64) -> Self {
        Self::new(value)
    }

    /// The plain number, which is in the engine's units.
    pub const fn as_engine(self) -> f64 {
        self.value
    }
}

impl<From, To> Scale<From, To> {
    /// By what one unit of the first frame is in units of the second.
    pub const fn new(factor: f64) -> Self {
        Self { factor, frames: PhantomData }
    }

    /// What one unit of the first frame is in units of the second.
    pub const fn factor(&self) -> f64 {
        self.factor
    }

    /// A number of the first frame in the second: the product with the factor.
    pub const fn of(&self, number: Number<From>) -> Number<To> {
        Number::new(number.value * self.factor)
    }

    /// A number of the second frame in the first: the quotient by the factor.
    pub const fn back(&self, number: Number<To>) -> Number<From> {
        Number::new(number.value / self.factor)
    }

    /// From the second frame to the first by one factor. Its products may differ from the quotients of [`Scale::back`] in the last
    /// digit.
    pub const fn inverse(&self) -> Scale<To, From> {
        Scale::new(self.factor.recip())
    }

    /// From the first frame to another one, of which a scale leads to the second, too.
    pub const fn over<Other>(&self, other: &Scale<Other, To>) -> Scale<From, Other> {
        Scale::new(self.factor / other.factor)
    }
}

impl<Frame> Add for Number<Frame> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.value + other.value)
    }
}

impl<Frame> Sub for Number<Frame> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::new(self.value - other.value)
    }
}

/// As the plain number: what is saved of a problem knows it by this text.
impl<Frame> fmt::Debug for Number<Frame> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.value, f)
    }
}

/// As the factor, for the same reason.
impl<From, To> fmt::Debug for Scale<From, To> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.factor, f)
    }
}

/// People read numbers in declared units, and in no others.
impl fmt::LowerExp for Number<Declared> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::LowerExp::fmt(&self.value, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A millimetre, and a unit of length of two metres.
    const MILLIMETRE: Scale<Declared, Si> = Scale::new(1e-3);
    const LARGE: Scale<Engine, Si> = Scale::new(2.0);

    #[test]
    fn scales_go_forth_and_back() {
        assert_eq!(MILLIMETRE.of(Number::declared(5.0)), Number::si(5e-3));
        assert_eq!(MILLIMETRE.back(Number::si(5e-3)), Number::declared(5.0));
        assert_eq!(LARGE.back(Number::si(5.0)).as_engine(), 2.5);
        assert_eq!(LARGE.inverse().of(Number::si(5.0)), Number::engine(2.5));
    }

    #[test]
    fn scales_to_one_frame_compose() {
        let (inward, outward) = (MILLIMETRE.over(&LARGE), LARGE.over(&MILLIMETRE));
        assert_eq!(inward.of(Number::declared(4000.0)), Number::engine(2.0));
        assert_eq!(outward.of(Number::engine(2.0)), Number::declared(4000.0));
        assert_eq!((inward.factor(), outward.factor()), (5e-4, 2000.0));
    }

    #[test]
    fn numbers_of_a_frame_are_added_and_compared() {
        assert_eq!(Number::si(3.0) - Number::si(1.0) + Number::si(0.5), Number::si(2.5));
        assert!(Number::engine(-1.0) < Number::engine(0.0));
    }

    #[test]
    fn texts_are_those_of_plain_numbers() {
        assert_eq!(format!("{:?} {:?}", Number::si(0.1), MILLIMETRE), format!("{:?} {:?}", 0.1, 1e-3));
        assert_eq!(format!("{:.2e}", Number::declared(1234.0)), "1.23e3");
    }
}
