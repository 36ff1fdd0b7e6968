//! A second checker of state that lasts and of resources, naive on purpose: the definitions of SPEC 10 and 11 read off all
//! schedules in whole units, with every order of the events within each instant and every set of uses tried.

use std::collections::{BTreeMap, BTreeSet};

use exact::Rational;
use rmpl::program::{Change, LabelMode};
use tpn::{Extent, LabelId, Levels, Network, NodeId, Plan, Supply, UseId, VariableId};

use crate::brute_force::Schedule;
use crate::missions::{is_lasting, moment, occupied, ready};

type Pairs = BTreeSet<(LabelId, LabelId)>;

fn selected(network: &Network, plan: &Plan, mode: LabelMode) -> Vec<LabelId> {
    (0..network.labels.len())
        .map(LabelId::from_index)
        .filter(|&label| {
            let of = &network.labels[label.index()];
            of.mode == mode && plan.selected_arcs[of.arc.index()] && is_lasting(network, label)
        })
        .collect()
}

fn is_changing(network: &Network, label: LabelId) -> bool {
    network.labels[label.index()].extent == Extent::Effect
}

fn is_initial(network: &Network, label: LabelId) -> bool {
    network.labels[label.index()].extent == Extent::Initial
}

fn is_of_one(network: &Network, one: LabelId, other: LabelId) -> bool {
    network.labels[one.index()].literal.variable == network.labels[other.index()].literal.variable
}

/// The values by number; domains of state variables are declared.
fn values(network: &Network, label: LabelId) -> BTreeSet<u32> {
    match &network.labels[label.index()].literal.values {
        tpn::ValueSet::In(values) => values.iter().map(|value| value.0).collect(),
        tpn::ValueSet::NotIn(_) => panic!("the domain of a state variable is closed"),
    }
}

/// The selected producers of state variables.
pub fn producers(network: &Network, plan: &Plan) -> Vec<LabelId> {
    selected(network, plan, LabelMode::Tell)
}

/// The pairs of rule 2.
pub fn excluding(network: &Network, plan: &Plan) -> Vec<(LabelId, LabelId)> {
    let producers = selected(network, plan, LabelMode::Tell);
    let mut pairs = Vec::new();
    for (position, &one) in producers.iter().enumerate() {
        for &other in &producers[position + 1..] {
            let differ = values(network, one) != values(network, other);
            if is_of_one(network, one, other)
                && (is_changing(network, one) || is_changing(network, other) || differ)
            {
                pairs.push((one, other));
            }
        }
    }
    pairs
}

/// The producers that rule 1 keeps away from a requirement with a producer of its own.
pub fn threats(network: &Network, plan: &Plan, ask: LabelId, own: LabelId) -> Vec<LabelId> {
    let mut producers = selected(network, plan, LabelMode::Tell);
    producers.retain(|&it| {
        it != own
            && is_of_one(network, it, ask)
            && (is_changing(network, it) || !values(network, it).is_subset(&values(network, ask)))
    });
    producers
}

/// The selected requirements of state variables.
pub fn requirements(network: &Network, plan: &Plan) -> Vec<LabelId> {
    selected(network, plan, LabelMode::Ask)
}

/// The selected producers whose value a requirement allows.
pub fn supporters(network: &Network, plan: &Plan, ask: LabelId) -> Vec<LabelId> {
    let mut producers = selected(network, plan, LabelMode::Tell);
    let arc = |label: LabelId| network.labels[label.index()].arc;
    producers.retain(|&it| {
        // Nothing rests on its own effect.
        let is_own = is_changing(network, it) && arc(it) == arc(ask);
        is_of_one(network, it, ask) && values(network, it).is_subset(&values(network, ask)) && !is_own
    });
    producers
}

/// What happens before what in a plan (SPEC 10.4).
pub struct Before<'plan> {
    schedules: &'plan [Schedule],
    /// The relation `≺`, closed: row by row, whether it puts an event before another.
    order: Vec<Vec<bool>>,
}

