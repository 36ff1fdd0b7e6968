//! Resources beside durations that the environment chooses: the planner against a search for an order of events with
//! which no resource runs out, however long the durations are, and the network is controllable.
//!
//! An order is enough for a camera if every set of events that contains all that comes before its events leaves the camera
//! within its capacity. Where such a set does not, some event outside must come before some event inside. It is enough for
//! a tank by the criterion of SPEC 11: after each event, everything that pushes the level the same way counts unless it
//! comes later, and everything else only if it comes before. The search tries each pair that would help.

use acceptance::mission::{network, try_plans};
use exact::{Rational, Time};
use kirk::Search;
use rmpl::program::{Change, Controllability};
use tpn::generate::Rng;
use tpn::{LevelCondition, Network, NodeId, Supply};

use crate::uncertain::{compare_all, is_controllable_with, leave_to_nature};

/// Missions that the reference finishes.
const MISSIONS: u64 = 4_000;

/// Orders that the reference tries in one mission at most.
const ORDERS: usize = 400;

/// The text of mission number `seed`: two to four branches whose activities use a camera, fill and empty a tank.
fn random_mission(seed: u64) -> String {
    let mut rng = Rng::new(seed ^ 0x7A_4C);
    let capacity = rng.between(1, 3);
    let greatest = rng.between(3, 6);
    let level = rng.between(0, greatest);
    let mut text = format!("resource CAM capacity {capacity};\nresource TANK 0..{greatest} = {level};\n");
    let mut branches: Vec<String> = Vec::new();
    let mut horizon = 0;
    for branch in 0..rng.between(2, 4) {
        let mut steps: Vec<String> = Vec::new();
        let mut length = 0;
        for step in 0..rng.between(1, 2) {
            let lead = rng.between(0, 3);
            match rng.below(4) {
                0 => {}
                1 => steps.push("delay".to_owned()),
                _ => {
                    let longest = lead + if rng.chance(50) { rng.between(1, 3) } else { 0 };
                    steps.push(format!("delay[{lead},{longest}]"));
                    length += lead;
                }
            }
            let shortest = rng.between(0, 3);
            let longest = shortest + if rng.chance(60) { rng.between(1, 3) } else { 0 };
            let amount = rng.between(1, 3);
            let clause = match rng.below(8) {
                0 => format!(" produces TANK {amount}"),
                1 => format!(" consumes TANK {amount}"),
                2 => format!(" uses CAM {} consumes TANK 1", amount.min(capacity)),
                3 => format!(" requires TANK {} {amount}", if rng.chance(60) { ">=" } else { "<=" }),
                4 => format!(" requires TANK {} {amount} at start", if rng.chance(60) { ">=" } else { "<=" }),
                _ => format!(" uses CAM {}", amount.min(capacity)),
            };
            text.push_str(&format!("primitive A{branch}{step}()[{shortest},{longest}]{clause};\n"));
            steps.push(format!("A{branch}{step}()"));
            length += longest;
        }
        horizon += length;
        branches.push(format!("{{ {} }}", steps.join("; ")));
    }
    let horizon = (horizon * rng.between(4, 11) / 10).max(1);
    text.push_str(&format!("scenario S[0,{horizon}] = {{ {} }}\n", branches.join(", ")));
    text
}

/// Something that changes a resource, at its start or at its end.
struct Event {
    node: NodeId,
    /// What is in use or in store from then on, more than before.
    change: i64,
}

fn units(amount: Rational) -> i64 {
    assert!(amount.is_integer(), "the missions have whole amounts");
    amount.floor()
}

/// A resource: what is in use or in store at first, and its limits.
struct Level {
    is_reusable: bool,
    initial: i64,
    least: i64,
    greatest: i64,
    events: Vec<Event>,
    conditions: Vec<Condition>,
}

/// What a level must be just before an event, or from one to another.
struct Condition {
    start: NodeId,
    end: NodeId,
    is_minimum: bool,
    bound: i64,
}

impl Condition {
    const fn allows(&self, level: i64) -> bool {
        if self.is_minimum { level >= self.bound } else { level <= self.bound }
    }
}

impl Level {
    fn all(network: &Network) -> Vec<Self> {
        let mut levels: Vec<Self> = network
            .resources
            .iter()
            .map(|resource| {
                let (least, greatest) = match resource.supply {
                    Supply::Reusable { capacity } => (0, units(capacity)),
                    Supply::Reservoir { least, greatest, .. } => (units(least), units(greatest)),
                };
                let is_reusable = matches!(resource.supply, Supply::Reusable { .. });
                Self {
                    is_reusable,
                    initial: units(resource.supply.initial_level()),
                    least,
                    greatest,
                    events: Vec::new(),
                    conditions: Vec::new(),
                }
            })
            .collect();
        for it in &network.uses {
            let amount = units(it.amount);
            let level = &mut levels[it.resource.index()];
            if let Some(LevelCondition { order, bound }) = it.level {
                assert!(!order.is_strict(), "the missions have no strict conditions");
                let (is_minimum, bound) = (order.is_minimum(), units(bound));
                level.conditions.push(Condition { start: it.start, end: it.end, is_minimum, bound });
                continue;
            }
            let mut add = |node, change| level.events.push(Event { node, change });
            match it.change {
                Change::Uses => {
                    add(it.start, amount);
                    add(it.end, -amount);
                }
                Change::Consumes => add(it.start, -amount),
                Change::Produces => add(it.end, amount),
            }
        }
        levels
    }

