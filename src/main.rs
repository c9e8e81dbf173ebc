//! The command line of calipose.

fn main() {}
