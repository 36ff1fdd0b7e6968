//! The head of the review: what it comes to, whether it is stale, and how the plan stands with its board.

use std::sync::Arc;

use egui::{Frame, Margin, RichText, Ui};
use review::{PlanStatus, Review, Standing, Status};
use theme::icon::{self, Icon};
use theme::{space, strong};
use workbench::command::{Command, CommandSender};
use workbench::state;
use workbench::state::review::ReviewCommand;
use workbench::state::search::SearchCommand;
use workbench::state::window::WindowCommand;

use super::people::{People, who};
use super::{contradict, status_look};
use crate::Context;

/// Characters of the hash that are shown.
const HASH_LENGTH: usize = 12;

/// Shows the head.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    shown: Option<(&Arc<Review>, bool)>,
    standing: Option<&Standing<'_>>,
    people: &mut People,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let [good, warning, error, info] = tokens.soft;
    let (sign, color, fill, title) = match shown {
        None if context.state.review.is_running() => {
            (Icon::Working, tokens.info, info, "Reviewing…".to_owned())
        }
        None => (Icon::Nothing, tokens.info, info, "Not reviewed yet".to_owned()),
        Some((_, true)) => (Icon::Warning, tokens.warning, warning, "Out of date".to_owned()),
        Some((review, false)) => {
            let (sign, _, color) = status_look(tokens, review.status, false);
            let fill = match review.status {
                Status::Information | Status::Passed => good,
                Status::Attention => warning,
                Status::Failed => error,
            };
            (sign, color, fill, title(review))
        }
    };
    Frame::new().fill(fill).corner_radius(6.0).inner_margin(Margin::symmetric(10, 8)).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            icon::label(ui, sign, color);
            ui.label(strong(title).color(color));
        });
        if let Some((review, is_stale)) = shown {
            if is_stale {
                let text = if context.state.status() == state::Status::Broken {
                    "The text has errors. This review covers the last valid version, not the current text."
                } else if context.state.review.hash() == Some(review.content_hash.as_str()) {
                    "This review covers a different plan of the same text. Review again to check the \
                     current plan."
                } else {
                    "The text, the map or the seed changed after this review. Review again, or undo the \
                     change."
                };
                ui.label(RichText::new(text).color(tokens.text));
            }
            let [passed, attention, failed] = review.counts();
            let had = if is_stale { "Previously: " } else { "" };
            let need = if attention == 1 { "needs" } else { "need" };
            let information = review.count(Status::Information);
            let counts = format!(
                "{had}{passed} passed, {attention} {need} attention, {failed} failed; {information} informational"
            );
            ui.label(RichText::new(counts).color(tokens.text));
            if !is_stale {
                step(ui, context, commands);
            }
            content(ui, context, review, commands);
        } else {
            let text = "All items are computed from the plan.";
            ui.label(RichText::new(text).color(tokens.text_muted));
        }
        ui.add_space(space::XS);
        if let Some(standing) = standing {
            board(ui, context, standing);
        }
        people.identity(ui, context, commands);
        ui.add_space(space::S);
        buttons(ui, context, shown, commands);
        if let Some((review, false)) = shown {
            contradict::all(ui, context, review, commands);
        }
    });
}

fn title(review: &Review) -> String {
    let [_, attention, failed] = review.counts();
    match review.status {
        Status::Information | Status::Passed => "All checks passed".to_owned(),
        Status::Attention if attention == 1 => "1 item needs attention".to_owned(),
        Status::Attention => format!("{attention} items need attention"),
        Status::Failed if failed == 1 => "1 check failed".to_owned(),
        Status::Failed => format!("{failed} checks failed"),
    }
}

/// Says that the drawings beside the review show a step of the search, and not the plan that was reviewed.
fn step(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let Some(view) = context.step() else { return };
    let tokens = context.tokens;
    let step = view.step.step + 1;
    ui.horizontal_wrapped(|ui| {
        icon::label(ui, Icon::Warning, tokens.warning);
        let text = format!("The panels show step {step} of the search, not the reviewed plan.");
        ui.label(RichText::new(text).color(tokens.text));
        if ui.button("Show plan").clicked() {
            commands.send(Command::Search(SearchCommand::Close));
        }
    });
}

/// The hash of what was reviewed; a click copies it.
fn content(ui: &mut Ui, context: &Context<'_>, review: &Review, commands: &mut CommandSender) {
    let hash = &review.content_hash;
    let short = hash.get(..HASH_LENGTH).unwrap_or(hash);
    let text = RichText::new(format!("Content {short}…")).small().color(context.tokens.text_muted);
    let label = ui.add(egui::Button::new(text).frame(false));
    let label = label.on_hover_text(format!("SHA-256 of text, map and seed. Click to copy.\n{hash}"));
    if label.accessible_name("Copy content hash").clicked() {
        commands.send(Command::Window(WindowCommand::Copy(hash.clone())));
    }
}

/// How the plan stands with its board.
fn board(ui: &mut Ui, context: &Context<'_>, standing: &Standing<'_>) {
    let tokens = context.tokens;
    let (sign, color) = match standing.status {
        PlanStatus::Draft => (Icon::Nothing, tokens.text_muted),
        PlanStatus::InReview => (Icon::Info, tokens.info),
        PlanStatus::Approved => (Icon::Check, tokens.good),
        PlanStatus::ApprovedWithComments => (Icon::Check, tokens.warning),
        PlanStatus::Lapsed => (Icon::Warning, tokens.warning),
    };
    ui.horizontal_wrapped(|ui| {
        icon::label(ui, sign, color);
        ui.label(strong(format!("Plan: {}", standing.status.name())).color(color));
        ui.label(RichText::new(format!("Approvals: {}", standing.seats_in_words())).color(tokens.text));
    });
    if let (PlanStatus::Lapsed, Some((last, why))) = (standing.status, standing.lapsed) {
        let text = format!("{} approved this plan on {}. Since then, {why}.", who(last), moment(&last.time));
        ui.label(RichText::new(text).color(tokens.text));
    }
}

fn buttons(
    ui: &mut Ui,
    context: &Context<'_>,
    shown: Option<(&Arc<Review>, bool)>,
    commands: &mut CommandSender,
) {
    ui.horizontal_wrapped(|ui| {
        let is_running = context.state.review.is_running();
        let is_current = shown.is_some_and(|(_, is_stale)| !is_stale);
        let text = match (is_running, shown) {
            (true, _) => "Reviewing…",
            (false, None) => "Review",
            (false, Some(_)) => "Review again",
        };
        if !is_current && ui.add_enabled(!is_running, egui::Button::new(text)).clicked() {
            commands.send(Command::Review(ReviewCommand::Run));
        }
        if ui.button("Write report").clicked() {
            commands.send(Command::WriteReport);
        }
    });
}

/// `2026-01-02T03:04:05Z` as `2026-01-02 03:04 UTC`; another text as it is.
pub(super) fn moment(time: &str) -> String {
    match (time.get(..10), time.get(11..16), time.ends_with('Z')) {
        (Some(day), Some(minute), true) => format!("{day} {minute} UTC"),
        _ => time.to_owned(),
    }
}
