//! What can go wrong while a step is computed.

use thiserror::Error;

/// A step that could not be computed. The solver that meets one refuses the step and restores its state bitwise.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{term}{}: {what}{}", Place(point), what.remedy())]
pub struct Fault {
    /// Name of the residual, observation or prior where it happened, as the user wrote it.
    pub term: String,
    /// Number of the point within its term, where it is known.
    pub point: Option<usize>,
    /// What happened.
    pub what: Kind,
}

/// Kinds of [`Fault`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum Kind {
    /// A residual is NaN or infinite.
    #[error("the residual is not finite")]
    Residual,
    /// A derivative is NaN or infinite.
    #[error("the gradient is not finite")]
    Gradient,
    /// A matrix that should be positive definite is not, even with the largest damping.
    #[error("the normal matrix cannot be factorised")]
    Factorisation,
    /// Rows whose triangle has no finite solution.
    #[error("the rows cannot be solved in double precision")]
    Unsolved,
    /// A saved state does not belong to this solver, this version or this number of parameters.
    #[error("the saved state does not fit")]
    State,
}

impl Kind {
    const ALL: [Self; 5] = [Self::Residual, Self::Gradient, Self::Factorisation, Self::Unsolved, Self::State];

    /// Name in saved states.
    pub(super) fn code(self) -> &'static str {
        match self {
            Self::Residual => "residual",
            Self::Gradient => "gradient",
            Self::Factorisation => "factorisation",
            Self::Unsolved => "unsolved",
            Self::State => "state",
        }
    }

    /// The kind of a name.
    pub(super) fn from_code(code: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.code() == code)
    }

    fn remedy(self) -> &'static str {
        match self {
            Self::Residual => {
                "; check the equation there for a division by zero, a logarithm or a root of a negative number: where a field \
                 is never negative, say so (`h [m] >= 0`)"
            }
            Self::Gradient => "; check the equation there for a root or a power at zero",
            Self::Factorisation => {
                "; give every learned parameter a width (`learn k within 0.1;`) or a term that depends on it"
            }
            Self::Unsolved => "; check the units of the data and the parameters",
            Self::State => "; start afresh, or give the settings and the version of nisp that it was saved with",
        }
    }
}

impl Fault {
    /// A non-finite residual of `term` at `point`.
    pub fn residual(term: impl Into<String>, point: Option<usize>) -> Self {
        Self { term: term.into(), point, what: Kind::Residual }
    }

    /// A non-finite derivative of `term` at `point`.
    pub fn gradient(term: impl Into<String>, point: Option<usize>) -> Self {
        Self { term: term.into(), point, what: Kind::Gradient }
    }

    /// Rows of `rows` that have no finite solution.
    pub fn unsolved(rows: impl Into<String>) -> Self {
        Self { term: rows.into(), point: None, what: Kind::Unsolved }
    }

    /// A saved state that does not fit; `entry` names the part that is missing or has the wrong size.
    pub fn state(entry: impl Into<String>) -> Self {
        Self { term: entry.into(), point: None, what: Kind::State }
    }
}

struct Place<'a>(&'a Option<usize>);

impl std::fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.map_or(Ok(()), |point| write!(f, " at point {point}"))
    }
}
