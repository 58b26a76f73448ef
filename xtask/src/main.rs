//! Project tasks: serve, build, test, bench.
fn main() {}