impl<'plan> Before<'plan> {
    /// `schedules` are all that the plan has.
    pub fn new(network: &Network, plan: &Plan, schedules: &'plan [Schedule]) -> Self {
        let mut order = text_order(network, plan);
        let mut put =
            |earlier: NodeId, later: NodeId| order[earlier.index()][later.index()] |= earlier != later;
        let own = |ask: LabelId| plan.causal_links.iter().find(|link| link.ask == ask).map(|link| link.tell);
        for link in plan.causal_links.iter().filter(|link| is_lasting(network, link.ask)) {
            put(ready(network, link.tell), occupied(network, link.ask).0);
        }
        for added in plan.orderings_added.iter().filter(|added| is_lasting(network, added.first)) {
            let later = own(added.then).map_or(occupied(network, added.then).0, |own| ready(network, own));
            put(occupied(network, added.first).1, later);
        }
        for ordered in &plan.uses_ordered {
            let [first, then] = [ordered.first, ordered.then];
            let (one, other) = (&network.uses[first.index()], &network.uses[then.index()]);
            match network.resources[one.resource.index()].supply {
                Supply::Reusable { .. } => put(one.end, other.start),
                Supply::Reservoir { .. } => put(moment(network, first), moment(network, then)),
            }
        }
        close(&mut order);
        Self { schedules, order }
    }

    /// Returns whether some event would have to be before itself.
    pub fn has_circle(&self) -> bool {
        (0..self.order.len()).any(|node| self.order[node][node])
    }

    fn is_before(&self, one: NodeId, other: NodeId) -> bool {
        let (one, other) = (one.index(), other.index());
        let is_no_later = self.schedules.iter().all(|at| at[one] <= at[other]);
        let is_equal = self.schedules.iter().all(|at| at[one] == at[other]);
        one == other || (is_no_later && (!is_equal || self.order[one][other]))
    }
}

/// Returns which event the text puts before which, row by row; not closed.
fn text_order(network: &Network, plan: &Plan) -> Vec<Vec<bool>> {
    let mut order = vec![vec![false; network.nodes.len()]; network.nodes.len()];
    for (arc, &is_selected) in network.arcs.iter().zip(&plan.selected_arcs) {
        let is_forward = is_selected && !arc.lower.is_negative() && arc.from != arc.to;
        order[arc.from.index()][arc.to.index()] |= is_forward;
    }
    order
}

/// Warshall 1962.
fn close(order: &mut [Vec<bool>]) {
    for through in 0..order.len() {
        for from in 0..order.len() {
            for to in 0..order.len() {
                order[from][to] |= order[from][through] && order[through][to];
            }
        }
    }
}

/// Returns whether some order of all events, by time and within each instant as the text has it, keeps a rule: `keeps`
/// is told the place of each event that states and resources are about. `None` after too many of them.
pub fn some_order_keeps(
    network: &Network,
    plan: &Plan,
    at: &Schedule,
    most: usize,
    keeps: impl Fn(&Schedule) -> bool,
) -> Option<bool> {
    let labels = [LabelMode::Tell, LabelMode::Ask].into_iter().flat_map(|mode| selected(network, plan, mode));
    let labels = labels.flat_map(|label| <[NodeId; 2]>::from(occupied(network, label)));
    let uses = network.uses.iter().filter(|used| plan.selected_arcs[used.arc.index()]);
    let events: BTreeSet<NodeId> = labels.chain(uses.flat_map(|used| [used.start, used.end])).collect();
    let mut order = text_order(network, plan);
    close(&mut order);
    let must_wait = |event: NodeId, other: NodeId| {
        let (one, other) = (event.index(), other.index());
        at[other] < at[one] || (at[other] == at[one] && order[other][one])
    };
    let mut left = most;
    let mut open: Vec<Vec<NodeId>> = vec![Vec::new()];
    while let Some(placed) = open.pop() {
        if placed.len() == events.len() {
            let mut places = at.clone();
            (0..).zip(&placed).for_each(|(place, node)| places[node.index()] = place);
            if keeps(&places) {
                return Some(true);
            }
        }
        left = left.checked_sub(1)?;
        let rest: Vec<NodeId> = events.iter().copied().filter(|event| !placed.contains(event)).collect();
        for &event in rest.iter().filter(|&&event| !rest.iter().any(|&other| must_wait(event, other))) {
            open.push(placed.iter().copied().chain([event]).collect());
        }
    }
    Some(false)
}

