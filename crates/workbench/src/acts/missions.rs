//! What is done with the missions of the library: opening, naming, copying, deleting, and taking them out and in.

use interchange::{Translation, is_network_file, jmpl, pamela};
use link::Request;
use smol_str::SmolStr;
use terrain::format::{FileFormat, refusal};

use crate::command::Command;
use crate::dialog::Dialog;
use crate::effect::{Aside, Effect};
use crate::host::{FileKind, Save};
use crate::library::{LibraryCommand, MapFile, Mission, MissionError, MissionId, MissionKind, Open, joined};
use crate::limits::{MAX_TEXT_BYTES, too_large};
use crate::mission_file;
use crate::panel_effect::PanelEffect;
use crate::state::AppState;
use crate::workspace::Workspace;

/// What the whole of a mission is called as a file.
const WHOLE_EXTENSION: &str = "enroute";

impl AppState {
    pub(super) fn apply_to_library(&mut self, command: LibraryCommand) {
        let now_millis = self.frame.unix_millis;
        match command {
            LibraryCommand::New(template) => {
                let name = if template.source.is_empty() { "New mission" } else { template.title };
                let id = self.library.add(name, MissionKind::Own, template.source, now_millis);
                self.open_mission(&id);
                self.window.focus_editor();
            }
            LibraryCommand::NewFromExample(name) => {
                if let Some(example) = mission_file::example(&name) {
                    let name = format!("{} (copy)", example.title);
                    let id = self.library.add(&name, MissionKind::Example, example.source, now_millis);
                    self.open_mission(&id);
                }
            }
            LibraryCommand::Open(id) => self.open_mission(&id),
            LibraryCommand::Rename { id, name } => self.rename_mission(id, &name),
            LibraryCommand::Duplicate(id) => {
                let id = id.unwrap_or_else(|| self.mission_of_its_own());
                if let Some(copy) = self.library.duplicate(&id, now_millis) {
                    self.open_mission(&copy);
                    self.window.done(format!("Opened copy “{}”", self.mission));
                }
            }
            LibraryCommand::Delete(id) => self.delete_mission(id),
            LibraryCommand::Restore(id) => {
                let last = || self.library.deleted().first().map(|mission| mission.id.clone());
                if let Some(id) = id.or_else(last) {
                    self.library.restore(&id);
                    self.open_mission(&id);
                }
            }
            LibraryCommand::KeepVersion(name) => {
                self.window.dialog = None;
                self.mission_of_its_own();
                let name = name.trim();
                let name = if name.is_empty() { "Unnamed" } else { name };
                self.library.keep_version(name, now_millis);
                self.window.done(format!("Saved version “{name}”"));
            }
            LibraryCommand::RestoreVersion(index) => self.restore_version(index),
            LibraryCommand::SaveLayout(name) => self.save_layout(name.trim()),
            LibraryCommand::ShowLayout(number) => {
                let layout = self.library.open_mission().and_then(|it| it.layouts.get(number));
                let workspace = layout.and_then(|layout| Workspace::by_name(&layout.workspace));
                if let Some(workspace) = workspace {
                    self.window.dialog = None;
                    self.apply(Command::ShowWorkspace(workspace));
                    self.window.panel_effects.push(PanelEffect::ShowLayout(number));
                }
            }
            LibraryCommand::DeleteLayout(number) => self.library.remove_layout(number, now_millis),
            LibraryCommand::TurnIntoRmpl => self.turn_into_rmpl(),
            LibraryCommand::SaveMissionFile => self.save(true),
            LibraryCommand::SaveUnreadable(index) => {
                if let Some(unreadable) = self.library.unreadable.get(index) {
                    let name = unreadable.key.replace('/', "-");
                    let bytes = unreadable.bytes.to_vec();
                    self.window.save_file(format!("{name}.json"), bytes);
                }
            }
        }
    }

    /// Saves the panels of the workspace with the mission, under a name.
    fn save_layout(&mut self, name: &str) {
        if name.is_empty() {
            self.window.failed("A layout needs a name. Enter one.");
            return;
        }
        if self.lesson.is_beside() {
            self.window.failed("Lessons arrange the panels. Close the lesson to save a layout.");
            return;
        }
        self.mission_of_its_own();
        let workspace = self.window.workspace.name();
        if let Some(number) = self.library.add_layout(name, workspace, self.frame.unix_millis) {
            self.window.panel_effects.push(PanelEffect::SaveLayout(number));
            self.window.done(format!("Saved layout “{name}” with the mission"));
        }
    }

