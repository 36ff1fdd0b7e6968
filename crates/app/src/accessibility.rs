//! The interface as a document: egui's AccessKit tree, reduced to what a page can mirror.
//!
//! eframe drops AccessKit updates on the web. [`AccessibilityMirror`] catches them in egui's output, keeps the named and
//! meaningful nodes with their ARIA roles, and hands out what changed as plain data. What a user of the mirror does
//! (click, focus, step a slider) goes back into egui as AccessKit action requests. Nothing here knows of a document
//! or a browser.

mod arrange;
mod document;
mod role;

use egui::accesskit::{Action, ActionData, ActionRequest, NodeId, TreeId};
use egui::{Context, Event, FullOutput, Plugin, RawInput};
use serde::Deserialize;

pub use document::{Change, Document, Element, Flag};

/// The egui plugin that mirrors the tree. Add it once with [`Context::add_plugin`].
#[derive(Debug, Default)]
pub struct AccessibilityMirror {
    latest: Document,
    handed_out: Document,
    requests: Vec<Request>,
    announcement: String,
}

/// What a user of the mirror does to one element.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Act {
    Click,
    /// Gives it the keyboard.
    Focus,
    /// Makes its number greater by a step.
    Increment,
    /// Makes its number smaller by a step.
    Decrement,
    /// Sets its number.
    Number(f64),
}

#[derive(Debug)]
struct Request {
    element: u64,
    act: Act,
}

impl AccessibilityMirror {
    /// Returns what changed since the last call; `None` if nothing did.
    pub fn take_change(&mut self) -> Option<Change> {
        let change = self.latest.change_since(&self.handed_out)?;
        self.handed_out = self.latest.clone();
        Some(change)
    }

    /// Says something to those who do not see it; said again only after something else.
    pub fn announce(&mut self, words: &str) {
        if self.announcement != words {
            words.clone_into(&mut self.announcement);
        }
    }

    /// The interface as of the last frame.
    pub fn document(&self) -> &Document {
        &self.latest
    }

    /// Does something to an element in the next frame. An element that is gone by then is left alone.
    pub fn act(&mut self, element: u64, act: Act) {
        self.requests.push(Request { element, act });
    }
}

impl Plugin for AccessibilityMirror {
    fn debug_name(&self) -> &'static str {
        "accessibility mirror"
    }

    fn setup(&mut self, context: &Context) {
        context.enable_accesskit();
    }

    fn input_hook(&mut self, _context: &Context, input: &mut RawInput) {
        input.events.extend(self.requests.drain(..).map(|request| {
            let (action, data) = match request.act {
                Act::Click => (Action::Click, None),
                Act::Focus => (Action::Focus, None),
                Act::Increment => (Action::Increment, None),
                Act::Decrement => (Action::Decrement, None),
                Act::Number(number) => (Action::SetValue, Some(ActionData::NumericValue(number))),
            };
            Event::AccessKitActionRequest(ActionRequest {
                action,
                target_tree: TreeId::ROOT,
                target_node: NodeId(request.element),
                data,
            })
        }));
    }

    fn output_hook(&mut self, context: &Context, output: &mut FullOutput) {
        if let Some(update) = &output.platform_output.accesskit_update {
            self.latest = Document::read(update, f64::from(context.zoom_factor()));
            self.latest.announcement.clone_from(&self.announcement);
        }
    }
}

#[cfg(test)]
mod tests;
