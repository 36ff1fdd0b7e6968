//! Statements (SPEC 1.2, 1.3): blocks, choices, `do`, `if`, calls, assertions and delays.

use super::recovery::begins_only_statements;
use super::{CONTINGENT, Parser};
use crate::diagnostics::syntax;
use crate::span::Span;
use crate::syntax::SyntaxKind;

impl Parser<'_> {
    /// `{ a; b, c; … }`
    pub(super) fn block(&mut self) {
        let node = self.open();
        let brace = self.span_of(self.current);
        self.bump();
        self.nested(|parser| {
            parser.steps();
        });
        self.close_brace(brace);
        self.close(node, SyntaxKind::Block);
    }

    fn close_brace(&mut self, opened: Span) {
        if self.eat(SyntaxKind::RightBrace) {
            return;
        }
        let place = self.previous_end();
        self.report(syntax::unclosed_brace(opened, place));
    }

    /// Steps separated by `;`, with an optional `;` after the last.
    fn steps(&mut self) {
        loop {
            self.stray_separators();
            if self.at_block_end() {
                return;
            }
            self.step();
            if self.eat(SyntaxKind::Semicolon) {
                continue;
            }
            if self.at_block_end() {
                return;
            }
            self.between_statements("`;` or `,`", ";");
        }
    }

    fn at_block_end(&mut self) -> bool {
        matches!(self.kind, SyntaxKind::RightBrace | SyntaxKind::End) || self.at_declaration_at_line_start()
    }

    /// Reports `;` and `,` where a statement should begin, and accepts them.
    fn stray_separators(&mut self) {
        while matches!(self.kind, SyntaxKind::Semicolon | SyntaxKind::Comma) {
            let diagnostic = if self.at(SyntaxKind::Semicolon) {
                syntax::empty_statement(self.here())
            } else {
                syntax::expected("a statement", self.found(), self.here())
            };
            self.report(diagnostic);
            self.bump();
            self.hush();
        }
    }

    /// After a statement that no separator follows: reports, and continues where the next one can begin.
    fn between_statements(&mut self, wanted: &str, insertion: &str) {
        if self.at_statement_start() {
            self.report_missing(wanted, insertion);
            return;
        }
        self.report_expected(wanted);
        self.skip_until(Self::at_statement_end);
        self.eat(SyntaxKind::Semicolon);
        self.hush();
    }

    /// Statements separated by `,`, which bind tighter than `;`.
    fn step(&mut self) {
        let mark = self.next_mark();
        self.statement();
        if !self.at(SyntaxKind::Comma) {
            return;
        }
        let node = self.open_around(mark);
        while self.eat(SyntaxKind::Comma) {
            if self.at(SyntaxKind::Comma) || self.at(SyntaxKind::Semicolon) || self.at_block_end() {
                self.report_expected("a statement after `,`");
                continue;
            }
            self.statement();
        }
        self.close(node, SyntaxKind::Parallel);
    }

    /// A core statement, the bounds after it and the name of what it is.
    pub(super) fn statement(&mut self) {
        let node = self.open();
        self.core();
        self.bounds_if_any();
        self.naming_if_any();
        self.close(node, SyntaxKind::Statement);
    }

    fn core(&mut self) {
        let is_repeat = self.at_repeat();
        let is_free = self.at_prefix("free");
        let is_optional = self.at_prefix("optional");
        let is_unordered = self.at_word("unordered") && self.peek() == SyntaxKind::LeftBrace;
        let is_constrain = self.at_constrain();
        let is_members = self.at_members();
        match self.kind {
            SyntaxKind::LeftBrace => self.block(),
            SyntaxKind::ChooseKeyword => self.choose(),
            SyntaxKind::DoKeyword => self.do_statement(),
            SyntaxKind::IfKeyword => self.if_statement(),
            SyntaxKind::DelayKeyword => {
                let node = self.open();
                self.bump();
                self.close(node, SyntaxKind::Delay);
            }
            SyntaxKind::Name if is_constrain => self.constrain_in_block(),
            SyntaxKind::Name if is_members => self.members(),
            SyntaxKind::Name if is_repeat => self.repeat(),
            SyntaxKind::Name if is_free => self.prefixed(SyntaxKind::Free),
            SyntaxKind::Name if is_optional => self.prefixed(SyntaxKind::Optional),
            SyntaxKind::Name if is_unordered => self.unordered(),
            SyntaxKind::Name => self.call_or_assertion(),
            SyntaxKind::NotKeyword
            | SyntaxKind::Bang
            | SyntaxKind::LeftParen
            | SyntaxKind::TellKeyword
            | SyntaxKind::AskKeyword => self.assertion(),
            _ => {
                self.report_expected("a statement");
                if !self.at_statement_end() {
                    self.skip_until(|parser| {
                        parser.at_statement_end()
                            || matches!(parser.kind, SyntaxKind::LeftBrace | SyntaxKind::LeftBracket)
                            || parser.at_statement_start()
                    });
                }
            }
        }
    }

    fn choose(&mut self) {
        let node = self.open();
        self.bump();
        if self.at(SyntaxKind::LeftBrace) {
            let brace = self.span_of(self.current);
            self.bump();
            self.nested(Self::alternatives);
            self.close_brace(brace);
        } else {
            self.report_missing("`{`", " {");
        }
        self.close(node, SyntaxKind::Choose);
    }

    fn alternatives(&mut self) {
        if self.at_block_end() {
            let diagnostic = syntax::empty_choice(self.here());
            self.report(diagnostic);
            return;
        }
        loop {
            self.alternative();
            if self.eat(SyntaxKind::Comma) {
                if self.at_block_end() {
                    self.report_expected("another alternative after `,`");
                    return;
                }
                continue;
            }
            if self.at_block_end() {
                return;
            }
            self.between_statements("`,` between the alternatives", ",");
            if self.at_block_end() {
                return;
            }
            self.eat(SyntaxKind::Comma);
        }
    }

    /// Statements separated by `;`, with an optional `;` after the last.
    fn alternative(&mut self) {
        let node = self.open();
        loop {
            while self.at(SyntaxKind::Semicolon) {
                let diagnostic = syntax::empty_statement(self.here());
                self.report(diagnostic);
                self.bump();
                self.hush();
            }
            self.statement();
            if !self.eat(SyntaxKind::Semicolon) || self.at(SyntaxKind::Comma) || self.at_block_end() {
                break;
            }
        }
        self.close(node, SyntaxKind::Alternative);
    }

    fn do_statement(&mut self) {
        let node = self.open();
        self.bump();
        self.nested(Self::statement);
        if matches!(self.kind, SyntaxKind::MaintainingKeyword | SyntaxKind::WatchingKeyword) {
            self.bump();
            self.condition();
        } else if self.at_word("using") {
            self.using();
        } else {
            self.report_expected_keyword("`maintaining` or `watching`, or `using` with a resource", None);
        }
        self.close(node, SyntaxKind::Do);
    }

    /// `using NAME amount`
    fn using(&mut self) {
        self.bump();
        self.resource_name();
        let is_amount = match self.kind {
            SyntaxKind::Name => {
                let next = self.peek();
                let is_call = matches!(next, SyntaxKind::LeftParen | SyntaxKind::Dot);
                let is_condition =
                    matches!(next, SyntaxKind::Equals | SyntaxKind::NotEquals | SyntaxKind::Order);
                let is_outer_using = self.at_word("using") && next == SyntaxKind::Name;
                let is_else = self.at_word("else");
                let is_bounds = self.at_word(CONTINGENT) && next == SyntaxKind::LeftBracket;
                let is_naming = self.is_naming(self.current);
                let is_other = is_call || is_condition || is_outer_using || is_else || is_bounds || is_naming;
                !is_other && !self.at_declaration_at_line_start()
            }
            SyntaxKind::Minus => true,
            _ => self.at_operand(),
        };
        if is_amount {
            self.sum();
        }
        if self.at_per() {
            let unit = self.index_after(self.current);
            let span = self.here().cover(self.span_of(unit));
            self.report(syntax::using_per(span));
            let node = self.open();
            self.bump();
            self.bump();
            self.close(node, SyntaxKind::Skipped);
        }
    }

    fn if_statement(&mut self) {
        let node = self.open();
        self.bump();
        self.condition();
        if !self.eat(SyntaxKind::ThennextKeyword) {
            self.report_expected_keyword("`thennext`", Some("thennext "));
        }
        if self.at_statement_end() {
            self.report_expected("a statement after `thennext`");
        } else {
            self.nested(Self::statement);
            if self.eat_word("else") {
                self.nested(Self::statement);
            }
        }
        self.close(node, SyntaxKind::If);
    }

    fn report_expected_keyword(&mut self, wanted: &str, insertion: Option<&str>) {
        let mut diagnostic = syntax::expected(wanted, self.found(), self.here());
        if let Some(insertion) = insertion.filter(|_| self.at_statement_start()) {
            let place = self.start_of(self.current);
            diagnostic = diagnostic.with_fix(super::insertion(format!("Insert {wanted}"), place, insertion));
        }
        self.report(diagnostic);
    }

    fn call_or_assertion(&mut self) {
        self.join_index_before_dot(self.current);
        match self.peek() {
            SyntaxKind::LeftParen => {
                let node = self.open();
                self.bump();
                self.arguments();
                self.close(node, SyntaxKind::Call);
            }
            SyntaxKind::Equals | SyntaxKind::NotEquals | SyntaxKind::Order | SyntaxKind::Dot => {
                self.assertion();
            }
            _ if self.at_joined_literal() => self.assertion(),
            _ => {
                let node = self.open();
                self.bump();
                self.close(node, SyntaxKind::BareName);
            }
        }
    }

    pub(super) fn arguments(&mut self) {
        let node = self.open();
        self.bump();
        while !self.at(SyntaxKind::RightParen) {
            self.argument();
            if self.eat(SyntaxKind::Comma) {
                if self.at(SyntaxKind::RightParen) {
                    self.report_expected("an argument after `,`");
                }
                continue;
            }
            if matches!(self.kind, SyntaxKind::Name | SyntaxKind::Number | SyntaxKind::Minus)
                && !self.at_declaration_at_line_start()
                && self.reported_at != Some(self.current)
            {
                self.report_missing("`,`", ",");
                continue;
            }
            break;
        }
        if !self.at(SyntaxKind::RightParen) && self.reported_at == Some(self.current) {
            self.skip_until(|parser| {
                matches!(
                    parser.kind,
                    SyntaxKind::RightParen | SyntaxKind::LeftBracket | SyntaxKind::LeftBrace
                ) || (parser.at_statement_end() && !parser.at(SyntaxKind::Comma))
            });
        }
        self.expect_behind(SyntaxKind::RightParen, ")");
        self.close(node, SyntaxKind::Arguments);
    }

    /// Returns whether `repeat N {` begins here; otherwise the word is a name like any other.
    fn at_repeat(&mut self) -> bool {
        if !self.at_word("repeat") {
            return false;
        }
        match self.peek() {
            SyntaxKind::Number => true,
            SyntaxKind::Name => {
                let next = self.index_after(self.current);
                !self.at_joined_literal() && !self.is_naming(next)
            }
            SyntaxKind::LeftParen => {
                let next = self.index_after(self.current);
                let after = self.index_after_group(next, SyntaxKind::LeftParen, SyntaxKind::RightParen);
                self.kind_at(after) == SyntaxKind::LeftBrace
            }
            _ => false,
        }
    }

    fn repeat(&mut self) {
        let node = self.open();
        self.bump();
        self.sum();
        if self.at(SyntaxKind::LeftBrace) {
            self.block();
        } else {
            self.report_missing("`{`", " {");
        }
        self.close(node, SyntaxKind::Repeat);
    }

    /// Returns whether `word` is before a statement; otherwise it is a name like any other.
    fn at_prefix(&mut self, word: &str) -> bool {
        self.at_word(word)
            && match self.peek() {
                SyntaxKind::Name => !self.at_joint(),
                kind => begins_only_statements(kind),
            }
    }

    /// `free A` or `optional A`; bounds after it bind to A.
    fn prefixed(&mut self, kind: SyntaxKind) {
        let node = self.open();
        self.bump();
        self.nested(Self::statement);
        self.close(node, kind);
    }

    /// `unordered { A; B }`
    fn unordered(&mut self) {
        let node = self.open();
        self.bump();
        self.block();
        self.close(node, SyntaxKind::Unordered);
    }

    fn argument(&mut self) {
        let node = self.open();
        self.join_index(self.current);
        let (first, next) = (self.current, self.peek());
        let is_operator = matches!(
            next,
            SyntaxKind::Plus | SyntaxKind::Minus | SyntaxKind::Star | SyntaxKind::Slash | SyntaxKind::Percent
        );
        let is_membership = self.at_membership();
        let is_equipment = self.at_equipment();
        let is_plain_number = !is_operator && !self.at_quantity();
        match self.kind {
            SyntaxKind::Number if is_plain_number => self.bump(),
            SyntaxKind::Name if is_equipment => self.dotted_name(None),
            SyntaxKind::Name
                if matches!(next, SyntaxKind::Equals | SyntaxKind::NotEquals | SyntaxKind::Dot) =>
            {
                self.literal();
            }
            SyntaxKind::Name if is_membership => self.literal(),
            SyntaxKind::Name if !is_operator => self.bump(),
            SyntaxKind::Number | SyntaxKind::Name | SyntaxKind::LeftParen => self.sum(),
            SyntaxKind::NotKeyword | SyntaxKind::Bang => self.literal(),
            SyntaxKind::Minus => {
                self.bump();
                if !self.eat(SyntaxKind::Number) {
                    self.report_expected("a number");
                }
            }
            _ => self.report_expected("a name or a number"),
        }
        let order = (first..=self.current).find(|&index| self.kind_at(index) == SyntaxKind::Order);
        let is_joined = self.at_word("and") || self.at_word("or");
        if order.is_some() || is_joined {
            let diagnostic = match order {
                Some(order) => syntax::level_as_argument(self.span_of(order)),
                None => syntax::joined_argument(self.here()),
            };
            self.report(diagnostic);
            self.skip_until(|parser| {
                matches!(parser.kind, SyntaxKind::Comma | SyntaxKind::RightParen) || parser.at_statement_end()
            });
        }
        self.close(node, SyntaxKind::Argument);
    }

    fn assertion(&mut self) {
        let node = self.open();
        if matches!(self.kind, SyntaxKind::TellKeyword | SyntaxKind::AskKeyword) {
            self.bump();
        }
        self.condition();
        self.close(node, SyntaxKind::Assertion);
    }
}
