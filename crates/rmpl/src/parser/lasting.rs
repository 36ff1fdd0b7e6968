//! Declarations of what lasts and of what is wanted: states, resources, objectives (SPEC 10, 11, 12).

use super::Parser;
use crate::diagnostics::syntax;
use crate::program::Measure;
use crate::syntax::SyntaxKind;

impl Parser<'_> {
    pub(super) fn lasting_declaration(&mut self) {
        let node = self.open();
        let word = self.current_text();
        self.bump();
        let kind = match word {
            "state" => self.state(),
            "resource" => self.resource(),
            _ => self.objective(),
        };
        self.end_declaration();
        self.close(node, kind);
    }

    /// `state X : {V1, V2} = V1;` or `state C.mode from plant;`
    pub(super) fn state(&mut self) -> SyntaxKind {
        if self.at(SyntaxKind::Name) && self.peek() == SyntaxKind::Dot {
            self.dotted_name(Some("mode"));
            self.source();
            return SyntaxKind::StateDecl;
        }
        self.declared_name("the name of the state");
        if self.expect(SyntaxKind::Colon) || self.at(SyntaxKind::LeftBrace) {
            self.domain();
        }
        if self.at(SyntaxKind::Equals) {
            let node = self.open();
            self.bump();
            self.declared_name("the value at the start");
            self.close(node, SyntaxKind::Initial);
        } else {
            self.report_expected("`=` and the value at the start");
        }
        SyntaxKind::StateDecl
    }

    fn source(&mut self) {
        let node = self.open();
        if self.at_word("from") {
            self.bump();
            if !self.eat_word("plant") {
                self.report_expected("`plant`");
            }
        } else {
            self.report_expected("`from plant`");
        }
        self.close(node, SyntaxKind::FromPlant);
    }

    /// `resource NAME;`, `resource NAME capacity 3;` or `resource NAME 0..100 = 40;`
    pub(super) fn resource(&mut self) -> SyntaxKind {
        self.declared_name("the name of the resource");
        if self.at_capacity() {
            let node = self.open();
            self.bump();
            self.expression("the capacity: a number");
            self.close(node, SyntaxKind::Capacity);
        } else if self.at_operand() || matches!(self.kind, SyntaxKind::DotDot | SyntaxKind::Minus) {
            self.range();
        }
        SyntaxKind::ResourceDecl
    }

    /// Returns whether the capacity follows; a constant of that name may be the minimum level.
    fn at_capacity(&mut self) -> bool {
        self.at_word("capacity")
            && !matches!(
                self.peek(),
                SyntaxKind::DotDot
                    | SyntaxKind::Plus
                    | SyntaxKind::Star
                    | SyntaxKind::Slash
                    | SyntaxKind::Percent
            )
    }

    /// `0..100 = 40`
    fn range(&mut self) {
        let node = self.open();
        self.expression("the minimum level");
        if self.eat(SyntaxKind::DotDot) {
            self.expression("the maximum level");
            if self.eat(SyntaxKind::Equals) {
                self.expression("the level at the start");
            } else {
                self.report_expected("`=` and the level at the start");
            }
        } else {
            self.report_expected("`..` and the maximum level, or `capacity` before the number");
        }
        self.close(node, SyntaxKind::Range);
    }

    /// A sum, or a report that `wanted` is missing.
    fn expression(&mut self, wanted: &str) {
        if self.at_operand() || self.at(SyntaxKind::Minus) {
            self.sum();
        } else {
            self.report_expected(wanted);
        }
    }

    /// `objective minimize cost, maximize reward;`
    fn objective(&mut self) -> SyntaxKind {
        loop {
            self.goal();
            if self.reported_at == Some(self.current) {
                self.skip_until(|parser| {
                    matches!(parser.kind, SyntaxKind::Comma | SyntaxKind::Semicolon)
                        || parser.at_declaration_at_line_start()
                });
            }
            if self.eat(SyntaxKind::Comma) {
                continue;
            }
            let is_goal = self.at_word("minimize") || self.at_word("maximize");
            if !is_goal || self.reported_at == Some(self.current) {
                return SyntaxKind::ObjectiveDecl;
            }
            self.report_missing("`,`", ",");
        }
    }

    /// `minimize 2 * cost + end`
    fn goal(&mut self) {
        let node = self.open();
        if self.eat_word("minimize") || self.eat_word("maximize") {
            if matches!(self.kind, SyntaxKind::Plus | SyntaxKind::Minus) {
                self.bump();
            }
            self.term();
            while matches!(self.kind, SyntaxKind::Plus | SyntaxKind::Minus) {
                self.bump();
                self.term();
            }
        } else {
            self.report_expected("`minimize` or `maximize`");
        }
        self.close(node, SyntaxKind::Goal);
    }

    /// `2 * cost`
    fn term(&mut self) {
        if self.eat(SyntaxKind::Number) && !self.eat(SyntaxKind::Star) {
            if self.at(SyntaxKind::Name) {
                self.report_missing("`*`", " *");
            } else {
                self.report_expected("`*` and the measure");
                return;
            }
        }
        if !self.at(SyntaxKind::Name) {
            self.report_expected("`cost`, `reward`, `end` or `length`");
        } else if Measure::by_name(self.current_text()).is_some() {
            self.bump();
        } else {
            let diagnostic = syntax::unknown_measure(self.current_text(), self.here());
            self.report(diagnostic);
            self.bump();
            self.hush();
        }
    }
}
