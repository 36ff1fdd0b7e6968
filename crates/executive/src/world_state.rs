//! What is so in the simulated world while a plan is executed: the value of each variable that lasts, the place of each
//! vehicle among them (`V.at`), what is in use of each resource, and the level of each reservoir.
//!
//! It follows from what has happened alone and knows nothing of the plan's proofs: what an activity needs is compared with
//! what there is. Events of one instant happen in the order that the plan has for them (SPEC 10.4), and are written down in
//! it. What is needed is looked at when an instant is over, because the world may change values and levels at it, too.

use std::collections::{BTreeMap, BTreeSet};

use exact::Rational;
use rmpl::program::{Change, LabelMode};
use smol_str::SmolStr;
use tpn::{
    Extent, LabelId, Network, NodeId, OccurrenceId, Plan, PlanOrder, Resource, ResourceId, Supply, UseId,
    ValueId, ValueSet, VariableId,
};

use crate::log::Happening;

/// What events do to the world, and what they ask of it, by event.
#[derive(Clone, Debug, Default)]
pub(crate) struct Effects {
    by_node: BTreeMap<NodeId, Vec<Effect>>,
    /// What the plan requires of variables that last.
    pub(crate) requirements: Vec<LabelId>,
    /// The same by the events where they start, and by those where they end.
    beginnings: BTreeMap<NodeId, Vec<LabelId>>,
    endings: BTreeMap<NodeId, Vec<LabelId>>,
    /// Of two changes of a variable, which the plan puts first.
    order: PlanOrder,
    /// The producer of each requirement, as the plan has it.
    pub(crate) carriers: BTreeMap<LabelId, LabelId>,
    /// What the plan takes of reservoirs and gives to them.
    pub(crate) moves: Vec<UseId>,
    /// What the plan asks of levels.
    pub(crate) conditions: Vec<UseId>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Effect {
    /// What is in use is free again.
    Frees(UseId),
    /// The variable has the value that a label gives, and keeps it.
    Gives(LabelId),
    /// A reservoir's level changes.
    Moves(UseId),
    /// The variable begins to change.
    Changes(LabelId),
    /// A reusable resource is in use.
    Takes(UseId),
}

impl Effects {
    pub(crate) fn new(network: &Network, plan: &Plan) -> Self {
        let mut effects = Self {
            carriers: plan.causal_links.iter().map(|link| (link.ask, link.tell)).collect(),
            order: PlanOrder::new(plan),
            ..Self::default()
        };
        let mut add = |node: NodeId, effect: Effect| effects.by_node.entry(node).or_default().push(effect);
        for id in (0..network.labels.len()).map(LabelId::from_index) {
            let label = &network.labels[id.index()];
            if !plan.selected_arcs[label.arc.index()] || !network.is_lasting(id) {
                continue;
            }
            match (label.mode, label.extent) {
                (LabelMode::Ask, _) => {
                    let (start, end) = network.interval(id);
                    effects.requirements.push(id);
                    effects.beginnings.entry(start).or_default().push(id);
                    effects.endings.entry(end).or_default().push(id);
                }
                (LabelMode::Tell, Extent::Initial) => {}
                (LabelMode::Tell, _) => {
                    if label.is_changing() && network.interval(id).0 != network.ready(id) {
                        add(network.interval(id).0, Effect::Changes(id));
                    }
                    add(network.ready(id), Effect::Gives(id));
                }
            }
        }
        for id in (0..network.uses.len()).map(UseId::from_index) {
            let used = &network.uses[id.index()];
            if !plan.selected_arcs[used.arc.index()] {
                continue;
            }
            if used.level.is_some() {
                effects.conditions.push(id);
            } else if used.change == Change::Uses {
                add(used.start, Effect::Takes(id));
                add(used.end, Effect::Frees(id));
            } else {
                add(used.moment(), Effect::Moves(id));
                effects.moves.push(id);
            }
        }
        for list in effects.by_node.values_mut() {
            list.sort_unstable();
        }
        effects
    }

    /// Returns what gives variables their values at an event.
    pub(crate) fn given_at(&self, node: NodeId) -> Vec<LabelId> {
        let given = |effect: &Effect| match effect {
            Effect::Gives(label) => Some(*label),
            _ => None,
        };
        self.by_node.get(&node).into_iter().flatten().filter_map(given).collect()
    }

    /// The requirements that start at an event.
    pub(crate) fn beginning_at(&self, node: NodeId) -> &[LabelId] {
        self.beginnings.get(&node).map_or(&[], Vec::as_slice)
    }

