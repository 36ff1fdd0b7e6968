//! The search: the tree that planning walked, step by step, with what was tried and why it failed; or the trees of both
//! searches side by side.
//!
//! While a step is looked at, the other panels show that step: what was selected then, and the windows then.

mod canvas;
mod controls;
mod details;
mod items;
mod keys;
mod merged;
mod statistics;
mod step;
mod tree;

use std::collections::BTreeSet;

use egui::{RichText, Ui, UiBuilder};
use kirk::Search as SearchKind;
use kirk::TreeNodeId;
use theme::space;
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::search::focus::selection_of;
use workbench::state::search::{Recording, SearchCommand};
use workbench::state::settings::SettingsCommand;
use workbench::state::window::WindowCommand;

use crate::{Context, Panel};
use canvas::{Names, Pointed, Tree};
use details::Told;
use merged::MergedSide;
use tree::{TreeDrawing, TreeIndex};

/// The panel, with what concerns only it: where each tree is scrolled to and which of its states are folded.
pub struct SearchPanel {
    sides: [Side; 2],
    /// Both trees as one, while two searches are compared.
    merged: MergedSide,
    /// Whether two trees are shown as one.
    merges: bool,
    /// What this panel last said the pointer is over.
    told_hover: Selection,
}

impl Default for SearchPanel {
    fn default() -> Self {
        let (sides, merged) = (Default::default(), MergedSide::default());
        Self { sides, merged, merges: true, told_hover: Selection::None }
    }
}

/// One tree on screen.
#[derive(Default)]
struct Side {
    drawn: Option<Drawn>,
    /// States that were folded or opened by hand: the other way round than they would be.
    toggled: BTreeSet<TreeNodeId>,
    /// Whether failed subtrees are folded; large searches begin like that.
    folds_failed: bool,
    view: canvas::View,
}

/// The tree that was laid out last.
struct Drawn {
    recording: Recording,
    index: TreeIndex,
    drawing: TreeDrawing,
    names: Names,
    /// What the layout depends on besides.
    toggled: BTreeSet<TreeNodeId>,
    folds_failed: bool,
    /// The states above and at the step or the goal, which are open.
    open: Vec<TreeNodeId>,
}

/// A search with more states than this begins with its failed subtrees folded.
const MANY_STATES: usize = 300;
/// The least height of the tree, and that of what is said about the step where there is room for both.
const MIN_TREE: f32 = 120.0;
const DETAILS: f32 = 132.0;
/// Narrower panels show two trees one above the other.
const SIDE_BY_SIDE: f32 = 420.0;

impl Panel for SearchPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let panel = ui.max_rect();
        let search = &context.state.search;
        let recordings = search.recordings(context.snapshot);
        let side = search.side().min(recordings.len().saturating_sub(1));
        if recordings.is_empty() {
            show_unrecorded(ui, context, commands);
            return;
        }
        for (side, recording) in self.sides.iter_mut().zip(&recordings) {
            side.begin(recording);
        }
        let folds_failed = &mut self.sides[side].folds_failed;
        controls::show(ui, context, &recordings, [folds_failed, &mut self.merges], commands);
        for (number, recording) in recordings.iter().enumerate() {
            self.sides[number].follow(recording, context, number);
        }
        let Side { drawn, view, .. } = &self.sides[side];
        if let Some(drawn) = drawn {
            keys::follow(ui, context, (&drawn.recording, &drawn.index), view.has_focus, commands);
        }
        let action = context.view_action(PanelKind::Search);
        let room = ui.available_rect_before_wrap().intersect(panel);
        // What a low tree leaves free is for the words below it.
        let drawn = self.sides[side].drawn.as_ref().filter(|_| recordings.len() == 1);
        let free = drawn.map_or(0.0, |drawn| room.height() - canvas::height_of(&drawn.drawing));
        let details = free.max(DETAILS).min((room.height() - MIN_TREE).max(room.height() * 0.3));
        let (upper, lower) = room.split_top_bottom_at_y(room.bottom() - details);
        if let Some(action) = action {
            for (number, tree) in self.sides.iter_mut().enumerate() {
                if number == side || action == ViewAction::FitSelection {
                    tree.view.follow(action, upper);
                }
            }
            self.merged.follow(action, upper);
        }
        let pointed = match recordings.as_slice() {
            [first, other] if self.merges => {
                let both = [first.clone(), other.clone()];
                self.show_merged(ui, context, &both, upper, commands)
            }
            _ => self.show_trees(ui, context, &recordings, upper, commands),
        };
        let mut below = ui.new_child(UiBuilder::new().max_rect(lower.shrink2(egui::vec2(space::M, 2.0))));
        ui.painter().hline(lower.x_range(), lower.top(), egui::Stroke::new(1.0, context.tokens.line));
        let (shown, state) = pointed.map_or((side, None), |(side, state)| (side, Some(state)));
        if let Some(drawn) = &self.sides[shown].drawn {
            let looked_at = state.or_else(|| Some(context.state.search.view(shown)?.step.tree_node));
            let merged = (recordings.len() == 2 && self.merges).then_some(&self.merged);
            let other = merged.zip(looked_at).and_then(|(merged, state)| {
                let Drawn { recording, index, .. } = self.sides[1 - shown].drawn.as_ref()?;
                let told = Told { side: 1 - shown, recording, index };
                Some((told, merged.counterpart(shown, state)?))
            });
            let told = Told { side: shown, recording: &drawn.recording, index: &drawn.index };
            details::show(&mut below, context, told, state, other, commands);
        }
        self.tell_hover(context, shown, state, commands);
        ui.advance_cursor_after_rect(room);
    }
}

