//! Scenes beside their equations written by hand in plain dense Taylor arithmetic, for the tests of the engine and the suite of
//! numerical stability: built once for both.

pub mod adjoint;
pub mod dense_jet;
pub mod models;
pub mod number;
pub mod reference;
pub mod tangents;
