//! Flight rules: conditions of the mission's language, on activities and amounts as well, with when they hold (SPEC 16.1).
//!
//! `always`, `never`, `while`, `at`, `from`, `to` and `of` are words only in their places.

use super::Parser;
use crate::syntax::SyntaxKind;

impl Parser<'_> {
    /// `[always | never] condition [while condition] [moment]`
    pub(super) fn flight_rule(&mut self) {
        self.is_rule = true;
        let node = self.open();
        if self.at_rule_word() {
            self.bump();
        }
        self.condition();
        if self.eat_word("while") {
            self.condition();
        }
        if self.at_word("at") || self.at_word("from") {
            self.moment();
        }
        if !self.at(SyntaxKind::End) {
            self.report_expected("`and`, `or`, `while`, `at`, `from` or the end of the rule");
            self.skip_until(|parser| parser.at(SyntaxKind::End));
        }
        self.close(node, SyntaxKind::Rule);
    }

    /// Returns whether the rule begins with its word, which may be the name of a variable as well.
    fn at_rule_word(&mut self) -> bool {
        let is_name = matches!(
            self.peek(),
            SyntaxKind::Equals | SyntaxKind::NotEquals | SyntaxKind::Order | SyntaxKind::End
        );
        !is_name && (self.at_word("always") || self.at_word("never"))
    }

    /// `at start`, `at end of Drive`, `from 10 to 20`
    fn moment(&mut self) {
        let node = self.open();
        if self.eat_word("from") {
            self.sum();
            if self.eat_word("to") {
                self.sum();
            } else {
                self.report_expected("`to` and a time");
            }
        } else {
            self.bump();
            if !self.eat_word("start") && !self.eat_word("end") {
                self.report_expected("`start` or `end`");
            } else if self.eat_word("of") && !self.eat(SyntaxKind::String) {
                if !self.eat(SyntaxKind::Name) {
                    self.report_expected("an activity");
                } else if self.at(SyntaxKind::LeftParen) {
                    self.arguments();
                }
            }
        }
        self.close(node, SyntaxKind::Moment);
    }

    /// Returns what follows the name of an activity or a resource, if that is what the name is.
    pub(super) fn rule_atom(&mut self) -> bool {
        if self.eat(SyntaxKind::Order) {
            self.sum();
            return true;
        }
        let is_call = self.at(SyntaxKind::LeftParen);
        if is_call {
            self.arguments();
        }
        is_call
    }

    /// The index after an order or the arguments of an activity at `index`.
    pub(super) fn behind_rule_atom(&mut self, index: u32) -> u32 {
        let mut index = index;
        let mut depth = 0_u32;
        loop {
            let kind = self.kind_at(index);
            let is_joint = kind == SyntaxKind::Name && matches!(self.text_of(index), "and" | "or" | "while");
            match kind {
                SyntaxKind::End
                | SyntaxKind::Semicolon
                | SyntaxKind::LeftBrace
                | SyntaxKind::RightBrace
                | SyntaxKind::ThennextKeyword => return index,
                SyntaxKind::LeftParen => depth += 1,
                SyntaxKind::RightParen if depth == 0 => return index,
                SyntaxKind::RightParen => depth -= 1,
                _ if is_joint && depth == 0 => return index,
                _ => {}
            }
            index = self.index_after(index);
        }
    }
}
