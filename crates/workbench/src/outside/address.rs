//! What stands after `#` in the page's address (DESIGN 4.3): `mission=`, `source=`, `open=`, `lesson=`, `stop=`,
//! `workspace=`, `step=`, `t=`.
//!
//! A shared text is compressed (deflate) and written in the alphabet of base64 for addresses.

use crate::command::Command;
use crate::host::Host;
use crate::library::{MissionId, MissionKind, Open};
use crate::mission_file;
use crate::state::lesson::LessonCommand;
use crate::state::missions::LibraryCommand;
use crate::state::{AppState, ToastKind};
use crate::workspace::Workspace;

/// The fragment that brings back the open lesson at its stop, or the open mission, the workspace, the step of the search and the time.
pub fn fragment(state: &AppState) -> String {
    if let Some(lesson) = lesson(state).filter(|_| state.lesson.text() == Some(state.document.text())) {
        return lesson;
    }
    let example = mission_file::example(&state.mission);
    let is_example = example.is_some_and(|example| example.source == state.document.text());
    let mission = if is_example {
        format!("mission={}", state.mission)
    } else {
        format!("source={}", pack(state.document.text()))
    };
    let time = state.playback.time;
    let time = if time > 0.0 { format!("&t={time}") } else { String::new() };
    let step = state.search.step().map(|step| format!("&step={}", step.step + 1)).unwrap_or_default();
    format!("{mission}&workspace={}{step}{time}", state.workspace.name())
}

/// Lets the address name the mission that is open, unless it does already: what was edited is never brought back as it
/// came, by loading the page again.
pub fn show_address(state: &AppState, host: &mut dyn Host) {
    let lesson = lesson(state);
    let wanted = match (state.library.open(), &lesson) {
        (Open::Original { .. }, Some(lesson)) => lesson.clone(),
        (Open::Mission(id), Some(lesson)) => format!("open={}&{lesson}", id.0),
        (Open::Mission(id), None) => format!("open={}", id.0),
        (Open::Original { kind: MissionKind::Example, .. }, None) => format!("mission={}", state.mission),
        // What a link holds is in the address already.
        (Open::Original { .. }, None) => return,
    };
    let shown = host.fragment();
    let shows = |wanted: &str| shown.split('&').any(|part| part == wanted);
    let names_lesson = shown.split('&').any(|part| part.starts_with("lesson="));
    if wanted.split('&').all(shows) && names_lesson == lesson.is_some()
        || shown.is_empty() && lesson.is_none() && is_first_example(state)
    {
        return;
    }
    // What else the address says goes on.
    let keys = ["mission=", "source=", "open=", "step=", "t=", "lesson=", "stop="];
    let named = |part: &str| keys.iter().any(|key| part.starts_with(key));
    let rest = shown.split('&').filter(|part| !part.is_empty() && !named(part));
    let parts: Vec<&str> = std::iter::once(wanted.as_str()).chain(rest).collect();
    host.set_fragment(&parts.join("&"));
}

/// The lesson of the course that is open, and its stop.
fn lesson(state: &AppState) -> Option<String> {
    let lesson = state.lesson.open()?;
    crate::lesson::course_lesson(&lesson.name)?;
    Some(format!("lesson={}&stop={}", lesson.name, state.lesson.at() + 1))
}

fn is_first_example(state: &AppState) -> bool {
    state.library.open_id().is_none() && state.mission == mission_file::EXAMPLES[0].name
}

