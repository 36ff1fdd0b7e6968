//! The keys of people: one's own, those whose signatures count, and those that the history names and no one trusts yet.

use std::collections::{BTreeMap, BTreeSet};

use egui::{RichText, Ui};
use review::Signature;
use review::keys::{Person, PublicKey};
use theme::strong;
use workbench::command::{Command, CommandSender};
use workbench::state::keys::KeyChange;
use workbench::state::review::ReviewCommand;

use super::people::{People, indented};
use super::{header, row};
use crate::Context;

/// What is being asked about keys.
#[derive(Default)]
pub(super) struct Keys {
    /// The key that is to be removed once that is confirmed.
    removing: Option<PublicKey>,
}

impl Keys {
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        people: &mut People,
        closed: &mut BTreeSet<&'static str>,
        commands: &mut CommandSender,
    ) {
        let ring = context.state.keys.ring();
        let strangers = strangers(context);
        let mut note = format!("{} trusted", ring.people().len());
        if !strangers.is_empty() {
            note.push_str(&format!(", {} unknown", strangers.len()));
        }
        if !header(ui, context, closed, "Keys", None, &note) {
            return;
        }
        indented(ui, |ui| {
            row::muted_word(
                ui,
                "Enroute accepts signatures only from these people. Compare fingerprints before you trust a key.",
            );
            if let Some(reason) = context.state.keys.unkept() {
                let text = format!("Keys not saved: {reason}. Save your key to a file.");
                ui.label(RichText::new(text).color(context.tokens.error));
            }
        });
        for person in ring.people() {
            ui.push_id(person.key.as_str(), |ui| self.person(ui, person, commands));
        }
        for (key, name) in strangers {
            ui.push_id(key.as_str(), |ui| stranger(ui, context, &key, &name, commands));
        }
        indented(ui, |ui| {
            if ring.own().next().is_some() {
                people.new_key(ui, "Create another key", commands);
            }
            ui.horizontal_wrapped(|ui| {
                if ui.button("Save trusted keys…").clicked() {
                    commands.send(Command::Review(ReviewCommand::SaveKeys));
                }
                if ui.button("Add keys from file…").clicked() {
                    commands.send(Command::Review(ReviewCommand::OpenRecord));
                }
            });
        });
    }

    fn person(&mut self, ui: &mut Ui, person: &Person, commands: &mut CommandSender) {
        let is_own = person.secret.is_some();
        indented(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.label(strong(person.name.as_str()));
                let print = ui.label(RichText::new(person.key.fingerprint()).monospace());
                print.on_hover_text(person.key.as_str());
                if is_own {
                    row::muted_word(ui, "(your key)");
                }
                let named = |label: &str| format!("{label} {}", person.name);
                if is_own && ui.button("Save key…").accessible_name(named("Save key…")).clicked() {
                    commands.send(Command::Review(ReviewCommand::SaveOwnKey(person.name.clone())));
                }
                if self.removing.as_ref() != Some(&person.key) {
                    if ui.button("Remove…").accessible_name(named("Remove…")).clicked() {
                        self.removing = Some(person.key.clone());
                    }
                    return;
                }
                let warning = if is_own {
                    "If you have no saved file, this key can never sign again."
                } else {
                    "Signatures of this key no longer count."
                };
                row::muted_word(ui, warning);
                if ui.button("Remove key").accessible_name(named("Remove key")).clicked() {
                    let change = KeyChange::Remove(person.key.clone());
                    commands.send(Command::Review(ReviewCommand::ChangeKeys(change)));
                    self.removing = None;
                }
                if ui.button("Cancel").clicked() {
                    self.removing = None;
                }
            });
        });
    }
}

/// The keys that have signed entries of the history and that no one trusts here, with the names that the entries give.
fn strangers(context: &Context<'_>) -> BTreeMap<PublicKey, String> {
    let unknown =
        context.state.review.record().checked().filter(|(_, check)| check.signature == Signature::Unknown);
    unknown.filter_map(|(entry, _)| Some((entry.key.clone()?, entry.by.clone()))).collect()
}

fn stranger(ui: &mut Ui, context: &Context<'_>, key: &PublicKey, name: &str, commands: &mut CommandSender) {
    let person = Person { name: name.to_owned(), key: key.clone(), secret: None };
    let refused = context.state.keys.ring().clone().add(person.clone()).err();
    indented(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(format!("“{name}”, unknown key")).color(context.tokens.warning));
            ui.label(RichText::new(key.fingerprint()).monospace()).on_hover_text(key.as_str());
            let button = ui.add_enabled(refused.is_none(), egui::Button::new("Trust"));
            if button.accessible_name(format!("Trust {name}")).clicked() {
                let change = KeyChange::Add(vec![person]);
                commands.send(Command::Review(ReviewCommand::ChangeKeys(change)));
            }
        });
        if let Some(reason) = refused {
            row::muted(ui, context, &workbench::sentence(&format!("{reason}.")));
        }
    });
}
