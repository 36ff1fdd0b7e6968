//! The run in which the environment makes a plan fail, event by event: what a proof that it is not controllable looks
//! like in the world.

use exact::Time;
use serde::{Deserialize, Serialize};
use tpn::{ArcId, Network, NodeId, Precedence};

use crate::{Side, Source, plan_network, scale};

/// A run that ends in a constraint that cannot be kept.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FailingRun {
    /// What happens, in the order of time.
    pub events: Vec<RunEvent>,
    /// What cannot be kept.
    pub broken: Broken,
    /// When that is certain.
    pub at: Time,
}

/// What happens at one instant of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RunEvent {
    /// One of the events there, with a name if one of them has one.
    pub event: NodeId,
    pub time: Time,
    /// The duration that the environment ends there; otherwise the executive acts.
    pub natures: Option<ArcId>,
}

/// A constraint that cannot be kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Broken {
    /// The least duration of an arc.
    Lower(ArcId),
    /// The greatest duration of an arc.
    Upper(ArcId),
    /// One event comes before another.
    Order {
        /// What had to come first.
        earlier: NodeId,
        /// What had to come after it.
        later: NodeId,
    },
}

/// The run in which an executive fails that does everything as early as the constraints of a plan let it, against the
/// environment that chooses durations as the run goes; `None` if it need not fail, if that cannot be told, or if `stop` said so. The
/// plan is given by what it selects and what it adds.
pub fn failing_run(
    network: &Network,
    selected_arcs: &[bool],
    precedences: &[Precedence],
    stop: stnu::Stop<'_>,
) -> Option<FailingRun> {
    let read = plan_network(network, selected_arcs, precedences, scale(network).ok()?).ok()?;
    if stnu::check(&read.network, stop).ok()? == stnu::Verdict::Controllable {
        return None;
    }
    let run = stnu::adversary::failing_run(&read.network, stop).ok()??;
    let is_named = |node: &&NodeId| !network.nodes[node.index()].events.is_empty();
    let event = |point| {
        let nodes = read.nodes(point);
        nodes.iter().find(is_named).or_else(|| nodes.first()).copied()
    };
    let events = run.events.iter().filter_map(|&(point, ticks)| {
        let natures = read.network.link_ending_at(point).map(|link| read.arc(link));
        let event = event(point).or_else(|| natures.map(|arc| network.arcs[arc.index()].to))?;
        Some(RunEvent { event, time: read.scale.time(ticks), natures })
    });
    let broken = match read.source(stnu::Part::Edge(run.broken)) {
        Source::Arc(arc, Side::Lower) => Broken::Lower(arc),
        Source::Arc(arc, Side::Upper) => Broken::Upper(arc),
        Source::Precedence(place) => {
            let Precedence { earlier, later, .. } = precedences[place];
            Broken::Order { earlier, later }
        }
        Source::Tie(_) => return None,
    };
    Some(FailingRun { events: events.collect(), broken, at: read.scale.time(run.at) })
}
