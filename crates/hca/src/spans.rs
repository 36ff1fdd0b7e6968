//! The places in the text that an automaton refers to.

use crate::automaton::{Automaton, Composite, Location, Test};

rmpl::spans! {
    Automaton { tests, locations, composites }
    Test { guard }
    Location { span }
    Composite { span }
}
