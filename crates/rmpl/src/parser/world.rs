//! The world of a mission: terrain, locations, obstacles, vehicles, traverses (SPEC 1.8).

use super::Parser;
use crate::syntax::SyntaxKind;

impl Parser<'_> {
    pub(super) fn world_declaration(&mut self) {
        let node = self.open();
        let word = self.current_text();
        self.bump();
        let kind = match word {
            "terrain" => self.terrain(),
            "location" => self.location(),
            "obstacle" => self.obstacle(),
            _ => self.vehicle(),
        };
        self.end_declaration();
        self.close(node, kind);
    }

    fn terrain(&mut self) -> SyntaxKind {
        if self.expect(SyntaxKind::String) {
            if self.at_word("cell") {
                let node = self.open();
                self.bump();
                self.signed_number();
                self.close(node, SyntaxKind::Cell);
            }
            if self.at_word("origin") {
                let node = self.open();
                self.bump();
                self.coordinates();
                self.close(node, SyntaxKind::Origin);
            }
        }
        SyntaxKind::TerrainDecl
    }

    fn location(&mut self) -> SyntaxKind {
        self.declared_name("the name of the location");
        self.coordinates();
        SyntaxKind::LocationDecl
    }

    fn obstacle(&mut self) -> SyntaxKind {
        self.declared_name("the name of the obstacle");
        if !self.eat_word("circle") && !self.eat_word("polygon") {
            self.report_expected("`circle` or `polygon`");
            if self.at(SyntaxKind::Name) {
                self.bump();
                self.hush();
            }
        }
        self.coordinates();
        SyntaxKind::ObstacleDecl
    }

    fn vehicle(&mut self) -> SyntaxKind {
        self.declared_name("the name of the vehicle");
        self.expect(SyntaxKind::Colon);
        self.declared_name("the vehicle's model");
        if self.at_word("at") {
            let node = self.open();
            self.bump();
            self.declared_name("the location where the vehicle starts");
            self.close(node, SyntaxKind::At);
        } else {
            self.report_missing("`at` and a location", " at ");
        }
        SyntaxKind::VehicleDecl
    }

    /// `moves V1, V2 speed (least, greatest)`
    pub(super) fn moves(&mut self) {
        let node = self.open();
        self.bump();
        self.declared_name("the name of a vehicle");
        while self.eat(SyntaxKind::Comma) {
            self.declared_name("the name of a vehicle");
        }
        if self.at_word("speed") {
            let speed = self.open();
            self.bump();
            self.coordinates();
            self.close(speed, SyntaxKind::Speed);
        }
        self.close(node, SyntaxKind::Moves);
    }

    /// `(n, n, …)`
    fn coordinates(&mut self) {
        let node = self.open();
        if self.expect(SyntaxKind::LeftParen) {
            loop {
                self.signed_number();
                if self.eat(SyntaxKind::Comma) {
                    continue;
                }
                if matches!(self.kind, SyntaxKind::Number | SyntaxKind::Minus)
                    && self.reported_at != Some(self.current)
                {
                    self.report_missing("`,`", ",");
                    continue;
                }
                break;
            }
            if !self.at(SyntaxKind::RightParen) {
                self.skip_in_header(SyntaxKind::RightParen);
            }
            self.expect_behind(SyntaxKind::RightParen, ")");
        }
        self.close(node, SyntaxKind::Coordinates);
    }

    fn signed_number(&mut self) {
        self.eat(SyntaxKind::Minus);
        if !self.eat(SyntaxKind::Number) {
            self.report_expected("a number");
        }
    }
}
