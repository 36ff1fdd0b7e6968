//! The lossless tree of the prefix notation: parentheses matched as well as they can be.
//!
//! Nothing here knows what a form means.

use crate::diagnostic::{Code, Diagnostic, Edit, Fix};
use crate::span::Span;

use super::lexer::{Token, TokenKind};

/// Lists nested more deeply than this are refused, so that reading them needs no deep stack.
const DEEPEST_NESTING: usize = 200;

/// A token or a parenthesized list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Node {
    /// A token that is not a parenthesis, blank or comment.
    Leaf(Token),
    /// What is between parentheses or braces.
    List(List),
}

impl Node {
    /// Returns where the node is.
    pub const fn span(&self) -> Span {
        match self {
            Self::Leaf(token) => token.span,
            Self::List(list) => list.span,
        }
    }
}

/// A list with its parentheses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct List {
    /// What is inside, without blanks and comments.
    pub items: Vec<Node>,
    /// From the opening to the closing parenthesis, or to the last item if it is never closed.
    pub span: Span,
    /// Whether braces rather than parentheses enclose it.
    pub braced: bool,
}

/// A tree over all tokens of a text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tree {
    /// What is outside all parentheses.
    pub items: Vec<Node>,
    /// Where parentheses do not match: what is read from around there is a guess.
    pub broken: Vec<Span>,
}

struct Open {
    token: Token,
    items: Vec<Node>,
}

/// Matches parentheses; a list left open ends where the next definition starts at a line's beginning.
pub(super) fn build(text: &str, tokens: &[Token]) -> (Tree, Vec<Diagnostic>) {
    let mut builder =
        Builder { text, tokens, stack: Vec::new(), tree: Tree::default(), diagnostics: Vec::new() };
    for (at, token) in tokens.iter().enumerate() {
        builder.take(at, *token);
    }
    builder.close_all(text.trim_end().len() as u32);
    (builder.tree, builder.diagnostics)
}

struct Builder<'text> {
    text: &'text str,
    tokens: &'text [Token],
    stack: Vec<Open>,
    tree: Tree,
    diagnostics: Vec<Diagnostic>,
}

