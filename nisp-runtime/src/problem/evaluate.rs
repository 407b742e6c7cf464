//! A bound problem as a function of the network's parameters, for those who bring a method of their own.

use super::{BindError, Problem};
use crate::engine::{Engine, Scaling, factors};
use crate::kernel::Precision;
use crate::network::{Architecture, Inputs};
use crate::simd::Isa;

impl Problem {
    /// The loss of this problem for a network of the given shape, in precision `E`, with vectors of `isa`: half the mean
    /// squares of all terms, each over its natural size, times the user's weights.
    ///
    /// Made inside a rayon pool, it works on that pool's threads.
    ///
    /// # Errors
    /// A problem that is not fully or not sensibly bound, or a network that cannot be.
    pub fn engine<E: Precision>(&self, isa: Isa, architecture: Architecture) -> Result<Engine<E>, BindError> {
        let mut engine = self.bound(architecture.inputs)?.engine_on(isa, architecture)?;
        factors::by_size(&mut engine);
        Ok(engine)
    }

    /// How the network's inputs and outputs stand to coordinates and heads, in the engine's units, for a network with the
    /// given inputs.
    ///
    /// # Errors
    /// A problem that is not fully or not sensibly bound.
    pub fn scaling(&self, inputs: Inputs) -> Result<Scaling, BindError> {
        Ok(self.bound(inputs)?.scaling)
    }
}
