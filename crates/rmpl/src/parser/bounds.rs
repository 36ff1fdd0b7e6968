//! Bounds and the expressions in them, with their arithmetic (SPEC 1.2, 1.5) and units of time (SPEC 14).

use super::{MAX_OPERANDS, Mark, Parser};
use crate::diagnostics::syntax;
use crate::program::DurationUnit;
use crate::span::Span;
use crate::syntax::SyntaxKind;

/// The word before the bounds of what the environment chooses (SPEC 13.1).
pub(crate) const CONTINGENT: &str = "contingent";

impl Parser<'_> {
    /// `[lower, upper]` or `contingent [lower, upper]`, if one of them stands here.
    pub(super) fn bounds_if_any(&mut self) {
        if self.at(SyntaxKind::LeftBracket) || self.at_contingent() {
            self.bounds(Self::sum);
        }
    }

    /// The bounds of a `constrain`, whose sides may be negative.
    pub(super) fn bounds_between_events(&mut self) {
        self.bounds(Self::signed_sum);
    }

    /// Returns whether bounds begin with their word, which is a name like any other elsewhere. Where its brackets are
    /// still to be written, nothing else could continue here.
    pub(super) fn at_contingent(&mut self) -> bool {
        self.at_word(CONTINGENT)
            && matches!(
                self.peek(),
                SyntaxKind::LeftBracket
                    | SyntaxKind::Comma
                    | SyntaxKind::Semicolon
                    | SyntaxKind::RightBrace
                    | SyntaxKind::MaintainingKeyword
                    | SyntaxKind::WatchingKeyword
                    | SyntaxKind::End
            )
    }

    fn bounds(&mut self, side: impl Fn(&mut Self)) {
        let node = self.open();
        self.eat_word(CONTINGENT);
        if !self.at(SyntaxKind::LeftBracket) {
            self.report_expected("`[` and the minimum and maximum of the uncontrolled duration");
            self.close(node, SyntaxKind::Bounds);
            return;
        }
        let bracket = self.span_of(self.current);
        self.bump();
        side(self);
        if self.eat(SyntaxKind::Comma) {
            side(self);
        } else if self.at(SyntaxKind::RightBracket) {
            let diagnostic = syntax::one_bound(self.here());
            self.report(diagnostic);
        } else if self.at_operand() {
            self.report_missing("`,` between the bounds", ",");
            side(self);
        } else {
            self.missing_bracket(bracket);
        }
        if !self.at(SyntaxKind::RightBracket) {
            self.missing_bracket(bracket);
        }
        self.eat(SyntaxKind::RightBracket);
        self.close(node, SyntaxKind::Bounds);
    }

    fn missing_bracket(&mut self, opened: Span) {
        let ends_statement = matches!(
            self.kind,
            SyntaxKind::Semicolon
                | SyntaxKind::LeftBrace
                | SyntaxKind::RightBrace
                | SyntaxKind::Equals
                | SyntaxKind::End
                | SyntaxKind::MaintainingKeyword
                | SyntaxKind::WatchingKeyword
        );
        if ends_statement || self.at_declaration_at_line_start() {
            let diagnostic = syntax::unclosed_bracket(opened, self.previous_end());
            self.report(diagnostic);
        } else {
            self.report_expected("`]`");
        }
        self.skip_until(|parser| {
            matches!(
                parser.kind,
                SyntaxKind::RightBracket
                    | SyntaxKind::Semicolon
                    | SyntaxKind::LeftBrace
                    | SyntaxKind::RightBrace
                    | SyntaxKind::Equals
                    | SyntaxKind::MaintainingKeyword
                    | SyntaxKind::WatchingKeyword
            ) || parser.at_declaration_at_line_start()
        });
        self.hush();
    }

    pub(super) fn at_operand(&self) -> bool {
        matches!(
            self.kind,
            SyntaxKind::Number | SyntaxKind::Infinity | SyntaxKind::Name | SyntaxKind::LeftParen
        )
    }

    pub(super) fn sum(&mut self) {
        let mark = self.next_mark();
        self.product();
        self.chain(mark, SyntaxKind::Sum, [SyntaxKind::Plus, SyntaxKind::Minus], Self::product);
    }

    /// A sum that may begin with a minus.
    fn signed_sum(&mut self) {
        let mark = self.next_mark();
        if self.at(SyntaxKind::Minus) {
            let node = self.open();
            self.bump();
            self.product();
            self.close(node, SyntaxKind::Negation);
        } else {
            self.product();
        }
        self.chain(mark, SyntaxKind::Sum, [SyntaxKind::Plus, SyntaxKind::Minus], Self::product);
    }

    fn product(&mut self) {
        let mark = self.next_mark();
        self.percent();
        self.chain(mark, SyntaxKind::Product, [SyntaxKind::Star, SyntaxKind::Slash], Self::percent);
    }

    /// Further operands after the one at `mark`, in one node.
    fn chain(
        &mut self,
        mark: Mark,
        kind: SyntaxKind,
        operators: [SyntaxKind; 2],
        operand: impl Fn(&mut Self),
    ) {
        if !operators.contains(&self.kind) {
            return;
        }
        let node = self.open_around(mark);
        let mut operands = 1;
        while operators.contains(&self.kind) {
            operands += 1;
            if operands == MAX_OPERANDS {
                let diagnostic = syntax::too_deep(self.here());
                self.report(diagnostic);
                self.skip_until(|parser| {
                    matches!(parser.kind, SyntaxKind::RightBracket | SyntaxKind::Comma)
                        || parser.at_statement_end()
                });
                break;
            }
            // An operator without operands is one mistake, however many follow it.
            let is_reported = self.reported_at == Some(self.current);
            self.bump();
            if is_reported {
                self.hush();
            }
            operand(self);
        }
        self.close(node, kind);
    }

    fn percent(&mut self) {
        let mark = self.next_mark();
        self.operand();
        if self.at(SyntaxKind::Percent) {
            let node = self.open_around(mark);
            self.bump();
            self.close(node, SyntaxKind::PercentOf);
        }
    }

    /// A number with the unit that is written right after it, if one is: `90s`, `1.5h`.
    pub(super) fn quantity(&mut self) {
        let has_unit = self.at_quantity();
        self.bump();
        if has_unit {
            self.bump();
        }
    }

    /// Returns whether a number stands here with a unit of time right after it.
    pub(super) fn at_quantity(&mut self) -> bool {
        let next = self.index_after(self.current);
        self.at(SyntaxKind::Number)
            && next == self.current + 1
            && self.kind_at(next) == SyntaxKind::Name
            && DurationUnit::by_name(self.text_of(next)).is_some()
    }

    fn operand(&mut self) {
        match self.kind {
            SyntaxKind::Number => {
                let node = self.open();
                self.quantity();
                self.close(node, SyntaxKind::Operand);
            }
            SyntaxKind::Infinity | SyntaxKind::Name => {
                let node = self.open();
                self.bump();
                self.close(node, SyntaxKind::Operand);
            }
            SyntaxKind::LeftParen => {
                let node = self.open();
                self.bump();
                self.nested(Self::sum);
                self.expect_behind(SyntaxKind::RightParen, ")");
                self.close(node, SyntaxKind::Grouped);
            }
            SyntaxKind::Minus => {
                let diagnostic = syntax::negative_bound(self.here());
                self.report(diagnostic);
                self.bump();
                self.hush();
                if self.at_operand() {
                    self.operand();
                }
            }
            _ => self.report_expected("a bound: a number, `inf` or a name"),
        }
    }
}
