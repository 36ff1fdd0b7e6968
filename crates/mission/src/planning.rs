//! Planning with paths: plan, find paths for the traverses that the plan selected, insert them, and plan again.
//!
//! Inserted paths only add constraints. So when every traverse of a plan has its paths, that plan is the first plan of
//! the network with all paths, though none were computed for alternatives that the search never selects (SPEC 7.3).

use snapshot::vehicle;
use std::borrow::Cow;
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use exact::{Bound, Rational, Time};
use executive::Facts;
use executive::facts::StandingPlace;
use kirk::{Options, Outcome, Stats, Status};
use motion::{Formation, HiddenRocks, SegmentTiming, SpeedLimits};
use rmpl::Diagnostic;
use rmpl::program::{self, Change, Measure, Program, World};
use snapshot::blocked::name_blocked;
use snapshot::standing;
use snapshot::standing::Start;
use snapshot::{
    Keyframe, Leg, MapKey, PathFigures, Planning, SeparationViolation, Traverse, Undrivable, VehicleMotion,
};
use terrain::{ConfigurationSpace, Terrain};
use tpn::path::{PathLeg, TraversePath};
use tpn::worth;
use tpn::worth::rounded_up;
use tpn::{ArcKind, Choice, Departure, Distance, Goal, LevelCondition, Network, OccurrenceId, Plan, Supply};

use crate::departures::{self, Departures};
use crate::driving::{self, Drive};
use crate::ground::{EndGround, FreeSpace, Grounds};
use crate::listing::{self, Listed};
use crate::meetings::{self, KeepOuts, best_plan};
use crate::programs::{self, Programs};
use crate::separation::{self, Meeting};
use crate::traverse::{self, Paths, Preference, Route};

/// What to plan and how.
#[derive(Clone, Copy)]
pub struct Problem<'input> {
    /// The network of the program, without paths.
    pub network: &'input Arc<Network>,
    /// The program, for its world.
    pub program: &'input Program,
    /// The ground, if the mission has one.
    pub ground: Option<(&'input MapKey, &'input Arc<Terrain>)>,
    /// How to search.
    pub options: Options,
    /// Seeds path planning.
    pub seed: u64,
    /// What has already happened, when planning again during execution.
    pub facts: Option<&'input Facts>,
    /// The control programs that its activities run; compiled where they are needed if they are not given.
    pub programs: Option<&'input Programs>,
    /// Places that its traverses are led around, because other vehicles are there then.
    pub keep_outs: Option<&'input KeepOuts>,
    /// The choices of plans that are not looked for, such as those that are listed already.
    pub excluded: &'input [Vec<Choice>],
    /// Once this is set nothing better is looked for any more: the search still finds a first plan, if that takes little,
    /// and gives the best one so far its paths.
    pub enough: Option<&'input Cell<bool>>,
}

impl<'input> Problem<'input> {
    /// The network of a program without ground, planned as it is usual and from its start.
    pub fn new(network: &'input Arc<Network>, program: &'input Program) -> Self {
        Self {
            network,
            program,
            ground: None,
            options: Options::default(),
            seed: 0,
            facts: None,
            programs: None,
            keep_outs: None,
            excluded: &[],
            enough: None,
        }
    }

    /// The control programs that its activities run.
    pub(crate) fn programs(&self) -> Cow<'input, Programs> {
        self.programs
            .map_or_else(|| Cow::Owned(Programs::compile(self.program, Some(self.network)).0), Cow::Borrowed)
    }

    fn has_enough(&self) -> bool {
        self.enough.is_some_and(Cell::get)
    }

    /// Searches a network that its own has become.
    fn searched(&self, network: &Network, options: &Options, stop: &mut dyn FnMut() -> bool) -> Outcome {
        kirk::plan_except(network, options, self.excluded, &mut self.patient(stop))
    }

    /// Stops a search when `stop` returns true, and a little later than there is enough.
    fn patient(&self, stop: &mut dyn FnMut() -> bool) -> impl FnMut(&Stats) -> bool {
        // Without an objective there is nothing better to look for, and no plan before the last.
        let is_over = self.network.objective.is_empty();
        let has_tried = move |stats: &Stats| {
            is_over || stats.conflicts >= MIN_CONFLICTS || stats.expanded >= MIN_DECISIONS
        };
        move |stats| stop() || self.has_enough() && has_tried(stats)
    }
}

/// What a search may still do once there is enough.
const MIN_CONFLICTS: u64 = 500;
const MIN_DECISIONS: u64 = 50_000;

/// A mission, planned.
#[derive(Clone, Debug)]
pub struct Planned {
    /// The network with the paths of the plan's traverses.
    pub network: Arc<Network>,
    /// What planning found.
    pub planning: Arc<Planning>,
    /// Other plans that were asked for, each with its own paths; of missions without ground these are in `planning`.
    pub others: Vec<Listed>,
    /// The plan's traverses.
    pub traverses: Vec<Traverse>,
    /// The meters that were counted when the plan was chosen, where the objective counts them.
    pub counted_m: f64,
    /// Where the vehicles of each traverse can be.
    pub spaces: Vec<(OccurrenceId, Arc<ConfigurationSpace>)>,
    /// Where vehicles are over time.
    pub motions: Vec<VehicleMotion>,
    /// Vehicles that can be too near each other, for each pair of what they drive.
    pub meetings: Vec<Meeting>,
    /// How near they come, for each pair of them.
    pub separation_violations: Vec<SeparationViolation>,
    /// What the author should know.
    pub warnings: Vec<Diagnostic>,
}

/// Rounds of planning and path finding; each adds the paths of at least one traverse or of a new start for one.
const MAX_ROUNDS: usize = 64;

/// A traverse as it is in the network: its route, and its legs, or why it can't be driven.
pub(crate) struct Inserted {
    pub(crate) legs: Result<Vec<Leg>, Undrivable>,
    pub(crate) route: Route,
    /// Where its vehicles can be, whatever else they are led around.
    pub(crate) space: Arc<ConfigurationSpace>,
}

impl Inserted {
    pub(crate) fn new(
        (key, map): (&MapKey, &Arc<Terrain>),
        grounds: &mut Grounds,
        route: Route,
        legs: Result<Vec<Leg>, Undrivable>,
    ) -> Self {
        let space = grounds.space(key, map, &route.model, route.obstacles.clone()).exact;
        Self { legs, route, space }
    }
}

