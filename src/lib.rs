//! Recover unknown sources from noisy measurements and a governing equation checked when the program compiles.
