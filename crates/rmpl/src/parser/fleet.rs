//! Vehicle models, fleets, groups, and statements for their members (SPEC 17).
//!
//! `model`, `group`, `any` and `each` are words of the language only where their forms begin.

use super::Parser;
use crate::diagnostics::syntax;
use crate::syntax::SyntaxKind;

/// The words that begin properties of models.
pub(crate) const PROPERTY_WORDS: [&str; 7] =
    ["body", "speed", "slope", "clearance", "turning", "mast", "flies"];

impl Parser<'_> {
    /// Returns whether `model NAME {` or `model NAME extends` begins here.
    pub(super) fn at_model(&mut self) -> bool {
        if !self.at_word("model") || self.peek() != SyntaxKind::Name {
            return false;
        }
        let name = self.index_after(self.current);
        let next = self.index_after(name);
        self.kind_at(next) == SyntaxKind::LeftBrace
            || (self.kind_at(next) == SyntaxKind::Name && self.text_of(next) == "extends")
    }

    /// Returns whether `group NAME =` begins here.
    pub(super) fn at_group_declaration(&mut self) -> bool {
        if !self.at_word("group") || self.peek() != SyntaxKind::Name {
            return false;
        }
        let name = self.index_after(self.current);
        let next = self.index_after(name);
        self.kind_at(next) == SyntaxKind::Equals
    }

    /// `model NAME extends PARENT { … }`
    pub(super) fn model(&mut self) {
        let node = self.open();
        self.bump();
        self.declared_name("the name of the model");
        if self.at_word("extends") {
            let parent = self.open();
            self.bump();
            self.declared_name("the name of the extended model");
            self.close(parent, SyntaxKind::Extends);
        }
        if self.at(SyntaxKind::LeftBrace) {
            let brace = self.span_of(self.current);
            self.bump();
            self.model_parts();
            if !self.eat(SyntaxKind::RightBrace) {
                let place = self.previous_end();
                self.report(syntax::unclosed_brace(brace, place));
            }
            self.eat(SyntaxKind::Semicolon);
        } else {
            self.report_missing("`{`", " {");
        }
        self.close(node, SyntaxKind::ModelDecl);
    }

    fn model_parts(&mut self) {
        while !matches!(self.kind, SyntaxKind::RightBrace | SyntaxKind::End) {
            if self.at_lasting_declaration() && !self.at_word("objective") {
                self.equipment();
            } else if self.at_declaration_at_line_start() {
                return;
            } else if self.at(SyntaxKind::Name) && PROPERTY_WORDS.contains(&self.current_text()) {
                self.property();
            } else {
                self.report_expected(
                    "`body`, `speed`, `slope`, `clearance`, `turning`, `mast`, `flies`, `resource` or `state`",
                );
                self.skip_in_model();
                self.eat(SyntaxKind::Semicolon);
                self.hush();
            }
        }
    }

    fn skip_in_model(&mut self) {
        self.skip_until(|parser| {
            matches!(parser.kind, SyntaxKind::Semicolon | SyntaxKind::RightBrace)
                || parser.at_declaration_at_line_start()
        });
    }

    /// The `;` after a part of a model.
    fn end_part(&mut self) {
        if self.eat(SyntaxKind::Semicolon) {
            return;
        }
        if self.reported_at != Some(self.current) {
            self.report_missing("`;`", ";");
        }
        if !self.at(SyntaxKind::Name) {
            self.skip_in_model();
            self.eat(SyntaxKind::Semicolon);
        }
    }

    /// A resource or a state that each vehicle of the model has.
    fn equipment(&mut self) {
        let node = self.open();
        let is_state = self.at_word("state");
        self.bump();
        let kind = if is_state { self.state() } else { self.resource() };
        if self.reported_at == Some(self.current) {
            self.skip_in_model();
        }
        self.end_part();
        self.close(node, kind);
    }

    /// `body 0.8 x 0.6`, `speed (0.01, 0.8)`, `slope 20 degrees`
    fn property(&mut self) {
        let node = self.open();
        let word = self.current_text();
        self.bump();
        match word {
            "speed" => self.pair("2 speeds: minimum and maximum", &["m/s", "km/h"]),
            "flies" => self.pair("2 altitudes: minimum and maximum", &LENGTH_UNITS),
            "slope" => self.quantity_of("an angle", &["degrees", "deg", "rad"]),
            "body" => {
                self.quantity_of("the length of the body", &LENGTH_UNITS);
                if self.eat_word("x") {
                    self.quantity_of("the width of the body", &LENGTH_UNITS);
                } else {
                    self.report_expected("`x` and the width");
                }
            }
            _ => self.quantity_of("a length", &LENGTH_UNITS),
        }
        self.close(node, SyntaxKind::Property);
        if self.reported_at == Some(self.current) {
            self.skip_in_model();
        }
        self.end_part();
    }

    /// `(a, b)`
    fn pair(&mut self, wanted: &str, units: &[&str]) {
        if !self.at(SyntaxKind::LeftParen) {
            self.report_expected(&format!("`(` and {wanted}"));
            return;
        }
        self.bump();
        self.quantity_of(wanted, units);
        if self.eat(SyntaxKind::Comma) {
            self.quantity_of("the maximum", units);
        } else {
            self.report_expected("`,` and the maximum");
        }
        if self.reported_at != Some(self.current) {
            self.expect_behind(SyntaxKind::RightParen, ")");
        }
    }

    /// A number, perhaps with one of these units.
    fn quantity_of(&mut self, wanted: &str, units: &[&str]) {
        let node = self.open();
        self.eat(SyntaxKind::Minus);
        if self.eat(SyntaxKind::Number) {
            // `x` of a body and the words of properties are not units.
            if self.at(SyntaxKind::Name) && !self.at_word("x") {
                self.unit(units);
            }
        } else {
            self.report_expected(wanted);
        }
        self.close(node, SyntaxKind::Quantity);
    }

    /// `m`, `degrees` or `km/h`
    fn unit(&mut self, units: &[&str]) {
        let first = self.current_text();
        let has_slash = self.peek() == SyntaxKind::Slash;
        let is_unit = |unit: &&str| match unit.split_once('/') {
            Some((above, _)) => has_slash && above == first,
            None => !has_slash && *unit == first,
        };
        let Some(unit) = units.iter().find(|unit| is_unit(unit)) else {
            // A missing semicolon is reported where the property ends.
            if !PROPERTY_WORDS.contains(&first) && !matches!(first, "resource" | "state") {
                let listed: Vec<String> = units.iter().map(|unit| format!("`{unit}`")).collect();
                self.report_expected(&format!("a unit ({})", listed.join(", ")));
            }
            return;
        };
        self.bump();
        if let Some((_, below)) = unit.split_once('/') {
            self.bump();
            if !self.eat_word(below) {
                self.report_expected(&format!("`{below}`"));
            }
        }
    }

    /// `group NAME = MEMBER, MEMBER;`
    pub(super) fn group(&mut self) {
        let node = self.open();
        self.bump();
        self.declared_name("the name of the group");
        if self.expect(SyntaxKind::Equals) {
            self.member_name("a vehicle, a fleet, a location, a value or a group");
            while self.eat(SyntaxKind::Comma) {
                self.member_name("another member");
            }
        }
        self.end_declaration();
        self.close(node, SyntaxKind::GroupDecl);
    }

    /// `[1..4]` after the name of a fleet, which is being declared.
    pub(super) fn fleet_range_if_any(&mut self) {
        if !self.at(SyntaxKind::LeftBracket) {
            return;
        }
        let node = self.open();
        self.bump();
        self.integer("the number of the first vehicle");
        if self.eat(SyntaxKind::DotDot) {
            self.integer("the number of the last vehicle");
        } else {
            self.report_expected("`..` and the number of the last vehicle");
        }
        if self.reported_at == Some(self.current) {
            self.skip_in_header(SyntaxKind::RightBracket);
        }
        self.expect_behind(SyntaxKind::RightBracket, "]");
        self.close(node, SyntaxKind::FleetRange);
    }

    fn integer(&mut self, wanted: &str) {
        let is_integer = self.at(SyntaxKind::Number) && is_index(self.current_text());
        if is_integer {
            self.bump();
        } else {
            self.report_expected(wanted);
        }
    }

    /// A name that something else declares; of a fleet's vehicle with its index.
    pub(super) fn member_name(&mut self, wanted: &str) {
        self.join_index(self.current);
        self.declared_name(wanted);
    }

    /// Makes one name of `S[3]`, whose index stands directly behind the name at `index`: the name of a fleet's vehicle.
    pub(super) fn join_index(&mut self, index: u32) {
        if self.is_indexed(index) {
            let end = self.tokens[index as usize + 3].end;
            self.tokens[index as usize].end = end;
            self.tokens.drain(index as usize + 1..=index as usize + 3);
        }
    }

    /// The same if a dot follows: `S[3].at`. Elsewhere in statements, brackets are bounds.
    pub(super) fn join_index_before_dot(&mut self, index: u32) {
        if self.is_indexed(index)
            && self.next_significant(index + 4) == index + 4
            && self.kind_at(index + 4) == SyntaxKind::Dot
        {
            self.join_index(index);
        }
    }

    fn is_indexed(&mut self, index: u32) -> bool {
        let kinds = [SyntaxKind::LeftBracket, SyntaxKind::Number, SyntaxKind::RightBracket];
        self.kind_at(index) == SyntaxKind::Name
            && kinds
                .iter()
                .zip(index + 1..)
                .all(|(&kind, at)| self.next_significant(at) == at && self.kind_at(at) == kind)
            && is_index(self.text_of(index + 2))
    }

    /// Returns whether `R1.battery` stands here as a whole argument: a resource or a state that is handed on.
    pub(super) fn at_equipment(&mut self) -> bool {
        if !self.at(SyntaxKind::Name) || self.peek() != SyntaxKind::Dot {
            return false;
        }
        let dot = self.index_after(self.current);
        let part = self.index_after(dot);
        let next = self.index_after(part);
        self.kind_at(part) == SyntaxKind::Name
            && !matches!(self.text_of(part), "at" | "mode")
            && matches!(self.kind_at(next), SyntaxKind::Comma | SyntaxKind::RightParen)
    }

    /// Returns whether `any NAME in` or `each NAME in` begins here.
    pub(super) fn at_members(&mut self) -> bool {
        if !(self.at_word("any") || self.at_word("each")) || self.peek() != SyntaxKind::Name {
            return false;
        }
        let name = self.index_after(self.current);
        let next = self.index_after(name);
        self.kind_at(next) == SyntaxKind::Name && self.text_of(next) == "in"
    }

    /// `any r in G unit` or `each r in G in sequence unit`; bounds after it bind to the unit.
    pub(super) fn members(&mut self) {
        let node = self.open();
        let is_each = self.at_word("each");
        self.bump();
        self.bump();
        self.bump();
        self.declared_name("the name of a group or a fleet");
        if is_each && self.at_word("in") {
            self.bump();
            if !self.eat_word("sequence") {
                self.report_expected("`sequence`");
            }
        } else if is_each && self.at_word("unordered") {
            self.bump();
        }
        if self.at_statement_end() {
            self.report_expected("a statement for each member");
        } else {
            self.nested(Self::statement);
        }
        self.close(node, SyntaxKind::Members);
    }
}

const LENGTH_UNITS: [&str; 4] = ["m", "cm", "mm", "km"];

/// Returns whether a number is one of a fleet's: whole, without a sign, and written as the name of the vehicle is.
fn is_index(text: &str) -> bool {
    text.bytes().all(|byte| byte.is_ascii_digit())
        && text.len() < 10
        && (text == "0" || !text.starts_with('0'))
}