/// Returns whether the paths of a route are known, from where it starts.
pub(crate) fn is_inserted(route: &Route, inserted: &BTreeMap<OccurrenceId, Inserted>) -> bool {
    inserted.get(&route.occurrence).is_some_and(|known| known.route.waypoints == route.waypoints)
}

/// The routes of a plan, whose vehicles start from where formations end whose paths are known.
pub(crate) fn routes(
    problem: &Problem<'_>,
    network: &Network,
    plan: &Plan,
    inserted: &BTreeMap<OccurrenceId, Inserted>,
) -> Vec<Route> {
    let world = &problem.program.world;
    let ends = |route: &Route| {
        let known = inserted.get(&route.occurrence).filter(|_| is_inserted(route, inserted));
        let Some(Inserted { legs: Ok(legs), space, .. }) = known else { return Vec::new() };
        let formation = Formation { spacing_m: spacing_m(world, &route.vehicles) };
        formation.end_m(space, &snapshot::joined(legs), route.vehicles.len() as u32 - 1)
    };
    traverse::routes_between(network, problem.program, plan, places(problem), &ends)
}

/// Plans `problem`. If `stop` returns true before there is an answer, the outcome's status is [`Status::Limit`].
pub fn plan(
    problem: &Problem<'_>,
    grounds: &mut Grounds,
    paths: &mut Paths,
    stop: &mut dyn FnMut() -> bool,
) -> Planned {
    if !listing::is_listing(problem) {
        return plan_first(problem, grounds, paths, stop);
    }
    let options = Options { all: false, best: 1, ..problem.options };
    let mut planned = plan_first(&Problem { options, ..*problem }, grounds, paths, stop);
    if has_plan(&planned.planning.outcome) {
        if problem.options.all {
            listing::add_plans(problem, &mut planned, grounds, paths, stop);
        } else {
            listing::add_best(problem, &mut planned, &mut |problem| {
                plan_first(problem, grounds, paths, stop)
            });
        }
    }
    planned
}

/// Plans `problem` with the paths of its first plan, whose vehicles keep apart as far as the mission's bounds allow.
fn plan_first(
    problem: &Problem<'_>,
    grounds: &mut Grounds,
    paths: &mut Paths,
    stop: &mut dyn FnMut() -> bool,
) -> Planned {
    let planned = plan_paths(problem, grounds, paths, stop);
    if planned.separation_violations.is_empty() || stop() {
        return planned;
    }
    meetings::kept_apart(problem, planned, &mut |problem| {
        if stop() { None } else { Some(plan_paths(problem, grounds, paths, stop)) }
    })
}

/// Plans `problem` with the paths of its first plan; others that are asked for have theirs only as far as they share them. Where
/// the first order of movements drives too many meters for some resource, the shortest one is tried.
fn plan_paths(
    problem: &Problem<'_>,
    grounds: &mut Grounds,
    paths: &mut Paths,
    stop: &mut dyn FnMut() -> bool,
) -> Planned {
    let planned = plan_order(problem, Starts::Fixed, grounds, paths, stop);
    if !is_by_departure(problem) || !takes_for_meters(problem.network) || stop() {
        return planned;
    }
    if let Some((plan, _)) = best_plan(&planned) {
        if plan.quality.is_optimal != Some(false) || problem.has_enough() {
            return planned;
        }
        let open = plan_order(problem, Starts::Open, grounds, paths, stop);
        let is_valid = open.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid);
        let is_better = best_plan(&open).is_some_and(|(other, _)| {
            is_valid && worth::compare(problem.network, other, plan) == std::cmp::Ordering::Less
        });
        return if is_better { open } else { planned };
    }
    if planned.planning.outcome.status != Status::NoPlan {
        return planned;
    }
    let mut network = problem.network.as_ref().clone();
    let length = Goal { is_maximized: false, terms: vec![(Rational::ONE, Measure::Length)], span: None };
    network.objective.insert(0, length);
    let options = Options { explain: false, relax: false, trace_events: None, ..problem.options };
    let of_shortest = Problem { network: &Arc::new(network), options, ..*problem };
    let mut shortest = plan_order(&of_shortest, Starts::Fixed, grounds, paths, stop);
    let planning = Arc::make_mut(&mut shortest.planning);
    let Some(plan) = planning.outcome.plans.first_mut() else { return planned };
    // It is the shortest one, and nothing is known of what the mission asks for.
    let network = Arc::make_mut(&mut shortest.network);
    network.objective.clone_from(&problem.network.objective);
    if !network.counts_meters() {
        network.distances.clear();
    }
    plan.quality.is_optimal = (!network.objective.is_empty()).then_some(false);
    planning.verdict = Some(verify::check_plan(network, plan));
    planning.outcome.bound = None;
    shortest
}

/// Returns whether planning finds where movements start, or meters count.
fn is_by_departure(problem: &Problem<'_>) -> bool {
    let is_open = kirk::has_open_order(problem.network) || problem.network.counts_meters();
    problem.ground.is_some() && is_open
}

/// Returns whether some movement takes of a resource for each meter.
fn takes_for_meters(network: &Network) -> bool {
    network.uses.iter().any(|used| used.change == Change::Consumes && used.per_meter.is_positive())
}

/// Where movements may start once an order of them is found.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Starts {
    /// Where they do in that order.
    Fixed,
    /// Wherever another plan starts them: what meters take of resources may leave no time or room for some of them.
    Open,
}

