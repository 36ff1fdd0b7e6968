//! Numbers with nouns.

use std::fmt::Display;

/// Returns a number with its noun, in the plural unless it is 1: `1 step`, `2 steps`.
pub fn counted<N: Copy + Display + PartialEq + From<u8>>(number: N, noun: &str) -> String {
    if number == N::from(1) { format!("1 {noun}") } else { format!("{number} {noun}s") }
}

/// Returns a number with its digits in groups of three: `10,000`.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_singular() {
        let all = [counted(0_usize, "step"), counted(1_u64, "step"), counted(2_u32, "step")];
        assert_eq!(all, ["0 steps", "1 step", "2 steps"]);
    }

    #[test]
    fn thousands_are_groups() {
        let all = [0, 999, 1_000, 1_234_567].map(grouped);
        assert_eq!(all, ["0", "999", "1,000", "1,234,567"]);
    }
}