    /// Notes what the text says now: an original that was edited becomes a mission of its own.
    pub(crate) fn note_text(&mut self) {
        let title = self.mission_title().to_owned();
        if self.library.edited(&title, self.document.text(), self.frame.unix_millis) {
            self.is_a_mission_now();
        }
    }

    /// The id of the open mission; an original becomes a mission of its own.
    pub(super) fn mission_of_its_own(&mut self) -> MissionId {
        if let Some(id) = self.library.open_id() {
            return id.clone();
        }
        let (kind, title) = match self.library.open() {
            Open::Original { kind, .. } => (*kind, self.mission_title().to_owned()),
            Open::Mission(_) => (MissionKind::Own, self.mission.to_string()),
        };
        let name = if kind == MissionKind::Example { format!("{title} (copy)") } else { title };
        let id = self.library.add(&name, kind, self.document.text(), self.frame.unix_millis);
        self.library.show(&id);
        self.is_a_mission_now();
        id
    }

    /// What was an original is a mission of the library from here on, with what reviewers said of it.
    fn is_a_mission_now(&mut self) {
        if let Some(mission) = self.library.open_mission() {
            self.mission = mission.name.clone();
        }
        self.reviewing().go_along();
        self.window.ask(Effect::ShowAddress);
    }

    /// Opens a mission of the library.
    pub(crate) fn open_mission(&mut self, id: &MissionId) {
        self.note_text();
        let Some(mission) = self.library.mission(id) else {
            self.window.failed("This mission isn't saved in this browser");
            return;
        };
        let (name, text) = (mission.name.clone(), mission.joined_text());
        let maps = mission.maps.clone();
        self.set_document_aside();
        self.library.show(id);
        self.open(name, &text);
        if let Some(mut document) = self.library.set_aside.remove(id).filter(|kept| kept.text() == text) {
            document.count_on_from(self.document.revision());
            *self.document = document;
        }
        for map in maps {
            match map.bytes {
                Some(bytes) => self.import_map(map.name, bytes.to_vec()),
                None => self.window.ask(Effect::ReadMap(id.clone(), map.name)),
            }
        }
        self.window.ask(Effect::ShowAddress);
    }

    /// Opens a text that is not a mission of the library until it is edited.
    pub(super) fn open_original(&mut self, name: SmolStr, kind: MissionKind, source: &str) {
        self.note_text();
        self.set_document_aside();
        self.library.show_original(kind, source);
        self.open(name, source);
        // What is told apart later is what the document holds, in its own form of line breaks.
        self.library.show_original(kind, self.document.text());
        self.window.ask(Effect::ShowAddress);
    }

    /// Another mission is about to be opened: the history of this one stays as long as this run.
    fn set_document_aside(&mut self) {
        if let Some(id) = self.library.open_id().cloned() {
            let document = std::mem::take(&mut *self.document);
            // The count continues with the next text.
            self.document.count_on_from(document.revision());
            self.library.set_aside.insert(id, document);
        }
    }

    fn rename_mission(&mut self, id: Option<MissionId>, name: &str) {
        self.window.dialog =
            self.window.dialog.take().filter(|dialog| !matches!(dialog, Dialog::MissionName { .. }));
        if name.trim().is_empty() || id.is_none() && name.trim() == self.mission_title() {
            return;
        }
        let id = id.unwrap_or_else(|| self.mission_of_its_own());
        self.library.rename(&id, name, self.frame.unix_millis);
        if let Some(mission) = self.library.open_mission() {
            self.mission = mission.name.clone();
        }
    }

    fn delete_mission(&mut self, id: Option<MissionId>) {
        let open = self.library.open_id().cloned();
        let Some(id) = id.or_else(|| open.clone()) else {
            self.window.info("Examples can't be deleted");
            return;
        };
        self.note_text();
        let Some(name) = self.library.mission(&id).map(|mission| mission.name.clone()) else { return };
        self.library.delete(&id, self.frame.unix_millis);
        if open.as_ref() == Some(&id) {
            let next = self.library.missions().first().map(|mission| mission.id.clone());
            let dialog = self.window.dialog.take();
            match next {
                Some(next) => self.open_mission(&next),
                None => self.open_example(mission_file::EXAMPLES[0].name),
            }
            self.window.dialog = dialog;
        }
        let text = format!("Deleted “{name}”. To restore it, choose File > Restore deleted mission.");
        self.window.done(text);
    }

    fn restore_version(&mut self, index: usize) {
        let Some(mission) = self.library.open_mission() else { return };
        let Some(version) = mission.versions.get(index) else { return };
        let text = joined(&version.texts);
        let name = version.name.clone();
        self.document.replace_all(&text);
        self.window.dialog = None;
        self.window.done(format!("Restored version “{name}”. Undo to go back."));
    }