/// Plans `problem` with the paths of its first plan, beginning with the order of movements that is found without what their
/// meters take.
fn plan_order(
    problem: &Problem<'_>,
    starts: Starts,
    grounds: &mut Grounds,
    paths: &mut Paths,
    stop: &mut dyn FnMut() -> bool,
) -> Planned {
    let mut inserted: BTreeMap<OccurrenceId, Inserted> = BTreeMap::new();
    let (ordered, unordered) = (&mut None, problem);
    let mut departures = None;
    let is_by_departure = is_by_departure(problem);
    let (mut unproven, mut promised) = (None, None);
    let problem = if is_by_departure {
        match order_movements(problem, grounds, paths, stop) {
            Ok(mut order) => {
                if starts == Starts::Open {
                    order.network.departures = order.departures.bounds();
                }
                departures = Some(order.departures);
                unproven = order.unproven;
                promised = order.promised;
                &Problem { network: ordered.insert(Arc::new(order.network)), ..*problem }
            }
            Err(answer) => return conclude(problem, answer.network, answer.outcome, answer.tried),
        }
    } else {
        problem
    };
    let mut network = match problem.facts {
        Some(_) => Arc::new(with_paths(problem, &inserted)),
        None => Arc::clone(problem.network),
    };
    let mut outcome;
    let mut rounds = 0;
    // Once it is known which paths matter, resources without an upper limit have theirs again.
    let mut has_limits = false;
    loop {
        let without_limits =
            problem.ground.filter(|_| !has_limits).and_then(|_| without_upper_limits(&network, &inserted));
        let asked = without_limits.as_ref().unwrap_or(&network);
        outcome = problem.searched(asked, &problem.options, stop);
        rounds += 1;
        let (Some(ground), Some(found)) = (problem.ground, outcome.plans.first()) else { break };
        let is_new = rounds <= MAX_ROUNDS
            && find_paths(problem, ground, &network, found, grounds, paths, &mut inserted);
        if is_new {
            let mut described = with_paths(problem, &inserted);
            if let Some(departures) = &mut departures {
                let routes = routes(problem, &network, found, &inserted);
                learn_inserted(problem, departures, &inserted);
                described.departures = match starts {
                    Starts::Fixed => departures.only(&routes),
                    Starts::Open => departures.bounds(),
                };
            }
            network = Arc::new(described);
        } else if without_limits.is_some() {
            has_limits = true;
        } else {
            break;
        }
    }
    if let Some(Unproven { bound }) = unproven {
        match outcome.plans.first_mut() {
            // The best plan in this order of movements, but perhaps not in another one.
            Some(plan) if plan.quality.is_optimal.is_some() => {
                plan.quality.is_optimal = Some(false);
                outcome.bound = bound;
            }
            Some(_) => {}
            None => (outcome.status, outcome.failure) = (Status::Limit, None),
        }
    }
    if let Some(bounds) = promised.filter(|_| takes_for_meters(problem.network)) {
        // What meters take may allow more in another order.
        hold_against(problem, (&network, &mut outcome), &inserted, Some(bounds));
    }
    let is_said = |plan: &Plan| plan.quality.is_optimal == Some(true);
    let is_proof = match outcome.plans.first() {
        Some(plan) => is_said(plan),
        None => outcome.status == Status::NoPlan && !inserted.is_empty() && departures.is_none(),
    };
    if is_proof && problem.ground.is_some() {
        let departures = departures.get_or_insert_with(|| Departures::new(unordered, grounds));
        learn_inserted(unordered, departures, &inserted);
        if departures.are_open() && !departures.is_bounded_as_assumed() {
            let found = search_bounds(unordered, departures, &BTreeMap::new(), grounds, paths, stop);
            admit_other_spots(problem, (&network, &mut outcome), &inserted, found);
        }
    }
    if let Some(departures) = departures.filter(|_| is_by_departure && has_plan(&outcome)) {
        // What is asked of the plan from here on, such as what else could be, is not bound to its places.
        Arc::make_mut(&mut network).departures = departures.bounds();
    }
    conclude(problem, network, outcome, inserted)
}

/// Where the order of movements decides where vehicles stand, a plan is the best one, or there is none, only if that is so
/// wherever they stand. `found` is what a search with such bounds finds.
fn admit_other_spots(
    problem: &Problem<'_>,
    (network, outcome): (&Network, &mut Outcome),
    inserted: &BTreeMap<OccurrenceId, Inserted>,
    (_, asked, found): (Network, Arc<Network>, Outcome),
) {
    if outcome.plans.is_empty() && found.status != Status::NoPlan {
        (outcome.status, outcome.failure) = (Status::Limit, None);
    }
    if let Some(other) = found.plans.first() {
        hold_against(problem, (network, outcome), inserted, promised_values(problem, &asked, other));
    }
}

/// Returns what a plan promises for each goal by what is known of movements, if none is better.
fn promised_values(problem: &Problem<'_>, asked: &Network, plan: &Plan) -> Option<Vec<Rational>> {
    let routes = traverse::routes(asked, problem.program, plan, places(problem));
    let meters: f64 = routes.iter().map(|route| departures::counted_m(asked, route)).sum();
    worth::goal_values(asked, plan, meters).filter(|_| plan.quality.is_optimal == Some(true))
}

/// Calls a plan optimal only if it is as good as these bounds of its goals.
fn hold_against(
    problem: &Problem<'_>,
    (network, outcome): (&Network, &mut Outcome),
    inserted: &BTreeMap<OccurrenceId, Inserted>,
    bounds: Option<Vec<Rational>>,
) {
    let Some(plan) = outcome.plans.first_mut().filter(|plan| plan.quality.is_optimal == Some(true)) else {
        return;
    };
    let routes = traverse::routes(network, problem.program, plan, places(problem));
    let own_m: f64 = routes
        .iter()
        .filter_map(|route| inserted.get(&route.occurrence)?.legs.as_ref().ok())
        .map(|legs| snapshot::joined(legs).length_m())
        .sum();
    let values = worth::goal_values(network, plan, own_m);
    let Some((values, bounds)) = values.zip(bounds) else {
        plan.quality.is_optimal = Some(false);
        return;
    };
    let mut goals = network.objective.iter().zip(values.into_iter().zip(bounds));
    let differing = goals.find(|(goal, (value, bound))| !is_as_good(goal, *value, *bound, routes.len()));
    if let Some((_, (_, bound))) = differing {
        plan.quality.is_optimal = Some(false);
        outcome.bound = Some(bound);
    }
}

/// Returns whether a value of a goal is as good as its bound, in which what each of so many movements takes is rounded.
fn is_as_good(goal: &Goal, value: Rational, bound: Rational, movements: usize) -> bool {
    let factors: f64 = goal.terms.iter().map(|(factor, _)| factor.to_f64().abs()).sum();
    let rounding = factors * ROUNDING * (movements + 1) as f64;
    let lost = value.to_f64() - bound.to_f64();
    let lost = if goal.is_maximized { -lost } else { lost };
    lost <= rounding
}

/// Times and meters of bounds are rounded to multiples of this.
const ROUNDING: f64 = 0.001;

