//! Names of occurrences, the bounds between their events, and other files of the mission (SPEC 14).

use super::Parser;
use crate::diagnostics::syntax;
use crate::syntax::SyntaxKind;

/// The word before the name of an occurrence.
const AS: &str = "as";

impl Parser<'_> {
    /// Returns whether `as NAME` is at the cursor, where a statement or its bounds end.
    fn at_naming(&mut self) -> bool {
        self.at_word(AS) && self.peek() == SyntaxKind::Name
    }

    /// `as NAME`, if it is after a statement.
    pub(super) fn naming_if_any(&mut self) {
        if !self.at_naming() {
            return;
        }
        let node = self.open();
        self.bump();
        self.bump();
        self.close(node, SyntaxKind::Naming);
    }

    /// Returns whether `as NAME` is after the name at `index`.
    pub(super) fn is_naming(&mut self, index: u32) -> bool {
        if self.text_of(index) != AS {
            return false;
        }
        let name = self.index_after(index);
        self.kind_at(name) == SyntaxKind::Name
    }

    /// Returns whether `constrain NAME` begins here: no definition and no statement begins with two names like that.
    pub(super) fn at_constrain(&mut self) -> bool {
        self.at_word("constrain") && self.peek() == SyntaxKind::Name && !self.at_joint()
    }

    /// Returns whether `import "` begins here.
    pub(super) fn at_import(&mut self) -> bool {
        self.at_word("import") && self.peek() == SyntaxKind::String
    }

    /// `constrain NAME.start to OTHER.end [l,u];`
    pub(super) fn constrain(&mut self) {
        let node = self.open();
        self.bump();
        self.event_name();
        if !self.eat_word("to") {
            self.report_expected("`to` and the other event");
        }
        if self.at(SyntaxKind::Name) {
            self.event_name();
        } else {
            self.report_expected("the name of an occurrence");
        }
        if self.at(SyntaxKind::LeftBracket) || self.at_contingent() {
            self.bounds_between_events();
        } else {
            self.report_expected("`[` and the minimum and maximum time between the two");
        }
        self.end_declaration();
        self.close(node, SyntaxKind::ConstrainDecl);
    }

    /// `NAME.start` or `NAME.end`
    fn event_name(&mut self) {
        let node = self.open();
        let name = self.here();
        self.bump();
        if self.eat(SyntaxKind::Dot) {
            if self.at_word("start") || self.at_word("end") {
                self.bump();
            } else {
                self.report_expected("`start` or `end`");
                if self.at(SyntaxKind::Name) && !self.at_word("to") {
                    self.bump();
                    self.hush();
                }
            }
        } else {
            let diagnostic = syntax::which_event(name);
            self.report(diagnostic);
            self.hush();
        }
        self.close(node, SyntaxKind::EventName);
    }

    /// A `constrain` among statements, which it is none of.
    pub(super) fn constrain_in_block(&mut self) {
        let diagnostic = syntax::constrain_in_block(self.here());
        self.report(diagnostic);
        self.skip_until(|parser| {
            matches!(parser.kind, SyntaxKind::Semicolon | SyntaxKind::RightBrace)
                || parser.at_declaration_at_line_start()
        });
        self.hush();
    }

    /// `import "file";`
    pub(super) fn import(&mut self) {
        let node = self.open();
        self.bump();
        self.bump();
        self.end_declaration();
        self.close(node, SyntaxKind::ImportDecl);
    }
}
