//! The steps of a conflict-driven search in words: who comes before whom and why, who competes for what, what follows
//! from what, and what has been learned.

use exact::Rational;
#[cfg(test)]
mod tests;

use kirk::{Departing, Event, SearchRound, Trace, TreeChoice, TreeNodeId};
use rmpl::program::{Change, LabelMode, Measure};
use tpn::{Extent, Goal, LabelId, Network, Ordering, Supply, UseId, UseOrdering};

/// Longer lists are cut.
const MAX_LISTED: usize = 6;

/// One event in a sentence.
pub(super) fn event(network: &Network, trace: &Trace, event: &Event) -> Option<String> {
    Some(match event {
        Event::Begin(round) => begin(network, round),
        Event::TryLink { link } => {
            format!("{}.", gives(network, link.ask, Some(link.tell)))
        }
        Event::TryOrder { order } => {
            let why = reason_of_order(network, *order);
            format!("Order {} before {}: {why}.", owner(network, order.first), owner(network, order.then))
        }
        Event::TryUseOrder { order } => use_order(network, *order),
        Event::TryStart { used, by } => {
            let (user, resource) = (user(network, *used), resource(network, *used));
            format!("Start {user} as early as possible, by {by}; other users of {resource} wait.")
        }
        Event::Imply { choice, holds: true, because } if because.is_empty() => {
            format!("For every choice: {}.", fact(network, *choice))
        }
        Event::Imply { choice, holds: true, because } => {
            let verb = if because.len() == 1 { "implies" } else { "imply" };
            format!("{} {verb} {}.", facts(network, because), fact(network, *choice))
        }
        Event::Imply { choice, holds: false, because } if because.is_empty() => {
            format!("Ruled out for every choice: {}.", fact(network, *choice))
        }
        Event::Imply { choice, holds: false, because } => {
            let verb = if because.len() == 1 { "rules" } else { "rule" };
            format!("{} {verb} out {}.", facts(network, because), fact(network, *choice))
        }
        Event::Unclosable { ask } => {
            format!(
                "Failure: no assertion is left that supports {} of {}.",
                text(network, *ask),
                owner(network, *ask)
            )
        }
        Event::Unresolvable { left, right } => {
            let why = reason_of_order(network, Ordering { first: *left, then: *right });
            let (left, right) = (owner(network, *left), owner(network, *right));
            format!("Failure: no order of {left} and {right} is possible: {why}.")
        }
        Event::NoAlternative { decision } => {
            format!("Failure: {} has no alternative left.", Network::decision_name(*decision))
        }
        Event::Unsharable { uses } => {
            format!("Failure: {}, and none can wait longer.", demand(network, uses))
        }
        Event::NotBetter { choices } if choices.is_empty() && is_best_first(trace) => {
            "Closed: no plan from this state is better than the best plan found.".to_owned()
        }
        Event::NotBetter { choices } if choices.is_empty() => {
            "Failure: no plan is better than the best plan found.".to_owned()
        }
        Event::NotBetter { choices } => {
            format!("Failure: no plan with {} is better than the best plan found.", facts(network, choices))
        }
        Event::Clash { choices } => match choices.as_slice() {
            [] => "Failure: the constraints are inconsistent for every choice.".to_owned(),
            [only] => format!("Failure: {} is impossible.", fact(network, *only)),
            _ => format!("Failure: {} are incompatible.", facts(network, choices)),
        },
        Event::Uncontrollable { choices } if choices.is_empty() => {
            "Failure: the mission is not controllable, for every choice.".to_owned()
        }
        Event::Uncontrollable { choices } => format!(
            "Failure: the mission is not controllable with {}. {}",
            facts(network, choices),
            learned(network, choices)
        ),
        Event::Circle { orders } if orders.is_empty() => {
            "Failure: simultaneous events can't be ordered.".to_owned()
        }
        Event::Circle { orders } => {
            format!("Failure: simultaneous events can't be ordered with {}.", facts(network, orders))
        }
        Event::NoRoomForGap => "Failure: no time is left for a gap between adjacent intervals.".to_owned(),
        Event::Learn { choices } => learned(network, choices),
        Event::Known { choices } => {
            format!("Failure, ruled out by a learned conflict: {}.", never(network, choices))
        }
        Event::Threat { left, right } => {
            let why = reason_of_order(network, Ordering { first: *left, then: *right });
            let (left, right) = (owner(network, *left), owner(network, *right));
            format!("Threat: {why}. Either {left} or {right} must come first.")
        }
        Event::Overload { uses } => format!("{}: one must wait for another.", demand(network, uses)),
        Event::OutOfRange { early, late } => out_of_range(network, early, late),
        Event::Restart => "Restart with all learned conflicts.".to_owned(),
        Event::Backjump { to, because } => backjump(network, trace, *to, because),
        Event::Keep { orders, uses } => {
            let kept = orders.iter().map(|&order| TreeChoice::Order(order));
            let kept: Vec<TreeChoice> =
                kept.chain(uses.iter().map(|&order| TreeChoice::UseOrder(order))).collect();
            if kept.is_empty() {
                "The times are consistent, and the choices imply all necessary orderings.".to_owned()
            } else {
                format!(
                    "The times are consistent. The plan keeps these orderings: {}.",
                    facts(network, &kept)
                )
            }
        }
        Event::Bound { values } => {
            format!("Open: no plan from this state is better than {}.", goals(network, values))
        }
        Event::Visit { values, waiting: 0 } => {
            format!("Continue here: best possible {}; no other state is open.", goals(network, values))
        }
        Event::Visit { values, waiting } => {
            let others = if *waiting == 1 {
                "1 other state is".to_owned()
            } else {
                format!("{waiting} other states are")
            };
            format!("Continue here: best possible {}; {others} open.", goals(network, values))
        }
        Event::Improve { values } => format!("Best plan so far: {}.", goals(network, values)),
        _ => return None,
    })
}

