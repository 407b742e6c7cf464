//! Activations and their derivatives against references of twice the precision: f64 for f32, double-double for f64.

#[path = "../double_double/mod.rs"]
mod double_double;
mod sine;
mod tanh;
#[path = "../tanh_errors/mod.rs"]
mod tanh_errors;
