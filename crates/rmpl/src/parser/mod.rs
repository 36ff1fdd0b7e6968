//! The error-tolerant parser of the infix notation (SPEC 1.2, 1.3): one declaration at a time, one function per
//! production.
//!
//! It always gives a tree that holds every byte. After a mistake it continues at the next sensible place, and a mistake
//! is reported once: nothing more is said before a token has been accepted again. A declaration is parsed from its own
//! first byte without memory of what came before, which is what makes parsing after an edit local.

mod bounds;
mod clause;
mod condition;
mod declaration;
mod fleet;
mod lasting;
mod occurrence;
mod recovery;
mod rule;
mod statement;
mod world;

pub(crate) use bounds::CONTINGENT;
pub(crate) use clause::CLAUSE_WORDS;
pub(crate) use fleet::PROPERTY_WORDS;

use crate::diagnostic::{Diagnostic, Fix};
use crate::diagnostics::{lex, syntax};
use crate::span::Span;
use crate::syntax::{DeclarationTree, LexProblem, LexProblemKind, Lexer, RawNode, SyntaxKind, Token};

/// How deep braces, parentheses, `do` and `if` may nest, so that no text exhausts the stack.
pub(crate) const MAX_NESTING: u32 = 128;

/// How many operands one bound may join.
pub(crate) const MAX_OPERANDS: u32 = 128;

/// One declaration, with all offsets relative to its first byte.
pub(crate) struct ParsedDeclaration {
    pub(crate) tree: DeclarationTree,
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// How far the text was looked at: a change at or before this offset may change the declaration.
    pub(crate) reach: u32,
}

/// Memory that parsing one declaration after the other uses again.
#[derive(Default)]
pub(crate) struct Scratch {
    tokens: Vec<Token>,
    nodes: Vec<RawNode>,
}

/// Parses the declaration at the start of `text`, which is not empty.
pub(crate) fn parse_declaration(text: &str, scratch: &mut Scratch) -> ParsedDeclaration {
    scratch.tokens.clear();
    scratch.nodes.clear();
    let mut parser = Parser::new(text, std::mem::take(scratch));
    parser.file_item();
    parser.finish(scratch)
}

/// Parses a flight rule, which is not a declaration of a mission.
pub(crate) fn parse_rule(text: &str) -> ParsedDeclaration {
    let mut parser = Parser::new(text, Scratch::default());
    parser.flight_rule();
    parser.finish(&mut Scratch::default())
}

/// A node that is open: its tokens and children are still to come.
#[derive(Clone, Copy)]
struct Mark(u32);

struct Parser<'t> {
    text: &'t str,
    lexer: Lexer<'t>,
    tokens: Vec<Token>,
    /// Index of the next token that the grammar sees.
    current: u32,
    kind: SyntaxKind,
    /// Index just past the last token that was accepted.
    after_previous: u32,
    nodes: Vec<RawNode>,
    diagnostics: Vec<Diagnostic>,
    /// The value of `current` at the last report.
    reported_at: Option<u32>,
    depth: u32,
    /// The declaration nests too deeply, and the rest of it is skipped.
    is_cut: bool,
    /// Conditions are those of flight rules, which know activities and amounts as well.
    is_rule: bool,
}

impl<'t> Parser<'t> {
    fn new(text: &'t str, scratch: Scratch) -> Self {
        let mut parser = Self {
            text,
            lexer: Lexer::new(text),
            tokens: scratch.tokens,
            current: 0,
            kind: SyntaxKind::End,
            after_previous: 0,
            nodes: scratch.nodes,
            diagnostics: Vec::new(),
            reported_at: None,
            depth: 0,
            is_cut: false,
            is_rule: false,
        };
        parser.current = parser.next_significant(0);
        parser.kind = parser.kind_at(parser.current);
        parser
    }

    // Tokens.

    fn kind_at(&self, index: u32) -> SyntaxKind {
        self.tokens.get(index as usize).map_or(SyntaxKind::End, |token| token.kind)
    }

    /// The first index at or after `index` whose token the grammar sees.
    fn next_significant(&mut self, index: u32) -> u32 {
        let mut index = index;
        loop {
            while self.tokens.len() <= index as usize {
                let (kind, end) = self.lexer.next_token();
                self.tokens.push(Token { kind, end });
                if kind == SyntaxKind::End {
                    return self.tokens.len() as u32 - 1;
                }
            }
            if !self.kind_at(index).is_trivia() {
                return index;
            }
            index += 1;
        }
    }

