//! The order of events within each instant of a schedule (SPEC 10.4): a search for one that follows the text and keeps the
//! rules of state and of resources.
//!
//! Events are placed one after the other, by time. What a placed event leaves to later ones is which producers may still
//! make a requirement hold; all else follows from which events are placed. So a search over these two is exact.

mod place;

use std::collections::{BTreeMap, BTreeSet};

use exact::{Bound, Time};
use tpn::{LabelId, Network, NodeId};

use super::Schedule;
use crate::amounts::{ScaledSupply, Shared};
use crate::state::{self, State};
use crate::{Rule, Violation, departure, node_name};
use place::Refusal;

/// After this many ways to place events of which several may be next the search gives up. Twelve events at one instant have
/// fewer: what matters of a set of placed ones is which was last to give each variable its value, and over all sets that
/// makes no more than 33³, for three variables with four events each.
const MAX_WAYS: usize = 1 << 16;

/// What events are about: a state variable or a resource, by its place among those of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Subject {
    State(usize),
    Resource(usize),
}

/// The events at one time.
struct Instant {
    time: Time,
    nodes: Vec<NodeId>,
    /// By place: the places of those that an arc puts before it.
    before: Vec<Vec<usize>>,
    /// The places of the events about each subject.
    about: BTreeMap<Subject, Vec<usize>>,
}

/// How far the events are placed.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Placed {
    instant: usize,
    /// By place, of the present instant.
    has_come: Vec<bool>,
    /// By state: the producers that can make a requirement hold that starts next: ready, and everything that they exclude
    /// and that has started was over when they were.
    holding: Vec<Vec<LabelId>>,
}

struct Search<'search> {
    schedule: &'search Schedule<'search>,
    instants: Vec<Instant>,
    /// By node: the instant and the place in it.
    at: Vec<Option<(usize, usize)>>,
    states: Vec<State>,
    shared: Vec<Shared>,
    /// By node: what it is about.
    subjects: Vec<Vec<Subject>>,
    movements: BTreeSet<LabelId>,
}

impl Schedule<'_> {
    /// Some order of the events, by time and within each instant along the arcs, keeps the rules of SPEC 10.2 and 11.
    pub(super) fn check_order(&self, violations: &mut Vec<Violation>) {
        // What is too large to be added exactly has been said.
        let Some(shared) = Shared::all(self.network, self.plan) else { return };
        violations.extend(Search::new(self, shared).run().err());
    }
}

impl<'search> Search<'search> {
    fn new(schedule: &'search Schedule<'search>, shared: Vec<Shared>) -> Self {
        let (network, plan) = (schedule.network, schedule.plan);
        let states = state::selected(network, plan);
        let mut subjects: Vec<Vec<Subject>> = vec![Vec::new(); network.nodes.len()];
        let mut add = |node: NodeId, subject: Subject| {
            let own: &mut Vec<Subject> = &mut subjects[node.index()];
            if own.last() != Some(&subject) {
                own.push(subject);
            }
        };
        for (index, state) in states.iter().enumerate() {
            let producers = state.producers.iter().flat_map(|it| [it.start, it.end]);
            let requirements = state.requirements.iter().flat_map(|it| [it.start, it.end]);
            producers.chain(requirements).for_each(|node| add(node, Subject::State(index)));
        }
        for (index, shared) in shared.iter().enumerate() {
            for it in &shared.uses {
                let nodes = match shared.supply {
                    ScaledSupply::Reusable { .. } => [it.start, it.end],
                    ScaledSupply::Reservoir { .. } => [it.moment(), it.last_moment()],
                };
                for node in nodes {
                    add(node, Subject::Resource(index));
                }
            }
        }
        let (instants, at) = instants(schedule, &subjects);
        let movements = departure::arrivals(network, plan);
        Self { schedule, instants, at, states, shared, subjects, movements }
    }

