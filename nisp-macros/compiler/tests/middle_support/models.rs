//! Models built by hand.
