//! A plan as data: what was selected, linked and ordered, and the window of every selected event.
//!
//! The planner makes it and the checker reads it; neither's code is here.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::iter;

use exact::{Bound, Rational, Time};
use rmpl::program::LabelMode;
use serde::{Deserialize, Serialize};

use crate::exchange::{Distinction, Exchanges};
use crate::network::{
    ArcId, DecisionId, EventRef, Extent, LabelId, Network, NodeId, Supply, UseId, VariableId,
};

/// A plan of a [`crate::Network`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The decisions that were reached and the alternative taken, in textual order.
    pub choices: Vec<Choice>,
    /// Whether each node is selected; indexed by node.
    pub selected_nodes: Vec<bool>,
    /// Whether each arc is selected; indexed by arc.
    pub selected_arcs: Vec<bool>,
    /// Which assertion carries each requirement, in textual order of the requirements.
    pub causal_links: Vec<CausalLink>,
    /// Every pair of conflicting selected intervals of variables that are known only where they are asserted, the earlier
    /// first.
    pub conflict_order: Vec<Ordering>,
    /// How many such pairs the document that the plan was read from leaves out.
    pub conflict_order_omitted: usize,
    /// What gives each variable that keeps its value one, in order; by variable.
    pub state_order: Vec<StateOrder>,
    /// The orderings that planning had to add, in the order they were added.
    pub orderings_added: Vec<Ordering>,
    /// The orderings of resource uses that planning had to add.
    pub uses_ordered: Vec<UseOrdering>,
    /// How far each resource is used over all schedules, by resource.
    pub levels: Vec<Levels>,
    /// What the plan is worth.
    pub quality: Quality,
    /// The window of each node relative to the start; `None` if not selected. Indexed by node.
    pub windows: Vec<Option<Window>>,
}

/// A decision taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Choice {
    pub decision: DecisionId,
    /// The alternative, from 0.
    pub alternative: u32,
}

/// `later − earlier ≥ least`, which planning added to a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Precedence {
    /// The event that comes first.
    pub earlier: NodeId,
    /// The event that comes after it.
    pub later: NodeId,
    /// The least time between them.
    pub least: Time,
}

impl Plan {
    /// Returns whether another plan of the network is the same: they make the same choices, rest each requirement on
    /// the same assertion, and order the same way what excludes each other. How they order uses of resources does not
    /// tell them apart.
    pub fn is_same(&self, other: &Self) -> bool {
        Distinction::of(self) == Distinction::of(other)
    }

    /// Returns what gives a variable its values, of what the plan selects: where it keeps them in the plan's order, the
    /// initial value first.
    pub fn told(&self, network: &Network, variable: VariableId) -> Vec<LabelId> {
        let labels = network.labels.iter().enumerate().filter(|(_, label)| {
            label.literal.variable == variable
                && label.mode == LabelMode::Tell
                && self.selected_arcs.get(label.arc.index()) == Some(&true)
        });
        let mut told: Vec<LabelId> = labels.map(|(at, _)| LabelId::from_index(at)).collect();
        // A plan orders what is more than one.
        if let Some(order) = self.state_order.iter().find(|order| order.variable == variable) {
            let places: BTreeMap<LabelId, usize> = order.producers.iter().copied().zip(0..).collect();
            told.sort_by_key(|label| places.get(label));
        }
        told
    }

    /// All that planning added to the network: what causal links, orderings and orderings of uses say about times.
    pub fn precedences(&self, network: &Network) -> Vec<Precedence> {
        let natures = network.natures_events(&self.selected_arcs);
        let links = self.causal_links.iter().flat_map(|link| link.precedences(network));
        let orderings =
            self.orderings_added.iter().map(|ordering| self.ordering_precedence(network, ordering, &natures));
        let uses = self.uses_ordered.iter().map(|ordering| ordering.precedence(network));
        links.chain(orderings).chain(uses).collect()
    }

