//! The places in the text that a network refers to: they move with an edit that leaves the network as it is.

use rmpl::Span;
use rmpl::spans::Spans;

use crate::network::{Arc, Block, Decision, Label, Network, Occurrence};

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
    Network { arcs, labels, decisions, occurrences, blocks }
    Arc { span }
    Label { span }
    Decision { alternative_spans, span }
    Occurrence { span }
    Block { span }
}
