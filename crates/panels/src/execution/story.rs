//! The turns of a run: what broke the plan, when it was made again, and how the run ended.

use egui::Color32;
use exact::Time;
use executive::{Happening, NEEDED_UNTIL};
use snapshot::Execution;
use theme::Tokens;
use theme::icon::Icon;
use workbench::state::execution::has_come;
use workbench::time_text;

use crate::counted;
use workbench::sentence;

/// An event of the story that the timeline marks.
pub(crate) struct Turn {
    pub(crate) time: Time,
    pub(crate) kind: TurnKind,
    /// In words, with its time.
    pub(crate) text: String,
    /// What broke the plan before, if something did.
    pub(crate) because: Option<String>,
}

/// What a turn is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TurnKind {
    Replanned,
    Stopped,
    Finished,
}

impl TurnKind {
    /// Its sign, the color of that, and the ground below it.
    pub(crate) fn look(self, tokens: &Tokens) -> (Icon, Color32, Color32) {
        match self {
            Self::Replanned => (Icon::Warning, tokens.warning, tokens.soft[1]),
            Self::Stopped => (Icon::Error, tokens.error, tokens.soft[2]),
            Self::Finished => (Icon::Check, tokens.good, tokens.soft[0]),
        }
    }
}

/// What broke the plan, and why the run stopped: that says until when what was needed.
fn sentences(broke: &str, second: &str) -> String {
    let first = broke.split(NEEDED_UNTIL).next().unwrap_or(broke);
    let end = if second.ends_with('.') { "" } else { "." };
    format!("{first}. {}{end}", sentence(second))
}

/// The turns of a run up to a time, in order.
pub(crate) fn turns(run: &Execution, until: f64) -> Vec<Turn> {
    let mut found = Vec::new();
    let mut because = None;
    let mut replans = 0;
    for entry in run.log.iter().filter(|entry| has_come(entry.time, until)) {
        let at = time_text::short(entry.time);
        let (kind, text) = match &entry.happening {
            Happening::Violation { reason, .. } => {
                because = Some(reason.clone());
                continue;
            }
            Happening::Replanned { changes } => {
                replans += 1;
                let how = if changes.is_empty() { "same choices".to_owned() } else { changes.join(", ") };
                (TurnKind::Replanned, format!("Replanned at {at}: {how}"))
            }
            Happening::Stopped { reason } => {
                // A violation that ends the run stops it with its own reason.
                let broke = because.take().filter(|broke| broke != reason);
                because = Some(broke.map_or_else(|| reason.clone(), |broke| sentences(&broke, reason)));
                (TurnKind::Stopped, format!("Stopped safely at {at}"))
            }
            Happening::Finished => {
                let after = match replans {
                    0 => "as planned".to_owned(),
                    count => format!("after {}", counted(count, "replan")),
                };
                (TurnKind::Finished, format!("Mission completed at {at}, {after}"))
            }
            _ => continue,
        };
        found.push(Turn { time: entry.time, kind, text, because: because.clone() });
    }
    found
}
