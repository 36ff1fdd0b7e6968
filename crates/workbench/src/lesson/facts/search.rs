//! The recorded search and the step of it that is looked at.

use kirk::Event;
use kirk::Search as SearchKind;

use super::{Fact, Of, count, fact, plan, time, truth, words};
use crate::lesson::{StepKind, Value};
use crate::state::AppState;
use crate::state::search::wording::event;
use crate::state::search::{Counts, Recording};
use crate::state::selection::node_name;

/// What a count is of.
const WHICH: Of = Of::Maybe("chronological");

pub(super) const FACTS: &[Fact] = &[
    fact("steps", WHICH, "how many steps the search has", |state, which| {
        count(recording(state, which)?.steps())
    }),
    fact("states", WHICH, "how many states it entered", |state, which| {
        count(counts(state, which)?.states as usize)
    }),
    fact("backtracks", WHICH, "how often it went back", |state, which| {
        count(counts(state, which)?.backtracks as usize)
    }),
    fact("failures", WHICH, "how many failures it met", |state, which| {
        count(counts(state, which)?.failures as usize)
    }),
    fact("propagations", WHICH, "how often it propagated bounds", |state, which| {
        count(counts(state, which)?.propagations as usize)
    }),
    fact("count", Of::Something("threat"), "how many steps of a kind the search has", |state, kind| {
        let (_, kind) = StepKind::ALL.into_iter().find(|(name, _)| *name == kind)?;
        let recording = recording(state, "")?;
        count(recording.trace().events.iter().filter(|entry| kind.is(&entry.event)).count())
    }),
    fact("step", Of::Nothing, "the number of the step that is looked at; 0 is the plan", |state, _| {
        count(state.search.step().map_or(0, |step| step.step + 1))
    }),
    fact(
        "step-is",
        Of::Something("failure"),
        "whether the step that is looked at is of this kind",
        |state, kind| {
            let (_, kind) = StepKind::ALL.into_iter().find(|(name, _)| *name == kind)?;
            truth(looked_at(state).is_some_and(|(_, event)| kind.is(event)))
        },
    ),
    fact("sentence", Of::Nothing, "what happens at the step that is looked at, in a sentence", |state, _| {
        let (recording, entry) = looked_at(state)?;
        words(event(recording.network(), recording.trace(), entry))
    }),
    fact(
        "shortfall",
        Of::Nothing,
        "how much less than nothing the negative cycle of the step adds up to",
        |state, _| {
            let Event::Inconsistent { cycle } = looked_at(state)?.1 else { return None };
            let total = exact::Time::checked_sum(cycle.iter().map(|member| member.weight))?;
            time(total.checked_neg()?)
        },
    ),
    fact(
        "bound",
        Of::Nothing,
        "what the first goal may become at best with the choices of the step, in a best-first search",
        |state, _| {
            let (_, Event::Bound { values } | Event::Visit { values, .. }) = looked_at(state)? else {
                return None;
            };
            values.first().copied().map(Value::Number)
        },
    ),
    fact("cycle", Of::Nothing, "the events of the negative cycle of the step, in order", |state, _| {
        let (recording, event) = looked_at(state)?;
        let Event::Inconsistent { cycle } = event else { return None };
        let names: Vec<String> = cycle.iter().map(|it| node_name(recording.network(), it.from)).collect();
        words(names.join(" → "))
    }),
    fact(
        "cycle-length",
        Of::Nothing,
        "how many bounds the negative cycle of the step goes along",
        |state, _| {
            let Event::Inconsistent { cycle } = looked_at(state)?.1 else { return None };
            count(cycle.len())
        },
    ),
    fact("compared", Of::Nothing, "whether both searches are shown side by side", |state, _| {
        truth(state.search.recordings(state.shown()).len() == 2)
    }),
];

/// A recording: that of the search that is looked at, or of the one that is named.
fn recording(state: &AppState, which: &str) -> Option<Recording> {
    plan::fresh(state)?;
    let recordings = state.search.recordings(state.shown());
    if which.is_empty() {
        return recordings.into_iter().nth(state.search.side());
    }
    let kind = SearchKind::ALL.into_iter().find(|kind| kind.name() == which)?;
    recordings.into_iter().find(|recording| recording.kind().unwrap_or(state.settings.plan.search) == kind)
}

fn counts(state: &AppState, which: &str) -> Option<Counts> {
    Some(Counts::of(recording(state, which)?.trace()))
}

/// The step that is looked at, with its search.
fn looked_at(state: &AppState) -> Option<(&Recording, &Event)> {
    let view = state.search.shown()?;
    let entry = view.recording.trace().events.get(view.step.step)?;
    Some((&view.recording, &entry.event))
}
