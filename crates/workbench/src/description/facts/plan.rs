//! The text, its network, the plan, and why there is none.

use exact::{Bound, Time};
use rmpl::program::Change;
use tpn::{Levels, Network, OccurrenceKind, Window};

use super::{Row, count, measured, time, truth, words};
use crate::description::Description;
use crate::lesson::Value;
use crate::state::Status;
use crate::state::selection::arc_name;

pub(super) const VALUES: &[Row] = &[
    ("plan", |it, _| {
        let planning = it.fresh()?.planning.as_ref();
        let valid =
            planning.and_then(|planning| planning.verdict.as_ref()).is_some_and(|verdict| verdict.valid);
        truth(it.status() == Status::Plan && valid)
    }),
    ("no-plan", |it, _| {
        it.latest()?;
        truth(it.status() == Status::NoPlan)
    }),
    ("errors", |it, _| {
        let is_error = |it: &&snapshot::Problem| it.severity == rmpl::Severity::Error;
        count(it.latest()?.problems.iter().filter(is_error).count())
    }),
    ("problem", |it, code| truth(it.latest()?.problems.iter().any(|it| it.code == code))),
    ("says", |it, words| {
        let unspaced = |text: &str| -> String { text.split_whitespace().collect() };
        truth(unspaced(it.text()).contains(&unspaced(words)))
    }),
    ("events", |it, _| count(it.network()?.nodes.len())),
    ("constraints", |it, _| count(it.network()?.arcs.len())),
    ("decisions", |it, _| count(it.network()?.decisions.len())),
    ("activities", |it, _| {
        let is_primitive = |it: &&tpn::Occurrence| it.kind == OccurrenceKind::Primitive;
        count(it.network()?.occurrences.iter().filter(is_primitive).count())
    }),
    ("selected", |it, name| {
        let (network, plan) = it.plan()?;
        let occurrence = network.occurrences.iter().find(|it| it.name == name)?;
        truth(plan.selected_nodes.get(occurrence.start.index()) == Some(&true))
    }),
    ("choice", |it, name| {
        let (_, plan) = it.plan()?;
        let choice = plan.choices.iter().find(|it| Network::decision_name(it.decision) == name)?;
        count(choice.alternative as usize)
    }),
    ("alternatives", |it, name| {
        let network = it.network()?;
        let mut decisions = (0..network.decisions.len()).map(tpn::DecisionId::from_index);
        let found = decisions.find(|&id| Network::decision_name(id) == name)?;
        count(network.decisions.get(found.index())?.alternatives.len())
    }),
    ("assertions", |it, text| {
        let is_meant = |it: &&tpn::Label| it.mode == rmpl::program::LabelMode::Tell && it.text == text;
        count(it.network()?.labels.iter().filter(is_meant).count())
    }),
    ("conflicting", |it, _| count(it.plan()?.1.conflict_order.len())),
    ("lower", |it, name| time(written(it, name)?.0)),
    ("upper", |it, name| bound(written(it, name)?.1)),
    ("earliest", |it, name| time(window(it, name)?.earliest)),
    ("latest", |it, name| bound(window(it, name)?.latest)),
    ("slack", |it, name| {
        let window = window(it, name)?;
        bound(window.latest.checked_sub(window.earliest)?)
    }),
    ("links", |it, _| count(it.plan()?.1.causal_links.len())),
    ("link", |it, text| {
        let (network, plan) = it.plan()?;
        let label = |id: tpn::LabelId| network.labels.get(id.index());
        let link =
            plan.causal_links.iter().find(|link| label(link.ask).is_some_and(|ask| ask.text == text))?;
        let owner = network.occurrences.get(label(link.tell)?.owner?.index())?;
        words(owner.name.as_str())
    }),
    ("orderings", |it, _| count(it.plan()?.1.orderings_added.len())),
    ("uses-ordered", |it, _| count(it.plan()?.1.uses_ordered.len())),
    ("ordered", |it, names| {
        let (first, then) = names.split_once(',')?;
        let (network, plan) = it.plan()?;
        let owner = |owner: Option<tpn::OccurrenceId>| network.occurrences.get(owner?.index());
        let condition = |id: tpn::LabelId| owner(network.labels.get(id.index())?.owner);
        let used = |id: tpn::UseId| owner(network.uses.get(id.index())?.owner);
        let conditions = plan.orderings_added.iter().map(|it| [condition(it.first), condition(it.then)]);
        let mut all = conditions.chain(plan.uses_ordered.iter().map(|it| [used(it.first), used(it.then)]));
        let is = |it: Option<&tpn::Occurrence>, name: &str| it.is_some_and(|it| it.name == name.trim());
        truth(all.any(|[one, other]| is(one, first) && is(other, then)))
    }),
    ("consumes", |it, name| amount(it, name, Change::Consumes)),
    ("produces", |it, name| amount(it, name, Change::Produces)),
    ("least", |it, name| match levels(it, name)? {
        Levels::Range { low, .. } => Some(Value::Number(low)),
        Levels::Peak(_) => None,
    }),
    ("greatest", |it, name| match levels(it, name)? {
        Levels::Range { high, .. } => Some(Value::Number(high)),
        Levels::Peak(peak) => Some(Value::Number(peak)),
    }),
    ("end", |it, _| {
        let (network, plan) = it.plan()?;
        time(plan.windows.get(network.end.index()).copied().flatten()?.earliest)
    }),
    ("reward", |it, _| Some(Value::Number(it.plan()?.1.quality.reward))),
    ("cost", |it, _| Some(Value::Number(it.plan()?.1.quality.cost))),
    ("optimal", |it, _| truth(it.plan()?.1.quality.is_optimal?)),
    ("length", |it, name| {
        let snapshot = it.fresh()?;
        let network = it.network()?;
        let is_meant = |it: &&snapshot::Traverse| {
            name.is_empty()
                || network.occurrences.get(it.occurrence.index()).is_some_and(|it| it.name == name)
        };
        let lengths: Vec<f64> = snapshot.traverses.iter().filter(is_meant).map(|it| it.length_m).collect();
        if lengths.is_empty() { None } else { measured(lengths.iter().sum()) }
    }),
    ("reasons", |it, _| {
        it.fresh()?;
        count(it.failure()?.reasons.len())
    }),
    ("ways-out", |it, _| count(it.fresh()?.planning.as_ref()?.ways_out().len())),
    ("natures-choice", |it, _| {
        let (network, plan) = it.plan()?;
        truth(plan.has_natures_choice(network))
    }),
    ("pinned", |it, name| time(it.pinned(it.node(name)?)?)),
    ("selection", |it, _| words(it.selected_name())),
    ("selected-kind", |it, _| words(it.selected_kind())),
    ("time", |it, _| measured(it.time())),
    ("finished", |it, _| truth(it.execution()?.ending == executive::Ending::Finished)),
    ("predictions", |it, _| count(it.predictions().made().len())),
    ("right-predictions", |it, _| count(it.predictions().right())),
    ("disturbances", |it, _| count(it.disturbances())),
];