impl SearchPanel {
    /// Shows both trees as one below the figures of both, and answers which state of which the pointer is over.
    fn show_merged(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        recordings: &[Recording; 2],
        room: egui::Rect,
        commands: &mut CommandSender,
    ) -> Option<(usize, TreeNodeId)> {
        let mut part = ui.new_child(UiBuilder::new().max_rect(room).id_salt("merged"));
        let draw = |ui: &mut Ui, number: usize, commands: &mut CommandSender| {
            statistics::show(ui, context, &recordings[number], number, commands);
        };
        if room.width() >= SIDE_BY_SIDE {
            part.columns(2, |columns| {
                for (number, column) in columns.iter_mut().enumerate() {
                    draw(column, number, commands);
                }
            });
        } else {
            (0..2).for_each(|number| draw(&mut part, number, commands));
        }
        let folds_failed = self.sides.iter().any(|side| side.folds_failed);
        self.merged.show(&mut part, context, recordings, folds_failed, commands)
    }

    /// Shows the tree, or both, and answers what the pointer does in which of them.
    fn show_trees(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        recordings: &[Recording],
        room: egui::Rect,
        commands: &mut CommandSender,
    ) -> Option<(usize, TreeNodeId)> {
        let mut found = None;
        for (number, recording) in recordings.iter().enumerate() {
            let place = match recordings.len() {
                2 if room.width() >= SIDE_BY_SIDE => {
                    let (left, right) = room.split_left_right_at_fraction(0.5);
                    [left, right][number]
                }
                2 => {
                    let (upper, lower) = room.split_top_bottom_at_fraction(0.5);
                    [upper, lower][number]
                }
                _ => room,
            };
            let mut part = ui.new_child(UiBuilder::new().max_rect(place).id_salt(("search", number)));
            let is_active = context.state.search.side() == number;
            if recording.searched().is_some() {
                statistics::show(&mut part, context, recording, number, commands);
                if is_active {
                    let edge = place.shrink(1.0);
                    let stroke = egui::Stroke::new(1.0, context.tokens.accent);
                    ui.painter().rect_stroke(edge, 3.0, stroke, egui::StrokeKind::Inside);
                }
            }
            let side = &mut self.sides[number];
            let Some(drawn) = &side.drawn else { continue };
            let view = context.state.search.view(number);
            let tree = Tree {
                network: recording.network(),
                trace: recording.trace(),
                index: &drawn.index,
                drawing: &drawn.drawing,
                names: &drawn.names,
                step: view.map(|view| (view.step.step, view.step.tree_node)),
                goal: drawn.index.goal,
                jump: view.and_then(|view| canvas::jump(recording.trace(), view.step.step)),
                name: recording.kind().map_or("Search", kind_name),
                merged: None,
            };
            let pointed = side.view.show(&mut part, context, &tree);
            side.answer(pointed, number, commands);
            found = pointed.hovered.map(|state| (number, state)).or(found);
        }
        found
    }

    /// Lets the other panels hint at what is chosen in the state under the pointer.
    fn tell_hover(
        &mut self,
        context: &Context<'_>,
        side: usize,
        state: Option<TreeNodeId>,
        commands: &mut CommandSender,
    ) {
        let drawn = self.sides[side].drawn.as_ref();
        let hover = drawn.zip(state).map_or(Selection::None, |(drawn, state)| {
            let choice = drawn.recording.trace().tree.get(state as usize).and_then(|node| node.choice);
            selection_of(drawn.recording.network(), choice)
        });
        if hover != self.told_hover {
            if !hover.is_none() || context.state.hovered == self.told_hover {
                commands.send(Command::Hover(hover.clone()));
            }
            self.told_hover = hover;
        }
    }
}

