//! The canonical layout of a text in prefix notation: two blanks per depth, one form per line where a line is too long.

use super::duration::units;
use super::keyword::{self, EXPRESSION_KEYWORDS, MODEL_KEYWORDS, TIMED_KEYWORDS};
use super::lexer::{Token, TokenKind, lex};

/// Lines are broken when they would be longer than this many characters.
const LINE_WIDTH: usize = 100;

/// Lays out `text` again; comments stay, torn keywords are fixed, and the meaning does not change.
///
/// A text whose parentheses do not match is given back as it is.
pub fn format(text: &str) -> String {
    let tokens = lex(text);
    let (tree, diagnostics) = super::tree::build(text, &tokens);
    if !tree.broken.is_empty()
        || diagnostics.iter().any(|diagnostic| diagnostic.severity == crate::Severity::Error)
    {
        return text.to_owned();
    }
    let pieces = pieces(text, &tokens);
    let mut out = String::new();
    let mut at = 0;
    while at < pieces.len() {
        let unit = unit_end(&pieces, at);
        if !out.is_empty() && pieces.get(at).is_some_and(|piece| piece.blank_before) {
            out.push('\n');
        }
        lay_out(pieces.get(at..unit).unwrap_or_default(), 0, &mut out);
        out.push('\n');
        at = unit;
    }
    out
}

/// A piece of the text that no layout changes inside.
struct Piece {
    kind: TokenKind,
    text: String,
    /// Whether an empty line is before it.
    blank_before: bool,
    /// Whether it starts a line in the source.
    starts_line: bool,
    /// How many pieces the list that opens here takes, itself included.
    length: usize,
}

fn pieces(text: &str, tokens: &[Token]) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut newlines = 2;
    let mut open: Vec<usize> = Vec::new();
    for token in tokens {
        let slice = text.get(token.span.range()).unwrap_or("");
        if token.kind == TokenKind::Whitespace {
            newlines += slice.matches('\n').count();
            continue;
        }
        if token.kind == TokenKind::Comma {
            continue;
        }
        let piece = Piece {
            kind: token.kind,
            text: canonical(token.kind, slice.trim_end()),
            blank_before: newlines > 1 && !pieces.is_empty(),
            starts_line: newlines > 0,
            length: 1,
        };
        newlines = 0;
        match token.kind {
            TokenKind::Open | TokenKind::OpenBrace => open.push(pieces.len()),
            TokenKind::Close | TokenKind::CloseBrace => {
                let length = pieces.len() + 1;
                if let Some((start, piece)) =
                    open.pop().and_then(|start| Some((start, pieces.get_mut(start)?)))
                {
                    piece.length = length - start;
                }
            }
            _ => {}
        }
        if !mends(&mut pieces, &piece) {
            pieces.push(piece);
        }
    }
    pieces
}

/// Joins `-watching` to a `do` before it, if a keyword is torn there.
fn mends(pieces: &mut [Piece], piece: &Piece) -> bool {
    let [.., before, last] = pieces else { return false };
    if piece.kind != TokenKind::Word || last.kind != TokenKind::Word || before.kind != TokenKind::Open {
        return false;
    }
    let joined = format!("{}{}", last.text, piece.text).to_ascii_uppercase();
    let torn = last.text.ends_with('-') || piece.text.starts_with('-');
    if torn && EXPRESSION_KEYWORDS.iter().any(|keyword| keyword.starts_with(joined.as_str())) {
        last.text = joined;
        return true;
    }
    false
}

