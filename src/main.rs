//! The `belvedere` command.

fn main() {}
