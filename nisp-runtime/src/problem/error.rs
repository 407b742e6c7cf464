//! Why a problem cannot be solved as it is bound.

use thiserror::Error;

use crate::schema;
use crate::units::{Number, Si};

/// Why a problem cannot be solved as it is bound.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BindError {
    /// A name that the scene does not have.
    #[error("there is no {what} `{name}`; the scene has: {have}")]
    Unknown {
        /// What kind of name it should be.
        what: &'static str,
        /// The name given.
        name: String,
        /// The names there are.
        have: String,
    },
    /// A parameter that is not finite.
    #[error("parameter `{name}` is {value}; give a finite number in its declared unit")]
    Parameter {
        /// Its name.
        name: String,
        /// Its value.
        value: f64,
    },
    /// A parameter outside of the range that it is declared with.
    #[error("parameter `{name}` is {value}{}, and must be {range}", unit_text(.unit))]
    Range {
        /// Its name.
        name: String,
        /// Its value, in its declared unit.
        value: f64,
        /// Its declared unit.
        unit: &'static str,
        /// What is allowed.
        range: String,
    },
    /// A parameter without a value.
    #[error("parameter `{name}` has no value; give it one{}: where it is learned, the one to start from", unit_hint(.unit))]
    MissingParameter {
        /// Its name.
        name: String,
        /// Its declared unit.
        unit: &'static str,
    },
    /// A group without points.
    #[error("group `{group}` has no points; bind at least one")]
    NoPoints {
        /// The group.
        group: &'static str,
    },
    /// Numbers that do not come in whole points, or as many as there are points.
    #[error("group `{group}`: {what} has {found} numbers where {expected} are expected")]
    Length {
        /// The group.
        group: &'static str,
        /// Which of its data.
        what: String,
        /// How many numbers were given.
        found: usize,
        /// How many are expected.
        expected: usize,
    },
    /// A number that is NaN or infinite.
    #[error("group `{group}`: {what} is not finite at point {point}; remove the point or mend its data")]
    NotFinite {
        /// The group.
        group: &'static str,
        /// Which of its data.
        what: String,
        /// The point, counted from 0.
        point: usize,
    },
    /// Columns without a single value.
    #[error("group `{group}`: nothing is measured in any of its columns; bind a value at least")]
    NothingMeasured {
        /// The group.
        group: &'static str,
    },
    /// A Chamfer term without a cloud.
    #[error("group `{group}`: term `{term}` has no cloud; bind the points that its surface passes through")]
    NoCloud {
        /// The group.
        group: &'static str,
        /// The term.
        term: &'static str,
    },
    /// A scene whose kernels have not been compiled in the precision asked for.
    #[error(
        "scene `{scene}` is compiled in double precision only; call `.in_single_precision()` before `.problem()`, or solve \
         in f64"
    )]
    NotCompiled {
        /// The scene.
        scene: &'static str,
    },
    /// A network that cannot be.
    #[error(
        "a network of {layers} layers of {width} units cannot be built; both must be at least 1, and their product not huge"
    )]
    Architecture {
        /// Layers asked for.
        layers: usize,
        /// Units asked for.
        width: usize,
    },
}

fn unit_text(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// That a value lies in the range that its scalar is declared with.
pub(super) fn within(scalar: &schema::Scalar, value: Number<Si>) -> Result<(), BindError> {
    if scalar.lower.is_none_or(|low| value >= low) && scalar.upper.is_none_or(|high| value <= high) {
        return Ok(());
    }
    let (name, unit, range) = (scalar.name.into(), scalar.unit.text, range(scalar));
    Err(BindError::Range { name, value: scalar.unit.factor.back(value).as_declared(), unit, range })
}

/// The range of a scalar in its declared unit, in words.
fn range(scalar: &schema::Scalar) -> String {
    let unit = scalar.unit.behind();
    let shown = |bound: Number<Si>| {
        // Rounding of the unit's factor should not show.
        let outward = scalar.unit.factor.back(bound).as_declared();
        if outward.abs() < f64::MIN_POSITIVE { "0".to_string() } else { format!("{}", (outward * 1e12).round() / 1e12) }
    };
    let is_left_out = |bound: Number<Si>| bound.as_si() != 0.0 && bound.as_si().abs() < f64::MIN_POSITIVE;
    let low = scalar.lower.map(|low| {
        let word = if is_left_out(low) { "above" } else { "at least" };
        format!("{word} {}{unit}", shown(low))
    });
    let high = scalar.upper.map(|high| {
        let word = if is_left_out(high) { "below" } else { "at most" };
        format!("{word} {}{unit}", shown(high))
    });
    low.into_iter().chain(high).collect::<Vec<_>>().join(" and ")
}

fn unit_hint(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" in {unit}") }
}

impl BindError {
    pub(super) fn unknown<'a>(what: &'static str, name: &str, have: impl Iterator<Item = &'a str>) -> Self {
        Self::Unknown { what, name: name.into(), have: have.collect::<Vec<_>>().join(", ") }
    }
}
