//! tanh and its derivatives, vectorised.
