//! The runtime behind `pde!`: networks, derivative propagation, losses and solvers.
//!
//! Data flows one way: points, channels through the network, residuals, loss, step, report.

mod abrupt;
pub mod activation;
pub mod aligned;
mod axes;
mod bounds;
mod bytes;
pub mod carrier;
pub mod compiled;
mod correlation;
mod ends;
pub mod engine;
mod facts;
pub mod functions;
pub mod gemm;
mod given;
pub mod kernel;
pub mod layer;
mod levels;
pub mod local;
pub mod loss;
pub mod memory;
pub mod nearest;
pub mod network;
pub mod noise;
pub mod peak;
pub mod problem;
mod reads;
pub mod real;
pub mod recover;
pub mod residual;
mod rhythm;
mod roughness;
pub mod rules;
pub mod saved;
pub mod schema;
mod shared_noise;
pub mod simd;
pub mod solve;
mod splines;
mod standing;
mod start;
mod student;
mod tolerance;
pub mod values;
pub mod verdict;
mod weighed;
mod wide;

pub use nisp_units::frame as units;
pub use splines::live;
