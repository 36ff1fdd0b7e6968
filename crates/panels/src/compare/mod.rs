//! Two plans side by side: what differs by name, windows overlaid on one timeline, paths on one map.

mod list;
mod map;
mod timeline;

use std::sync::Arc;

use egui::{Frame, Margin, RichText, ScrollArea, Ui};
use review::compare::{Change, Comparison, Side, compare};
use review::since::{TextChange, text_changes};
use snapshot::Snapshot;
use theme::icon::Icon;
use theme::{Tokens, space, strong};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::compare::CompareCommand;

use crate::review::changes;
use crate::{Context, Panel};

/// The comparison.
#[derive(Default)]
pub struct ComparePanel {
    /// The last comparison, and what was compared.
    made: Option<Made>,
    /// Whether the timeline leaves out what does not differ.
    only_differences: bool,
}

struct Made {
    before: Arc<Side>,
    after: Arc<Snapshot>,
    comparison: Comparison,
    /// What was edited, where the text of the former plan is known.
    text: Vec<TextChange>,
}

impl Panel for ComparePanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            Frame::new().inner_margin(Margin::symmetric(10, 8)).show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = space::S;
                sources(ui, context, commands);
                let before = context.state.compare.reference();
                let Some((before, after)) = before.zip(context.snapshot) else {
                    self.made = None;
                    if context.state.compare.waiting().is_none() {
                        introduction(ui, context);
                    }
                    return;
                };
                self.compare(before, context.state.compare.text(), after);
                let Some(made) = &self.made else { return };
                legend(ui, context, before);
                if !before.is_planned || after.plan().is_none() {
                    let which = if before.is_planned { "The open mission" } else { &before.name };
                    ui.label(RichText::new(format!("{which} has no plan.")).color(context.tokens.warning));
                }
                summary(ui, context, &made.comparison);
                changes::text(ui, context, &made.text, "and more lines");
                ui.checkbox(&mut self.only_differences, "Show differences only");
                timeline::show(ui, context, &made.comparison, self.only_differences, commands);
                if !made.comparison.paths.is_empty() {
                    map::show(ui, context, &made.comparison);
                }
                list::show(ui, context, &made.comparison, commands);
            });
        });
    }
}

impl ComparePanel {
    /// Compares, unless the same two plans were compared last.
    fn compare(&mut self, before: &Arc<Side>, text: Option<&Arc<str>>, after: &Arc<Snapshot>) {
        let is_known = self
            .made
            .as_ref()
            .is_some_and(|made| Arc::ptr_eq(&made.before, before) && Arc::ptr_eq(&made.after, after));
        if !is_known {
            let comparison = compare(before, &Side::of_snapshot("the open mission", after));
            let text = text.map_or_else(Vec::new, |text| text_changes(text, &after.source));
            self.made = Some(Made { before: Arc::clone(before), after: Arc::clone(after), comparison, text });
        }
    }
}

/// What the open mission can be compared with.
fn sources(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let state = context.state;
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("Compare with").color(context.tokens.text_muted));
        let has_approval = state.review.record().last_approval().is_some();
        let approved = ui.add_enabled(has_approval, egui::Button::new("Last approval"));
        if approved.on_disabled_hover_text("this mission has no approval yet").clicked() {
            commands.send(Command::Compare(CompareCommand::WithApproved));
        }
        let file = ui.button("Choose file…").on_hover_text("Open a mission, saved plan or approved review");
        if file.clicked() {
            commands.send(Command::Compare(CompareCommand::OpenFile));
        }
        let has_plan = context.snapshot.is_some_and(|snapshot| snapshot.plan().is_some());
        let pin = ui.add_enabled(has_plan, egui::Button::new("Set as baseline"));
        if pin.on_hover_text("Compare later edits with this plan").clicked() {
            commands.send(Command::Compare(CompareCommand::Pin));
        }
        if state.compare.reference().is_some() && ui.button("Stop").clicked() {
            commands.send(Command::Compare(CompareCommand::Clear));
        }
    });
    if let Some(name) = state.compare.waiting() {
        ui.label(RichText::new(format!("Planning {name}…")).color(context.tokens.text_muted));
    }
}

fn introduction(ui: &mut Ui, context: &Context<'_>) {
    ui.add_space(space::L);
    ui.label(strong("Choose a plan to compare with").color(context.tokens.text));
    let text = "Choose the last approval, another mission or a saved plan, or set the current plan as \
                baseline. The panel lists what was added, removed, moved or chosen differently.";
    ui.label(RichText::new(text).color(context.tokens.text_muted));
}

/// Which bars and lines are whose.
fn legend(ui: &mut Ui, context: &Context<'_>, before: &Side) {
    let tokens = context.tokens;
    let entry = |ui: &mut Ui, is_after: bool, word: &str, name: &str| {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(egui::vec2(26.0, 12.0), egui::Sense::hover());
            timeline::sample(ui, context, rect, is_after);
            ui.label(strong(word).color(tokens.text));
            ui.add(egui::Label::new(RichText::new(name).color(tokens.text_muted)).truncate());
        });
    };
    let revision = context.state.document.revision();
    let now =
        if context.is_stale { "the open mission, without its latest edits" } else { "the open mission" };
    entry(ui, false, "Before", &before.name);
    entry(ui, true, "After", &format!("{now} (revision {revision})"));
}

fn summary(ui: &mut Ui, context: &Context<'_>, comparison: &Comparison) {
    let tokens = context.tokens;
    if comparison.is_same() {
        ui.horizontal(|ui| {
            theme::icon::label(ui, Icon::Check, tokens.good);
            ui.label(strong("The plans are identical").color(tokens.good));
        });
        return;
    }
    ui.horizontal_wrapped(|ui| {
        for (change, count) in Change::ALL.into_iter().zip(comparison.counts()) {
            if count > 0 {
                let (sign, color) = change_look(tokens, change);
                theme::icon::label(ui, sign, color);
                ui.label(strong(format!("{count} {}", change.name())).color(color));
                ui.add_space(space::S);
            }
        }
    });
}

/// The sign and the color of a change; the sign alone tells them apart.
fn change_look(tokens: &Tokens, change: Change) -> (Icon, egui::Color32) {
    match change {
        Change::Added => (Icon::Plus, tokens.good),
        Change::Removed => (Icon::Minus, tokens.error),
        Change::Moved => (Icon::Moved, tokens.info),
        Change::Rechosen => (Icon::Rechosen, tokens.warning),
        Change::Changed => (Icon::Changed, tokens.ask),
    }
}

/// Selects what is called so in the open mission.
fn select(context: &Context<'_>, name: &str, commands: &mut CommandSender) {
    if let Some(found) = context.snapshot.and_then(|snapshot| Selection::by_name(snapshot, name)) {
        commands.send(Command::SelectAndReveal(found));
    }
}
