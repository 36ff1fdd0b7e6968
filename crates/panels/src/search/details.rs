//! What is said about the step that is looked at, or about the state under the pointer: what was decided, why it failed,
//! and the windows that changed.

use egui::{RichText, ScrollArea, Ui};
use kirk::{Event, Trace, TreeChoice, TreeNodeId, TreeStatus};
use tpn::Window;
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::search::wording;
use workbench::state::search::{Exclusion, Recording, SearchCommand, WindowChange};
use workbench::state::selection::node_name;
use workbench::time_text;

use super::tree::TreeIndex;
use super::{kind_name, step};
use crate::Context;

/// More changed windows than this are counted, not listed.
const MAX_CHANGES: usize = 60;
/// Of more learned conflicts only the latest are listed.
const MAX_LEARNED: usize = 40;

/// A search that is told of.
#[derive(Clone, Copy)]
pub struct Told<'a> {
    /// 0 for the first search, 1 for the second.
    pub side: usize,
    /// What was recorded.
    pub recording: &'a Recording,
    /// What is known of its states.
    pub index: &'a TreeIndex,
}

/// Shows the details of `state`, or of the step that is looked at; and what the other search made of the same choices, if
/// both are drawn as one.
pub fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    told: Told<'_>,
    state: Option<TreeNodeId>,
    other: Option<(Told<'_>, TreeNodeId)>,
    commands: &mut CommandSender,
) {
    let recording = told.recording;
    let show_states = |ui: &mut Ui, state: TreeNodeId| {
        show_state(ui, context, told, state, false);
        if let Some((other, state)) = other {
            show_state(ui, context, other, state, true);
        }
    };
    ScrollArea::vertical().auto_shrink(false).id_salt("search-details").show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        if let Some(state) = state {
            show_states(ui, state);
            return;
        }
        step::show(ui, context, recording);
        if let Some(step) = context.state.search.step() {
            show_states(ui, step.tree_node);
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
        if ui.add(button).on_hover_text("Go to the step that learned it").clicked() {
            commands.send(Command::Search(SearchCommand::GoTo(step)));
        }
    }
}

/// What was decided in a state, and what became of it; of a search that is only compared its name instead of the choice.
fn show_state(ui: &mut Ui, context: &Context<'_>, told: Told<'_>, state: TreeNodeId, is_compared: bool) {
    let Told { side, recording, index } = told;
    let tokens = context.tokens;
    let trace = recording.trace();
    let at = state as usize;
    let Some(node) = trace.tree.get(at) else { return };
    let view = context.state.search.view(side).filter(|view| view.recording.is(recording));
    let step = view.map(|view| view.step.step);
    let (what, color) = match index.status(trace, state, step) {
        TreeStatus::Unexplored if index.bounded(trace, state, step).is_some() => {
            ("waiting", tokens.text_muted)
        }
        TreeStatus::Unexplored => ("not tried", tokens.text_muted),
        TreeStatus::Excluded => ("ruled out", tokens.failure),
        TreeStatus::Decision if index.is_left(state, step) => ("not entered yet", tokens.text_muted),
        TreeStatus::Decision => ("open", tokens.decision),
        TreeStatus::Failed => ("failed", tokens.failure),
        TreeStatus::Solution => ("plan", tokens.solution),
    };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 8.0;
        let label = match recording.kind().filter(|_| is_compared) {
            Some(kind) => kind_name(kind).to_owned(),
            None => wording::choice(recording.network(), node.choice),
        };
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
    if let Some(exclusion) = index.exclusion(state, step) {
        let text = exclusion_text(recording, &exclusion);
        ui.label(RichText::new(text).small().color(tokens.failure));
    } else if what == "ruled out" {
        let text = match (own_failure(trace, index, state), index.excluded_by(trace, state)) {
            (Some(closed), _) => wording::event(recording.network(), trace, closed),
            (None, Some(step)) => {
                format!("Skipped: the failure at step {} doesn't depend on this choice.", step + 1)
            }
            (None, None) => "Skipped: the failure doesn't depend on this choice.".to_owned(),
        };
        ui.label(RichText::new(text).small().color(tokens.failure));
    }
    if let Some(failure) = failure_of(trace, index, state).filter(|_| what == "failed") {
        let text = wording::event(recording.network(), trace, failure);
        ui.label(RichText::new(text).small().color(tokens.failure));
    }
}

/// The learned conflict that a state contains.
fn exclusion_text(recording: &Recording, exclusion: &Exclusion) -> String {
    let conflict = wording::never(recording.network(), exclusion.conflict(recording.trace()));
    match exclusion.taught {
        Some(step) => format!("Ruled out by the conflict learned at step {}: {conflict}.", step + 1),
        None => format!("Ruled out by a learned conflict: {conflict}."),
    }
}

/// The failure that a state without states below it ended in.
fn failure_of<'a>(trace: &'a Trace, index: &TreeIndex, state: TreeNodeId) -> Option<&'a Event> {
    if index.children(state).is_empty() { own_failure(trace, index, state) } else { None }
}

/// The last failure that was met in a state itself.
fn own_failure<'a>(trace: &'a Trace, index: &TreeIndex, state: TreeNodeId) -> Option<&'a Event> {
    let at = state as usize;
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
    ui.label(RichText::new("Windows changed by this step").small().color(tokens.text_muted));
    for change in named.iter().take(MAX_CHANGES) {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            let name = network.readable(&node_name(network, change.node));
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
