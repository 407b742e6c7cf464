//! Solvers: functions to minimise, methods that minimise them, and what the minimum says about its own accuracy.
//!
//! One direction: an [`objective`] gives values, gradients and rows; a [`method`] takes one step at a time; the
//! [`driver`] repeats steps within a budget and judges convergence; [`evidence`] and [`posterior`] read the
//! factorisation at the minimum.

pub mod adam;
pub mod broyden;
pub mod curvature;
mod damping;
pub(crate) mod dense;
pub mod driver;
pub mod empirical_bayes;
pub mod evidence;
pub mod fault;
pub mod gauss_newton;
mod judge;
pub mod lbfgs;
mod line_search;
pub mod marquardt;
pub mod method;
mod normal;
pub mod objective;
pub mod outcome;
pub mod posterior;
pub mod prior;
pub mod projection;
mod record;
pub(crate) mod root;
pub mod state;
mod symmetric;
pub(crate) mod vector;
