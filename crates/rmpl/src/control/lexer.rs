//! Tokens of the prefix notation: every byte of the text belongs to exactly one token (SPEC 2.1).

use serde::{Deserialize, Serialize};

use crate::span::Span;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum TokenKind {
    /// Blanks and line ends.
    Whitespace,
    /// From `;` to the end of the line.
    Comment,
    /// `(`
    Open,
    /// `)`
    Close,
    /// `{`
    OpenBrace,
    /// `}`
    CloseBrace,
    /// A keyword, name, value or number.
    Word,
    /// `=`
    Equals,
    /// `~`, the bar of non-entailment.
    Tilde,
    /// `::`
    DoubleColon,
    /// `,`, which separates nothing here but is often written between arguments.
    Comma,
    /// `*`, which represents all modes.
    Star,
    /// Characters that mean nothing in this notation.
    Unknown,
}

impl TokenKind {
    /// Returns whether the token carries no meaning: blanks and comments.
    pub const fn is_trivia(self) -> bool {
        matches!(self, Self::Whitespace | Self::Comment)
    }
}

/// A piece of the text, of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Token {
    pub kind: TokenKind,
    pub span: Span,
}

/// Cuts `text` into tokens in one pass; their texts joined give `text` again.
pub fn lex(text: &str) -> Vec<Token> {
    let mut tokens: Vec<Token> = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let kind = kind_at(rest, first);
        let length = length_of(kind, rest, first);
        let start = (text.len() - rest.len()) as u32;
        let span = Span::new(start, start + length as u32);
        match tokens.last_mut() {
            Some(last) if kind == TokenKind::Unknown && last.kind == TokenKind::Unknown => {
                last.span = last.span.cover(span);
            }
            _ => tokens.push(Token { kind, span }),
        }
        rest = rest.get(length..).unwrap_or("");
    }
    tokens
}

/// Returns whether `character` is a hyphen, also as typesetting writes it.
pub(crate) const fn is_hyphen(character: char) -> bool {
    matches!(character, '-' | '\u{2010}' | '\u{2011}' | '\u{2012}' | '\u{2013}' | '\u{2212}' | '\u{ad}')
}

fn is_word(character: char) -> bool {
    character.is_alphanumeric()
        || matches!(character, '_' | '.' | '/' | '#' | '\'' | '+')
        || is_hyphen(character)
}

fn kind_at(rest: &str, first: char) -> TokenKind {
    match first {
        ';' => TokenKind::Comment,
        '(' => TokenKind::Open,
        ')' => TokenKind::Close,
        '{' => TokenKind::OpenBrace,
        '}' => TokenKind::CloseBrace,
        '=' => TokenKind::Equals,
        '~' | '\u{223c}' | '\u{2dc}' => TokenKind::Tilde,
        ',' => TokenKind::Comma,
        '*' => TokenKind::Star,
        '\u{2237}' => TokenKind::DoubleColon,
        ':' if rest.starts_with("::") => TokenKind::DoubleColon,
        _ if first.is_whitespace() || first == '\u{feff}' => TokenKind::Whitespace,
        _ if is_word(first) => TokenKind::Word,
        _ => TokenKind::Unknown,
    }
}

fn length_of(kind: TokenKind, rest: &str, first: char) -> usize {
    let run = |accept: &dyn Fn(char) -> bool| rest.find(|c| !accept(c)).unwrap_or(rest.len());
    match kind {
        TokenKind::Comment => rest.find('\n').unwrap_or(rest.len()),
        TokenKind::Whitespace => run(&|c| c.is_whitespace() || c == '\u{feff}'),
        TokenKind::Word => run(&is_word),
        TokenKind::DoubleColon if first == ':' => 2,
        _ => first.len_utf8(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_joined_give_the_text_again_whatever_it_holds() {
        for text in ["", "(a = b) ; c\n{}~ :: : é§ \u{2013}x", "(((", "\u{feff}A ()::\r\n(true)"] {
            let joined: String = lex(text).iter().map(|token| &text[token.span.range()]).collect();
            assert_eq!(joined, text);
        }
    }
}