/// The network with reservoirs that never run over, where that may be due to meters that are not known yet: what a path takes
/// of a reservoir also makes room in it. `None` where all that matters is known.
pub(crate) fn without_upper_limits(
    network: &Arc<Network>,
    inserted: &BTreeMap<OccurrenceId, Inserted>,
) -> Option<Arc<Network>> {
    let is_open = |used: &tpn::Use| {
        used.change == Change::Consumes
            && used.per_meter.is_positive()
            && used.owner.is_some_and(|owner| !inserted.contains_key(&owner))
    };
    let mut relaxed: Option<Network> = None;
    for (index, resource) in network.resources.iter().enumerate() {
        let own = || network.uses.iter().filter(|used| used.resource.index() == index);
        let Supply::Reservoir { least, level, .. } = resource.supply else { continue };
        if !own().any(is_open) {
            continue;
        }
        let gains = own().filter(|used| used.change == Change::Produces).map(|used| used.amount);
        let highest = gains.into_iter().try_fold(level, Rational::checked_add);
        let is_limit = |used: &tpn::Use| used.level.is_some() && used.change == Change::Produces;
        let has_limits = own().any(is_limit);
        if let Some(greatest) = highest.filter(|&highest| highest > level || has_limits) {
            let relaxed = relaxed.get_or_insert_with(|| network.as_ref().clone());
            relaxed.resources[index].supply = Supply::Reservoir { least, greatest, level };
            for used in relaxed.uses.iter_mut().filter(|it| it.resource.index() == index && is_limit(it)) {
                used.level = Some(LevelCondition { order: program::Order::AtMost, bound: greatest });
            }
        }
    }
    relaxed.map(Arc::new)
}

/// The network in which movements start where they do in the best plan.
struct Order<'input> {
    network: Network,
    /// How long they take from every place that they may start from.
    departures: Departures<'input>,
    /// There, if the search for the best plan was stopped, or what it assumed does not hold wherever vehicles stand.
    unproven: Option<Unproven>,
    /// What its best plan comes to in each goal, before what meters take of resources.
    promised: Option<Vec<Rational>>,
}

/// That another order may be better, or the only one.
struct Unproven {
    /// What no plan is better than.
    bound: Option<Rational>,
}

/// How many legs that a plan does not have are looked at after the first one; after each plan it is twice as many.
const LEGS_AT_FIRST: usize = 8;
/// Searches with bounds that hold wherever vehicles stand, at most, and decisions of them all after which none follows.
const MAX_BOUND_SEARCHES: usize = 12;
const MAX_BOUND_DECISIONS: u64 = 50_000;

/// The result where movements fit in no order.
struct NoOrder {
    network: Arc<Network>,
    outcome: Outcome,
    tried: BTreeMap<OccurrenceId, Inserted>,
}

/// The network in which movements start where they do in the first plan whose paths are all known: each path that is found
/// tells how long its leg takes, and excludes the orders in which there is no time for it (SPEC 10.3). Of the legs that the
/// plan does not have, more and more of the shortest are looked at as well, so that the straight lines of those that are not
/// known do not promise plans for long.
fn order_movements<'input>(
    problem: &Problem<'input>,
    grounds: &mut Grounds,
    paths: &mut Paths,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Order<'input>, Box<NoOrder>> {
    let mut departures = Departures::new(problem, grounds);
    let (mut extra, mut promised) = (LEGS_AT_FIRST, None);
    let mut tried: BTreeMap<OccurrenceId, Inserted> = BTreeMap::new();
    loop {
        let distances = || departures.assumed_distances();
        let (mut network, mut asked) = asked(problem, departures.assumed(), distances, &tried);
        // Without a plan, the last round tells why.
        let is_assumed = !departures.is_bounded_as_assumed();
        let explain = problem.options.explain && !is_assumed;
        let options = Options { all: false, best: 1, explain, ..problem.options };
        let mut counting = None;
        if !problem.network.objective.is_empty() && takes_for_meters(problem.network) {
            // What movements take at least tells what is worth driving to; what is too much is explained with real meters.
            let mut counted = asked.as_ref().clone();
            count_min_meters(&mut counted, &departures);
            let quietly = Options { explain: false, ..options };
            let outcome = problem.searched(&Arc::new(counted), &quietly, stop);
            counting = (!outcome.plans.is_empty()).then_some(outcome);
        }
        let mut outcome = counting.unwrap_or_else(|| problem.searched(&asked, &options, stop));
        let is_refuted = is_assumed && outcome.status == Status::NoPlan;
        if is_refuted {
            // Elsewhere vehicles may have less to drive.
            (network, asked, outcome) = search_bounds(problem, &mut departures, &tried, grounds, paths, stop);
        }
        let (Some(ground), Some(plan)) = (problem.ground, outcome.plans.first()) else {
            return Err(Box::new(NoOrder { network: asked, outcome, tried }));
        };
        let routes = traverse::routes(&asked, problem.program, plan, places(problem));
        let (mut is_new, mut is_drivable) = (false, true);
        for route in &routes {
            if departures.knows(route) {
                continue;
            }
            is_new = true;
            let legs = learn_legs(problem, ground, &mut departures, grounds, paths, route);
            is_drivable &= legs.is_ok();
            if legs.is_err() {
                tried.insert(route.occurrence, Inserted::new(ground, grounds, route.clone(), legs));
            }
        }
        let is_optimal = plan.quality.is_optimal;
        // With straight lines for what is not known no plan is worse than it is.
        if is_optimal == Some(true) && !is_assumed && !asked.counts_meters() {
            let values = worth::goal_values(&asked, plan, 0.0);
            promised = values.and_then(|values| values.first().copied()).or(promised);
        }
        // A search that was stopped goes no further than the order of the best plan so far.
        let is_stopped = problem.has_enough() && is_drivable;
        if !is_new || is_stopped {
            network.departures = departures.only(&routes);
            network.distances = counted(problem, || departures.distances_of(&routes));
            // Where vehicles are that followed another one is known with the paths.
            let is_known = !is_new && !routes.iter().any(|route| route.has_followed);
            let is_proven = is_known && !is_refuted && is_optimal != Some(false);
            let bound = promised.or(outcome.bound).filter(|_| is_optimal.is_some() && !is_assumed);
            let promised = promised_values(problem, &asked, plan);
            let unproven = (!is_proven).then_some(Unproven { bound });
            return Ok(Order { network, departures, unproven, promised });
        }
        for route in departures.unknown(extra) {
            if stop() {
                break;
            }
            // Where none is found, the vehicles may stand at other spots in a plan: that asks by itself.
            if let Ok(legs) = legs(problem, ground, grounds, paths, &route) {
                learn(problem, &mut departures, &route, Some(&legs));
            }
        }
        extra *= 2;
    }
}

