//! A mission as a constraint problem that says all that the planner decides: choices, times, conditions and threats.
//!
//! Every solver is given this same problem. A literal is a number: 0 is always true, others are free Booleans. An event
//! exists when its literal holds; an arc binds when its literal holds. The structure of the program is used for all of
//! them alike: a merge after a choice exists when the choice does, and a pair of conditions that the arcs put in an
//! order in any case is left out.

use exact::{Bound, Time};
use rmpl::program::LabelMode;
use serde::Serialize;
use tpn::{ArcKind, Label, Network, NodeId};

/// A time interval that exists when a literal holds.
#[derive(Clone, Copy, Serialize)]
pub(crate) struct Interval {
    pub(crate) when: usize,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

/// Exactly one of the alternatives holds if `when` holds, and none if not.
#[derive(Serialize)]
pub(crate) struct Choice {
    pub(crate) when: usize,
    pub(crate) alternatives: Vec<usize>,
}

/// `lower ≤ time of to − time of from ≤ upper`, when the literal holds; no upper bound is `None`.
#[derive(Serialize)]
pub(crate) struct Bounds {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) lower: i32,
    pub(crate) upper: Option<i32>,
    pub(crate) when: usize,
}

/// An interval that must lie inside one of the others.
#[derive(Serialize)]
pub(crate) struct Requirement {
    pub(crate) interval: Interval,
    pub(crate) supports: Vec<Interval>,
}

#[derive(Serialize)]
pub(crate) struct Instance {
    /// The number of literals, the true one included.
    pub(crate) literals: usize,
    /// The literal of every event; event 0 is at time 0.
    pub(crate) events: Vec<usize>,
    /// No event is later.
    pub(crate) horizon: i32,
    pub(crate) choices: Vec<Choice>,
    pub(crate) bounds: Vec<Bounds>,
    pub(crate) requirements: Vec<Requirement>,
    /// Pairs of intervals of which one ends at least `gap` before the other starts, if both exist.
    pub(crate) conflicts: Vec<(Interval, Interval)>,
    pub(crate) gap: i32,
}

impl Instance {
    /// The problem of a network, in the greatest unit of which all its bounds are whole multiples. Where nothing bounds
    /// the whole, no event is later than if everything took the longest and came one after the other.
    pub(crate) fn of(network: &Network) -> Self {
        let mut contexts = Contexts::default();
        let mut events = contexts.of_events(network);
        // Event 0 is the start.
        let start = network.start.index();
        events.swap(0, start);
        let event = |node: NodeId| match node.index() {
            0 => start,
            node if node == start => 0,
            node => node,
        };
        let units = units_of(network);
        let whole = |time: Time| whole(time, units);
        let spans = network.arcs.iter().filter(|arc| arc.from == network.start && arc.to == network.end);
        let horizon = spans.filter_map(|arc| arc.upper.finite()).map(whole).min().unwrap_or_else(|| {
            let longest = network.arcs.iter().map(|arc| whole(arc.upper.finite().unwrap_or(arc.lower)));
            longest.fold(0_i32, i32::saturating_add).min(i32::MAX / 4)
        });
        let bounds: Vec<Bounds> = (network.arcs.iter())
            .map(|arc| Bounds {
                from: event(arc.from),
                to: event(arc.to),
                lower: whole(arc.lower),
                upper: match arc.upper {
                    Bound::Finite(upper) => Some(whole(upper)),
                    Bound::Infinite => None,
                },
                when: if arc.kind == ArcKind::Choice {
                    events[event(arc.to)]
                } else {
                    events[event(arc.from)]
                },
            })
            .collect();
        let choices = (network.decisions.iter())
            .map(|decision| Choice {
                when: events[event(decision.node)],
                alternatives: (decision.alternatives.iter())
                    .map(|arc| events[event(network.arcs[arc.index()].to)])
                    .collect(),
            })
            .collect();
        let interval = |label: &Label| {
            let arc = &network.arcs[label.arc.index()];
            Interval { when: events[event(arc.from)], start: event(arc.from), end: event(arc.to) }
        };
        let requirements = (network.labels.iter().filter(|label| label.mode == LabelMode::Ask))
            .map(|ask| Requirement {
                interval: interval(ask),
                supports: (network.labels.iter())
                    .filter(|tell| tell.mode == LabelMode::Tell && tell.literal.supports(&ask.literal))
                    .map(interval)
                    .filter(|tell| {
                        !contexts.exclude(tell.when, events[event(network.arcs[ask.arc.index()].from)])
                    })
                    .collect(),
            })
            .collect();
        let mut conflicts = Vec::new();
        for (at, first) in network.labels.iter().enumerate() {
            for second in &network.labels[at + 1..] {
                if first.literal.conflicts(&second.literal) {
                    let (one, other) = (interval(first), interval(second));
                    if !contexts.exclude(one.when, other.when)
                        && !is_ordered(network, first, second)
                        && !is_ordered(network, second, first)
                    {
                        conflicts.push((one, other));
                    }
                }
            }
        }
        Self {
            literals: contexts.parents.len(),
            events,
            horizon,
            choices,
            bounds,
            requirements,
            conflicts,
            gap: whole(network.threat_gap),
        }
    }
}

