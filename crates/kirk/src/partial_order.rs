//! From a solution of the solver to a plan that holds in every schedule: what the solution's times order is ordered in
//! the plan, as far as that does not follow from the rest (a partial-order schedule, Policella et al. 2004).

use std::collections::{BTreeMap, BTreeSet};
use std::iter;

use exact::Bound;
use rmpl::program::Change;
use stn::{Inconsistency, PointId, Stn};
use tpn::selection::closure;
use tpn::{
    ArcId, CausalLink, Choice, LabelId, Levels, Network, NodeId, Ordering, Plan, Precedence, StateOrder,
    UseOrdering, Window,
};
use typed_index_collections::TiVec;

use crate::antichain::heaviest_antichain;
use crate::demands::{ModelSupply, ModelUse, ResourceDemand};
use crate::instants::{self, Before};
use crate::model::{Alternatives, INFINITE, Model};
use crate::solver::{Solution, turns};
use crate::state_order::neighbors;
use crate::unplannable::Unplannable;

/// The plan of a solution; `None` if intervals that the solution only lets touch are not forced to, so that the gap
/// between them that SPEC 5.3 asks for is not there.
pub(crate) fn plan(
    network: &Network,
    model: &Model,
    solution: &Solution,
) -> Result<Option<Plan>, Unplannable> {
    let mut choices = choices(&solution.alternatives);
    let (selected_nodes, selected_arcs) = closure(network, &choices);
    // What is decided inside an alternative that is not taken is not part of the plan.
    choices.retain(|choice| selected_nodes[network.decisions[choice.decision.index()].node.index()]);
    let mut making = Making {
        network,
        model,
        solution,
        is_selected: selected_arcs.iter().copied().collect(),
        natures_events: network.natures_events(&selected_arcs),
        stn: Stn::new(model.num_nodes),
        windows: (Vec::new(), Vec::new()),
        num_edges: 0,
        happens_after: TiVec::new(),
        positions: TiVec::new(),
        relied_on: Vec::new(),
    };
    if !making.add_arcs()? {
        return Ok(None);
    }
    let mut causal_links = making.add_links()?;
    making.find_windows()?;
    let mut conflict_order = Vec::new();
    let threats = making.find_threats(&mut conflict_order)?;
    causal_links.extend(making.add_lasting_links()?);
    causal_links.sort_unstable();
    making.add_departures()?;
    making.find_windows()?;
    making.order_instants(&causal_links);
    let mut orderings_added = Vec::new();
    making.order_kept(&mut orderings_added)?;
    if !making.resolve(threats, &mut conflict_order, &mut orderings_added)? {
        return Ok(None);
    }
    conflict_order.sort_by_key(|order| (order.first.min(order.then), order.first.max(order.then)));
    let mut uses_ordered = Vec::new();
    if making.natures_events.is_empty() {
        for resource in &model.demands.resources {
            making.share(resource, &mut uses_ordered)?;
        }
    } else {
        // Times that fit say nothing of those that the environment will choose: what was decided suffices.
        making.keep_uses_ordered(&mut uses_ordered)?;
    }
    making.keep_in_order(&mut orderings_added, &mut uses_ordered)?;
    let mut levels = Vec::with_capacity(model.demands.resources.len());
    for resource in &model.demands.resources {
        levels.push(making.levels(resource)?);
    }
    let windows = making.windows(&selected_nodes)?;
    let quality = model.demands.quality(&selected_arcs, &windows);
    Ok(Some(Plan {
        choices,
        selected_nodes,
        selected_arcs,
        causal_links,
        conflict_order,
        conflict_order_omitted: 0,
        state_order: solution.kept.order.clone(),
        orderings_added,
        uses_ordered,
        levels,
        quality,
        windows,
    }))
}

fn choices(alternatives: &Alternatives) -> Vec<Choice> {
    let taken = alternatives.iter_enumerated();
    taken
        .filter_map(|(decision, &alternative)| Some(Choice { decision, alternative: alternative? }))
        .collect()
}