    /// Returns which events come first where several happen at one time (SPEC 10.4): pairs of an earlier and a later
    /// event, whose transitive closure is the order within an instant. It follows the text, the causal links of
    /// variables that keep their values, and the orderings that planning chose; a valid plan has no cycle of such
    /// pairs. Nothing is before the start.
    pub fn instant_order(&self, network: &Network) -> Vec<[NodeId; 2]> {
        let selected = network.arcs.iter().zip(&self.selected_arcs).filter(|(_, is_selected)| **is_selected);
        let forward = selected.map(|(arc, _)| arc).filter(|arc| !arc.lower.is_negative());
        let arcs = forward.map(|arc| [arc.from, arc.to]);
        let pair = |precedence: Precedence| [precedence.earlier, precedence.later];
        let links = self.causal_links.iter().filter(|link| network.is_lasting(link.ask));
        let links = links.flat_map(|link| link.precedences(network)).map(pair);
        let orderings = self.orderings_added.iter().filter(|ordering| network.is_lasting(ordering.first));
        let orderings = orderings.map(|ordering| pair(self.ordering_precedence(network, ordering, &[])));
        let uses = self.uses_ordered.iter().map(|ordering| pair(ordering.precedence(network)));
        let pairs = arcs.chain(links).chain(orderings).chain(uses);
        pairs.filter(|&[earlier, later]| earlier != later && later != network.start).collect()
    }

    /// Returns whether an event is of something that the plan selects. Alternatives of foreign networks may end at one
    /// node, which has the ends of all of them.
    pub fn has_event(&self, network: &Network, event: EventRef) -> bool {
        let is_selected = |node: NodeId| self.selected_nodes.get(node.index()) == Some(&true);
        let occurrence = network.occurrences.get(event.occurrence.index());
        occurrence.is_some_and(|occurrence| is_selected(occurrence.start) && is_selected(occurrence.end))
    }

    /// Returns whether the environment chooses some duration of the plan, and the mission asks to withstand that.
    pub fn has_natures_choice(&self, network: &Network) -> bool {
        let arcs = (0..network.arcs.len()).map(ArcId::from_index);
        arcs.zip(&self.selected_arcs).any(|(arc, &is_selected)| is_selected && network.is_uncertain(arc))
    }

    /// The order of intervals that exclude each other, as far as it does not follow from the rest: of variables that keep
    /// their values each change with the next one, and each requirement with the change that ends what it rests on. Left out
    /// is what goes without saying: what holds at first comes before everything, and what an activity needs at its start
    /// before what it sets.
    pub fn telling_order(&self, network: &Network) -> Vec<Ordering> {
        let carriers: BTreeMap<LabelId, Vec<LabelId>> =
            self.causal_links.iter().fold(BTreeMap::new(), |mut carriers, link| {
                let asks: &mut Vec<LabelId> = carriers.entry(link.tell).or_default();
                asks.push(link.ask);
                carriers
            });
        let mut told = self.conflict_order.clone();
        for StateOrder { producers, .. } in &self.state_order {
            for (position, &producer) in producers.iter().enumerate() {
                let next = |label: LabelId| {
                    let mut later = producers[position + 1..].iter().copied();
                    later.find(|&other| network.conflict(label, other))
                };
                let asks = carriers.get(&producer).into_iter().flatten().copied();
                told.extend(
                    iter::once(producer)
                        .chain(asks)
                        .filter_map(|first| Some(Ordering { first, then: next(first)? })),
                );
            }
        }
        let known: BTreeSet<Ordering> = told.iter().copied().collect();
        told.extend(self.orderings_added.iter().copied().filter(|added| !known.contains(added)));
        told.retain(|order| {
            let (first, then) = (&network.labels[order.first.index()], &network.labels[order.then.index()]);
            first.extent != Extent::Initial && (first.owner.is_none() || first.owner != then.owner)
        });
        told.sort_unstable_by_key(|order| (order.first.min(order.then), order.first.max(order.then)));
        told
    }

    /// One interval ends before the other starts: with the gap that SPEC 5.3 asks for, of a variable that keeps its value
    /// without. A change that comes before a requirement is over when what carries that one is ready (SPEC 10.2).
    /// `natures` are the events that the environment executes ([`Network::natures_events`]): before what begins at one
    /// there is no gap (SPEC 13.1).
    pub fn ordering_precedence(
        &self,
        network: &Network,
        ordering: &Ordering,
        natures: &[bool],
    ) -> Precedence {
        let (earlier, later) = (network.interval(ordering.first).1, network.interval(ordering.then).0);
        if !network.is_lasting(ordering.first) {
            let is_natures = natures.get(later.index()).copied().unwrap_or(false);
            let least = if is_natures { Time::ZERO } else { network.threat_gap };
            return Precedence { earlier, later, least };
        }
        let carried = self.causal_links.iter().find(|link| link.ask == ordering.then);
        let later = carried.map_or(later, |link| network.ready(link.tell));
        Precedence { earlier, later, least: Time::ZERO }
    }
}