/// Returns whether SPEC 10.2 accepts a plan in which events happen in this order, and the plan says all of it.
pub fn accepts_states(network: &Network, plan: &Plan, before: &Before<'_>) -> bool {
    let ends = |label: LabelId| occupied(network, label);
    // Each variable lists what gives it its values, all of it and each once.
    let mut listed: BTreeMap<VariableId, Vec<LabelId>> = BTreeMap::new();
    for order in &plan.state_order {
        if listed.insert(order.variable, order.producers.clone()).is_some() {
            return false;
        }
    }
    for producer in producers(network, plan) {
        let list = listed.entry(network.labels[producer.index()].literal.variable).or_default();
        if is_initial(network, producer) && !list.contains(&producer) {
            list.insert(0, producer);
        }
    }
    let mut places: BTreeMap<LabelId, usize> = BTreeMap::new();
    for (&variable, list) in &listed {
        let of_variable = |it: &LabelId| network.labels[it.index()].literal.variable == variable;
        let mut expected: Vec<LabelId> = producers(network, plan).into_iter().filter(of_variable).collect();
        let mut found = list.clone();
        expected.sort_unstable();
        found.sort_unstable();
        if expected != found || list.iter().skip(1).any(|&it| is_initial(network, it)) {
            return false;
        }
        places.extend(list.iter().copied().zip(0..));
    }
    // The sides of rule 2.
    let mut sides = Pairs::new();
    let mut asked: Pairs = Pairs::new();
    for (one, other) in excluding(network, plan) {
        let side = if places[&one] < places[&other] { (one, other) } else { (other, one) };
        let is_kept = before.is_before(ends(side.0).1, ends(side.1).0) && !is_initial(network, side.1);
        if !is_kept {
            return false;
        }
        sides.insert(side);
        asked.insert(side);
    }
    let asks = requirements(network, plan);
    let links: BTreeMap<LabelId, LabelId> =
        plan.causal_links.iter().map(|link| (link.ask, link.tell)).collect();
    for ask in asks {
        let Some(&own) = links.get(&ask) else { return false };
        if plan.causal_links.iter().filter(|link| link.ask == ask).count() != 1
            || !supporters(network, plan, ask).contains(&own)
            || !before.is_before(ready(network, own), ends(ask).0)
        {
            return false;
        }
        for threat in threats(network, plan, ask, own) {
            let is_before = sides.contains(&(threat, own));
            // What rule 2 put before the producer is before the requirement, too; the rest is after it.
            let expected = if is_before { (threat, ask) } else { (ask, threat) };
            let is_kept = if is_before {
                before.is_before(ends(threat).1, ready(network, own))
            } else {
                before.is_before(ends(ask).1, ends(threat).0)
            };
            if !is_kept {
                return false;
            }
            asked.insert(expected);
        }
    }
    plan.orderings_added.iter().all(|it| asked.contains(&(it.first, it.then)))
}

/// Returns whether SPEC 10.2 accepts the places of all events.
pub fn accepts_states_at(network: &Network, plan: &Plan, at: &Schedule) -> bool {
    let place = |node: NodeId| at[node.index()];
    let keeps_sides = excluding(network, plan).into_iter().all(|(one, other)| {
        let ((from, to), (start, end)) = (occupied(network, one), occupied(network, other));
        place(to) <= place(start) || place(end) <= place(from)
    });
    let holds = |ask: LabelId| {
        supporters(network, plan, ask).into_iter().any(|own| {
            let (start, end) = occupied(network, ask);
            place(ready(network, own)) <= place(start)
                && threats(network, plan, ask, own).into_iter().all(|threat| {
                    let (from, to) = occupied(network, threat);
                    place(to) <= place(ready(network, own)) || place(end) <= place(from)
                })
        })
    };
    keeps_sides && requirements(network, plan).into_iter().all(holds)
}

fn uses_of(network: &Network, plan: &Plan, resource: usize) -> Vec<UseId> {
    (0..network.uses.len())
        .map(UseId::from_index)
        .filter(|used| {
            let used = &network.uses[used.index()];
            used.resource.index() == resource && plan.selected_arcs[used.arc.index()]
        })
        .collect()
}

fn amount(network: &Network, used: UseId) -> i64 {
    let amount = network.uses[used.index()].amount;
    assert!(amount.is_integer());
    amount.numerator()
}

