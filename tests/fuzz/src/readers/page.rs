//! What else reaches the page: lessons, kept settings, dropped files, and commands of pages around it.

use serde_json::Value;
use workbench::host::{FileKind, HostEvent};
use workbench::lesson::Lesson;
use workbench::state::{AppState, Settings};

use super::{Outcome, Reader, nothing, read, refused, text_of};

/// Lessons of other authors.
pub(super) const LESSONS: Reader = Reader {
    name: "lessons",
    seeds: &["assets/lessons/*.md"],
    words: &[
        "# ",
        "## ",
        "```show\n",
        "```ask\n",
        "```\n",
        "{{",
        "}}",
        "step:",
        "answer:",
        "select:",
        "| a | b |\n|--|--|\n",
        "](",
        "* ",
        "> ",
    ],
    mend: nothing,
    exercise: lessons,
    tested: 1200,
    keeps_form: 3,
    cost: 1,
};

fn lessons(input: &[u8]) -> Outcome {
    let (lesson, errors) = Lesson::read("fuzzed", &text_of(input));
    let words: String = errors.iter().map(|error| error.message.as_str()).collect();
    if lesson.stops.is_empty() { refused(&words) } else { read(&words) }
}

/// Settings as they were kept.
pub(super) const SETTINGS: Reader = Reader {
    name: "settings",
    seeds: &[],
    words: &[
        "\"theme\"",
        "\"text_scale\"",
        "\"views\"",
        "\"terrain\"",
        "\"height_scale\"",
        "1e30",
        "-1",
        "\"learned\"",
        "null",
    ],
    mend: nothing,
    exercise: settings,
    tested: 2000,
    keeps_form: 3,
    cost: 1,
};

fn settings(input: &[u8]) -> Outcome {
    let settings = match serde_json::from_str::<Settings>(&text_of(input)) {
        Ok(settings) => settings.checked(),
        Err(reason) => return refused(&reason.to_string()),
    };
    assert!((0.5..=3.0).contains(&settings.text_scale), "text that can be read");
    assert!((0.5..=10.0).contains(&settings.views.terrain.height_scale), "heights that can be drawn");
    let written = serde_json::to_string(&settings).expect("they are written");
    assert_eq!(serde_json::from_str::<Settings>(&written).map(Settings::checked).ok(), Some(settings));
    read("")
}

/// Files that are dropped on the page: the first line is the name.
pub(super) const FILES: Reader = Reader {
    name: "dropped-files",
    seeds: &[],
    words: &[
        ".rmpl\n",
        ".json\n",
        ".edn\n",
        ".enroute\n",
        ".md\n",
        ".tif\n",
        ".lbl\n",
        ".img\n",
        ".txt\n",
        ".JSON\n",
        ".tpn\n",
        ".xml\n",
        "\"start_offset\": \"-1 day, 23:00:00\"",
        "../",
        "PDS_VERSION_ID = PDS3\n",
    ],
    mend: nothing,
    exercise: dropped,
    tested: 400,
    keeps_form: 3,
    cost: 1,
};

fn dropped(input: &[u8]) -> Outcome {
    let end = input.iter().position(|&byte| byte == b'\n').unwrap_or(input.len());
    let name = text_of(&input[..end]).into_owned();
    let bytes = input.get(end + 1..).unwrap_or_default().to_vec();
    let mut state = AppState::new();
    state.receive(HostEvent::FileOpened { kind: FileKind::of_name(&name), name, bytes, token: None });
    let said: String = state.window.toasts.shown().iter().map(|toast| toast.text.as_str()).collect();
    read(&said)
}

/// Commands that a page around this one sends: a line each, its name and its arguments as JSON.
pub(super) const COMMANDS: Reader = Reader {
    name: "commands",
    seeds: &[],
    words: &[
        "null",
        "{}",
        "[]",
        "-1",
        "1e308",
        "\"\"",
        "{\"text\":\"x\"}",
        "\nedit.undo ",
        "\nview.workspace ",
        "\nplayback.seek ",
    ],
    mend: nothing,
    exercise: commands,
    tested: 200,
    keeps_form: 3,
    cost: 1,
};

fn commands(input: &[u8]) -> Outcome {
    let mut state = AppState::new();
    let mut led = String::new();
    for line in text_of(input).lines().take(12) {
        let (name, arguments) = line.split_once(' ').unwrap_or((line, "null"));
        let arguments: Value = serde_json::from_str(arguments).unwrap_or(Value::Null);
        match workbench::registry::from_json(&state, name, &arguments) {
            Ok(command) => {
                state.apply(command);
                led += name;
            }
            Err(reason) => led += &reason.to_string(),
        }
    }
    read(&led)
}
