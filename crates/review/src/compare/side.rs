//! One plan as it is compared: everything by its name.

use std::collections::{BTreeMap, BTreeSet};

use exact::{Bound, Time};
use nalgebra::Point2;
use serde::Deserialize as _;
use serde_json::Value;
use snapshot::Snapshot;
use tpn::plan_json::plan_to_json;
use tpn::{Network, OccurrenceKind, Ordering, StateOrder, UseOrdering, Window};

use super::Subject;
use crate::schedule::scheduled;

/// A plan, or that there is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Side {
    /// What it is called: a file, a revision.
    pub name: String,
    /// Whether there is a plan.
    pub is_planned: bool,
    /// The alternatives taken, by decision.
    pub choices: BTreeMap<String, Taken>,
    /// What happens, by name.
    pub items: BTreeMap<String, Item>,
    /// The assertion that carries each requirement.
    pub links: BTreeMap<String, String>,
    /// Conflicting intervals, the first before the second.
    pub orderings: BTreeSet<[String; 2]>,
    /// What gives variables that keep their values one, in order, by variable.
    pub states: BTreeMap<String, Vec<String>>,
    /// How far resources are used and what the plan is worth, by name, as figures.
    pub figures: BTreeMap<String, String>,
    /// The ways of traverses; `None` where they are not known, as in a plan's JSON.
    pub ways: Option<BTreeMap<String, Way>>,
}

/// An alternative taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Taken {
    /// Its number, from 0.
    pub alternative: u32,
    /// What it is about, where the text is known.
    pub text: Option<String>,
}

/// Something that happens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    pub subject: Subject,
    /// Its arguments, where they are known.
    pub arguments: Option<String>,
    /// When it may start and end.
    pub windows: [Window; 2],
}

/// The way of a traverse.
#[derive(Clone, Debug, PartialEq)]
pub struct Way {
    /// The path, in meters.
    pub points_m: Vec<Point2<f64>>,
    /// Its length along the map, in meters.
    pub length_m: f64,
}

/// Why a JSON document is not a plan.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SideError {
    /// It does not have the shape of a plan.
    #[error("this is not a plan: {0}")]
    Shape(String),
}

impl Side {
    /// The plan of a mission that was worked out.
    pub fn of_snapshot(name: &str, snapshot: &Snapshot) -> Self {
        let mut side = Self { name: name.to_owned(), ways: Some(BTreeMap::new()), ..Self::default() };
        let (Some(network), Some(plan)) = (snapshot.network.as_deref(), snapshot.plan()) else { return side };
        side.is_planned = true;
        side.choices = plan
            .choices
            .iter()
            .map(|choice| {
                let text = beginning(network, &snapshot.source, *choice);
                (
                    Network::decision_name(choice.decision),
                    Taken { alternative: choice.alternative, text: Some(text) },
                )
            })
            .collect();
        side.items = scheduled(network, plan)
            .into_iter()
            .map(|row| {
                let occurrence = &network.occurrences[row.occurrence.index()];
                let arguments: Vec<&str> =
                    occurrence.arguments.iter().map(smol_str::SmolStr::as_str).collect();
                let item = Item {
                    subject: subject(occurrence.kind),
                    arguments: Some(arguments.join(", ")),
                    windows: [row.start, row.end],
                };
                (occurrence.name.to_string(), item)
            })
            .collect();
        side.links = plan
            .causal_links
            .iter()
            .map(|link| (network.label_name(link.ask), network.label_name(link.tell)))
            .collect();
        let pair = |it: &Ordering| [network.label_name(it.first), network.label_name(it.then)];
        side.orderings = plan.conflict_order.iter().map(pair).collect();
        let used = |it: &UseOrdering| [network.use_name(it.first), network.use_name(it.then)];
        side.orderings.extend(plan.uses_ordered.iter().map(used));
        side.states = (plan.state_order.iter())
            .map(|StateOrder { variable, producers }| {
                let names = producers.iter().map(|&label| network.label_name(label));
                (network.variables[variable.index()].name.to_string(), names.collect())
            })
            .collect();
        side.figures = figures(&plan_to_json(network, plan));
        side.ways = Some(
            snapshot
                .traverses
                .iter()
                .filter_map(|traverse| {
                    let occurrence = network.occurrences.get(traverse.occurrence.index())?;
                    let points = traverse.legs.iter().flat_map(|leg| leg.points_m.iter().copied());
                    let way = Way { points_m: points.collect(), length_m: traverse.length_m };
                    Some((occurrence.name.to_string(), way))
                })
                .collect(),
        );
        side
    }