fn canonical(kind: TokenKind, text: &str) -> String {
    match kind {
        TokenKind::Tilde => "~".into(),
        TokenKind::DoubleColon => "::".into(),
        TokenKind::Word => {
            let upper: String = text
                .chars()
                .map(|c| if super::lexer::is_hyphen(c) { '-' } else { c.to_ascii_uppercase() })
                .collect();
            let is_keyword = EXPRESSION_KEYWORDS.contains(&upper.as_str())
                || MODEL_KEYWORDS.contains(&upper.as_str())
                || matches!(upper.as_str(), "AND" | "OR" | "NOT" | "NOT-ENTAILED" | "HELD");
            // Names are case-sensitive: a variable called `mode` or `port` keeps its case.
            if is_keyword && (upper.contains('-') || text.chars().all(char::is_uppercase)) {
                upper
            } else {
                text.into()
            }
        }
        _ => text.into(),
    }
}

/// Returns where the definition, form or comment that starts at `at` ends.
fn unit_end(pieces: &[Piece], at: usize) -> usize {
    let Some(first) = pieces.get(at) else { return at };
    let mut end = at + first.length;
    if first.kind == TokenKind::Word && pieces.get(end).is_some_and(|piece| piece.kind == TokenKind::Open) {
        end += pieces.get(end).map_or(0, |piece| piece.length);
        if pieces.get(end).is_some_and(|piece| piece.kind == TokenKind::DoubleColon) {
            end += 1;
            while pieces
                .get(end)
                .is_some_and(|piece| matches!(piece.kind, TokenKind::Comment | TokenKind::Tilde))
            {
                end += 1;
            }
            end += pieces.get(end).map_or(0, |piece| piece.length);
        }
    }
    while pieces.get(end).is_some_and(|piece| piece.kind == TokenKind::Comment && !piece.starts_line) {
        end += 1;
    }
    end.max(at + 1).min(pieces.len())
}

fn on_one_line(pieces: &[Piece]) -> Option<String> {
    let mut line = String::new();
    let mut glued = true;
    for piece in pieces {
        match piece.kind {
            TokenKind::Comment => return None,
            TokenKind::Close | TokenKind::CloseBrace => {
                line.push_str(&piece.text);
                glued = false;
                continue;
            }
            TokenKind::DoubleColon => {
                line.push_str("::");
                glued = false;
                continue;
            }
            _ => {}
        }
        if !glued {
            line.push(' ');
        }
        line.push_str(&piece.text);
        glued = matches!(piece.kind, TokenKind::Open | TokenKind::OpenBrace | TokenKind::Tilde);
        if line.len() > 4 * LINE_WIDTH {
            return None;
        }
    }
    Some(line)
}

/// Writes pieces that stand side by side; `depth` is that of the line they start on.
fn lay_out(pieces: &[Piece], depth: usize, out: &mut String) {
    let column = out.rsplit('\n').next().map_or(0, |line| line.chars().count());
    if let Some(line) = on_one_line(pieces)
        && column + line.chars().count() <= LINE_WIDTH
    {
        out.push_str(&line);
        return;
    }
    let mut at = 0;
    let mut fresh = true;
    while let Some(piece) = pieces.get(at) {
        let end = at + piece.length;
        if piece.kind == TokenKind::Comment && !fresh && !piece.starts_line {
            out.push_str("  ");
        } else if !fresh && piece.kind != TokenKind::DoubleColon {
            let after_definition =
                pieces.get(at.wrapping_sub(1)).is_some_and(|before| before.kind == TokenKind::DoubleColon);
            let parameters = at == 1
                && piece.kind == TokenKind::Open
                && pieces.get(end).is_some_and(|next| next.kind == TokenKind::DoubleColon);
            if parameters {
                out.push(' ');
            } else {
                new_line(depth + usize::from(after_definition), out);
            }
        }
        fresh = piece.kind == TokenKind::Tilde;
        if piece.length > 1 {
            let inner_depth =
                out.rsplit('\n').next().map_or(0, |line| (line.len() - line.trim_start().len()) / 2);
            list(pieces.get(at..end).unwrap_or_default(), inner_depth, out);
        } else {
            out.push_str(&piece.text);
        }
        at = end;
    }
}

