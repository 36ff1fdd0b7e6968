//! Nature against a plan that is not controllable: durations that make it fail, chosen as the run goes (SPEC 13.2).

use controllability::{PlanNetwork, plan_network};
use exact::Time;
use rmpl::program::Controllability;
use stnu::adversary::{Intention, respond};
use tpn::{ArcId, Network, NodeId};

use crate::plan_network::PlanError;
use crate::stage::Stage;
use crate::world::World;

/// The network that is played on. No duration is the executive's to choose because the mission reads it as ordinary.
#[derive(Clone, Debug)]
pub(crate) struct Adversary {
    read: PlanNetwork,
}

impl Adversary {
    /// The adversary of a stage in `world`, if there is one: plans that withstand the environment have none.
    pub(crate) fn of(world: &World, stage: &Stage) -> Result<Option<Self>, PlanError> {
        let is_lost = !stage.dispatch.withstands_nature() && !stage.natures.is_empty();
        if !world.is_adversary() || !is_lost {
            return Ok(None);
        }
        let precedences = stage.plan.precedences(&stage.network);
        let network = Network { controllability: Controllability::Dynamic, ..stage.network.as_ref().clone() };
        let scale = stage.made.scale();
        let read = plan_network(&network, &stage.plan.selected_arcs, &precedences, scale)?;
        let verdict = stnu::check(&read.network, &mut || false)?;
        Ok((verdict != stnu::Verdict::Controllable).then_some(Self { read }))
    }

    /// Returns which duration the environment ends next, and when; `None` if it lets the executive do what that would
    /// do next, at an event and a time.
    pub(crate) fn answer(
        &self,
        stage: &Stage,
        now: Time,
        next: Option<(NodeId, Time)>,
    ) -> Result<Option<(ArcId, Time)>, PlanError> {
        let (network, scale) = (&self.read.network, self.read.scale);
        let ticks = |time: Time| scale.ticks(time);
        let mut times = vec![None; network.num_points()];
        for (index, time) in stage.times.iter().enumerate() {
            if let (Some(point), Some(time)) = (self.read.point(NodeId::from_index(index)), *time) {
                times[point.index()] = Some(ticks(time)?);
            }
        }
        // A duration is over when its own end has come, whatever else comes at that instant.
        for (id, link) in (0..).map(stnu::LinkId).zip(network.links()) {
            let end = stage.network.arcs[self.read.arc(id).index()].to;
            times[link.end.index()] = stage.times[end.index()].map(ticks).transpose()?;
        }
        let mut intention = None;
        if let Some((node, at)) = next
            && let Some(point) = self.read.point(node)
        {
            if times[point.index()].is_some() {
                // It comes at the instant that has come.
                return Ok(None);
            }
            intention = Some(Intention { points: vec![point], at: ticks(at)? });
        }
        let answer = respond(network, &times, ticks(now)?, intention.as_ref(), &mut || false)?;
        Ok(answer.map(|(link, at)| (self.read.arc(link), scale.time(at))))
    }
}
