//! The places in a text that data refers to, so that they can move with an edit elsewhere in the text.
//!
//! What is computed from a text and does not depend on where things are written can be kept through an edit: only its
//! places move.

use crate::diagnostic::{Diagnostic, Edit, Fix};
use crate::program::{
    ActivityDecl, Amount, Argument, ArgumentValue, Bounds, Condition, ConstantDecl, ConstrainDecl,
    ControlDecl, Effect, EventName, Expr, ExprKind, GoalDecl, HeaderBound, HeaderBounds, ImportDecl,
    LocationDecl, Moves, Name, ObjectiveDecl, ObstacleDecl, PrimitiveDecl, Program, Requirement,
    ResourceDecl, ResourceUse, Runs, ScenarioDecl, Statement, StatementKind, Supply, TerrainDecl,
    VariableDecl, VehicleDecl, World,
};
use crate::span::Span;

/// Data that refers to places in a text.
pub trait Spans {
    /// Calls `visit` with each place.
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span));

    /// Moves all places through an edit of the text.
    fn follow(&mut self, edit: &Edit) {
        self.visit_spans(&mut |span| *span = edit.moved(*span));
    }

    /// The same wherever it is written.
    #[must_use]
    fn without_places(&self) -> Self
    where
        Self: Clone,
    {
        let mut bare = self.clone();
        bare.visit_spans(&mut |span| *span = Span::default());
        bare
    }
}

impl Edit {
    /// Where what stood at `span` stands after the edit, if the edit is outside of it, or inside but not at its ends.
    pub fn moved(&self, span: Span) -> Span {
        let inserted = self.text.len() as u32;
        let shifted = |offset: u32| {
            if offset >= self.span.end {
                offset - (self.span.end - self.span.start) + inserted
            } else {
                offset
            }
        };
        let end = if span.end <= self.span.start { span.end } else { shifted(span.end) };
        // What is empty stays where it ends.
        if span.start == span.end { Span::new(end, end) } else { Span::new(shifted(span.start), end) }
    }
}

/// The change from one text to another as one edit: what stands between their common beginning and end.
pub fn difference(before: &str, after: &str) -> Edit {
    let common = before.bytes().zip(after.bytes()).take_while(|(one, other)| one == other).count();
    let mut start = common;
    while !before.is_char_boundary(start) || !after.is_char_boundary(start) {
        start -= 1;
    }
    let rest = (before.len() - start).min(after.len() - start);
    let endings = before.bytes().rev().zip(after.bytes().rev()).take(rest);
    let mut tail = endings.take_while(|(one, other)| one == other).count();
    while !before.is_char_boundary(before.len() - tail) || !after.is_char_boundary(after.len() - tail) {
        tail -= 1;
    }
    let text = after.get(start..after.len() - tail).unwrap_or_default().to_owned();
    Edit { span: Span::new(start as u32, (before.len() - tail) as u32), text }
}

impl Spans for Span {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        visit(self);
    }
}

impl<T: Spans> Spans for Option<T> {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        if let Some(inner) = self {
            inner.visit_spans(visit);
        }
    }
}

impl<T: Spans> Spans for Vec<T> {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        for inner in self {
            inner.visit_spans(visit);
        }
    }
}

/// Visits the named fields of a type, which are all that hold places.
#[macro_export]
macro_rules! spans {
    ($($type:ty { $($field:ident),* })*) => {$(
        impl $crate::spans::Spans for $type {
            fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut $crate::Span)) {
                $($crate::spans::Spans::visit_spans(&mut self.$field, visit);)*
            }
        }
    )*};
}

spans! {
    Program {
        constants, variables, resources, objectives, primitives, activities, scenarios, constraints, imports, control,
        world
    }
    Name { span }
    Runs { program, arguments }
    ControlDecl { text_span, span }
    ConstantDecl { name, value, span }
    VariableDecl { name, values, initial, span }
    ResourceDecl { name, supply, span }
    ObjectiveDecl { goals, span }
    GoalDecl { span }
    PrimitiveDecl {
        name, formals, bounds, moves, runs, requires, sets, uses, costs, rewards, aborts, span
    }
    Requirement { condition }
    Effect { variable, value, span }
    ResourceUse { resource, amount, span }
    Amount { value, span }
    Moves { vehicles, span }
    ActivityDecl { name, formals, bounds, body, span }
    ScenarioDecl { name, bounds, body, span }
    ConstrainDecl { from, to, bounds, span }
    EventName { name, span }
    ImportDecl { file_span, span }
    Bounds { lower, upper, span }
    Expr { kind, span }
    Statement { kind, bounds, span }
    Argument { value, span }
    Condition { variable, values, span }
    World { terrain, locations, obstacles, vehicles }
    TerrainDecl { asset_span, span }
    LocationDecl { name, numbers_span, span }
    ObstacleDecl { name, numbers_span, span }
    VehicleDecl { name, model, start, span }
    Diagnostic { span, fixes }
    Fix { edits }
    Edit { span }
}