fn window(it: &Description<'_>, event: &str) -> Option<Window> {
    let (_, plan) = it.plan()?;
    plan.windows.get(it.node(event)?.index()).copied().flatten()
}

/// The bounds of an occurrence, or of an arc by its ends.
fn written(it: &Description<'_>, name: &str) -> Option<(Time, Bound)> {
    let network = it.network()?;
    let of_occurrence = network.occurrences.iter().find(|it| it.name == name).and_then(|it| it.arc);
    let of_ends =
        || (0..network.arcs.len()).map(tpn::ArcId::from_index).find(|&arc| arc_name(network, arc) == name);
    let arc = network.arcs.get(of_occurrence.or_else(of_ends)?.index())?;
    Some((arc.lower, arc.upper))
}

fn levels(it: &Description<'_>, resource: &str) -> Option<Levels> {
    let (network, plan) = it.plan()?;
    let at = network.resources.iter().position(|it| it.name == resource)?;
    plan.levels.get(at).copied()
}

/// Returns how much of the first resource that it changes so an occurrence takes or gives.
fn amount(it: &Description<'_>, name: &str, change: Change) -> Option<Value> {
    let network = it.network()?;
    let is_meant = |it: &&tpn::Use| {
        let owner = it.owner.and_then(|owner| network.occurrences.get(owner.index()));
        it.change == change && owner.is_some_and(|owner| owner.name == name)
    };
    Some(Value::Number(network.uses.iter().find(is_meant)?.amount))
}

fn bound(bound: Bound) -> Option<Value> {
    bound.finite().map_or_else(|| words("any time"), time)
}
