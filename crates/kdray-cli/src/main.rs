//! The kdray command.
fn main() {}