/// The network of a problem with what is known of its movements, and what a search is asked: the same as it is now, with
/// reservoirs that do not run over where that depends on unknown meters.
fn asked(
    problem: &Problem<'_>,
    departures: Vec<Departure>,
    distances: impl FnOnce() -> Vec<Distance>,
    tried: &BTreeMap<OccurrenceId, Inserted>,
) -> (Network, Arc<Network>) {
    let mut network = problem.network.as_ref().clone();
    network.departures = departures;
    network.distances = counted(problem, distances);
    let asked = match problem.facts {
        Some(facts) => facts.apply(&network, problem.network.nodes.len()),
        None => network.clone(),
    };
    let asked = Arc::new(asked);
    let asked = without_upper_limits(&asked, tried).unwrap_or(asked);
    (network, asked)
}

/// Searches with bounds that hold wherever vehicles stand. Each leg of a plan whose bound is that of a straight line is given
/// the bound of its path, until no plan has such a leg.
fn search_bounds(
    problem: &Problem<'_>,
    departures: &mut Departures<'_>,
    tried: &BTreeMap<OccurrenceId, Inserted>,
    grounds: &mut Grounds,
    paths: &mut Paths,
    stop: &mut dyn FnMut() -> bool,
) -> (Network, Arc<Network>, Outcome) {
    let options = Options { all: false, best: 1, ..problem.options };
    let mut num_decisions = 0;
    for round in 1.. {
        let distances = || departures.distance_bounds();
        let (network, mut asked) = asked(problem, departures.bounds(), distances, tried);
        count_min_meters(Arc::make_mut(&mut asked), departures);
        let outcome = problem.searched(&asked, &options, stop);
        num_decisions += outcome.stats.expanded;
        let is_last = round == MAX_BOUND_SEARCHES || num_decisions > MAX_BOUND_DECISIONS || stop();
        let (Some(ground), Some(plan), false) = (problem.ground, outcome.plans.first(), is_last) else {
            return (network, asked, outcome);
        };
        let routes = traverse::routes(&asked, problem.program, plan, places(problem));
        let shorter: Vec<Route> =
            routes.iter().filter_map(|route| departures.shortest_unknown(route)).collect();
        if shorter.is_empty() {
            return (network, asked, outcome);
        }
        for route in &shorter {
            let _ = learn_legs(problem, ground, departures, grounds, paths, route);
        }
    }
    unreachable!("the last round returns")
}

/// Looks for the legs of a route, and learns how long it takes.
fn learn_legs(
    problem: &Problem<'_>,
    ground: (&MapKey, &Arc<Terrain>),
    departures: &mut Departures<'_>,
    grounds: &mut Grounds,
    paths: &mut Paths,
    route: &Route,
) -> Result<Vec<Leg>, Undrivable> {
    let legs = legs(problem, ground, grounds, paths, route);
    learn(problem, departures, route, legs.as_ref().ok());
    legs
}

/// Learns how long the routes of the plan take that nothing is known of.
fn learn_inserted(
    problem: &Problem<'_>,
    departures: &mut Departures<'_>,
    inserted: &BTreeMap<OccurrenceId, Inserted>,
) {
    for Inserted { route, legs, .. } in inserted.values() {
        if !departures.knows(route) {
            learn(problem, departures, route, legs.as_ref().ok());
        }
    }
}

/// Learns how long a route takes with these legs, or that it cannot be driven.
fn learn(problem: &Problem<'_>, departures: &mut Departures<'_>, route: &Route, legs: Option<&Vec<Leg>>) {
    let least = legs.and_then(|legs| min_duration(problem, route, legs));
    let length_m = legs.map(|legs| snapshot::joined(legs).length_m());
    departures.learn(route, least, length_m.and_then(rounded_up));
}

/// Adds what movements take of resources for each meter, wherever their vehicles stand.
fn count_min_meters(network: &mut Network, departures: &Departures<'_>) {
    let least = departures.min_meters();
    for used in network.uses.iter_mut().filter(|used| used.change == Change::Consumes) {
        let meters = used.owner.and_then(|owner| least.get(&owner));
        let more = meters.and_then(|&meters| used.per_meter.checked_mul(meters));
        used.amount = more.and_then(|more| used.amount.checked_add(more)).unwrap_or(used.amount);
    }
}

/// The meters that movements drive, where the objective counts them.
fn counted(problem: &Problem<'_>, distances: impl FnOnce() -> Vec<Distance>) -> Vec<Distance> {
    if problem.network.counts_meters() { distances() } else { Vec::new() }
}

/// Returns where vehicles stand that have stopped on their way.
pub(crate) fn places<'input>(problem: &Problem<'input>) -> &'input [StandingPlace] {
    problem.facts.map_or(&[], |facts| &facts.places)
}

/// The least time that the legs of a route take; nothing where that does not fit, which its own bounds then decide.
pub(crate) fn min_duration(problem: &Problem<'_>, route: &Route, legs: &[Leg]) -> Option<Time> {
    let unit_seconds = problem.program.options.time_unit.seconds();
    let Some(path) = traverse_path(route, legs, problem.ground?.1) else { return Some(Time::ZERO) };
    let segments = tpn::path::segment_bounds(&path, unit_seconds).unwrap_or_default();
    Some(Time::checked_sum(segments.iter().map(|segment| segment.least)).unwrap_or_default())
}

/// A network that was planned as it is.
pub(crate) fn without_paths(network: &Arc<Network>, outcome: Outcome) -> Planned {
    let verdict = outcome.plans.first().map(|plan| verify::check_plan(network, plan));
    let planning = Arc::new(Planning {
        outcome,
        verdict,
        undrivable: Vec::new(),
        left_out: Vec::new(),
        repairs: Vec::new(),
    });
    Planned {
        network: Arc::clone(network),
        planning,
        others: Vec::new(),
        traverses: Vec::new(),
        counted_m: 0.0,
        spaces: Vec::new(),
        motions: Vec::new(),
        meetings: Vec::new(),
        separation_violations: Vec::new(),
        warnings: Vec::new(),
    }
}

