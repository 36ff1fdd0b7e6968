//! What has happened, newest last; a row leads to its moment.

use egui::{RichText, ScrollArea, Ui};
use executive::{Entry, Happening};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::execution::has_come;
use workbench::state::playback::number;
use workbench::time_text;

use super::Shown;
use crate::Context;
use crate::plan::section;

/// Shows the log up to the time shown.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>, commands: &mut CommandSender) {
    let time = context.state.playback.time;
    // While a change is simulated, the end of the run is unknown.
    let is_open = context.state.execution.is_working();
    let is_known = |entry: &&Entry| !(is_open && matches!(entry.happening, Happening::Finished));
    let come = shown.run.log.iter().filter(|entry| has_come(entry.time, time));
    let seen: Vec<&Entry> = come.filter(is_known).collect();
    let vertices = |entry: &&&Entry| match &entry.happening {
        Happening::Executed { name } => !name.contains(".vertex"),
        _ => true,
    };
    let rows: Vec<&Entry> = seen.iter().filter(vertices).copied().collect();
    section(ui, context, "Log", &format!("{} of {} entries", seen.len(), shown.run.log.len()));
    ScrollArea::vertical().auto_shrink(false).stick_to_bottom(true).show(ui, |ui| {
        for entry in rows {
            row(ui, context, shown, entry, commands);
        }
    });
}

fn row(ui: &mut Ui, context: &Context<'_>, shown: Shown<'_>, entry: &Entry, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let (text, color) = match &entry.happening {
        Happening::Executed { name } => (name.to_string(), tokens.text),
        Happening::Progress { name, text } => (format!("{name}: {text}"), tokens.text_muted),
        Happening::State { .. } | Happening::Level { .. } => {
            (entry.happening.state_words().unwrap_or_default(), tokens.text_muted)
        }
        Happening::Violation { reason, .. } => (format!("✗ {reason}"), tokens.error),
        Happening::Replanned { changes } if changes.is_empty() => {
            ("→ replanned, same choices".to_owned(), tokens.warning)
        }
        Happening::Replanned { changes } => (format!("→ replanned: {}", changes.join(", ")), tokens.warning),
        Happening::Stopped { reason } => (format!("✗ stopped: {reason}"), tokens.error),
        Happening::Finished => ("✓ finished".to_owned(), tokens.good),
    };
    let text = shown.network.readable(&text);
    ui.horizontal(|ui| {
        let at = format!("{:>8}", time_text::short(entry.time).replace("≈ ", ""));
        ui.label(RichText::new(at).monospace().small().color(tokens.text_muted));
        let button = egui::Button::selectable(false, RichText::new(&text).small().color(color)).truncate();
        if ui.add(button).on_hover_text(&text).clicked() {
            commands.send(Command::Seek(number(entry.time)));
            if let Some(selection) = subject(shown, entry) {
                commands.send(Command::Select(selection));
            }
        }
    });
}

/// Returns what an entry is about.
fn subject(shown: Shown<'_>, entry: &Entry) -> Option<Selection> {
    let name = match &entry.happening {
        Happening::Executed { name } | Happening::Violation { name, .. } => {
            name.rsplit_once('.').map_or(name.as_str(), |(occurrence, _)| occurrence)
        }
        Happening::Progress { name, .. }
        | Happening::State { by: Some(name), .. }
        | Happening::Level { by: Some(name), .. } => name.as_str(),
        _ => return None,
    };
    let index = shown.network.occurrences.iter().position(|occurrence| occurrence.name == name)?;
    Some(Selection::Occurrence(tpn::OccurrenceId::from_index(index)))
}
