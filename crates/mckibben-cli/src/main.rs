//! The program `mckibben`.
fn main() {}