/// Finds the paths that the plan needs and that are not in the network yet; whether there were any.
fn find_paths(
    problem: &Problem<'_>,
    ground: (&MapKey, &Arc<Terrain>),
    network: &Network,
    plan: &Plan,
    grounds: &mut Grounds,
    paths: &mut Paths,
    inserted: &mut BTreeMap<OccurrenceId, Inserted>,
) -> bool {
    let mut is_new = false;
    for route in routes(problem, network, plan, inserted) {
        if is_inserted(&route, inserted) {
            continue;
        }
        let legs = found_legs(problem, ground, grounds, paths, &route);
        is_new = true;
        inserted.insert(route.occurrence, Inserted::new(ground, grounds, route, legs));
    }
    is_new
}

/// The legs of a route: the roomy ones, or the shortest where there is no time for these.
fn found_legs(
    problem: &Problem<'_>,
    ground: (&MapKey, &Arc<Terrain>),
    grounds: &mut Grounds,
    paths: &mut Paths,
    route: &Route,
) -> Result<Vec<Leg>, Undrivable> {
    let space = space(problem, ground, grounds, route);
    let map = ground.1;
    let world = &problem.program.world;
    let standing = grounds.standing(ground, world, vehicle::flies(world, route.vehicles[0] as u32));
    let ends = EndGround { standing, space: Arc::clone(&space.exact) };
    let mut route = route.clone();
    for place in &mut route.waypoints {
        place.position_m = ends.free_m(place);
    }
    let route = &route;
    let mut legs = paths.legs(route, &space, problem.seed, Preference::Roomy);
    let does_not_fit = |legs: &Vec<Leg>| out_of_bounds(problem, route, legs, map).is_some();
    if legs.as_ref().is_ok_and(does_not_fit) {
        legs = paths.legs(route, &space, problem.seed, Preference::Shortest);
    }
    let legs = legs.map_err(|(leg, reason)| Undrivable { occurrence: route.occurrence, leg, reason })?;
    let unit_seconds = problem.program.options.time_unit.seconds();
    let path = traverse_path(route, &legs, map);
    match path.map(|path| tpn::path::segment_bounds(&path, unit_seconds)) {
        Some(Err(error)) => {
            Err(Undrivable { occurrence: route.occurrence, leg: 0, reason: format!("because {error}") })
        }
        _ => Ok(legs),
    }
}

/// Returns where the vehicles of a route can be.
pub(crate) fn space(
    problem: &Problem<'_>,
    (key, map): (&MapKey, &Arc<Terrain>),
    grounds: &mut Grounds,
    route: &Route,
) -> FreeSpace {
    let keep_outs = problem.keep_outs.and_then(|keep_outs| keep_outs.get(&route.occurrence));
    let obstacles = route.obstacles.iter().chain(keep_outs.into_iter().flatten()).cloned().collect();
    grounds.space(key, map, &route.model, obstacles)
}

/// The legs of a route that can be driven within its bounds.
pub(crate) fn legs(
    problem: &Problem<'_>,
    ground: (&MapKey, &Arc<Terrain>),
    grounds: &mut Grounds,
    paths: &mut Paths,
    route: &Route,
) -> Result<Vec<Leg>, Undrivable> {
    let legs = found_legs(problem, ground, grounds, paths, route)?;
    match out_of_bounds(problem, route, &legs, ground.1) {
        Some(undrivable) => Err(undrivable),
        None => Ok(legs),
    }
}

/// The program's network with the paths inserted, or blocked where a traverse can't be driven.
pub(crate) fn with_paths(problem: &Problem<'_>, inserted: &BTreeMap<OccurrenceId, Inserted>) -> Network {
    let map = problem.ground.map(|(_, map)| map);
    let unit_seconds = problem.program.options.time_unit.seconds();
    let mut network = problem.network.as_ref().clone();
    for (&occurrence, Inserted { route, legs, .. }) in inserted {
        let Ok(legs) = legs else {
            block(&mut network, occurrence);
            continue;
        };
        let path = map.and_then(|map| traverse_path(route, legs, map));
        let world = &problem.program.world;
        let rocks = map.map_or(HiddenRocks::None, |map| hidden_rocks(world, route, map));
        let outcome = path.map_or(Ok(()), |path| tpn::path::insert_path(&mut network, &path, unit_seconds));
        if outcome.is_err() {
            // Nothing is known of how long it takes.
            block(&mut network, occurrence);
            continue;
        }
        count_meters(&mut network, route, snapshot::joined(legs).length_m(), rocks);
    }
    match problem.facts {
        Some(facts) => facts.apply(&network, problem.network.nodes.len()),
        None => network,
    }
}

/// Adds what a traverse takes, gives and costs for each meter (SPEC 11, 12), rounded up: between what it drives at least along
/// its path and at most; costs are those of the path itself.
fn count_meters(network: &mut Network, route: &Route, length_m: f64, rocks: HiddenRocks) {
    let at_most_m = motion::driven_at_most_m(length_m, route.company, rocks);
    let (Some(meters), Some(at_most)) = (rounded_up(length_m), rounded_up(at_most_m)) else { return };
    let at_least = motion::min_driven_m(length_m, route.company, rocks);
    let at_least = rounded_up(at_least).unwrap_or_default();
    let with = |amount: Rational, per_meter: Rational, meters: Rational| {
        per_meter.checked_mul(meters).and_then(|more| amount.checked_add(more)).unwrap_or(amount)
    };
    for used in network.uses.iter_mut().filter(|used| used.owner == Some(route.occurrence)) {
        used.at_least = with(used.amount, used.per_meter, at_least);
        used.amount = with(used.amount, used.per_meter, at_most);
    }
    let arc = network.occurrences[route.occurrence.index()].arc;
    for worth in network.worths.iter_mut().filter(|worth| Some(worth.arc) == arc) {
        worth.cost = with(worth.cost, worth.cost_per_meter, meters);
    }
}

/// Returns how many rocks a route may meet that its map does not show. What flies is above them.
pub(crate) fn hidden_rocks(world: &World, route: &Route, map: &Terrain) -> HiddenRocks {
    let drives = route.vehicles.iter().any(|&vehicle| !vehicle::flies(world, vehicle as u32));
    if world.terrain.is_some() && drives { HiddenRocks::on(map) } else { HiddenRocks::None }
}

