//! An exhaustive reference for state that lasts and for resources, written from SPEC 10 and 11 alone: every choice, every
//! schedule in whole units, every order of the events within each instant. It shares no code with the planner or the checker,
//! and is only for networks of a few activities with whole bounds and a short horizon.
//!
//! All rules compare events. An order of all events, by the times of a schedule and within an instant as the text has it,
//! that keeps the rules gives a plan, which puts what is in order there into that order. And a plan has such an order: it
//! has a schedule in whole units, because its constraints are differences with whole weights, and its events of one instant
//! have an order that its arcs, links and orderings agree with. So a plan exists exactly when such an order keeps every rule.

use std::collections::BTreeSet;

use exact::Rational;
use rmpl::program::{Change, LabelMode, Order};
use tpn::{Extent, LabelId, LevelCondition, Network, NodeId, Supply, ValueSet};

use crate::distances::{FAR, Matrix, Scale, of_arcs};

/// What makes plans distinct: the alternatives taken, the producer of each requirement, and which of two producers that
/// exclude each other is first. Each list is sorted, all ids are numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    /// Decision and alternative.
    pub choices: Vec<(u32, u32)>,
    /// Requirement and producer.
    pub links: Vec<(u32, u32)>,
    /// The first and the later producer.
    pub sides: Vec<(u32, u32)>,
}

/// What the exhaustive search found.
#[derive(Clone, Debug, Default)]
pub struct Answer {
    /// Every distinct plan.
    pub plans: BTreeSet<Key>,
    /// Schedules and orders looked at.
    pub schedules: u64,
}

/// How much the exhaustive search may look at.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub schedules: u64,
    /// Distinct plans: what happens at one instant may have very many orders.
    pub plans: usize,
}

/// Searches; `None` if there is more than the limits allow, or if a bound is not whole or the horizon is infinite.
pub fn search(network: &Network, limits: Limits) -> Option<Answer> {
    if Scale::of(network).0 != 1 {
        return None;
    }
    let mut search = Exhaustive { network, limits, answer: Answer::default() };
    search.choose(&mut vec![None; network.decisions.len()])?;
    Some(search.answer)
}

/// Something that happens to a variable between two events, by their positions among those that matter.
#[derive(Clone, Copy, Debug)]
struct Event {
    label: LabelId,
    start: usize,
    end: usize,
    ready: usize,
    is_changing: bool,
    is_initial: bool,
}

/// One state variable with what is selected of it.
#[derive(Debug, Default)]
struct Variable {
    producers: Vec<Event>,
    requirements: Vec<Event>,
}

/// One use of a resource.
#[derive(Clone, Copy, Debug)]
struct Use {
    start: usize,
    end: usize,
    /// The minimum and the maximum amount: drives differ in length.
    amounts: [Rational; 2],
    is_production: bool,
    /// Of a condition on a level.
    level: Option<LevelCondition>,
}

/// One resource with its selected uses.
#[derive(Debug)]
struct Pool {
    supply: Supply,
    uses: Vec<Use>,
}

/// A complete choice.
struct Leaf {
    choices: Vec<(u32, u32)>,
    matrix: Matrix,
    /// The events that matter.
    events: Vec<usize>,
    /// Row by row whether the text puts an event of the network before another at one time.
    text: Vec<Vec<bool>>,
    variables: Vec<Variable>,
    pools: Vec<Pool>,
}

/// The orders that were looked at.
#[derive(Default)]
struct Seen {
    /// With what ties.
    schedules: BTreeSet<Vec<usize>>,
    orders: BTreeSet<Vec<usize>>,
}

struct Exhaustive<'network> {
    network: &'network Network,
    limits: Limits,
    answer: Answer,
}

