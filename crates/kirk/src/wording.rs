//! Reasons in the author's terms.

use controllability::{Broken, FailingRun, RunEvent};
use exact::{Rational, Time};
use rmpl::program::{Change, LabelMode};
use tpn::{
    Arc, ArcId, ArcKind, Block, BlockId, BlockKind, Choice, EventRef, LabelId, Network, OccurrenceKind,
    Supply, Use,
};

use crate::failure::{FailureKind, Member, NATURE_ENDS};
use crate::trace::{Constraint, CycleMember};

/// A reason to be told.
pub(crate) struct Told<'a> {
    pub(crate) network: &'a Network,
    pub(crate) kind: FailureKind,
    pub(crate) choices: &'a [Choice],
    pub(crate) conflict: &'a [Member],
    pub(crate) cycle: &'a [CycleMember],
}

/// Returns what contradicts what along a negative cycle, in the author's terms: what needs more time than something
/// else leaves it, and how much too much that is where something allows a time. `None` for an empty cycle.
pub fn contradiction(network: &Network, cycle: &[CycleMember]) -> Option<String> {
    let told = Told { network, kind: FailureKind::Temporal, choices: &[], conflict: &[], cycle };
    let bounds = told.bounds()?;
    let allows = |member: &CycleMember| {
        matches!(member.constraint, Constraint::Upper(_)) && is_telling(network, member)
    };
    let total = Time::checked_sum(cycle.iter().map(|member| member.weight)).and_then(Time::checked_neg);
    Some(match total.filter(|_| cycle.iter().any(allows)) {
        Some(excess) => format!("{bounds}: {excess} too long"),
        None => bounds,
    })
}

/// What needs time, in the order in which it is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Need {
    /// The least duration of an arc.
    Arc(ArcId),
    /// The way from where something sets out.
    Way,
    /// The gap between conflicting intervals.
    Gap,
}

/// What is told of a bound, and how many bounds are told so: a reader who adds up finds all that a sum is made of.
struct Counted<K> {
    kind: K,
    name: String,
    count: usize,
}

impl<K> Counted<K> {
    /// The name, in the plural if it represents several: `the delay`, `2 delays`, `MODE=A (2 times)`.
    fn text(&self) -> String {
        let Self { name, count, .. } = self;
        if *count == 1 {
            return name.clone();
        }
        match name.as_str() {
            "the delay" => format!("{count} delays"),
            UNNAMED_BLOCK => format!("{count} bounded blocks"),
            name => match name.strip_prefix("a gap of ") {
                Some(length) => format!("{count} gaps of {length}"),
                None => format!("{name} ({count} times)"),
            },
        }
    }
}

/// One more bound of a name.
fn count<K>(all: &mut Vec<Counted<K>>, kind: K, name: String) {
    match all.iter_mut().find(|known| known.name == name) {
        Some(known) => known.count += 1,
        None => all.push(Counted { kind, name, count: 1 }),
    }
}

/// Returns how many bounds were told.
fn counted<K>(all: &[Counted<K>]) -> usize {
    all.iter().map(|known| known.count).sum()
}

/// The start of a sentence about choices: `if D1 selects Charge() and D2 selects Drive(RIDGE), `; empty without choices.
pub fn after_choices(network: &Network, choices: &[Choice]) -> String {
    let choices: Vec<String> = choices
        .iter()
        .map(|choice| {
            let name = network.alternative_name(choice.decision, choice.alternative);
            format!("{} selects {name}", Network::decision_name(choice.decision))
        })
        .collect();
    match choices.as_slice() {
        [] => String::new(),
        [only] => format!("if {only}, "),
        [first @ .., last] => format!("if {} and {last}, ", first.join(", ")),
    }
}

