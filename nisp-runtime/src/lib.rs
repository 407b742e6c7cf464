//! The runtime behind `pde!`: networks, derivative propagation, losses and solvers.
//!
//! Data flows one way: points, channels through the network, residuals, loss, step, report.

pub mod aligned;
pub mod gemm;
pub mod peak;
pub mod real;
pub mod simd;
pub mod solve;
pub mod tanh;
