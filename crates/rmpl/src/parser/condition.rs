//! Conditions (SPEC 1.2): `not`, `!`, parentheses, and the literal inside.

use super::{MAX_NESTING, Parser};
use crate::diagnostics::syntax;
use crate::syntax::SyntaxKind;

impl Parser<'_> {
    /// A condition; its negations and parentheses are tokens of one flat node.
    pub(super) fn condition(&mut self) {
        let node = self.open();
        let mut open_parens = 0_u32;
        let mut prefixes = 0_u32;
        loop {
            match self.kind {
                SyntaxKind::NotKeyword | SyntaxKind::Bang => self.bump(),
                SyntaxKind::LeftParen => {
                    self.bump();
                    open_parens += 1;
                }
                _ => break,
            }
            prefixes += 1;
        }
        if prefixes > MAX_NESTING {
            let diagnostic = syntax::too_deep(self.here());
            self.report(diagnostic);
        }
        self.literal();
        while open_parens > 0 && self.eat(SyntaxKind::RightParen) {
            open_parens -= 1;
        }
        if open_parens > 0 {
            self.report_missing("`)`", ")");
        }
        self.close(node, SyntaxKind::Condition);
    }

    fn literal(&mut self) {
        if !self.eat(SyntaxKind::Name) {
            let keyword = self.kind.is_keyword() && self.kind != SyntaxKind::ThennextKeyword;
            if keyword && self.peek() != SyntaxKind::LeftBrace {
                let diagnostic = syntax::keyword_as_name(self.current_text(), self.here());
                self.report(diagnostic);
                self.bump();
                self.hush();
            } else {
                self.report_expected("a condition such as `X` or `X=V`");
                return;
            }
        }
        if !matches!(self.kind, SyntaxKind::Equals | SyntaxKind::NotEquals) {
            return;
        }
        self.bump();
        if self.at(SyntaxKind::Equals) {
            let diagnostic = syntax::double_equals(self.here());
            self.report(diagnostic);
            self.bump();
            self.hush();
        }
        if !self.eat(SyntaxKind::Name) && !self.eat(SyntaxKind::Number) {
            self.report_expected("a value");
            if self.kind.is_keyword() && !self.at_statement_end() && self.kind != SyntaxKind::ThennextKeyword
            {
                self.bump();
                self.hush();
            }
        }
    }
}
