//! The conflicts of the last step as sets of assumptions, and the hitting-set tree that a student builds over them.

use egui::accesskit::Role;
use egui::{Button, Frame, Margin, RichText, Ui};
use plant::hitting_sets::{HittingLabel, HittingMove};
use plant::{Conflict, Model};
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::{AutomatonCommand, PlantMoment};
use workbench::state::diagnosing::{
    Diagnosing, conflict_text, label_text, observations_text, refusal_text, set_text,
};

use super::title;
use crate::{Context, counted};

/// From a node to its children, in points.
const INDENT: f32 = 16.0;

/// The conflicts of the last step, in the order in which they are numbered.
pub(super) fn conflicts<'a>(context: &Context<'a>, plant: &'a PlantMoment) -> &'a [Conflict] {
    match (context.state.automaton.diagnosing(), &plant.record) {
        (Some(diagnosing), _) => diagnosing.tree().conflicts(),
        (None, Some(record)) => &record.conflicts,
        (None, None) => &[],
    }
}

/// Lists the conflicts, and shows the tree if it was started.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    model: &Model,
    plant: &PlantMoment,
    commands: &mut CommandSender,
) {
    if plant.record.as_ref().is_none_or(|record| record.conflicts.is_empty()) {
        return;
    }
    let tokens = context.tokens;
    let diagnosing = context.state.automaton.diagnosing();
    let conflicts = conflicts(context, plant);
    title(ui, context, "Conflicts", "sets of assumptions that can't all hold");
    for (at, conflict) in conflicts.iter().enumerate() {
        let text = format!("{}. {}", at + 1, conflict_text(model, conflict));
        ui.add(egui::Label::new(RichText::new(text).color(tokens.warning)).wrap());
        let observed = observations_text(model, conflict);
        if !observed.is_empty() {
            let text = RichText::new(format!("contradicted by {observed}")).small().color(tokens.text_muted);
            ui.add(egui::Label::new(text).wrap());
        }
    }
    title(ui, context, "Diagnoses", "minimal sets with an assumption of every conflict");
    let Some(diagnosing) = diagnosing else {
        let begin = ui.button("Build hitting-set tree");
        if begin.on_hover_text("Find the diagnoses step by step").clicked() {
            commands.send(Command::Automaton(AutomatonCommand::StartDiagnosis));
        }
        return;
    };
    ui.scope(|ui| {
        theme::structure::part(ui, Role::Tree, "Hitting-set tree");
        for at in depth_first(diagnosing) {
            node(ui, context, model, diagnosing, at, commands);
        }
    });
    result(ui, context, model, plant, diagnosing);
    ui.horizontal_wrapped(|ui| {
        let next = ui.add_enabled(!diagnosing.tree().is_finished(), Button::new("Do next step"));
        if next.on_hover_text("Continue level by level").clicked() {
            commands.send(Command::Automaton(AutomatonCommand::DiagnoseNext(false)));
        }
        if ui.button("Restart tree").clicked() {
            commands.send(Command::Automaton(AutomatonCommand::StartDiagnosis));
        }
    });
}

/// The nodes, each before those below it.
fn depth_first(diagnosing: &Diagnosing) -> Vec<usize> {
    let nodes = diagnosing.tree().nodes();
    let mut order = Vec::with_capacity(nodes.len());
    let mut pending = vec![0];
    while let Some(at) = pending.pop() {
        order.push(at);
        pending.extend((0..nodes.len()).rev().filter(|&child| nodes[child].parent == Some(at)));
    }
    order
}

/// A node: which assumptions are no longer made there, what became of it, and what an open one can become.
fn node(
    ui: &mut Ui,
    context: &Context<'_>,
    model: &Model,
    diagnosing: &Diagnosing,
    at: usize,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let tree = diagnosing.tree();
    let Some(node) = tree.nodes().get(at) else { return };
    let path =
        if node.without.is_empty() { "all assumed".to_owned() } else { set_text(model, &node.without) };
    let color = match node.label {
        HittingLabel::Open => tokens.text,
        HittingLabel::Conflict(_) => tokens.warning,
        HittingLabel::Diagnosis => tokens.good,
        HittingLabel::Closed { .. } => tokens.text_muted,
    };
    let name = format!("{path}: {}", label_text(model, tree, node.label));
    let mut send = |step: HittingMove| {
        commands.send(Command::Automaton(AutomatonCommand::Diagnose(at, step)));
    };
    let margin = Margin { left: (INDENT * node.without.len() as f32).min(96.0) as i8, ..Margin::ZERO };
    Frame::new().inner_margin(margin).show(ui, |ui| {
        item(ui, diagnosing, at, &name);
        ui.add(egui::Label::new(RichText::new(&name).color(color)).wrap());
        if node.label != HittingLabel::Open {
            return;
        }
        ui.horizontal_wrapped(|ui| {
            let mut button = |ui: &mut Ui, text: String, step: HittingMove| {
                let response = ui.button(&text);
                response.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, true, format!("{text}: {path}"))
                });
                if response.clicked() {
                    send(step);
                }
            };
            for conflict in 0..tree.conflicts().len() {
                button(ui, format!("Conflict {}", conflict + 1), HittingMove::Expand(conflict));
            }
            button(ui, "Diagnosis".to_owned(), HittingMove::Diagnose);
            button(ui, "Close".to_owned(), HittingMove::Close);
        });
        if let Some((_, refusal)) = diagnosing.refused().filter(|(node, _)| *node == at) {
            let text = refusal_text(model, tree, refusal);
            ui.add(egui::Label::new(RichText::new(text).color(tokens.error)).wrap());
        }
    });
    ui.add_space(space::XS);
}

/// Marks `ui` as an item of the tree: with its level, and its place among the children of the same node.
fn item(ui: &Ui, diagnosing: &Diagnosing, at: usize, name: &str) {
    let nodes = diagnosing.tree().nodes();
    let node = &nodes[at];
    let beside = (0..nodes.len()).filter(|&it| nodes[it].parent == node.parent).collect::<Vec<_>>();
    let has_children = nodes.iter().any(|it| it.parent == Some(at));
    theme::structure::part(ui, Role::TreeItem, name);
    ui.ctx().accesskit_node_builder(ui.unique_id(), |item| {
        item.set_level(node.without.len() + 1);
        item.set_position_in_set(beside.iter().position(|&it| it == at).unwrap_or_default());
        item.set_size_of_set(beside.len());
        if has_children {
            item.set_expanded(true);
        }
    });
}

/// What the tree came to, and whether the estimate agrees.
fn result(ui: &mut Ui, context: &Context<'_>, model: &Model, plant: &PlantMoment, diagnosing: &Diagnosing) {
    let tree = diagnosing.tree();
    if !tree.is_finished() {
        return;
    }
    let agreement = diagnosing.agreement(model, &plant.belief);
    for ((_, set), probability) in tree.diagnoses().zip(&agreement.probabilities) {
        let share = super::components::percent(*probability);
        let text = format!("{} alone: {share} of the estimate", set_text(model, set));
        ui.label(RichText::new(text).color(context.tokens.good));
    }
    let (states, explained) = (agreement.states, agreement.explained);
    let text = if states == explained {
        let states = counted(states as u64, "state");
        format!("The estimator agrees: {states}, and each includes a diagnosis.")
    } else {
        format!(
            "The estimator disagrees: {}, of which {} without a diagnosis.",
            counted(states as u64, "state"),
            states - explained
        )
    };
    ui.add(egui::Label::new(RichText::new(text).color(context.tokens.text_muted)).wrap());
}
