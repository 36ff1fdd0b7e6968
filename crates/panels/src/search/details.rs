//! What is said about the step that is looked at, or about the state under the pointer: what was decided, why it failed,
//! and the windows that changed.

use egui::{RichText, ScrollArea, Ui};
use kirk::{Event, Trace, TreeChoice, TreeNodeId, TreeStatus};
use tpn::Window;
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::search::wording;
use workbench::state::search::{Recording, SearchCommand, WindowChange};
use workbench::state::selection::node_name;
use workbench::time_text;

use super::step;
use super::tree::TreeIndex;
use crate::Context;

/// More changed windows than this are counted, not listed.
const MAX_CHANGES: usize = 60;
/// Of more learned conflicts only the latest are listed.
const MAX_LEARNED: usize = 40;

/// Shows the details of `state`, or of the step that is looked at.
pub fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    recording: &Recording,
    index: &TreeIndex,
    state: Option<TreeNodeId>,
    commands: &mut CommandSender,
) {
    ScrollArea::vertical().auto_shrink(false).id_salt("search-details").show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        if let Some(state) = state {
            show_state(ui, context, recording, index, state);
            return;
        }
        step::show(ui, context, recording);
        if let Some(step) = context.state.search.step() {
            show_state(ui, context, recording, index, step.tree_node);
        }
        show_changes(ui, context, recording, commands);
        show_learned(ui, context, recording, commands);
    });
}

/// What the search has learned by the step that is looked at, or in all; the latest first.
fn show_learned(ui: &mut Ui, context: &Context<'_>, recording: &Recording, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let view = context.state.search.shown().filter(|view| view.recording.is(recording));
    let until = view.map_or(usize::MAX, |view| view.step.step);
    let learned: Vec<(usize, &[TreeChoice])> = recording.trace().learned(until).collect();
    if learned.is_empty() {
        return;
    }
    ui.add_space(3.0);
    ui.label(RichText::new(format!("Learned conflicts: {}", learned.len())).small().color(tokens.text_muted));
    for (step, choices) in learned.into_iter().rev().take(MAX_LEARNED) {
        let text = wording::learned(recording.network(), choices);
        let button = egui::Button::new(RichText::new(text).small()).frame_when_inactive(false).wrap();
        if ui.add(button).on_hover_text("Goes to the step that taught it").clicked() {
            commands.send(Command::Search(SearchCommand::GoTo(step)));
        }
    }
}

/// What was decided in a state, and what became of it.
fn show_state(
    ui: &mut Ui,
    context: &Context<'_>,
    recording: &Recording,
    index: &TreeIndex,
    state: TreeNodeId,
) {
    let tokens = context.tokens;
    let trace = recording.trace();
    let at = state as usize;
    let Some(node) = trace.tree.get(at) else { return };
    let step = context.state.search.shown().filter(|it| it.recording.is(recording)).map(|it| it.step.step);
    let (what, color) = match index.status(trace, state, step) {
        TreeStatus::Unexplored if index.bounded(trace, state, step).is_some() => {
            ("waiting", tokens.text_muted)
        }
        TreeStatus::Unexplored => ("not tried", tokens.text_muted),
        TreeStatus::Excluded => ("excluded", tokens.failure),
        TreeStatus::Decision if index.is_left(state, step) => ("left", tokens.text_muted),
        TreeStatus::Decision => ("open", tokens.decision),
        TreeStatus::Failed => ("failed", tokens.failure),
        TreeStatus::Solution => ("a plan", tokens.solution),
    };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        let label = wording::choice(recording.network(), node.choice);
        ui.label(RichText::new(label).small().color(tokens.text));
        ui.label(RichText::new(what).small().color(color));
        if let (Some(Some(first)), Some(Some(last))) = (index.first_step.get(at), index.last_step.get(at)) {
            let text = format!("steps {}–{}", first + 1, last + 1);
            ui.label(RichText::new(text).small().color(tokens.text_muted));
        }
        let (below, failures) = (index.below[at], index.failures[at]);
        if below > 0 {
            let states = if below == 1 { "state" } else { "states" };
            let ends = if failures == 1 { "failure" } else { "failures" };
            let text = format!("{below} {states} below, {failures} {ends}");
            ui.label(RichText::new(text).small().color(tokens.text_muted));
        }
    });
    if what == "excluded" {
        let text = match index.excluded_by(trace, state) {
            Some(step) => {
                format!("Not tried: the failure of step {} does not depend on this choice.", step + 1)
            }
            None => "Not tried: what failed does not depend on this choice.".to_owned(),
        };
        ui.label(RichText::new(text).small().color(tokens.failure));
    }
    if let Some(failure) = failure_of(trace, index, state).filter(|_| what == "failed") {
        let text = wording::event(recording.network(), trace, failure);
        ui.label(RichText::new(text).small().color(tokens.failure));
    }
}

/// The failure that a state without states below it ended in.
fn failure_of<'a>(trace: &'a Trace, index: &TreeIndex, state: TreeNodeId) -> Option<&'a Event> {
    let at = state as usize;
    if !index.children(state).is_empty() {
        return None;
    }
    let (first, last) = ((*index.first_step.get(at)?)?, (*index.last_step.get(at)?)?);
    let events = trace.events.get(first..=last)?;
    let mut own = events.iter().rev().filter(|entry| entry.tree_node == state).map(|entry| &entry.event);
    own.find(|event| workbench::state::search::focus::is_failure(event))
}

/// The windows that the step changed: before and after.
fn show_changes(ui: &mut Ui, context: &Context<'_>, recording: &Recording, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let Some(view) = context.state.search.shown().filter(|view| view.recording.is(recording)) else { return };
    let network = recording.network();
    let is_named = |change: &&WindowChange| {
        network.nodes.get(change.node.index()).is_some_and(|node| {
            let is_point = |event: &tpn::EventRef| matches!(event.end, tpn::EventEnd::PathVertex { .. });
            !node.events.is_empty() && !node.events.iter().all(is_point)
        })
    };
    let named: Vec<&WindowChange> = view.changes.iter().filter(is_named).collect();
    if named.is_empty() {
        return;
    }
    ui.add_space(3.0);
    ui.label(RichText::new("Windows that this step changed").small().color(tokens.text_muted));
    for change in named.iter().take(MAX_CHANGES) {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            let name = node_name(network, change.node);
            let button = egui::Button::new(RichText::new(name).small()).frame_when_inactive(false);
            if ui.add(button).clicked() {
                commands.send(Command::Select(Selection::Node(change.node)));
            }
            let before = change.before.map_or_else(|| "not selected".to_owned(), words);
            ui.label(RichText::new(format!("{before} →")).small().color(tokens.text_muted));
            let after = change.after.map_or_else(|| "not selected".to_owned(), words);
            ui.label(RichText::new(after).small().color(tokens.text));
        });
    }
    if named.len() > MAX_CHANGES {
        let text = format!("and {} more", named.len() - MAX_CHANGES);
        ui.label(RichText::new(text).small().color(tokens.text_muted));
    }
}

fn words(window: Window) -> String {
    time_text::interval(window.earliest, window.latest)
}