impl Told<'_> {
    /// One sentence: what contradicts what, and after which choices.
    pub(crate) fn message(&self) -> String {
        let what = match self.kind {
            FailureKind::Temporal => {
                self.bounds().unwrap_or_else(|| "the bounds are inconsistent".to_owned())
            }
            FailureKind::OpenCondition => self.open_condition(),
            FailureKind::Threat => self.threat(),
            FailureKind::Resource => self.resource(),
            FailureKind::Controllability => self.controllability(),
        };
        format!("{}{what}", after_choices(self.network, self.choices))
    }

    fn conditions(&self) -> Vec<LabelId> {
        let labels = self.conflict.iter().filter_map(|member| match member {
            Member::Condition(label) => Some(*label),
            Member::Use(_) | Member::Bound(_) => None,
        });
        labels.collect()
    }

    /// The activities that compete for a resource, what is missing, and where its level would go.
    fn resource(&self) -> String {
        let uses: Vec<&Use> = (self.conflict.iter())
            .filter_map(|member| match member {
                Member::Use(used) => Some(&self.network.uses[used.index()]),
                _ => None,
            })
            .collect();
        let Some(first) = uses.first() else { return "resource demand exceeds capacity".to_owned() };
        let resource = &self.network.resources[first.resource.index()];
        let mut names: Vec<String> = Vec::new();
        for owner in uses.iter().map(|used| use_owner(self.network, used)) {
            if !names.contains(&owner) {
                names.push(owner);
            }
        }
        let names_joined = joined(&names);
        let name = &resource.name;
        if uses.iter().any(|used| used.resource != first.resource) {
            let mut shared: Vec<&str> = Vec::new();
            for used in &uses {
                let name = self.network.resources[used.resource.index()].name.as_str();
                if !shared.contains(&name) {
                    shared.push(name);
                }
            }
            let shared: Vec<String> = shared.into_iter().map(str::to_owned).collect();
            return format!(
                "{names_joined} share {}, but they do not fit one after the other",
                joined(&shared)
            );
        }
        if let Some(told) = self.level(&uses) {
            return told;
        }
        let sum = |change: Change| {
            let amounts = uses.iter().filter(|used| used.change == change).map(|used| used.amount);
            amounts.fold(Rational::default(), |sum, amount| sum.checked_add(amount).unwrap_or(sum))
        };
        let verb = if names.len() == 1 { "takes" } else { "together take" };
        let what = match resource.supply {
            Supply::Reusable { capacity } if capacity == Rational::ONE => {
                format!("{names_joined} do not fit one after the other on {name}")
            }
            Supply::Reusable { capacity } => format!(
                "{names_joined} {verb} {} of {name}, but its capacity is {capacity}, and they cannot wait for each other",
                sum(Change::Uses),
            ),
            Supply::Reservoir { least, greatest, level } => {
                let (taken, given) = (sum(Change::Consumes), sum(Change::Produces));
                // The amounts of drives have a minimum and a maximum: a plan has to keep the level for all between these.
                let [low, high] = uses.iter().fold([level; 2], |[low, high], used| {
                    let [less, more] = used.level_changes();
                    [low.checked_add(less).unwrap_or(low), high.checked_add(more).unwrap_or(high)]
                });
                if low >= least && high <= greatest {
                    let text =
                        format!("no order of {names_joined} keeps {name} between {least} and {greatest}");
                    return format!("{text}{}", driven(self.network, &uses));
                }
                let (verb, amount, after, beyond, end) = if low < least {
                    (
                        verb,
                        taken,
                        low,
                        least.checked_sub(low),
                        format!("below the minimum {least}, and not enough is produced"),
                    )
                } else {
                    let verb = if names.len() == 1 { "gives" } else { "together give" };
                    let end = format!("above the maximum {greatest}, and not enough is consumed");
                    (verb, given, high, high.checked_sub(greatest), end)
                };
                format!(
                    "{names_joined} {verb} {amount} of {name}: its level would go from {level} to {after}, which is {} {end} in time{}",
                    beyond.unwrap_or_default(),
                    driven(self.network, &uses)
                )
            }
        };
        match self.room() {
            Some(bounds) => format!("{what}: {bounds}"),
            None => what,
        }
    }

    /// A condition on a level among these uses of one reservoir, and what keeps it from holding.
    fn level(&self, uses: &[&Use]) -> Option<String> {
        let condition = uses.iter().find(|used| used.level.is_some())?;
        let asks = condition.level_text(&self.network.resources)?;
        let Supply::Reservoir { level, .. } = self.network.resources[condition.resource.index()].supply
        else {
            return None;
        };
        let mut others: Vec<String> = Vec::new();
        let mut after = level;
        for used in uses.iter().filter(|used| used.level.is_none()) {
            let [less, more] = used.level_changes();
            let by = if condition.change == Change::Produces { more } else { less };
            after = after.checked_add(by).unwrap_or(after);
            let owner = use_owner(self.network, used);
            if !others.contains(&owner) {
                others.push(owner);
            }
        }
        let name = use_owner(self.network, condition);
        let verb = if condition.change == Change::Produces { "consumed" } else { "produced" };
        let what = match others.as_slice() {
            [] => format!(
                "{name} requires {asks}, but the level at the start is {level}, and not enough is {verb} in time"
            ),
            others => format!(
                "{name} requires {asks}, but with {} the level would be {after}, and not enough is {verb} in time{}",
                joined(others),
                driven(self.network, uses)
            ),
        };
        Some(match self.room() {
            Some(bounds) => format!("{what}: {bounds}"),
            None => what,
        })
    }

    /// Returns what the environment chooses, and what that leaves no times for.
    fn controllability(&self) -> String {
        let (mut natures, mut rest) = (Vec::new(), Vec::new());
        let push = |names: &mut Vec<String>, name: String| {
            if !names.contains(&name) {
                names.push(name);
            }
        };
        for label in self.conditions() {
            let (label, owner) = (&self.network.labels[label.index()], interval_name(self.network, label));
            if label.mode == LabelMode::Ask && owner != label.text.as_str() {
                push(&mut rest, format!("{owner} requires {}", label.text));
            }
        }
        for member in self.conflict {
            let Member::Bound(Constraint::Lower(id) | Constraint::Upper(id)) = member else { continue };
            let arc = &self.network.arcs[id.index()];
            let name = arc_name(self.network, arc);
            if self.network.is_uncertain(*id) {
                let verb = if name.starts_with("the ") { "lasts" } else { "takes" };
                push(
                    &mut natures,
                    format!("{name} {verb} {} to {}", arc.lower.readable(), arc.upper.readable()),
                );
            } else if !is_structural(arc.kind) {
                match member {
                    Member::Bound(Constraint::Upper(_)) => {
                        push(
                            &mut rest,
                            format!("{name} {} {}", allowing_verb(self.network, arc), arc.upper.readable()),
                        );
                    }
                    _ if arc.lower != Time::ZERO => {
                        push(&mut rest, format!("{name} {}", needing(arc)));
                    }
                    _ => {}
                }
            }
        }
        let natures = joined(&natures);
        if rest.is_empty() {
            return format!("{natures} (uncontrolled), so no schedule works for every duration");
        }
        format!("{natures} (uncontrolled), so the remaining bounds cannot be met: {}", joined(&rest))
    }

    /// The activities that would move one vehicle at the same time, if that is what the conflict is about.
    fn movements(&self) -> Option<String> {
        let labels = self.conditions();
        let variable = self.network.labels[labels.first()?.index()].literal.variable;
        let name = self.network.variables[variable.index()].name.as_str();
        let vehicle = name.strip_suffix(".at")?;
        let is_movement = |label: &LabelId| {
            let label = &self.network.labels[label.index()];
            label.is_changing() && label.literal.variable == variable
        };
        if labels.len() < 2 || !labels.iter().all(is_movement) {
            return None;
        }
        let names: Vec<String> = labels.iter().map(|&label| interval_name(self.network, label)).collect();
        Some(format!("{} both move {vehicle}, which is in one place at a time", joined(&names)))
    }

    fn open_condition(&self) -> String {
        let asks: Vec<LabelId> = self.conditions();
        let Some(&ask) = asks.first() else { return "nothing supports a requirement".to_owned() };
        let label = &self.network.labels[ask.index()];
        let owner = interval_name(self.network, ask);
        let requires = if owner == label.text.as_str() {
            format!("{} is required here", label.text)
        } else {
            format!("{owner} requires {}", label.text)
        };
        if let Some(bounds) = self.bounds() {
            return format!("{requires}: {bounds}");
        }
        let unseen = self.network.unseen(label, self.network.labels.iter());
        if !unseen.is_empty() {
            return format!("{requires}, but {}", joined(&unseen));
        }
        let is_asserted = self
            .network
            .labels
            .iter()
            .any(|other| other.mode == LabelMode::Tell && other.literal.supports(&label.literal));
        if is_asserted {
            format!("{requires}, but nothing asserts it with these choices")
        } else {
            format!("{requires}, but nothing asserts it")
        }
    }

    fn threat(&self) -> String {
        if let Some(movements) = self.movements() {
            return match self.room() {
                Some(bounds) => format!("{movements}: {bounds}"),
                None => format!("{movements}, and they cannot wait for each other"),
            };
        }
        let mut names: Vec<String> = Vec::new();
        for label in self.conditions() {
            let name = format!(
                "{} of {}",
                self.network.labels[label.index()].text,
                interval_name(self.network, label)
            );
            let name =
                if interval_name(self.network, label) == self.network.labels[label.index()].text.as_str() {
                    self.network.labels[label.index()].text.to_string()
                } else {
                    name
                };
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let labels: Vec<&tpn::Label> =
            self.conditions().iter().map(|label| &self.network.labels[label.index()]).collect();
        let unseen: Vec<String> = labels
            .iter()
            .filter(|label| label.mode == LabelMode::Ask)
            .flat_map(|ask| self.network.unseen(ask, labels.iter().copied()))
            .collect();
        let reason = if unseen.is_empty() { String::new() } else { format!(", because {}", joined(&unseen)) };
        let kept_apart = format!("{} overlap, and the planner cannot separate them{reason}", joined(&names));
        match self.bounds().or_else(|| self.room()) {
            Some(bounds) => format!("{kept_apart}: {bounds}"),
            None => kept_apart,
        }
    }

    /// Returns what leaves too little time, where the conflict has no cycle to show.
    fn room(&self) -> Option<String> {
        let mut limits: Vec<String> = Vec::new();
        for member in self.conflict {
            let Member::Bound(Constraint::Upper(arc)) = member else { continue };
            let arc = &self.network.arcs[arc.index()];
            if !is_structural(arc.kind) {
                let name = arc_name(self.network, arc);
                let limit = format!("{name} {} {}", allowing_verb(self.network, arc), arc.upper.readable());
                if !limits.contains(&limit) {
                    limits.push(limit);
                }
            }
        }
        (!limits.is_empty()).then(|| joined(&limits))
    }

    /// Returns what needs more time than something else leaves it.
    fn bounds(&self) -> Option<String> {
        // In textual order, whatever way round the cycle goes.
        let mut needs: Vec<Counted<Need>> = Vec::new();
        let mut allows: Vec<Counted<&'static str>> = Vec::new();
        // What would have to wait.
        let mut waiting: Option<LabelId> = None;
        let (mut needed, mut allowed) = (Some(Time::ZERO), Some(Time::ZERO));
        for member in self.cycle {
            match member.constraint {
                Constraint::Lower(arc) => {
                    needed = needed.and_then(|needed| needed.checked_sub(member.weight));
                    if is_telling(self.network, member) {
                        let name = arc_name(self.network, &self.network.arcs[arc.index()]);
                        count(&mut needs, Need::Arc(arc), name);
                    }
                }
                Constraint::Upper(arc) => {
                    allowed = allowed.and_then(|allowed| allowed.checked_add(member.weight));
                    let arc = &self.network.arcs[arc.index()];
                    if is_telling(self.network, member) {
                        count(&mut allows, allowing_verb(self.network, arc), arc_name(self.network, arc));
                    }
                }
                Constraint::Order(order) => {
                    waiting = Some(order.then);
                    needed = needed.and_then(|needed| needed.checked_sub(member.weight));
                    if member.weight != Time::ZERO {
                        let gap = format!("a gap of {}", shown(member.weight.checked_neg()));
                        count(&mut needs, Need::Gap, gap);
                    }
                }
                Constraint::Link(link) => {
                    waiting = waiting.or(Some(link.ask));
                    allowed = allowed.and_then(|allowed| allowed.checked_add(member.weight));
                }
                Constraint::Departure(way) => {
                    needed = needed.and_then(|needed| needed.checked_sub(member.weight));
                    if member.weight != Time::ZERO {
                        let name = format!("the drive of {}", interval_name(self.network, way.movement));
                        count(&mut needs, Need::Way, name);
                    }
                }
                Constraint::UseOrder(_) => {
                    needed = needed.and_then(|needed| needed.checked_sub(member.weight));
                }
            }
        }
        if self.cycle.is_empty() {
            return None;
        }
        needs.sort_by_key(|need| need.kind);
        let verb = if counted(&needs) > 1 { "need" } else { "needs" };
        let names: Vec<String> = needs.iter().map(Counted::text).collect();
        let needs = if needs.is_empty() { self.unnamed_need() } else { joined(&names) };
        let (needed, allowed) = (shown(needed), shown(allowed));
        Some(match allows.as_slice() {
            [] => match waiting {
                Some(label) => {
                    let name = interval_name(self.network, label);
                    format!("{needs} {verb} at least {needed}, but {name} cannot wait that long")
                }
                None => format!("{needs} {verb} at least {needed}, but the mission leaves no time for it"),
            },
            [only] if only.count == 1 => {
                format!("{needs} {verb} at least {needed}, but {} {} {allowed}", only.name, only.kind)
            }
            _ => {
                let names: Vec<String> = allows.iter().map(Counted::text).collect();
                format!(
                    "{needs} {verb} at least {needed}, but {} together allow only {allowed}",
                    joined(&names)
                )
            }
        })
    }

    /// Returns what takes the time of a cycle in which nothing with a name does.
    fn unnamed_need(&self) -> String {
        let has = |wanted: fn(Constraint) -> bool| self.cycle.iter().any(|it| wanted(it.constraint));
        let what = if has(|it| matches!(it, Constraint::Order(_))) {
            "separating them"
        } else if has(|it| matches!(it, Constraint::UseOrder(_) | Constraint::Departure(_))) {
            "running them one after the other"
        } else {
            "their order in the mission"
        };
        what.to_owned()
    }
}

