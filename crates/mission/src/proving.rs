//! Flight rules over every plan of a mission (SPEC 16.4): the network whose plans are all that may be plans, and the paths of
//! those that would break a rule.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use review::MissionRule;
use review::flight_rule::proof::{self, Effort, Mission, Proven, prove};
use snapshot::vehicle;
use tpn::{Network, Plan};

use crate::departures::Departures;
use crate::evaluated::Evaluated;
use crate::ground::Grounds;
use crate::listing;
use crate::planning;
use crate::traverse::{self, Paths};

/// Proves that a rule holds in every plan of a mission, or finds one that breaks it. The planner tries so many alternatives.
pub(crate) fn prove_rule(
    evaluated: &Evaluated,
    rule: &MissionRule,
    alternatives: u64,
    (grounds, paths): (&mut Grounds, &mut Paths),
    stop: &mut dyn FnMut() -> bool,
) -> Proven {
    let problem = evaluated.problem();
    let is_moving = |occurrence| vehicle::moving(problem.program, occurrence).is_some();
    let needs_paths = problem.ground.is_some() && problem.network.occurrences.iter().any(is_moving);
    // What is known of movements without paths bounds them from below, so that no plan that can be driven is missed.
    let mut follow_from_choices = true;
    let network: Cow<'_, Network> = if needs_paths {
        let mut network = problem.network.as_ref().clone();
        let departures = Departures::new(&problem, grounds);
        // The order of movements decides where vehicles come from, and which of two that meet stands where.
        follow_from_choices = !kirk::has_open_order(&network) && !departures.are_open();
        network.departures = departures.bounds();
        let network = Arc::new(network);
        let relaxed = planning::without_upper_limits(&network, &BTreeMap::new());
        Cow::Owned(Arc::unwrap_or_clone(relaxed.unwrap_or(network)))
    } else {
        Cow::Borrowed(problem.network)
    };
    let mut with_paths = |plan: &Plan| {
        let routes = traverse::routes(problem.network, problem.program, plan, &[]);
        let departures = Departures::new(&problem, grounds).only(&routes);
        let inserted = listing::inserted(&problem, (problem.network, plan), grounds, paths)?;
        Ok(Network { departures, ..planning::with_paths(&problem, &inserted) })
    };
    let planned = &evaluated.planned;
    let mission = Mission {
        program: problem.program,
        network: &network,
        plan: planned.planning.outcome.plans.first().map(|plan| (&*planned.network, plan)),
    };
    let paths = needs_paths.then_some(proof::Paths { find: &mut with_paths, follow_from_choices });
    prove(mission, rule, Effort { alternatives, stop, paths })
}