/// Returns whether the arcs alone put `first` before `second`; touching is enough, unless it is a point.
fn is_ordered(network: &Network, first: &Label, second: &Label) -> bool {
    let arc = &network.arcs[first.arc.index()];
    if arc.upper == Bound::Finite(Time::ZERO) {
        return false;
    }
    let start = network.arcs[second.arc.index()].from;
    let mut seen = vec![false; network.nodes.len()];
    let mut open = vec![arc.to];
    while let Some(node) = open.pop() {
        if node == start {
            return true;
        }
        if !std::mem::replace(&mut seen[node.index()], true) {
            open.extend(network.nodes[node.index()].out_arcs.iter().map(|arc| network.arcs[arc.index()].to));
        }
    }
    false
}

/// In how many parts a unit of time is divided for all bounds to be whole.
fn units_of(network: &Network) -> i128 {
    let bounds = network.arcs.iter().flat_map(|arc| [Some(arc.lower), arc.upper.finite()]).flatten();
    bounds.chain([network.threat_gap]).fold(1, |units, time| {
        let denominator = i128::from(time.denominator());
        units / greatest_common_divisor(units, denominator) * denominator
    })
}

fn greatest_common_divisor(one: i128, other: i128) -> i128 {
    if other == 0 { one } else { greatest_common_divisor(other, one % other) }
}

fn whole(time: Time, units: i128) -> i32 {
    let whole = i128::from(time.numerator()) * (units / i128::from(time.denominator()));
    i32::try_from(whole).expect("missions of the benchmark are short")
}

/// The literals: 0 and one per alternative.
#[derive(Default)]
struct Contexts {
    /// Per literal: the decision it is an alternative of, and the literal under which that decision is made.
    parents: Vec<Option<(usize, usize)>>,
}

impl Contexts {
    /// The literal of every event, in the order of time through the network.
    fn of_events(&mut self, network: &Network) -> Vec<usize> {
        self.parents.push(None);
        let mut waiting: Vec<usize> = network.nodes.iter().map(|node| node.in_arcs.len()).collect();
        let mut contexts = vec![0; network.nodes.len()];
        let mut open = vec![network.start.index()];
        while let Some(at) = open.pop() {
            let node = &network.nodes[at];
            let incoming: Vec<usize> = (node.in_arcs.iter())
                .map(|arc| &network.arcs[arc.index()])
                .map(|arc| match arc.choice {
                    Some((decision, _)) => {
                        self.parents.push(Some((decision.index(), contexts[arc.from.index()])));
                        self.parents.len() - 1
                    }
                    None => contexts[arc.from.index()],
                })
                .collect();
            contexts[at] = match incoming.first() {
                None => 0,
                Some(&first) if incoming.iter().all(|&context| context == first) => first,
                // A merge, or what follows it: the literal under which all of these are made.
                Some(_) => incoming.into_iter().reduce(|a, b| self.common(a, b)).unwrap_or(0),
            };
            for arc in &node.out_arcs {
                let to = network.arcs[arc.index()].to.index();
                waiting[to] -= 1;
                if waiting[to] == 0 {
                    open.push(to);
                }
            }
        }
        contexts
    }

    /// The literals from the given one up to the true one.
    fn ancestors(&self, mut context: usize) -> Vec<usize> {
        let mut line = vec![context];
        while let Some((_, parent)) = self.parents[context] {
            context = parent;
            line.push(context);
        }
        line
    }

    fn common(&self, a: usize, b: usize) -> usize {
        let line = self.ancestors(b);
        self.ancestors(a).into_iter().find(|context| line.contains(context)).unwrap_or(0)
    }

    /// Returns whether the two belong to different alternatives of one decision.
    fn exclude(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.ancestors(a), self.ancestors(b));
        a.iter().any(|&one| {
            b.iter().any(|&other| {
                one != other
                    && self.parents[one].is_some()
                    && self.parents[one].map(|parent| parent.0) == self.parents[other].map(|parent| parent.0)
            })
        })
    }
}
