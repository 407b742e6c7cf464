//! What one check found.

/// How many samples are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Some seconds: a part of the tests.
    Fast,
    /// All of what the report is made from.
    Full,
}

impl Extent {
    /// One of two sizes.
    pub fn pick<T>(self, fast: T, full: T) -> T {
        match self {
            Self::Fast => fast,
            Self::Full => full,
        }
    }
}

/// A line of the report.
#[derive(Clone, Debug)]
pub struct Row {
    /// What was compared with what.
    pub what: String,
    /// Over how much.
    pub samples: String,
    /// The largest error.
    pub worst: f64,
    /// What was asked for: the largest error that passes.
    pub target: f64,
    /// What tests hold us to: the target, or more where it is missed.
    pub held: f64,
    /// What bounds the error where the target is missed.
    pub why: &'static str,
}

impl Row {
    /// A check that is to reach its target.
    pub fn new(what: impl Into<String>, samples: impl Into<String>, worst: f64, target: f64) -> Self {
        Self { what: what.into(), samples: samples.into(), worst, target, held: target, why: "" }
    }

    /// A check that may miss its target, as far as `held`, and why.
    pub fn missing(self, held: f64, why: &'static str) -> Self {
        Self { held, why, ..self }
    }

    /// A measured time, which tests do not judge, and what may bound it.
    pub fn timed(self, why: &'static str) -> Self {
        self.missing(f64::INFINITY, why)
    }

    /// A check of which every sample is right or wrong.
    pub fn count(what: impl Into<String>, samples: usize, wrong: usize) -> Self {
        Self::new(what, samples.to_string(), wrong as f64, 0.0)
    }

    /// Whether the target is reached; what is not a number never is.
    pub fn passes(&self) -> bool {
        self.worst <= self.target
    }

    /// Whether it is as good as tests demand.
    pub fn holds(&self) -> bool {
        self.worst <= self.held
    }
}
