//! Whole missions in one file (`.enroute`).

use workbench::host::{FileKind, HostEvent};
use workbench::library::Mission;
use workbench::state::AppState;

use super::{Outcome, Reader, nothing, read, refused, text_of};

/// Read, written, and opened.
pub(super) const ARCHIVES: Reader = Reader {
    name: "archives",
    seeds: &[],
    words: &[
        "\"format\"",
        "\"enroute-mission/1\"",
        "\"texts\"",
        "\"maps\"",
        "\"versions\"",
        "\"review\"",
        "\"picture\"",
        "\"bytes\"",
        "\"kind\"",
    ],
    mend: nothing,
    exercise: archives,
    tested: 1200,
    keeps_form: 3,
    cost: 1,
};

fn archives(input: &[u8]) -> Outcome {
    let text = text_of(input);
    match Mission::from_json(&text) {
        Ok(mission) => {
            let _ = mission.review_record();
            let again = Mission::from_json(&mission.to_json());
            assert_eq!(again.as_ref(), Ok(&mission), "what is written can be read");
            let mut state = AppState::new();
            state.receive(HostEvent::FileOpened {
                kind: FileKind::Mission,
                name: "mission.enroute".to_owned(),
                bytes: input.to_vec(),
                token: None,
            });
            read(&format!("{:?}", state.window.toasts.shown().iter().map(|it| &it.text).collect::<Vec<_>>()))
        }
        Err(reason) => refused(&reason.to_string()),
    }
}
