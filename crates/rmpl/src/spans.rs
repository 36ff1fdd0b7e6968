//! The places in a text that data refers to, so that they can move with an edit elsewhere in the text.
//!
//! What is computed from a text and does not depend on where things are written can be kept through an edit: only its
//! places move.

use crate::diagnostic::{Diagnostic, Edit, Fix};
use crate::edits::Shift;
use crate::program::{
    ActivityDecl, Amount, Argument, ArgumentValue, Bounds, Condition, ConstantDecl, ConstrainDecl,
    ControlDecl, Effect, EventName, Expr, ExprKind, FleetDecl, GoalDecl, GroupDecl, HeaderBound,
    HeaderBounds, ImportDecl, Level, LocationDecl, Members, ModelDecl, Moves, Name, ObjectiveDecl,
    ObstacleDecl, ObstacleKind, PrimitiveDecl, Program, PropertyDecl, Requirement, ResourceDecl, ResourceUse,
    Runs, ScenarioDecl, Statement, StatementKind, Supply, TerrainDecl, VariableDecl, VehicleDecl, World,
};
use crate::span::Span;

/// Data that refers to places in a text.
pub trait Spans {
    /// Calls `visit` with each place.
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span));

    /// Moves all places through a change of the text.
    fn follow(&mut self, shift: Shift) {
        self.visit_spans(&mut |span| *span = shift.moved(*span));
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

impl<T: Spans> Spans for Box<T> {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        (**self).visit_spans(visit);
    }
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
        world, fleets, groups
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
        name, formals, kinds, bounds, moves, runs, requires, sets, uses, costs, rewards, aborts, span
    }
    Requirement { condition }
    Effect { variable, value, span }
    ResourceUse { resource, amount, span }
    Amount { value, span }
    Moves { vehicles, span }
    ActivityDecl { name, formals, kinds, bounds, body, span }
    ScenarioDecl { name, bounds, body, span }
    ConstrainDecl { from, to, bounds, span }
    EventName { name, span }
    ImportDecl { file_span, span }
    Bounds { lower, upper, span }
    Expr { kind, span }
    Statement { kind, bounds, span }
    Argument { value, span }
    Condition { variable, values, sees, level, span }
    Level { bound }
    World { terrain, locations, obstacles, vehicles, models }
    TerrainDecl { asset_span, span }
    LocationDecl { name, numbers_span, span }
    ObstacleDecl { name, kind, numbers_span, span }
    VehicleDecl { name, model, start, span }
    ModelDecl { name, parent, properties, resources, states, span }
    PropertyDecl { span }
    FleetDecl { name, range_span }
    GroupDecl { name, members, span }
    Members { variable, group, body }
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

impl Spans for ObstacleKind {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        match self {
            Self::Solid => {}
            Self::KeepOut { closed_to } => closed_to.visit_spans(visit),
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
            Self::Members(members) => members.visit_spans(visit),
            Self::Condition(_, condition) => condition.visit_spans(visit),
            Self::Delay => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        program.follow(Shift::between(before, &after));
        assert_eq!(program, crate::parse(&after).program());
    }
}
