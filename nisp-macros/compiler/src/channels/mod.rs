//! Compiler stage 4: the minimal channel set and its rules.