/// A time as people read it, where it fits.
fn shown(time: Option<Time>) -> String {
    time.map_or_else(|| "a time too large to represent".to_owned(), Time::readable)
}

/// Returns whether a bound says something to the author: glue does not.
pub(crate) fn is_telling(network: &Network, member: &CycleMember) -> bool {
    let arc = match member.constraint {
        Constraint::Lower(arc) | Constraint::Upper(arc) => &network.arcs[arc.index()],
        Constraint::Link(_) | Constraint::Order(_) | Constraint::UseOrder(_) | Constraint::Departure(_) => {
            return false;
        }
    };
    let is_structural = is_structural(arc.kind);
    // A duration of zero at least says nothing; one of zero at most does, where it is written.
    !is_structural && (matches!(member.constraint, Constraint::Upper(_)) || member.weight != Time::ZERO)
}

/// Of a longer run only the last events are told.
const MAX_RUN_LINES: usize = 20;

/// A run in which the environment makes a mission fail, a line for each thing that happens.
pub(crate) fn failing_run(network: &Network, run: &FailingRun) -> Vec<String> {
    let event = |event: &RunEvent| {
        let time = event.time.readable();
        if let Some(natures) = event.natures {
            let name = arc_name(network, &network.arcs[natures.index()]);
            return Some(format!("at {time} {NATURE_ENDS} {name}"));
        }
        let is_named = !network.nodes[event.event.index()].events.is_empty();
        is_named.then(|| format!("at {time} {}", tpn::plan_json::node_name(network, event.event)))
    };
    let broken = match run.broken {
        Broken::Lower(arc) => {
            let arc = &network.arcs[arc.index()];
            format!("{} {}", arc_name(network, arc), needing(arc))
        }
        Broken::Upper(arc) => {
            let arc = &network.arcs[arc.index()];
            format!("{} {} {}", arc_name(network, arc), allowing_verb(network, arc), arc.upper.readable())
        }
        Broken::Order { earlier, later } => {
            let [earlier, later] = [earlier, later].map(|node| tpn::plan_json::node_name(network, node));
            format!("{later} must not come before {earlier}")
        }
    };
    let broken = format!("at {} the plan fails: {broken}", run.at.readable());
    let mut lines: Vec<String> = run.events.iter().filter_map(event).collect();
    // What breaks a long run is what happens last.
    let left_out = lines.len().saturating_sub(MAX_RUN_LINES);
    if left_out > 1 {
        lines.splice(..left_out, [format!("{left_out} earlier events, as planned")]);
    }
    lines.push(broken);
    lines.iter().map(|line| network.readable(line)).collect()
}