impl CausalLink {
    /// The requirement lies inside the assertion; of a variable that keeps its value, it begins when that is so
    /// (SPEC 5.2, 10.2).
    pub fn precedences(&self, network: &Network) -> Vec<Precedence> {
        let at_once = |earlier, later| Precedence { earlier, later, least: Time::ZERO };
        let (ask_start, ask_end) = network.interval(self.ask);
        if network.is_lasting(self.ask) {
            return vec![at_once(network.ready(self.tell), ask_start)];
        }
        let (tell_start, tell_end) = network.interval(self.tell);
        vec![at_once(tell_start, ask_start), at_once(ask_end, tell_end)]
    }
}

impl UseOrdering {
    /// When one is over, or has happened, the other begins, or happens (SPEC 11).
    pub fn precedence(&self, network: &Network) -> Precedence {
        let (first, then) = (&network.uses[self.first.index()], &network.uses[self.then.index()]);
        let (earlier, later) = match network.resources[first.resource.index()].supply {
            Supply::Reusable { .. } => (first.end, then.start),
            Supply::Reservoir { .. } => (first.last_moment(), then.moment()),
        };
        Precedence { earlier, later, least: Time::ZERO }
    }
}

/// An assertion that contains a requirement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CausalLink {
    /// The requirement.
    pub ask: LabelId,
    /// The assertion.
    pub tell: LabelId,
}

/// The producers of one variable that keeps its value, those that a plan selects (SPEC 10.2): of two that exclude each other
/// the first is over before the other begins. The initial value comes first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct StateOrder {
    /// What is given its values.
    pub variable: VariableId,
    /// What gives it its values. Neighbors that give it one and the same value may overlap; they are in textual order.
    pub producers: Vec<LabelId>,
}

/// Plans of one network, each once, in the order in which they were found. Of those that differ only in which of several
/// interchangeable vehicles does what, it is the one whose alternatives come first.
#[derive(Clone, Debug, Default)]
pub struct DistinctPlans {
    exchanges: Exchanges,
    plans: Vec<Plan>,
    /// Their places, by what tells them apart.
    places: BTreeMap<Distinction, usize>,
}

impl DistinctPlans {
    /// No plans of a network yet.
    pub fn new(network: &Network) -> Self {
        Self { exchanges: Exchanges::new(network), plans: Vec::new(), places: BTreeMap::new() }
    }

    /// Each plan once.
    pub fn plans(&self) -> &[Plan] {
        &self.plans
    }

    /// Adds a plan. Returns whether it is none of those that are there.
    pub fn insert(&mut self, plan: Plan) -> bool {
        match self.places.entry(self.exchanges.least(&plan)) {
            Entry::Vacant(place) => {
                place.insert(self.plans.len());
                self.plans.push(plan);
                true
            }
            Entry::Occupied(place) => {
                let known = &mut self.plans[*place.get()];
                if plan.choices < known.choices {
                    *known = plan;
                }
                false
            }
        }
    }

    /// The plans by themselves.
    pub fn into_plans(self) -> Vec<Plan> {
        self.plans
    }
}

/// Which of two intervals of one variable a plan puts first, where they exclude each other.
#[derive(Clone, Debug, Default)]
pub struct PlanOrder {
    pairs: BTreeSet<(LabelId, LabelId)>,
    /// Of variables that keep their values: the variable, and where the interval is among the others.
    places: BTreeMap<LabelId, (VariableId, usize)>,
}