    fn network(&self) -> &'search Network {
        self.schedule.network
    }

    /// Depth first, so that a schedule whose order is plain costs no more than to go through it.
    fn run(&self) -> Result<(), Violation> {
        let first = Placed {
            instant: 0,
            has_come: vec![false; self.instants.first().map_or(0, |instant| instant.nodes.len())],
            holding: vec![Vec::new(); self.states.len()],
        };
        let mut open = vec![first];
        let mut seen = BTreeSet::new();
        let mut farthest: Option<((usize, usize), Violation)> = None;
        while let Some(mut placed) = open.pop() {
            loop {
                let Some(instant) = self.instants.get(placed.instant) else { return Ok(()) };
                let mut next = self.next(instant, &placed);
                let reached = (placed.instant, placed.has_come.iter().filter(|it| **it).count());
                let mut refuse = |violation: &dyn Fn() -> Violation| {
                    if farthest.as_ref().is_none_or(|(before, _)| reached > *before) {
                        farthest = Some((reached, violation()));
                    }
                };
                match next.as_slice() {
                    [] if placed.has_come.iter().all(|it| *it) => {
                        placed.instant += 1;
                        let count = self.instants.get(placed.instant).map_or(0, |it| it.nodes.len());
                        placed.has_come = vec![false; count];
                    }
                    [] => {
                        refuse(&|| self.in_a_circle(instant, &placed));
                        break;
                    }
                    &[only] => {
                        if let Err(refusal) = self.place(instant, only, &mut placed) {
                            refuse(&|| self.without_order(instant, only, &refusal));
                            break;
                        }
                    }
                    _ => {
                        if !seen.insert(placed.clone()) {
                            break;
                        }
                        if seen.len() > MAX_WAYS {
                            return Err(too_many(instant));
                        }
                        // The one that is first in the text is tried first.
                        next.reverse();
                        for place in next {
                            let mut further = placed.clone();
                            match self.place(instant, place, &mut further) {
                                Ok(()) => open.push(further),
                                Err(refusal) => refuse(&|| self.without_order(instant, place, &refusal)),
                            }
                        }
                        break;
                    }
                }
            }
        }
        Err(farthest.map_or_else(|| Violation::new(Rule::State, "no order of the events"), |(_, it)| it))
    }

    /// The events of which one is to be placed next, without loss: what an event is about and what must come before that
    /// can go before all else, in any order that keeps the rules.
    fn next(&self, instant: &Instant, placed: &Placed) -> Vec<usize> {
        let is_free = |place: usize| {
            !placed.has_come[place] && instant.before[place].iter().all(|&it| placed.has_come[it])
        };
        let free: Vec<usize> = (0..instant.nodes.len()).filter(|&place| is_free(place)).collect();
        let mut is_known = vec![false; instant.nodes.len()];
        let mut least: Option<Vec<usize>> = None;
        for &place in &free {
            if std::mem::replace(&mut is_known[place], true) {
                continue;
            }
            let mut is_inside = vec![false; instant.nodes.len()];
            let mut inside = vec![place];
            is_inside[place] = true;
            let mut at = 0;
            while let Some(&member) = inside.get(at) {
                at += 1;
                let subjects = self.subjects[instant.nodes[member].index()].iter();
                let related = subjects.flat_map(|subject| &instant.about[subject]);
                for &other in related.chain(&instant.before[member]) {
                    if !placed.has_come[other] && !std::mem::replace(&mut is_inside[other], true) {
                        inside.push(other);
                    }
                }
            }
            // What is about the same has the same around it.
            let subjects = self.subjects[instant.nodes[place].index()].iter();
            for &alike in subjects.flat_map(|subject| &instant.about[subject]) {
                is_known[alike] = true;
            }
            let choices: Vec<usize> = free.iter().copied().filter(|&it| is_inside[it]).collect();
            if choices.len() == 1 {
                return choices;
            }
            if least.as_ref().is_none_or(|least| choices.len() < least.len()) {
                least = Some(choices);
            }
        }
        least.unwrap_or_default()
    }

    /// Returns whether an event is placed before the one that is placed next.
    fn is_over(&self, placed: &Placed, node: NodeId) -> bool {
        self.at[node.index()].is_some_and(|(instant, place)| {
            instant < placed.instant || (instant == placed.instant && placed.has_come[place])
        })
    }

    fn without_order(&self, instant: &Instant, place: usize, refusal: &Refusal) -> Violation {
        let name = node_name(self.network(), instant.nodes[place]);
        let message = format!(
            "no order of the events at {} follows the text and satisfies every rule: with {name} next, {}",
            Bound::Finite(instant.time),
            refusal.message
        );
        Violation::new(refusal.rule, message)
            .with_events(vec![name])
            .with_intervals(refusal.intervals.clone())
    }

    fn in_a_circle(&self, instant: &Instant, placed: &Placed) -> Violation {
        let left = instant.nodes.iter().zip(&placed.has_come).filter(|(_, has_come)| !**has_come);
        let names: Vec<String> = left.map(|(&node, _)| node_name(self.network(), node)).collect();
        let message = format!(
            "the events at {} have no order that follows the text: each of {} would have to come after another",
            Bound::Finite(instant.time),
            names.join(", ")
        );
        Violation::new(Rule::Temporal, message).with_events(names)
    }
}

fn too_many(instant: &Instant) -> Violation {
    let message = format!(
        "the events at {} have too many orders to check: the search stopped after {MAX_WAYS} attempts",
        Bound::Finite(instant.time)
    );
    Violation::new(Rule::Form, message)
}

/// The selected events by time; and by node its instant and its place there.
fn instants(
    schedule: &Schedule<'_>,
    subjects: &[Vec<Subject>],
) -> (Vec<Instant>, Vec<Option<(usize, usize)>>) {
    let (network, plan) = (schedule.network, schedule.plan);
    let mut by_time: BTreeMap<Time, Vec<NodeId>> = BTreeMap::new();
    for node in (0..network.nodes.len()).map(NodeId::from_index) {
        if plan.selected_nodes[node.index()] {
            by_time.entry(schedule.time(node)).or_default().push(node);
        }
    }
    let mut at = vec![None; network.nodes.len()];
    let mut instants = Vec::with_capacity(by_time.len());
    for (time, nodes) in by_time {
        let mut about: BTreeMap<Subject, Vec<usize>> = BTreeMap::new();
        for (place, node) in nodes.iter().enumerate() {
            at[node.index()] = Some((instants.len(), place));
            for &subject in &subjects[node.index()] {
                about.entry(subject).or_default().push(place);
            }
        }
        let before = vec![Vec::new(); nodes.len()];
        instants.push(Instant { time, nodes, before, about });
    }
    for (arc, _) in network.arcs.iter().zip(&plan.selected_arcs).filter(|(_, is_selected)| **is_selected) {
        // Nothing is before the start.
        if arc.lower.is_negative() || arc.to == network.start || arc.from == arc.to {
            continue;
        }
        if let (Some((one, from)), Some((other, to))) = (at[arc.from.index()], at[arc.to.index()])
            && one == other
        {
            instants[one].before[to].push(from);
        }
    }
    (instants, at)
}
