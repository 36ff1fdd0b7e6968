//! Names of people: which ones cannot be told apart, and which ones no one should have.

use std::collections::BTreeSet;

use unicode_normalization::UnicodeNormalization as _;
use unicode_normalization::char::is_combining_mark;
use unicode_security::confusable_detection::skeleton;
use unicode_security::general_security_profile::IdentifierType;
use unicode_security::{GeneralSecurityProfile as _, MixedScript as _};

/// The longest name of a person, in characters.
const MAX_NAME_LENGTH: usize = 80;

/// A name in one spelling: composed letters, and single spaces between words.
pub fn tidy(name: &str) -> String {
    let composed: String = name.nfc().collect();
    composed.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns whether all characters of a text of one line can be seen. Others break the line, reorder it, or hide in it.
pub fn is_visible(text: &str) -> bool {
    !text.chars().any(is_hidden)
}

/// A text in one line, with spaces for the characters that cannot be seen.
pub fn one_line(text: &str) -> String {
    text.chars().map(|letter| if is_hidden(letter) { ' ' } else { letter }).collect()
}

/// Returns whether a character is a control, a line break, or one that leaves no mark, such as the override that makes
/// a text run from right to left.
pub(super) fn is_hidden(letter: char) -> bool {
    let hides = || {
        let kind = letter.identifier_type();
        matches!(kind, Some(IdentifierType::Default_Ignorable | IdentifierType::Deprecated))
    };
    letter.is_control() || matches!(letter, '\u{2028}' | '\u{2029}') || hides()
}

/// Returns what is wrong with a name, no matter who has it.
pub fn problem(name: &str) -> Option<String> {
    let is_word_mixed = |word: &str| !word.is_single_script();
    let composed: String = name.nfc().collect();
    if !is_visible(name) {
        return Some("a name must not contain line breaks or invisible characters".to_owned());
    }
    if forms(name).iter().all(String::is_empty) {
        return Some("a name must contain letters or digits".to_owned());
    }
    if name.chars().count() > MAX_NAME_LENGTH {
        return Some(format!("a name must have at most {MAX_NAME_LENGTH} characters"));
    }
    if let Some(sign) = composed.chars().find(|&letter| !is_of_words(letter) && !is_sign(letter)) {
        return Some(format!(
            "“{sign}” is not allowed in a name: use letters, digits, spaces, and signs such as ' - . ·"
        ));
    }
    if let Some(letter) = composed.chars().find(|&letter| is_of_words(letter) && !is_usual(letter)) {
        return Some(format!(
            "“{letter}” is not a usual letter of names, so the name can look like another name"
        ));
    }
    let mixed = name.split_whitespace().find(|word| is_word_mixed(word))?;
    Some(format!("“{mixed}” mixes letters of several scripts, so it can look like another name"))
}

/// Returns whether a character is a letter, a mark on one, or a digit.
fn is_of_words(letter: char) -> bool {
    letter.is_alphanumeric() || is_combining_mark(letter)
}

/// Returns whether a letter is in use today (Unicode Technical Standard 39), and no variant of another one: not a small
/// capital, not a letter of phonetics. Scripts of few people are in use.
fn is_usual(letter: char) -> bool {
    letter.identifier_allowed() || letter.identifier_type() == Some(IdentifierType::Limited_Use)
}

/// Returns whether a character is between the words and letters of names and roles. Comparisons leave it out.
fn is_sign(letter: char) -> bool {
    let joins = || letter.identifier_type() == Some(IdentifierType::Inclusion) && letter != ':';
    letter.is_whitespace() || "'’-‐.·,&/()".contains(letter) || joins()
}

/// Returns whether people could take one name for the other: they are the same without case, accents, spaces and signs,
/// or by the letters that they look like (the skeletons of Unicode Technical Standard 39, and a few pairs more).
pub fn are_alike(one: &str, other: &str) -> bool {
    !forms(one).is_disjoint(&forms(other))
}

/// Returns what a name looks like: as it is written, and in small letters, for `I` looks like `l` and `i` does not.
fn forms(name: &str) -> BTreeSet<String> {
    // Small letters of Cherokee look like small capitals of Latin.
    let capital = |letter: char| match letter {
        '\u{ab70}'..='\u{abbf}' => letter.to_uppercase().next().unwrap_or(letter),
        other => other,
    };
    let written: String = name.nfkc().map(capital).collect();
    let small = written.to_lowercase();
    [written, small].iter().map(|form| letters(skeleton(form))).collect()
}

fn letters(form: impl Iterator<Item = char>) -> String {
    let bare = form.nfd().filter(|&letter| !is_combining_mark(letter) && letter.is_alphanumeric());
    let mut found = String::new();
    for letter in bare.flat_map(char::to_lowercase) {
        match PAIRS.iter().find(|(one, _)| *one == letter) {
            Some((_, looks_like)) => found.push_str(looks_like),
            None => found.push(letter),
        }
    }
    found
}

/// Letters and digits that look like others, in small letters, where the standard tells them apart.
const PAIRS: [(char, &str); 26] = [
    ('w', "vv"),
    ('d', "cl"),
    ('m', "rn"),
    ('0', "o"),
    ('1', "l"),
    ('2', "z"),
    ('3', "e"),
    ('4', "a"),
    ('5', "s"),
    ('6', "b"),
    ('7', "t"),
    ('8', "b"),
    ('9', "g"),
    ('в', "b"),
    ('к', "k"),
    ('м', "rn"),
    ('н', "h"),
    ('п', "n"),
    ('т', "t"),
    ('ʙ', "b"),
    ('ĸ', "k"),
    ('ᴍ', "rn"),
    ('ʜ', "h"),
    ('ᴛ', "t"),
    ('π', "n"),
    ('ᴨ', "n"),
];

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
            ["Otto", "Отто"],
            ["Ana", "Апа"],
            ["Kim", "Кіm"],
            ["Ida", "lda"],
            ["Ida", "ida"],
            ["Otto", "0tto"],
            ["Maria-Luise", "Maria Luise"],
            ["VVilliam", "William"],
            ["5am", "Sam"],
            ["4da", "Ada"],
            ["8ob", "Bob"],
            ["3ve", "Eve"],
            ["2oe", "Zoe"],
            ["7om", "Tom"],
            ["Rnaria", "Maria"],
            ["dara", "Clara"],
            ["Daude", "Claude"],
            ["Grace₂", "Grace2"],
            ["ꭺ", "A"],
        ] {
            assert!(are_alike(one, other), "{one} {other}");
            assert!(are_alike(other, one), "{other} {one}");
        }
        for [one, other] in [
            ["Ada", "Ida"],
            ["Ada", "Adam"],
            ["Grace", "Ada"],
            ["Ян", "Ян Ли"],
            ["Adam", "Adan"],
            ["Grace 2", "Grace 3"],
        ] {
            assert!(!are_alike(one, other), "{one} {other}");
        }
    }

    #[test]
    fn names_that_only_deceive_are_refused() {
        for name in ["Ada", "Àda", "Ян", "田中 Ada", "O'Neil", "Maria-Luise 2"] {
            assert_eq!(problem(name), None, "{name}");
        }
        let real =
            "José Nguyễn O'Brien O’Brien 王芳 Иван محمد Zoë Đặng Łukasz Þór Əli Sałata Núria·Gal·la D. יעל
            Ηλέκτρα दीपक สมชาย 김민준 さくら ნინო Արամ ᏣᎳᎩ ⵉⴷⵉⵔ Kaʻiulani J.-P. Strauß Ångström";
        for name in real.split_whitespace().chain(["Lee, Ann (JPL)", "R&D / GNC"]) {
            assert_eq!(problem(name), None, "{name}");
        }
        // Letters that are variants of others, and signs that look like letters.
        for (name, reason) in [
            ("ᴀda", "“ᴀ” is not a usual letter"),
            ("Adⱥ", "“ⱥ” is not a usual letter"),
            ("Adꬰ", "“ꬰ” is not a usual letter"),
            ("Ａda", "“Ａ” is not a usual letter"),
            ("Grace₂", "“₂” is not a usual letter"),
            ("∆da", "“∆” is not allowed"),
            ("🅰da", "“🅰” is not a usual letter"),
            ("Ada$", "“$” is not allowed"),
            ("Ad@", "“@” is not allowed"),
        ] {
            let refused = problem(name).unwrap_or_default();
            assert!(refused.starts_with(reason), "{name}: {refused}");
        }
        for name in ["", " \u{200b}", "...", "\u{2800}", "А\u{64}а", "Ada\nGrace"] {
            assert!(problem(name).is_some(), "{name:?}");
        }
        assert!(problem(&"a".repeat(81)).is_some());
        // Zero width, right to left, a mark that hides, a filler that is a letter, a line of its own.
        for hidden in
            ["\u{200b}", "\u{202e}", "\u{200f}", "\u{2067}", "\u{ad}", "\u{3164}", "\u{2028}", "\u{1b}"]
        {
            let name = format!("{hidden}ecarG");
            let refused = problem(&name).unwrap_or_default();
            assert!(refused.contains("invisible"), "{hidden:?}: {refused}");
            assert!(are_alike(&format!("Ada{hidden}"), "Ada"), "{hidden:?}");
            assert_eq!(one_line(&name), " ecarG");
        }
    }

    #[test]
    fn a_name_has_one_spelling() {
        for spelled in [" Zoë Ada ", "Zoe\u{308} Ada", "Zoë\u{a0}Ada", "Zoë\tAda", "Zoë\u{3000} Ada"] {
            assert_eq!(tidy(spelled), "Zoë Ada", "{spelled:?}");
        }
    }
}