impl Exhaustive<'_> {
    fn choose(&mut self, taken: &mut Vec<Option<u32>>) -> Option<()> {
        let (nodes, arcs) = self.reach(taken);
        let open = self
            .network
            .decisions
            .iter()
            .enumerate()
            .find(|(index, decision)| taken[*index].is_none() && nodes[decision.node.index()]);
        if let Some((index, decision)) = open {
            for alternative in 0..decision.alternatives.len() as u32 {
                taken[index] = Some(alternative);
                self.choose(taken)?;
            }
            taken[index] = None;
            return Some(());
        }
        let Some(matrix) = of_arcs(self.network, Scale(1), |arc| arcs[arc.index()]) else { return Some(()) };
        let leaf = self.leaf(taken, &arcs, matrix);
        let mut times = Vec::with_capacity(leaf.events.len());
        self.schedules(&leaf, &mut times, &mut Seen::default())
    }

    /// Returns what the choices select, as far as they go.
    fn reach(&self, taken: &[Option<u32>]) -> (Vec<bool>, Vec<bool>) {
        let mut nodes = vec![false; self.network.nodes.len()];
        let mut arcs = vec![false; self.network.arcs.len()];
        nodes[self.network.start.index()] = true;
        let mut has_grown = true;
        while has_grown {
            has_grown = false;
            for (index, arc) in self.network.arcs.iter().enumerate() {
                let is_taken = arc
                    .choice
                    .is_none_or(|(decision, alternative)| taken[decision.index()] == Some(alternative));
                if nodes[arc.from.index()] && is_taken && !arcs[index] {
                    arcs[index] = true;
                    nodes[arc.to.index()] = true;
                    has_grown = true;
                }
            }
        }
        (nodes, arcs)
    }

    fn leaf(&self, taken: &[Option<u32>], arcs: &[bool], matrix: Matrix) -> Leaf {
        let decided = taken.iter().enumerate();
        let choices = decided.filter_map(|(decision, &it)| Some((decision as u32, it?))).collect();
        let text = text_order(self.network, arcs);
        let mut leaf =
            Leaf { choices, matrix, events: Vec::new(), text, variables: Vec::new(), pools: Vec::new() };
        leaf.variables.resize_with(self.network.variables.len(), Variable::default);
        for (index, label) in self.network.labels.iter().enumerate() {
            let arc = &self.network.arcs[label.arc.index()];
            let variable = label.literal.variable.index();
            if !arcs[label.arc.index()] || !self.network.variables[variable].is_lasting {
                continue;
            }
            let is_changing = label.mode == LabelMode::Tell && label.extent == Extent::Effect;
            let (start, end) = match label.extent {
                Extent::Initial => (self.network.start, self.network.start),
                Extent::Start => (arc.from, arc.from),
                Extent::Arc | Extent::Effect => (arc.from, arc.to),
            };
            let (start, end) = (leaf.event(start), leaf.event(end));
            let event = Event {
                label: LabelId::from_index(index),
                start,
                end,
                ready: if is_changing { end } else { start },
                is_changing,
                is_initial: label.extent == Extent::Initial,
            };
            match label.mode {
                LabelMode::Tell => leaf.variables[variable].producers.push(event),
                LabelMode::Ask => leaf.variables[variable].requirements.push(event),
            }
        }
        for resource in &self.network.resources {
            leaf.pools.push(Pool { supply: resource.supply, uses: Vec::new() });
        }
        for used in &self.network.uses {
            if arcs[used.arc.index()] {
                let (start, end) = (leaf.event(used.start), leaf.event(used.end));
                let is_production = used.change == Change::Produces;
                let amounts = [used.at_least, used.amount];
                let used_here = Use { start, end, amounts, is_production, level: used.level };
                leaf.pools[used.resource.index()].uses.push(used_here);
            }
        }
        leaf
    }

    /// Gives each event every time that its distances to those before it allow; all of them can be completed, because
    /// the distances are the least ones. Schedules with the same order of events are looked at once.
    fn schedules(&mut self, leaf: &Leaf, times: &mut Vec<i64>, seen: &mut Seen) -> Option<()> {
        let Some(&node) = leaf.events.get(times.len()) else {
            self.count()?;
            let distinct: BTreeSet<i64> = times.iter().copied().collect();
            let distinct: Vec<i64> = distinct.into_iter().collect();
            let ranks: Vec<usize> =
                times.iter().filter_map(|time| distinct.binary_search(time).ok()).collect();
            if seen.schedules.insert(ranks.clone()) {
                self.orders(leaf, &ranks, &mut Vec::with_capacity(ranks.len()), &mut seen.orders)?;
            }
            return Some(());
        };
        let start = self.network.start.index();
        let (mut earliest, mut latest) = (-leaf.matrix.get(node, start), leaf.matrix.get(start, node));
        if latest >= FAR {
            return None;
        }
        for (&time, &other) in times.iter().zip(&leaf.events) {
            earliest = earliest.max(time - leaf.matrix.get(node, other));
            latest = latest.min(time + leaf.matrix.get(other, node));
        }
        for time in earliest..=latest {
            times.push(time);
            self.schedules(leaf, times, seen)?;
            times.pop();
        }
        Some(())
    }

    /// Gives the events every order that follows their times and, within an instant, the text. `placed` come first.
    fn orders(
        &mut self,
        leaf: &Leaf,
        ranks: &[usize],
        placed: &mut Vec<usize>,
        seen: &mut BTreeSet<Vec<usize>>,
    ) -> Option<()> {
        if placed.len() == ranks.len() {
            self.count()?;
            let mut places = vec![0; ranks.len()];
            placed.iter().enumerate().for_each(|(place, &event)| places[event] = place);
            if seen.insert(places.clone()) && leaf.pools.iter().all(|pool| is_enough(pool, &places)) {
                self.plans(leaf, &places)?;
            }
            return Some(());
        }
        let left: Vec<usize> = (0..ranks.len()).filter(|event| !placed.contains(event)).collect();
        let is_before = |one: usize, other: usize| {
            let is_text = leaf.text[leaf.events[one]][leaf.events[other]];
            ranks[one] < ranks[other] || (ranks[one] == ranks[other] && is_text)
        };
        for &event in left.iter().filter(|&&event| !left.iter().any(|&other| is_before(other, event))) {
            placed.push(event);
            self.orders(leaf, ranks, placed, seen)?;
            placed.pop();
        }
        Some(())
    }

    fn count(&mut self) -> Option<()> {
        self.answer.schedules += 1;
        (self.answer.schedules <= self.limits.schedules).then_some(())
    }

    /// Every way to link and to order what happens in this order.
    fn plans(&mut self, leaf: &Leaf, times: &[usize]) -> Option<()> {
        let mut keys = vec![Key { choices: leaf.choices.clone(), ..Key::default() }];
        for variable in &leaf.variables {
            let ways = self.ways(variable, times);
            if keys.len().saturating_mul(ways.len()) > self.limits.plans {
                return None;
            }
            keys = (keys.iter())
                .flat_map(|key| {
                    ways.iter().map(|way| {
                        let mut longer = key.clone();
                        longer.links.extend(&way.links);
                        longer.sides.extend(&way.sides);
                        longer
                    })
                })
                .collect();
        }
        for mut key in keys {
            key.links.sort_unstable();
            key.sides.sort_unstable();
            self.answer.plans.insert(key);
        }
        (self.answer.plans.len() <= self.limits.plans).then_some(())
    }

    /// Every way to link and to order what is selected of one variable (SPEC 10.2).
    fn ways(&self, variable: &Variable, times: &[usize]) -> Vec<Key> {
        let producers = &variable.producers;
        let is_over = |one: &Event, other: &Event| times[one.end] <= times[other.start];
        let mut sides: Vec<Vec<(usize, usize)>> = vec![Vec::new()];
        for (one, producer) in producers.iter().enumerate() {
            for (other, another) in producers.iter().enumerate().skip(one + 1) {
                let differ = self.values(producer.label) != self.values(another.label);
                if !(producer.is_changing || another.is_changing || differ) {
                    continue;
                }
                // The first value is before all others.
                let may_be = |first: &Event, then: &Event| is_over(first, then) && !then.is_initial;
                let mut longer = Vec::new();
                for known in &sides {
                    for (first, then) in [(one, other), (other, one)] {
                        if may_be(&producers[first], &producers[then]) {
                            longer.push([known.as_slice(), &[(first, then)]].concat());
                        }
                    }
                }
                sides = longer;
            }
        }
        sides.retain(|sides| is_without_circles(sides, producers.len()));
        let number = |at: usize| producers[at].label.0;
        let mut ways = Vec::new();
        for sides in sides {
            let named: Vec<(u32, u32)> =
                sides.iter().map(|&(first, then)| (number(first), number(then))).collect();
            let mut found = vec![Key { sides: named, ..Key::default() }];
            for requirement in &variable.requirements {
                let own = (0..producers.len())
                    .filter(|&own| self.is_carried(requirement, own, producers, &sides, times));
                let own: Vec<u32> = own.map(number).collect();
                found = (found.iter())
                    .flat_map(|way| {
                        own.iter().map(|&own| {
                            let mut longer = way.clone();
                            longer.links.push((requirement.label.0, own));
                            longer
                        })
                    })
                    .collect();
            }
            ways.extend(found);
        }
        ways
    }

    /// Rule 1 for one requirement and the producer `own`.
    fn is_carried(
        &self,
        requirement: &Event,
        own: usize,
        producers: &[Event],
        sides: &[(usize, usize)],
        times: &[usize],
    ) -> bool {
        let is_allowed =
            |producer: &Event| self.values(producer.label).is_subset(&self.values(requirement.label));
        let is_kept_away = |(other, producer): (usize, &Event)| {
            let is_threat = producer.is_changing || !is_allowed(producer);
            let is_before =
                sides.contains(&(other, own)) && times[producer.end] <= times[producers[own].ready];
            other == own || !is_threat || is_before || times[requirement.end] <= times[producer.start]
        };
        let arc = |event: &Event| self.network.labels[event.label.index()].arc;
        // Nothing rests on its own effect.
        let is_own_effect = producers[own].is_changing && arc(&producers[own]) == arc(requirement);
        is_allowed(&producers[own])
            && !is_own_effect
            && times[producers[own].ready] <= times[requirement.start]
            && producers.iter().enumerate().all(is_kept_away)
    }

    /// The values by number. The domain of a state variable is declared.
    fn values(&self, label: LabelId) -> BTreeSet<u32> {
        let label = &self.network.labels[label.index()];
        let all = 0..self.network.variables[label.literal.variable.index()].values.len() as u32;
        match &label.literal.values {
            ValueSet::In(values) => values.iter().map(|value| value.0).collect(),
            ValueSet::NotIn(values) => all.filter(|value| values.iter().all(|it| it.0 != *value)).collect(),
        }
    }
}

