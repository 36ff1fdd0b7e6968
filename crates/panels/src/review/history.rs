//! The history of the review: who did what about which content, who took it back, and its way into files.

use std::collections::BTreeSet;

use egui::{Button, Frame, Margin, RichText, TextStyle, Ui};
use review::record::{Act, Entry, short};
use review::{Check, Signature};
use theme::icon::{self, Icon};
use theme::{space, strong};
use workbench::command::{Command, CommandSender};
use workbench::state::review::ReviewCommand;

use super::people::{indented, who};
use super::verdict::moment;
use super::{header, row};
use crate::{Context, inline_code};

/// The last entries are all listed, and earlier ones if they do not count; a file has all.
const MAX_ENTRIES: usize = 60;

/// Entries that are listed, at most.
const MAX_LISTED: usize = 500;

/// Shows the history, the last entry first.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    closed: &mut BTreeSet<&'static str>,
    commands: &mut CommandSender,
) {
    let review = &context.state.review;
    if let Some(reason) = review.unkept() {
        let text = format!("{reason}. Save the history to a file before you close this window.");
        let save = ("Save to file", ReviewCommand::SaveRecord);
        warning(ui, context, "Review history not saved", &text, save, commands);
    }
    if let Some(aside) = review.aside() {
        let text = format!("{}. A copy was set aside.", aside.reason);
        let save = ("Save copy to file", ReviewCommand::SaveAside);
        warning(ui, context, "Couldn't read a review of this mission", &text, save, commands);
    }
    let record = review.record();
    let entries = record.entries();
    let note = match entries.len() {
        0 => "no entries".to_owned(),
        1 => "1 entry".to_owned(),
        count => format!("{count} entries"),
    };
    if !header(ui, context, closed, "History", None, &note) {
        return;
    }
    let withdrawn = record.withdrawn();
    let doubtful = record.checked().filter(|(_, check)| !check.counts()).count();
    if doubtful > 0 {
        let one = if doubtful == 1 { "entry does" } else { "entries do" };
        row::muted(ui, context, &format!("{doubtful} {one} not count. See the reason next to each."));
    }
    let checked: Vec<(&Entry, &Check)> = record.checked().collect();
    // An entry that does not count is not pushed out of sight by others.
    let is_listed = |(index, (_, check)): &(usize, &(&Entry, &Check))| {
        index + MAX_ENTRIES >= checked.len() || !check.counts()
    };
    let listed = checked.iter().enumerate().rev().filter(is_listed);
    for (index, &(entry, check)) in listed.take(MAX_LISTED) {
        let taken_back = withdrawn.get(entry.digest()).map(|by| format!("withdrawn by {}", who(by)));
        let of = entry.act.of().map(|of| format!(" {}", record.number(of))).unwrap_or_default();
        show_entry(ui, context, (entry, check), &format!("{}  ", index + 1), &of, taken_back);
    }
    if entries.len() > MAX_ENTRIES {
        row::muted(ui, context, "See the file or the report for earlier entries.");
    }
    indented(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            let save = ui.add_enabled(!record.is_empty(), Button::new("Save to file…"));
            if save.on_hover_text("Save the history with its digests as JSON").clicked() {
                commands.send(Command::Review(ReviewCommand::SaveRecord));
            }
            let open = ui.button("Merge from file…");
            if open.on_hover_text("Verify a history file and merge it into this one").clicked() {
                commands.send(Command::Review(ReviewCommand::OpenRecord));
            }
        });
    });
}

fn show_entry(
    ui: &mut Ui,
    context: &Context<'_>,
    (entry, check): (&Entry, &Check),
    number: &str,
    of: &str,
    taken_back: Option<String>,
) {
    let tokens = context.tokens;
    indented(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(number).small().color(tokens.text_muted));
            let done = format!("{} {}{of}", who(entry), entry.act.name());
            let done = strong(done).color(tokens.text);
            ui.label(if taken_back.is_some() { done.strikethrough() } else { done });
            // Rules are not about one content.
            let is_stale = context.state.review.hash() != Some(entry.content_hash.as_str())
                && !matches!(entry.act, Act::Rules { .. });
            let about = if is_stale { ", other content" } else { "" };
            let when = format!("{}{about}", moment(&entry.time));
            let label = ui.label(RichText::new(when).small().color(tokens.text_muted));
            label.on_hover_text(format!(
                "Content {}…\nPlan {}…\nEntry {}…",
                short(&entry.content_hash),
                short(&entry.plan_hash),
                short(entry.digest())
            ));
            let record = context.state.review.record();
            let (sign, color) = match check.signature {
                _ if record.without_effect(entry).is_some() => (Icon::Warning, tokens.warning),
                _ if check.counts() => (Icon::Check, tokens.good),
                Signature::Broken => (Icon::Error, tokens.error),
                Signature::Valid | Signature::Unknown | Signature::Unsigned => {
                    (Icon::Warning, tokens.warning)
                }
            };
            icon::label(ui, sign, color);
            ui.label(RichText::new(record.words_of(entry, check)).small().color(color));
            if let Some(taken_back) = taken_back {
                ui.label(RichText::new(taken_back).small().color(tokens.warning));
            }
        });
        let words = match &entry.act {
            Act::Acknowledge { line, text } => {
                format!("{}\nReason: {text}", workbench::sentence(&line.text))
            }
            Act::Waive { line, text, until } => {
                format!("{}\nReason: {text} (until {until})", workbench::sentence(&line.text))
            }
            act => act.text().to_owned(),
        };
        if !words.is_empty() {
            let font = TextStyle::Body.resolve(ui.style());
            ui.label(inline_code::job(&words, &font, tokens.text_muted, ui.available_width()));
        }
    });
}

/// Says that something could be lost, and offers to save it.
fn warning(
    ui: &mut Ui,
    context: &Context<'_>,
    title: &str,
    text: &str,
    (label, save): (&str, ReviewCommand),
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    ui.add_space(space::S);
    let frame = Frame::new().fill(tokens.soft[2]).corner_radius(6.0).inner_margin(Margin::symmetric(10, 8));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            icon::label(ui, Icon::Warning, tokens.error);
            ui.label(strong(title).color(tokens.error));
        });
        ui.label(RichText::new(workbench::sentence(text)).color(tokens.text));
        if ui.button(label).clicked() {
            commands.send(Command::Review(save));
        }
    });
}
