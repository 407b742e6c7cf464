//! Solvers: functions to minimise, methods that minimise them, and what the minimum says about its own accuracy.
//!
//! One direction: an [`objective`] gives values, gradients and rows; a [`method`] takes one step at a time; the
//! [`driver`] repeats steps within a budget and judges convergence; [`evidence`] and [`posterior`] read the
//! factorisation at the minimum.

pub mod adam;
pub mod broyden;
pub mod fault;
pub mod lbfgs;
mod line_search;
pub mod method;
pub mod objective;
pub mod state;
mod symmetric;
mod vector;
mod wide;
