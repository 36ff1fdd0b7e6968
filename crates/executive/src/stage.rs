//! One plan under execution, between two replans.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use exact::{Bound, Time};
use stn::PointId;
use tpn::{ArcId, ArcKind, EventRef, Network, NodeId, Occurrence, OccurrenceId, Plan, Precedence};

use crate::dispatch::{Dispatch, NEVER};
use crate::instants::ranks;
use crate::plan_network::{PlanError, PlanNetwork};
use crate::world_state::Effects;

/// A plan made ready for dispatch, in ticks fine enough for all times that the world brings. Many runs of one plan share it.
#[derive(Clone, Debug)]
pub struct Stage {
    pub(crate) network: Arc<Network>,
    pub(crate) plan: Plan,
    pub(crate) made: PlanNetwork,
    /// What its events do to states and levels.
    pub(crate) effects: Effects,
    pub(crate) dispatch: Dispatch,
    /// The durations that the environment chooses, whether or not the mission asks to withstand that, by the events
    /// where they end.
    pub(crate) natures: BTreeMap<NodeId, Vec<ArcId>>,
    /// The vertices of paths.
    pub(crate) guides: BTreeMap<NodeId, Guide>,
    /// What traverses take by their paths and their drivers.
    durations: Durations,
    /// The times that are not the network's own.
    grid: Arc<[Time]>,
    /// When each node happened.
    pub(crate) times: Vec<Option<Time>>,
    /// When this plan was made.
    pub(crate) from: Time,
    /// By point: which of two events that happen at one time is first.
    ranks: Vec<u32>,
    /// The nodes that each selected node follows along the plan's arcs and links.
    before: Vec<Vec<NodeId>>,
    /// The nodes that follow each.
    after: Arc<[Vec<NodeId>]>,
}

impl Stage {
    /// Makes `plan` ready. `grid` are the times, or their common divisors, that are not the network's own.
    pub fn new(network: Arc<Network>, plan: Plan, grid: &[Time]) -> Result<Self, PlanError> {
        let durations = Durations::by_paths(&network, &plan)?;
        let (made, dispatch) = durations.dispatch(&network, &plan, grid)?;
        let ranks = ranks(&network, &plan, &made)?;
        let mut natures: BTreeMap<NodeId, Vec<ArcId>> = BTreeMap::new();
        for (index, arc) in network.arcs.iter().enumerate().filter(|(_, arc)| arc.is_contingent) {
            if plan.selected_arcs[index] {
                natures.entry(arc.to).or_default().push(ArcId::from_index(index));
            }
        }
        let times = vec![None; network.nodes.len()];
        let before = before(&network, &plan);
        let mut after = vec![Vec::new(); network.nodes.len()];
        for (node, earlier) in before.iter().enumerate() {
            for earlier in earlier {
                after[earlier.index()].push(NodeId::from_index(node));
            }
        }
        let after = after.into();
        let effects = Effects::new(&network, &plan);
        let guides = Guide::all(&network, &plan)?;
        let from = Time::ZERO;
        Ok(Self {
            network,
            plan,
            made,
            effects,
            dispatch,
            natures,
            guides,
            durations,
            grid: grid.into(),
            times,
            from,
            ranks,
            before,
            after,
        })
    }

    /// Takes in how long a traverse under way takes at least, or that it never ends, as far as the mission itself does not
    /// forbid it. Returns whether that changes what is dispatched.
    pub(crate) fn expect(&mut self, traverse: OccurrenceId, least: Option<Time>) -> Result<bool, PlanError> {
        let described = &self.network.occurrences[traverse.index()];
        let [started, ended] = [described.start, described.end].map(|node| self.times[node.index()]);
        if !self.durations.paths.contains(&traverse) || started.is_none() || ended.is_some() {
            return Ok(false);
        }
        let most = self.durations.most.get(&traverse);
        let is_over = most.is_some_and(|&most| least.is_none_or(|least| least > most));
        // In a plan without such choices it is enough to ask which events leave it the time.
        let least = least.filter(|_| self.dispatch.withstands_nature());
        let allowed = is_over.then(|| {
            let mut allowed = self.durations.clone();
            allowed.most.remove(&traverse);
            allowed
        });
        if let Some(least) = least {
            let mut expected = allowed.as_ref().unwrap_or(&self.durations).clone();
            expected.least.insert(traverse, least);
            if self.try_durations(expected)? {
                return Ok(true);
            }
        }
        // A drive that leaves the rest no time is late, whatever waits for it.
        allowed.map_or(Ok(false), |allowed| self.try_durations(allowed))
    }

