//! Counterexamples to the items of a review: other plans of the mission, and what vehicles see during a run.

use std::sync::Arc;

use exact::Time;
use kirk::{Options, Search};
use review::contradict::{Effort, Sight, Trial};
use review::record::LineKey;
use snapshot::SimulatedDrive;
use tpn::{Network, Plan};

use crate::evaluated::Evaluated;
use crate::ground::Grounds;
use crate::planning::{self, Planned, Problem};
use crate::sight::Seeing;
use crate::traverse::Paths;

/// A trial, and what it belongs to: the revision of the text, the one line that is tried, and how much is tried.
pub(crate) struct Trying {
    pub(crate) of: (u64, Option<LineKey>, Effort),
    pub(crate) trial: Trial,
}

/// The most plans with other choices that are tried.
const MAX_PLANS: usize = 50;
/// The most alternatives that one search tries.
const MAX_ALTERNATIVES: u32 = 5_000;

/// Other plans of the mission: those of the search that it does not use, and one for each combination of choices.
pub(crate) fn other_plans(
    evaluated: &Evaluated,
    grounds: &mut Grounds,
    paths: &mut Paths,
) -> Vec<(Arc<Network>, Plan)> {
    let problem = evaluated.problem();
    let options = Options { explain: false, relax: false, all: false, best: 1, ..problem.options };
    let search = match options.search {
        Search::BestFirst => Search::ConflictDirected,
        Search::Chronological | Search::ConflictDirected => Search::BestFirst,
    };
    let mut found = Vec::new();
    let all = Options { all: true, max_plans: MAX_PLANS, ..options };
    for options in [Options { search, ..options }, all] {
        let mut left = MAX_ALTERNATIVES;
        let mut stop = || {
            left = left.saturating_sub(1);
            left == 0
        };
        let planned = planning::plan(&Problem { options, ..problem }, grounds, paths, &mut stop);
        let Planned { network, planning, others, .. } = planned;
        found.extend(planning.outcome.plans.iter().map(|plan| (Arc::clone(&network), plan.clone())));
        found.extend(others.into_iter().map(|listed| (listed.network, listed.plan)));
    }
    // Only plans that the checker accepts are counterexamples.
    found.retain(|(network, plan)| verify::check_plan(network, plan).valid);
    found
}

/// Whether a vehicle sees a location from where it is at a time of a run; `None` without a terrain.
pub(crate) fn sight(
    evaluated: &Evaluated,
    drives: &[SimulatedDrive],
    (vehicle, location): (&str, &str),
    at: Time,
) -> Option<Sight> {
    let world = &evaluated.compiled.program.world;
    world.terrain.as_ref()?;
    let (_, map) = evaluated.ground.as_ref()?;
    let index = world.vehicles.iter().position(|it| it.name.text == vehicle)?;
    let frames = drives.iter().rev().flat_map(|drive| &drive.vehicles);
    let mut frames = frames.filter(|it| it.vehicle as usize == index);
    let driven = frames.find_map(|it| it.at(at.to_f64()));
    let program = &evaluated.compiled.program;
    let start_m = || {
        let starts = snapshot::standing::starts(program, &evaluated.planned.network.occurrences);
        starts.get(index).copied().flatten().map(|start| start.place_m)
    };
    let place_m = driven.map(|frame| frame.position_m).or_else(start_m)?;
    let is_seen = Seeing::new(world, map).sees(vehicle, place_m, location)?;
    Some(Sight { is_seen, from_m: place_m.coords.into() })
}
