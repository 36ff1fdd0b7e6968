//! The lines about a plan: its choices, links, conflicts, events and traverses.

use std::collections::BTreeSet;

use exact::{Bound, Time};
use motion::DriveLimits;
use rmpl::Span;
use rmpl::program::{Change, LabelMode, LocationDecl, VehicleDecl, World};
use snapshot::vehicle::{is_way, model_of, moving};
use snapshot::{Planning, Snapshot, joined, standing};
use tpn::{EventEnd, Extent, LabelId, Network, NodeId, OccurrenceId, OccurrenceKind, Plan};

use super::alternatives::{Alternative, Examiner};
use super::demand_lines::{DemandLines, status_by_checker};
use super::distances::Distances;
use super::late_drives::driven_within_s;
use super::lines::{Places, unit};
use super::overlaps::overlaps;
use super::schedule::slack;
use super::{
    ChoiceReview, ConflictReview, EventReview, Fate, Line, LinkReview, Status, TimeRange, TraverseReview,
};

/// How the line of a drive ends for which the plan may not leave enough time.
pub(super) const LATE: &str = "may make the plan late";

/// How the line of a drive ends that other vehicles may hold up.
const IN_THE_WAY: &str = "may be in its way";

/// What lines say of drives that may have to take another path, which may be longer than plans count.
pub(super) const CLOSED: &str = "rocks that the map does not show could close its path";

/// A vehicle that is not where the leader of its formation is when both are to set out.
struct Scattered<'a> {
    leader: &'a str,
    from: String,
    other: &'a str,
    there: String,
}

/// What the lines about a plan are made from.
pub(super) struct PlanLines<'input> {
    snapshot: &'input Snapshot,
    network: &'input Network,
    planning: &'input Planning,
    plan: &'input Plan,
    distances: Distances,
    /// The drives for which the plan may not leave enough time.
    late: &'input BTreeSet<OccurrenceId>,
    places: &'input Places<'input>,
    /// How everything stands that the checker examines.
    checked: Status,
}

impl<'input> PlanLines<'input> {
    /// `None` without a plan.
    pub(super) fn new(
        snapshot: &'input Snapshot,
        late: &'input BTreeSet<OccurrenceId>,
        places: &'input Places<'input>,
    ) -> Option<Self> {
        let network = snapshot.network.as_deref()?;
        let planning = snapshot.planning.as_deref()?;
        let plan = planning.outcome.plans.first()?;
        let distances = Distances::new(network, plan)?;
        let checked = status_by_checker(planning);
        Some(Self { snapshot, network, planning, plan, distances, late, places, checked })
    }