    /// Dispatches the plan with other durations from now on, if it can be kept with them.
    fn try_durations(&mut self, durations: Durations) -> Result<bool, PlanError> {
        if durations == self.durations {
            return Ok(false);
        }
        let (made, dispatch) = match durations.dispatch(&self.network, &self.plan, &self.grid) {
            Ok(made) => made,
            Err(PlanError::Inconsistent) => return Ok(false),
            Err(error) => return Err(error),
        };
        if dispatch.withstands_nature() != self.dispatch.withstands_nature() {
            return Ok(false);
        }
        let before =
            (std::mem::replace(&mut self.made, made), std::mem::replace(&mut self.dispatch, dispatch));
        let past = self.times.iter().enumerate();
        let past = past.filter_map(|(index, &time)| Some((time?, NodeId::from_index(index)))).collect();
        if self.enter_past(past).is_err() {
            (self.made, self.dispatch) = before;
            return Ok(false);
        }
        self.durations = durations;
        Ok(true)
    }

    /// The window of a point in mission units; no latest time if it is not bounded.
    pub(crate) fn window(&self, point: PointId) -> (Time, Option<Time>) {
        let (earliest, latest) = self.dispatch.window(point);
        (self.made.time(earliest), (latest != NEVER).then(|| self.made.time(latest)))
    }

    /// Returns whether everything that a node follows has happened. Where durations may be zero, the dispatchable form
    /// alone would let an end come before its start.
    pub(crate) fn is_next(&self, node: NodeId) -> bool {
        self.before[node.index()].iter().all(|before| self.times[before.index()].is_some())
    }

    /// The rank of a point: of two that happen at one time the one of lower rank is first (SPEC 10.4).
    pub(crate) fn rank(&self, point: PointId) -> u32 {
        self.ranks[point.index()]
    }

    /// The nodes that follow each node along the plan's arcs and links.
    pub(crate) fn followers(&self) -> Arc<[Vec<NodeId>]> {
        Arc::clone(&self.after)
    }

    /// Returns how many nodes each node follows that have not happened.
    pub(crate) fn missing(&self) -> Vec<u32> {
        let count = |before: &Vec<NodeId>| {
            before.iter().filter(|before| self.times[before.index()].is_none()).count() as u32
        };
        self.before.iter().map(count).collect()
    }

    /// Returns whether one event comes no later than another in every schedule that is left, as far as its arcs and
    /// orderings or their windows say so.
    pub(crate) fn precedes(&self, one: NodeId, other: NodeId) -> bool {
        let window = |node: NodeId| self.made.point(node).map(|point| self.window(point));
        let by_windows = || match (window(one), window(other)) {
            (Some((_, Some(latest))), Some((earliest, _))) => latest <= earliest,
            _ => false,
        };
        one == other || by_windows() || leads_to(&self.before, one, other)
    }

    /// Returns whether one event happens before another in every schedule that is left (SPEC 10.4), as far as its arcs
    /// and orderings or their windows say so.
    pub(crate) fn happens_before(&self, one: NodeId, other: NodeId) -> bool {
        let window = |node: NodeId| self.made.point(node).map(|point| self.window(point));
        let (first, then) = (window(one), window(other));
        // Of two that come at one time whatever happens only their order says which is first.
        let is_one_time = first == then && first.is_some_and(|(earliest, latest)| latest == Some(earliest));
        if is_one_time {
            one == other || leads_to(&self.before, one, other)
        } else {
            self.precedes(one, other)
        }
    }

    pub(crate) fn occurrence(&self, event: EventRef) -> &Occurrence {
        &self.network.occurrences[event.occurrence.index()]
    }

    /// Returns what begins or ends with a node, of all that the plan selects.
    pub(crate) fn events(&self, node: NodeId) -> impl Iterator<Item = EventRef> {
        let events = self.network.nodes[node.index()].events.iter().copied();
        events.filter(|&event| self.plan.has_event(&self.network, event))
    }

    pub(crate) fn name(&self, node: NodeId) -> String {
        match self.events(node).next() {
            Some(event) => self.network.event_name(event),
            None => tpn::plan_json::node_name(&self.network, node),
        }
    }

    /// Enters what happened before this plan was made. Fails for a plan that does not keep it, with the node.
    pub(crate) fn enter_past(&mut self, mut past: Vec<(Time, NodeId)>) -> Result<(), NodeId> {
        past.sort();
        for &(time, node) in &past {
            self.times[node.index()] = Some(time);
        }
        let mut at_once = past.as_slice();
        while let Some(&(time, first)) = at_once.first() {
            let (now, later) = at_once.split_at(at_once.partition_point(|&(other, _)| other == time));
            at_once = later;
            // Of what came at one instant some may have to be entered before others.
            let mut left: Vec<NodeId> = now.iter().map(|&(_, node)| node).collect();
            let ticks = self.made.scale().ticks(time).map_err(|_| first)?;
            while let Some(&next) = left.first() {
                let before = left.len();
                left.retain(|&node| {
                    let point = self.made.point(node);
                    point.is_none_or(|point| self.dispatch.settle(point, ticks).is_err())
                });
                if left.len() == before {
                    return Err(next);
                }
            }
        }
        Ok(())
    }

