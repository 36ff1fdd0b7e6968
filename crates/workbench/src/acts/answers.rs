//! What happened outside: answers of the planning core, and files.

use interchange::is_network_file;
use link::Response;
use review::keys::{KeyRing, Person};
use review::rules::RULES_FORMAT;
use text_editing::TextCommand;

use crate::command::Command;
use crate::dialog::Dialog;
use crate::effect::Effect;
use crate::host::{FileKind, HostEvent};
use crate::library::Mission;
use crate::limits::too_large;
use crate::state::AppState;
use crate::state::review::Waiting;

impl AppState {
    /// Takes in something that happened outside, and computes what depends on it.
    pub fn receive(&mut self, event: HostEvent) {
        self.take(event);
        self.derive();
    }

    fn take(&mut self, event: HostEvent) {
        match event {
            HostEvent::Answer(answer) => self.take_answer(answer),
            HostEvent::FragmentChanged(_)
            | HostEvent::Shelf(_)
            | HostEvent::TabSaid(_)
            | HostEvent::PrivateWindow => {}
            HostEvent::ClipboardRead(text) => {
                if !text.is_empty() {
                    self.apply(Command::Text(TextCommand::Paste(text.replace("\r\n", "\n"))));
                }
            }
            HostEvent::ClipboardRefused { reason } => self.window.failed(format!("Couldn't paste: {reason}")),
            HostEvent::CoreFailed { message, revision } => {
                self.give_up(revision);
                self.window.failed(format!(
                    "The planner crashed and was restarted ({message}). Edit the text or plan again."
                ));
            }
            HostEvent::CoreRestarted { message } => {
                self.window.info(format!("Planning was interrupted ({message}) and restarted"));
            }
            HostEvent::FileOpened { kind, name, bytes, token } => {
                // What the text imports decides on what a file is for, also where the text came just now.
                self.language.follow(&self.document);
                let open_before = self.library.open_id().cloned();
                self.open_file(kind, &name, bytes);
                // A file that became part of another mission is not that mission's own; nor is that of a network, which
                // other tools have written.
                let token = token.filter(|_| !self.language.is_network());
                let opened = self.library.open_id().filter(|id| open_before.as_ref() != Some(id)).cloned();
                if let Some((id, token)) = opened.zip(token) {
                    self.window.ask(Effect::KeepFile(id, token));
                }
            }
            HostEvent::FileSaved { name, revision } => {
                if self.document.revision() == revision {
                    self.document.mark_saved();
                }
                self.window.done(format!("Saved to {name}"));
            }
            HostEvent::FileFailed { name, reason } => {
                let place = if name.is_empty() { String::new() } else { format!("{name}: ") };
                self.window.failed(format!("{place}{reason}"));
            }
        }
    }

    fn take_answer(&mut self, answer: Response) {
        let revision = self.document.revision();
        match answer {
            Response::Snapshot(snapshot) => self.snapshots.take(snapshot, self.frame.now_secs),
            Response::Map { key, map } => self.maps.take(key, map),
            Response::Searches(comparison) => {
                let shown = self.snapshots.shown().cloned();
                self.search.take_comparison(comparison, shown.as_ref(), self.settings.plan.recorded());
            }
            Response::MapAccepted { name, cells: [width, height], no_data_cells } => {
                if self.keep_map(&name) {
                    let holes = match no_data_cells {
                        0 => String::new(),
                        1 => ", one without data".to_owned(),
                        count => format!(", {count} without data"),
                    };
                    let use_it = format!("Use it with: terrain \"{name}\";");
                    self.window
                        .done(format!("Imported map {name}: {width} × {height} cells{holes}. {use_it}"));
                }
                // Texts that name it are planned again.
                self.document.touch();
            }
            Response::MapRejected { name, reason } => {
                self.maps.let_go(&name);
                self.window.failed(format!("Couldn't import map {name}: {reason}"));
            }
            Response::PlacesRead { name, lines } => {
                self.maps.let_go(&name);
                self.writing().take_places(&name, &lines);
            }
            Response::Review { revision, review } => match self.reviewing().take(revision, review) {
                Some(Waiting::Report) if self.review.current().is_some() => self.write_report(),
                // Without a review of the plan that is drawn, it is not approved.
                Some(Waiting::Schedule(form, epoch)) => self.save_schedule(form, &epoch),
                Some(Waiting::Report) | None => {}
            },
            Response::Evaluated { token, snapshot } => self.compare.take(token, &snapshot),
            Response::Execution(_) | Response::NotExecuted { .. } => {
                self.execution.take(answer, revision, &mut self.window);
            }
            Response::ControlRun(standing) => self.automaton.take(*standing),
            Response::PathGrowth(standing) => self.terrain.growth.take(*standing),
            Response::Sampled { .. } => {
                let update = self.update_with_plan();
                let ended = self.chance.take(answer, update, &mut self.window);
                self.keep_ended_runs(ended);
            }
            Response::Contradicted { .. } => {
                let update = self.update_with_plan();
                self.contradict.take(answer, update, self.frame.now_secs, &mut self.window);
            }
            Response::RuleProven { .. } => {
                let update = self.update_with_plan();
                self.rule_proof.take(answer, update, &mut self.window);
            }
            Response::ProgramProven { .. } => {
                self.automaton.take_proof(answer, &self.document, &mut self.window);
            }
            Response::ProgramSampled { .. } => {
                self.automaton.take_sample(answer, &self.document, &mut self.window);
            }
        }
    }

