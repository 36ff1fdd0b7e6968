//! What all questions ask of a plant, derived once from its components and variables.

use crate::island::{islands, watchers};
use crate::model::Model;
use crate::successor::led_by_commands;

impl Model {
    /// Derives what is not given.
    pub(crate) fn prepare(&mut self) {
        self.islands = islands(self);
        self.watchers = watchers(self);
        self.led_by_commands = led_by_commands(self);
    }
}
