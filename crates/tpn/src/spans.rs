//! The places in the text that a network refers to: they move with an edit that leaves the network as it is.

use crate::network::{Arc, Block, Decision, Label, Network, Occurrence};

rmpl::spans! {
    Network { arcs, labels, decisions, occurrences, blocks }
    Arc { span }
    Label { span }
    Decision { alternative_spans, span }
    Occurrence { span }
    Block { span }
}