    fn open_file(&mut self, kind: FileKind, name: &str, bytes: Vec<u8>) {
        if let Some(reason) = too_large(bytes.len(), kind.max_bytes(name)) {
            self.window.failed(format!("Couldn't open {name}: {reason}. Your current mission is unchanged."));
            return;
        }
        match kind {
            FileKind::Mission => self.open_mission_file(name, bytes),
            FileKind::Map => self.maps.open_file(name, bytes, &mut self.window),
            FileKind::Lesson => self.open_lesson_file(name, bytes),
            FileKind::Json | FileKind::Comparison => match String::from_utf8(bytes) {
                Ok(text) if kind == FileKind::Json => self.open_json(name, text),
                Ok(text) => {
                    let seed = self.settings.plan.seed;
                    let now = report::calendar::utc_text(self.frame.unix_millis);
                    let by = (&self.keys.ring().trust(), now.as_str());
                    self.compare.open_file(name, &text, seed, by, &mut self.window);
                }
                Err(_) => self.window.failed(format!("{name} is not a text file")),
            },
        }
    }

    fn open_json(&mut self, name: &str, text: String) {
        let document: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
        if let Ok(mission) = Mission::from_json(&text) {
            self.open_imported(mission);
        } else if is_network_file(&text) {
            self.open_mission_file(name, text.into_bytes());
        } else if document["format"].as_str().is_some_and(|format| format.starts_with("enroute-keys/")) {
            match KeyRing::from_json(&text) {
                Ok(ring) => self.ask_for_trust(name, ring.people()),
                Err(error) => self.window.failed(format!("{name}: {error}")),
            }
        } else if document["format"] == RULES_FORMAT {
            self.reviewing().import_rules(name, &text);
        } else if document["type"] == "FeatureCollection" {
            self.maps.open_file(name, text.into_bytes(), &mut self.window);
        } else if !self.execution.open_file(
            &document,
            &mut self.settings.plan,
            &mut self.playback,
            &mut self.window,
        ) {
            self.reviewing().import_record(name, &text);
        }
    }

    /// Asks whether to trust people of a file: anyone may have written it.
    fn ask_for_trust(&mut self, file: &str, people: &[Person]) {
        let is_known = |person: &&Person| {
            let known = self.keys.ring().people().iter().find(|known| known.key == person.key);
            known.is_some_and(|known| {
                known.name == person.name && (person.secret.is_none() || known.secret.is_some())
            })
        };
        let new: Vec<Person> = people.iter().filter(|person| !is_known(person)).cloned().collect();
        if new.is_empty() {
            self.window.info(format!("All keys in {file} are trusted already"));
        } else {
            self.window.dialog = Some(Dialog::TrustKeys { file: file.to_owned(), people: new });
        }
    }
}