    /// The pairs of events of which one must be put in order, as few as possible, if there are any.
    fn fewest_ways_out(&self, before: &Before) -> Option<Vec<(NodeId, NodeId)>> {
        let ways_out = if self.is_reusable { self.crowded_sets(before) } else { self.worst_cases(before) };
        ways_out.into_iter().min_by_key(Vec::len)
    }

    /// For each set of events with too much in use: what could come before what then.
    fn crowded_sets(&self, before: &Before) -> Vec<Vec<(NodeId, NodeId)>> {
        let count = self.events.len();
        let node = |index: usize| self.events[index].node;
        let mut ways_out = Vec::new();
        for set in 0_u32..1 << count {
            let (inside, outside): (Vec<usize>, Vec<usize>) = (0..count).partition(|&it| set >> it & 1 == 1);
            let in_use: i64 = inside.iter().map(|&it| self.events[it].change).sum();
            let is_closed =
                outside.iter().all(|&out| inside.iter().all(|&own| !before.is_before(node(out), node(own))));
            if is_closed && in_use > self.greatest {
                let pairs = outside.iter().flat_map(|&out| inside.iter().map(move |&own| (out, own)));
                let pairs = pairs.map(|(out, own)| (node(out), node(own)));
                ways_out.push(pairs.filter(|&(out, own)| before.can_add(out, own)).collect());
            }
        }
        ways_out
    }

    /// For each event after which the level may be out of range, or break a condition: what could come later, or earlier.
    fn worst_cases(&self, before: &Before) -> Vec<Vec<(NodeId, NodeId)>> {
        let mut ways_out = Vec::new();
        for now in &self.events {
            let (level, pairs) = self.worst_case(before, now.node, now.change > 0, None);
            if !(self.least..=self.greatest).contains(&level) {
                ways_out.push(pairs.clone());
            }
            for condition in self.conditions.iter().filter(|it| it.start != it.end) {
                let is_over = now.node != condition.start && before.is_before(now.node, condition.start);
                let is_later = now.node != condition.end && before.is_before(condition.end, now.node);
                let breaks = (now.change < 0) == condition.is_minimum && !condition.allows(level);
                if breaks && !is_over && !is_later {
                    let mut pairs = pairs.clone();
                    pairs.extend([(now.node, condition.start), (condition.end, now.node)]);
                    ways_out.push(pairs);
                }
            }
        }
        for condition in self.conditions.iter().filter(|it| it.start == it.end) {
            let at = condition.start;
            let (level, pairs) = self.worst_case(before, at, !condition.is_minimum, Some(at));
            if !condition.allows(level) {
                ways_out.push(pairs);
            }
        }
        for pairs in &mut ways_out {
            pairs.retain(|&(earlier, later)| before.can_add(earlier, later));
        }
        ways_out
    }

    /// The highest level after an event, or the lowest, without what happens at `left_out`; and the orders that would change
    /// it.
    fn worst_case(
        &self,
        before: &Before,
        now: NodeId,
        is_highest: bool,
        left_out: Option<NodeId>,
    ) -> (i64, Vec<(NodeId, NodeId)>) {
        let (mut level, mut pairs) = (self.initial, Vec::new());
        for other in self.events.iter().filter(|other| left_out != Some(other.node)) {
            if (other.change > 0) == is_highest {
                if other.node == now || !before.is_before(now, other.node) {
                    level += other.change;
                    pairs.push((now, other.node));
                }
            } else if other.node == now || before.is_before(other.node, now) {
                level += other.change;
            } else {
                pairs.push((other.node, now));
            }
        }
        (level, pairs)
    }
}

/// Which events come before which.
#[derive(Clone)]
struct Before {
    /// By order, that of the mission and what was added.
    by_order: Vec<Vec<bool>>,
    /// The maximum of the first event's time minus the second one's; [`FAR`] if nothing limits it.
    at_most: Vec<Vec<i64>>,
}

/// More than any time of the missions.
const FAR: i64 = 1 << 40;