fn is_best_first(trace: &Trace) -> bool {
    matches!(trace.events.first().map(|entry| &entry.event), Some(Event::Begin(round)) if round.is_best_first)
}

/// Returns what was learned, in a sentence.
pub fn learned(network: &Network, choices: &[TreeChoice]) -> String {
    format!("Learned: {}.", never(network, choices))
}

/// Choices that a search has learned never to make together again.
pub fn never(network: &Network, choices: &[TreeChoice]) -> String {
    match choices {
        [] => "no choice can succeed".to_owned(),
        [TreeChoice::Apart] => "some intervals must touch".to_owned(),
        [only] => format!("never {}", fact(network, *only)),
        [first, rest @ ..] => {
            format!("never {} together with {}", fact(network, *first), facts(network, rest))
        }
    }
}

/// A choice as a part of a sentence.
pub fn fact(network: &Network, choice: TreeChoice) -> String {
    match choice {
        TreeChoice::Decision { decision, alternative } => {
            let name = network.alternative_name(decision, alternative);
            format!("{name} in {}", Network::decision_name(decision))
        }
        TreeChoice::Link(link) => {
            let (ask, tell) = (owner(network, link.ask), giver(network, link.tell));
            format!("{} for {ask} from {tell}", text(network, link.ask))
        }
        TreeChoice::Order(Ordering { first, then }) => {
            let (one, other) = (owner(network, first), owner(network, then));
            if one == other {
                format!("{} before {}", network.label_name(first), network.label_name(then))
            } else if vehicle(network, first).is_some() {
                format!("{one} before {other}")
            } else {
                format!("{one} before {other} ({})", variable(network, first))
            }
        }
        TreeChoice::UseOrder(UseOrdering { first, then }) => {
            let resource = resource(network, first);
            format!("{} before {} ({resource})", user(network, first), user(network, then))
        }
        TreeChoice::Start { used, by } => {
            format!("{} by {by} ({})", user(network, used), resource(network, used))
        }
        TreeChoice::Later { used, than } => {
            format!("{} after {than} ({})", user(network, used), resource(network, used))
        }
        TreeChoice::Departure(Departing { movement, before }) => {
            let (movement, label) = (owner(network, movement), &network.labels[before.index()]);
            if label.extent == Extent::Initial {
                format!(
                    "{movement} from the initial place of {}",
                    vehicle(network, before).unwrap_or_default()
                )
            } else {
                format!("{movement} from the destination of {}", owner(network, before))
            }
        }
        TreeChoice::NoLink { ask } => format!("no support for {}", network.label_name(ask)),
        TreeChoice::Apart => "keeping all gaps".to_owned(),
    }
}

/// Returns which assertion supports a requirement; without one, that nothing does.
pub(super) fn gives(network: &Network, ask: LabelId, tell: Option<LabelId>) -> String {
    let giver = tell.map_or_else(|| "Nothing".to_owned(), |tell| giver(network, tell));
    format!("{giver} supports {} of {}", text(network, ask), owner(network, ask))
}

/// Returns what a choice decides, whichever of its alternatives is taken.
pub(super) fn decided(network: &Network, choice: TreeChoice) -> String {
    match choice {
        TreeChoice::Decision { decision, .. } => Network::decision_name(decision),
        TreeChoice::Link(link) => {
            format!("the support for {} of {}", text(network, link.ask), owner(network, link.ask))
        }
        TreeChoice::Order(order) => {
            let [first, then] = named(network, [order.first, order.then]);
            format!("the order of {first} and {then}")
        }
        other => fact(network, other),
    }
}

