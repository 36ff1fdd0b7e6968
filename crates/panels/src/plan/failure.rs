//! Why there is no plan: the smallest changes that would give one, and a reason per group of choices.

use egui::{Frame, Margin, RichText, Stroke, Ui};
use kirk::{Failure, FailureKind, GAP_LABEL, Reason, Status};
use rmpl::{Edit, Span};
use snapshot::Planning;
use text_editing::EditKind;
use theme::icon::{self, Icon};
use theme::space;
use tpn::Network;
use workbench::command::{Command, CommandSender};
use workbench::state::editor::EditorCommand;

use crate::Context;
use crate::plan::section;
use workbench::sentence;

/// Shows why there is no plan.
pub(crate) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    planning: &Planning,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let verdict = match planning.undecided() {
        Some(why) => format!("{}.", sentence(why)),
        None if planning.outcome.status == Status::Error => {
            "A time in this mission is too large to represent exactly.".to_owned()
        }
        None => "This mission has no plan.".to_owned(),
    };
    ui.horizontal(|ui| {
        icon::label(ui, Icon::Error, tokens.error);
        ui.label(theme::strong(verdict).color(tokens.error));
    });
    if let Some(message) = planning.outcome.unplannable_message(network) {
        ui.label(RichText::new(message).color(tokens.text_muted));
    }
    let Some(failure) = &planning.outcome.failure else { return };
    show_fixes(ui, context, planning, failure, commands);
    for (index, reason) in failure.reasons.iter().enumerate() {
        ui.push_id(index, |ui| show_reason(ui, context, network, (index, reason), commands));
    }
    if !failure.is_complete {
        let note = "All combinations of choices fail (too many to list).";
        ui.label(RichText::new(note).color(tokens.text_muted));
    }
}

/// A change of the text that gives a plan.
struct Offer<'a> {
    label: &'a str,
    /// The edits; `None` for the gap, whose fix reads the whole text when it is applied, and where no edit does it.
    edits: Option<Vec<Edit>>,
    /// The place in the text that the change is about.
    span: Option<Span>,
    is_of_gap: bool,
}

/// The fixes, above all reasons: first those of what was edited last.
fn show_fixes(
    ui: &mut Ui,
    context: &Context<'_>,
    planning: &Planning,
    failure: &Failure,
    commands: &mut CommandSender,
) {
    let source = context.snapshot.map(|snapshot| snapshot.source.as_ref()).unwrap_or_default();
    let gap = Offer { label: GAP_LABEL, edits: None, span: None, is_of_gap: true };
    let repairs = planning.repairs.iter().map(|repair| Offer {
        label: &repair.label,
        edits: Some(repair.edits.clone()),
        span: repair.edits.first().map(|edit| edit.span),
        is_of_gap: false,
    });
    let relaxations = failure.relaxations.iter().map(|relaxation| Offer {
        label: &relaxation.label,
        edits: relaxation.fix(source).map(|fix| fix.edits),
        span: relaxation.span,
        is_of_gap: false,
    });
    let mut offers: Vec<Offer<'_>> =
        failure.is_of_gap.then_some(gap).into_iter().chain(repairs).chain(relaxations).collect();
    if offers.is_empty() {
        return;
    }
    let edited = last_edited(context);
    offers.sort_by_key(|offer| !offer.span.zip(edited).is_some_and(|(span, edited)| meet(span, edited)));
    section(ui, context, "Suggested fixes", "Apply any one; Enroute verified each");
    for offer in offers {
        ui.horizontal(|ui| {
            icon::label(ui, Icon::Fix, context.tokens.accent);
            let can_apply = (offer.is_of_gap || offer.edits.is_some()) && !context.is_stale;
            let button = ui.add_enabled(can_apply, egui::Button::new(sentence(offer.label)).wrap());
            let button = button.accessible_name(format!("Fix: {}", offer.label));
            // The gap's fix reads the whole text, so it is only computed when it is applied.
            if button.clicked()
                && let Some(edits) = offer.edits.or_else(|| failure.gap_fix(source).map(|fix| fix.edits))
            {
                commands.send(Command::Edit { edits, kind: EditKind::Single });
            }
            if let Some(span) = offer.span
                && ui.add(egui::Button::new("Show").frame_when_inactive(false)).clicked()
            {
                commands.send(Command::Reveal(span));
                commands.send(Command::Editor(EditorCommand::Focus));
            }
        });
    }
}

