//! Names, constants and numbers as our notations have them.

use exact::Rational;

use super::tree::Tree;

/// The mode that `:mode` or `(mode-of class :mode)` names.
pub(super) fn mode_of(tree: &Tree) -> Option<&str> {
    match tree.headed() {
        Some(("mode-of", [_, mode])) => mode.keyword(),
        Some(_) => None,
        None => tree.keyword(),
    }
}

/// A constant as the name of a value.
pub(super) fn constant(tree: &Tree) -> Option<String> {
    match tree {
        Tree::Text(text, _) => Some(value_name(text)),
        Tree::Word(word, _) if matches!(word.as_str(), "true" | "false") || number(tree).is_some() => {
            Some(value_name(word))
        }
        _ => mode_of(tree).map(value_name),
    }
}

/// Numbers of a mission have at most so many characters.
const MAX_DIGITS: usize = 14;

/// A number from 0 on, or a calculation with numbers, as a mission has it.
pub(super) fn number(tree: &Tree) -> Option<String> {
    match tree.headed() {
        Some((sign @ ("+" | "-" | "*" | "/"), parts)) => {
            let parts = parts.iter().map(number).collect::<Option<Vec<_>>>()?;
            (!parts.is_empty()).then(|| format!("({})", parts.join(sign)))
        }
        Some(("lvar", _)) | None => {
            let is_number = |word: &&str| word.parse().is_ok_and(|number: Rational| number >= Rational::ZERO);
            tree.word().filter(is_number).filter(|word| word.len() <= MAX_DIGITS).map(str::to_owned)
        }
        Some(_) => None,
    }
}

/// Bounds that are plain numbers.
pub(super) fn limits(tree: Option<&Tree>) -> Option<(Rational, Option<Rational>)> {
    let [least, most] = tree?.vector()? else { return None };
    Some((least.word()?.parse().ok()?, most.word()?.parse().ok()))
}

/// Words that a mission reserves.
const RESERVED: [&str; 17] = [
    "choose",
    "do",
    "maintaining",
    "watching",
    "if",
    "thennext",
    "var",
    "primitive",
    "scenario",
    "option",
    "delay",
    "not",
    "tell",
    "ask",
    "inf",
    "optional",
    "repeat",
];

/// A name as a mission can have it.
pub(super) fn name(text: &str) -> String {
    let letters =
        text.chars().map(|letter| if letter.is_ascii_alphanumeric() || letter == '-' { letter } else { '_' });
    let letters: String = letters.collect();
    let parts: Vec<&str> = letters.split('-').filter(|part| !part.is_empty()).collect();
    let name = parts.join("-");
    if name.is_empty()
        || name.starts_with(|letter: char| letter.is_ascii_digit())
        || RESERVED.contains(&&*name)
    {
        return format!("_{name}");
    }
    name
}

/// A constant as the name of a value.
pub(super) fn value_name(text: &str) -> String {
    match text.parse::<Rational>() {
        Ok(_) => name(&format!("n{}", text.replace('-', "minus").replace('.', "_"))),
        Err(_) => name(text),
    }
}
