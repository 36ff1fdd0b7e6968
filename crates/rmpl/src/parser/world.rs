//! The world of a mission: terrain, locations, obstacles, vehicles, traverses (SPEC 1.8).

use super::Parser;
use crate::diagnostics::syntax;
use crate::span::Span;
use crate::syntax::{KEEPOUT, SyntaxKind};

/// What a keep-out area may be closed to.
const CLOSED_TO: &str = "a vehicle, a vehicle model, or an activity that moves vehicles";

impl Parser<'_> {
    pub(super) fn world_declaration(&mut self) {
        let node = self.open();
        let word = self.current_text();
        self.bump();
        let kind = match word {
            "terrain" => self.terrain(),
            "location" => self.location(),
            "obstacle" => self.obstacle(),
            KEEPOUT => self.keepout(),
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
                self.coordinates("2 numbers: meters east and meters north", |count| count == 2);
                self.close(node, SyntaxKind::Origin);
            }
        }
        SyntaxKind::TerrainDecl
    }

    fn location(&mut self) -> SyntaxKind {
        self.declared_name("the name of the location");
        self.coordinates("2 numbers: meters east and meters north", |count| count == 2);
        SyntaxKind::LocationDecl
    }

    fn obstacle(&mut self) -> SyntaxKind {
        self.declared_name("the name of the obstacle");
        self.shape();
        SyntaxKind::ObstacleDecl
    }

    /// `keepout NAME circle (…) for R1, ATRV, Drive`
    fn keepout(&mut self) -> SyntaxKind {
        self.declared_name("the name of the keep-out area");
        self.shape();
        if self.at_word("for") {
            let node = self.open();
            self.bump();
            self.member_name(CLOSED_TO);
            while self.eat(SyntaxKind::Comma) {
                self.member_name(CLOSED_TO);
            }
            self.close(node, SyntaxKind::ClosedTo);
        }
        SyntaxKind::ObstacleDecl
    }

    fn shape(&mut self) {
        if self.eat_word("circle") {
            self.coordinates("3 numbers: meters east and north of the center, and the radius", |count| {
                count == 3
            });
        } else if self.eat_word("polygon") {
            let wanted = "an east and a north coordinate for each of at least three corners";
            self.coordinates(wanted, |count| count >= 6 && count % 2 == 0);
        } else {
            self.report_expected("`circle` or `polygon`");
            if self.at(SyntaxKind::Name) {
                self.bump();
                self.hush();
            }
            self.coordinates("numbers", |_| true);
        }
    }

    fn vehicle(&mut self) -> SyntaxKind {
        self.declared_name("the name of the vehicle");
        self.fleet_range_if_any();
        while self.eat(SyntaxKind::Comma) {
            self.declared_name("the name of another vehicle");
            self.fleet_range_if_any();
        }
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

    /// `moves V1, V2 speed (least, greatest) kinodynamic`
    pub(super) fn moves(&mut self) {
        let node = self.open();
        self.bump();
        self.member_name("the name of a vehicle");
        while self.eat(SyntaxKind::Comma) {
            self.member_name("the name of a vehicle");
        }
        if self.at_word("speed") {
            let speed = self.open();
            self.bump();
            self.coordinates("2 speeds: minimum and maximum, in meters per second", |count| count == 2);
            self.close(speed, SyntaxKind::Speed);
        }
        if self.at_word("kinodynamic") {
            let limited = self.open();
            self.bump();
            self.close(limited, SyntaxKind::Kinodynamic);
        }
        self.close(node, SyntaxKind::Moves);
    }

    /// `(n, n, …)` with a number of numbers that `fits`; `wanted` says which.
    fn coordinates(&mut self, wanted: &str, fits: impl Fn(usize) -> bool) {
        let node = self.open();
        let start = self.start_of(self.current);
        let reports = self.diagnostics.len();
        let mut count = 0;
        if self.expect(SyntaxKind::LeftParen) {
            loop {
                self.signed_number();
                count += 1;
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
            if reports == self.diagnostics.len() && !fits(count) {
                let span = Span::new(start, self.previous_end());
                self.diagnostics.push(syntax::wrong_count(wanted, count, span));
            }
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