    /// The requirements that end at an event.
    pub(crate) fn ending_at(&self, node: NodeId) -> &[LabelId] {
        self.endings.get(&node).map_or(&[], Vec::as_slice)
    }
}

/// The value of a variable that lasts.
#[derive(Clone, Debug, Default, PartialEq)]
struct Held {
    value: Option<ValueId>,
    /// What gave it; nothing for the world.
    by: Option<LabelId>,
    changing: Vec<LabelId>,
    /// What it was at some moment of the present instant.
    seen: Vec<ValueId>,
}

/// The world's state at the present instant.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WorldState {
    /// Indexed by variable.
    held: Vec<Held>,
    /// By resource: of a reservoir its level, of another what is in use.
    levels: Vec<Rational>,
    /// Requirements that lasted no time and are of the present instant.
    momentary: Vec<LabelId>,
    /// By variable: the requirements that continue.
    under_way: Vec<BTreeSet<LabelId>>,
    /// What may be otherwise, or be needed, since the present instant.
    touched: BTreeSet<VariableId>,
    moved: BTreeSet<ResourceId>,
    /// The conditions on levels that go on.
    kept: BTreeSet<UseId>,
    /// Those that did not hold at some moment of the present instant.
    unmet: Vec<UseId>,
}

/// Something that is not as an activity needs it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Lack {
    /// A requirement without its value.
    Value(LabelId),
    /// A resource outside its range, or of which more is in use than there is.
    Level(ResourceId),
    /// A condition on a level that did not hold.
    Condition(UseId),
}

impl WorldState {
    /// The state at the start.
    pub(crate) fn new(network: &Network) -> Self {
        let mut held = vec![Held::default(); network.variables.len()];
        for label in network.labels.iter().filter(|label| label.extent == Extent::Initial) {
            let held: &mut Held = &mut held[label.literal.variable.index()];
            held.value = value_of(&label.literal.values);
            held.seen.extend(held.value);
        }
        let levels = network.resources.iter().map(|resource| resource.supply.initial_level()).collect();
        Self {
            under_way: vec![BTreeSet::new(); held.len()],
            touched: (0..held.len()).map(VariableId::from_index).collect(),
            moved: (0..network.resources.len()).map(ResourceId::from_index).collect(),
            held,
            levels,
            momentary: Vec::new(),
            kept: BTreeSet::new(),
            unmet: Vec::new(),
        }
    }

    /// Another plan is followed from now on: orders that are not resources of the mission are its own, and it has its own
    /// requirements.
    pub(crate) fn follow(
        &mut self,
        network: &Network,
        plan: &Plan,
        effects: &Effects,
        has_happened: impl Fn(NodeId) -> bool,
    ) {
        let Self { levels: start, under_way, touched, moved, .. } = Self::new(network);
        (self.under_way, self.touched, self.moved) = (under_way, touched, moved);
        for &requirement in &effects.requirements {
            let (from, until) = network.interval(requirement);
            if has_happened(from) && !has_happened(until) {
                self.require(network, requirement);
            }
        }
        let goes_on = |id: &&UseId| {
            let condition = &network.uses[id.index()];
            has_happened(condition.start) && !has_happened(condition.end)
        };
        self.kept = effects.conditions.iter().filter(goes_on).copied().collect();
        self.unmet.clear();
        self.levels.resize(start.len(), Rational::ZERO);
        for (index, _) in network.resources.iter().enumerate().filter(|(_, it)| is_unnamed(it)) {
            let own = network.uses.iter().filter(|used| used.resource.index() == index);
            let mut level = start[index];
            for used in own.filter(|used| plan.selected_arcs[used.arc.index()]) {
                let by = match used.change {
                    Change::Uses if has_happened(used.start) && !has_happened(used.end) => Some(used.amount),
                    Change::Produces if has_happened(used.end) => Some(used.counted()),
                    Change::Consumes if has_happened(used.start) => used.counted().checked_neg(),
                    _ => None,
                };
                level = by.and_then(|by| level.checked_add(by)).unwrap_or(level);
            }
            self.levels[index] = level;
        }
    }

    /// The value of a variable; `None` while it changes, and of one that does not last.
    pub(crate) fn value(&self, variable: VariableId) -> Option<ValueId> {
        let held = self.held.get(variable.index())?;
        held.value.filter(|_| held.changing.is_empty())
    }

    /// Returns whether something is changing a variable.
    pub(crate) fn is_changing(&self, variable: VariableId) -> bool {
        self.held.get(variable.index()).is_some_and(|held| !held.changing.is_empty())
    }

