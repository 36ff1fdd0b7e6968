//! The text, its network, the plan, and why there is none.

use exact::{Bound, Time};
use snapshot::Snapshot;
use tpn::{Levels, Network, OccurrenceKind, Plan, Window};

use super::super::expression::Value;
use super::{Fact, Of, count, fact, measured, time, truth, words};
use crate::state::selection::arc_name;
use crate::state::{AppState, Selection, Status};

pub(super) const FACTS: &[Fact] = &[
    fact("plan", Of::Nothing, "whether there is a plan that holds", |state, _| {
        let planning = fresh(state)?.planning.as_ref();
        let valid =
            planning.and_then(|planning| planning.verdict.as_ref()).is_some_and(|verdict| verdict.valid);
        truth(state.status() == Status::Plan && valid)
    }),
    fact("no-plan", Of::Nothing, "whether it is proven that there is no plan", |state, _| {
        latest(state)?;
        truth(state.status() == Status::NoPlan)
    }),
    fact("errors", Of::Nothing, "how many errors the text has", |state, _| {
        let is_error = |it: &&snapshot::Problem| it.severity == rmpl::Severity::Error;
        count(latest(state)?.problems.iter().filter(is_error).count())
    }),
    fact(
        "problem",
        Of::Something("E-BOUNDS"),
        "whether the text has a problem of this kind",
        |state, code| truth(latest(state)?.problems.iter().any(|it| it.code == code)),
    ),
    fact(
        "says",
        Of::Something("words"),
        "whether these words stand in the text, however they are spaced",
        |state, words| {
            let unspaced = |text: &str| -> String { text.split_whitespace().collect() };
            truth(unspaced(state.document.text()).contains(&unspaced(words)))
        },
    ),
    fact("events", Of::Nothing, "how many events the network has", |state, _| {
        count(network(state)?.nodes.len())
    }),
    fact("constraints", Of::Nothing, "how many arcs the network has", |state, _| {
        count(network(state)?.arcs.len())
    }),
    fact("decisions", Of::Nothing, "how many decisions the network has", |state, _| {
        count(network(state)?.decisions.len())
    }),
    fact("activities", Of::Nothing, "how many primitive activities the network has", |state, _| {
        let is_primitive = |it: &&tpn::Occurrence| it.kind == OccurrenceKind::Primitive;
        count(network(state)?.occurrences.iter().filter(is_primitive).count())
    }),
    fact("selected", Of::Something("Drive#1"), "whether the plan does this activity", |state, name| {
        let (network, plan) = plan(state)?;
        let occurrence = network.occurrences.iter().find(|it| it.name == name)?;
        truth(plan.selected_nodes.get(occurrence.start.index()) == Some(&true))
    }),
    fact(
        "choice",
        Of::Something("D1"),
        "the alternative that the plan takes of a decision, from 0",
        |state, name| {
            let (_, plan) = plan(state)?;
            let choice = plan.choices.iter().find(|it| Network::decision_name(it.decision) == name)?;
            count(choice.alternative as usize)
        },
    ),
    fact("alternatives", Of::Something("D1"), "how many alternatives a decision has", |state, name| {
        let network = network(state)?;
        let mut decisions = (0..network.decisions.len()).map(tpn::DecisionId::from_index);
        let found = decisions.find(|&id| Network::decision_name(id) == name)?;
        count(network.decisions.get(found.index())?.alternatives.len())
    }),
    fact(
        "assertions",
        Of::Something("LIGHT"),
        "how many intervals of the text assert a condition",
        |state, text| {
            let is_meant = |it: &&tpn::Label| it.mode == rmpl::program::LabelMode::Tell && it.text == text;
            count(network(state)?.labels.iter().filter(is_meant).count())
        },
    ),
    fact("conflicting", Of::Nothing, "how many pairs of conflicting intervals the plan has", |state, _| {
        count(plan(state)?.1.conflict_order.len())
    }),
    fact("lower", Of::Something("Drive#1"), "the least duration that is written for it", |state, name| {
        time(written(state, name)?.0)
    }),
    fact("upper", Of::Something("Drive#1"), "the greatest duration that is written for it", |state, name| {
        bound(written(state, name)?.1)
    }),
    fact(
        "earliest",
        Of::Something("Drive#1.start"),
        "when an event can happen at the earliest",
        |state, name| time(window(state, name)?.earliest),
    ),
    fact(
        "latest",
        Of::Something("Drive#1.start"),
        "when an event can happen at the latest",
        |state, name| bound(window(state, name)?.latest),
    ),
    fact("slack", Of::Something("Drive#1.start"), "how long an event can wait", |state, name| {
        let window = window(state, name)?;
        bound(window.latest.checked_sub(window.earliest)?)
    }),
    fact("links", Of::Nothing, "how many conditions have their assertion", |state, _| {
        count(plan(state)?.1.causal_links.len())
    }),
    fact(
        "link",
        Of::Something("LIGHT"),
        "the assertion that carries the first requirement of this condition",
        |state, text| {
            let (network, plan) = plan(state)?;
            let label = |id: tpn::LabelId| network.labels.get(id.index());
            let link =
                plan.causal_links.iter().find(|link| label(link.ask).is_some_and(|ask| ask.text == text))?;
            let owner = network.occurrences.get(label(link.tell)?.owner?.index())?;
            words(owner.name.as_str())
        },
    ),
    fact(
        "orderings",
        Of::Nothing,
        "how many orders planning added between conflicting conditions",
        |state, _| count(plan(state)?.1.orderings_added.len()),
    ),
    fact(
        "uses-ordered",
        Of::Nothing,
        "how many orders planning added between uses of resources",
        |state, _| count(plan(state)?.1.uses_ordered.len()),
    ),
    fact("least", Of::Something("Battery"), "the lowest level in any schedule of the plan", |state, name| {
        match levels(state, name)? {
            Levels::Range { low, .. } => Some(Value::Number(low)),
            Levels::Peak(_) => None,
        }
    }),
    fact(
        "greatest",
        Of::Something("Battery"),
        "the highest level, or the most that is used at a time, in any schedule",
        |state, name| match levels(state, name)? {
            Levels::Range { high, .. } => Some(Value::Number(high)),
            Levels::Peak(peak) => Some(Value::Number(peak)),
        },
    ),
    fact("end", Of::Nothing, "when the mission ends at the earliest", |state, _| {
        let (network, plan) = plan(state)?;
        time(plan.windows.get(network.end.index()).copied().flatten()?.earliest)
    }),
    fact("reward", Of::Nothing, "what the plan is rewarded with", |state, _| {
        Some(Value::Number(plan(state)?.1.quality.reward))
    }),
    fact("cost", Of::Nothing, "what the plan costs", |state, _| {
        Some(Value::Number(plan(state)?.1.quality.cost))
    }),
    fact("optimal", Of::Nothing, "whether it is proven that no plan is better", |state, _| {
        truth(plan(state)?.1.quality.is_optimal?)
    }),
    fact(
        "length",
        Of::Maybe("Drive#1"),
        "the metres of all planned paths, or of one traverse",
        |state, name| {
            let snapshot = fresh(state)?;
            let network = network(state)?;
            let is_meant = |it: &&snapshot::Traverse| {
                name.is_empty()
                    || network.occurrences.get(it.occurrence.index()).is_some_and(|it| it.name == name)
            };
            let lengths: Vec<f64> =
                snapshot.traverses.iter().filter(is_meant).map(|it| it.length_m).collect();
            if lengths.is_empty() { None } else { measured(lengths.iter().sum()) }
        },
    ),
    fact("reasons", Of::Nothing, "how many reasons there are why there is no plan", |state, _| {
        count(failure(state)?.reasons.len())
    }),
    fact("ways-out", Of::Nothing, "how many changes are known that would give a plan", |state, _| {
        count(fresh(state)?.planning.as_ref()?.ways_out().len())
    }),
    fact("natures-choice", Of::Nothing, "whether nature chooses durations of the plan", |state, _| {
        let (network, plan) = plan(state)?;
        truth(plan.has_natures_choice(network))
    }),
    fact("pinned", Of::Something("Drive#1.end"), "the time that an event is pinned to", |state, name| {
        let Selection::Node(node) = Selection::by_name(fresh(state)?, name)? else { return None };
        let pins = state.pins.all();
        time(pins.into_iter().find(|(pinned, _)| *pinned == node)?.1)
    }),
    fact("selection", Of::Nothing, "the name of what is selected; nothing is the empty word", |state, _| {
        words(state.selection.name(state.shown().and_then(|shown| shown.network.as_deref())))
    }),
    fact(
        "selected-kind",
        Of::Nothing,
        "what kind of thing is selected, such as occurrence, node or arc",
        |state, _| words(state.selection.kind()),
    ),
    fact("time", Of::Nothing, "the time shown", |state, _| measured(state.playback.time)),
    fact(
        "finished",
        Of::Nothing,
        "whether the run that is watched reaches the end of the mission",
        |state, _| truth(state.run_shown()?.ending == executive::Ending::Finished),
    ),
    fact("disturbances", Of::Nothing, "how many disturbances the run has", |state, _| {
        count(state.execution.disturbances().len())
    }),
];