impl PlanOrder {
    /// The order of a plan.
    pub fn new(plan: &Plan) -> Self {
        let pairs = plan.conflict_order.iter().map(|order| (order.first, order.then)).collect();
        let mut places = BTreeMap::new();
        for StateOrder { variable, producers } in &plan.state_order {
            let at = producers.iter().zip(0..).map(|(&producer, place)| (producer, (*variable, 2 * place)));
            places.extend(at);
        }
        // A requirement is right after what it rests on.
        let after: Vec<(LabelId, (VariableId, usize))> = (plan.causal_links.iter())
            .filter_map(|link| places.get(&link.tell).map(|&(of, place)| (link.ask, (of, place + 1))))
            .collect();
        places.extend(after);
        Self { pairs, places }
    }

    /// Returns whether the first interval is over before the other one begins, of two that exclude each other.
    pub fn is_before(&self, first: LabelId, then: LabelId) -> bool {
        let places = (self.places.get(&first), self.places.get(&then));
        let is_earlier = matches!(places, (Some(one), Some(other)) if one.0 == other.0 && one.1 < other.1);
        is_earlier || self.pairs.contains(&(first, then))
    }
}

/// Two conflicting intervals, one before the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Ordering {
    /// Ends before `then` starts.
    pub first: LabelId,
    /// Starts after `first` has ended.
    pub then: LabelId,
}

/// Two uses of one resource, one before the other: of a reusable resource `first` ends no later than `then` starts; of a
/// reservoir `first` happens no later than `then`, a consumption at its start and a production at its end (SPEC 11).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct UseOrdering {
    /// The earlier one.
    pub first: UseId,
    /// The later one.
    pub then: UseId,
}

/// How far a resource is used over all schedules of a plan (SPEC 11).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Levels {
    /// Of a reusable resource: the most that is used at a time.
    Peak(Rational),
    /// Of a reservoir: the minimum and the maximum level.
    Range {
        /// The least level.
        low: Rational,
        /// The greatest level.
        high: Rational,
    },
}

/// What a plan is worth (SPEC 12).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// What the selected activities cost.
    pub cost: Rational,
    /// What they are rewarded with.
    pub reward: Rational,
    /// The earliest time of the scenario's end.
    pub end: Time,
    /// Meters driven, once paths are known.
    pub length_m: f64,
    /// Whether no valid plan is better, where the mission has an objective.
    pub is_optimal: Option<bool>,
}

