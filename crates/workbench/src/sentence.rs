//! Texts as sentences.

/// A text with a capital at its start, unless it starts with a name.
pub fn sentence(text: &str) -> String {
    let first_word = text.split(' ').next().unwrap_or_default();
    let is_plain = first_word.chars().all(|c| c.is_ascii_lowercase() || c == ':');
    let mut characters = text.chars();
    match characters.next() {
        Some(first) if is_plain => first.to_uppercase().chain(characters).collect(),
        _ => text.to_owned(),
    }
}
