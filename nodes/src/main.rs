//! The `ferntast` command.

fn main() {}
