//! Declarations of a mission file (SPEC 1.2, 1.4).

use super::Parser;
use crate::diagnostics::syntax;
use crate::syntax::SyntaxKind;

impl Parser<'_> {
    /// One declaration, or the garbage up to the next one, or the blanks at the end of the text.
    pub(super) fn file_item(&mut self) {
        let root = self.open();
        let kind = self.kind;
        match kind {
            SyntaxKind::End => {}
            SyntaxKind::VarKeyword => self.variable(),
            SyntaxKind::PrimitiveKeyword => self.primitive(),
            SyntaxKind::OptionKeyword => self.option(),
            SyntaxKind::ScenarioKeyword => self.scenario(),
            SyntaxKind::ControlText => self.control(),
            _ if self.at_constant() => self.constant(),
            _ if self.at_constrain() => self.constrain(),
            _ if self.at_import() => self.import(),
            _ if self.at_model() => self.model(),
            _ if self.at_group_declaration() => self.group(),
            _ if self.at_lasting_declaration() => self.lasting_declaration(),
            _ if self.at_world_declaration() => self.world_declaration(),
            _ if self.at_definition(false) => self.activity(),
            _ => self.garbage(),
        }
        self.close(root, SyntaxKind::Root);
    }

    fn garbage(&mut self) {
        let node = self.open();
        let diagnostic = match self.kind {
            SyntaxKind::RightBrace => syntax::unmatched_brace(self.here()),
            SyntaxKind::Semicolon => syntax::stray_semicolon(self.here()),
            _ => syntax::no_declaration(self.found(), self.here()),
        };
        self.report(diagnostic);
        // A lone brace or semicolon is its own mistake; what follows it may be sound.
        if matches!(self.kind, SyntaxKind::Semicolon) {
            self.bump();
        }
        while !self.at(SyntaxKind::End) && !self.at_file_item() {
            self.bump();
        }
        self.close(node, SyntaxKind::Garbage);
    }

    fn control(&mut self) {
        let node = self.open();
        self.bump();
        self.close(node, SyntaxKind::ControlDecl);
    }

    /// `const NAME = expression;`
    fn constant(&mut self) {
        let node = self.open();
        self.bump();
        self.declared_name("the name of the constant");
        if self.expect(SyntaxKind::Equals) {
            self.sum();
        }
        self.end_declaration();
        self.close(node, SyntaxKind::ConstantDecl);
    }

    fn variable(&mut self) {
        let node = self.open();
        self.bump();
        self.declared_name("the name of the variable");
        if self.expect(SyntaxKind::Colon) || self.at(SyntaxKind::LeftBrace) {
            self.domain();
        }
        self.end_declaration();
        self.close(node, SyntaxKind::VariableDecl);
    }

    /// `{V1, V2}`
    pub(super) fn domain(&mut self) {
        let node = self.open();
        if self.expect(SyntaxKind::LeftBrace) {
            self.names_until(SyntaxKind::RightBrace, "a value");
            self.expect_behind(SyntaxKind::RightBrace, "}");
        }
        self.close(node, SyntaxKind::Domain);
    }

    /// Names separated by commas, at least one; stops before `close`.
    pub(super) fn names_until(&mut self, close: SyntaxKind, wanted: &str) {
        self.names_with(close, wanted, |_| {});
    }

    /// `: vehicle` behind a parameter
    fn parameter_kind(&mut self) {
        if !self.at(SyntaxKind::Colon) {
            return;
        }
        let node = self.open();
        self.bump();
        self.declared_name("`vehicle`, `location`, `number`, `resource`, `condition`, a model or a state");
        self.close(node, SyntaxKind::ParameterKind);
    }

    /// The same, with `behind` each name.
    fn names_with(&mut self, close: SyntaxKind, wanted: &str, behind: impl Fn(&mut Self)) {
        loop {
            if !self.eat(SyntaxKind::Name) {
                self.report_expected(wanted);
                if self.at(SyntaxKind::Number)
                    || (self.kind.is_keyword() && !self.at_declaration_at_line_start())
                {
                    self.bump();
                    self.hush();
                }
            }
            behind(self);
            if self.eat(SyntaxKind::Comma) {
                continue;
            }
            if self.at(SyntaxKind::Name) && !self.at_declaration_at_line_start() {
                self.report_missing("`,`", ",");
                continue;
            }
            break;
        }
        if !self.at(close) {
            self.skip_in_header(close);
        }
    }

    /// After a mistake in a header, skips what cannot continue it.
    pub(super) fn skip_in_header(&mut self, close: SyntaxKind) {
        if self.reported_at != Some(self.current) {
            return;
        }
        self.skip_until(|parser| {
            parser.kind == close
                || matches!(
                    parser.kind,
                    SyntaxKind::Semicolon
                        | SyntaxKind::LeftBrace
                        | SyntaxKind::RightBrace
                        | SyntaxKind::Equals
                        | SyntaxKind::LeftBracket
                )
                || parser.at_declaration_at_line_start()
        });
    }

    fn primitive(&mut self) {
        let node = self.open();
        self.bump();
        self.declared_name("the name of the primitive");
        self.formals(true);
        self.bounds_if_any();
        self.clauses();
        if self.at(SyntaxKind::Equals) {
            let diagnostic = syntax::primitive_with_body(self.here());
            self.report(diagnostic);
            self.bump();
            if self.at(SyntaxKind::LeftBrace) {
                self.block();
            }
            self.eat(SyntaxKind::Semicolon);
        } else {
            self.end_declaration();
        }
        self.close(node, SyntaxKind::PrimitiveDecl);
    }

    fn option(&mut self) {
        let node = self.open();
        self.bump();
        self.declared_name("the name of an option");
        if self.expect(SyntaxKind::Equals) && !self.eat(SyntaxKind::Number) && !self.eat(SyntaxKind::Name) {
            self.report_expected("a number or a name");
        }
        self.end_declaration();
        self.close(node, SyntaxKind::OptionDecl);
    }

    fn activity(&mut self) {
        let node = self.open();
        self.bump();
        self.formals(true);
        self.bounds_if_any();
        self.definition_body();
        self.close(node, SyntaxKind::ActivityDecl);
    }

    fn scenario(&mut self) {
        let node = self.open();
        self.bump();
        self.declared_name("the name of the scenario");
        self.formals(false);
        self.bounds_if_any();
        self.definition_body();
        self.close(node, SyntaxKind::ScenarioDecl);
    }

    fn definition_body(&mut self) {
        if !self.eat(SyntaxKind::Equals) {
            self.report_missing("`=`", " =");
            self.skip_until(|parser| {
                matches!(parser.kind, SyntaxKind::LeftBrace | SyntaxKind::Semicolon)
                    || parser.at_declaration_at_line_start()
            });
        }
        if self.at(SyntaxKind::LeftBrace) {
            self.block();
            self.eat(SyntaxKind::Semicolon);
        } else {
            self.report_expected("`{`");
            if self.at_statement_start() && !self.at_declaration_at_line_start() {
                self.hush();
                self.statement();
            }
            self.skip_until(|parser| {
                matches!(parser.kind, SyntaxKind::Semicolon) || parser.at_declaration_at_line_start()
            });
            self.eat(SyntaxKind::Semicolon);
        }
    }

    fn formals(&mut self, required: bool) {
        if !self.at(SyntaxKind::LeftParen) {
            if required {
                self.report_missing("`(`", "()");
            }
            return;
        }
        let node = self.open();
        self.bump();
        if !self.at(SyntaxKind::RightParen) {
            self.names_with(SyntaxKind::RightParen, "the name of a parameter", Self::parameter_kind);
        }
        self.expect_behind(SyntaxKind::RightParen, ")");
        self.close(node, SyntaxKind::Formals);
    }

    /// The name that a declaration introduces or refers to.
    pub(super) fn declared_name(&mut self, wanted: &str) {
        if self.eat(SyntaxKind::Name) {
            return;
        }
        if self.kind.is_keyword() || self.at(SyntaxKind::Infinity) {
            let is_word = self.current_text() != "∞";
            if is_word && !self.at_declaration_at_line_start() {
                let diagnostic = syntax::keyword_as_name(self.current_text(), self.here());
                self.report(diagnostic);
                self.bump();
                return;
            }
        }
        self.report_expected(wanted);
    }

    /// The `;` that ends a declaration; skips what is before it.
    pub(super) fn end_declaration(&mut self) {
        if self.eat(SyntaxKind::Semicolon) {
            return;
        }
        if self.at(SyntaxKind::End) || self.at_file_item() {
            self.report_missing("`;`", ";");
            return;
        }
        self.report_expected("`;`");
        self.skip_until(|parser| parser.at(SyntaxKind::Semicolon) || parser.at_declaration_at_line_start());
        self.eat(SyntaxKind::Semicolon);
    }
}
