//! How the run stands: a line on top, then what is under way, what holds, what comes next and what is due.

use egui::{CornerRadius, Frame, Margin, RichText, Ui};
use executive::Ending;
use theme::icon::{self, Icon};
use theme::{space, strong};
use tpn::{OccurrenceId, OccurrenceKind};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::execution::{Pending, has_come};
use workbench::state::playback::number;
use workbench::time_text;

use super::{Shown, story};
use crate::Context;
use crate::plan::{section, selectable_row};

/// So many of the things to come are listed.
const MAX_LISTED: usize = 5;

/// Says in one line how the run stands, and what last broke the plan.
pub(super) fn banner(ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>) {
    let tokens = context.tokens;
    let time = context.state.playback.time;
    let last = || story::turns(shown.run, time).pop();
    let ((icon, color, fill), text, because) = if context.state.execution.is_working() {
        // The run that is drawn lacks the last disturbance.
        ((Icon::Working, tokens.info, tokens.soft[3]), "Simulating the change…".to_owned(), None)
    } else if let Some(last) = last() {
        (last.kind.look(tokens), last.text, last.because)
    } else {
        ((Icon::Play, tokens.info, tokens.soft[3]), "In progress".to_owned(), None)
    };
    let frame = Frame::new()
        .fill(fill)
        .corner_radius(CornerRadius::same(4))
        .inner_margin(Margin::symmetric(8, 4))
        .outer_margin(Margin::symmetric(8, 2));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            icon::label(ui, icon, color);
            ui.label(strong(text).color(tokens.text));
        });
        if let Some(because) = because {
            ui.label(RichText::new(because).small().color(tokens.text_muted));
        }
    });
}

/// Returns whether the mission has come to its end at the time shown.
fn is_finished(context: &Context<'_>, shown: Shown<'_>) -> bool {
    let is_over = shown.run.log.last().is_some_and(|last| {
        has_come(last.time, context.state.playback.time)
            && (shown.run.ending == Ending::Stopped || shown.moment.to_come.is_empty())
            && shown.moment.deadline.is_none_or(|_| shown.run.ending == Ending::Stopped)
    });
    is_over && shown.run.ending == Ending::Finished
}

/// What is due and what is under way.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>, commands: &mut CommandSender) {
    if is_finished(context, shown) {
        return;
    }
    due(ui, context, shown, commands);
    let moment = shown.moment;
    section(ui, context, "In progress", "");
    if moment.under_way.is_empty() {
        ui.label(RichText::new("No activity").color(context.tokens.text_muted));
    }
    for pending in moment.under_way.iter().chain(&moment.holding) {
        let window = time_text::interval(pending.window.earliest, pending.window.latest);
        let since = pending.since.map(time_text::short).unwrap_or_default();
        row(ui, context, shown, pending, &format!("since {since}, ends {window}"), commands);
    }
}

/// What comes next.
pub(super) fn upcoming(ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>, commands: &mut CommandSender) {
    let moment = shown.moment;
    if is_finished(context, shown) || moment.to_come.is_empty() {
        return;
    }
    section(ui, context, "Upcoming", "with start windows");
    for pending in moment.to_come.iter().take(MAX_LISTED) {
        let window = time_text::interval(pending.window.earliest, pending.window.latest);
        row(ui, context, shown, pending, &window, commands);
    }
    let rest = moment.to_come.len().saturating_sub(MAX_LISTED);
    if rest > 0 {
        ui.label(RichText::new(format!("and {rest} more")).small().color(context.tokens.text_muted));
    }
}

/// The next deadline.
fn due(ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>, commands: &mut CommandSender) {
    let Some((event, latest)) = shown.moment.deadline else { return };
    let left = number(latest) - context.state.playback.time;
    let note = if left >= 0.0 { format!("in {left:.1}") } else { "overdue".to_owned() };
    section(ui, context, "Next deadline", &note);
    let name = shown.network.readable(&shown.network.event_name(event));
    let text = RichText::new(format!("{name} by {}", time_text::short(latest)));
    selectable_row(ui, context, &Selection::Occurrence(event.occurrence), text, commands);
}

fn row(
    ui: &mut Ui,
    context: &Context<'_>,
    shown: Shown<'_>,
    pending: &Pending,
    note: &str,
    commands: &mut CommandSender,
) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::S;
        let name = words(shown, pending.occurrence);
        let selection = Selection::Occurrence(pending.occurrence);
        let is_selected = context.state.selection == selection;
        let button = egui::Button::selectable(is_selected, RichText::new(&name));
        if ui.add(button).clicked() {
            commands.send(Command::Select(selection));
        }
        let note = RichText::new(note).small().color(context.tokens.text_muted);
        ui.add(egui::Label::new(note).truncate());
    });
}

/// Returns what an occurrence is called where it is read: an activity with its arguments, or a condition.
pub(super) fn words(shown: Shown<'_>, id: OccurrenceId) -> String {
    let Some(occurrence) = shown.network.occurrences.get(id.index()) else { return String::new() };
    let condition = shown.network.labels.iter().find(|label| label.owner == Some(id));
    match condition.filter(|_| occurrence.kind == OccurrenceKind::Assertion) {
        Some(label) => label.text.to_string(),
        None => layout::text::activity_name(occurrence).to_string(),
    }
}

/// The name of an occurrence, which no other one has.
pub(super) fn name(shown: Shown<'_>, occurrence: OccurrenceId) -> String {
    let occurrence = shown.network.occurrences.get(occurrence.index());
    occurrence.map_or_else(String::new, |it| shown.network.readable(&it.name))
}