    /// Returns what is left of it when it is over.
    pub(crate) fn close(self) -> ExecutedPlan {
        ExecutedPlan { from: self.from, network: self.network, plan: self.plan, times: self.times }
    }
}

/// A vertex of a path: it guides the vehicle, and is not a deadline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Guide {
    pub(crate) traverse: OccurrenceId,
    /// How long it takes at least from the start of the traverse.
    pub(crate) min_before: Time,
    /// How long the rest takes at most.
    pub(crate) max_after: Bound,
}

impl Guide {
    fn all(network: &Network, plan: &Plan) -> Result<BTreeMap<NodeId, Self>, PlanError> {
        let mut paths: BTreeMap<OccurrenceId, Vec<&tpn::Arc>> = BTreeMap::new();
        for (arc, _) in network.arcs.iter().zip(&plan.selected_arcs).filter(|(_, is_selected)| **is_selected)
        {
            if let (ArcKind::Path, Some(traverse)) = (arc.kind, arc.occurrence) {
                // In the order in which they follow each other.
                paths.entry(traverse).or_default().push(arc);
            }
        }
        let mut guides = BTreeMap::new();
        for (traverse, path) in paths {
            let mut max_after = Bound::ZERO;
            let mut min_before =
                Time::checked_sum(path.iter().map(|arc| arc.lower)).ok_or(PlanError::Overflow)?;
            for arc in path.iter().skip(1).rev() {
                min_before = min_before.checked_sub(arc.lower).ok_or(PlanError::Overflow)?;
                max_after = max_after.checked_add(arc.upper).ok_or(PlanError::Overflow)?;
                guides.insert(arc.from, Self { traverse, min_before, max_after });
            }
        }
        Ok(guides)
    }
}

/// A network in which the vertices of paths guide vehicles and are not deadlines, so that what bounds a traverse from above is
/// what the mission says of it.
pub fn without_vertex_deadlines(network: &Network) -> Cow<'_, Network> {
    if network.arcs.iter().all(|arc| arc.kind != ArcKind::Path) {
        return Cow::Borrowed(network);
    }
    let mut network = network.clone();
    for arc in network.arcs.iter_mut().filter(|arc| arc.kind == ArcKind::Path) {
        arc.upper = Bound::Infinite;
    }
    Cow::Owned(network)
}

/// The network of a plan as it is executed: the vertices of paths have no latest times of their own, but traverses take at
/// most as long as at their least speeds.
pub fn executed_network<'network>(
    network: &'network Network,
    plan: &Plan,
) -> Result<Cow<'network, Network>, PlanError> {
    Ok(Durations::by_paths(network, plan)?.guided(network))
}

/// What traverses take by their paths and their drivers.
#[derive(Clone, Debug, Default, PartialEq)]
struct Durations {
    /// Those with paths.
    paths: BTreeSet<OccurrenceId>,
    /// At most at their least speeds, of those that may not stop.
    most: BTreeMap<OccurrenceId, Time>,
    /// At least, as the drivers of those under way say.
    least: BTreeMap<OccurrenceId, Time>,
}

impl Durations {
    fn by_paths(network: &Network, plan: &Plan) -> Result<Self, PlanError> {
        let mut greatest: BTreeMap<OccurrenceId, Bound> = BTreeMap::new();
        let selected = network.arcs.iter().zip(&plan.selected_arcs).filter(|(_, is_selected)| **is_selected);
        for (arc, _) in selected {
            if let (ArcKind::Path, Some(traverse)) = (arc.kind, arc.occurrence) {
                let all = greatest.entry(traverse).or_insert(Bound::ZERO);
                *all = all.checked_add(arc.upper).ok_or(PlanError::Overflow)?;
            }
        }
        let paths = greatest.keys().copied().collect();
        let most = greatest.into_iter().filter_map(|(traverse, most)| Some((traverse, most.finite()?)));
        Ok(Self { paths, most: most.collect(), least: BTreeMap::new() })
    }

    /// Makes a plan ready for dispatch, in which the vertices of paths have no latest times of their own, but the traverses
    /// take these durations.
    fn dispatch(
        &self,
        network: &Network,
        plan: &Plan,
        grid: &[Time],
    ) -> Result<(PlanNetwork, Dispatch), PlanError> {
        let network = self.guided(network);
        let mut made = PlanNetwork::new(&network, plan)?;
        made.refine_for(&network, plan, grid)?;
        let dispatch = Dispatch::new(&network, plan, &made)?;
        Ok((made, dispatch))
    }

