//! The places in the text that a plant model refers to.

use crate::model::{Component, Mode, Model, Transition};

rmpl::spans! {
    Model { components }
    Component { modes, span }
    Mode { transitions, span }
    Transition { span }
}
