//! The name that an author probably meant.

/// The one of `known` nearest to `word`, when it is near enough to be a slip of the fingers.
///
/// Distance is the number of letters inserted, removed, replaced or swapped with a neighbour, where case counts half.
pub fn nearest<'name>(word: &str, known: impl IntoIterator<Item = &'name str>) -> Option<&'name str> {
    let most = match word.chars().count() {
        0..=1 => 1,
        2 => 2,
        3..=5 => 3,
        _ => 5,
    };
    known
        .into_iter()
        .filter(|name| *name != word)
        .map(|name| (distance(word, name), name))
        .filter(|&(distance, _)| distance <= most)
        .min_by_key(|&(distance, name)| (distance, name))
        .map(|(_, name)| name)
}

/// Twice the optimal-string-alignment distance, with a difference in case alone counting one.
fn distance(left: &str, right: &str) -> usize {
    let left: Vec<char> = left.chars().take(64).collect();
    let right: Vec<char> = right.chars().take(64).collect();
    let width = right.len() + 1;
    let mut table = vec![0; (left.len() + 1) * width];
    let at = |row: usize, column: usize| row * width + column;
    for row in 0..=left.len() {
        for column in 0..width {
            table[at(row, column)] = if row == 0 || column == 0 {
                2 * (row + column)
            } else {
                let (a, b) = (left[row - 1], right[column - 1]);
                let change = if a == b { 0 } else { 1 + usize::from(!a.eq_ignore_ascii_case(&b)) };
                let mut best = (table[at(row - 1, column - 1)] + change)
                    .min(table[at(row - 1, column)] + 2)
                    .min(table[at(row, column - 1)] + 2);
                if row > 1 && column > 1 && a == right[column - 2] && left[row - 2] == b {
                    best = best.min(table[at(row - 2, column - 2)] + 2);
                }
                best
            };
        }
    }
    table[at(left.len(), right.len())]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_fingers_is_mended_and_another_word_is_not() {
        assert_eq!(nearest("Stanby", ["Off", "Standby", "Firing"]), Some("Standby"));
        assert_eq!(nearest("firing", ["Off", "Standby", "Firing"]), Some("Firing"));
        assert_eq!(nearest("Camera", ["Off", "Standby", "Firing"]), None);
    }
}