impl Side {
    /// Starts with another search.
    fn begin(&mut self, recording: &Recording) {
        if self.drawn.as_ref().is_some_and(|drawn| drawn.recording.is(recording)) {
            return;
        }
        let trace = recording.trace();
        if self.drawn.as_ref().is_some_and(|drawn| drawn.recording.trace() == trace) {
            // The same search, come again: everything stays where it is.
            if let Some(drawn) = &mut self.drawn {
                drawn.recording = recording.clone();
            }
            return;
        }
        self.toggled.clear();
        self.folds_failed = trace.tree.len() > MANY_STATES;
        self.view = canvas::View::default();
        self.drawn = Some(Drawn {
            recording: recording.clone(),
            index: TreeIndex::new(trace),
            drawing: TreeDrawing::default(),
            names: Names::default(),
            toggled: BTreeSet::new(),
            folds_failed: false,
            open: Vec::new(),
        });
    }

    /// Lays the tree out again if other states are folded than before.
    fn follow(&mut self, recording: &Recording, context: &Context<'_>, number: usize) {
        let Some(drawn) = &mut self.drawn else { return };
        let trace = recording.trace();
        let looked_at = context.state.search.view(number).map(|view| view.step.tree_node);
        let state = Some(looked_at.unwrap_or(drawn.index.goal));
        let above = |&id: &TreeNodeId| trace.tree.get(id as usize).and_then(|node| node.parent);
        let is_above_step = |id: &TreeNodeId| drawn.index.is_failed_subtree(*id);
        let mut open: Vec<TreeNodeId> = if self.folds_failed {
            std::iter::successors(state, above).filter(is_above_step).collect()
        } else {
            Vec::new()
        };
        open.sort_unstable();
        let is_laid_out = !drawn.drawing.rows.is_empty()
            && drawn.toggled == self.toggled
            && drawn.folds_failed == self.folds_failed
            && drawn.open == open;
        if is_laid_out {
            return;
        }
        let index = &drawn.index;
        let folds = |id: TreeNodeId| {
            let is_folded = self.folds_failed && index.is_failed_subtree(id);
            is_folded != self.toggled.contains(&id) && open.binary_search(&id).is_err()
        };
        drawn.drawing = TreeDrawing::new(index, &folds);
        drawn.toggled.clone_from(&self.toggled);
        drawn.folds_failed = self.folds_failed;
        drawn.open = open;
    }

    fn answer(&mut self, pointed: Pointed, number: usize, commands: &mut CommandSender) {
        let (Some(state), Some(drawn)) = (pointed.hovered, &self.drawn) else { return };
        if pointed.toggled {
            if !self.toggled.remove(&state) {
                self.toggled.insert(state);
            }
        } else if pointed.clicked || pointed.chosen {
            commands.send(Command::Window(WindowCommand::Activate(PanelKind::Search)));
            commands.send(Command::Search(SearchCommand::Turn(number)));
            commands.send(Command::Search(SearchCommand::GoToNode(state)));
            let choice = drawn.recording.trace().tree.get(state as usize).and_then(|node| node.choice);
            commands.send(Command::Select(selection_of(drawn.recording.network(), choice)));
        }
    }
}

/// Returns how a search is called on screen.
pub(crate) fn kind_name(kind: SearchKind) -> &'static str {
    match kind {
        SearchKind::Chronological => "Chronological",
        SearchKind::ConflictDirected => "Conflict-directed",
        SearchKind::BestFirst => "Best first",
    }
}

/// Returns what a search does, in a sentence.
fn kind_help(kind: SearchKind) -> &'static str {
    match kind {
        SearchKind::Chronological => "Undo the last choice after each failure",
        SearchKind::ConflictDirected => "Learn from each failure and jump back to its cause",
        SearchKind::BestFirst => "Expand the state with the best bound first (A*)",
    }
}

fn show_unrecorded(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    ui.vertical_centered(|ui| {
        ui.add_space(space::XL * 2.0);
        if context.state.settings.plan.trace {
            ui.label(RichText::new("No search recorded yet.").color(context.tokens.text_muted));
            return;
        }
        let text = "This search was not recorded. Record it to step through every decision and failure.";
        ui.label(RichText::new(text).color(context.tokens.text_muted));
        ui.add_space(space::M);
        if ui.button("Record search").clicked() {
            commands.send(Command::Settings(SettingsCommand::SetTrace(true)));
        }
    });
}