fn traverse_path(route: &Route, legs: &[Leg], map: &Terrain) -> Option<TraversePath> {
    let mut heading = None;
    let legs = legs.iter().map(|leg| {
        let timings = timings(route, leg, map, heading);
        heading = leg.heading_rad().or(heading);
        PathLeg {
            segment_lengths_m: timings.iter().map(|timing| timing.ground_length_m).collect(),
            slope_speeds_mps: timings.iter().map(|timing| timing.slope_speed_mps).collect(),
        }
    });
    let path = TraversePath {
        occurrence: route.occurrence,
        legs: legs.filter(|leg| !leg.segment_lengths_m.is_empty()).collect(),
        speed_mps: route.speed_mps,
        may_stop: route.speed_mps.0.is_zero(),
    };
    (!path.legs.is_empty()).then_some(path)
}

/// Returns what the segments of a leg take; `heading` is how the leader faces before it.
fn timings(route: &Route, leg: &Leg, map: &Terrain, heading: Option<f64>) -> Vec<SegmentTiming> {
    let [min_mps, max_mps] = [route.speed_mps.0, route.speed_mps.1].map(Rational::to_f64);
    let path = motion::Path::new(leg.points_m.clone());
    let speeds = SpeedLimits { min_mps, max_mps };
    match &route.limits {
        Some(limits) => motion::time_path_within(&path, map, &route.model, speeds, (limits, heading)),
        None => motion::time_path(&path, map, &route.model, speeds),
    }
}

/// Returns why a traverse can't be driven within its own bounds (SPEC 7.3), if so.
fn out_of_bounds(problem: &Problem<'_>, route: &Route, legs: &[Leg], map: &Terrain) -> Option<Undrivable> {
    let arc = problem.network.occurrences[route.occurrence.index()].arc?;
    let (lower, upper) = {
        let arc = &problem.network.arcs[arc.index()];
        (arc.lower, arc.upper)
    };
    let unit = problem.program.options.time_unit;
    let path = traverse_path(route, legs, map)?;
    let segments = tpn::path::segment_bounds(&path, unit.seconds()).ok()?;
    let least = Time::checked_sum(segments.iter().map(|segment| segment.least))?;
    let most = segments.iter().try_fold(Time::ZERO, |sum, it| sum.checked_add(it.greatest.finite()?));
    let length_m: f64 = path.legs.iter().flat_map(|leg| &leg.segment_lengths_m).sum();
    let shown = |time: Time| format!("{:.1}", time.to_f64());
    let reason = match (upper, most) {
        (Bound::Finite(upper), _) if least > upper => format!(
            "within its bounds: its path of {length_m:.0} m takes at least {}, but at most {} is allowed",
            shown(least),
            shown(upper)
        ),
        (_, Some(most)) if most < lower => format!(
            "within its bounds: its path of {length_m:.0} m takes at most {} without stopping, but must take at least {}",
            shown(most),
            shown(lower)
        ),
        _ => return None,
    };
    Some(Undrivable { occurrence: route.occurrence, leg: 0, reason })
}

/// Returns what the legs of a traverse come to.
fn figures(
    problem: &Problem<'_>,
    route: &Route,
    legs: &[Leg],
    map: &Terrain,
    space: &ConfigurationSpace,
) -> Vec<PathFigures> {
    let unit_seconds = problem.program.options.time_unit.seconds();
    let Some(path) = traverse_path(route, legs, map) else { return Vec::new() };
    let bounds = tpn::path::segment_bounds(&path, unit_seconds).unwrap_or_default();
    let of_leg = |(index, leg): (usize, &Leg)| {
        let own = || bounds.iter().filter(move |segment| segment.leg as usize == index + 1);
        let least = Time::checked_sum(own().map(|segment| segment.least));
        let greatest = own().try_fold(Time::ZERO, |sum, it| sum.checked_add(it.greatest.finite()?));
        PathFigures {
            length_m: path.legs.get(index).map_or(0.0, |leg| leg.segment_lengths_m.iter().sum()),
            min_clearance_m: traverse::clearance_m(space, &leg.points_m),
            max_slope_deg: map.steepest_slope_rad(&leg.points_m).to_degrees(),
            min_duration: least.unwrap_or_default(),
            max_duration: greatest.map_or(Bound::Infinite, Bound::Finite),
        }
    };
    legs.iter().enumerate().map(of_leg).collect()
}

/// Makes a traverse that can't be driven impossible: it would have to take no time and also one unit.
fn block(network: &mut Network, occurrence: OccurrenceId) {
    let (start, end, span) = {
        let traverse = &network.occurrences[occurrence.index()];
        (traverse.start, traverse.end, traverse.span)
    };
    for units in [0, 1] {
        let duration = Time::from(units);
        let arc = tpn::Arc::bare(start, end, (duration, Bound::Finite(duration)), ArcKind::Path);
        network.connect(tpn::Arc { occurrence: Some(occurrence), span, ..arc });
    }
}

