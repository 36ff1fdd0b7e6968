//! What is after `#` in the page's address (DESIGN 4.3): `mission=`, `source=`, `open=`, `lesson=`, `stop=`,
//! `workspace=`, `step=`, `t=`.
//!
//! A shared text is compressed with a checksum (zlib) and written in the alphabet of base64 for addresses, after the
//! version of this notation and a point: `source=2.eJx…`. What has no version is of the first, which had no checksum.

use miniz_oxide::inflate::{TINFLStatus, decompress_to_vec_with_limit, decompress_to_vec_zlib_with_limit};

use crate::command::Command;
use crate::host::Host;
use crate::library::LibraryCommand;
use crate::library::{MissionId, MissionKind, Open};
use crate::limits::MAX_TEXT_BYTES;
use crate::mission_file;
use crate::state::AppState;
use crate::state::lesson::LessonCommand;
use crate::state::settings::SettingsCommand;
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
    format!("{mission}&workspace={}{step}{time}", state.window.workspace.name())
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
    // What else the address says continues.
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

/// Returns whether nothing was opened yet.
pub(super) fn is_first_example(state: &AppState) -> bool {
    state.library.open_id().is_none() && state.mission == mission_file::EXAMPLES[0].name
}

/// The mission of the library that a fragment names, if it does.
pub(super) fn named_mission(fragment: &str) -> Option<MissionId> {
    let mut parts = fragment.trim_start_matches('#').split('&');
    parts.find_map(|part| part.strip_prefix("open=")).map(|id| MissionId(id.into()))
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
                None => state.window.failed(format!("Unknown mission “{value}”")),
            },
            "source" => match unpack(value) {
                Ok(source) => state.apply(Command::OpenSource { name: "shared".into(), source }),
                Err(reason) => state.window.failed(reason.to_string()),
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
                    state.apply(Command::Settings(SettingsCommand::SetTrace(true)));
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

/// The version of what follows `source=`.
const VERSION: u32 = 2;

/// Links of more characters are not offered: Chromium does not show longer addresses, and Windows hands none over from one
/// program to another.
const MAX_LINK_CHARACTERS: usize = 32_000;

/// Returns whether a link works in all browsers.
pub fn is_link_short(link: &str) -> bool {
    link.len() <= MAX_LINK_CHARACTERS
}

/// Why the text of a link is not opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
enum LinkError {
    #[error("Couldn't open this link: it is incomplete or was changed. Your current mission is unchanged.")]
    Damaged,
    #[error("This link needs a later version of Enroute. Reload the page to update.")]
    Newer,
    #[error("Couldn't open this link: the mission has more than {} MB. Your current mission is unchanged.", MAX_TEXT_BYTES >> 20)]
    TooLong,
}

fn pack(text: &str) -> String {
    let bytes = miniz_oxide::deflate::compress_to_vec_zlib(text.as_bytes(), 9);
    format!("{VERSION}.{}", digits_of(&bytes))
}

fn digits_of(bytes: &[u8]) -> String {
    let mut digits = String::with_capacity(bytes.len() * 4 / 3 + 4);
    for chunk in bytes.chunks(3) {
        let group =
            chunk.iter().fold(0_u32, |group, &byte| group << 8 | u32::from(byte)) << (8 * (3 - chunk.len()));
        for at in 0..=chunk.len() {
            let index = (group >> (18 - 6 * at)) & 63;
            digits.push(char::from(ALPHABET[index as usize]));
        }
    }
    digits
}

fn unpack(packed: &str) -> Result<String, LinkError> {
    let (version, packed) = match packed.split_once('.') {
        Some((version, packed)) => (version.parse().map_err(|_| LinkError::Damaged)?, packed),
        None => (1, packed),
    };
    if version > VERSION {
        return Err(LinkError::Newer);
    }
    let bytes = bytes_of(packed).ok_or(LinkError::Damaged)?;
    let inflate = if version == 1 { decompress_to_vec_with_limit } else { decompress_to_vec_zlib_with_limit };
    let text = inflate(&bytes, MAX_TEXT_BYTES).map_err(|error| match error.status {
        TINFLStatus::HasMoreOutput => LinkError::TooLong,
        _ => LinkError::Damaged,
    })?;
    String::from_utf8(text).map_err(|_| LinkError::Damaged)
}

fn bytes_of(packed: &str) -> Option<Vec<u8>> {
    let digits: Option<Vec<u32>> = packed
        .bytes()
        .map(|byte| ALPHABET.iter().position(|&letter| letter == byte).map(|at| at as u32))
        .collect();
    let mut bytes = Vec::new();
    for chunk in digits?.chunks(4) {
        let group = chunk.iter().fold(0_u32, |group, &digit| group << 6 | digit) << (6 * (4 - chunk.len()));
        bytes.extend((0..chunk.len().saturating_sub(1)).map(|at| (group >> (16 - 8 * at)) as u8));
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_survives_the_way_through_an_address() {
        for text in ["", "a", "ab", "abc", "delay[0,∞];\n", &"Group-Wait() ".repeat(500)] {
            let packed = pack(text);
            let (version, digits) = packed.split_once('.').expect("a version");
            assert_eq!(version, "2");
            assert!(digits.bytes().all(|byte| ALPHABET.contains(&byte)));
            assert_eq!(unpack(&packed).as_deref(), Ok(text));
        }
    }

    #[test]
    fn links_without_a_version_are_still_read() {
        let text = "scenario Later { Drive() }";
        let bytes = miniz_oxide::deflate::compress_to_vec(text.as_bytes(), 9);
        let packed = digits_of(&bytes);
        assert_eq!(unpack(&packed).as_deref(), Ok(text));
    }

    #[test]
    fn whatever_character_of_a_link_is_changed_or_lost_it_is_noticed() {
        let text = "scenario Storm[0,60] = { Drive(Rover1,Base); Wait()[5,10] }";
        let packed = pack(text);
        let start = packed.find('.').expect("a version") + 1;
        for at in start..packed.len() {
            let mut changed = packed.clone().into_bytes();
            changed[at] = if changed[at] == b'A' { b'B' } else { b'A' };
            let changed = String::from_utf8(changed).expect("letters");
            // The last digit has bits that represent nothing.
            assert!(unpack(&changed).is_err() || at + 1 == packed.len(), "{at}");
            assert_eq!(unpack(&packed[..at]), Err(LinkError::Damaged), "{at}");
        }
    }

    #[test]
    fn a_later_link_and_one_that_is_too_long_are_told_apart_from_a_damaged_one() {
        assert_eq!(unpack("3.AAAA"), Err(LinkError::Newer));
        assert_eq!(unpack("two.AAAA"), Err(LinkError::Damaged));
        let long = pack(&"x".repeat(MAX_TEXT_BYTES + 1));
        assert!(is_link_short(&long));
        assert_eq!(unpack(&long), Err(LinkError::TooLong));
        let mut state = AppState::new();
        let before = state.document.text().to_owned();
        open_fragment(&mut state, "source=3.AAAA");
        assert_eq!(state.document.text(), before);
        assert!(state.window.toasts.shown()[0].text.contains("later version"));
    }

    #[test]
    fn a_damaged_text_is_refused_and_keeps_the_open_mission() {
        let mut state = AppState::new();
        let before = state.document.text().to_owned();
        for damaged in ["source=%%%", "source=A", "source=zzzzzzzz", "mission=nowhere"] {
            open_fragment(&mut state, damaged);
        }
        assert_eq!(state.document.text(), before);
        assert!(!state.window.toasts.shown().is_empty());
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
        assert_eq!(again.window.workspace, Workspace::Review);
        assert_eq!(again.playback.time, 12.5);
    }
}
