//! Several plans with their paths (SPEC 10.3, 12): each plan that is listed is planned again with the paths of its own
//! traverses, which start where its movements do, and left out if it cannot be driven.
//!
//! The plans are found with what is known of movements without paths, as lower bounds: no plan that can be driven is missed.
//! Plans with the same choices and the same ways share one planning again.

use snapshot::vehicle;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use kirk::{Options, Stats, Status};
use smol_str::SmolStr;
use snapshot::LeftOut;
use tpn::exchange::{Distinction, Exchanges};
use tpn::worth;
use tpn::{Choice, Network, OccurrenceId, Plan};

use crate::departures::Departures;
use crate::ground::Grounds;
use crate::planning::{self, Inserted, Planned, Problem};
use crate::traverse::{self, Paths, Route};

/// A plan beside the first one, with its own paths.
#[derive(Clone, Debug)]
pub struct Listed {
    /// The network with the paths of its traverses, and with its choices alone.
    pub network: Arc<Network>,
    pub plan: Plan,
}

/// Ways to drive that are looked at, at most: each combination of choices and ways of all its traverses is one.
const MAX_WAYS: usize = 64;

/// Returns whether the plans that `problem` asks for are listed here: those of missions that move vehicles over ground.
pub(crate) fn is_listing(problem: &Problem<'_>) -> bool {
    let options = &problem.options;
    let is_moving = |occurrence| vehicle::moving(problem.program, occurrence).is_some();
    (options.all || options.best > 1)
        && problem.ground.is_some()
        && problem.facts.is_none()
        && problem.network.occurrences.iter().any(is_moving)
}

/// Adds to `planned`, which has the first plan, all others.
pub(crate) fn add_plans(
    problem: &Problem<'_>,
    planned: &mut Planned,
    grounds: &mut Grounds,
    paths: &mut Paths,
    stop: &mut dyn FnMut() -> bool,
) {
    let mut network = problem.network.as_ref().clone();
    let departures = Departures::new(problem, grounds);
    network.departures = departures.bounds();
    if problem.network.counts_meters() {
        network.distances = departures.distance_bounds();
    }
    let network = Arc::new(network);
    let inserted = BTreeMap::new();
    let relaxed = planning::without_upper_limits(&network, &inserted).unwrap_or_else(|| Arc::clone(&network));
    let found = kirk::plan(&relaxed, &problem.options, &mut |_: &Stats| stop());
    let mut listing = Listing {
        problem,
        ways: BTreeMap::new(),
        is_cut: found.status == Status::Limit,
        left_out: Vec::new(),
    };
    let exchanges = Exchanges::new(&relaxed);
    let first = planned.planning.outcome.plans.first();
    let mut known: BTreeSet<Distinction> = first.iter().map(|plan| exchanges.least(plan)).collect();
    let mut listed: Vec<Listed> = Vec::new();
    for plan in &found.plans {
        if stop() {
            listing.is_cut = true;
            break;
        }
        if !known.insert(exchanges.least(plan)) {
            continue;
        }
        match listing.driven(plan, grounds, paths, stop) {
            Some(Ok(found)) => listed.push(found),
            Some(Err(reason)) => listing.left_out.push(LeftOut { choices: plan.choices.clone(), reason }),
            None => listing.is_cut = true,
        }
    }
    let planning = Arc::make_mut(&mut planned.planning);
    planned.others = listed;
    planning.left_out = listing.left_out;
    if listing.is_cut && planning.outcome.status == Status::Plan {
        planning.outcome.status = Status::Limit;
    }
}

