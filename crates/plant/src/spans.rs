//! The places in the text that a plant model refers to.

use rmpl::Span;
use rmpl::spans::Spans;

use crate::model::{Component, Mode, Model, Transition};

/// Visits the named fields of a type, which are all that hold places.
macro_rules! spans {
    ($($type:ty { $($field:ident),* })*) => {$(
        impl Spans for $type {
            fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
                $(self.$field.visit_spans(visit);)*
            }
        }
    )*};
}

spans! {
    Model { components }
    Component { modes, span }
    Mode { transitions, span }
    Transition { span }
}