/// Returns where the present text was edited last.
fn last_edited(context: &Context<'_>) -> Option<Span> {
    let document = &context.state.document;
    let last = document.edits_since(document.revision().checked_sub(1)?)?.last()?;
    Some(Span::new(last.span.start, last.span.start + last.text.len() as u32))
}

fn meet(one: Span, other: Span) -> bool {
    one.start <= other.end && other.start <= one.end
}

fn show_reason(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    (index, reason): (usize, &Reason),
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let frame = Frame::new()
        .fill(tokens.raised)
        .stroke(Stroke::new(1.0, tokens.line))
        .corner_radius(6.0)
        .inner_margin(Margin::same(8));
    ui.add_space(space::S);
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        let kind = match reason.kind {
            FailureKind::Temporal => "Inconsistent bounds",
            FailureKind::OpenCondition => "Requirement without support",
            FailureKind::Threat => "Conflicting conditions overlap",
            FailureKind::Resource => "Not enough of a resource",
            FailureKind::Controllability => "Not controllable",
        };
        let choices: Vec<String> = reason
            .choices
            .iter()
            .map(|choice| network.alternative_name(choice.decision, choice.alternative))
            .collect();
        let heading = if choices.is_empty() {
            format!("{kind}, for every choice")
        } else {
            format!("{kind} with {}", choices.join(", "))
        };
        ui.label(RichText::new(heading).color(tokens.threat));
        ui.label(sentence(&reason.message));
        show_run(ui, context, network, reason);
        if !reason.cycle.is_empty() {
            show_cycle(ui, context, network, reason);
        }
        ui.horizontal_wrapped(|ui| {
            for (index, &span) in reason.spans.iter().enumerate() {
                let source = context.snapshot.and_then(|snapshot| snapshot.source.get(span.range()));
                let text = one_line(source.unwrap_or_default());
                let button = egui::Button::new(RichText::new(text).monospace().small()).truncate();
                let button = ui.add(button).accessible_name(format!("Go to source {}", index + 1));
                if button.clicked() {
                    commands.send(Command::Reveal(span));
                    commands.send(Command::Editor(EditorCommand::Focus));
                }
            }
            let is_shown = context.state.reason == index;
            let button = egui::Button::selectable(is_shown, RichText::new("Show on network").small());
            let hint = "Highlight the conflict on the network";
            if ui.add(button).on_hover_text(hint).clicked() {
                commands.send(Command::ShowReason(index));
            }
        });
    });
}

/// The run in which the environment makes it fail, event by event.
fn show_run(ui: &mut Ui, context: &Context<'_>, network: &Network, reason: &Reason) {
    let lines = reason.failing_run_in_words(network);
    let Some((end, lines)) = lines.split_last() else { return };
    let tokens = context.tokens;
    ui.add_space(space::XS);
    ui.label(theme::strong("Counterexample").small());
    for line in lines {
        let color = if line.contains(kirk::NATURE_ENDS) { tokens.nature } else { tokens.text_muted };
        ui.label(RichText::new(line).small().color(color));
    }
    ui.label(RichText::new(end).small().color(tokens.threat));
}

/// The contradiction as a sum: the steps of the cycle, which add up to less than zero.
fn show_cycle(ui: &mut Ui, context: &Context<'_>, network: &Network, reason: &Reason) {
    let tokens = context.tokens;
    egui::CollapsingHeader::new(RichText::new("Conflict, step by step").small()).id_salt("cycle").show(
        ui,
        |ui| {
            let total = exact::Time::checked_sum(reason.cycle.iter().map(|member| member.weight));
            for member in &reason.cycle {
                let step = format!(
                    "{} is at most {} after {}",
                    workbench::state::selection::node_name(network, member.to),
                    workbench::time_text::time(member.weight),
                    workbench::state::selection::node_name(network, member.from),
                );
                ui.label(RichText::new(network.readable(&step)).small().color(tokens.text_muted));
            }
            let sum = format!(
                "The sum around the cycle is {}, which is negative.",
                total.map_or_else(|| "a number too large to show".to_owned(), workbench::time_text::time)
            );
            ui.label(RichText::new(sum).small().color(tokens.threat));
        },
    );
}

/// A piece of text on one line, cut when it is long.
fn one_line(text: &str) -> String {
    const LONGEST: usize = 48;
    let words: Vec<&str> = text.split_whitespace().collect();
    let line = words.join(" ");
    if line.chars().count() <= LONGEST { line } else { line.chars().take(LONGEST).chain(['…']).collect() }
}
