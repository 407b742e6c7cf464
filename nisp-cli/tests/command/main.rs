//! Runs the command as its users do. One binary for all tests: linking the scenes takes longer than compiling the tests.

mod bad_cloud;
mod bad_input;
mod beliefs;
mod bubble;
mod check;
mod common;
mod contact;
mod contract;
mod eval;
mod few_places;
mod folders;
mod forward;
mod gaps;
mod geometry;
mod interrupt;
mod json;
mod open_directions;
mod plate;
mod readme;
mod records;
mod resume;
mod rust;
mod stream;
mod streams;
mod text;
mod verdict;