    /// Lets the user save the open mission: to the file it has, as its text or as a whole; with `asks` to another file,
    /// as a whole unless the user wants the text.
    pub(super) fn save(&mut self, asks: bool) {
        let texts = self.writing().files_to_save();
        // The text of an example or a link can be saved as it is; anything more is a mission of its own.
        if asks || texts.len() > 1 {
            self.mission_of_its_own();
        }
        self.note_text();
        let own = self.library.open_mission();
        let knows_maps = |mission: &&Mission| mission.maps.iter().all(|map| map.bytes.is_some());
        let whole = own.filter(knows_maps).map(|mission| {
            let record = self.review.record();
            let review = (!record.is_empty()).then(|| serde_json::from_str(&record.to_json()).ok()).flatten();
            let whole = Mission { review, ..mission.clone() };
            (format!("{}.{WHOLE_EXTENSION}", self.mission), whole.to_json().into_bytes())
        });
        // What is not of its own has no file: another link may go by the same name.
        let asks_for_file = asks || own.is_none();
        let mut forms = Vec::new();
        // The text alone is a file only where it is one.
        forms.extend(texts.first().filter(|_| texts.len() == 1).cloned());
        forms.extend(whole.clone());
        if asks {
            forms.reverse();
        }
        if asks && whole.is_none() || forms.is_empty() {
            self.window.info("The maps of this mission are still loading. Try again soon.");
            return;
        }
        let downloads = if asks { whole.into_iter().collect() } else { texts };
        let revision = self.document.revision();
        let mission = self.mission_key().to_string();
        let save = Save { mission, asks: asks_for_file, forms, revision };
        self.window.ask(Effect::Save(save, downloads));
    }

    /// Opens a file as a mission of its own, whatever is open; nothing is opened that does not read as one.
    pub(super) fn open_mission_file(&mut self, name: &str, bytes: Vec<u8>) {
        let text = match String::from_utf8(without_mark(bytes)) {
            Ok(text) => text,
            Err(error) => return self.open_what_is_no_mission(name, error.into_bytes()),
        };
        let refuse = |state: &mut Self, reason: &str| {
            let text = format!("Couldn't open {name}: {reason}. Your current mission is unchanged.");
            state.window.failed(text);
        };
        match Mission::from_json(&text) {
            Ok(mission) => self.open_imported(mission),
            Err(MissionError::NoMission) if let Some(reason) = too_large(text.len(), MAX_TEXT_BYTES) => {
                refuse(self, &reason);
            }
            Err(MissionError::NoMission) if let Some(missing) = self.writing().missing_file(name) => {
                if let Err(reason) = self.writing().add_file(&missing, &text) {
                    refuse(self, &reason);
                }
            }
            Err(MissionError::NoMission) if let Some(read) = read_model(name, &text) => match read {
                Ok(read) => self.open_model(name, &read),
                Err(reason) => refuse(self, &reason),
            },
            Err(MissionError::NoMission) if is_network_file(&text) || reads_as_mission(name, &text) => {
                let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
                let stem =
                    stem.strip_suffix(".tpn").or_else(|| stem.strip_suffix(".plandev")).unwrap_or(stem);
                let id = self.library.add(stem, MissionKind::File, &text, self.frame.unix_millis);
                self.open_mission(&id);
            }
            Err(MissionError::NoMission) => self.open_what_is_no_mission(name, text.into_bytes()),
            Err(error) => refuse(self, &error.to_string()),
        }
    }

    /// Opens what was read of a model of another tool, and says how much was not.
    fn open_model(&mut self, name: &str, read: &Translation) {
        let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
        let id = self.library.add(stem, MissionKind::File, &read.text, self.frame.unix_millis);
        self.open_mission(&id);
        let left_out = match read.left_out.len() {
            0 => return self.window.done(format!("Converted {name} to RMPL.")),
            1 => "1 line".to_owned(),
            count => format!("{count} lines"),
        };
        let text =
            format!("Converted {name} to RMPL, without {left_out}. The first lines of the text list them.");
        self.window.info(text);
    }

    /// A file that is neither mission nor network: a map under another ending, or something that is refused, by its name where
    /// that is known.
    fn open_what_is_no_mission(&mut self, name: &str, bytes: Vec<u8>) {
        if FileFormat::detect(&bytes).is_some() {
            return self.maps.open_file(name, bytes, &mut self.window);
        }
        let known = refusal(&bytes).map(|reason| reason.to_string());
        let reason =
            known.or_else(|| encoding_refusal(name, &bytes)).unwrap_or_else(|| NO_MISSION.to_owned());
        let text = format!("Couldn't open {name}: {reason}. Your current mission is unchanged.");
        self.window.failed(text);
    }