    /// The lines about what lasts and what is limited.
    pub(super) fn demands(&self) -> DemandLines<'input> {
        let Self { snapshot, network, plan, places, checked: status, .. } = *self;
        DemandLines { network, plan, traverses: &snapshot.traverses, places, status }
    }

    pub(super) fn choices(&mut self, stop: &mut dyn FnMut() -> bool) -> Vec<ChoiceReview> {
        let mut examiner =
            Examiner::new(self.network, self.plan, &self.planning.undrivable, &self.snapshot.source);
        let review = |&choice: &tpn::Choice| {
            let name = Network::decision_name(choice.decision);
            let decision = &self.network.decisions[choice.decision.index()];
            let alternatives = examiner.alternatives(choice, stop);
            let is_open = alternatives.iter().any(|it| it.fate == Fate::NotExamined);
            let status = if is_open { Status::Attention } else { Status::Passed };
            let text = choice_text(&name, &alternatives);
            let nodes = vec![decision.node];
            let line = self.places.line(status, text, decision.span, vec![name.clone()], nodes);
            ChoiceReview { line, name, alternatives }
        };
        self.plan.choices.iter().map(review).collect()
    }

    pub(super) fn causal_links(&mut self) -> Vec<LinkReview> {
        let links = &self.plan.causal_links;
        let pairs: Vec<(NodeId, NodeId)> = links
            .iter()
            .flat_map(|link| {
                let ((ask_start, ask_end), (tell_start, tell_end)) =
                    (self.network.interval(link.ask), self.network.interval(link.tell));
                if self.network.is_lasting(link.ask) {
                    // What lasts holds until the next change.
                    let until = self.next_change(link.tell).map_or(self.network.end, |(start, _)| start);
                    return [(self.network.ready(link.tell), ask_start), (ask_end, until)];
                }
                [(tell_start, ask_start), (ask_end, tell_end)]
            })
            .collect();
        let ranges = self.distances.between(&pairs);
        let review = |(link, ranges): (&tpn::CausalLink, &[Option<TimeRange>])| {
            let [lead, margin] = *ranges else { return None };
            let (lead, margin) = (lead?, margin?);
            let (ask, tell) = (self.network.label_name(link.ask), self.network.label_name(link.tell));
            let (status, text) = if self.network.is_lasting(link.ask) {
                let text = self.lasting_link_text(*link, lead, margin);
                (self.checked, text)
            } else {
                let text = format!(
                    "{} supports {} and outlasts it by {}",
                    interval_text(&tell),
                    interval_text(&ask),
                    self.range_text(margin)
                );
                (self.checked, text)
            };
            let is_lasting = self.network.is_lasting(link.ask);
            let (start, end) = self.network.interval(link.ask);
            let names = vec![ask.clone(), tell.clone()];
            let line = self.places.line(status, text, self.label_span(link.ask), names, vec![start, end]);
            Some(LinkReview { line, ask, tell, lead, margin, is_lasting })
        };
        links.iter().zip(ranges.chunks(2)).filter_map(review).collect()
    }

    /// Returns who makes a state what someone needs, how long before, and who changes it after.
    fn lasting_link_text(&self, link: tpn::CausalLink, lead: TimeRange, margin: TimeRange) -> String {
        let owner_of = |label: LabelId| {
            let owner = self.network.labels[label.index()].owner?;
            Some(self.network.occurrences.get(owner.index())?.name.as_str())
        };
        let told = &self.network.labels[link.tell.index()];
        let (value, lead) = (&told.text, self.range_text(lead));
        let needs = owner_of(link.ask).unwrap_or("the mission");
        let before = match (told.extent, owner_of(link.tell)) {
            (Extent::Effect, Some(owner)) => format!("{owner} sets {value} {lead} before {needs} needs it"),
            (Extent::Initial, _) | (_, None) => {
                format!("{value} holds from the start, {lead} before {needs} needs it")
            }
            (_, Some(owner)) => format!("{owner} makes {value} hold {lead} before {needs} needs it"),
        };
        let after = match self.next_change(link.tell).map(|(_, next)| owner_of(next)) {
            None => "nothing changes it later".to_owned(),
            Some(next) if next == Some(needs) => format!("{needs} itself changes it then"),
            Some(next) => {
                let margin = self.range_text(margin);
                format!("{} changes it {margin} after that", next.unwrap_or("the mission"))
            }
        };
        let is_from_plant = self.network.variables[told.literal.variable.index()].component().is_some();
        let unless = if is_from_plant { ", as long as no component fails" } else { "" };
        format!("{before}; {after}{unless}")
    }

    pub(super) fn conflicts(&mut self) -> Vec<ConflictReview> {
        let mut conflicts = self.ordered_labels();
        conflicts.extend(self.ordered_uses());
        conflicts
    }

    fn ordered_labels(&mut self) -> Vec<ConflictReview> {
        let (plan, network) = (self.plan, self.network);
        let orders = plan.telling_order(network);
        let added: BTreeSet<&tpn::Ordering> = plan.orderings_added.iter().collect();
        let pairs: Vec<(NodeId, NodeId)> = orders
            .iter()
            .map(|order| (network.interval(order.first).1, network.interval(order.then).0))
            .collect();
        let gaps = self.distances.between(&pairs);
        let review =
            |((order, gap), (end, start)): ((&tpn::Ordering, &Option<TimeRange>), &(NodeId, NodeId))| {
                let gap = (*gap)?;
                let (first, then) = (network.label_name(order.first), network.label_name(order.then));
                let is_added = added.contains(order);
                let by = if is_added {
                    "the planner chose this order"
                } else {
                    "the mission's bounds imply this order"
                };
                let text = format!(
                    "{} ends {} before {} starts; {by}",
                    interval_text(&first),
                    self.range_text(gap),
                    interval_text(&then)
                );
                let names = vec![first.clone(), then.clone()];
                let span = self.label_span(order.first);
                let line = self.places.line(self.checked, text, span, names, vec![*end, *start]);
                Some(ConflictReview { line, first, then, gap, is_added, is_of_uses: false })
            };
        orders.iter().zip(&gaps).zip(&pairs).filter_map(review).collect()
    }

    /// The uses of resources that planning had to put in order, the parts of `unordered` blocks among them.
    fn ordered_uses(&mut self) -> Vec<ConflictReview> {
        let (plan, network) = (self.plan, self.network);
        let event = |used: tpn::UseId, is_first: bool| {
            let used = &network.uses[used.index()];
            match (used.change, is_first) {
                (Change::Uses, true) => used.end,
                (Change::Uses, false) => used.start,
                (Change::Consumes | Change::Produces, true) => used.last_moment(),
                (Change::Consumes | Change::Produces, false) => used.moment(),
            }
        };
        let pairs: Vec<(NodeId, NodeId)> = plan
            .uses_ordered
            .iter()
            .map(|order| (event(order.first, true), event(order.then, false)))
            .collect();
        let gaps = self.distances.between(&pairs);
        let review =
            |((order, gap), (end, start)): ((&tpn::UseOrdering, &Option<TimeRange>), &(NodeId, NodeId))| {
                let gap = (*gap)?;
                let (first, then) = (network.use_name(order.first), network.use_name(order.then));
                let used = &network.uses[order.first.index()];
                let resource = &network.resources[used.resource.index()];
                let why = if is_way(resource) {
                    "so that they do not collide".to_owned()
                } else if resource.name.contains('#') {
                    "as parts of one `unordered`".to_owned()
                } else {
                    format!("because of {}", resource.name)
                };
                let owner = |used: tpn::UseId| {
                    let owner = network.uses[used.index()].owner?;
                    Some(network.occurrences.get(owner.index())?.name.to_string())
                };
                let (earlier, later) = (
                    owner(order.first).unwrap_or_else(|| first.clone()),
                    owner(order.then).unwrap_or_else(|| then.clone()),
                );
                let text = format!(
                    "{earlier} comes {} before {later}; the planner chose this order {why}",
                    self.range_text(gap)
                );
                let line =
                    self.places.line(self.checked, text, used.span, vec![earlier, later], vec![*end, *start]);
                Some(ConflictReview { line, first, then, gap, is_added: true, is_of_uses: true })
            };
        plan.uses_ordered.iter().zip(&gaps).zip(&pairs).filter_map(review).collect()
    }

    /// The first change of a variable that comes after `label`, and when it begins.
    fn next_change(&self, label: LabelId) -> Option<(NodeId, LabelId)> {
        let earliest = |node: NodeId| {
            self.plan.windows.get(node.index()).copied().flatten().map(|window| window.earliest)
        };
        let is_told = |other: LabelId| self.network.labels[other.index()].mode == LabelMode::Tell;
        let pairs =
            self.plan.conflict_order.iter().filter(|order| order.first == label && is_told(order.then));
        let orders = self.plan.state_order.iter();
        let changes =
            orders.flat_map(|order| order.producers.iter().skip_while(|it| **it != label).skip(1).copied());
        let changes = changes.filter(|&change| self.network.conflict(label, change)).take(1);
        let after = pairs.map(|order| order.then).chain(changes);
        let after = after.map(|then| (self.network.interval(then).0, then));
        after.min_by_key(|&(start, then)| (earliest(start), earliest(self.network.ready(then))))
    }

    /// Returns what each vehicle may do at the same time.
    pub(super) fn overlaps(&mut self) -> Vec<Line> {
        let planned = (self.network, self.plan);
        overlaps(self.snapshot, planned, &mut self.distances, self.places, self.checked)
    }

    /// The activities of which the plan can use only a part of what is declared.
    pub(super) fn durations(&mut self) -> Vec<Line> {
        let network = self.network;
        let declared = declared_durations(network, self.plan);
        let pairs: Vec<(NodeId, NodeId)> = declared.iter().map(|(it, ..)| (it.start, it.end)).collect();
        let used = self.distances.between(&pairs);
        let line =
            |(&(occurrence, lower, upper), used): (&(&tpn::Occurrence, Time, Bound), &Option<TimeRange>)| {
                let used = (*used)?;
                let (is_later, is_earlier) = (used.least > lower, used.greatest < upper);
                if !is_later && !is_earlier {
                    return None;
                }
                let name = occurrence.name.to_string();
                let declared = match upper {
                    Bound::Finite(upper) => format!("[{},{}]", lower.readable(), upper.readable()),
                    Bound::Infinite => format!("{} or longer", lower.readable()),
                };
                let text = format!(
                    "{name} is declared with {declared}, but the plan is valid only if it takes {}",
                    self.range_text(used)
                );
                let nodes = vec![occurrence.start, occurrence.end];
                // An activity that is early can wait; one that is late breaks the plan. Without a declared maximum, the plan
                // takes nothing away.
                let is_cut = is_earlier && upper != Bound::Infinite;
                let status = if is_cut { Status::Attention } else { Status::Information };
                Some(self.places.line(status, text, occurrence.span, vec![name], nodes))
            };
        declared.iter().zip(&used).filter_map(line).collect()
    }

    pub(super) fn events(&self) -> Vec<EventReview> {
        let mut events: Vec<(bool, EventReview)> = Vec::new();
        for (index, node) in self.network.nodes.iter().enumerate() {
            let Some(window) = self.plan.windows.get(index).copied().flatten() else { continue };
            for &event in &node.events {
                let name = self.network.event_name(event);
                let earliest = window.earliest.readable();
                let text = match window.latest {
                    Bound::Infinite => format!("{name} may happen at {earliest} or later"),
                    Bound::Finite(latest) if latest == window.earliest => {
                        format!("{name} happens at {earliest}, with no slack")
                    }
                    latest @ Bound::Finite(_) => {
                        format!("{name} may happen from {earliest} to {}", latest.readable())
                    }
                };
                let span = self.network.occurrences[event.occurrence.index()].span;
                let nodes = vec![NodeId::from_index(index)];
                let line = self.places.line(Status::Information, text, span, vec![name.clone()], nodes);
                let is_vertex = matches!(event.end, EventEnd::PathVertex { .. });
                events.push((is_vertex, EventReview { line, name, window, slack: slack(window) }));
            }
        }
        // Points of a path follow the events that they lie between.
        events.sort_by(|(left_vertex, left), (right_vertex, right)| {
            let key = |event: &EventReview| (event.slack, event.window.earliest);
            (key(left), left_vertex).cmp(&(key(right), right_vertex))
        });
        events.into_iter().map(|(_, event)| event).collect()
    }

    pub(super) fn traverses(&mut self) -> Vec<TraverseReview> {
        let pairs: Vec<(NodeId, NodeId)> = self
            .snapshot
            .traverses
            .iter()
            .map(|traverse| {
                let occurrence = &self.network.occurrences[traverse.occurrence.index()];
                (occurrence.start, occurrence.end)
            })
            .collect();
        let durations = self.distances.between(&pairs);
        let review = |(traverse, duration): (&snapshot::Traverse, &Option<TimeRange>)| {
            Some(self.traverse(traverse, (*duration)?))
        };
        self.snapshot.traverses.iter().zip(&durations).filter_map(review).collect()
    }

    /// The vehicles that come too close to one of a traverse in some schedule.
    fn in_the_way(&self, traverse: &snapshot::Traverse) -> Vec<&str> {
        let others: BTreeSet<u32> = (self.snapshot.separation_violations.iter())
            .filter_map(|violation| {
                let [one, other] = violation.vehicles;
                match [one, other].map(|vehicle| traverse.vehicles.contains(&vehicle)) {
                    [true, false] => Some(other),
                    [false, true] => Some(one),
                    _ => None,
                }
            })
            .collect();
        let vehicles = &self.snapshot.program.world.vehicles;
        let name = |&vehicle: &u32| vehicles.get(vehicle as usize).map(|it| it.name.text.as_str());
        others.iter().filter_map(name).collect()
    }

    fn traverse(&self, traverse: &snapshot::Traverse, duration: TimeRange) -> TraverseReview {
        let occurrence = &self.network.occurrences[traverse.occurrence.index()];
        let name = occurrence.name.to_string();
        let vehicles: Vec<String> = traverse
            .vehicles
            .iter()
            .filter_map(|&vehicle| self.snapshot.program.world.vehicles.get(vehicle as usize))
            .map(|vehicle| vehicle.name.text.to_string())
            .collect();
        let clearance_m = traverse.clearance_m.is_finite().then_some(traverse.clearance_m);
        let needed_s = self.needed_s(traverse);
        let unit_s = self.snapshot.program.options.time_unit.seconds() as f64;
        let is_too_short =
            needed_s.is_some_and(|needed_s| duration.least.to_f64() * unit_s < needed_s - 1e-3);
        let is_late = self.late.contains(&traverse.occurrence);
        let others = self.in_the_way(traverse);
        let astray = self.scattered_formation(traverse);
        let may_be_late = is_late || !others.is_empty() || traverse.may_be_closed() || astray.is_some();
        let status = match clearance_m {
            Some(clearance_m) if clearance_m < 0.0 => Status::Failed,
            _ if is_too_short => Status::Failed,
            _ if may_be_late => Status::Attention,
            _ => Status::Passed,
        };
        let slope_limit_rad = self.slope_limit_rad(traverse);
        let whose = match vehicles.len() {
            0 | 1 => "its planned path".to_owned(),
            2 => "the planned paths of both vehicles".to_owned(),
            count => format!("the planned paths of all {count} vehicles"),
        };
        let clearance = match clearance_m {
            Some(clearance_m) => format!("{whose} {clearance_m:.2} m clear of obstacles"),
            None => "no obstacle nearby".to_owned(),
        };
        let slope = match slope_limit_rad {
            Some(_) => format!(", slope up to {:.1}°", traverse.slope_max_rad.to_degrees()),
            None => String::new(),
        };
        let limits = match needed_s {
            Some(needed_s) if is_too_short => {
                format!(", too short for the vehicle limits, which need {needed_s:.1} s")
            }
            Some(_) => ", within the vehicle limits".to_owned(),
            None => String::new(),
        };
        let mut driving = String::new();
        if is_late {
            let most = driven_within_s(self.snapshot, self.network, traverse) / unit_s;
            driving = format!("; slow driving, up to {most:.1} {}, {LATE}", unit(self.snapshot));
        }
        if !others.is_empty() {
            driving.push_str(&format!("; {} {IN_THE_WAY}", others.join(", ")));
        }
        if traverse.may_be_closed() {
            driving.push_str(&format!("; {CLOSED}"));
        }
        if let Some(place_m) = traverse.narrow_m {
            driving.push_str(&format!(" near ({}, {})", place_m.x.round(), place_m.y.round()));
        }
        if let Some(Scattered { other, there, .. }) = astray {
            driving.push_str(&format!("; {other} is at {there} when it sets out"));
        }
        let text = format!(
            "{name}: {:.1} m in {}{limits}, {clearance}{slope}{driving}",
            traverse.length_m,
            self.range_text(duration)
        );
        let mut names = vec![name.clone()];
        names.extend(vehicles.iter().cloned());
        let nodes = vec![occurrence.start, occurrence.end];
        TraverseReview {
            line: self.places.line(status, text, occurrence.span, names, nodes),
            occurrence: traverse.occurrence,
            name,
            vehicles,
            places: traverse.legs.iter().map(|leg| leg.to.to_string()).collect(),
            length_m: traverse.length_m,
            duration,
            clearance_m,
            slope_max_rad: traverse.slope_max_rad,
            slope_limit_rad,
            may_be_late,
        }
    }

    /// Vehicles that do not reach the location that they are then said to be at, because others stand there (SPEC 10.3).
    pub(super) fn short_of_their_goals(&self) -> Vec<Line> {
        self.snapshot.traverses.iter().filter_map(|traverse| self.short_of_its_goal(traverse)).collect()
    }

    fn short_of_its_goal(&self, traverse: &snapshot::Traverse) -> Option<Line> {
        let world = &self.snapshot.program.world;
        let (short_m, location) = short_of_its_goal_m(world, traverse)?;
        let location_m = nalgebra::Point2::from(location.position_m);
        let occurrence = &self.network.occurrences[traverse.occurrence.index()];
        let name = |vehicle: u32| Some(world.vehicles.get(vehicle as usize)?.name.text.as_str());
        let &leader = traverse.vehicles.first()?;
        let time = self.plan.windows.get(occurrence.end.index()).copied().flatten()?.earliest.to_f64();
        let place = |motion: &snapshot::VehicleMotion| Some((motion.vehicle, motion.at(time)?.0));
        let places = self.snapshot.motions.iter().filter_map(place);
        let there = standing::nearest_other(world, &traverse.vehicles, (location_m, short_m), places);
        let other = there.and_then(name);
        let why = other.map_or_else(String::new, |other| format!(", where {other} is parked"));
        let (leader, place) = (name(leader)?, &location.name.text);
        let text = format!(
            "{leader} stops {short_m:.2} m short of {place} in {}{why}; the plan counts it as at {place}",
            occurrence.name
        );
        let names = [leader, occurrence.name.as_str()].into_iter().chain(other).map(str::to_owned).collect();
        Some(self.places.line(Status::Attention, text, occurrence.span, names, vec![occurrence.end]))
    }

    /// Traverses whose vehicles are to set out in formation, but are at different locations: no run can start them as planned.
    pub(super) fn scattered_formations(&self) -> Vec<Line> {
        let line = |traverse: &snapshot::Traverse| {
            let Scattered { leader, from, other, there } = self.scattered_formation(traverse)?;
            let occurrence = &self.network.occurrences[traverse.occurrence.index()];
            let name = occurrence.name.as_str();
            let text = format!(
                "{name} sets out in formation behind {leader} from {from}, but {other} is at {there}; drive it to {from} first"
            );
            let names = [name, leader, other].map(str::to_owned).into();
            Some(self.places.line(Status::Failed, text, occurrence.span, names, vec![occurrence.start]))
        };
        self.snapshot.traverses.iter().filter_map(line).collect()
    }

    fn scattered_formation(&self, traverse: &snapshot::Traverse) -> Option<Scattered<'input>> {
        let vehicles = &self.snapshot.program.world.vehicles;
        let members = traverse.vehicles.iter().filter_map(|&vehicle| vehicles.get(vehicle as usize));
        let mut places =
            members.map(|it| (it.name.text.as_str(), self.place_before(traverse.occurrence, it)));
        let (leader, from) = places.next()?;
        let (other, there) = places.find(|(_, place)| *place != from)?;
        Some(Scattered { leader, from, other, there })
    }

    /// The location where a vehicle is before a traverse that moves it.
    fn place_before(&self, traverse: OccurrenceId, vehicle: &VehicleDecl) -> String {
        let is_its = |order: &&tpn::StateOrder| {
            self.network.variables[order.variable.index()].name.strip_suffix(".at")
                == Some(vehicle.name.text.as_str())
        };
        let before = self.plan.state_order.iter().find(is_its).and_then(|order| {
            let moved = |&label: &LabelId| self.network.labels[label.index()].owner == Some(traverse);
            let at = order.producers.iter().position(moved)?;
            order.producers.get(at.checked_sub(1)?)
        });
        let literal = before.map(|&label| &self.network.labels[label.index()].literal);
        literal.map_or_else(
            || vehicle.start.text.to_string(),
            |literal| self.network.value_names(literal).join(", "),
        )
    }

    /// Returns how long the vehicles of a kinodynamic traverse take at least for its way on flat ground, in seconds:
    /// driven state by state within their limits, which shares nothing with how its durations were planned.
    fn needed_s(&self, traverse: &snapshot::Traverse) -> Option<f64> {
        let program = &self.snapshot.program;
        let occurrence = &self.network.occurrences[traverse.occurrence.index()];
        let moving = moving(program, occurrence).filter(|moving| moving.moves.is_kinodynamic)?;
        let models =
            traverse.vehicles.iter().filter_map(|&vehicle| model_of(&program.world, vehicle as usize));
        let mut limits = models.map(|model| DriveLimits::of(&model)).reduce(DriveLimits::of_both)?;
        // How fast a traverse may be does not limit its wheels in a turn.
        (limits.turn_rate_rps, limits.half_track_m) = (limits.turn_rate_in_place_rps(), 0.0);
        if let Some((_, greatest)) = moving.moves.speed_mps {
            limits.speed_mps = limits.speed_mps.min(greatest.to_f64());
        }
        let path = joined(&traverse.legs);
        let (from, to) = path.segments().find(|(from, to)| from != to)?;
        let heading_rad = libm::atan2(to.y - from.y, to.x - from.x);
        Some(motion::drive_path(&path, heading_rad, &limits).duration_s())
    }

    /// Returns what all vehicles of a traverse can climb.
    fn slope_limit_rad(&self, traverse: &snapshot::Traverse) -> Option<f64> {
        let world = &self.snapshot.program.world;
        let grades = traverse.vehicles.iter().filter_map(|&vehicle| {
            let model = model_of(world, vehicle as usize)?;
            match model.drive {
                motion::Drive::SkidSteer { max_grade, .. } => Some(max_grade),
                motion::Drive::Flight { .. } => None,
            }
        });
        grades.reduce(f64::min).map(libm::atan)
    }

    /// Returns how long something takes, with its unit.
    fn range_text(&self, range: TimeRange) -> String {
        let unit = unit(self.snapshot);
        let least = range.least.readable();
        match range.greatest {
            Bound::Infinite => format!("at least {least} {unit}"),
            Bound::Finite(greatest) if greatest == range.least => format!("{least} {unit}"),
            greatest @ Bound::Finite(_) => format!("{least} to {} {unit}", greatest.readable()),
        }
    }

    fn label_span(&self, label: LabelId) -> Option<Span> {
        self.network.labels[label.index()].span
    }
}

