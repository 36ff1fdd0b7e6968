//! A plan that is given instead of found, with the paths of its own traverses.

use std::sync::Arc;

use kirk::{Outcome, Stats, Status};
use tpn::{Network, Plan};

use crate::ground::Grounds;
use crate::listing;
use crate::planning::{self, Planned, Problem};
use crate::traverse::Paths;

/// Returns what `planned` would be if planning had found the plan that `read` reads. Fails with the reason if it is not a plan
/// of the mission.
pub(crate) fn planned(
    problem: &Problem<'_>,
    planned: &Planned,
    read: &dyn Fn(&Network) -> Result<Plan, String>,
    grounds: &mut Grounds,
    paths: &mut Paths,
) -> Result<Planned, String> {
    // The plan that was found has paths, and perhaps orders of vehicles that would meet, which others lack.
    let own = read(&planned.network).ok().filter(|plan| verify::check_plan(&planned.network, plan).valid);
    let is_own = own.is_some();
    let plan = own.map_or_else(|| read(problem.network), Ok)?;
    let base = if is_own { &planned.network } else { problem.network };
    let inserted = listing::inserted(problem, (base, &plan), grounds, paths)?;
    let (network, plan) = if is_own {
        (Arc::clone(&planned.network), plan)
    } else {
        let network = planning::with_paths(problem, &inserted);
        let plan = read(&network)?;
        (Arc::new(network), plan)
    };
    let outcome = Outcome {
        status: Status::Plan,
        plans: vec![plan],
        bound: None,
        failure: None,
        stats: Stats::default(),
        trace: None,
        unplannable: None,
    };
    Ok(planning::conclude(problem, network, outcome, inserted))
}
