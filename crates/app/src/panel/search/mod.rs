//! The search: the tree that planning walked, step by step, with what was tried and why it failed.
//!
//! While a step is looked at, the other panels show that step: what was selected then, and the windows then.

mod canvas;
mod controls;
mod keys;
mod matrix;
mod tree;
mod wording;

use std::collections::BTreeSet;
use std::sync::Arc;

use kirk::{Trace, TreeNodeId};
use mission::Snapshot;
use tpn::Network;

use crate::command::{Command, CommandSender};
use crate::panel::{Context, Panel, PanelKind};
use crate::state::search::{SearchCommand, recorded};
use crate::theme::space;
use tree::TreeDrawing;

/// The panel, with what concerns only it: where the tree is scrolled to and which states are collapsed.
#[derive(Default)]
pub struct SearchPanel {
    drawn: Option<Drawn>,
    collapsed: BTreeSet<TreeNodeId>,
    hides_failed: bool,
    shows_matrix: bool,
    view: canvas::View,
    followed_action: u64,
}

/// The tree of the search that was drawn last.
struct Drawn {
    snapshot: Arc<Snapshot>,
    collapsed: BTreeSet<TreeNodeId>,
    drawing: TreeDrawing,
}

/// What the panel draws from.
struct Shown<'a> {
    network: &'a Network,
    trace: &'a Trace,
    /// The step that is looked at.
    step: Option<&'a kirk::ReplayStep>,
}

impl Panel for SearchPanel {
    fn show(&mut self, ui: &mut egui::Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let snapshot = context.snapshot.filter(|snapshot| recorded(snapshot).is_some());
        let parts = snapshot.and_then(|it| Some((it, it.network.as_deref()?, recorded(it)?)));
        let Some((snapshot, network, trace)) = parts else {
            show_unrecorded(ui, context, commands);
            return;
        };
        let shown = Shown { network, trace, step: context.state.search.step() };
        controls::show(ui, context, &shown, &mut self.hides_failed, &mut self.shows_matrix, commands);
        self.layout(snapshot, trace);
        let Some(drawn) = &self.drawn else { return };
        keys::follow(ui, context, &shown, &drawn.drawing, commands);
        wording::show(ui, context, &shown);
        if self.shows_matrix {
            matrix::show(ui, context, &shown);
        }
        if let Some(action) = context.view_action(PanelKind::Search, &mut self.followed_action) {
            self.view.follow(action);
        }
        let clicked = self.view.show(ui, context, &shown, &drawn.drawing);
        match clicked {
            Some(canvas::Clicked::State(node)) => {
                commands.send(Command::Activate(PanelKind::Search));
                commands.send(Command::Search(SearchCommand::GoToNode(node)));
            }
            Some(canvas::Clicked::Toggle(node)) => {
                if !self.collapsed.remove(&node) {
                    self.collapsed.insert(node);
                }
            }
            None => {}
        }
    }
}

impl SearchPanel {
    /// Lays the tree out again if it is another one, or other states are collapsed.
    fn layout(&mut self, snapshot: &Arc<Snapshot>, trace: &Trace) {
        let is_same_search = self.drawn.as_ref().is_some_and(|drawn| Arc::ptr_eq(&drawn.snapshot, snapshot));
        if !is_same_search {
            self.collapsed.clear();
            self.view = canvas::View::default();
        }
        let mut collapsed = self.collapsed.clone();
        if self.hides_failed {
            let whole = TreeDrawing::new(trace, &BTreeSet::new());
            // A click on a failed state opens it: what was toggled by hand is the other way round.
            let failed = whole.failed_subtrees(trace);
            collapsed = failed.symmetric_difference(&self.collapsed).copied().collect();
        }
        let is_current =
            is_same_search && self.drawn.as_ref().is_some_and(|drawn| drawn.collapsed == collapsed);
        if !is_current {
            let drawing = TreeDrawing::new(trace, &collapsed);
            self.drawn = Some(Drawn { snapshot: Arc::clone(snapshot), collapsed, drawing });
        }
    }
}

fn show_unrecorded(ui: &mut egui::Ui, context: &Context<'_>, commands: &mut CommandSender) {
    ui.vertical_centered(|ui| {
        ui.add_space(space::XL * 2.0);
        if context.state.settings.plan.trace {
            ui.label(egui::RichText::new("There is no search to show yet.").color(context.tokens.text_muted));
            return;
        }
        let text =
            "The search is not recorded. Recording it lets you step through every decision and dead end.";
        ui.label(egui::RichText::new(text).color(context.tokens.text_muted));
        ui.add_space(space::M);
        if ui.button("Record the search").clicked() {
            commands.send(Command::SetTrace(true));
        }
    });
}
