//! The text under work, kept beyond the end of this run: a closed tab loses nothing.

use smol_str::SmolStr;

use crate::command::Command;
use crate::host::{Host, StorageError};
use crate::mission_file;
use crate::state::{AppState, Draft, ToastKind};

const KEY: &str = "enroute/draft-1";
/// Where a draft goes that another is about to replace.
const EARLIER_KEY: &str = "enroute/draft-1/earlier";
/// Whoever types fast does not wait for the storage at each key.
const SECONDS_BETWEEN: f64 = 0.3;

/// Keeps the text while it is edited.
#[derive(Debug, Default)]
pub struct DraftKeeper {
    kept_revision: Option<u64>,
    kept_at_secs: f64,
    /// The mission whose text lies in the storage, if this run put it there or opened it from there.
    kept_name: Option<SmolStr>,
    has_complained: bool,
}

impl DraftKeeper {
    /// Opens the draft of the run before, unless the address asks for something else; then it can be brought back by
    /// a command.
    pub fn start(state: &mut AppState, host: &dyn Host) -> Self {
        let draft = read(host, KEY).filter(|draft| !is_example(&draft.name, &draft.source));
        let names_mission = ["mission=", "source="].iter().any(|part| host.fragment().contains(part));
        let mut keeper = Self::default();
        match draft {
            Some(Draft { name, source }) if !names_mission => {
                state.earlier_draft = read(host, EARLIER_KEY);
                keeper.kept_name = Some(name.clone());
                state.apply(Command::OpenSource { name, source });
                state.toasts.add(ToastKind::Done, "Your text is as you left it");
            }
            draft => state.earlier_draft = draft.or_else(|| read(host, EARLIER_KEY)),
        }
        keeper.kept_revision = Some(state.document.revision());
        keeper
    }

    /// Keeps the text if it has changed. Answers after how many seconds it wants to be asked again, if it does.
    pub fn follow(&mut self, state: &mut AppState, host: &mut dyn Host, now_secs: f64) -> Option<f64> {
        let revision = state.document.revision();
        if self.kept_revision == Some(revision) || is_example(&state.mission, state.document.text()) {
            return None;
        }
        let wait = self.kept_at_secs + SECONDS_BETWEEN - now_secs;
        if wait > 0.0 {
            return Some(wait);
        }
        self.kept_revision = Some(revision);
        self.kept_at_secs = now_secs;
        if self.kept_name.as_ref() != Some(&state.mission)
            && let Some(earlier) = read(host, KEY)
        {
            // Where there is no room for two, the newer one matters more; the earlier one is still in memory.
            let _ = serde_json::to_string(&earlier).map(|text| host.store(EARLIER_KEY, &text));
            state.earlier_draft = Some(earlier);
        }
        self.kept_name = Some(state.mission.clone());
        let draft = Draft { name: state.mission.clone(), source: state.document.text().to_owned() };
        let kept = serde_json::to_string(&draft).map(|text| host.store(KEY, &text));
        match kept {
            Ok(Ok(())) => self.has_complained = false,
            Ok(Err(reason)) => self.complain(state, &reason),
            Err(_) => {}
        }
        None
    }

    fn complain(&mut self, state: &mut AppState, reason: &StorageError) {
        if !std::mem::replace(&mut self.has_complained, true) {
            let text = format!("Your text is not kept when this closes ({reason}); save it as a file");
            state.toasts.add(ToastKind::Failed, text);
        }
    }
}

fn read(host: &dyn Host, key: &str) -> Option<Draft> {
    serde_json::from_str(&host.stored(key)?).ok()
}

fn is_example(name: &str, source: &str) -> bool {
    mission_file::example(name).is_some_and(|example| example.source == source)
}