/// Two conditions by whose they are, or in full if both are of the same.
pub(super) fn named(network: &Network, labels: [LabelId; 2]) -> [String; 2] {
    let owners = labels.map(|label| owner(network, label));
    if owners[0] == owners[1] { labels.map(|label| network.label_name(label)) } else { owners }
}

fn facts(network: &Network, choices: &[TreeChoice]) -> String {
    let mut names: Vec<String> =
        choices.iter().take(MAX_LISTED).map(|&choice| fact(network, choice)).collect();
    if choices.len() > MAX_LISTED {
        names.push(format!("{} more", choices.len() - MAX_LISTED));
    }
    joined(&names)
}

/// `a, b and c`.
fn joined(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [only] => only.clone(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

fn begin(network: &Network, round: &SearchRound) -> String {
    let SearchRound { is_in_textual_order, is_best_first, values, bound } = round;
    if let Some(goal) = values.len().checked_sub(1).and_then(|last| network.objective.get(last)) {
        let more = if goal.is_maximized { "more" } else { "less" };
        let measure = measure(goal);
        let proven = bound.map_or_else(String::new, |bound| format!("; no plan has {more} than {bound}"));
        return format!(
            "Search for a better plan than {}: {more} {measure}{proven}.",
            goals(network, values)
        );
    }
    if *is_best_first {
        return "Expand the state with the best bound first. The first complete plan is optimal.".to_owned();
    }
    match (is_in_textual_order, network.objective.is_empty()) {
        (true, _) => "Search in text order, learning a conflict from each failure.",
        (false, false) => "Find a first plan, then improve it.",
        (false, true) => "Too many failures in text order: decide the choices that cause failures first.",
    }
    .to_owned()
}

/// Each goal with its value.
fn goals(network: &Network, values: &[Rational]) -> String {
    let known = network.objective.iter().zip(values);
    let known: Vec<String> = known.map(|(goal, value)| format!("{} {value}", measure(goal))).collect();
    joined(&known)
}

fn measure(goal: &Goal) -> String {
    let terms = goal.terms.iter().map(|(factor, measure)| {
        let name = match measure {
            Measure::Cost => "cost",
            Measure::Reward => "reward",
            Measure::End => "end",
            Measure::Length => "length",
        };
        if *factor == Rational::ONE { name.to_owned() } else { format!("{factor} {name}") }
    });
    terms.collect::<Vec<_>>().join(" + ")
}

fn backjump(network: &Network, trace: &Trace, to: TreeNodeId, because: &[TreeNodeId]) -> String {
    let choice = |id: TreeNodeId| trace.tree.get(id as usize).and_then(|state| state.choice);
    let causes: Vec<TreeChoice> = because.iter().filter_map(|&state| choice(state)).collect();
    let to = choice(to).map_or_else(|| "the start".to_owned(), |choice| fact(network, choice));
    match causes.len() {
        0 => format!("Backjump to {to}."),
        _ => format!("Backjump to {to}: the failure depends only on {}.", facts(network, &causes)),
    }
}

/// Returns why two intervals must be ordered.
fn reason_of_order(network: &Network, Ordering { first, then }: Ordering) -> String {
    let (one, other) = (&network.labels[first.index()], &network.labels[then.index()]);
    if one.mode == LabelMode::Tell && other.mode == LabelMode::Tell {
        if let Some(vehicle) = vehicle(network, first) {
            return format!("both move {vehicle}");
        }
        if network.is_lasting(first) {
            return format!("both set {}", variable(network, first));
        }
    } else if network.is_lasting(first) && one.mode != other.mode {
        let (ask, tell) = if one.mode == LabelMode::Ask { (first, then) } else { (then, first) };
        return format!(
            "{} requires {}, which {} changes",
            owner(network, ask),
            text(network, ask),
            owner(network, tell)
        );
    }
    format!("{} and {} cannot hold at once", text(network, first), text(network, then))
}

fn use_order(network: &Network, order: UseOrdering) -> String {
    let (first, then) = (&network.uses[order.first.index()], &network.uses[order.then.index()]);
    let resource = resource(network, order.first);
    let asked = first.level_text(&network.resources).or_else(|| then.level_text(&network.resources));
    if let Some(asked) = asked {
        let (first, then) = (user(network, order.first), user(network, order.then));
        return format!("Order {first} before {then}, so that {asked} holds.");
    }
    let why = match (first.change, then.change) {
        (Change::Produces, Change::Consumes) => format!("{resource} is produced before it is consumed"),
        (Change::Consumes, Change::Produces) => format!("{resource} is consumed before it is produced"),
        (Change::Consumes, _) => format!("both consume {resource}"),
        (Change::Produces, _) => format!("both produce {resource}"),
        (Change::Uses, _) => format!("both use {resource}"),
    };
    format!("Order {} before {}: {why}.", user(network, order.first), user(network, order.then))
}

/// Returns who takes how much of a resource that has less.
fn demand(network: &Network, uses: &[UseId]) -> String {
    let Some(&first) = uses.first() else { return "A resource is overused".to_owned() };
    let resource = &network.resources[network.uses[first.index()].resource.index()];
    let names = users(network, uses);
    match resource.supply {
        Supply::Reusable { capacity } => {
            let amounts = uses.iter().map(|used| network.uses[used.index()].amount);
            let sum = amounts.fold(Rational::default(), |sum, it| sum.checked_add(it).unwrap_or(sum));
            let together = if uses.len() == 1 { "" } else { "Together " };
            let verb = if uses.len() == 1 { "takes" } else { "take" };
            format!("{together}{names} {verb} {sum} of {}, which has {capacity}", resource.name)
        }
        Supply::Reservoir { .. } => format!("{names} together need too much {}", resource.name),
    }
}

fn out_of_range(network: &Network, early: &[UseId], late: &[UseId]) -> String {
    let Some(used) = early.first().map(|first| &network.uses[first.index()]) else { return String::new() };
    let resource = &network.resources[used.resource.index()];
    let Supply::Reservoir { least, greatest, .. } = resource.supply else { return String::new() };
    let earlier = match late.len() {
        0 => None,
        1 => Some(users(network, late)),
        _ => Some(format!("one of {}", users(network, late))),
    };
    let is_condition = |id: &&UseId| network.uses[id.index()].level.is_some();
    if let Some(&condition) = early.iter().find(is_condition) {
        let others: Vec<UseId> = early.iter().copied().filter(|&id| id != condition).collect();
        let by = if others.is_empty() { String::new() } else { format!(" with {}", users(network, &others)) };
        let asked = network.uses[condition.index()].level_text(&network.resources).unwrap_or_default();
        let first = match earlier {
            Some(who) => format!("{who} must come earlier, or another order must be found"),
            None if others.is_empty() => "nothing can prevent this".to_owned(),
            None => "another order must be found".to_owned(),
        };
        return format!("{} needs {asked}, which fails{by}: {first}.", user(network, condition));
    }
    let place =
        if used.change == Change::Produces { format!("above {greatest}") } else { format!("below {least}") };
    let names = users(network, early);
    let verb = if early.len() == 1 { "takes" } else { "take" };
    let those = if early.len() == 1 { "that" } else { "one of them" };
    let first = earlier.map_or_else(
        || "no other use can prevent this".to_owned(),
        |who| format!("{who} must come before {those}"),
    );
    format!("{names} {verb} {} {place}: {first}.", resource.name)
}

fn users(network: &Network, uses: &[UseId]) -> String {
    let names: Vec<String> = uses.iter().map(|&used| user(network, used)).collect();
    joined(&names)
}

/// Whose use it is.
fn user(network: &Network, used: UseId) -> String {
    let owner = network.uses[used.index()].owner.and_then(|owner| network.occurrences.get(owner.index()));
    owner.map_or_else(|| network.use_name(used), |owner| owner.name.to_string())
}

fn resource(network: &Network, used: UseId) -> &str {
    &network.resources[network.uses[used.index()].resource.index()].name
}

/// Whose condition it is.
fn owner(network: &Network, label: LabelId) -> String {
    let it = &network.labels[label.index()];
    let owner = it.owner.and_then(|owner| network.occurrences.get(owner.index()));
    owner.map_or_else(|| network.label_name(label), |owner| owner.name.to_string())
}

/// Returns what gives a condition.
fn giver(network: &Network, label: LabelId) -> String {
    if network.labels[label.index()].extent == Extent::Initial {
        "the start of the mission".to_owned()
    } else {
        owner(network, label)
    }
}

fn text(network: &Network, label: LabelId) -> &str {
    &network.labels[label.index()].text
}

fn variable(network: &Network, label: LabelId) -> &str {
    &network.variables[network.labels[label.index()].literal.variable.index()].name
}

/// The vehicle whose place a label is about.
fn vehicle(network: &Network, label: LabelId) -> Option<&str> {
    variable(network, label).strip_suffix(".at")
}