/// When an event may happen, in time units from the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Window {
    pub earliest: Time,
    pub latest: Bound,
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::{Choice, DistinctPlans, UseOrdering};
    use crate::network::{DecisionId, Network, NodeId, UseId};
    use crate::{Plan, Top, plan_json};

    fn network(text: &str) -> Network {
        let parsed = rmpl::parse(text);
        let (network, diagnostics) = crate::compile(&parsed.program(), &Top::Scenario(None));
        network.unwrap_or_else(|| panic!("{text} has errors: {diagnostics:?}"))
    }

    fn plan(network: &Network, links: &serde_json::Value, orderings: &serde_json::Value) -> Plan {
        let stated = json!({
            "choices": {}, "causal_links": links, "orderings_added": orderings["states"],
            "uses_ordered": orderings["uses"], "windows": {},
        });
        plan_json::plan_from_json(network, &stated).expect("the plan is of the network")
    }

    #[test]
    fn plans_are_told_apart_by_choices_links_and_orders() {
        let network =
            network("resource R capacity 2; primitive A()[1,2] uses R; scenario S[0,9] = { A(), A() }");
        let none = json!([]);
        let first = plan(&network, &none, &json!({ "states": [], "uses": [] }));
        let mut ordered = first.clone();
        ordered.uses_ordered.push(UseOrdering { first: UseId::from_index(0), then: UseId::from_index(1) });
        ordered.windows.iter_mut().for_each(|window| *window = None);
        let mut chosen = first.clone();
        chosen.choices.push(Choice { decision: DecisionId::from_index(0), alternative: 1 });
        assert!(first.is_same(&ordered) && !first.is_same(&chosen));
        let mut plans = DistinctPlans::new(&network);
        let inserted = [&chosen, &first, &ordered, &chosen].map(|plan| plans.insert(plan.clone()));
        assert_eq!(inserted, [true, true, false, false]);
        assert_eq!(plans.into_plans(), [chosen, first]);
    }

    /// Returns whether the pairs lead from one event to another.
    fn is_before(network: &Network, plan: &Plan, earlier: &str, later: &str) -> bool {
        let names = plan_json::Names::new(network);
        let event = |name: &str| names.event(name).expect("the network has the event");
        let pairs = plan.instant_order(network);
        let mut reached: Vec<NodeId> = vec![event(earlier)];
        let mut next = 0;
        while let Some(&node) = reached.get(next) {
            next += 1;
            for [_, then] in pairs.iter().filter(|[first, _]| *first == node) {
                if !reached.contains(then) {
                    reached.push(*then);
                }
            }
        }
        reached.contains(&event(later))
    }

    #[test]
    fn the_order_within_an_instant_follows_the_text_the_links_and_the_orderings() {
        let text = "state LAMP : {OFF, ON} = OFF; resource Tank 0..9 = 0; resource Arm; \
            primitive Light()[0,5] sets LAMP=ON; primitive Look()[0,5] requires LAMP=ON; \
            primitive Dim()[0,5] sets LAMP=OFF; \
            primitive Fill()[0,5] uses Arm produces Tank 2; primitive Pour()[0,5] uses Arm consumes Tank 2; \
            scenario Day[0,9] = { { Light(); delay[0,2] }, Look(), Dim(), Fill(), Pour() }";
        let network = network(text);
        let bare = plan(&network, &json!([]), &json!({"states": [], "uses": []}));
        assert!(is_before(&network, &bare, "Light#1.start", "Light#1.end"));
        assert!(is_before(&network, &bare, "scenario#1.start", "Look#1.start"));
        assert!(is_before(&network, &bare, "Light#1.end", "delay#1.end"));
        for (earlier, later) in [
            ("Light#1.end", "Light#1.start"),
            ("Light#1.end", "Look#1.start"),
            ("Look#1.end", "Dim#1.start"),
            ("Fill#1.end", "Pour#1.start"),
        ] {
            assert!(!is_before(&network, &bare, earlier, later), "{earlier} before {later}");
        }
        let links = json!([{"ask": "Ask(LAMP=ON)@Look#1", "tell": "Set(LAMP=ON)@Light#1"}]);
        let states = json!([["Ask(LAMP=ON)@Look#1", "Set(LAMP=OFF)@Dim#1"]]);
        let linked = plan(&network, &links, &json!({"states": states, "uses": []}));
        assert!(is_before(&network, &linked, "Light#1.end", "Look#1.start"));
        assert!(is_before(&network, &linked, "Look#1.end", "Dim#1.start"));
        assert!(!is_before(&network, &linked, "Dim#1.start", "Look#1.end"));
        let moments = json!([["Produces(Tank)@Fill#1", "Consumes(Tank)@Pour#1"]]);
        let poured = plan(&network, &json!([]), &json!({"states": [], "uses": moments}));
        assert!(is_before(&network, &poured, "Fill#1.end", "Pour#1.start"));
        assert!(!is_before(&network, &poured, "Pour#1.start", "Fill#1.end"));
        let shared = json!([["Uses(Arm)@Pour#1", "Uses(Arm)@Fill#1"]]);
        let shared = plan(&network, &json!([]), &json!({"states": [], "uses": shared}));
        assert!(is_before(&network, &shared, "Pour#1.end", "Fill#1.start"));
        assert!(!is_before(&network, &shared, "Pour#1.start", "Look#1.end"));
    }

    #[test]
    fn conditions_that_do_not_last_order_nothing_within_an_instant() {
        let text = "var SUN : {UP, DOWN}; primitive Look()[0,5]; \
            scenario Day[0,9] = { SUN=UP [0,5], do Look() maintaining SUN=UP, SUN=DOWN [1,2] }";
        let network = network(text);
        let links = json!([{"ask": "Ask(SUN=UP)@Look#1", "tell": "Tell(SUN=UP)@Tell(SUN=UP)#1"}]);
        let orderings = json!([["Ask(SUN=UP)@Look#1", "Tell(SUN=DOWN)@Tell(SUN=DOWN)#1"]]);
        let plan = plan(&network, &links, &json!({"states": orderings, "uses": []}));
        assert!(!is_before(&network, &plan, "Tell(SUN=UP)#1.start", "Look#1.start"));
        assert!(!is_before(&network, &plan, "Look#1.end", "Tell(SUN=DOWN)#1.start"));
    }
}
