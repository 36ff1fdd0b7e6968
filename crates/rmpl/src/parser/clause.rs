//! What follows a primitive's parameters and bounds: what it moves, runs, requires, sets, takes, gives, costs and
//! is worth, and how it is aborted (SPEC 1.8, 10.1, 11, 12, 15).
//!
//! The words of clauses are words of the language only where a clause can begin; a comma continues with a clause.

use super::Parser;
use crate::diagnostics::syntax;
use crate::program::Per;
use crate::syntax::SyntaxKind;

/// The words that begin clauses.
pub(crate) const CLAUSE_WORDS: [&str; 10] =
    ["requires", "sets", "uses", "consumes", "produces", "costs", "rewards", "moves", "runs", "aborts"];

impl Parser<'_> {
    /// Clauses in any order, up to what is none.
    pub(super) fn clauses(&mut self) {
        loop {
            if self.at(SyntaxKind::Comma) && self.begins_clause_behind() {
                self.comma_before_clause();
            }
            if !self.at(SyntaxKind::Name) || self.at_declaration_at_line_start() {
                return;
            }
            match self.current_text() {
                "requires" => self.requires(),
                "sets" => self.sets(),
                "uses" => self.uses(false),
                "consumes" | "produces" => self.uses(true),
                "costs" => self.single(SyntaxKind::Costs, Self::amount),
                "rewards" => self.single(SyntaxKind::Rewards, Self::number),
                "moves" => self.moves(),
                "runs" => self.runs(),
                "aborts" => self.aborts(),
                _ => return,
            }
        }
    }

    /// A comma, and after it what no list continues with.
    fn comma_before_clause(&mut self) {
        let next = self.index_after(self.current);
        if self.at_start_of_activity(next) {
            let diagnostic = syntax::start_in_list(self.here());
            self.report(diagnostic);
            self.bump();
            self.requires();
        } else {
            let diagnostic = syntax::comma_before_clause(self.here());
            self.report(diagnostic);
            self.bump();
        }
    }

    fn runs(&mut self) {
        let node = self.open();
        self.bump();
        self.declared_name("the name of a control program");
        if self.at(SyntaxKind::LeftParen) {
            let arguments = self.open();
            self.bump();
            if !self.at(SyntaxKind::RightParen) {
                self.names_until(SyntaxKind::RightParen, "an argument: a name of the plant, or a parameter");
            }
            self.expect_behind(SyntaxKind::RightParen, ")");
            self.close(arguments, SyntaxKind::Arguments);
        }
        self.close(node, SyntaxKind::Runs);
    }

    /// `aborts [a,b]`
    fn aborts(&mut self) {
        let node = self.open();
        self.bump();
        if self.at(SyntaxKind::LeftBracket) {
            self.bounds_if_any();
        } else {
            self.report_expected("`[` and the minimum and maximum time that stopping takes");
        }
        self.skip_in_clause();
        self.close(node, SyntaxKind::Aborts);
    }

    /// `requires c, c` or `requires at start c, c`
    fn requires(&mut self) {
        let node = self.open();
        self.eat_word("requires");
        if self.at_start_of_activity(self.current) {
            self.bump();
            self.bump();
        }
        self.items(Self::condition, |_| true);
        self.close(node, SyntaxKind::Requires);
    }

    /// `sets X=V, X=V`
    fn sets(&mut self) {
        let node = self.open();
        self.bump();
        self.items(Self::effect, |parser| matches!(parser.peek(), SyntaxKind::Equals | SyntaxKind::Dot));
        self.close(node, SyntaxKind::Sets);
    }

    /// `uses R, R 2`, `consumes R 2, R 3` or `produces R 2, R 3`
    fn uses(&mut self, needs_amount: bool) {
        let node = self.open();
        self.bump();
        self.items(|parser| parser.resource_use(needs_amount), |_| true);
        self.close(node, SyntaxKind::Uses);
    }

    /// A word and the one thing after it.
    fn single(&mut self, kind: SyntaxKind, item: impl Fn(&mut Self)) {
        let node = self.open();
        self.bump();
        item(self);
        self.skip_in_clause();
        self.close(node, kind);
    }

    /// Items separated by commas, at least one. `goes_on` says whether another one begins where a comma is missing.
    fn items(&mut self, item: impl Fn(&mut Self), goes_on: impl Fn(&mut Self) -> bool) {
        loop {
            item(self);
            self.skip_in_clause();
            if self.at(SyntaxKind::Comma) && !self.begins_clause_behind() {
                self.bump();
            } else if matches!(self.kind, SyntaxKind::Name | SyntaxKind::NotKeyword | SyntaxKind::Bang)
                && self.reported_at != Some(self.current)
                && !CLAUSE_WORDS.contains(&self.current_text())
                && !self.at_file_item()
                && goes_on(self)
            {
                self.report_missing("`,`", ",");
            } else {
                return;
            }
        }
    }

    /// After a mistake in a clause, skips what cannot continue with it.
    fn skip_in_clause(&mut self) {
        if self.reported_at != Some(self.current) {
            return;
        }
        self.skip_until(|parser| {
            matches!(parser.kind, SyntaxKind::Comma | SyntaxKind::Semicolon | SyntaxKind::RightBrace)
                || parser.begins_clause(parser.current)
                || parser.at_declaration_at_line_start()
        });
    }

    /// `X=V`
    fn effect(&mut self) {
        let node = self.open();
        if matches!(self.kind, SyntaxKind::NotKeyword | SyntaxKind::Bang) {
            let diagnostic = syntax::no_single_effect(self.here());
            self.report(diagnostic);
        } else if !self.variable_name() {
            self.report_expected("the name of a state variable");
        } else if self.eat(SyntaxKind::Equals) {
            self.value();
        } else if self.at(SyntaxKind::NotEquals) || self.at_word("in") {
            let diagnostic = syntax::no_single_effect(self.here());
            self.report(diagnostic);
        } else {
            self.report_expected("`=` and the value that the activity sets");
        }
        self.close(node, SyntaxKind::Effect);
    }

    /// `NAME amount`
    fn resource_use(&mut self, needs_amount: bool) {
        let node = self.open();
        self.resource_name();
        if needs_amount || self.at_number() || self.at_per() {
            self.amount();
        }
        self.close(node, SyntaxKind::ResourceUse);
    }

    /// The name of a resource; of a vehicle's own `V.battery`.
    pub(super) fn resource_name(&mut self) {
        self.join_index_before_dot(self.current);
        if self.at(SyntaxKind::Name) && self.peek() == SyntaxKind::Dot {
            self.dotted_name(None);
        } else {
            self.declared_name("the name of a resource");
        }
    }

    /// An expression, perhaps with `per` and a unit.
    fn amount(&mut self) {
        let node = self.open();
        self.number();
        if self.eat_word("per") {
            if self.at(SyntaxKind::Name) && Per::by_name(self.current_text()).is_some() {
                self.bump();
            } else {
                self.report_expected("`second`, `minute`, `hour` or `metre`");
                if self.at(SyntaxKind::Name) && !self.begins_clause(self.current) {
                    self.bump();
                    self.hush();
                }
            }
        }
        self.close(node, SyntaxKind::Amount);
    }

    /// An expression that represents how much.
    fn number(&mut self) {
        if self.at_number() {
            self.sum();
        } else {
            self.report_expected("a number");
        }
    }

    /// Returns whether a number stands here, rather than `per` or another clause.
    fn at_number(&mut self) -> bool {
        match self.kind {
            SyntaxKind::Name => !self.at_per() && !self.begins_clause(self.current),
            SyntaxKind::Minus => true,
            _ => self.at_operand(),
        }
    }

    /// Returns whether `per` and a unit stand here.
    pub(super) fn at_per(&mut self) -> bool {
        let next = self.index_after(self.current);
        self.at_word("per") && Per::by_name(self.text_of(next)).is_some()
    }

    /// Returns whether a clause begins at `index`: what follows its word tells it from a name.
    fn begins_clause(&mut self, index: u32) -> bool {
        if self.kind_at(index) != SyntaxKind::Name {
            return false;
        }
        let word = self.text_of(index);
        let next = self.index_after(index);
        self.join_index_before_dot(next);
        let is_before_name = self.kind_at(next) == SyntaxKind::Name && {
            let unit = self.index_after(next);
            self.text_of(next) != "per" || Per::by_name(self.text_of(unit)).is_none()
        };
        match word {
            "requires" => {
                let begins_condition = matches!(
                    self.kind_at(next),
                    SyntaxKind::NotKeyword | SyntaxKind::Bang | SyntaxKind::LeftParen
                );
                is_before_name || begins_condition
            }
            "costs" | "rewards" => {
                let begins_number = matches!(
                    self.kind_at(next),
                    SyntaxKind::Number | SyntaxKind::Infinity | SyntaxKind::LeftParen
                );
                is_before_name || begins_number
            }
            "sets" => {
                let behind = self.index_after(next);
                let is_effect = matches!(
                    self.kind_at(behind),
                    SyntaxKind::Equals | SyntaxKind::NotEquals | SyntaxKind::Dot
                );
                is_before_name && is_effect
            }
            "aborts" => self.kind_at(next) == SyntaxKind::LeftBracket,
            word => is_before_name && CLAUSE_WORDS.contains(&word),
        }
    }

    /// Returns whether a clause begins after the comma at the cursor.
    fn begins_clause_behind(&mut self) -> bool {
        let next = self.index_after(self.current);
        self.begins_clause(next) || self.at_start_of_activity(next)
    }

    /// Returns whether the words `at start` are at `index`.
    pub(super) fn at_start_of_activity(&mut self, index: u32) -> bool {
        let next = self.index_after(index);
        self.kind_at(index) == SyntaxKind::Name
            && self.text_of(index) == "at"
            && self.kind_at(next) == SyntaxKind::Name
            && self.text_of(next) == "start"
    }
}