/// Returns whether the bounds of an arc are rules of the language, which no author wrote.
pub(crate) fn is_structural(kind: ArcKind) -> bool {
    matches!(
        kind,
        ArcKind::Glue | ArcKind::Fork | ArcKind::Join | ArcKind::Choice | ArcKind::Merge | ArcKind::Point
    )
}

/// Returns what an author calls an arc.
pub(crate) fn arc_name(network: &Network, arc: &Arc) -> String {
    if let Some(occurrence) = arc.occurrence {
        let occurrence = &network.occurrences[occurrence.index()];
        match occurrence.kind {
            OccurrenceKind::Assertion => {
                if let Some(label) = arc.labels.first() {
                    return network.labels[label.index()].text.to_string();
                }
            }
            OccurrenceKind::Delay => return "the delay".to_owned(),
            OccurrenceKind::Scenario => return "the scenario".to_owned(),
            OccurrenceKind::Scope => return block_name(network, arc),
            OccurrenceKind::Primitive | OccurrenceKind::Activity => {}
        }
        let same = network.occurrences.iter().filter(|other| other.activity == occurrence.activity).count();
        return if same > 1 { occurrence.name.to_string() } else { occurrence.activity.to_string() };
    }
    if arc.kind == ArcKind::Constraint {
        let [from, to] = [arc.from, arc.to].map(|node| {
            let events = &network.nodes[node.index()].events;
            let is_minor = |event: &&EventRef| {
                network.occurrences[event.occurrence.index()].kind == OccurrenceKind::Delay
            };
            let told = events.iter().rfind(|event| !is_minor(event)).or(events.first());
            told.map_or_else(|| "an event".to_owned(), |&event| network.event_name(event))
        });
        return format!("the bound from {from} to {to}");
    }
    match arc.labels.first() {
        Some(label) => network.labels[label.index()].text.to_string(),
        None => block_name(network, arc),
    }
}

