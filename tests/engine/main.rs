//! The whole engine, from `pde!` to gradients and Jacobian rows, against plain dense Taylor arithmetic.

mod adjoint;
mod assignment;
mod beliefs;
mod contact;
mod determinism;
mod gradients;
mod hard;
mod interpreted;
mod open;
mod rows;
mod tolerance;
mod values;