    /// The level of a reservoir, or what is in use of another resource.
    pub(crate) fn level(&self, resource: ResourceId) -> Rational {
        self.levels.get(resource.index()).copied().unwrap_or_default()
    }

    /// Advances time, and drops what held between two values at the last instant.
    pub(crate) fn advance(&mut self) {
        self.momentary.clear();
        self.moved.clear();
        self.unmet.clear();
        for variable in std::mem::take(&mut self.touched) {
            let held = &mut self.held[variable.index()];
            held.seen.clear();
            held.seen.extend(held.value.filter(|_| held.changing.is_empty()));
        }
    }

    /// A requirement begins.
    pub(crate) fn require(&mut self, network: &Network, requirement: LabelId) {
        let variable = network.labels[requirement.index()].literal.variable;
        self.under_way[variable.index()].insert(requirement);
        self.touched.insert(variable);
    }

    /// A requirement is over.
    pub(crate) fn release(&mut self, network: &Network, requirement: LabelId) {
        let variable = network.labels[requirement.index()].literal.variable;
        self.under_way[variable.index()].remove(&requirement);
    }

    /// An event happens. Returns what changes.
    pub(crate) fn happen(&mut self, network: &Network, effects: &Effects, node: NodeId) -> Vec<Happening> {
        let mut happenings = Vec::new();
        let starting = || effects.conditions.iter().filter(move |id| network.uses[id.index()].start == node);
        for &id in starting().filter(|id| !network.uses[id.index()].is_lasting()) {
            if self.is_unmet(network, id) {
                self.unmet.push(id);
            }
        }
        for &effect in effects.by_node.get(&node).into_iter().flatten() {
            match effect {
                Effect::Changes(label) => {
                    let of = &network.labels[label.index()];
                    self.held[of.literal.variable.index()].changing.push(label);
                    self.touched.insert(of.literal.variable);
                    happenings.push(self.value_shown(network, of.literal.variable, of.owner));
                }
                Effect::Gives(label) => {
                    let of = &network.labels[label.index()];
                    self.give(effects, label, of.literal.variable, value_of(&of.literal.values));
                    happenings.push(self.value_shown(network, of.literal.variable, of.owner));
                }
                Effect::Takes(id) | Effect::Frees(id) | Effect::Moves(id) => {
                    let used = &network.uses[id.index()];
                    let is_more = match effect {
                        Effect::Takes(_) => true,
                        Effect::Frees(_) => false,
                        _ => used.change == Change::Produces,
                    };
                    let by = if is_more { Some(used.counted()) } else { used.counted().checked_neg() };
                    happenings.extend(self.move_level(
                        network,
                        used.resource,
                        by.unwrap_or_default(),
                        used.owner,
                    ));
                }
            }
        }
        self.kept.extend(starting().filter(|id| network.uses[id.index()].is_lasting()));
        self.ask_kept(network);
        self.kept.retain(|id| network.uses[id.index()].end != node);
        happenings
    }

    /// Takes note of conditions on levels that go on and do not hold now: what changes at one event is one change.
    pub(crate) fn ask_kept(&mut self, network: &Network) {
        let unmet: Vec<UseId> =
            self.kept.iter().copied().filter(|&condition| self.is_unmet(network, condition)).collect();
        self.unmet.extend(unmet);
    }

    /// Returns whether a condition on a level does not hold now.
    fn is_unmet(&self, network: &Network, condition: UseId) -> bool {
        let of = &network.uses[condition.index()];
        of.level.is_some_and(|level| !level.order.holds(self.level(of.resource), level.bound))
    }

    /// A label gives its value. Of two without length at one instant the plan says which is the later one.
    fn give(&mut self, effects: &Effects, label: LabelId, variable: VariableId, value: Option<ValueId>) {
        self.touched.insert(variable);
        let held = &mut self.held[variable.index()];
        held.changing.retain(|&changing| changing != label);
        held.seen.extend(value);
        let is_before = |later: LabelId| effects.order.is_before(label, later);
        if !held.by.is_some_and(is_before) {
            (held.value, held.by) = (value, Some(label));
        }
    }

    /// The world gives a variable a value. Returns what changes: nothing where an activity is changing it, which will give
    /// it its own value in the end.
    pub(crate) fn set_value(
        &mut self,
        network: &Network,
        variable: VariableId,
        value: ValueId,
    ) -> Option<Happening> {
        let held = self.held.get_mut(variable.index()).filter(|held| held.changing.is_empty())?;
        (held.value, held.by) = (Some(value), None);
        held.seen.push(value);
        self.touched.insert(variable);
        Some(self.value_shown(network, variable, None))
    }