    /// Opens what one file held as a mission of its own.
    pub(super) fn open_imported(&mut self, mission: Mission) {
        if self.refuses_text(mission.texts.iter().map(|file| file.text.len()).sum()) {
            return;
        }
        let record = mission.review_record();
        let text = mission.review.as_ref().map(ToString::to_string);
        let id = self.library.add_from_file(mission, self.frame.unix_millis);
        self.open_mission(&id);
        match record {
            Some(Ok(record)) => self.window.ask(Effect::JoinReview(Box::new(record))),
            Some(Err(reason)) => {
                let words =
                    format!("Couldn't read the review of this mission: {reason}. A copy was set aside.");
                self.window.failed(words);
                let aside = Aside { reason: reason.to_string(), text: text.unwrap_or_default() };
                self.window.ask(Effect::SetReviewAside(aside));
            }
            None => {}
        }
    }

    pub(crate) fn import_map(&mut self, name: SmolStr, bytes: Vec<u8>) {
        // The core reads it, and says what it has found.
        self.window.post(Request::ImportMap { name, bytes });
    }

    /// The core can use a map that the user chose just now; the open mission keeps it.
    pub(super) fn keep_map(&mut self, name: &str) -> bool {
        let Some(bytes) = self.maps.let_go(name) else { return false };
        self.mission_of_its_own();
        let map = MapFile { name: name.into(), bytes: Some(bytes) };
        self.library.take_map(map, self.frame.unix_millis);
        true
    }

    /// Another tab has changed the text of the open mission: this one says the same from here on.
    pub(crate) fn adopt_text(&mut self, text: &str) {
        self.document.replace_all(text);
        self.derive();
    }
}

/// Reads a model of Livingstone or Pamela; `None` if the name says that the file is neither.
fn read_model(name: &str, text: &str) -> Option<Result<Translation, String>> {
    if pamela::is_pamela(name) {
        return Some(pamela::translate(name, text).map_err(|error| error.to_string()));
    }
    name.to_ascii_lowercase().ends_with(".jmpl").then(|| {
        let file = jmpl::SourceFile { name: name.to_owned(), text: text.to_owned() };
        jmpl::translate(&[file], &[]).map_err(|error| error.to_string())
    })
}

/// Why a file is not opened as a mission, and what is read.
const NO_MISSION: &str = "unrecognized format. Supported: missions and control programs (.rmpl, \
                          .enroute), networks (.tpn.json, .tpn.edn, .tpn), PlanDev plans (.json), models \
                          (.jmpl, .pamela), maps \
                          (PNG, PGM, TIFF, PDS3, ESRI ASCII grid, MovingAI, ROS), places (.geojson), \
                          lessons (.md), saved plans, runs and reviews (.json)";

/// Without the mark that editors of other systems put before a text, which says nothing in UTF-8.
fn without_mark(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.starts_with("\u{feff}".as_bytes()) {
        bytes.drain(..'\u{feff}'.len_utf8());
    }
    bytes
}

/// Returns why a text in another encoding is not opened.
fn encoding_refusal(name: &str, bytes: &[u8]) -> Option<String> {
    let encoding = if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        "UTF-16"
    } else if says_mission(name) {
        "another encoding, such as Latin-1"
    } else {
        return None;
    };
    let first_bad = str::from_utf8(bytes).err()?.valid_up_to();
    let line = bytes[..first_bad].split(|&byte| byte == b'\n').count();
    Some(format!(
        "line {line} is not UTF-8; the text seems to be in {encoding}. Save it as UTF-8 in your editor"
    ))
}

/// Returns whether a file is a mission: its name says so, or it reads as one.
fn reads_as_mission(name: &str, text: &str) -> bool {
    let reads = || {
        let has_error = |all: &[rmpl::Diagnostic]| all.iter().any(|it| it.severity == rmpl::Severity::Error);
        if rmpl::control::is_control_text(text) {
            !rmpl::control::parse(text).has_errors()
        } else {
            !text.trim().is_empty() && !has_error(&rmpl::parse(text).diagnostics())
        }
    };
    says_mission(name) || reads()
}

/// Returns whether a file's name says that it is a mission's text.
fn says_mission(name: &str) -> bool {
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension).to_ascii_lowercase();
    FileKind::Mission.extensions().contains(&extension.as_str())
        && !["txt", WHOLE_EXTENSION, "json", "edn", "tpn", "ptpn", "xml"].contains(&extension.as_str())
}
