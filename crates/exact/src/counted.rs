//! Numbers with nouns.

use std::fmt::Display;

/// Returns a number with its noun, in the plural unless it is 1: `1 step`, `2 steps`.
pub fn counted<N: Copy + Display + PartialEq + From<u8>>(number: N, noun: &str) -> String {
    if number == N::from(1) { format!("1 {noun}") } else { format!("{number} {noun}s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_singular() {
        let all = [counted(0_usize, "step"), counted(1_u64, "step"), counted(2_u32, "step")];
        assert_eq!(all, ["0 steps", "1 step", "2 steps"]);
    }
}