impl Before {
    fn new(network: &Network) -> Self {
        let nodes = network.nodes.len();
        let mut before =
            Self { by_order: vec![vec![false; nodes]; nodes], at_most: vec![vec![FAR; nodes]; nodes] };
        for node in 0..nodes {
            before.at_most[node][node] = 0;
        }
        for arc in &network.arcs {
            before.add(arc.from, arc.to);
            before.bound(arc.from, arc.to, -arc.lower.numerator());
            if let Some(upper) = arc.upper.finite() {
                before.bound(arc.to, arc.from, upper.numerator());
            }
        }
        before
    }

    /// Returns whether one event happens before another one in every schedule (SPEC 10.4).
    fn is_before(&self, earlier: NodeId, later: NodeId) -> bool {
        let (first, then) = (earlier.index(), later.index());
        let is_tied = self.at_most[first][then] <= 0 && self.at_most[then][first] <= 0;
        if is_tied { self.by_order[first][then] } else { self.at_most[first][then] <= 0 }
    }

    fn can_add(&self, earlier: NodeId, later: NodeId) -> bool {
        let (first, then) = (earlier.index(), later.index());
        first != then && !self.by_order[first][then] && !self.by_order[then][first]
    }

    fn add(&mut self, earlier: NodeId, later: NodeId) {
        let nodes = self.by_order.len();
        let (first, then) = (earlier.index(), later.index());
        for from in (0..nodes).filter(|&it| it == first || self.by_order[it][first]).collect::<Vec<_>>() {
            for to in 0..nodes {
                if to == then || self.by_order[then][to] {
                    self.by_order[from][to] = true;
                }
            }
        }
        self.bound(earlier, later, 0);
    }

    fn bound(&mut self, first: NodeId, then: NodeId, most: i64) {
        let nodes = self.at_most.len();
        for from in 0..nodes {
            for to in 0..nodes {
                let through = self.at_most[from][first.index()] + most + self.at_most[then.index()][to];
                if through < self.at_most[from][to] {
                    self.at_most[from][to] = through;
                }
            }
        }
    }
}

struct Reference<'a> {
    network: &'a Network,
    levels: Vec<Level>,
    order: Vec<(NodeId, NodeId)>,
    tried: usize,
}

impl Reference<'_> {
    /// Returns whether events can be put in order, or nothing if that takes too long. What is `excluded` was tried
    /// before.
    fn search(&mut self, before: &Before, excluded: &[(NodeId, NodeId)]) -> Option<bool> {
        self.tried += 1;
        if self.tried > ORDERS {
            return None;
        }
        if !is_controllable_with(self.network, &[], &self.order) {
            return Some(false);
        }
        let ways_out =
            self.levels.iter().filter_map(|level| level.fewest_ways_out(before)).min_by_key(Vec::len);
        let Some(pairs) = ways_out else { return Some(true) };
        let mut excluded = excluded.to_vec();
        for (earlier, later) in pairs {
            if excluded.contains(&(earlier, later)) {
                continue;
            }
            let mut then = before.clone();
            then.add(earlier, later);
            self.order.push((earlier, later));
            let found = self.search(&then, &excluded);
            self.order.pop();
            if found != Some(false) {
                return found;
            }
            excluded.push((earlier, later));
        }
        Some(false)
    }
}

/// Returns how many plans the mission has, one or none, and how many without the environment, if the reference
/// finishes.
fn compare(seed: u64) -> Result<Option<(usize, usize)>, String> {
    let text = random_mission(seed);
    let mut network = network(&text);
    network.threat_gap = Time::ZERO;
    let without =
        try_plans(&network, Search::ConflictDirected, false).map_err(|it| format!("{it}\n{text}"))?;
    if leave_to_nature(&mut network, seed) == 0 {
        return Ok(None);
    }
    if seed.is_multiple_of(5) {
        network.controllability = Controllability::Strong;
    }
    let levels = Level::all(&network);
    if levels.iter().any(|level| level.events.len() > 10) {
        return Ok(None);
    }
    let mut reference = Reference { network: &network, levels, order: Vec::new(), tried: 0 };
    let Some(expected) = reference.search(&Before::new(&network), &[]) else { return Ok(None) };
    // The checker accepts whatever is found here.
    let outcome =
        try_plans(&network, Search::ConflictDirected, false).map_err(|it| format!("{it}\n{text}"))?;
    let found = !outcome.plans.is_empty();
    if found != expected {
        let natures: Vec<String> = network
            .arcs
            .iter()
            .filter(|arc| arc.is_contingent)
            .map(|arc| format!("{:?} {}..{:?}", arc.kind, arc.lower, arc.upper.finite()))
            .collect();
        return Err(format!("{expected} expected, {found} found; contingent: {natures:?}\n{text}"));
    }
    Ok(Some((usize::from(found), without.plans.len())))
}

#[test]
fn shared_resources_are_planned_exactly() {
    compare_all("resources", MISSIONS, MISSIONS / 20, &compare);
}