/// What a block is called that says nothing by which to tell it from others.
const UNNAMED_BLOCK: &str = "the bounded block";

/// Returns what tells a block with bounds from others: its first and its last activity in the text, `the block from
/// Drive to Photo`. Its line would not do: a text that means the same in other places keeps its plan, and so the
/// sentences about it.
fn block_name(network: &Network, arc: &Arc) -> String {
    let is_own = |block: &&Block| match &block.kind {
        BlockKind::Scope { arcs, .. } => {
            arcs.iter().any(|&id| std::ptr::eq(&raw const network.arcs[id.index()], arc))
        }
        _ => false,
    };
    let mut parts = Vec::new();
    if let Some(Block { kind: BlockKind::Scope { child, .. }, .. }) = network.blocks.iter().find(is_own) {
        collect_activities(network, *child, &mut parts);
    }
    match parts.as_slice() {
        [] => UNNAMED_BLOCK.to_owned(),
        [only] => format!("the block around {only}"),
        [first, .., last] => format!("the block from {first} to {last}"),
    }
}

/// The names of the activities and assertions in a block, in textual order, without those inside of activities.
fn collect_activities(network: &Network, block: BlockId, names: &mut Vec<String>) {
    let mut waiting = vec![block];
    while let Some(block) = waiting.pop() {
        let of_arc = |arc: ArcId| {
            let arc = &network.arcs[arc.index()];
            let kind = arc.occurrence.map(|it| network.occurrences[it.index()].kind);
            let is_named = matches!(
                kind,
                Some(OccurrenceKind::Primitive | OccurrenceKind::Activity | OccurrenceKind::Assertion)
            );
            is_named.then(|| arc_name(network, arc))
        };
        match &network.blocks[block.index()].kind {
            BlockKind::Leaf { arc } => names.extend(of_arc(*arc)),
            BlockKind::Scope { child, arcs, .. } => match arcs.iter().find_map(|&arc| of_arc(arc)) {
                Some(name) => names.push(name),
                None => waiting.push(*child),
            },
            BlockKind::Guard { child, .. } => waiting.push(*child),
            BlockKind::Sequence { children: parts }
            | BlockKind::Parallel { branches: parts }
            | BlockKind::Choose { alternatives: parts, .. } => waiting.extend(parts.iter().rev()),
        }
    }
}