/// Returns whether what is used stays within a resource in a plan, by the criteria of SPEC 11; and how far it goes.
pub fn levels(network: &Network, plan: &Plan, before: &Before<'_>) -> (bool, Vec<Levels>) {
    let mut is_within = true;
    let mut all = Vec::new();
    for (index, resource) in network.resources.iter().enumerate() {
        let uses = uses_of(network, plan, index);
        match resource.supply {
            Supply::Reusable { capacity } => {
                let peak = peak(network, &uses, before);
                is_within &= peak <= capacity.numerator();
                all.push(Levels::Peak(Rational::from_integer(peak)));
            }
            Supply::Reservoir { least, greatest, level } => {
                let (mut low, mut high) = (level.numerator(), level.numerator());
                for &used in &uses {
                    let reached = level.numerator() + reached(network, &uses, used, before);
                    if network.uses[used.index()].change == Change::Produces {
                        high = high.max(reached);
                    } else {
                        low = low.min(reached);
                    }
                }
                is_within &= low >= least.numerator() && high <= greatest.numerator();
                let [low, high] = [low, high].map(Rational::from_integer);
                all.push(Levels::Range { low, high });
            }
        }
    }
    (is_within, all)
}

/// The greatest sum of a set of uses of which none happens before another.
fn peak(network: &Network, uses: &[UseId], before: &Before<'_>) -> i64 {
    let precedes = |one: UseId, other: UseId| {
        before.is_before(network.uses[one.index()].end, network.uses[other.index()].start)
    };
    let mut peak = 0;
    for set in 0_u32..1 << uses.len() {
        let chosen: Vec<UseId> =
            uses.iter().enumerate().filter(|(at, _)| set >> at & 1 == 1).map(|(_, &it)| it).collect();
        let is_free = chosen.iter().enumerate().all(|(at, &one)| {
            chosen[at + 1..].iter().all(|&other| !precedes(one, other) && !precedes(other, one))
        });
        if is_free {
            peak = peak.max(chosen.iter().map(|&it| amount(network, it)).sum());
        }
    }
    peak
}

/// Returns how far the level is from the first one at a consumption or a production, at worst.
fn reached(network: &Network, uses: &[UseId], event: UseId, before: &Before<'_>) -> i64 {
    let produces = |used: UseId| network.uses[used.index()].change == Change::Produces;
    let x = moment(network, event);
    let mut sum = 0;
    for &used in uses {
        let at = moment(network, used);
        let is_no_later = before.is_before(at, x);
        let comes_after = before.is_before(x, at) && !is_no_later;
        match (produces(event), produces(used)) {
            (false, false) if !comes_after => sum -= amount(network, used),
            (false, true) if is_no_later => sum += amount(network, used),
            (true, true) if !comes_after => sum += amount(network, used),
            (true, false) if is_no_later => sum -= amount(network, used),
            _ => {}
        }
    }
    sum
}

/// Returns whether SPEC 11 accepts the places of all events: at every one for what is reusable, after every one for
/// levels.
pub fn accepts_resources_at(network: &Network, plan: &Plan, at: &Schedule) -> bool {
    network.resources.iter().enumerate().all(|(index, resource)| {
        let uses = uses_of(network, plan, index);
        let times = |used: UseId| {
            let used = &network.uses[used.index()];
            (at[used.start.index()], at[used.end.index()])
        };
        match resource.supply {
            Supply::Reusable { capacity } => uses.iter().all(|&counted| {
                let (start, end) = times(counted);
                // What contains the start of a use; a use without length is only inside what it lies strictly inside.
                let around = |&&other: &&UseId| {
                    let (from, to) = times(other);
                    if start == end { from < start && start < to } else { from <= start && start < to }
                };
                let others: Vec<&UseId> = uses.iter().filter(around).collect();
                let own = if start == end && !others.is_empty() { amount(network, counted) } else { 0 };
                own + others.into_iter().map(|&it| amount(network, it)).sum::<i64>() <= capacity.numerator()
            }),
            Supply::Reservoir { least, greatest, level } => uses.iter().all(|&event| {
                let now = at[moment(network, event).index()];
                let mut reached = level.numerator();
                for &used in uses.iter().filter(|&&it| at[moment(network, it).index()] <= now) {
                    let is_production = network.uses[used.index()].change == Change::Produces;
                    reached += if is_production { amount(network, used) } else { -amount(network, used) };
                }
                (least.numerator()..=greatest.numerator()).contains(&reached)
            }),
        }
    })
}