    /// A level changes by so much. Returns how it stands then; nothing of resources that no text declares, and where the
    /// amount does not count.
    pub(crate) fn move_level(
        &mut self,
        network: &Network,
        resource: ResourceId,
        by: Rational,
        owner: Option<OccurrenceId>,
    ) -> Option<Happening> {
        let level = self.levels.get_mut(resource.index())?;
        self.moved.insert(resource);
        *level = level.checked_add(by).unwrap_or(*level);
        let level = *level;
        let of = &network.resources[resource.index()];
        (!by.is_zero() && !is_unnamed(of)).then(|| Happening::Level {
            resource: of.name.clone(),
            level,
            by: owner.map(|owner| network.occurrences[owner.index()].name.clone()),
        })
    }

    /// Changes are broken off, and what was in use is free again. A variable that was changing keeps its value; where a
    /// vehicle is that stopped on its way is not a location.
    pub(crate) fn abandon(
        &mut self,
        network: &Network,
        changing: &[LabelId],
        used: &[UseId],
    ) -> Vec<Happening> {
        let mut happenings = Vec::new();
        for label in changing {
            let of = &network.labels[label.index()];
            let held = &mut self.held[of.literal.variable.index()];
            if !held.changing.contains(label) {
                continue;
            }
            held.changing.retain(|changing| changing != label);
            self.touched.insert(of.literal.variable);
            if network.variables[of.literal.variable.index()].name.ends_with(".at") {
                (held.value, held.by) = (None, None);
            } else {
                happenings.push(self.value_shown(network, of.literal.variable, of.owner));
            }
        }
        for id in used {
            let of = &network.uses[id.index()];
            let by = of.amount.checked_neg().unwrap_or_default();
            happenings.extend(self.move_level(network, of.resource, by, of.owner));
        }
        happenings
    }

    fn value_shown(&self, network: &Network, variable: VariableId, owner: Option<OccurrenceId>) -> Happening {
        let of = &network.variables[variable.index()];
        Happening::State {
            variable: of.name.clone(),
            value: self.value(variable).and_then(|value| of.values.get(value.index()).cloned()),
            by: owner.map(|owner| network.occurrences[owner.index()].name.clone()),
        }
    }

    /// A requirement that lasts no time is of the present instant.
    pub(crate) fn need_now(&mut self, requirement: LabelId) {
        self.momentary.push(requirement);
    }

    /// Returns what is not as it must be when the present instant is over: only what has changed in it can have become
    /// so.
    pub(crate) fn lack(&self, network: &Network) -> Option<Lack> {
        let holds = |label: &LabelId| {
            let literal = &network.labels[label.index()].literal;
            self.value(literal.variable).is_some_and(|value| literal.values.contains(value))
        };
        let held = |label: &LabelId| {
            let literal = &network.labels[label.index()].literal;
            self.held[literal.variable.index()].seen.iter().any(|&value| literal.values.contains(value))
        };
        let momentary = self.momentary.iter().find(|label| !held(label));
        let lasting = || {
            let needed = self.touched.iter().flat_map(|variable| &self.under_way[variable.index()]);
            needed.filter(|label| !holds(label)).min()
        };
        if let Some(&label) = momentary.or_else(lasting) {
            return Some(Lack::Value(label));
        }
        if let Some(&condition) = self.unmet.first() {
            return Some(Lack::Condition(condition));
        }
        let is_kept = |resource: &ResourceId| {
            let level = self.level(*resource);
            match network.resources[resource.index()].supply {
                Supply::Reusable { capacity } => level <= capacity,
                Supply::Reservoir { least, greatest, .. } => (least..=greatest).contains(&level),
            }
        };
        self.moved.iter().find(|resource| !is_kept(resource)).map(|&resource| Lack::Level(resource))
    }

    /// Returns what a variable is, for people: `IN`, `changing`.
    pub(crate) fn words(&self, network: &Network, variable: VariableId) -> SmolStr {
        let named = |value: ValueId| network.variables[variable.index()].values.get(value.index()).cloned();
        match self.value(variable) {
            Some(value) => named(value).unwrap_or_default(),
            None if self.is_changing(variable) => "changing".into(),
            None => "unknown".into(),
        }
    }
}

/// Returns whether a resource represents an order, such as that of the parts of an `unordered` block, and is not one of
/// the mission.
fn is_unnamed(resource: &Resource) -> bool {
    resource.name.contains('#')
}

/// The one value that an assertion names.
fn value_of(values: &ValueSet) -> Option<ValueId> {
    match values {
        ValueSet::In(values) => values.first().copied(),
        ValueSet::NotIn(_) => None,
    }
}
