//! Names of people: which ones cannot be told apart, and which ones nobody should have.

use std::collections::BTreeSet;

use unicode_normalization::UnicodeNormalization as _;
use unicode_normalization::char::is_combining_mark;
use unicode_security::MixedScript as _;
use unicode_security::confusable_detection::skeleton;

/// The longest name of a person, in characters.
const MAX_NAME_LENGTH: usize = 80;

/// What is wrong with a name, whoever has it.
pub fn problem(name: &str) -> Option<String> {
    let is_word_mixed = |word: &str| !word.is_single_script();
    if forms(name).iter().all(String::is_empty) {
        return Some("a key needs a name with letters or digits".to_owned());
    }
    if name.chars().count() > MAX_NAME_LENGTH {
        return Some(format!("a name has at most {MAX_NAME_LENGTH} characters"));
    }
    if name.chars().any(char::is_control) {
        return Some("a name is one line".to_owned());
    }
    let mixed = name.split_whitespace().find(|word| is_word_mixed(word))?;
    Some(format!("“{mixed}” mixes letters of several scripts, so it can look like another name"))
}

/// Whether people could take one name for the other: they are the same without case, accents, spaces and signs, or by
/// the letters that they look like (the skeletons of Unicode Technical Standard 39).
pub fn are_alike(one: &str, other: &str) -> bool {
    !forms(one).is_disjoint(&forms(other))
}

/// What a name looks like: as it is written, and in small letters, for `I` looks like `l` and `i` does not.
fn forms(name: &str) -> BTreeSet<String> {
    let written: String = name.nfkc().collect();
    let small = written.to_lowercase();
    [written, small].iter().map(|form| letters(skeleton(form))).collect()
}

fn letters(form: impl Iterator<Item = char>) -> String {
    let bare = form.nfd().filter(|&letter| !is_combining_mark(letter) && letter.is_alphanumeric());
    bare.flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_look_alike_are_alike() {
        for [one, other] in [
            ["Ada", "ada "],
            ["Ada", "Àda"],
            ["Ada", "A\u{300}da"],
            ["Ada", "A\u{200b}da"],
            ["Ada", "А\u{64}а"],
            ["Ada", "Ａｄａ"],
            ["Pope", "Роре"],
            ["Ida", "lda"],
            ["Ida", "ida"],
            ["Otto", "0tto"],
            ["Maria-Luise", "Maria Luise"],
        ] {
            assert!(are_alike(one, other), "{one} {other}");
            assert!(are_alike(other, one), "{other} {one}");
        }
        for [one, other] in [["Ada", "Ida"], ["Ada", "Adam"], ["Grace", "Ada"], ["Ян", "Ян Ли"]] {
            assert!(!are_alike(one, other), "{one} {other}");
        }
    }

    #[test]
    fn names_that_only_deceive_are_refused() {
        for name in ["Ada", "Àda", "Ян", "田中 Ada", "O'Neil", "Maria-Luise 2"] {
            assert_eq!(problem(name), None, "{name}");
        }
        for name in ["", " \u{200b}", "...", "А\u{64}а", "Ada\nGrace"] {
            assert!(problem(name).is_some(), "{name:?}");
        }
        assert!(problem(&"a".repeat(81)).is_some());
    }
}