impl Builder<'_> {
    fn take(&mut self, at: usize, token: Token) {
        if token.kind.is_trivia() {
            return;
        }
        if !self.stack.is_empty() && self.starts_definition(at) {
            self.close_all(token.span.start);
        }
        match token.kind {
            TokenKind::Open | TokenKind::OpenBrace => self.open(token),
            TokenKind::Close | TokenKind::CloseBrace => self.close(token),
            TokenKind::Unknown => self.refuse(token),
            _ => self.push(Node::Leaf(token)),
        }
    }

    fn open(&mut self, token: Token) {
        if self.stack.len() == DEEPEST_NESTING {
            self.diagnostics.push(
                Diagnostic::error(
                    Code("E-SYNTAX"),
                    token.span,
                    format!("parentheses are nested more than {DEEPEST_NESTING} deep"),
                )
                .with_hint("move an inner part into its own definition"),
            );
            self.tree.broken.push(token.span);
        }
        self.stack.push(Open { token, items: Vec::new() });
    }

    fn close(&mut self, token: Token) {
        let braced = token.kind == TokenKind::CloseBrace;
        let Some(open) = self.stack.pop() else {
            let word = if braced { "}" } else { ")" };
            self.diagnostics.push(
                Diagnostic::error(Code("E-SYNTAX"), token.span, format!("unmatched `{word}`"))
                    .with_fix(replace(&format!("Remove `{word}`"), token.span, "")),
            );
            self.tree.broken.push(token.span);
            return;
        };
        if braced != (open.token.kind == TokenKind::OpenBrace) {
            let (opened, wanted) = if braced { ("(", ")") } else { ("{", "}") };
            self.diagnostics.push(
                Diagnostic::error(
                    Code("E-SYNTAX"),
                    token.span,
                    format!("expected `{wanted}` to close `{opened}`"),
                )
                .with_fix(replace(&format!("Write `{wanted}`"), token.span, wanted)),
            );
            self.tree.broken.push(token.span);
        }
        self.finish(open, token.span.end);
    }

    fn finish(&mut self, open: Open, end: u32) {
        let span = Span::new(open.token.span.start, end);
        let braced = open.token.kind == TokenKind::OpenBrace;
        // Past the limit the inside is dropped: the diagnostic has been given, and no reader goes that deep.
        let items = if self.stack.len() >= DEEPEST_NESTING { Vec::new() } else { open.items };
        self.push(Node::List(List { items, span, braced }));
    }

    fn close_all(&mut self, end: u32) {
        let missing = self.stack.len();
        let Some(outermost) = self.stack.first().map(|open| open.token) else { return };
        let closers: String = self
            .stack
            .iter()
            .rev()
            .map(|open| if open.token.kind == TokenKind::Open { ')' } else { '}' })
            .collect();
        let what = if missing == 1 {
            "this parenthesis is never closed".into()
        } else {
            format!("{missing} parentheses starting here are never closed")
        };
        let insert = self.text.get(..end as usize).map_or(end, |before| before.trim_end().len() as u32);
        self.diagnostics.push(
            Diagnostic::error(Code("E-SYNTAX"), outermost.span, what)
                .with_hint(format!("expected `{closers}`"))
                .with_fix(replace(&format!("Add `{closers}`"), Span::new(insert, insert), &closers)),
        );
        self.tree.broken.push(Span::new(outermost.span.start, insert));
        while let Some(open) = self.stack.pop() {
            self.finish(open, insert);
        }
    }

    fn refuse(&mut self, token: Token) {
        let text = self.text.get(token.span.range()).unwrap_or("");
        let mut diagnostic =
            Diagnostic::error(Code("E-LEX"), token.span, format!("unexpected `{text}` in a control program"));
        if text.contains(['¬', '!', '\u{304}', '\u{305}']) {
            diagnostic = diagnostic.with_hint("write `~c` for non-entailment and `(NOT c)` for negation");
        } else if text == ":" {
            diagnostic = diagnostic.with_hint("write a definition as `Name ():: …`");
        } else if text.contains(['&', '|']) {
            diagnostic = diagnostic.with_hint("write `AND` and `OR`");
        }
        self.diagnostics.push(diagnostic);
    }

    fn push(&mut self, node: Node) {
        match self.stack.last_mut() {
            Some(open) => open.items.push(node),
            None => self.tree.items.push(node),
        }
    }

    /// Returns whether `NAME (…) ::`, `(DEFCLASS`, `(DEFINSTANCE`, `(DEFOPTION` or `(DEFSTEP` starts at token `at`, at
    /// a line's beginning.
    fn starts_definition(&self, at: usize) -> bool {
        let Some(token) = self.tokens.get(at) else { return false };
        let at_line_start =
            self.text.get(..token.span.start as usize).is_some_and(|before| before.ends_with('\n'));
        if !at_line_start {
            return false;
        }
        let mut following = self.tokens.iter().skip(at).filter(|token| !token.kind.is_trivia());
        match token.kind {
            TokenKind::Open => following.nth(1).is_some_and(|word| {
                let word = self.text.get(word.span.range()).unwrap_or("");
                ["DEFCLASS", "DEFINSTANCE", "DEFOPTION", "DEFSTEP"]
                    .iter()
                    .any(|head| word.eq_ignore_ascii_case(head))
            }),
            TokenKind::Word => {
                following.next();
                let mut kinds = following
                    .map(|token| token.kind)
                    .skip_while(|kind| matches!(kind, TokenKind::Open | TokenKind::Word | TokenKind::Comma));
                kinds.next() == Some(TokenKind::Close) && kinds.next() == Some(TokenKind::DoubleColon)
            }
            _ => false,
        }
    }
}

fn replace(label: &str, span: Span, text: &str) -> Fix {
    Fix { label: label.into(), edits: vec![Edit { span, text: text.into() }] }
}
