//! The tokens of JMPL, each with its line.

use super::error::JmplError;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Token {
    Word(String),
    Number(String),
    /// What stands between quotation marks.
    Text(String),
    Sign(char),
}

impl std::fmt::Display for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Word(text) | Self::Number(text) => write!(f, "`{text}`"),
            Self::Text(text) => write!(f, "`\"{text}\"`"),
            Self::Sign(sign) => write!(f, "`{sign}`"),
        }
    }
}

/// Cuts a text into tokens. Of `==`, `&&` and `||` one character remains, and `!=` is the sign `≠`.
pub(super) fn lex(text: &str, file: &str) -> Result<Vec<(Token, u32)>, JmplError> {
    let mut tokens = Vec::new();
    let mut line = 1;
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            match rest.find("*/") {
                Some(end) => end + 2,
                None => return Err(JmplError::shape(file, line, "this comment is not closed with `*/`")),
            }
        } else if is_word_start(first) {
            let length = rest.find(|letter| !is_word(letter)).unwrap_or(rest.len());
            tokens.push((Token::Word(rest[..length].to_owned()), line));
            length
        } else if is_number(rest) {
            let length = number_length(rest);
            tokens.push((Token::Number(rest[..length].to_owned()), line));
            length
        } else if first == '"' {
            let Some(end) = rest[1..].find('"') else {
                return Err(JmplError::shape(file, line, "this text is not closed with `\"`"));
            };
            tokens.push((Token::Text(rest[1..=end].to_owned()), line));
            end + 2
        } else if rest.starts_with("!=") {
            tokens.push((Token::Sign('≠'), line));
            2
        } else if ["==", "&&", "||"].iter().any(|twice| rest.starts_with(twice)) {
            tokens.push((Token::Sign(first), line));
            2
        } else if "{}()[],;:.*+=&|!~".contains(first) {
            tokens.push((Token::Sign(if first == '~' { '!' } else { first }), line));
            1
        } else if first.is_whitespace() || first == '\u{feff}' {
            first.len_utf8()
        } else {
            return Err(JmplError::shape(file, line, &format!("unrecognized character `{first}`")));
        };
        line += rest[..length].matches('\n').count() as u32;
        rest = &rest[length..];
    }
    Ok(tokens)
}

const fn is_word_start(letter: char) -> bool {
    letter.is_ascii_alphabetic() || letter == '_' || letter == '$'
}

const fn is_word(letter: char) -> bool {
    is_word_start(letter) || letter.is_ascii_digit()
}

fn is_number(rest: &str) -> bool {
    rest.trim_start_matches(['-', '.']).starts_with(|letter: char| letter.is_ascii_digit())
        && rest.starts_with(|letter: char| letter.is_ascii_digit() || letter == '.' || letter == '-')
}

/// The length of a number such as `.5`, `0.05` or `1.0e-4`.
fn number_length(rest: &str) -> usize {
    let mut before = ' ';
    for (at, letter) in rest.char_indices() {
        let is_sign = letter == '-' && (at == 0 || matches!(before, 'e' | 'E'));
        if !(letter.is_ascii_digit() || matches!(letter, '.' | 'e' | 'E') || is_sign) {
            return at;
        }
        before = letter;
    }
    rest.len()
}
