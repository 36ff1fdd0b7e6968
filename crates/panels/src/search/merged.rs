//! The trees of both searches as one: what both entered is drawn once, and what one alone entered has lines of its own.

use std::collections::BTreeSet;

use egui::{Rect, RichText, Sense, Shape, Stroke, Ui, pos2, vec2};
use kirk::Search as SearchKind;
use kirk::{TreeChoice, TreeNodeId, TreeStatus};
use theme::space;
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::search::focus::selection_of;
use workbench::state::search::{MergedTree, Recording, SearchCommand, Share};
use workbench::state::window::WindowCommand;

use super::canvas::{self, Names, Pointed, Tree};
use super::kind_name;
use super::tree::{TreeDrawing, TreeIndex};
use crate::{Context, one_line};

/// The merged tree on screen, with what concerns only it.
#[derive(Default)]
pub struct MergedSide {
    drawn: Option<Drawn>,
    /// States that were folded or opened by hand: the other way round than they would be.
    toggled: BTreeSet<TreeNodeId>,
    view: canvas::View,
}

struct Drawn {
    recordings: [Recording; 2],
    tree: MergedTree,
    /// What is known of the states of the merged tree, and of each search's own.
    index: TreeIndex,
    own: [TreeIndex; 2],
    drawing: TreeDrawing,
    names: Names,
    toggled: BTreeSet<TreeNodeId>,
    folds_failed: bool,
}

/// What of a merged tree each search knows at its step.
#[derive(Clone, Copy)]
pub struct Merged<'a> {
    pub tree: &'a MergedTree,
    recordings: &'a [Recording; 2],
    own: &'a [TreeIndex; 2],
    /// The step of each search and its state in the merged tree, if one is looked at.
    pub steps: [Option<(usize, TreeNodeId)>; 2],
}

impl Merged<'_> {
    /// Returns whether either search knows a state at its step.
    pub fn is_known(&self, id: TreeNodeId) -> bool {
        let own = self.tree.own.get(id as usize).copied().unwrap_or_default();
        (0..2).any(|side| {
            let step = self.steps[side].map(|(step, _)| step);
            own[side].is_some_and(|id| self.own[side].is_known(id, step))
        })
    }

    /// The learned conflict that excludes a state in either search by its step.
    pub fn learned(&self, id: TreeNodeId) -> Option<&[TreeChoice]> {
        let own = self.tree.own.get(id as usize)?;
        (0..2).find_map(|side| {
            let step = self.steps[side].map(|(step, _)| step);
            let exclusion = self.own[side].exclusion(own[side]?, step)?;
            Some(exclusion.conflict(self.recordings[side].trace()))
        })
    }

    /// Returns what came of a state in whichever search has come furthest there by its step.
    pub fn status(&self, id: TreeNodeId) -> TreeStatus {
        let own = self.tree.own.get(id as usize).copied().unwrap_or_default();
        let known = (0..2).filter_map(|side| {
            let step = self.steps[side].map(|(step, _)| step);
            Some(self.own[side].status(self.recordings[side].trace(), own[side]?, step))
        });
        let order = [
            TreeStatus::Solution,
            TreeStatus::Failed,
            TreeStatus::Decision,
            TreeStatus::Excluded,
            TreeStatus::Unexplored,
        ];
        let known: Vec<TreeStatus> = known.collect();
        order.into_iter().find(|status| known.contains(status)).unwrap_or(TreeStatus::Unexplored)
    }
}

/// Lengths of a dash and of the gap behind it, in points, of lines to states that one search alone entered; a whole line
/// leads to those of both.
pub const fn dash(share: Share) -> Option<[f32; 2]> {
    match share {
        Share::Only(0) => Some([7.0, 4.0]),
        Share::Only(_) => Some([1.6, 3.2]),
        Share::Both | Share::Neither => None,
    }
}

impl MergedSide {
    /// Zooms, or shows what matters.
    pub fn follow(&mut self, action: ViewAction, room: Rect) {
        self.view.follow(action, room);
    }

