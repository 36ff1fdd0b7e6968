//! The places in the text that a plant model refers to.

use crate::model::{Choice, Component, Fault, Mode, Model, Transition};

rmpl::spans! {
    Model { components }
    Component { modes, span }
    Mode { transitions, choices, faults, span }
    Choice { span }
    Fault { span }
    Transition { span }
}