    /// A plan saved as JSON (DESIGN 4.2): an `enroute-plan` document, of which the first plan counts, or one plan.
    pub fn of_json(name: &str, document: &Value) -> Result<Self, SideError> {
        let mut side = Self { name: name.to_owned(), ..Self::default() };
        let plan = match document.get("plans") {
            Some(Value::Array(plans)) => match plans.first() {
                Some(plan) => plan,
                None => return Ok(side),
            },
            Some(_) => return Err(shape("`plans` must be a list")),
            None => document,
        };
        side.is_planned = true;
        for (decision, alternative) in members(plan, "choices")? {
            let alternative = alternative
                .as_u64()
                .and_then(|number| u32::try_from(number).ok())
                .ok_or_else(|| shape("a choice must be the number of an alternative"))?;
            side.choices.insert(decision.clone(), Taken { alternative, text: None });
        }
        side.items = items(plan)?;
        for link in list(plan, "causal_links") {
            let name = |member: &str| {
                let name = link.get(member).and_then(Value::as_str);
                name.map(str::to_owned).ok_or_else(|| shape("a causal link has the names `ask` and `tell`"))
            };
            side.links.insert(name("ask")?, name("tell")?);
        }
        side.figures = figures(plan);
        for pair in list(plan, "conflict_order").iter().chain(list(plan, "uses_ordered")) {
            match pair.as_array().map(Vec::as_slice) {
                Some([Value::String(first), Value::String(then)]) => {
                    side.orderings.insert([first.clone(), then.clone()]);
                }
                _ => return Err(shape("`conflict_order` must be a list of pairs of names")),
            }
        }
        if let Some(stated) = plan.get("state_order") {
            side.states = BTreeMap::deserialize(stated)
                .map_err(|_| shape("`state_order` has a list of names for each variable"))?;
        }
        Ok(side)
    }
}

/// The figures of a plan's JSON: the levels of its resources with a name, and what it is worth.
fn figures(plan: &Value) -> BTreeMap<String, String> {
    let number = |value: &Value| -> Option<String> { Some(Time::deserialize(value).ok()?.readable()) };
    let resources = plan.get("resources").and_then(Value::as_object).into_iter().flatten();
    let levels = resources.filter(|(name, _)| !name.contains('#')).filter_map(|(name, levels)| {
        let of = |member: &str| number(levels.get(member)?);
        let text = match of("peak") {
            Some(peak) => format!("at most {peak} of {}", of("capacity")?),
            None => format!("between {} and {}", of("low")?, of("high")?),
        };
        Some((name.clone(), text))
    });
    let worth = ["cost", "reward", "end"]
        .into_iter()
        .filter_map(|member| Some((member.to_owned(), number(plan.get(member)?)?)));
    let length = plan.get("length").and_then(Value::as_f64);
    let length = length.map(|length_m| ("length".to_owned(), format!("{length_m:.1} m")));
    levels.chain(worth).chain(length).collect()
}

/// Returns what happens in a plan's JSON: whatever has a window for its start and one for its end.
fn items(plan: &Value) -> Result<BTreeMap<String, Item>, SideError> {
    let primitives: BTreeSet<&str> = list(plan, "activities").iter().filter_map(Value::as_str).collect();
    let mut ends: BTreeMap<&str, [Option<Window>; 2]> = BTreeMap::new();
    for (event, window) in members(plan, "windows")? {
        let read = read_window(window)
            .ok_or_else(|| shape(&format!("the window of `{event}` must be a pair of exact times")))?;
        if let Some(name) = event.strip_suffix(".start") {
            ends.entry(name).or_default()[0] = Some(read);
        } else if let Some(name) = event.strip_suffix(".end") {
            ends.entry(name).or_default()[1] = Some(read);
        }
    }
    let item = |(name, ends): (&str, [Option<Window>; 2])| {
        let [Some(start), Some(end)] = ends else { return None };
        let subject = if primitives.contains(name) {
            Subject::Activity
        } else if name.starts_with("Tell(") || name.starts_with("Ask(") {
            Subject::Condition
        } else if name.starts_with("delay#") {
            Subject::Delay
        } else {
            Subject::Phase
        };
        Some((name.to_owned(), Item { subject, arguments: None, windows: [start, end] }))
    };
    Ok(ends.into_iter().filter_map(item).collect())
}

fn read_window(value: &Value) -> Option<Window> {
    let [earliest, latest] = value.as_array()?.as_slice() else { return None };
    Some(Window { earliest: Time::deserialize(earliest).ok()?, latest: Bound::deserialize(latest).ok()? })
}

fn members<'value>(
    plan: &'value Value,
    member: &str,
) -> Result<impl Iterator<Item = (&'value String, &'value Value)>, SideError> {
    let members = plan.get(member).and_then(Value::as_object);
    Ok(members.ok_or_else(|| shape(&format!("it has no `{member}`")))?.iter())
}

fn list<'value>(plan: &'value Value, member: &str) -> &'value [Value] {
    plan.get(member).and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default()
}

fn shape(message: &str) -> SideError {
    SideError::Shape(message.to_owned())
}

const fn subject(kind: OccurrenceKind) -> Subject {
    match kind {
        OccurrenceKind::Primitive => Subject::Activity,
        OccurrenceKind::Assertion => Subject::Condition,
        OccurrenceKind::Delay => Subject::Delay,
        OccurrenceKind::Activity | OccurrenceKind::Scenario | OccurrenceKind::Scope => Subject::Phase,
    }
}

/// Characters of an alternative that are shown.
const LONGEST_BEGINNING: usize = 48;

/// Returns how the text of an alternative begins.
fn beginning(network: &Network, source: &str, choice: tpn::Choice) -> String {
    let decision = network.decisions.get(choice.decision.index());
    let span = decision.and_then(|it| it.alternative_spans.get(choice.alternative as usize));
    let text = span.and_then(|span| source.get(span.range())).unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    let whole = words.join(" ");
    if whole.chars().count() <= LONGEST_BEGINNING {
        return whole;
    }
    let cut: String = whole.chars().take(LONGEST_BEGINNING - 1).collect();
    format!("{cut}…")
}
