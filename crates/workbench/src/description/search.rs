//! The recorded search and the step that is looked at.

use serde::Serialize;
use serde_json::{Value, json};
use tpn::plan_json::plan_to_json;
#[cfg(test)]
use ts_rs::TS;

use crate::state::AppState;
use crate::state::search::{Breakpoints, Counts, Recording, wording};
use crate::state::selection::node_name;

/// The recorded search and its current step. If there is a current step, all panels show it instead of the plan.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct Search {
    /// The current step, from 1; 0 while the panels show the plan.
    pub step: usize,
    /// How many steps are recorded; 0 if none are.
    pub steps: usize,
    pub is_playing: bool,
    /// Whether stepping and playing skip steps that only prepare a key step.
    pub only_key_steps: bool,
    pub steps_per_second: f64,
    /// Where running and playing stop.
    #[cfg_attr(test, ts(type = "Record<\"decision\" | \"failure\" | \"threat\" | \"solution\", boolean>"))]
    pub breakpoints: Breakpoints,
    /// The knowledge of the search at the step: its choices, links, orderings and windows in the form of a plan.
    #[cfg_attr(
        test,
        ts(
            type = "(Plan & { event: string | null; text: string | null; state: number; cycle: string[] }) | null"
        )
    )]
    pub known: Option<Value>,
    /// Both searches side by side, if they are compared.
    pub compare: Option<SearchComparison>,
}

/// Two searches of one mission side by side.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct SearchComparison {
    /// The one that the panels show, from 0.
    pub side: usize,
    pub is_linked: bool,
    pub searches: Vec<SearchFigures>,
}

/// The amount of work of a search, and its current step.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct SearchFigures {
    #[cfg_attr(test, ts(type = "\"chronological\" | \"conflict-directed\""))]
    pub search: kirk::Search,
    #[cfg_attr(test, ts(type = "string"))]
    pub status: kirk::Status,
    pub step: usize,
    pub steps: usize,
    pub states: u32,
    pub propagations: u32,
    pub backtracks: u32,
    #[serde(rename = "deadEnds")]
    pub failures: u32,
    pub millis: f64,
}

pub(super) fn search(state: &AppState) -> Search {
    let recordings = state.search.recordings(state.shown());
    let side = state.search.side();
    let known = state.search.shown().map(|view| {
        let network = view.recording.network();
        let trace = view.recording.trace();
        let entry = trace.events.get(view.step.step);
        let mut known = plan_to_json(network, &view.plan);
        known["event"] = json!(entry.map(|entry| event_name(&entry.event)));
        known["text"] = json!(entry.map(|entry| wording::event(network, trace, &entry.event)));
        known["state"] = json!(view.step.tree_node);
        known["cycle"] = view.step.cycle.iter().map(|it| json!(node_name(network, it.from))).collect();
        known
    });
    let compare = state.search.compares().then(|| SearchComparison {
        side,
        is_linked: state.search.is_linked(),
        searches: recordings
            .iter()
            .enumerate()
            .filter_map(|(side, recording)| figures(state, side, recording))
            .collect(),
    });
    Search {
        step: state.search.step().map_or(0, |step| step.step + 1),
        steps: recordings.get(side).or(recordings.first()).map_or(0, Recording::steps),
        is_playing: state.search.is_playing,
        only_key_steps: state.search.only_key(),
        steps_per_second: state.search.steps_per_sec,
        breakpoints: state.search.breakpoints,
        known,
        compare,
    }
}

fn figures(state: &AppState, side: usize, recording: &Recording) -> Option<SearchFigures> {
    let searched = recording.searched()?;
    let counts = Counts::of(recording.trace());
    Some(SearchFigures {
        search: searched.search,
        status: searched.status,
        step: state.search.view(side).map_or(0, |view| view.step.step + 1),
        steps: recording.steps(),
        states: counts.states,
        propagations: counts.propagations,
        backtracks: counts.backtracks,
        failures: counts.failures,
        millis: searched.millis,
    })
}

/// The name of an event of the search, as in recorded searches on the command line.
fn event_name(event: &kirk::Event) -> &'static str {
    use kirk::Event;
    match event {
        Event::Expand { .. } => "expand",
        Event::Decide { .. } => "decide",
        Event::AddArc { .. } => "add-arc",
        Event::Propagate { .. } => "propagate",
        Event::Inconsistent { .. } => "inconsistent",
        Event::Unclosable { .. } => "unclosable",
        Event::TryLink { .. } => "try-link",
        Event::Threat { .. } => "threat",
        Event::TryOrder { .. } => "try-order",
        Event::Unresolvable { .. } => "unresolvable",
        Event::Known { .. } => "known",
        Event::Backtrack { .. } => "backtrack",
        Event::Backjump { .. } => "backjump",
        Event::Solution { .. } => "solution",
        Event::Exhausted => "exhausted",
        Event::Begin(_) => "begin",
        Event::TryUseOrder { .. } => "try-use-order",
        Event::TryStart { .. } => "try-start",
        Event::Imply { .. } => "imply",
        Event::NoAlternative { .. } => "no-alternative",
        Event::Unsharable { .. } => "unsharable",
        Event::NotBetter { .. } => "not-better",
        Event::Clash { .. } => "clash",
        Event::Uncontrollable { .. } => "uncontrollable",
        Event::Circle { .. } => "circle",
        Event::NoRoomForGap => "no-room-for-gap",
        Event::Learn { .. } => "learn",
        Event::Overload { .. } => "overload",
        Event::OutOfRange { .. } => "out-of-range",
        Event::Restart => "restart",
        Event::Keep { .. } => "keep",
        Event::Bound { .. } => "bound",
        Event::Visit { .. } => "visit",
        Event::Improve { .. } => "improve",
    }
}
