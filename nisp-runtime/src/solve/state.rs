//! The whole state of a method as plain numbers, for checkpoints.

use super::fault::Fault;
use crate::real::Real;

/// Named vectors and counters. A method restored from its state goes on with the same bits as if it had not stopped.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct State {
    /// Name of the method and its settings, so that a state is not given to another one.
    pub method: String,
    /// Vectors by name. Single-precision values are widened, which is exact.
    pub vectors: Vec<(String, Vec<f64>)>,
    /// Counters by name.
    pub counters: Vec<(String, u64)>,
}

impl State {
    pub(crate) fn new(method: impl Into<String>) -> Self {
        Self { method: method.into(), ..Self::default() }
    }

    pub(crate) fn with<E: Real>(mut self, name: &str, vector: &[E]) -> Self {
        self.vectors.push((name.into(), vector.iter().map(|x| x.to_f64()).collect()));
        self
    }

    pub(crate) fn with_counter(mut self, name: &str, value: u64) -> Self {
        self.counters.push((name.into(), value));
        self
    }

    /// The same with nothing in the vector `name`.
    pub(crate) fn without(&self, name: &str) -> Self {
        let mut state = self.clone();
        state.vectors.iter_mut().filter(|(key, _)| key == name).for_each(|(_, vector)| vector.clear());
        state
    }

    /// The same with another value of the counter `name`.
    pub(crate) fn with_counter_at(mut self, name: &str, value: u64) -> Self {
        self.counters.iter_mut().filter(|(key, _)| key == name).for_each(|(_, own)| *own = value);
        self
    }

    pub(crate) fn check_method(&self, method: &str) -> Result<(), Fault> {
        if self.method == method { Ok(()) } else { Err(Fault::state(format!("method {}", self.method))) }
    }

    /// True if there is a vector `name`.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.vectors.iter().any(|(key, _)| key == name)
    }

    /// The vector `name` of any length; every element is finite.
    pub(crate) fn vector(&self, name: &str) -> Result<&[f64], Fault> {
        self.vectors
            .iter()
            .find(|(key, _)| key == name)
            .map(|(_, vector)| vector.as_slice())
            .filter(|vector| super::vector::all_finite(vector))
            .ok_or_else(|| Fault::state(name))
    }

    /// The vector `name`, which must have `len` elements, rounded to `E`.
    pub(crate) fn sized<E: Real>(&self, name: &str, len: usize) -> Result<Vec<E>, Fault> {
        let vector = self.vector(name)?;
        if vector.len() == len { Ok(vector.iter().map(|x| E::from_f64(*x)).collect()) } else { Err(Fault::state(name)) }
    }

    /// The vector `name`, which must have `N` elements.
    pub(crate) fn scalars<const N: usize>(&self, name: &str) -> Result<[f64; N], Fault> {
        self.vector(name)?.try_into().map_err(|_| Fault::state(name))
    }

    /// The vector `name` as whole numbers of at least zero.
    pub(crate) fn indices(&self, name: &str) -> Result<Vec<usize>, Fault> {
        let index = |x: &f64| (*x >= 0.0 && x.fract() == 0.0 && *x < f64::from(u32::MAX)).then_some(*x as usize);
        self.vector(name)?.iter().map(index).collect::<Option<_>>().ok_or_else(|| Fault::state(name))
    }

    pub(crate) fn counter(&self, name: &str) -> Result<u64, Fault> {
        self.counters.iter().find(|(key, _)| key == name).map(|(_, value)| *value).ok_or_else(|| Fault::state(name))
    }
}
