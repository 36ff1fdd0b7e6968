//! How long it is between two events in all schedules of a plan.

use std::collections::BTreeMap;

use exact::Bound;
use executive::PlanNetwork;
use stn::{INFINITE, PairDistances};
use tpn::{Network, NodeId, Plan};

use super::TimeRange;

/// The distances of one plan.
pub struct Distances {
    network: PlanNetwork,
    /// `None` where times do not fit.
    pairs: Option<PairDistances>,
}

impl Distances {
    /// `None` where times do not fit, which planning would already have said.
    ///
    /// Orderings that follow from others change no distance, and of intervals that exclude each other most do.
    pub fn new(network: &Network, plan: &Plan) -> Option<Self> {
        let pairs: Vec<[usize; 2]> =
            plan.orderings_added.iter().map(|it| [it.first.index(), it.then.index()]).collect();
        let mut plan = plan.clone();
        let mut is_needed = tpn::precedence::needed(&pairs).into_iter();
        plan.orderings_added.retain(|_| is_needed.next().unwrap_or(true));
        let network = PlanNetwork::new(network, &plan).ok()?;
        let pairs = PairDistances::new(&network.stn).ok();
        Some(Self { network, pairs })
    }

    /// Returns how far it is from the second of two events to the first, and from the first to the second.
    fn on_the_tree(&self, from: NodeId, to: NodeId) -> Option<(i64, i64)> {
        let pairs = self.pairs.as_ref()?;
        let (from, to) = (self.network.point(from)?, self.network.point(to)?);
        let distance = |from, to| pairs.between(from, to).ok().flatten();
        Some((distance(to, from)?, distance(from, to)?))
    }

    /// Returns whether some schedule has the second of two events later than the first.
    pub fn can_follow(&mut self, from: NodeId, to: NodeId) -> bool {
        let (Some(from), Some(to)) = (self.network.point(from), self.network.point(to)) else { return false };
        let known = self.pairs.as_ref().and_then(|pairs| pairs.between(from, to).ok().flatten());
        let distance = known.unwrap_or_else(|| {
            let mut row = Vec::new();
            // Times that do not fit may be any.
            let is_found = self.network.stn.distances_from(from, &mut row).is_ok();
            if is_found { row[to.index()] } else { INFINITE }
        });
        distance > 0
    }

    /// For each pair, how much later the second event is than the first; `None` if nothing bounds it from below.
    ///
    /// Found on the elimination tree of the plan's constraints; where that leaves something out, by one search of the
    /// constraints for each different event, however many pairs share it.
    pub fn between(&mut self, pairs: &[(NodeId, NodeId)]) -> Vec<Option<TimeRange>> {
        let mut wanted: BTreeMap<NodeId, Vec<(NodeId, usize, bool)>> = BTreeMap::new();
        let mut found = vec![(INFINITE, INFINITE); pairs.len()];
        for (index, &(from, to)) in pairs.iter().enumerate() {
            if let Some(known) = self.on_the_tree(from, to) {
                found[index] = known;
                continue;
            }
            wanted.entry(from).or_default().push((to, index, true));
            wanted.entry(to).or_default().push((from, index, false));
        }
        let mut row = Vec::new();
        for (source, targets) in wanted {
            let Some(source) = self.network.point(source) else { continue };
            if self.network.stn.distances_from(source, &mut row).is_err() {
                continue;
            }
            for (target, index, is_forward) in targets {
                let Some(target) = self.network.point(target) else { continue };
                let slot = &mut found[index];
                *(if is_forward { &mut slot.1 } else { &mut slot.0 }) = row[target.index()];
            }
        }
        found
            .into_iter()
            .map(|(backward, forward)| {
                let least = (backward != INFINITE).then(|| self.network.time(-backward))?;
                let greatest = match forward {
                    INFINITE => Bound::Infinite,
                    forward => Bound::Finite(self.network.time(forward)),
                };
                Some(TimeRange { least, greatest })
            })
            .collect()
    }
}
