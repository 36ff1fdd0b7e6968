//! The name that an author probably meant.

/// Longer names are compared by this many of their first letters.
const MAX_LETTERS: usize = 64;

/// The one of `known` nearest to `word`, when it is near enough to be a slip of the fingers.
///
/// Distance is the number of letters inserted, removed, replaced or swapped with a neighbor, whatever their case; of
/// two that are equally near it is the one whose case agrees better, and then the first in the alphabet.
pub fn nearest<'name>(word: &str, known: impl IntoIterator<Item = &'name str>) -> Option<&'name str> {
    let most = match word.chars().count() {
        0..=1 => 0,
        2..=5 => 1,
        _ => 2,
    };
    let written = Letters::of(word);
    known
        .into_iter()
        .filter(|name| *name != word)
        .filter_map(|name| Some((written.distance(&Letters::of(name), most)?, name)))
        .min()
        .map(|(_, name)| name)
}

/// The letters of a name that are compared: as they are, in lower case, and how many there are.
struct Letters {
    exact: String,
    lowercase: String,
    count: usize,
}

impl Letters {
    fn of(name: &str) -> Self {
        let exact: String = name.chars().take(MAX_LETTERS).collect();
        Self { lowercase: exact.to_ascii_lowercase(), count: exact.chars().count(), exact }
    }

    /// The distances whatever the case and with it, if the first is at most `most`.
    fn distance(&self, other: &Self, most: usize) -> Option<(usize, usize)> {
        if self.count.abs_diff(other.count) > most {
            return None;
        }
        let distance = strsim::osa_distance(&self.lowercase, &other.lowercase);
        (distance <= most).then(|| (distance, strsim::osa_distance(&self.exact, &other.exact)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_fingers_is_mended_and_another_word_is_not() {
        assert_eq!(nearest("Stanby", ["Off", "Standby", "Firing"]), Some("Standby"));
        assert_eq!(nearest("firing", ["Off", "Standby", "Firing"]), Some("Firing"));
        assert_eq!(nearest("Camera", ["Off", "Standby", "Firing"]), None);
        assert_eq!(nearest("Of", ["Off", "On"]), Some("Off"));
        assert_eq!(nearest("X", ["Y"]), None);
    }

    #[test]
    fn case_alone_is_no_mistake_that_counts_but_decides_between_equals() {
        assert_eq!(nearest("STANDBY", ["Off", "Standby", "Firing"]), Some("Standby"));
        assert_eq!(nearest("Fire1", ["fire2", "Fire3"]), Some("Fire3"));
        assert_eq!(nearest("Fire1", ["Fire3", "Fire2"]), Some("Fire2"));
    }
}
