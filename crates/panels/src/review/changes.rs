//! What differs since the last approval: text, plan, checklist, rules and runs with chance.

use std::collections::BTreeSet;
use std::sync::Arc;

use egui::{RichText, Ui};
use review::record::Rate;
use review::since::TextChange;
use review::{Review, Since, since};
use snapshot::Snapshot;
use theme::strong;
use workbench::command::{Command, CommandSender};
use workbench::state::compare::CompareCommand;

use super::people::{indented, who};
use super::verdict::moment;
use super::{header, row};
use crate::Context;

/// What differs, worked out once for one approval and one review.
#[derive(Default)]
pub(super) struct Changes {
    made: Option<(Key, Since)>,
}

/// What tells what was compared: the approval, the mission, the review with its rules, and the runs.
struct Key {
    approval: String,
    /// A review that an undo brings back is there before its mission is.
    snapshot: Arc<Snapshot>,
    review: Arc<Review>,
    rate: Option<Rate>,
}

/// Entries of each kind that are listed; the report has all.
const MAX_LINES: usize = 30;

impl Changes {
    /// Shows what differs; nothing before an approval, and while the present content is not reviewed.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        closed: &mut BTreeSet<&'static str>,
        commands: &mut CommandSender,
    ) {
        let state = context.state;
        let approval = state.review.record().last_approval();
        let Some(((entry, approved), review)) = approval.zip(state.review.current()) else { return };
        let Some(snapshot) = context.snapshot.filter(|_| !context.is_stale) else { return };
        let found = state.robustness().map(AsRef::as_ref);
        let is_known = self.made.as_ref().is_some_and(|(key, _)| {
            key.approval == entry.digest()
                && Arc::ptr_eq(&key.snapshot, snapshot)
                && Arc::ptr_eq(&key.review, review)
                && key.rate == found.map(Rate::new)
        });
        if !is_known {
            // Holding the review keeps it from being changed in place.
            let (approval, review) = (entry.digest().to_owned(), Arc::clone(review));
            let made = since(approved, snapshot, &review, found);
            let (snapshot, rate) = (Arc::clone(snapshot), found.map(Rate::new));
            self.made = Some((Key { approval, snapshot, review, rate }, made));
        }
        let Some((_, since)) = &self.made else { return };
        let title = "Since the last approval";
        if !header(ui, context, closed, title, None, &note(since)) {
            return;
        }
        let by = format!("Approved by {}, {}.", who(entry), moment(&entry.time));
        row::muted(ui, context, &by);
        if since.is_nothing() {
            row::muted(ui, context, "No changes to text, plan, checklist, flight rules or Monte Carlo runs.");
            return;
        }
        indented(ui, |ui| {
            text(ui, context, &since.text, "and more (see the report)");
            plan(ui, context, since, commands);
            let lines: Vec<String> = since
                .lines
                .iter()
                .map(|line| {
                    let section = line.section().map(review::Section::title).unwrap_or_default();
                    format!("{section}: {}", line.sentence())
                })
                .collect();
            list(ui, context, "Checklist", &lines);
            let rules: Vec<String> =
                since.rules.iter().map(|[before, after]| format!("{before} → {after}")).collect();
            list(ui, context, "Flight rules", &rules);
            if let Some(rates) = since.robustness {
                let [before, after] = rates.map(rate);
                list(ui, context, "Robustness", &[format!("{before} → {after}")]);
            }
        });
    }
}

fn note(since: &Since) -> String {
    if since.is_nothing() {
        return "no differences".to_owned();
    }
    let plan = since.plan.as_ref().map_or(0, |plan| plan.differences.len());
    let parts = [("text", since.text.len()), ("plan", plan), ("checklist", since.lines.len())];
    let parts = parts.into_iter().filter(|(_, count)| *count > 0);
    let mut words: Vec<String> = parts.map(|(part, count)| format!("{part} {count}")).collect();
    words.extend((!since.rules.is_empty()).then(|| "rules".to_owned()));
    words.extend(since.robustness.map(|_| "robustness".to_owned()));
    words.join(", ")
}

/// The places at which two texts differ; `more` says where the others are, of many.
pub(crate) fn text(ui: &mut Ui, context: &Context<'_>, changes: &[TextChange], more: &str) {
    if changes.is_empty() {
        return;
    }
    let tokens = context.tokens;
    ui.label(strong("Text").color(tokens.text));
    let mut left = MAX_LINES;
    for change in changes {
        let place = format!("line {}", change.after_line);
        if left > 0 {
            ui.label(RichText::new(place).small().color(tokens.text_muted));
        }
        let removed = change.removed.iter().map(|line| (line, "−", tokens.error));
        let added = change.added.iter().map(|line| (line, "+", tokens.good));
        for (line, sign, color) in removed.chain(added) {
            if left > 0 {
                left -= 1;
                ui.label(RichText::new(format!("{sign} {line}")).monospace().color(color));
            }
        }
    }
    if left == 0 {
        row::muted_word(ui, more);
    }
}

fn plan(ui: &mut Ui, context: &Context<'_>, since: &Since, commands: &mut CommandSender) {
    match &since.plan {
        None => list(ui, context, "Plan", &["the approved plan was not saved".to_owned()]),
        Some(plan) if plan.is_same() => {}
        Some(plan) => {
            let lines: Vec<String> =
                plan.differences.iter().map(review::compare::Difference::sentence).collect();
            list(ui, context, &format!("Plan: {}", plan.summary()), &lines);
            if ui.button("Compare plans").clicked() {
                commands.send(Command::Compare(CompareCommand::WithApproved));
            }
        }
    }
}

fn list(ui: &mut Ui, context: &Context<'_>, title: &str, lines: &[String]) {
    if lines.is_empty() {
        return;
    }
    ui.label(strong(title).color(context.tokens.text));
    for line in lines.iter().take(MAX_LINES) {
        ui.label(RichText::new(workbench::sentence(line)).color(context.tokens.text));
    }
    if lines.len() > MAX_LINES {
        row::muted_word(ui, &format!("and {} more (see the report)", lines.len() - MAX_LINES));
    }
}

fn rate(rate: Option<Rate>) -> String {
    match rate {
        Some(rate) => format!("{} of {} runs (seed {})", rate.succeeded, rate.runs, rate.seed),
        None => "no runs".to_owned(),
    }
}