    /// Shows the tree and what its lines mean. Returns which search and which of its states the pointer is over.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        recordings: &[Recording; 2],
        folds_failed: bool,
        commands: &mut CommandSender,
    ) -> Option<(usize, TreeNodeId)> {
        self.lay_out(recordings, folds_failed);
        let drawn = self.drawn.as_ref()?;
        legend(ui, context, drawn);
        let search = &context.state.search;
        let side = search.side().min(1);
        let steps = [0, 1].map(|side| {
            let step = &search.view(side)?.step;
            let here = drawn.tree.here[side].get(step.tree_node as usize)?;
            Some((step.step, *here))
        });
        let jump = search.step().and_then(|step| canvas::jump(recordings[side].trace(), step.step));
        let goal = drawn.tree.here[side].get(drawn.own[side].goal as usize).copied().unwrap_or(0);
        let tree = Tree {
            network: recordings[side].network(),
            trace: &drawn.tree.trace,
            index: &drawn.index,
            drawing: &drawn.drawing,
            names: &drawn.names,
            step: steps[side],
            goal,
            jump: jump.and_then(|to| drawn.tree.here[side].get(to as usize).copied()),
            name: "Both searches",
            merged: Some(Merged { tree: &drawn.tree, recordings, own: &drawn.own, steps }),
        };
        let pointed = self.view.show(ui, context, &tree);
        let hovered = pointed.hovered?;
        let own = drawn.tree.own.get(hovered as usize).copied().unwrap_or_default();
        // The search that is turned to, if the state is one of its own.
        let sides = [side, 1 - side];
        let (side, state) = sides.into_iter().find_map(|side| Some((side, own[side]?)))?;
        self.answer(pointed, hovered, (side, state), recordings, commands);
        Some((side, state))
    }

    /// The state of the other search that represents the same choices as `state` of `side`, while the two are merged.
    pub fn counterpart(&self, side: usize, state: TreeNodeId) -> Option<TreeNodeId> {
        let tree = &self.drawn.as_ref()?.tree;
        let here = *tree.here.get(side)?.get(state as usize)?;
        *tree.own.get(here as usize)?.get(1 - side)?
    }

    fn answer(
        &mut self,
        pointed: Pointed,
        hovered: TreeNodeId,
        (side, state): (usize, TreeNodeId),
        recordings: &[Recording; 2],
        commands: &mut CommandSender,
    ) {
        if pointed.toggled {
            if !self.toggled.remove(&hovered) {
                self.toggled.insert(hovered);
            }
        } else if pointed.clicked || pointed.chosen {
            commands.send(Command::Window(WindowCommand::Activate(PanelKind::Search)));
            commands.send(Command::Search(SearchCommand::Turn(side)));
            commands.send(Command::Search(SearchCommand::GoToNode(state)));
            let choice = recordings[side].trace().tree.get(state as usize).and_then(|node| node.choice);
            commands.send(Command::Select(selection_of(recordings[side].network(), choice)));
        }
    }

    fn lay_out(&mut self, recordings: &[Recording; 2], folds_failed: bool) {
        let is_same = |drawn: &Drawn| (0..2).all(|side| drawn.recordings[side].is(&recordings[side]));
        if !self.drawn.as_ref().is_some_and(is_same) {
            self.toggled.clear();
            self.view = canvas::View::default();
            let traces = [0, 1].map(|side| recordings[side].trace());
            let tree = MergedTree::new(traces);
            self.drawn = Some(Drawn {
                recordings: recordings.clone(),
                index: TreeIndex::new(&tree.trace),
                own: traces.map(TreeIndex::new),
                tree,
                drawing: TreeDrawing::default(),
                names: Names::default(),
                toggled: BTreeSet::new(),
                folds_failed,
            });
        }
        let Some(drawn) = &mut self.drawn else { return };
        let is_laid_out = !drawn.drawing.rows.is_empty()
            && drawn.toggled == self.toggled
            && drawn.folds_failed == folds_failed;
        if is_laid_out {
            return;
        }
        let index = &drawn.index;
        let folds = |id: TreeNodeId| {
            let is_folded = folds_failed && index.is_failed_subtree(id);
            is_folded != self.toggled.contains(&id)
        };
        drawn.drawing = TreeDrawing::new(index, &folds);
        drawn.toggled.clone_from(&self.toggled);
        drawn.folds_failed = folds_failed;
    }
}

/// How many states who entered, each beside the line that leads to them.
fn legend(ui: &mut Ui, context: &Context<'_>, drawn: &Drawn) {
    let tokens = context.tokens;
    let counts = drawn.tree.counts();
    let name = |side: usize| kind_name(drawn.recordings[side].kind().unwrap_or(SearchKind::Chronological));
    ui.horizontal_wrapped(|ui| {
        ui.add_space(space::S);
        ui.spacing_mut().item_spacing.x = space::S;
        ui.label(RichText::new("States entered").small().color(tokens.text_muted));
        for (share, text) in [
            (Share::Both, format!("both: {}", counts.both)),
            (Share::Only(0), format!("{} only: {}", name(0), counts.only[0])),
            (Share::Only(1), format!("{} only: {}", name(1), counts.only[1])),
        ] {
            let text = one_line::in_one_line(ui, RichText::new(text).small().color(tokens.text));
            if ui.available_size_before_wrap().x < space::L + 26.0 + space::S + text.size().x {
                ui.end_row();
            }
            // Nearer to its own words than to those before.
            ui.add_space(space::M);
            let (rect, _) = ui.allocate_exact_size(vec2(26.0, 14.0), Sense::hover());
            let line = [pos2(rect.left(), rect.center().y), pos2(rect.right(), rect.center().y)];
            ui.painter().extend(lines(&line, Stroke::new(1.8, color(context, share)), share));
            ui.label(text);
        }
    });
}

/// The color of lines to the states that a search entered.
pub fn color(context: &Context<'_>, share: Share) -> egui::Color32 {
    match share {
        // Not the first color, which is that of the way to the step.
        Share::Only(side) => context.tokens.series(side + 1),
        Share::Both | Share::Neither => context.tokens.text_faint,
    }
}

/// A line to a state of `share`: whole, or in the dashes of the search that alone entered it.
pub fn lines(points: &[egui::Pos2], stroke: Stroke, share: Share) -> Vec<Shape> {
    match dash(share) {
        Some([dash, gap]) => Shape::dashed_line(points, stroke, dash, gap),
        None => vec![Shape::line(points.to_vec(), stroke)],
    }
}