    fn at(&self, kind: SyntaxKind) -> bool {
        self.kind == kind
    }

    /// The token after the current one.
    fn peek(&mut self) -> SyntaxKind {
        let next = self.index_after(self.current);
        self.kind_at(next)
    }

    /// The index of the token that the grammar sees after the one at `index`.
    fn index_after(&mut self, index: u32) -> u32 {
        if self.kind_at(index) == SyntaxKind::End { index } else { self.next_significant(index + 1) }
    }

    /// Accepts the current token.
    fn bump(&mut self) {
        if self.kind == SyntaxKind::End {
            return;
        }
        self.after_previous = self.current + 1;
        self.current = self.next_significant(self.current + 1);
        self.kind = self.kind_at(self.current);
    }

    fn eat(&mut self, kind: SyntaxKind) -> bool {
        let found = self.at(kind);
        if found {
            self.bump();
        }
        found
    }

    fn start_of(&self, index: u32) -> u32 {
        index.checked_sub(1).and_then(|before| self.tokens.get(before as usize)).map_or(0, |token| token.end)
    }

    fn span_of(&self, index: u32) -> Span {
        let start = self.start_of(index);
        Span::new(start, self.tokens.get(index as usize).map_or(start, |token| token.end))
    }

    fn text_of(&self, index: u32) -> &'t str {
        self.text.get(self.span_of(index).range()).unwrap_or("")
    }

    fn current_text(&self) -> &'t str {
        self.text_of(self.current)
    }

    /// Returns whether the current token is the name `word`, which is a keyword only in its place.
    fn at_word(&self, word: &str) -> bool {
        self.at(SyntaxKind::Name) && self.current_text() == word
    }

    fn eat_word(&mut self, word: &str) -> bool {
        let found = self.at_word(word);
        if found {
            self.bump();
        }
        found
    }

    // Nodes.

    fn open(&mut self) -> Mark {
        let mark = Mark(self.nodes.len() as u32);
        self.nodes.push(RawNode {
            kind: SyntaxKind::Skipped,
            first_token: self.current,
            end_token: self.current,
            size: 1,
        });
        mark
    }

    fn close(&mut self, mark: Mark, kind: SyntaxKind) {
        let size = self.nodes.len() as u32 - mark.0;
        let after = self.after_previous;
        if let Some(node) = self.nodes.get_mut(mark.0 as usize) {
            node.kind = kind;
            node.end_token = after.max(node.first_token);
            node.size = size;
        }
    }

    /// Opens a node around the node at `mark` and all that came after it.
    fn open_around(&mut self, mark: Mark) -> Mark {
        let at = mark.0 as usize;
        if let Some(&inner) = self.nodes.get(at) {
            self.nodes.insert(at, inner);
        }
        mark
    }

    fn next_mark(&self) -> Mark {
        Mark(self.nodes.len() as u32)
    }

    /// Runs `inner` one level deeper, or reports that the text nests too deeply and skips the rest of the declaration.
    fn nested(&mut self, inner: impl FnOnce(&mut Self)) {
        if self.depth >= MAX_NESTING {
            let span = self.span_of(self.current);
            self.report(syntax::too_deep(span));
            self.is_cut = true;
            self.skip_until(Self::at_declaration_at_line_start);
            return;
        }
        self.depth += 1;
        inner(self);
        self.depth -= 1;
    }

    // Reports.

    /// Adds a diagnostic, unless one was given since the last token was accepted.
    fn report(&mut self, diagnostic: Diagnostic) {
        if self.reported_at != Some(self.current) && !self.is_cut {
            self.diagnostics.push(diagnostic);
        }
        self.reported_at = Some(self.current);
    }

    /// Says nothing more about the current place.
    fn hush(&mut self) {
        self.reported_at = Some(self.current);
    }

    /// Reports that `wanted` should stand where the current token is.
    fn report_expected(&mut self, wanted: &str) {
        let diagnostic = syntax::expected(wanted, self.found(), self.here());
        self.report(diagnostic);
    }

    /// Reports that `wanted` is missing after the token accepted last; `insertion` would fix it.
    fn report_missing(&mut self, wanted: &str, insertion: &str) {
        let place = self.previous_end();
        let span = Span::new(self.last_character_start(place), place);
        let diagnostic = syntax::missing(wanted, self.found(), span, place, insertion);
        self.report(diagnostic);
    }

    fn found(&self) -> syntax::Found<'t> {
        if self.at(SyntaxKind::End) { syntax::Found::End } else { syntax::Found::Text(self.current_text()) }
    }

    /// The current token, or the last character of the text at its end.
    fn here(&self) -> Span {
        if !self.at(SyntaxKind::End) {
            return self.span_of(self.current);
        }
        let place = self.previous_end();
        Span::new(self.last_character_start(place), place)
    }

    fn previous_end(&self) -> u32 {
        self.start_of(self.after_previous)
    }

    fn last_character_start(&self, end: u32) -> u32 {
        let before = self.text.get(..end as usize).unwrap_or("");
        before.chars().next_back().map_or(end, |last| end - last.len_utf8() as u32)
    }

    fn expect(&mut self, kind: SyntaxKind) -> bool {
        let found = self.eat(kind);
        if !found {
            self.report_expected(kind.describe());
        }
        found
    }

    /// Accepts a separator or terminator, or reports it missing after what is before it.
    fn expect_behind(&mut self, kind: SyntaxKind, insertion: &str) -> bool {
        let found = self.eat(kind);
        if !found {
            self.report_missing(kind.describe(), insertion);
        }
        found
    }

    fn finish(mut self, scratch: &mut Scratch) -> ParsedDeclaration {
        let reach = self.tokens.last().map_or(0, |token| token.end) + 2;
        let end = self.end_of_declaration();
        self.tokens.truncate(end as usize);
        let length = self.tokens.last().map_or(0, |token| token.end);
        let problems = std::mem::take(&mut self.lexer.problems);
        for problem in runs(problems.into_iter().filter(|problem| problem.start < length), self.text) {
            self.diagnostics.push(lex::diagnostic(problem, self.text));
        }
        if let Some(root) = self.nodes.first_mut() {
            root.end_token = end;
            root.first_token = 0;
        }
        self.diagnostics.sort_by_key(|diagnostic| diagnostic.span.start);
        // Copies have exactly the size that they need.
        let tree = DeclarationTree { tokens: self.tokens.clone(), nodes: self.nodes.clone() };
        *scratch = Scratch { tokens: self.tokens, nodes: self.nodes };
        ParsedDeclaration { tree, diagnostics: self.diagnostics, reach }
    }

    /// The index just past the last token: comments after a declaration on its line belong to it, and at the end of
    /// the text everything does.
    fn end_of_declaration(&mut self) -> u32 {
        if self.after_previous == 0 && self.at(SyntaxKind::End) {
            return self.current;
        }
        let mut end = self.after_previous;
        for index in self.after_previous..self.current {
            let text = self.text_of(index);
            if text.contains('\n') && !self.kind_at(index).is_comment() {
                break;
            }
            if self.kind_at(index) != SyntaxKind::Whitespace {
                end = index + 1;
            }
            if text.contains('\n') {
                break;
            }
        }
        end
    }
}

/// Characters without a meaning that only blanks part are one mistake.
fn runs(problems: impl Iterator<Item = LexProblem>, text: &str) -> Vec<LexProblem> {
    let mut runs: Vec<LexProblem> = Vec::new();
    for problem in problems {
        match runs.last_mut() {
            Some(last)
                if (last.kind, problem.kind) == (LexProblemKind::Unknown, LexProblemKind::Unknown)
                    && text
                        .get(last.end as usize..problem.start as usize)
                        .is_some_and(|between| between.trim().is_empty()) =>
            {
                last.end = problem.end;
            }
            _ => runs.push(problem),
        }
    }
    runs
}

/// A fix of one insertion.
pub(crate) fn insertion(label: impl Into<String>, at: u32, text: impl Into<String>) -> Fix {
    replacement(label, Span::new(at, at), text)
}

/// A fix of one replacement.
pub(crate) fn replacement(label: impl Into<String>, span: Span, text: impl Into<String>) -> Fix {
    Fix { label: label.into(), edits: vec![crate::diagnostic::Edit { span, text: text.into() }] }
}