/// Opens what a fragment names; parts that it does not name stay as they are. Returns whether it names a mission.
pub fn open_fragment(state: &mut AppState, fragment: &str) -> bool {
    let (mut is_named, mut is_edited) = (false, false);
    let parts = || fragment.trim_start_matches('#').split('&').filter_map(|part| part.split_once('='));
    for (key, value) in parts() {
        is_named |= matches!(key, "mission" | "source" | "open" | "lesson");
        match key {
            "open" => {
                is_edited = true;
                state.apply(Command::Library(LibraryCommand::Open(MissionId(value.into()))));
            }
            "mission" => match mission_file::example(value) {
                Some(example) => state.apply(Command::OpenExample(example.name.into())),
                None => state.toasts.add(ToastKind::Failed, format!("There is no mission \"{value}\"")),
            },
            "source" => match unpack(value) {
                Some(source) => {
                    state.apply(Command::OpenSource { name: "shared".into(), source });
                }
                None => state.toasts.add(ToastKind::Failed, "The mission in this link is damaged"),
            },
            "workspace" => {
                if let Some(workspace) = Workspace::by_name(value) {
                    state.apply(Command::ShowWorkspace(workspace));
                }
            }
            _ => {}
        }
    }
    let value_of = |wanted: &str| parts().find(|(key, _)| *key == wanted).map(|(_, value)| value);
    if let Some(name) = value_of("lesson") {
        let stop = value_of("stop").and_then(|stop| stop.parse::<usize>().ok()).unwrap_or(1).max(1) - 1;
        if is_edited {
            state.resume_lesson(name, stop);
        } else {
            state.apply(Command::Lesson(LessonCommand::Open(name.into(), stop)));
        }
    }
    // These are about the mission that the others open, wherever they stand.
    for (key, value) in parts() {
        match key {
            "step" => {
                if let Ok(step) = value.parse::<usize>() {
                    state.apply(Command::SetTrace(true));
                    state.want_step(step);
                }
            }
            "t" => {
                if let Ok(time) = value.parse::<f64>() {
                    state.playback.time = time.max(0.0);
                    state.playback.end = state.playback.end.max(state.playback.time);
                }
            }
            _ => {}
        }
    }
    is_named
}

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

/// A larger text than this is not unpacked: no mission is that long, and a short link must not fill the memory.
const LONGEST_TEXT_BYTES: usize = 8 << 20;

fn pack(text: &str) -> String {
    let bytes = miniz_oxide::deflate::compress_to_vec(text.as_bytes(), 9);
    let mut packed = String::with_capacity(bytes.len() * 4 / 3 + 4);
    for chunk in bytes.chunks(3) {
        let group =
            chunk.iter().fold(0_u32, |group, &byte| group << 8 | u32::from(byte)) << (8 * (3 - chunk.len()));
        for at in 0..=chunk.len() {
            let index = (group >> (18 - 6 * at)) & 63;
            packed.push(char::from(ALPHABET[index as usize]));
        }
    }
    packed
}

fn unpack(packed: &str) -> Option<String> {
    let digits: Option<Vec<u32>> = packed
        .bytes()
        .map(|byte| ALPHABET.iter().position(|&letter| letter == byte).map(|at| at as u32))
        .collect();
    let mut bytes = Vec::new();
    for chunk in digits?.chunks(4) {
        let group = chunk.iter().fold(0_u32, |group, &digit| group << 6 | digit) << (6 * (4 - chunk.len()));
        bytes.extend((0..chunk.len().saturating_sub(1)).map(|at| (group >> (16 - 8 * at)) as u8));
    }
    let text = miniz_oxide::inflate::decompress_to_vec_with_limit(&bytes, LONGEST_TEXT_BYTES).ok()?;
    String::from_utf8(text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_survives_the_way_through_an_address() {
        for text in ["", "a", "ab", "abc", "delay[0,∞];\n", &"Group-Wait() ".repeat(500)] {
            let packed = pack(text);
            assert!(packed.bytes().all(|byte| ALPHABET.contains(&byte)));
            assert_eq!(unpack(&packed).as_deref(), Some(text));
        }
    }

    #[test]
    fn a_damaged_text_is_refused_and_keeps_the_open_mission() {
        let mut state = AppState::new();
        let before = state.document.text().to_owned();
        for damaged in ["source=%%%", "source=A", "source=zzzzzzzz", "mission=nowhere"] {
            open_fragment(&mut state, damaged);
        }
        assert_eq!(state.document.text(), before);
        assert!(!state.toasts.shown().is_empty());
    }

    #[test]
    fn a_fragment_names_the_step_in_any_order_and_without_it_none() {
        let mut state = AppState::new();
        open_fragment(&mut state, "step=12&mission=backjump&workspace=teach");
        assert_eq!(state.mission, "backjump");
        assert!(state.settings.plan.trace, "there is nothing to step through without a recorded search");
        assert!(!fragment(&state).contains("step="), "the search has not been recorded yet");
    }

    #[test]
    fn a_fragment_brings_back_the_text_the_workspace_and_the_time() {
        let mut state = AppState::new();
        state.apply(Command::SetSource("scenario S { }".to_owned()));
        state.apply(Command::ShowWorkspace(Workspace::Review));
        state.playback.end = 100.0;
        state.apply(Command::Seek(12.5));
        let mut again = AppState::new();
        open_fragment(&mut again, &fragment(&state));
        assert_eq!(again.document.text(), "scenario S { }");
        assert_eq!(again.workspace, Workspace::Review);
        assert_eq!(again.playback.time, 12.5);
    }
}