fn list(pieces: &[Piece], depth: usize, out: &mut String) {
    let column = out.rsplit('\n').next().map_or(0, |line| line.chars().count());
    if let Some(line) = on_one_line(pieces)
        && column + line.chars().count() <= LINE_WIDTH
    {
        out.push_str(&line);
        return;
    }
    let [open, inner @ .., close] = pieces else { return };
    out.push_str(&open.text);
    let kept = kept_on_first_line(inner);
    let (first, rest) = inner.split_at(kept);
    if let Some(line) = on_one_line(first) {
        out.push_str(&line);
    } else {
        lay_out(first, depth + 1, out);
    }
    let comment_last = rest.last().or(first.last()).is_some_and(|piece| piece.kind == TokenKind::Comment);
    if !rest.is_empty() {
        if rest.first().is_some_and(|piece| piece.kind == TokenKind::Comment && !piece.starts_line) {
            out.push_str("  ");
        } else if kept > 0 {
            new_line(depth + 1, out);
        }
        lay_out_broken(rest, depth + 1, out);
    }
    if comment_last {
        new_line(depth, out);
    }
    out.push_str(&close.text);
}

/// Each piece on a line of its own, whether or not all would fit on one.
fn lay_out_broken(pieces: &[Piece], depth: usize, out: &mut String) {
    let mut at = 0;
    while let Some(piece) = pieces.get(at) {
        let mut end = at + piece.length;
        while pieces.get(end.wrapping_sub(1)).is_some_and(|piece| piece.kind == TokenKind::Tilde) {
            end += pieces.get(end).map_or(0, |piece| piece.length).max(1);
        }
        let is_connective = matches!(piece.text.as_str(), "AND" | "OR" | "and" | "or");
        if at > 0 {
            if piece.kind == TokenKind::Comment && !piece.starts_line {
                out.push_str("  ");
            } else if is_connective {
                out.push(' ');
            } else {
                new_line(depth, out);
            }
        }
        lay_out(pieces.get(at..end.min(pieces.len())).unwrap_or_default(), depth, out);
        at = end;
    }
}

/// The head of a form, and with it the names and guards that say what the form is about.
fn kept_on_first_line(inner: &[Piece]) -> usize {
    let Some(head) = inner.first().filter(|piece| piece.kind == TokenKind::Word) else { return 0 };
    let upper = head.text.to_ascii_uppercase();
    let extra = match upper.as_str() {
        "PARALLEL" | "SEQUENCE" | "ALWAYS" | "AND" | "OR" | "CHOOSE-PROB" | "CHOOSE-REWARD" => 0,
        "WITHIN" => 2,
        _ if keyword::EXPRESSION_KEYWORDS.contains(&upper.as_str()) => 1,
        "DEFCLASS" | "DEFINSTANCE" | "DEFOPTION" | "VAR" | "PART" | "METHOD" | "TRANSITION" => 2,
        "FAULT" => 3,
        "MODE" | "COMMAND" | "PORT" | "HELD" | "DEFSTEP" => 1,
        _ => 0,
    };
    let mut kept = 1;
    let mut taken = 0;
    while taken < extra {
        match inner.get(kept) {
            None => break,
            Some(piece) if piece.kind == TokenKind::Comment => break,
            Some(piece) if piece.kind == TokenKind::Tilde => kept += 1,
            Some(piece) => {
                kept += piece.length;
                taken += 1;
                // The unit of a duration may stand apart.
                let is_unit = |unit: &&Piece| units().contains(&unit.text.as_str());
                let is_duration = TIMED_KEYWORDS.contains(&upper.as_str()) || upper == "HELD";
                kept += usize::from(is_duration && inner.get(kept).as_ref().is_some_and(is_unit));
            }
        }
    }
    kept.min(inner.len())
}

fn new_line(depth: usize, out: &mut String) {
    out.push('\n');
    out.push_str(&"  ".repeat(depth));
}