impl Leaf {
    /// The position of an event among those that matter.
    fn event(&mut self, node: NodeId) -> usize {
        let node = node.index();
        self.events.iter().position(|&known| known == node).unwrap_or_else(|| {
            self.events.push(node);
            self.events.len() - 1
        })
    }
}

/// Returns what arcs whose lower bound is not negative put before what, one after the other.
fn text_order(network: &Network, arcs: &[bool]) -> Vec<Vec<bool>> {
    let count = network.nodes.len();
    let mut before = vec![vec![false; count]; count];
    for (arc, _) in network.arcs.iter().zip(arcs).filter(|(_, is_selected)| **is_selected) {
        before[arc.from.index()][arc.to.index()] |= !arc.lower.is_negative();
    }
    for through in 0..count {
        for from in 0..count {
            for to in 0..count {
                before[from][to] |= before[from][through] && before[through][to];
            }
        }
    }
    before
}

fn is_without_circles(sides: &[(usize, usize)], count: usize) -> bool {
    // What nothing that is left precedes is taken away, again and again.
    let mut left: Vec<usize> = (0..count).collect();
    loop {
        let is_first = |&one: &usize| !sides.iter().any(|(first, then)| *then == one && left.contains(first));
        let Some(position) = left.iter().position(is_first) else { return left.is_empty() };
        left.remove(position);
    }
}

