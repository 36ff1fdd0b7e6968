//! How these programs print what they measured.

use std::time::Duration;

/// Prints the median, the 95th percentile and the worst of some times.
#[expect(clippy::print_stdout, reason = "the figures are this program's answer")]
pub fn report(what: &str, mut times: Vec<Duration>) {
    times.sort();
    let at = |part: usize| times[(times.len() * part / 100).min(times.len() - 1)];
    println!("{what}: median {:?}, 95% {:?}, most {:?}", at(50), at(95), at(100));
}
