//! The nisp command.
fn main() {}