/// Adds to `planned`, which has the best plan, the next best ones that `problem` asks for: each is the best of those whose choices
/// are not listed yet, as `plan` finds it with its own paths.
pub(crate) fn add_best(
    problem: &Problem<'_>,
    planned: &mut Planned,
    plan: &mut dyn FnMut(&Problem<'_>) -> Planned,
) {
    let options = Options { best: 1, explain: false, relax: false, trace_events: None, ..problem.options };
    let mut excluded: Vec<Vec<Choice>> = problem.excluded.to_vec();
    excluded.extend(planned.planning.outcome.plans.first().map(|plan| plan.choices.clone()));
    // A plan without choices is the only one.
    while planned.others.len() + 1 < problem.options.best
        && excluded.last().is_some_and(|last| !last.is_empty())
    {
        let mut next = plan(&Problem { options, excluded: &excluded, ..*problem });
        let planning = Arc::make_mut(&mut next.planning);
        let Some(plan) = planning.outcome.plans.pop() else {
            if planning.outcome.status == Status::Limit {
                Arc::make_mut(&mut planned.planning).outcome.status = Status::Limit;
            }
            break;
        };
        excluded.push(plan.choices.clone());
        planned.others.push(Listed { network: next.network, plan });
    }
    // Where vehicles must keep apart a plan is worth less than it was chosen for.
    planned.others.sort_by(|one, other| worth::compare(problem.network, &one.plan, &other.plan));
}

/// What tells ways to drive from each other: the choices, and the places that each traverse passes.
type Way = (Vec<Choice>, Vec<(OccurrenceId, Vec<SmolStr>)>);

/// A network with the paths of one way, and its plans.
type OfWay = (Arc<Network>, Vec<Plan>);

struct Listing<'run, 'input> {
    problem: &'run Problem<'input>,
    /// The plans of each way with its paths, or why it cannot be driven.
    ways: BTreeMap<Way, Result<OfWay, String>>,
    is_cut: bool,
    left_out: Vec<LeftOut>,
}

impl Listing<'_, '_> {
    /// A plan with the paths of its traverses; why there is none. `None` if that was not looked at.
    fn driven(
        &mut self,
        plan: &Plan,
        grounds: &mut Grounds,
        paths: &mut Paths,
        stop: &mut dyn FnMut() -> bool,
    ) -> Option<Result<Listed, String>> {
        let routes = traverse::routes(self.problem.network, self.problem.program, plan, &[]);
        let places = |route: &Route| {
            let names = route.waypoints.iter().map(|place| place.name.clone()).collect();
            (route.occurrence, names)
        };
        let mut of_routes: Vec<_> = routes.iter().map(places).collect();
        of_routes.sort();
        let way = (plan.choices.clone(), of_routes);
        if !self.ways.contains_key(&way) {
            if self.ways.len() >= MAX_WAYS {
                return None;
            }
            let plans = self.plans_of_way(plan, &routes, grounds, paths, stop);
            self.ways.insert(way.clone(), plans);
        }
        Some(match self.ways.get(&way)? {
            Ok((network, plans)) => {
                let same = plans.iter().find(|known| known.is_same(plan));
                let listed = |plan: &Plan| Listed { network: Arc::clone(network), plan: plan.clone() };
                same.map(listed).ok_or_else(|| "its drives take too long in this order".to_owned())
            }
            Err(reason) => Err(reason.clone()),
        })
    }

    /// All plans with the choices of `plan` and paths along its routes.
    fn plans_of_way(
        &self,
        plan: &Plan,
        routes: &[Route],
        grounds: &mut Grounds,
        paths: &mut Paths,
        stop: &mut dyn FnMut() -> bool,
    ) -> Result<OfWay, String> {
        let mut network = self.problem.network.with_choices(plan.choices.iter().copied());
        network.departures = Departures::new(self.problem, grounds).only(routes);
        let network = Arc::new(network);
        let problem = Problem { network: &network, ..*self.problem };
        let inserted = inserted(&problem, (&network, plan), grounds, paths)?;
        let with_paths = Arc::new(planning::with_paths(&problem, &inserted));
        let options =
            Options { explain: false, relax: false, trace_events: None, best: 1, ..problem.options };
        let outcome = kirk::plan(&with_paths, &options, &mut |_: &Stats| stop());
        if outcome.plans.is_empty() {
            return Err(no_time(&problem, &inserted));
        }
        let length_m = inserted
            .values()
            .filter_map(|it| Some(snapshot::joined(it.legs.as_ref().ok()?).length_m()))
            .sum();
        let is_valid = |plan: &Plan| {
            let own = planning::routes(&problem, &with_paths, plan, &inserted);
            own.iter().all(|route| planning::is_inserted(route, &inserted))
                && verify::check_plan(&with_paths, plan).valid
        };
        let mut plans: Vec<Plan> = outcome.plans.into_iter().filter(is_valid).collect();
        for plan in &mut plans {
            plan.quality.length_m = length_m;
        }
        Ok((with_paths, plans))
    }
}

/// That there is no time for some drives, and how much each of them takes.
fn no_time(problem: &Problem<'_>, inserted: &BTreeMap<OccurrenceId, Inserted>) -> String {
    let least = |it: &Inserted| {
        let least = planning::min_duration(problem, &it.route, it.legs.as_ref().ok()?)?;
        let name = &problem.network.occurrences[it.route.occurrence.index()].name;
        Some(format!("{name} takes at least {:.1}", least.to_f64()))
    };
    let drives: Vec<String> = inserted.values().filter_map(least).collect();
    format!("no plan with the paths of its drives: {}", drives.join(", "))
}

/// The network of `problem` with the paths of a plan's traverses; why there is none.
pub(crate) fn network_of(
    problem: &Problem<'_>,
    plan: &Plan,
    grounds: &mut Grounds,
    paths: &mut Paths,
) -> Result<Network, String> {
    let inserted = inserted(problem, (problem.network, plan), grounds, paths)?;
    Ok(planning::with_paths(problem, &inserted))
}

/// The paths of a plan of some network; why there are none. A route may start where an earlier one leaves its formation.
pub(crate) fn inserted(
    problem: &Problem<'_>,
    (network, plan): (&Network, &Plan),
    grounds: &mut Grounds,
    paths: &mut Paths,
) -> Result<BTreeMap<OccurrenceId, Inserted>, String> {
    let mut inserted = BTreeMap::new();
    let Some(ground) = problem.ground else { return Ok(inserted) };
    for mut route in planning::routes(problem, network, plan, &inserted) {
        if route.has_followed {
            // Where it starts is known now that the paths before it are.
            let routes = planning::routes(problem, network, plan, &inserted);
            route = routes.into_iter().find(|it| it.occurrence == route.occurrence).unwrap_or(route);
        }
        let legs = planning::legs(problem, ground, grounds, paths, &route).map_err(|undrivable| {
            let name = &problem.network.occurrences[route.occurrence.index()].name;
            format!("{name} can't be driven {}", undrivable.reason)
        })?;
        inserted.insert(route.occurrence, Inserted::new(ground, grounds, route, Ok(legs)));
    }
    Ok(inserted)
}
