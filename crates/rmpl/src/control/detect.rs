//! Which of the two notations a text is written in.

use super::keyword::{EXPRESSION_KEYWORDS, MODEL_KEYWORDS};
use super::lexer::{Token, TokenKind, is_hyphen, lex};

/// Returns whether `text` is in prefix notation rather than in the notation of missions.
///
/// Broken texts are judged by what they show: forms of the one notation against marks of the other. Comments of
/// either notation (`; …`, `// …`, `/* … */`) do not count.
pub fn is_control_text(text: &str) -> bool {
    // Neither notation begins like markup.
    if has_control_block(text) || text.trim_start_matches('\u{feff}').trim_start().starts_with('<') {
        return false;
    }
    let bare = without_mission_comments(text);
    let tokens: Vec<Token> = lex(&bare).into_iter().filter(|token| !token.kind.is_trivia()).collect();
    let word = |at: usize| {
        tokens
            .get(at)
            .filter(|token| token.kind == TokenKind::Word)
            .and_then(|token| bare.get(token.span.range()))
    };
    let kind = |at: usize| tokens.get(at).map(|token| token.kind);
    let mut control = 0_u32;
    let mut mission = 0_u32;
    for at in 0..tokens.len() {
        match kind(at) {
            Some(TokenKind::DoubleColon) => control += 3,
            Some(TokenKind::Tilde) => control += 1,
            Some(TokenKind::Open) => {
                let has_parts = !matches!(kind(at + 2), None | Some(TokenKind::Close | TokenKind::Comma));
                if has_parts && word(at + 1).is_some_and(is_form_head) {
                    control += 3;
                } else if kind(at + 2) == Some(TokenKind::Equals) && kind(at + 4) == Some(TokenKind::Close) {
                    control += 1;
                }
                if at > 0 && kind(at - 1) == Some(TokenKind::Word) && kind(at + 1) == Some(TokenKind::Close) {
                    // `name()` is a call of the mission notation unless `::` makes it a definition.
                    mission += u32::from(kind(at + 2) != Some(TokenKind::DoubleColon));
                }
            }
            Some(TokenKind::Unknown) => {
                let text = tokens.get(at).and_then(|token| bare.get(token.span.range())).unwrap_or("");
                mission += u32::from(text.starts_with(['[', ']', ':', '"']));
            }
            Some(TokenKind::Word) if word(at).is_some_and(is_mission_keyword) => {
                mission += if at == 0 || kind(at - 1) != Some(TokenKind::Open) { 2 } else { 0 };
            }
            _ => {}
        }
    }
    mission += 2 * statement_ends(text);
    control > mission || (control == mission && kind(0) == Some(TokenKind::Open))
}

/// Returns whether a line begins with `control {`, which only missions have.
fn has_control_block(text: &str) -> bool {
    text.lines().any(|line| {
        let behind = line.strip_prefix("control");
        behind.is_some_and(|behind| behind.trim_start().starts_with('{'))
    })
}

fn is_form_head(word: &str) -> bool {
    let upper: String =
        word.chars().map(|c| if is_hyphen(c) { '-' } else { c.to_ascii_uppercase() }).collect();
    let torn = ["DO", "WHEN", "WHENEVER", "UNLESS", "IF", "AND", "OR", "NOT", "NOT-ENTAILED"];
    EXPRESSION_KEYWORDS.contains(&upper.as_str())
        || MODEL_KEYWORDS.contains(&upper.as_str())
        || torn.contains(&upper.as_str())
}

fn is_mission_keyword(word: &str) -> bool {
    matches!(
        word,
        "var"
            | "primitive"
            | "scenario"
            | "option"
            | "choose"
            | "maintaining"
            | "thennext"
            | "terrain"
            | "location"
            | "vehicle"
            | "obstacle"
            | "keepout"
    )
}

/// Lines on which something is before a `;`, as at the end of a declaration, and nothing or a comment after.
fn statement_ends(text: &str) -> u32 {
    text.lines()
        .filter_map(|line| line.split_once(';'))
        .filter(|(before, after)| {
            let before = before.trim();
            let ends = before.ends_with(|c: char| c.is_alphanumeric() || matches!(c, ')' | ']' | '}' | '"'));
            ends && (after.trim().is_empty() || after.trim_start().starts_with('/'))
        })
        .count() as u32
}

fn without_mission_comments(text: &str) -> String {
    let mut bare = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(['/', ';']) {
        let (before, from) = rest.split_at(at);
        bare.push_str(before);
        let length = if from.starts_with("//") || from.starts_with(';') {
            from.find('\n').unwrap_or(from.len())
        } else if from.starts_with("/*") {
            from.find("*/").map_or(from.len(), |end| end + 2)
        } else {
            bare.push('/');
            1
        };
        rest = from.get(length..).unwrap_or("");
    }
    bare.push_str(rest);
    bare
}
