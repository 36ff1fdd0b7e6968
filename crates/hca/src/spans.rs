//! The places in the text that an automaton refers to.

use rmpl::Span;
use rmpl::spans::Spans;

use crate::automaton::{Automaton, Composite, Location, Test};

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
    Automaton { tests, locations, composites }
    Test { guard }
    Location { span }
    Composite { span }
}
