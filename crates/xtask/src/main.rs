//! Builds, serves, tests, benchmarks and packs the page.
fn main() {}