/// What is known of the present text, complete.
pub(super) fn fresh(state: &AppState) -> Option<&Snapshot> {
    let revision = state.document.revision();
    state
        .shown()
        .map(AsRef::as_ref)
        .filter(|shown: &&Snapshot| shown.revision == revision && shown.stage == snapshot::Stage::Complete)
}

/// The answer to the present text, also if it does not compile.
fn latest(state: &AppState) -> Option<&Snapshot> {
    let revision = state.document.revision();
    let latest = state.snapshots.latest()?;
    (latest.revision == revision && latest.stage == snapshot::Stage::Complete).then_some(latest)
}

pub(super) fn network(state: &AppState) -> Option<&Network> {
    fresh(state)?.network.as_deref()
}

pub(super) fn plan(state: &AppState) -> Option<(&Network, &Plan)> {
    Some((network(state)?, fresh(state)?.plan()?))
}

fn failure(state: &AppState) -> Option<&kirk::Failure> {
    fresh(state)?.planning.as_ref()?.outcome.failure.as_ref()
}

fn window(state: &AppState, event: &str) -> Option<Window> {
    let (_, plan) = plan(state)?;
    match Selection::by_name(fresh(state)?, event)? {
        Selection::Node(node) => plan.windows.get(node.index()).copied().flatten(),
        _ => None,
    }
}

/// The bounds of an occurrence, or of an arc by its ends.
fn written(state: &AppState, name: &str) -> Option<(Time, Bound)> {
    let network = network(state)?;
    let of_occurrence = network.occurrences.iter().find(|it| it.name == name).and_then(|it| it.arc);
    let of_ends =
        || (0..network.arcs.len()).map(tpn::ArcId::from_index).find(|&arc| arc_name(network, arc) == name);
    let arc = network.arcs.get(of_occurrence.or_else(of_ends)?.index())?;
    Some((arc.lower, arc.upper))
}

fn levels(state: &AppState, resource: &str) -> Option<Levels> {
    let (network, plan) = plan(state)?;
    let at = network.resources.iter().position(|it| it.name == resource)?;
    plan.levels.get(at).copied()
}

fn bound(bound: Bound) -> Option<Value> {
    bound.finite().map_or_else(|| words("any time"), time)
}