pub(crate) fn conclude(
    problem: &Problem<'_>,
    mut network: Arc<Network>,
    mut outcome: Outcome,
    inserted: BTreeMap<OccurrenceId, Inserted>,
) -> Planned {
    let mut warnings = traverse::check(problem.network, problem.program);
    let mut traverses = Vec::new();
    let mut drives: Vec<Drive> = Vec::new();
    let mut spaces = Vec::new();
    let mut counted_m = 0.0;
    let world = &problem.program.world;
    if let (Some((_, map)), Some(plan)) = (problem.ground, outcome.plans.first()) {
        let routes = traverse::routes(&network, problem.program, plan, places(problem));
        if !network.distances.is_empty() {
            counted_m = routes.iter().map(|route| departures::counted_m(&network, route)).sum();
            let described = Arc::make_mut(&mut network);
            for route in &routes {
                if let Some(Inserted { legs: Ok(legs), .. }) = inserted.get(&route.occurrence) {
                    departures::record(described, route, snapshot::joined(legs).length_m());
                }
            }
        }
        for route in routes {
            let Some(known) = inserted.get(&route.occurrence) else { continue };
            let Inserted { legs: Ok(legs), space, .. } = known else { continue };
            let path = snapshot::joined(legs);
            let drive = drive(world, &network, plan, &route, path.clone(), space);
            let tracks = drive.as_ref().map_or_else(|| vec![path.clone()], driving::tracks_m);
            let clearances_m = tracks.iter().map(|it| traverse::clearance_m(space, &it.points_m));
            let slopes_rad = tracks.iter().map(|it| map.steepest_slope_rad(&it.points_m));
            let rocks = hidden_rocks(world, &route, map);
            traverses.push(Traverse {
                occurrence: route.occurrence,
                vehicles: route.vehicles.iter().map(|&vehicle| vehicle as u32).collect(),
                length_m: path.length_m(),
                clearance_m: clearances_m.fold(f64::INFINITY, f64::min),
                rocks,
                narrow_m: (rocks != HiddenRocks::None)
                    .then(|| tracks.iter().find_map(|track| motion::narrow_passage(space, track)))
                    .flatten(),
                slope_max_rad: slopes_rad.fold(0.0, f64::max),
                leg_figures: figures(problem, &route, legs, map, space),
                legs: legs.clone(),
                company: route.company as u32,
            });
            drives.extend(drive);
            spaces.push((route.occurrence, Arc::clone(space)));
        }
    }
    if let Some(plan) = outcome.plans.first_mut() {
        plan.quality.length_m = traverses.iter().fold(0.0, |sum, traverse| sum + traverse.length_m);
    }
    let verdict = outcome.plans.first().map(|plan| verify::check_plan(&network, plan));
    let tracks = driving::all_tracks(&drives);
    let starts = standing::starts(problem.program, &network.occurrences);
    let motions = with_parked(driving::motions(&drives, &tracks, &starts), &starts, problem);
    let plan = outcome.plans.first();
    let meetings =
        plan.map(|plan| separation::meetings((&drives, tracks), &motions, problem.program, &network, plan));
    let meetings = meetings.unwrap_or_default();
    let separation_violations = separation::violations(&meetings);
    warnings.extend(separation::warnings(&separation_violations, &drives, &network, problem.program));
    if let Some(plan) = outcome.plans.first() {
        warnings.extend(programs::overlaps(&problem.programs(), &network, plan));
    }
    for warning in &mut warnings {
        warning.message = network.readable(&warning.message);
    }
    let undrivable: Vec<Undrivable> = inserted
        .into_values()
        .filter_map(|traverse| match traverse.legs {
            Ok(legs) => out_of_bounds(problem, &traverse.route, &legs, problem.ground?.1),
            Err(undrivable) => Some(undrivable),
        })
        .collect();
    name_blocked(&mut outcome, &network, &undrivable);
    let planning =
        Arc::new(Planning { outcome, verdict, undrivable, left_out: Vec::new(), repairs: Vec::new() });
    let others = Vec::new();
    Planned {
        network,
        planning,
        others,
        traverses,
        counted_m,
        spaces,
        motions,
        meetings,
        separation_violations,
        warnings,
    }
}

/// Returns where the vehicles are that move, and where those stay that do not: others have to keep apart from these as
/// well.
fn with_parked(
    mut motions: Vec<VehicleMotion>,
    starts: &[Option<Start>],
    problem: &Problem<'_>,
) -> Vec<VehicleMotion> {
    if motions.is_empty() {
        return motions;
    }
    let moved = motions.iter().map(|motion| motion.vehicle);
    let elsewhere: BTreeSet<u32> = moved.chain(places(problem).iter().map(|it| it.vehicle)).collect();
    for (vehicle, start) in (0..).zip(starts) {
        let Some(start) = start.as_ref().filter(|_| !elsewhere.contains(&vehicle)) else { continue };
        let frame = Keyframe { time: Time::ZERO, position_m: start.place_m, heading_rad: 0.0 };
        motions.push(VehicleMotion { vehicle, keyframes: vec![frame] });
    }
    motions.sort_by_key(|motion| motion.vehicle);
    motions
}

/// Returns where the vehicles are over time when `plan` is driven along the traverses of `planned`.
pub fn motions_of(
    program: &Program,
    network: &Network,
    plan: &Plan,
    planned: &Planned,
) -> Vec<VehicleMotion> {
    let routes = traverse::routes(network, program, plan, &[]);
    let drives: Vec<Drive> = routes
        .iter()
        .filter_map(|route| {
            let is_its = |traverse: &&Traverse| traverse.occurrence == route.occurrence;
            let traverse = planned.traverses.iter().find(is_its)?;
            let (_, space) = planned.spaces.iter().find(|(occurrence, _)| *occurrence == route.occurrence)?;
            drive(&program.world, network, plan, route, snapshot::joined(&traverse.legs), space)
        })
        .collect();
    let starts = standing::starts(program, &network.occurrences);
    driving::motions(&drives, &driving::all_tracks(&drives), &starts)
}

/// Room between the centers of vehicles that drive together, in meters.
pub(crate) fn spacing_m(world: &World, vehicles: &[usize]) -> f64 {
    let radii = |vehicle: &usize| vehicle::radius_m(world, *vehicle as u32);
    let mut widest: Vec<f64> = vehicles.iter().map(radii).collect();
    widest.sort_by(f64::total_cmp);
    widest.iter().rev().take(2).sum::<f64>() + vehicle::GAP_M
}

pub(crate) fn drive(
    world: &World,
    network: &Network,
    plan: &Plan,
    route: &Route,
    path: motion::Path,
    space: &Arc<ConfigurationSpace>,
) -> Option<Drive> {
    let occurrence = &network.occurrences[route.occurrence.index()];
    Some(Drive {
        occurrence: route.occurrence,
        vehicles: route.vehicles.iter().map(|&vehicle| vehicle as u32).collect(),
        spacing_m: spacing_m(world, &route.vehicles),
        space: Arc::clone(space),
        path,
        start: plan.windows[occurrence.start.index()]?.earliest,
        end: plan.windows[occurrence.end.index()]?.earliest,
    })
}

/// The latest time anything of the plan can happen, as far as it is bounded, for time axes.
pub fn horizon(plan: &Plan) -> Time {
    plan.windows
        .iter()
        .flatten()
        .map(|window| match window.latest {
            Bound::Finite(latest) => latest,
            Bound::Infinite => window.earliest,
        })
        .max()
        .unwrap_or_default()
}

/// Returns whether an outcome has a plan.
pub fn has_plan(outcome: &Outcome) -> bool {
    outcome.status == Status::Plan && !outcome.plans.is_empty()
}