fn interval_name(network: &Network, label: LabelId) -> String {
    arc_name(network, &network.arcs[network.labels[label.index()].arc.index()])
}

/// Returns who uses a resource.
fn use_owner(network: &Network, used: &Use) -> String {
    match used.owner {
        Some(owner) => network.occurrences[owner.index()].name.to_string(),
        None => arc_name(network, &network.arcs[used.arc.index()]),
    }
}

/// Returns what the minimum of an arc asks for. A negative one is how far its second event may come before the first.
fn needing(arc: &Arc) -> String {
    match arc.lower.checked_neg().filter(|ahead| ahead.is_positive()) {
        Some(ahead) => format!("allows only {} in the other direction", ahead.readable()),
        None => format!("needs at least {}", arc.lower.readable()),
    }
}

/// The minimum and maximum amounts of drives that take of the resource of `uses`, or give to it: of these uses, and of others
/// that could help them. Empty if no amount depends on the distance.
fn driven(network: &Network, uses: &[&Use]) -> String {
    let Some(first) = uses.first() else { return String::new() };
    let ranges = network.uses.iter().filter(|used| {
        let is_other = used.change != first.change;
        used.resource == first.resource && used.at_least < used.amount && (is_other || uses.contains(used))
    });
    let ranges = ranges.map(|used| {
        let verb = if used.change == Change::Produces { "gives" } else { "takes" };
        format!("{} {verb} {}", use_owner(network, used), used.readable_amount())
    });
    let ranges: Vec<String> = ranges.collect();
    if ranges.is_empty() {
        return String::new();
    }
    format!(" (depending on the distance that is really driven, {})", joined(&ranges))
}

fn allowing_verb(network: &Network, arc: &Arc) -> &'static str {
    match arc.occurrence.map(|occurrence| network.occurrences[occurrence.index()].kind) {
        Some(OccurrenceKind::Assertion) => "holds for only",
        Some(OccurrenceKind::Primitive | OccurrenceKind::Activity) => "takes at most",
        Some(OccurrenceKind::Delay) => "lasts at most",
        Some(OccurrenceKind::Scenario | OccurrenceKind::Scope) | None => "allows only",
    }
}

fn joined(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] if names.len() <= 4 => format!("{} and {last}", first.join(", ")),
        [first, second, rest @ ..] => format!("{first}, {second} and {} others", rest.len()),
    }
}