impl Spans for Supply {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        match self {
            Self::Reusable { capacity } => capacity.visit_spans(visit),
            Self::Reservoir { least, greatest, level } => {
                least.visit_spans(visit);
                greatest.visit_spans(visit);
                level.visit_spans(visit);
            }
        }
    }
}

impl Spans for HeaderBounds {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        if let Self::Sides { lower, upper, span } = self {
            lower.visit_spans(visit);
            upper.visit_spans(visit);
            visit(span);
        }
    }
}

impl Spans for HeaderBound {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        match self {
            Self::Parameter(name) => name.visit_spans(visit),
            Self::Limit(limit) => limit.visit_spans(visit),
        }
    }
}

impl Spans for ExprKind {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        match self {
            Self::Number(_) | Self::Duration(..) | Self::Infinity | Self::Name(_) => {}
            Self::Percent(inner) => inner.visit_spans(visit),
            Self::Binary(_, left, right) => {
                left.visit_spans(visit);
                right.visit_spans(visit);
            }
        }
    }
}

impl Spans for ArgumentValue {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        match self {
            Self::Name(_) | Self::Number(_) => {}
            Self::Expression(expr) => expr.visit_spans(visit),
            Self::Condition(condition) => condition.visit_spans(visit),
        }
    }
}

impl Spans for StatementKind {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        match self {
            Self::Sequence(parts) | Self::Parallel(parts) | Self::Choose(parts) | Self::Unordered(parts) => {
                parts.visit_spans(visit);
            }
            Self::Maintaining(body, condition)
            | Self::Watching(body, condition)
            | Self::Telling(body, condition) => {
                body.visit_spans(visit);
                condition.visit_spans(visit);
            }
            Self::IfThennext(condition, body) => {
                condition.visit_spans(visit);
                body.visit_spans(visit);
            }
            Self::Repeat(count, body) => {
                count.visit_spans(visit);
                body.visit_spans(visit);
            }
            Self::Using(body, resource, amount) => {
                body.visit_spans(visit);
                resource.visit_spans(visit);
                amount.visit_spans(visit);
            }
            Self::Named(body, name) => {
                body.visit_spans(visit);
                name.visit_spans(visit);
            }
            Self::Call(name, arguments) => {
                name.visit_spans(visit);
                arguments.visit_spans(visit);
            }
            Self::Condition(_, condition) => condition.visit_spans(visit),
            Self::Delay => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_is_the_least_that_turns_one_text_into_the_other() {
        let shown = |before: &str, after: &str| {
            let edit = difference(before, after);
            let mut text = before.to_owned();
            text.replace_range(edit.span.range(), &edit.text);
            assert_eq!(text, after);
            (edit.span.start, edit.span.end, edit.text)
        };
        assert_eq!(shown("abc", "abc"), (3, 3, String::new()));
        assert_eq!(shown("abc", "abxc"), (2, 2, "x".to_owned()));
        assert_eq!(shown("aaa", "aa"), (2, 3, String::new()));
        assert_eq!(shown("", "new"), (0, 0, "new".to_owned()));
        // The first byte of both letters is the same.
        assert_eq!(shown("è", "é"), (0, 2, "é".to_owned()));
        // So is the last.
        assert_eq!(shown("\u{e9}", "\u{129}"), (0, 2, "\u{129}".to_owned()));
    }

    #[test]
    fn what_is_behind_an_edit_moves_and_what_is_around_it_grows() {
        let edit = Edit { span: Span::new(4, 6), text: "12345".to_owned() };
        assert_eq!(edit.moved(Span::new(0, 4)), Span::new(0, 4));
        assert_eq!(edit.moved(Span::new(6, 8)), Span::new(9, 11));
        assert_eq!(edit.moved(Span::new(2, 8)), Span::new(2, 11));
        let insertion = Edit { span: Span::new(4, 4), text: "12".to_owned() };
        assert_eq!(insertion.moved(Span::new(2, 4)), Span::new(2, 4), "it ends before the insertion");
        assert_eq!(insertion.moved(Span::new(4, 5)), Span::new(6, 7), "it begins behind the insertion");
    }

    #[test]
    fn a_program_follows_the_edit_of_a_comment() {
        let before = "# A note.\nconst N = 2*M; const M = 3;\nprimitive B(n, c)[1,2];\n\
             state ARM : {IN, OUT} = IN;\nresource P capacity 2; resource E 0..N = 3; objective minimize cost;\n\
             primitive D(s)[1,2] requires ARM=OUT, V.at=s sets ARM=IN uses P 2 consumes E N per metre costs 3 rewards N aborts [0,N];\n\
             U() = { unordered { B(1, P); do D(s) using P N }; optional D(s) }\n\
             A() = { B(N+1, X in {a, b})[1,2*3]; if P=OK thennext B(2, Q=on) else repeat N { delay } }\n\
             scenario S = { free A() as F; do A() maintaining P and (Q or R) }\n\
             constrain F.start to F.end [N,2*N]; import \"other.rmpl\";\n";
        let after = before.replace("note", "longer note");
        let mut program = crate::parse(before).program();
        program.follow(&difference(before, &after));
        assert_eq!(program, crate::parse(&after).program());
    }
}