/// Returns whether a resource is enough for its uses in this order (SPEC 11).
fn is_enough(pool: &Pool, times: &[usize]) -> bool {
    let sum = |amounts: &mut dyn Iterator<Item = Rational>| {
        amounts.fold(Rational::ZERO, |sum, it| sum.checked_add(it).expect("small amounts"))
    };
    match pool.supply {
        Supply::Reusable { capacity } => pool.uses.iter().all(|counted| {
            let now = times[counted.start];
            let has_length = |used: &Use| times[used.start] < times[used.end];
            let contains = |used: &Use, is_strictly: bool| {
                (times[used.start] < now || (times[used.start] == now && !is_strictly))
                    && now < times[used.end]
            };
            // What is one event counts where it lies strictly inside another, and not beside its like.
            let is_instant = !has_length(counted);
            let around: Vec<Rational> = (pool.uses.iter())
                .filter(|used| has_length(used) && contains(used, is_instant))
                .map(|used| used.amounts[1])
                .collect();
            let own = (is_instant && !around.is_empty()).then_some(counted.amounts[1]);
            sum(&mut around.into_iter().chain(own)) <= capacity
        }),
        Supply::Reservoir { least, greatest, level } => {
            let (conditions, changes): (Vec<&Use>, Vec<&Use>) =
                pool.uses.iter().partition(|used| used.level.is_some());
            let moment = |used: &Use| times[if used.is_production { used.end } else { used.start }];
            // The least and the greatest level after everything up to a place, or before it.
            let levels_at = |now: usize, is_included: bool| {
                let happened = |is_production: bool, end: usize| {
                    let has_come = |it: &&&Use| moment(it) < now || (is_included && moment(it) == now);
                    let its = changes.iter().filter(has_come).filter(|it| it.is_production == is_production);
                    sum(&mut its.map(|it| it.amounts[end]))
                };
                [(0, 1), (1, 0)].map(|(given, taken)| {
                    level.checked_add(happened(true, given))?.checked_sub(happened(false, taken))
                })
            };
            let is_kept = |condition: &&Use| {
                let (from, to) = (times[condition.start], times[condition.end]);
                let holds = |levels: [Option<Rational>; 2]| {
                    levels.into_iter().all(|level| {
                        let asked = condition.level.zip(level);
                        asked.is_some_and(|(LevelCondition { order, bound }, level)| match order {
                            Order::Below => level < bound,
                            Order::AtMost => level <= bound,
                            Order::Above => level > bound,
                            Order::AtLeast => level >= bound,
                        })
                    })
                };
                if condition.start == condition.end {
                    return holds(levels_at(from, false));
                }
                (from..=to).all(|now| holds(levels_at(now, true)))
            };
            let is_in_range = |now: usize| {
                let [low, high] = levels_at(now, true);
                low.is_some_and(|low| least <= low) && high.is_some_and(|high| high <= greatest)
            };
            conditions.iter().all(is_kept) && changes.iter().all(|used| is_in_range(moment(used)))
        }
    }
}