    fn guided<'network>(&self, network: &'network Network) -> Cow<'network, Network> {
        let mut network = without_vertex_deadlines(network);
        for traverse in &self.paths {
            let Some(whole) = network.occurrences[traverse.index()].arc else { continue };
            let whole = &mut network.to_mut().arcs[whole.index()];
            if let Some(&most) = self.most.get(traverse) {
                whole.upper = whole.upper.min(Bound::Finite(most));
            }
            if let Some(&least) = self.least.get(traverse) {
                whole.lower = whole.lower.max(least);
            }
        }
        network
    }
}

/// Arcs lead forwards in time, but for those by which facts hold the past, which lead back to the start, and for bounds between
/// threads whose minimum is negative: either of their events may come first.
fn before(network: &Network, plan: &Plan) -> Vec<Vec<NodeId>> {
    let mut before = vec![Vec::new(); network.nodes.len()];
    for (arc, _) in network.arcs.iter().zip(&plan.selected_arcs).filter(|(_, is_selected)| **is_selected) {
        if arc.to != network.start && arc.from != arc.to && !arc.lower.is_negative() {
            before[arc.to.index()].push(arc.from);
        }
    }
    // First the order within an instant: what else is added may come at one instant, and then says nothing of it.
    let added =
        plan.precedences(network).into_iter().map(|Precedence { earlier, later, .. }| [earlier, later]);
    for [earlier, later] in plan.instant_order(network).into_iter().chain(added) {
        let is_known = earlier == later || before[later.index()].contains(&earlier);
        if !is_known && !leads_to(&before, later, earlier) {
            before[later.index()].push(earlier);
        }
    }
    wait_together(network, plan, &mut before);
    before
}

/// What comes at one instant because of `[0,0]` waits together: the first of it follows whatever a later one follows.
/// Otherwise the end of a delay would come as soon as it may, and with it the activity behind it, before what that waits
/// for is over.
fn wait_together(network: &Network, plan: &Plan, before: &mut [Vec<NodeId>]) {
    let selected = network.arcs.iter().zip(&plan.selected_arcs).filter(|(_, is_selected)| **is_selected);
    let ties = selected.map(|(arc, _)| arc).filter(|arc| arc.lower.is_zero() && arc.upper == Bound::ZERO);
    let group_of: Vec<usize> = network.instants(ties).into_iter().map(NodeId::index).collect();
    let mut groups: Vec<Group> = vec![Group::default(); before.len()];
    for (node, earlier) in before.iter().enumerate() {
        let group = group_of[node];
        let outside = earlier.iter().filter(|earlier| group_of[earlier.index()] != group);
        groups[group].follows.extend(outside);
        groups[group].members += 1;
        if earlier.iter().all(|earlier| group_of[earlier.index()] != group) {
            groups[group].first.push(NodeId::from_index(node));
        }
    }
    // Instants that follow each other are one; which of their events is first only their own order says.
    let mut followers = vec![Vec::new(); groups.len()];
    for (group, described) in groups.iter().enumerate() {
        for earlier in &described.follows {
            followers[group_of[earlier.index()]].push(group);
        }
    }
    let mut missing: Vec<usize> = groups.iter().map(|group| group.follows.len()).collect();
    let mut ready: Vec<usize> = (0..groups.len()).filter(|&group| missing[group] == 0).collect();
    while let Some(group) = ready.pop() {
        let Group { first, follows, members } = &groups[group];
        if *members > 1 {
            for node in first {
                let own = &mut before[node.index()];
                own.extend(follows);
                own.sort_unstable();
                own.dedup();
            }
        }
        for &follower in &followers[group] {
            missing[follower] -= 1;
            if missing[follower] == 0 {
                ready.push(follower);
            }
        }
    }
}

/// Events that come at one instant.
#[derive(Clone, Default)]
struct Group {
    members: usize,
    /// Those that follow none of the others.
    first: Vec<NodeId>,
    /// What they follow, but for each other.
    follows: Vec<NodeId>,
}

/// Returns whether `to` follows `from`.
fn leads_to(before: &[Vec<NodeId>], from: NodeId, to: NodeId) -> bool {
    let mut seen = vec![false; before.len()];
    let mut pending = vec![to];
    while let Some(node) = pending.pop() {
        if node == from {
            return true;
        }
        if !std::mem::replace(&mut seen[node.index()], true) {
            pending.extend(&before[node.index()]);
        }
    }
    false
}

/// A plan that was executed, as far as it was.
#[derive(Clone, Debug, PartialEq)]
pub struct ExecutedPlan {
    /// When it was made.
    pub from: Time,
    /// Its network, with the facts known then.
    pub network: Arc<Network>,
    pub plan: Plan,
    /// When each node happened, those before `from` included; `None` for those that did not while this plan held.
    pub times: Vec<Option<Time>>,
}
