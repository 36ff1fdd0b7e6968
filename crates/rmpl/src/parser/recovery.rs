//! Where the parser continues after a mistake.

use super::{CONTINGENT, Parser};
use crate::syntax::{KEEPOUT, SyntaxKind};

/// How far a header is looked along, so that text without any sense is still read in linear time.
const LONGEST_HEADER_TOKENS: u32 = 256;

impl Parser<'_> {
    /// Accepts tokens into a skipped node until `stop` or the end of the text; groups in brackets are skipped whole.
    pub(super) fn skip_until(&mut self, stop: impl Fn(&mut Self) -> bool) {
        if self.at(SyntaxKind::End) || stop(self) {
            return;
        }
        let node = self.open();
        while !self.at(SyntaxKind::End) && !stop(self) {
            self.skip_group_or_token();
        }
        self.close(node, SyntaxKind::Skipped);
        self.hush();
    }

    /// Accepts one token, or all of a group if it opens one.
    pub(super) fn skip_group_or_token(&mut self) {
        let mut depth = 0_u32;
        loop {
            match self.kind {
                SyntaxKind::LeftBrace | SyntaxKind::LeftParen | SyntaxKind::LeftBracket => depth += 1,
                SyntaxKind::RightBrace | SyntaxKind::RightParen | SyntaxKind::RightBracket => {
                    depth = depth.saturating_sub(1);
                }
                SyntaxKind::End => return,
                _ => {}
            }
            self.bump();
            if depth == 0 || self.at_declaration_at_line_start() {
                return;
            }
        }
    }

    /// Returns whether the current token can begin a statement.
    pub(super) fn at_statement_start(&self) -> bool {
        matches!(self.kind, SyntaxKind::Name | SyntaxKind::LeftParen) || begins_only_statements(self.kind)
    }

    /// Returns whether the current token ends a statement or a group of them.
    pub(super) fn at_statement_end(&mut self) -> bool {
        matches!(
            self.kind,
            SyntaxKind::Semicolon | SyntaxKind::Comma | SyntaxKind::RightBrace | SyntaxKind::End
        ) || self.at_declaration_at_line_start()
    }

    /// Returns whether a declaration certainly begins here: in a block, this means that a brace was left open.
    pub(super) fn at_declaration_at_line_start(&mut self) -> bool {
        match self.kind {
            SyntaxKind::VarKeyword
            | SyntaxKind::PrimitiveKeyword
            | SyntaxKind::ScenarioKeyword
            | SyntaxKind::OptionKeyword => true,
            SyntaxKind::Name => {
                self.begins_line()
                    && (self.at_constant()
                        || self.at_constrain()
                        || self.at_import()
                        || self.at_model()
                        || self.at_group_declaration()
                        || self.at_lasting_declaration()
                        || self.at_world_declaration()
                        || self.at_definition(true))
            }
            _ => false,
        }
    }

    fn begins_line(&self) -> bool {
        let start = self.start_of(self.current) as usize;
        start == 0 || self.text.as_bytes().get(start - 1) == Some(&b'\n')
    }

    /// Returns whether `Name( … ) [ … ] = {` begins here; if not `strict`, a missing `=` or `{` is forgiven.
    pub(super) fn at_definition(&mut self, strict: bool) -> bool {
        if !self.at(SyntaxKind::Name) {
            return false;
        }
        let mut index = self.index_after(self.current);
        let called = self.kind_at(index) == SyntaxKind::LeftParen;
        if called {
            index = self.index_after_group(index, SyntaxKind::LeftParen, SyntaxKind::RightParen);
        }
        if self.kind_at(index) == SyntaxKind::Name && self.text_of(index) == CONTINGENT {
            let bracket = self.index_after(index);
            if self.kind_at(bracket) == SyntaxKind::LeftBracket {
                index = bracket;
            }
        }
        if self.kind_at(index) == SyntaxKind::LeftBracket {
            index = self.index_after_group(index, SyntaxKind::LeftBracket, SyntaxKind::RightBracket);
        }
        match self.kind_at(index) {
            SyntaxKind::Equals => {
                let after = self.index_after(index);
                self.kind_at(after) == SyntaxKind::LeftBrace || (!strict && called)
            }
            SyntaxKind::LeftBrace => !strict && called,
            _ => false,
        }
    }

    /// The index after the flat group that opens at `index`; stops at what no such group contains.
    pub(super) fn index_after_group(&mut self, index: u32, open: SyntaxKind, close: SyntaxKind) -> u32 {
        let mut index = index;
        let mut depth = 0_u32;
        for _ in 0..LONGEST_HEADER_TOKENS {
            let kind = self.kind_at(index);
            if kind == open {
                depth += 1;
            } else if kind == close {
                depth = depth.saturating_sub(1);
            } else if matches!(
                kind,
                SyntaxKind::End | SyntaxKind::Semicolon | SyntaxKind::LeftBrace | SyntaxKind::RightBrace
            ) {
                return index;
            }
            index = self.index_after(index);
            if depth == 0 {
                return index;
            }
        }
        index
    }

    /// Returns whether `const NAME` begins here: no definition begins with two names.
    pub(super) fn at_constant(&mut self) -> bool {
        self.at_word("const") && (self.peek() == SyntaxKind::Name || self.at_definition_of_nothing())
    }

    /// Returns whether a state, a resource or an objective is declared here. No definition begins with two names, but a
    /// statement may: `state and ready`.
    pub(super) fn at_lasting_declaration(&mut self) -> bool {
        self.at(SyntaxKind::Name)
            && matches!(self.current_text(), "state" | "resource" | "objective")
            && self.peek() == SyntaxKind::Name
            && !self.at_joint()
    }

    /// Returns whether a word that continues with the statement is after the name at the cursor.
    pub(super) fn at_joint(&mut self) -> bool {
        let next = self.index_after(self.current);
        if self.kind_at(next) != SyntaxKind::Name {
            return false;
        }
        match self.text_of(next) {
            "and" | "or" | "in" | "else" => true,
            "as" => self.is_naming(next),
            "using" => {
                let resource = self.index_after(next);
                self.kind_at(resource) == SyntaxKind::Name
            }
            _ => false,
        }
    }

    /// Returns whether a world declaration begins here: its first word is a keyword only before what must follow it.
    pub(super) fn at_world_declaration(&mut self) -> bool {
        if !self.at(SyntaxKind::Name) {
            return false;
        }
        match self.current_text() {
            "terrain" => self.peek() == SyntaxKind::String || self.at_definition_of_nothing(),
            "location" | "obstacle" | KEEPOUT | "vehicle" => {
                self.peek() == SyntaxKind::Name || self.at_definition_of_nothing()
            }
            _ => false,
        }
    }

    /// Returns whether the word is alone before `;`, as in a declaration that is being typed.
    fn at_definition_of_nothing(&mut self) -> bool {
        self.peek() == SyntaxKind::Semicolon && self.begins_line()
    }

    /// Returns whether any declaration begins here.
    pub(super) fn at_file_item(&mut self) -> bool {
        matches!(
            self.kind,
            SyntaxKind::VarKeyword
                | SyntaxKind::PrimitiveKeyword
                | SyntaxKind::ScenarioKeyword
                | SyntaxKind::OptionKeyword
                | SyntaxKind::ControlText
        ) || self.at_constant()
            || self.at_constrain()
            || self.at_import()
            || self.at_model()
            || self.at_group_declaration()
            || self.at_lasting_declaration()
            || self.at_world_declaration()
            || self.at_definition(false)
    }
}

/// Returns whether a token begins a statement wherever one may stand. A name or a parenthesis may be something else.
pub(super) const fn begins_only_statements(kind: SyntaxKind) -> bool {
    matches!(
        kind,
        SyntaxKind::LeftBrace
            | SyntaxKind::ChooseKeyword
            | SyntaxKind::DoKeyword
            | SyntaxKind::IfKeyword
            | SyntaxKind::DelayKeyword
            | SyntaxKind::NotKeyword
            | SyntaxKind::Bang
            | SyntaxKind::TellKeyword
            | SyntaxKind::AskKeyword
    )
}