/// Returns what was taken, and rather than what.
fn choice_text(name: &str, alternatives: &[Alternative]) -> String {
    const MAX_NAMED: usize = 3;
    let taken = alternatives.iter().find(|it| it.fate == Fate::Taken).map_or("nothing", |it| &it.name);
    let others: Vec<&str> =
        alternatives.iter().filter(|it| it.fate != Fate::Taken).map(|it| it.name.as_str()).collect();
    match others.len() {
        0 => format!("{name} selects {taken}, its only alternative"),
        1..=MAX_NAMED => {
            let others: Vec<&str> = match others.as_slice() {
                [only] => vec![tpn::other_choice(only)],
                _ => others,
            };
            format!("{name} selects {taken} instead of {}", others.join(" or "))
        }
        count => format!("{name} selects {taken} instead of one of {count} others"),
    }
}

/// An interval as people call it: `Tell(PATH1=OK)#1`, or the condition and the activity it belongs to.
fn interval_text(name: &str) -> String {
    let Some((condition, owner)) = name.split_once('@') else { return name.to_owned() };
    if owner.starts_with("Tell(") || owner.starts_with("Ask(") {
        return owner.to_owned();
    }
    let inside =
        condition.split_once('(').and_then(|(_, rest)| rest.rsplit_once(')')).map(|(inside, _)| inside);
    if condition.starts_with("Set(") {
        return format!("the change to {} by {owner}", inside.unwrap_or(condition));
    }
    format!("{} during {owner}", inside.unwrap_or(condition))
}

