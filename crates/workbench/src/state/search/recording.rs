//! A recorded search with the network it was recorded on, and what was known at one of its steps.

use std::sync::Arc;

use kirk::Search as SearchKind;
use kirk::{Replay, ReplayStep, Trace};
use link::{BothSearches, Searched};
use snapshot::Snapshot;
use tpn::{Network, NodeId, Plan, Window};

/// A recorded search with the network it was recorded on.
#[derive(Clone, Debug)]
pub struct Recording {
    network: Arc<Network>,
    source: Source,
}

/// Where a recording comes from.
#[derive(Clone, Debug)]
enum Source {
    /// The search that found the plan.
    Planned(Arc<Snapshot>),
    /// One of two that are compared.
    Compared(Arc<BothSearches>, usize),
}

static NOTHING: Trace = Trace { events: Vec::new(), tree: Vec::new(), is_truncated: false };

impl Recording {
    /// The search that planned `snapshot`, if it was recorded.
    pub fn planned(snapshot: &Arc<Snapshot>) -> Option<Self> {
        recorded(snapshot)?;
        Some(Self {
            network: Arc::clone(snapshot.network.as_ref()?),
            source: Source::Planned(Arc::clone(snapshot)),
        })
    }

    /// One of the searches of a comparison, made on `network`.
    pub fn compared(network: &Arc<Network>, comparison: &Arc<BothSearches>, side: usize) -> Option<Self> {
        let searched = comparison.searches.get(side)?;
        (!searched.trace.events.is_empty()).then(|| Self {
            network: Arc::clone(network),
            source: Source::Compared(Arc::clone(comparison), side),
        })
    }

    /// The network that was searched.
    pub fn network(&self) -> &Arc<Network> {
        &self.network
    }

    /// Returns what the search did; it has at least one step.
    pub fn trace(&self) -> &Trace {
        let trace = match &self.source {
            Source::Planned(snapshot) => recorded(snapshot),
            Source::Compared(..) => self.searched().map(|searched| &searched.trace),
        };
        trace.unwrap_or(&NOTHING)
    }

    /// The search as it was measured, if it is one of two that are compared.
    pub fn searched(&self) -> Option<&Searched> {
        match &self.source {
            Source::Planned(_) => None,
            Source::Compared(comparison, side) => comparison.searches.get(*side),
        }
    }

    /// Its kind, if it is one of two that are compared.
    pub fn kind(&self) -> Option<SearchKind> {
        self.searched().map(|searched| searched.search)
    }

    /// Returns how many steps it has.
    pub fn steps(&self) -> usize {
        self.trace().events.len()
    }

    /// Returns whether `other` is the very same recording.
    pub fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.network, &other.network)
            && match (&self.source, &other.source) {
                (Source::Planned(one), Source::Planned(other)) => Arc::ptr_eq(one, other),
                (Source::Compared(one, left), Source::Compared(other, right)) => {
                    Arc::ptr_eq(one, other) && left == right
                }
                _ => false,
            }
    }
}

/// The recorded search of a snapshot, if there is one with at least one step.
pub fn recorded(snapshot: &Snapshot) -> Option<&Trace> {
    let trace = snapshot.planning.as_ref()?.outcome.trace.as_ref()?;
    (!trace.events.is_empty()).then_some(trace)
}

/// A step of a recording that is looked at, with what the search knew there.
#[derive(Clone, Debug)]
pub struct View {
    pub recording: Recording,
    pub step: Arc<ReplayStep>,
    /// What was selected at the step, in the form of a plan, for the panels that draw plans.
    pub plan: Arc<Plan>,
    /// The windows that the step changed.
    pub changes: Arc<Vec<WindowChange>>,
    replay: Arc<Replay>,
}

/// A window that a step changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindowChange {
    pub node: NodeId,
    /// What it was before; nothing if the event was not selected.
    pub before: Option<Window>,
    /// What it is after the step; nothing if the event is not selected any more.
    pub after: Option<Window>,
}

impl View {
    /// The state of `recording` after step `step`, from 0. What `earlier` has worked out is used if it is a step of the
    /// same recording.
    pub fn at(recording: &Recording, step: usize, earlier: Option<&Self>) -> Option<Self> {
        let earlier = earlier.filter(|earlier| earlier.recording.is(recording));
        let replay = match earlier {
            Some(earlier) => Arc::clone(&earlier.replay),
            None => Arc::new(Replay::new(&recording.network, None, recording.trace())?),
        };
        let shown = replay.at(recording.trace(), step);
        let changes = match (earlier, step) {
            (_, 0) => changes(&[], &shown.windows),
            (Some(earlier), _) if earlier.step.step + 1 == step => {
                changes(&earlier.step.windows, &shown.windows)
            }
            _ => changes(&replay.at(recording.trace(), step - 1).windows, &shown.windows),
        };
        Some(Self {
            recording: recording.clone(),
            plan: Arc::new(as_plan(&recording.network, &shown)),
            step: Arc::new(shown),
            changes: Arc::new(changes),
            replay,
        })
    }

    /// The same step of an equal recording.
    pub fn moved_to(&self, recording: Recording) -> Self {
        Self { recording, ..self.clone() }
    }
}

fn changes(before: &[Option<Window>], after: &[Option<Window>]) -> Vec<WindowChange> {
    let windows = after.iter().enumerate().map(|(index, &after)| WindowChange {
        node: NodeId::from_index(index),
        before: before.get(index).copied().flatten(),
        after,
    });
    windows.filter(|change| change.before != change.after).collect()
}

fn as_plan(network: &Network, step: &ReplayStep) -> Plan {
    let mut plan = Plan {
        choices: step.choices.clone(),
        selected_nodes: vec![false; network.nodes.len()],
        selected_arcs: vec![false; network.arcs.len()],
        causal_links: step.links.clone(),
        conflict_order: step.orders.clone(),
        conflict_order_omitted: 0,
        state_order: Vec::new(),
        orderings_added: step.orders.clone(),
        uses_ordered: step.uses.clone(),
        levels: Vec::new(),
        quality: tpn::Quality::default(),
        windows: step.windows.clone(),
    };
    plan.windows.resize(network.nodes.len(), None);
    for node in &step.nodes {
        if let Some(selected) = plan.selected_nodes.get_mut(node.index()) {
            *selected = true;
        }
    }
    for arc in &step.arcs {
        if let Some(selected) = plan.selected_arcs.get_mut(arc.index()) {
            *selected = true;
        }
    }
    plan
}
