//! Conditions: literals with `not`, `!` and parentheses (SPEC 1.2), joined by `and` and `or` (SPEC 14).
//!
//! `and`, `or` and `in` are keywords only after a literal, `visible` only after `in`, and `at start` only after the bound of a
//! level.

use super::{MAX_NESTING, Mark, Parser};
use crate::diagnostics::syntax;
use crate::syntax::SyntaxKind;

impl Parser<'_> {
    /// Conditions joined by `or`, which binds loosest.
    pub(super) fn condition(&mut self) {
        let mark = self.next_mark();
        self.conjunction();
        self.joined(mark, "or", SyntaxKind::AnyOf, Self::conjunction);
    }

    fn conjunction(&mut self) {
        let mark = self.next_mark();
        self.negation();
        self.joined(mark, "and", SyntaxKind::AllOf, Self::negation);
    }

    /// Further operands after the one at `mark`, in one node.
    fn joined(&mut self, mark: Mark, word: &str, kind: SyntaxKind, operand: impl Fn(&mut Self)) {
        if !self.at_word(word) {
            return;
        }
        let node = self.open_around(mark);
        while self.eat_word(word) {
            operand(self);
        }
        self.close(node, kind);
    }

    /// One literal, or several in parentheses.
    fn negation(&mut self) {
        if !self.at_group() {
            self.literal();
            return;
        }
        let node = self.open();
        if self.eat(SyntaxKind::NotKeyword) || self.eat(SyntaxKind::Bang) {
            self.nested(Self::negation);
            self.close(node, SyntaxKind::NotOf);
        } else {
            self.bump();
            self.nested(Self::condition);
            self.expect_behind(SyntaxKind::RightParen, ")");
            self.close(node, SyntaxKind::ConditionGroup);
        }
    }

    /// Returns whether negations and parentheses stand here around several literals.
    fn at_group(&mut self) -> bool {
        let mut index = self.current;
        let mut open_parens = 0_u32;
        for _ in 0..MAX_NESTING {
            match self.kind_at(index) {
                SyntaxKind::NotKeyword | SyntaxKind::Bang => {}
                SyntaxKind::LeftParen => open_parens += 1,
                _ => break,
            }
            index = self.index_after(index);
        }
        let is_quoted = self.is_rule && self.kind_at(index) == SyntaxKind::String;
        self.join_index_before_dot(index);
        if open_parens == 0 || (self.kind_at(index) != SyntaxKind::Name && !is_quoted) {
            return false;
        }
        index = self.index_after(index);
        if self.kind_at(index) == SyntaxKind::Dot {
            index = self.index_after(index);
            index = self.index_after(index);
        }
        if matches!(self.kind_at(index), SyntaxKind::Equals | SyntaxKind::NotEquals) {
            index = self.index_after(index);
            index = self.index_after(index);
        } else if self.kind_at(index) == SyntaxKind::Order
            || (self.is_rule && self.kind_at(index) == SyntaxKind::LeftParen)
        {
            index = self.behind_rule_atom(index);
        } else if self.kind_at(index) == SyntaxKind::Name && self.text_of(index) == "in" {
            let set = self.index_after(index);
            let last = match self.kind_at(set) {
                SyntaxKind::Name => SyntaxKind::RightParen,
                _ => SyntaxKind::RightBrace,
            };
            while !matches!(self.kind_at(index), SyntaxKind::Semicolon | SyntaxKind::End)
                && self.kind_at(index) != last
            {
                index = self.index_after(index);
            }
            index = self.index_after(index);
        }
        // A parenthesis that closes before `and` groups one literal; the group may be a larger one around it.
        while open_parens > 0 && self.kind_at(index) == SyntaxKind::RightParen {
            open_parens -= 1;
            index = self.index_after(index);
        }
        open_parens > 0
            && self.kind_at(index) == SyntaxKind::Name
            && matches!(self.text_of(index), "and" | "or")
    }

    /// Returns whether `and`, `or` or `in` is after the name at the cursor.
    pub(super) fn at_joined_literal(&mut self) -> bool {
        let next = self.index_after(self.current);
        self.kind_at(next) == SyntaxKind::Name && matches!(self.text_of(next), "and" | "or" | "in")
    }

    /// Returns whether `X in` stands here.
    pub(super) fn at_membership(&mut self) -> bool {
        let next = self.index_after(self.current);
        self.kind_at(next) == SyntaxKind::Name && self.text_of(next) == "in"
    }

    /// A literal; its negations and parentheses are tokens of one flat node.
    pub(super) fn literal(&mut self) {
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
        self.comparison();
        while open_parens > 0 && self.eat(SyntaxKind::RightParen) {
            open_parens -= 1;
        }
        if open_parens > 0 {
            self.report_missing("`)`", ")");
        }
        self.close(node, SyntaxKind::Condition);
    }

    fn comparison(&mut self) {
        if self.is_rule && self.eat(SyntaxKind::String) {
            return;
        }
        self.join_index_before_dot(self.current);
        let is_place = self.at(SyntaxKind::Name) && self.peek() == SyntaxKind::Dot;
        if !self.variable_name() {
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
        if self.at_word("in") {
            self.bump();
            if self.at_word("visible") {
                self.visible();
            } else {
                self.domain();
            }
            return;
        }
        if self.is_rule && self.rule_atom() {
            return;
        }
        if matches!(self.kind, SyntaxKind::Equals | SyntaxKind::NotEquals) {
            self.bump();
            self.value();
        } else if self.eat(SyntaxKind::Order) {
            self.sum();
            if self.at_start_of_activity(self.current) {
                self.bump();
                self.bump();
            }
        } else if is_place {
            self.report_expected("`=` and a location or a value, or a comparison of a level such as `>= 30`");
            self.skip_until(|parser| !parser.at(SyntaxKind::LeftParen));
        }
    }

    /// `visible(BASE)`
    fn visible(&mut self) {
        let node = self.open();
        self.bump();
        if self.expect(SyntaxKind::LeftParen) {
            self.declared_name("the location that must be visible");
            if self.at(SyntaxKind::Dot) {
                let diagnostic = syntax::sight_of_vehicle(self.here());
                self.report(diagnostic);
                self.bump();
                self.hush();
                self.eat(SyntaxKind::Name);
            }
            self.expect_behind(SyntaxKind::RightParen, ")");
        }
        self.close(node, SyntaxKind::Visible);
    }

    /// The name of a variable: that of a vehicle's place is `V.at`, of its state `V.arm`, of a component's mode `C.mode`.
    pub(super) fn variable_name(&mut self) -> bool {
        self.join_index_before_dot(self.current);
        if !self.at(SyntaxKind::Name) || self.peek() != SyntaxKind::Dot {
            return self.eat(SyntaxKind::Name);
        }
        self.dotted_name(None);
        true
    }

    /// A name, and after its dot another one, which may have to be this one.
    pub(super) fn dotted_name(&mut self, word: Option<&str>) {
        let node = self.open();
        self.bump();
        self.bump();
        let is_adjacent = self.start_of(self.current) == self.previous_end();
        let is_part = match word {
            Some(word) => self.at_word(word),
            None => self.at(SyntaxKind::Name),
        };
        if is_adjacent && is_part {
            self.bump();
        } else {
            self.report_expected(match word {
                None => {
                    "`at` (place of a vehicle), `mode` (of a component), or a state or resource directly after `.`"
                }
                Some(_) => "`mode` directly after `.`",
            });
            if self.at(SyntaxKind::Name) {
                self.bump();
                self.hush();
            }
        }
        self.close(node, SyntaxKind::Dotted);
    }

    /// The value after `=`.
    pub(super) fn value(&mut self) {
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
