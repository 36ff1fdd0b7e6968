//! The places that what is kept of a control program refers to: see [`crate::spans`].

use super::syntax::{Constraint, ConstraintKind, Guard, Held, Name};
use crate::span::Span;
use crate::spans::Spans;

crate::spans! {
    Name { span }
    Guard { held, constraint, span }
    Held { duration }
    Constraint { kind, span }
}

impl Spans for ConstraintKind {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        match self {
            Self::True | Self::False | Self::Unreadable => {}
            Self::Equals { variable, value } => {
                variable.visit_spans(visit);
                value.visit_spans(visit);
            }
            Self::Not(inner) => inner.visit_spans(visit),
            Self::And(parts) | Self::Or(parts) => parts.visit_spans(visit),
            Self::Parameter(name) => name.visit_spans(visit),
        }
    }
}
