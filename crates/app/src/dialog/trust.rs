//! Asks whether to trust the keys of a file.

use egui::{Button, Id, RichText, ScrollArea, Ui};
use panels::Context;
use review::keys::Person;
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::keys::KeyChange;
use workbench::state::review::ReviewCommand;
use workbench::state::window::WindowCommand;

/// Nothing can be trusted before this time.
const READING_SECONDS: f64 = 1.0;

/// The list of keys is at most this high.
const MAX_LIST_POINTS: f32 = 240.0;

/// Shows the question.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    file: &str,
    people: &[Person],
    commands: &mut CommandSender,
) {
    ui.set_width(420.0);
    let question = match people {
        [only] => format!("Trust the key of {} from {file}?", only.name),
        people => format!("Trust {} keys from {file}?", people.len()),
    };
    ui.label(question);
    ui.label(
        RichText::new("Approvals of these people will count. Compare each fingerprint with its owner first.")
            .color(context.tokens.text_muted),
    );
    ui.add_space(space::S);
    ScrollArea::vertical().max_height(MAX_LIST_POINTS).show(ui, |ui| {
        for person in people {
            ui.horizontal_wrapped(|ui| {
                ui.label(&person.name);
                ui.label(RichText::new(person.key.fingerprint()).monospace())
                    .on_hover_text(person.key.as_str());
                if person.secret.is_some() {
                    let words = "with its secret key: you will sign with it";
                    ui.label(RichText::new(words).color(context.tokens.warning));
                }
            });
        }
    });
    ui.add_space(space::S);
    let is_read = is_open_for_a_while(ui, people);
    let mut is_trusted = false;
    ui.horizontal(|ui| {
        let trust = ui.add_enabled(is_read, Button::new("Trust"));
        is_trusted = trust.clicked();
        let cancel = ui.button("Cancel");
        // Keys that were pressed for something else must not trust anyone.
        if !trust.has_focus() && !cancel.has_focus() {
            cancel.request_focus();
        }
        if cancel.clicked() {
            commands.send(Command::Window(WindowCommand::CloseDialog));
        }
    });
    if is_trusted {
        commands.send(Command::Window(WindowCommand::CloseDialog));
        commands.send(Command::Review(ReviewCommand::ChangeKeys(KeyChange::Add(people.to_vec()))));
    }
}

/// Returns whether these people have been shown for [`READING_SECONDS`], so that a click or a key that was meant for something
/// else trusts no one.
fn is_open_for_a_while(ui: &Ui, people: &[Person]) -> bool {
    let keys: Vec<&str> = people.iter().map(|person| person.key.as_str()).collect();
    let id = Id::unique(("trust", keys));
    let (now, frame) = (ui.input(|input| input.time), ui.ctx().cumulative_frame_nr());
    let (since, last_frame) = ui.data(|data| data.get_temp(id)).unwrap_or((now, frame));
    // The question may be asked a second time.
    let since = if frame > last_frame + 1 { now } else { since };
    ui.data_mut(|data| data.insert_temp(id, (since, frame)));
    let rest = READING_SECONDS - (now - since);
    if rest > 0.0 {
        ui.ctx().request_repaint_after_secs(rest as f32);
    }
    rest <= 0.0
}
