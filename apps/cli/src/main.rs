//! The `belvedere` command line.
fn main() {}