/// With more uses of one resource all distances from one of them are found at once.
const MANY_USES: usize = 32;

struct Making<'a> {
    network: &'a Network,
    model: &'a Model,
    solution: &'a Solution,
    is_selected: TiVec<ArcId, bool>,
    /// Empty if the environment executes none.
    natures_events: Vec<bool>,
    stn: Stn,
    /// Distances from and to the start with all links and no order yet: still bounds with orders.
    windows: (Vec<i64>, Vec<i64>),
    num_edges: usize,
    /// What happens right before each event among those at its time (SPEC 10.4); empty where nothing needs that order.
    happens_after: TiVec<NodeId, Vec<NodeId>>,
    /// An order by time, and within an instant by what happens before what.
    positions: TiVec<NodeId, u32>,
    /// What was in order as it was, so that nothing was added for it.
    relied_on: Vec<Reliance>,
}

/// That one event happens before another, and what that keeps in order.
#[derive(Clone, Copy)]
struct Reliance {
    earlier: NodeId,
    later: NodeId,
    kept: InOrder,
}

#[derive(Clone, Copy)]
enum InOrder {
    Conditions(Ordering),
    Uses(UseOrdering),
}

const fn point(node: NodeId) -> PointId {
    PointId(node.0)
}

impl Making<'_> {
    fn time(&self, node: NodeId) -> i64 {
        self.solution.times[node]
    }

    fn selected_labels(&self) -> impl Iterator<Item = LabelId> + '_ {
        let labels = self.model.conditions.labels.iter_enumerated();
        labels.filter(|(_, label)| self.is_selected[label.arc]).map(|(id, _)| id)
    }

    /// `false` if the selected bounds contradict each other, which no solution's do.
    fn add_arcs(&mut self) -> Result<bool, Unplannable> {
        self.stn.set_origin(point(self.model.start));
        self.stn.propose(self.solution.times.iter().copied());
        for (id, arc) in self.model.arcs.iter_enumerated() {
            if !self.is_selected[id] {
                continue;
            }
            let (from, to) = (point(arc.from), point(arc.to));
            if arc.upper != INFINITE {
                self.stn.push(from, to, arc.upper, id.0);
            }
            self.stn.push(to, from, -arc.lower, id.0);
        }
        done(self.stn.settle(&self.model.order))
    }

    /// `later − earlier ≥ least`, which the solution's times satisfy. `false` if the network refuses it.
    fn insert(&mut self, earlier: NodeId, later: NodeId, least: i64) -> Result<bool, Unplannable> {
        done(self.stn.insert(point(later), point(earlier), -least, 0))
    }

    /// Links of variables that are known only where they are asserted.
    fn add_links(&mut self) -> Result<Vec<CausalLink>, Unplannable> {
        let carried = self.solution.carriers.iter_enumerated();
        let carried = carried.filter_map(|(ask, &tell)| Some(CausalLink { ask, tell: tell? }));
        let links: Vec<CausalLink> =
            carried.filter(|link| self.is_selected[self.model.conditions.labels[link.ask].arc]).collect();
        for link in &links {
            let (start, end) = self.network.interval(link.ask);
            let (from, to) = self.network.interval(link.tell);
            self.insert(from, start, 0)?;
            self.insert(end, to, 0)?;
        }
        Ok(links)
    }

    /// Links of variables that keep their values.
    fn add_lasting_links(&mut self) -> Result<Vec<CausalLink>, Unplannable> {
        let links: Vec<CausalLink> =
            self.solution.kept.links.iter().map(|&(ask, tell)| CausalLink { ask, tell }).collect();
        for link in &links {
            self.insert(self.network.ready(link.tell), self.network.interval(link.ask).0, 0)?;
        }
        Ok(links)
    }

    /// Movements take at least as long as from where the one before them ends (SPEC 10.3).
    fn add_departures(&mut self) -> Result<(), Unplannable> {
        let (model, solution) = (self.model, self.solution);
        if model.demands.departures.is_empty() {
            return Ok(());
        }
        let orders = solution.kept.order.iter();
        for &[before, movement] in orders.flat_map(|order| order.producers.array_windows()) {
            let departures = model.demands.departures.get(&movement);
            let departure = departures.and_then(|departures| {
                departures.iter().find(|departure| model.conditions.gives_value(before, departure.from))
            });
            if let Some(least) = departure.and_then(|departure| departure.least) {
                let (start, end) = self.network.interval(movement);
                self.insert(start, end, least)?;
            }
        }
        Ok(())
    }

    fn find_windows(&mut self) -> Result<(), Unplannable> {
        self.num_edges = self.stn.num_edges();
        let (from_start, to_start) = &mut self.windows;
        Ok(self.stn.sweep_distances(point(self.model.start), &self.model.order, from_start, to_start)?)
    }

    /// Returns whether every schedule has `later − earlier ≥ least`.
    fn is_entailed(&mut self, earlier: NodeId, later: NodeId, least: i64) -> Result<bool, Unplannable> {
        let (at_latest, at_earliest) = (self.windows.0[earlier.index()], self.windows.1[later.index()]);
        let ends_by = at_latest != INFINITE
            && at_earliest != INFINITE
            && at_latest.checked_add(least).is_some_and(|time| time <= -at_earliest);
        if ends_by {
            return Ok(true);
        }
        let schedule = self.stn.schedule();
        if schedule[later.index()] - schedule[earlier.index()] < least {
            return Ok(false);
        }
        match self.stn.admits(point(earlier), point(later), least - 1, 0) {
            Ok(()) => Ok(false),
            Err(Inconsistency::NegativeCycle) => Ok(true),
            Err(Inconsistency::Overflow(overflow)) => Err(overflow.into()),
        }
    }

    /// Which events happen before which within an instant, by arcs and links, and an order of all in which the solution's
    /// own orders hold, too.
    fn order_instants(&mut self, links: &[CausalLink]) {
        let (network, model) = (self.network, self.model);
        let demands = &model.demands;
        if demands.variables.is_empty() && demands.resources.is_empty() {
            return;
        }
        let mut before: Vec<(NodeId, NodeId)> = Vec::new();
        for (id, arc) in model.arcs.iter_enumerated() {
            // What leads back to the start says when something was, and not before what.
            if self.is_selected[id] && arc.lower >= 0 && arc.to != self.model.start {
                before.push((arc.from, arc.to));
            }
        }
        for link in links.iter().filter(|link| network.is_lasting(link.ask)) {
            before.push((network.ready(link.tell), network.interval(link.ask).0));
        }
        self.happens_after = vec![Vec::new(); model.num_nodes].into();
        for &(first, then) in &before {
            self.note_before(first, then);
        }
        for Ordering { first, then } in self.sides() {
            before.push((network.interval(first).1, network.interval(then).0));
        }
        for &(ask, change) in &self.solution.kept.over_before {
            before.push((network.interval(ask).1, network.interval(change).0));
        }
        for &(first, then) in &self.solution.uses_ordered {
            let Precedence { earlier, later, .. } = UseOrdering { first, then }.precedence(network);
            before.push((earlier, later));
        }
        let mut times: TiVec<NodeId, Option<i64>> = vec![None; model.num_nodes].into();
        for (id, arc) in model.arcs.iter_enumerated() {
            if self.is_selected[id] {
                for node in [arc.from, arc.to] {
                    times[node] = Some(self.time(node));
                }
            }
        }
        let before = before.into_iter().map(|(first, then)| Before { first, then, reason: () });
        let before: Vec<Before<()>> = before.collect();
        let positions = instants::order(&times, &before, &turns(model));
        debug_assert!(positions.is_ok(), "solutions have no circles");
        self.positions = positions.unwrap_or_else(|_| vec![0; model.num_nodes].into());
    }

    /// Takes note that one event happens before another, if they are at one time.
    fn note_before(&mut self, first: NodeId, then: NodeId) {
        if first != then && self.time(first) == self.time(then) {
            self.happens_after[then].push(first);
        }
    }

    /// Returns whether one event happens before another in every schedule (SPEC 10.4).
    fn happens_before(&mut self, earlier: NodeId, later: NodeId) -> Result<bool, Unplannable> {
        if earlier == later {
            return Ok(true);
        }
        Ok(self.is_entailed(earlier, later, 0)? && self.is_before_within_instant(earlier, later)?)
    }

    /// Returns whether one event that is no later than another in any schedule happens before it, where they are at one
    /// time.
    fn is_before_within_instant(&mut self, earlier: NodeId, later: NodeId) -> Result<bool, Unplannable> {
        // Only where both are at one instant in every schedule it takes more.
        let may_be_apart = self.time(earlier) != self.time(later) || !self.is_entailed(later, earlier, 0)?;
        Ok(may_be_apart || self.is_noted(earlier, later))
    }

    /// Returns whether one event leads to another along what happens before what within their instant.
    fn is_noted(&self, earlier: NodeId, later: NodeId) -> bool {
        let mut seen: BTreeSet<NodeId> = BTreeSet::new();
        let mut open = vec![later];
        while let Some(node) = open.pop() {
            for &before in &self.happens_after[node] {
                if before == earlier {
                    return true;
                }
                if seen.insert(before) {
                    open.push(before);
                }
            }
        }
        false
    }

    /// Makes sure that one event happens before another. Whether that had to be added.
    fn ensure(&mut self, earlier: NodeId, later: NodeId, kept: InOrder) -> Result<bool, Unplannable> {
        if self.happens_before(earlier, later)? {
            self.relied_on.push(Reliance { earlier, later, kept });
            return Ok(false);
        }
        let is_added = self.insert(earlier, later, 0)?;
        if is_added {
            self.note_before(earlier, later);
        }
        Ok(is_added)
    }

    /// Adds what was in order because two events could be apart, and is not any more: orders that were added later hold both at
    /// one time in every schedule.
    fn keep_in_order(
        &mut self,
        orderings: &mut Vec<Ordering>,
        uses: &mut Vec<UseOrdering>,
    ) -> Result<(), Unplannable> {
        let mut has_changed = true;
        while std::mem::take(&mut has_changed) {
            for Reliance { earlier, later, kept } in std::mem::take(&mut self.relied_on) {
                if self.ensure(earlier, later, kept)? {
                    has_changed = true;
                    match kept {
                        InOrder::Conditions(order) => orderings.push(order),
                        InOrder::Uses(order) => uses.push(order),
                    }
                }
            }
            if self.natures_events.is_empty() {
                let before = uses.len();
                for resource in &self.model.demands.resources {
                    if let ModelSupply::Reservoir { .. } = resource.supply {
                        self.share(resource, uses)?;
                    }
                }
                has_changed |= uses.len() > before;
            }
        }
        Ok(())
    }

    /// Returns where an event stands among all.
    fn position(&self, node: NodeId) -> u32 {
        self.positions[node]
    }

    /// The pairs of changes that exclude each other from which all the others follow.
    fn sides(&self) -> Vec<Ordering> {
        let conditions = &self.model.conditions;
        self.solution.kept.order.iter().flat_map(|order| neighbors(conditions, &order.producers)).collect()
    }

    /// Orders what excludes or breaks each other among variables that keep their values (SPEC 10.2).
    fn order_kept(&mut self, added: &mut Vec<Ordering>) -> Result<(), Unplannable> {
        let (network, solution) = (self.network, self.solution);
        // What follows closely first: the rest follows from that.
        let mut sides = self.sides();
        sides.sort_by_key(|order| (self.room(order.first, order.then), *order));
        for order in sides {
            self.put_in_order(order, added)?;
        }
        let mut asks: BTreeMap<LabelId, Vec<LabelId>> = BTreeMap::new();
        for &(ask, carrier) in &solution.kept.links {
            asks.entry(carrier).or_default().push(ask);
        }
        for StateOrder { producers, .. } in &solution.kept.order {
            for (position, carrier) in producers.iter().enumerate() {
                for &ask in asks.get(carrier).into_iter().flatten() {
                    // Before the first of those that follow each other it is before all.
                    let mut later = producers[position + 1..].iter().copied();
                    let Some(first) = later.find(|&change| network.conflict(ask, change)) else { continue };
                    let alike = later.take_while(|&change| !network.conflict(first, change));
                    for then in iter::once(first).chain(alike) {
                        self.put_in_order(Ordering { first: ask, then }, added)?;
                    }
                }
            }
        }
        Ok(())
    }

    /// Makes sure that one interval is over before another begins, of a variable that keeps its value.
    fn put_in_order(&mut self, order: Ordering, added: &mut Vec<Ordering>) -> Result<(), Unplannable> {
        let (over, begun) = (self.network.interval(order.first).1, self.network.interval(order.then).0);
        if self.ensure(over, begun, InOrder::Conditions(order))? {
            added.push(order);
        }
        Ok(())
    }

    /// The conflicting pairs of variables that are known only where they are asserted which arcs and links do not put in
    /// order (SPEC 5.3); the others are added to `order`.
    fn find_threats(&mut self, order: &mut Vec<Ordering>) -> Result<Vec<(LabelId, LabelId)>, Unplannable> {
        let labels: Vec<LabelId> = self.selected_labels().collect();
        let mut threats = Vec::new();
        for &left in &labels {
            for right in self.model.conditions.later_conflicts(left) {
                if !self.is_selected[self.model.conditions.labels[right].arc] {
                    continue;
                }
                let gap_left = self.gap_before(right, self.model.gap_after[left]);
                let gap_right = self.gap_before(left, self.model.gap_after[right]);
                let (one, other) = (self.network.interval(left), self.network.interval(right));
                if self.is_entailed(one.1, other.0, gap_left)? {
                    order.push(Ordering { first: left, then: right });
                } else if self.is_entailed(other.1, one.0, gap_right)? {
                    order.push(Ordering { first: right, then: left });
                } else {
                    threats.push((left, right));
                }
            }
        }
        Ok(threats)
    }

    /// Orders threats as the solution's times do. `false` if one has no room for the gap, which no solution's have.
    fn resolve(
        &mut self,
        threats: Vec<(LabelId, LabelId)>,
        order: &mut Vec<Ordering>,
        added: &mut Vec<Ordering>,
    ) -> Result<bool, Unplannable> {
        let ordered: BTreeSet<(LabelId, LabelId)> = self.solution.orders.iter().copied().collect();
        for (left, right) in threats {
            let is_left_first = if ordered.contains(&(left, right)) == ordered.contains(&(right, left)) {
                self.room(left, right) >= self.room(right, left)
            } else {
                ordered.contains(&(left, right))
            };
            let (first, then) = if is_left_first { (left, right) } else { (right, left) };
            let (wanted, other) = (Ordering { first, then }, Ordering { first: then, then: first });
            // Without a gap, intervals that last no time may be in both orders: what is so already stays so.
            let mut known = None;
            for ordering in [wanted, other] {
                let (end, start, gap) = self.kept_apart(ordering);
                if known.is_none() && self.is_entailed(end, start, gap)? {
                    known = Some(ordering);
                }
            }
            order.push(known.unwrap_or(wanted));
            if known.is_some() {
                continue;
            }
            let (end, start, gap) = self.kept_apart(wanted);
            if !self.insert(end, start, gap)? {
                return Ok(false);
            }
            added.push(wanted);
        }
        // What is in both orders at once, as intervals without length at one instant are, is in the textual one.
        for order in order.iter_mut().filter(|order| order.then < order.first) {
            let Ordering { first, then } = *order;
            let (end, start) = (self.network.interval(then).1, self.network.interval(first).0);
            let gap = self.gap_before(first, self.model.gap_after[then]);
            if gap == 0 && !self.network.is_lasting(first) && self.is_entailed(end, start, 0)? {
                *order = Ordering { first: then, then: first };
            }
        }
        Ok(true)
    }

    /// Returns what must be how far before what, where a threat is put in order.
    fn kept_apart(&self, Ordering { first, then }: Ordering) -> (NodeId, NodeId, i64) {
        let (end, start) = (self.network.interval(first).1, self.network.interval(then).0);
        (end, start, self.gap_before(then, self.model.gap))
    }

    /// No gap comes before what begins when the environment says (SPEC 13.1).
    fn gap_before(&self, then: LabelId, gap: i64) -> i64 {
        let start = self.network.interval(then).0;
        if self.natures_events.get(start.index()).copied().unwrap_or(false) { 0 } else { gap }
    }

    fn room(&self, first: LabelId, then: LabelId) -> i64 {
        self.time(self.network.interval(then).0) - self.time(self.network.interval(first).1)
    }

    /// Orders uses as the solution does, as far as that does not follow from the rest.
    fn keep_uses_ordered(&mut self, added: &mut Vec<UseOrdering>) -> Result<(), Unplannable> {
        for &(first, then) in &self.solution.uses_ordered {
            let ordering = UseOrdering { first, then };
            let Precedence { earlier, later, .. } = ordering.precedence(self.network);
            if self.ensure(earlier, later, InOrder::Uses(ordering))? {
                added.push(ordering);
            }
        }
        Ok(())
    }

    /// Orders the uses of a resource so that no schedule takes more than there is.
    fn share(&mut self, resource: &ResourceDemand, added: &mut Vec<UseOrdering>) -> Result<(), Unplannable> {
        let uses: Vec<ModelUse> =
            resource.uses.iter().filter(|used| self.is_selected[used.arc]).copied().collect();
        match resource.supply {
            ModelSupply::Reusable { capacity } => {
                let total: i64 = uses.iter().map(|used| used.amount).sum();
                if total > capacity { self.hand_on(uses, capacity, added) } else { Ok(()) }
            }
            ModelSupply::Reservoir { least, greatest, level } => {
                self.keep_level(&uses, (least, greatest), level, added)
            }
        }
    }

    /// Each use takes what it needs from what no one has, or from uses that are over: these end before it starts.
    fn hand_on(
        &mut self,
        mut uses: Vec<ModelUse>,
        capacity: i64,
        added: &mut Vec<UseOrdering>,
    ) -> Result<(), Unplannable> {
        uses.sort_by_key(|used| (self.position(used.start), self.position(used.end), used.id));
        let mut free = capacity;
        // Uses that are over or running, with what they still have to hand on.
        let mut held: Vec<(ModelUse, i64)> = Vec::new();
        for used in uses {
            let mut needed = used.amount;
            let mut given: Vec<usize> = Vec::new();
            for (position, &(giver, amount)) in held.iter().enumerate() {
                if needed > 0
                    && amount > 0
                    && self.position(giver.end) <= self.position(used.start)
                    && self.happens_before(giver.end, used.start)?
                {
                    let (earlier, later) = (giver.end, used.start);
                    let kept = InOrder::Uses(UseOrdering { first: giver.id, then: used.id });
                    self.relied_on.push(Reliance { earlier, later, kept });
                    given.push(position);
                    needed -= amount.min(needed);
                }
            }
            let taken = free.min(needed);
            free -= taken;
            needed -= taken;
            // Those that end last leave most room to the others.
            let mut others: Vec<usize> = (0..held.len())
                .filter(|position| {
                    let (giver, amount) = held[*position];
                    amount > 0
                        && !given.contains(position)
                        && self.position(giver.end) <= self.position(used.start)
                })
                .collect();
            others.sort_by_key(|&at| std::cmp::Reverse((self.position(held[at].0.end), at)));
            for position in others {
                if needed == 0 {
                    break;
                }
                let (giver, amount) = held[position];
                let ordering = UseOrdering { first: giver.id, then: used.id };
                self.ensure(giver.end, used.start, InOrder::Uses(ordering))?;
                added.push(ordering);
                given.push(position);
                needed -= amount.min(needed);
            }
            let mut due = used.amount - taken;
            for position in given {
                let handed = held[position].1.min(due);
                held[position].1 -= handed;
                due -= handed;
            }
            held.retain(|&(_, amount)| amount > 0);
            held.push((used, used.amount));
        }
        Ok(())
    }

    /// Orders what is consumed and produced until no schedule leaves the range (Laborie 2003), and every condition on the level
    /// holds.
    fn keep_level(
        &mut self,
        uses: &[ModelUse],
        (least, greatest): (i64, i64),
        level: i64,
        added: &mut Vec<UseOrdering>,
    ) -> Result<(), Unplannable> {
        let (mut conditions, mut changes): (Vec<ModelUse>, Vec<ModelUse>) =
            uses.iter().copied().partition(|used| used.level.is_some());
        for list in [&mut conditions, &mut changes] {
            list.sort_by_key(|used| (self.position(used.moment()), used.id));
        }
        for used in &changes {
            let bound = if used.change == Change::Produces { greatest } else { least };
            self.keep_within(&changes, used, bound, level, added)?;
        }
        for condition in &conditions {
            let Some(bound) = condition.level else { continue };
            if condition.start == condition.end {
                self.keep_within(&changes, condition, bound, level, added)?;
                continue;
            }
            for used in changes.iter().filter(|used| used.change == condition.change) {
                self.keep_condition(&changes, (condition, used), bound, level, added)?;
            }
        }
        Ok(())
    }

    /// Orders the others until the level after one use, or just before a condition, is within its bound in any schedule.
    fn keep_within(
        &mut self,
        changes: &[ModelUse],
        used: &ModelUse,
        bound: i64,
        level: i64,
        added: &mut Vec<UseOrdering>,
    ) -> Result<(), Unplannable> {
        let (now, at) = (self.time(used.moment()), self.position(used.moment()));
        let mut others: Vec<&ModelUse> = changes.iter().filter(|other| other.id != used.id).collect();
        // First what the times order for good, then what they let happen at one time.
        others.sort_by_key(|other| {
            let then = self.time(other.moment());
            (then == now, then.abs_diff(now), other.id)
        });
        for other in others {
            if used.allows(self.extreme(changes, used, level)?, bound) {
                break;
            }
            let then = self.position(other.moment());
            // Of its own kind the others come later, of the other kind before.
            let is_same_change = other.change == used.change;
            let (first, later) = if is_same_change { (used, other) } else { (other, used) };
            let fits = if is_same_change { at <= then } else { then <= at };
            let ordering = UseOrdering { first: first.id, then: later.id };
            if fits && self.ensure(first.moment(), later.moment(), InOrder::Uses(ordering))? {
                added.push(ordering);
            }
        }
        Ok(())
    }

    /// Where a condition on a level goes on, a change of the kind that may break it comes before or after it, or leaves the
    /// level within the bound.
    fn keep_condition(
        &mut self,
        changes: &[ModelUse],
        (condition, used): (&ModelUse, &ModelUse),
        bound: i64,
        level: i64,
        added: &mut Vec<UseOrdering>,
    ) -> Result<(), Unplannable> {
        let (moment, ModelUse { start, end, .. }) = (used.moment(), *condition);
        let is_apart = (moment != start && self.happens_before(moment, start)?)
            || (moment != end && self.happens_before(end, moment)?);
        if is_apart || used.allows(self.extreme(changes, used, level)?, bound) {
            return Ok(());
        }
        let (at, from, to) = (self.position(moment), self.position(start), self.position(end));
        let (first, then) = if at < from {
            (used, condition)
        } else if at > to {
            (condition, used)
        } else {
            return self.keep_within(changes, used, bound, level, added);
        };
        let ordering = UseOrdering { first: first.id, then: then.id };
        if self.ensure(first.last_moment(), then.moment(), InOrder::Uses(ordering))? {
            added.push(ordering);
        }
        Ok(())
    }

    /// The lowest level after a consumption, or the highest after a production (SPEC 11); of a condition the one just before it.
    fn extreme(&mut self, uses: &[ModelUse], used: &ModelUse, level: i64) -> Result<i64, Unplannable> {
        let mut extreme = level;
        let now = used.moment();
        let (mut until_now, mut since_now) = (Vec::new(), Vec::new());
        if uses.len() > MANY_USES {
            self.stn.distances_to(point(now), &mut until_now)?;
            self.stn.distances_from(point(now), &mut since_now)?;
        }
        let happens_before =
            |making: &mut Self, earlier: NodeId, later: NodeId| {
                let (row, other) = if earlier == now { (&until_now, later) } else { (&since_now, earlier) };
                match row.get(other.index()) {
                    Some(&distance) => Ok(earlier == later
                        || (distance <= 0 && making.is_before_within_instant(earlier, later)?)),
                    None => making.happens_before(earlier, later),
                }
            };
        for other in uses {
            let then = other.moment();
            let counts = if other.id == used.id {
                true
            } else if used.level.is_some() && now == then {
                false
            } else if other.change == used.change {
                // Unless it comes after; what changes at the same event counts.
                now == then || !happens_before(self, now, then)?
            } else {
                happens_before(self, then, now)?
            };
            if counts {
                extreme += other.level_change(used.change == Change::Produces);
            }
        }
        Ok(extreme)
    }

    fn levels(&mut self, resource: &ResourceDemand) -> Result<Levels, Unplannable> {
        let uses: Vec<ModelUse> =
            resource.uses.iter().filter(|used| self.is_selected[used.arc]).copied().collect();
        match resource.supply {
            ModelSupply::Reusable { .. } => {
                let mut is_before = vec![vec![false; uses.len()]; uses.len()];
                let mut row = Vec::new();
                for (first, used) in uses.iter().enumerate() {
                    self.stn.distances_to(point(used.end), &mut row)?;
                    for (then, other) in uses.iter().enumerate() {
                        is_before[first][then] = first != then
                            && row[other.start.index()] <= 0
                            && (used.end == other.start
                                || self.is_before_within_instant(used.end, other.start)?);
                    }
                }
                let weights: Vec<i64> = uses.iter().map(|used| used.amount).collect();
                Ok(Levels::Peak(resource.amount(heaviest_antichain(&weights, &is_before).weight)))
            }
            ModelSupply::Reservoir { level, .. } => {
                let changes: Vec<ModelUse> = uses.into_iter().filter(|used| used.level.is_none()).collect();
                let (mut low, mut high) = (level, level);
                for used in &changes {
                    let extreme = self.extreme(&changes, used, level)?;
                    low = low.min(extreme);
                    high = high.max(extreme);
                }
                Ok(Levels::Range { low: resource.amount(low), high: resource.amount(high) })
            }
        }
    }

    fn windows(&mut self, selected: &[bool]) -> Result<Vec<Option<Window>>, Unplannable> {
        let (mut latest, mut earliest) = self.windows.clone();
        self.stn.tighten_distances(self.num_edges, &self.model.order, &mut latest, &mut earliest)?;
        let model = self.model;
        let windows = selected.iter().enumerate().map(|(node, &is_selected)| {
            let (latest, earliest) = (latest[node], earliest[node]);
            is_selected.then(|| Window {
                earliest: if earliest == INFINITE { model.time(0) } else { model.time(-earliest) },
                latest: if latest == INFINITE { Bound::Infinite } else { Bound::Finite(model.time(latest)) },
            })
        });
        Ok(windows.collect())
    }
}

/// Returns whether the network took it.
fn done(result: Result<(), Inconsistency>) -> Result<bool, Unplannable> {
    match result {
        Ok(()) => Ok(true),
        Err(Inconsistency::NegativeCycle) => Ok(false),
        Err(Inconsistency::Overflow(overflow)) => Err(overflow.into()),
    }
}