/// The activities that a plan selects and whose durations the environment does not choose, each with its declared
/// bounds. A plan has to leave the environment the whole range.
pub(super) fn declared_durations<'network>(
    network: &'network Network,
    plan: &Plan,
) -> Vec<(&'network tpn::Occurrence, Time, Bound)> {
    let primitives = network.occurrences.iter().filter(|it| it.kind == OccurrenceKind::Primitive);
    let declared = primitives.filter_map(|occurrence| {
        let id = occurrence.arc?;
        let arc = network.arcs.get(id.index())?;
        let is_selected = plan.selected_arcs.get(id.index()) == Some(&true);
        (is_selected && !network.is_uncertain(id)).then_some((occurrence, arc.lower, arc.upper))
    });
    declared.collect()
}

/// Returns how many meters beside its last location a traverse ends, if it does, and that location.
pub(super) fn short_of_its_goal_m<'program>(
    world: &'program World,
    traverse: &snapshot::Traverse,
) -> Option<(f64, &'program LocationDecl)> {
    let last = traverse.legs.last()?;
    let location = world.locations.iter().find(|location| location.name.text == last.to)?;
    let short_m = nalgebra::distance(last.points_m.last()?, &nalgebra::Point2::from(location.position_m));
    (short_m >= 0.01).then_some((short_m, location))
}
