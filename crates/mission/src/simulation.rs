//! Vehicles that really drive their traverses in simulation (SPEC 7.4): along their paths, past what the map does not
//! show, and as late as that makes them.
//!
//! A traverse is driven when the executive starts it, and what it came to follows from its path, the moment and the
//! disturbances alone. The world that range sensors see holds all rocks, declared obstacles exactly, and what disturbances
//! put into it; planning knows only the map.

mod contact;
mod seen;
mod trip;
mod way;

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use exact::{Overflow, Rational, Time};
use executive::{
    ActivityExecution, ActivityExecutor, Contact, Disturbance, Ends, Entry, Happening, Revision,
};
use motion::FineWorld;
use nalgebra::{Point2, distance};
use rmpl::program::Program;
use smol_str::SmolStr;
use snapshot::standing::Start;
use snapshot::vehicle;
use snapshot::{DriveFrame, Keyframe, SimulatedDrive, SimulatedVehicle, VehicleMotion, standing};
use terrain::{Obstacle, Terrain};
use tpn::{EventRef, Network, OccurrenceId};

use self::seen::SeenMap;
use self::trip::Trip;
use crate::driving::{self, Drive};
use crate::planning::{self, Planned, Problem};
use crate::traverse::{self, Route};

pub(crate) use self::contact::first_on_paths;
pub(crate) use self::way::nearest_free;

/// A traverse with all that driving it takes.
struct Course {
    drive: Drive,
    route: Route,
    /// How far along the path each leg ends, in meters.
    leg_ends_m: Vec<f64>,
}

/// The traverses of the plans of a run, as they are known so far.
#[derive(Clone, Default)]
pub(crate) struct Courses {
    known: BTreeMap<OccurrenceId, Arc<Course>>,
}

impl Courses {
    /// Takes in the paths of a plan.
    pub(crate) fn learn(&mut self, program: &Program, planned: &Planned) {
        let Some(plan) = planned.planning.outcome.plans.first() else { return };
        let world = &program.world;
        for route in traverse::routes(&planned.network, program, plan, &[]) {
            let is_its = |traverse: &&snapshot::Traverse| traverse.occurrence == route.occurrence;
            let traverse = planned.traverses.iter().find(is_its);
            let space = planned.spaces.iter().find(|(occurrence, _)| *occurrence == route.occurrence);
            let (Some(traverse), Some((_, space))) = (traverse, space) else { continue };
            let path = snapshot::joined(&traverse.legs);
            let mut leg_ends_m = Vec::new();
            let mut along_m = 0.0;
            for leg in &traverse.legs {
                along_m += motion::length_m(&leg.points_m);
                leg_ends_m.push(along_m);
            }
            if let Some(drive) = planning::drive(world, &planned.network, plan, &route, path, space) {
                self.known.insert(route.occurrence, Arc::new(Course { drive, route, leg_ends_m }));
            }
        }
    }

    /// Returns whether this traverse is known.
    pub(crate) fn has(&self, occurrence: OccurrenceId) -> bool {
        self.known.contains_key(&occurrence)
    }

    /// The ways that are driven, each with how far along it the places that it leads to are, in meters.
    pub(crate) fn ways(&self) -> impl Iterator<Item = (&motion::Path, &[f64])> {
        self.known.values().map(|course| (&course.drive.path, course.leg_ends_m.as_slice()))
    }
}

/// Returns what all durations of drives are multiples of, in mission units.
pub(crate) fn granularity(program: &Program) -> Time {
    Time::ONE.checked_div(i64::from(ticks_per_unit(program))).unwrap_or_default()
}

/// Returns how many of [`granularity`] a mission unit has.
fn ticks_per_unit(program: &Program) -> u32 {
    u32::try_from(program.options.time_unit.seconds()).unwrap_or(1).saturating_mul(TICKS_PER_SECOND)
}

/// A traverse that was started, with what driving it follows from.
struct Departed {
    course: Arc<Course>,
    before: Before,
    /// When it was driven, among all: it is driven with the ways of those before in sight.
    turn: usize,
}

/// What was known when a traverse started.
struct Before {
    /// Where vehicles were that had driven.
    stand: Stand,
    /// What was seen by then that is not on the map.
    seen_m: Vec<Point2<f64>>,
    /// The ways of others: of those under way what is left of theirs, of the rest those that they take next.
    lanes: Vec<Lane>,
}

/// The way of a vehicle, with the radius of its body in meters.
struct Lane {
    path: motion::Path,
    radius_m: f64,
}

/// Where vehicles are that have driven, with their headings.
type Stand = BTreeMap<u32, (Point2<f64>, f64)>;

/// What driving a traverse has come to.
struct Driven {
    drive: SimulatedDrive,
    execution: ActivityExecution,
    seen: SeenMap,
    stand: Vec<(u32, (Point2<f64>, f64))>,
}

/// Drives traverses when the executive starts them.
///
/// Each is driven to its end when it starts, with the ways of those under way in sight, which do not know of it. Where they
/// would touch it, those who know least are driven again, as before until that moment.
pub(crate) struct Driving<'run> {
    problem: &'run Problem<'run>,
    map: &'run Terrain,
    disturbances: &'run [Disturbance],
    courses: &'run RefCell<Courses>,
    /// Seeds the noise of range sensors.
    seed: u64,
    /// What stands on the ground from the beginning; vehicles that fly are above it.
    world: FineWorld,
    stand: Stand,
    /// Where vehicles stand before they first drive.
    starts: Vec<Option<Start>>,
    /// When vehicles touch first in what was driven.
    contact: Option<Contact>,
    drives: Vec<SimulatedDrive>,
    /// For each of the drives.
    departed: Vec<Departed>,
    /// What those under way do otherwise since the last start.
    revised: BTreeMap<OccurrenceId, ActivityExecution>,
    /// What range finders have seen that is not on the map: the map that all vehicles share.
    seen: SeenMap,
    /// How long traverses take whose durations the environment chooses, by name.
    chosen: BTreeMap<SmolStr, Time>,
}

/// Rocks that a range sensor sees are at least this large, in meters: smaller ones are below its plane.
const MIN_ROCK_M: f64 = 0.4;
/// Durations are whole multiples of this fraction of a second.
const TICKS_PER_SECOND: u32 = 10;
/// Within this distance of a location a vehicle is at it, in meters: it may stop a little before its path ends.
const AT_GOAL_M: f64 = 0.5;
/// Where a vehicle stands first, no rock comes nearer to its body than this, in meters.
const STARTING_ROOM_M: f64 = 0.1;
/// Meters driven are whole multiples of this fraction of a meter.
const PARTS_PER_METER: u32 = 1000;
/// How often traverses are driven again, at most, so that vehicles that were driven one after the other see each other.
const MAX_AGAIN: usize = 6;

impl<'run> Driving<'run> {
    /// For one run of `problem` on `map`.
    pub(crate) fn new(
        problem: &'run Problem<'run>,
        map: &'run Terrain,
        disturbances: &'run [Disturbance],
        courses: &'run RefCell<Courses>,
        seed: u64,
    ) -> Self {
        let solid = problem.program.world.obstacles.iter().filter(|it| it.is_solid());
        let obstacles: Vec<Obstacle> = solid.map(|it| snapshot::ground::obstacle(&it.shape)).collect();
        let world = FineWorld::new(map, &obstacles, MIN_ROCK_M);
        let (starts, contact) = (standing::starts(problem.program, &problem.network.occurrences), None);
        Self {
            problem,
            map,
            disturbances,
            courses,
            seed,
            world,
            stand: Stand::new(),
            starts,
            contact,
            drives: Vec::new(),
            departed: Vec::new(),
            revised: BTreeMap::new(),
            seen: SeenMap::default(),
            chosen: BTreeMap::new(),
        }
    }

    /// Returns where vehicles stand that have driven, which is given, or have not driven yet, with their numbers.
    fn standing_m<'a>(&'a self, stand: &'a Stand) -> impl Iterator<Item = (u32, Point2<f64>)> + 'a {
        let starts = self.starts.iter().enumerate();
        let starts = starts.filter_map(|(vehicle, start)| Some((vehicle as u32, (*start)?)));
        let parked = starts.filter(|(vehicle, _)| !stand.contains_key(vehicle));
        let parked = parked.map(|(vehicle, start)| (vehicle, self.start_m(vehicle, start)));
        stand.iter().map(|(&vehicle, &(place, _))| (vehicle, place)).chain(parked)
    }

    /// The ways of vehicles that do not drive with these and are as high above the ground as one of them.
    fn lanes(&self, drive: &Drive, now: f64) -> Vec<Lane> {
        let world = &self.problem.program.world;
        let is_in_its_way = |vehicle: u32| {
            let flies = vehicle::flies(world, vehicle);
            !drive.vehicles.contains(&vehicle)
                && drive.vehicles.iter().any(|&own| vehicle::flies(world, own) == flies)
        };
        let mut lanes: BTreeMap<u32, motion::Path> = BTreeMap::new();
        for driven in self.drives.iter().flat_map(|drive| &drive.vehicles) {
            let left = driven.frames.iter().filter(|frame| frame.time > now).map(|frame| frame.position_m);
            let left: Vec<Point2<f64>> = left.collect();
            if !left.is_empty() && is_in_its_way(driven.vehicle) {
                lanes.insert(driven.vehicle, motion::Path::new(left));
            }
        }
        let courses = self.courses.borrow();
        let departed: BTreeSet<OccurrenceId> = self.drives.iter().map(|drive| drive.occurrence).collect();
        let mut next: BTreeMap<u32, &Drive> = BTreeMap::new();
        for drive in courses.known.values().map(|course| &course.drive) {
            let others = drive.vehicles.iter().filter(|vehicle| {
                !departed.contains(&drive.occurrence)
                    && is_in_its_way(**vehicle)
                    && !lanes.contains_key(vehicle)
            });
            for &vehicle in others {
                let first = next.entry(vehicle).or_insert(drive);
                if drive.start < first.start {
                    *first = drive;
                }
            }
        }
        for (vehicle, drive) in next {
            let member = drive.vehicles.iter().position(|&member| member == vehicle);
            let track = member.and_then(|member| driving::tracks_m(drive).into_iter().nth(member));
            lanes.extend(track.map(|track| (vehicle, track)));
        }
        let lane = |(vehicle, path)| Lane { path, radius_m: vehicle::radius_m(world, vehicle) };
        lanes.into_iter().map(lane).collect()
    }

    /// Returns where a vehicle is that has not driven yet.
    fn start_m(&self, vehicle: u32, start: Start) -> Point2<f64> {
        let courses = self.courses.borrow();
        let drives = courses.known.values().map(|course| &course.drive);
        let first = drives.filter(|drive| drive.vehicles.contains(&vehicle)).min_by_key(|drive| drive.start);
        let place_m = first.and_then(|drive| {
            let index = drive.vehicles.iter().position(|&it| it == vehicle)?;
            let track = driving::tracks_m(drive).into_iter().nth(index)?;
            Some(driving::place_before(drive, index, *track.points_m.first()?, Some(start)))
        });
        place_m.unwrap_or(start.place_m)
    }

    /// Drives a traverse from its start to its end, or until it gives up.
    fn driven(
        &self,
        network: &Network,
        course: &Course,
        (start, before): (Time, &Before),
    ) -> Result<Driven, Overflow> {
        let occurrence = course.drive.occurrence;
        let name = network.occurrences[occurrence.index()].name.clone();
        let tracks = driving::tracks_m(&course.drive);
        let mut trip = Trip::new(self, course, tracks, network, (start, before));
        let reached = trip.drive();
        if let Err(reason) = &reached {
            trip.entries.push((trip.convoy.time_s(), format!("{reason}, and gives up")));
        } else if let Some(note) =
            self.short_of_its_goal(course, trip.convoy.state(0).position_m, &before.stand)
        {
            trip.entries.push((trip.convoy.time_s(), note));
        }
        let driven_m = trip.driven_m();
        let Trip {
            frames,
            entries,
            passes,
            reroutes,
            min_clearance_m,
            convoy,
            extra_meters,
            arrived_m,
            seen,
            ..
        } = trip;
        let time_s = convoy.time_s();
        let unit_seconds = self.problem.program.options.time_unit.seconds();
        let units = |seconds: f64| {
            let seconds = Time::from_f64_up(seconds, TICKS_PER_SECOND);
            seconds.and_then(|seconds| seconds.checked_div(unit_seconds)).ok_or(Overflow)
        };
        let duration = units(time_s)?;
        let vehicles = || course.drive.vehicles.iter().copied();
        let at_last = |index: usize| (convoy.state(index).position_m, convoy.state(index).heading_rad);
        let stand = vehicles().enumerate().map(|(index, vehicle)| (vehicle, at_last(index))).collect();
        let frames = vehicles().zip(frames);
        let drive = SimulatedDrive {
            occurrence,
            start,
            duration: reached.is_ok().then_some(duration),
            vehicles: frames.map(|(vehicle, frames)| SimulatedVehicle { vehicle, frames }).collect(),
            driven_m,
            reroutes,
            min_clearance_m,
        };
        let entry = |(seconds, text): (f64, String)| {
            let time = start.checked_add(units(seconds)?).ok_or(Overflow)?;
            Ok(Entry { time, happening: Happening::Progress { name: name.clone(), text } })
        };
        let pass = |(event, seconds): (EventRef, f64)| Ok((event, units(seconds)?));
        let length_m = course.drive.path.length_m();
        let margin = |meters: f64| Rational::from_f64_up(meters, PARTS_PER_METER).ok_or(Overflow);
        let company = course.route.company;
        let rocks = planning::hidden_rocks(&self.problem.program.world, &course.route, self.map);
        let at_most_m = motion::driven_at_most_m(length_m, company, rocks);
        let taken_m = margin(at_most_m - length_m)?;
        let given_m = margin(length_m - motion::min_driven_m(length_m, company, rocks))?;
        let extra = |(seconds, meters): (f64, f64)| {
            let meters = Rational::from_f64_up(meters, PARTS_PER_METER).ok_or(Overflow)?;
            Ok((units(seconds)?, meters))
        };
        let execution = ActivityExecution {
            ends: reached.map_or_else(Ends::Never, |()| Ends::NotBefore(duration)),
            entries: entries.into_iter().map(entry).collect::<Result<_, _>>()?,
            passes: passes.into_iter().map(pass).collect::<Result<_, _>>()?,
            extra_meters: (extra_meters.into_iter())
                .filter(|&(_, extra_m)| extra_m > at_most_m - length_m)
                .chain(arrived_m)
                .map(extra)
                .collect::<Result<_, _>>()?,
            counted_margins: [taken_m, given_m],
        };
        Ok(Driven { drive, execution, seen, stand })
    }

    /// Notes what driving a traverse has come to. Returns the drive.
    fn take_in(&mut self, driven: Driven) -> SimulatedDrive {
        let Driven { drive, execution, seen, stand } = driven;
        self.revised.insert(drive.occurrence, execution);
        self.seen.extend(seen);
        self.stand.extend(stand);
        drive
    }

    /// Where vehicles under way would touch, one of the two is driven again, which knows less than the other one of what was
    /// driven since: as before until now.
    fn keep_apart(&mut self, network: &Network, now: Time) -> Result<(), Overflow> {
        let (program, now) = (self.problem.program, now.to_f64());
        for round in 0..=MAX_AGAIN {
            let touching = contact::first_contact(program, network, &self.drives);
            self.contact = touching.as_ref().map(|it| it.contact.clone());
            let Some(touching) = touching else { break };
            let is_concerned = |drive: &SimulatedDrive| {
                let mut vehicles = drive.vehicles.iter().filter(|it| touching.vehicles.contains(&it.vehicle));
                drive.start.to_f64() <= touching.time
                    && vehicles.any(|it| it.frames.last().is_some_and(|last| last.time > now))
            };
            let concerned = (0..self.drives.len()).filter(|&index| is_concerned(&self.drives[index]));
            let Some(index) = concerned.min_by_key(|&index| self.departed[index].turn) else { break };
            let last = self.departed.iter().map(|departed| departed.turn).max().unwrap_or_default();
            let Departed { course, before, turn } = &self.departed[index];
            if *turn == last || round == MAX_AGAIN {
                break;
            }
            let again = self.driven(network, course, (self.drives[index].start, before))?;
            self.departed[index].turn = last + 1;
            self.drives[index] = self.take_in(again);
        }
        Ok(())
    }

    /// That the leader of a traverse is not at the location that the traverse leads to, but beside it, and who stands there.
    fn short_of_its_goal(&self, course: &Course, place: Point2<f64>, stand: &Stand) -> Option<String> {
        let world = &self.problem.program.world;
        let goal = course.route.waypoints.last()?;
        let location = world.locations.iter().find(|location| location.name.text == goal.name)?;
        let location_m = Point2::from(location.position_m);
        let short_m = distance(&place, &location_m);
        if short_m <= AT_GOAL_M {
            return None;
        }
        let name =
            |vehicle: u32| world.vehicles.get(vehicle as usize).map_or("?", |it| it.name.text.as_str());
        let &leader = course.drive.vehicles.first()?;
        let there = standing::nearest_other(
            world,
            &course.drive.vehicles,
            (location_m, short_m),
            self.standing_m(stand),
        );
        let why = there.map_or_else(String::new, |other| format!(", where {} is parked", name(other)));
        Some(format!("{} stops {short_m:.2} m short of {}{why}", name(leader), location.name.text))
    }

    /// Drives at the speed that durations need which the environment chose, by the names of their occurrences.
    pub(crate) fn hurry(&mut self, chosen: BTreeMap<SmolStr, Time>) {
        self.chosen = chosen;
    }

    /// Returns what was driven, in order of departure; after a contact nothing more.
    pub(crate) fn into_drives(mut self) -> Vec<SimulatedDrive> {
        if let Some(contact) = &self.contact {
            let at = contact.at.to_f64();
            for drive in &mut self.drives {
                let frames = drive.vehicles.iter_mut().map(|vehicle| &mut vehicle.frames);
                for frames in frames.filter(|frames| frames.last().is_some_and(|last| last.time > at)) {
                    frames.truncate(frames.partition_point(|frame| frame.time <= at));
                    drive.duration = None;
                }
            }
        }
        self.drives
    }
}

impl ActivityExecutor for Driving<'_> {
    fn start(
        &mut self,
        network: &Network,
        occurrence: OccurrenceId,
        start: Time,
    ) -> Result<ActivityExecution, Overflow> {
        let courses = self.courses.borrow();
        let Some(course) = courses.known.get(&occurrence).cloned() else {
            return Ok(ActivityExecution::default());
        };
        if course.drive.path.length_m() <= 0.0 {
            // Who is there already has nothing to drive.
            return Ok(ActivityExecution {
                ends: Ends::NotBefore(Time::ZERO),
                ..ActivityExecution::default()
            });
        }
        drop(courses);
        let tracks = driving::tracks_m(&course.drive);
        for (vehicle, track) in course.drive.vehicles.iter().zip(&tracks) {
            // Where it stands from the beginning no rock is, whatever the map leaves out.
            if let (Some(&place), false) = (track.points_m.first(), self.stand.contains_key(vehicle)) {
                let radius_m = vehicle::radius_m(&self.problem.program.world, *vehicle);
                self.world.clear_rocks(place, radius_m + STARTING_ROOM_M);
            }
        }
        let seen_m = self.seen.known_at(start.to_f64());
        let lanes = self.lanes(&course.drive, start.to_f64());
        let before = Before { stand: self.stand.clone(), seen_m, lanes };
        let driven = self.driven(network, &course, (start, &before))?;
        let turn = self.departed.iter().map(|departed| departed.turn + 1).max().unwrap_or(0);
        self.departed.push(Departed { course, before, turn });
        let drive = self.take_in(driven);
        self.drives.push(drive);
        self.keep_apart(network, start)?;
        Ok(self.revised.remove(&occurrence).unwrap_or_default())
    }

    fn granularity(&self) -> Time {
        granularity(self.problem.program)
    }

    fn whereabouts(&self, _: &Network, of: &[OccurrenceId], now: Time) -> Vec<(u32, [f64; 2])> {
        let now = now.to_f64();
        let mut places: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
        for drive in self.drives.iter().filter(|drive| of.contains(&drive.occurrence)) {
            for vehicle in &drive.vehicles {
                let frame = vehicle.at(now);
                places.extend(frame.map(|frame| (vehicle.vehicle, frame.position_m.coords.into())));
            }
        }
        places.into_iter().collect()
    }

    fn contact(&self) -> Option<Contact> {
        self.contact.clone()
    }

    fn revise(&mut self) -> Option<Revision> {
        let executions: Vec<_> = std::mem::take(&mut self.revised).into_iter().collect();
        (!executions.is_empty()).then_some(Revision { executions, readings: None })
    }

    fn abandon(&mut self, network: &Network, of: &[OccurrenceId], now: Time) {
        let now = now.to_f64();
        for drive in self.drives.iter_mut().filter(|drive| of.contains(&drive.occurrence)) {
            for vehicle in &mut drive.vehicles {
                let driven = vehicle.frames.partition_point(|frame| frame.time <= now);
                if driven == 0 || driven == vehicle.frames.len() {
                    continue;
                }
                vehicle.frames.truncate(driven);
                drive.duration = None;
                if let Some(last) = vehicle.frames.last() {
                    self.stand.insert(vehicle.vehicle, (last.position_m, last.heading_rad));
                }
            }
        }
        self.seen.forget_after(now);
        let touching = contact::first_contact(self.problem.program, network, &self.drives);
        self.contact = touching.map(|it| it.contact);
    }
}

/// Puts what was driven in place of even drives between the planned times.
pub(crate) fn put_into(motions: &mut [VehicleMotion], drives: &[SimulatedDrive]) {
    const PARTS_PER_UNIT: u32 = 60_000;
    for drive in drives {
        for simulated in &drive.vehicles {
            let Some(motion) = motions.iter_mut().find(|motion| motion.vehicle == simulated.vehicle) else {
                continue;
            };
            let (Some(first), Some(last)) = (simulated.frames.first(), simulated.frames.last()) else {
                continue;
            };
            let is_within = |frame: &Keyframe| {
                let time = frame.time.to_f64();
                time >= first.time - 1e-6 && time <= last.time + 1e-6
            };
            motion.keyframes.retain(|frame| !is_within(frame));
            motion.keyframes.extend(simulated.frames.iter().map(|frame| Keyframe {
                time: Time::from_f64_nearest(frame.time, PARTS_PER_UNIT).unwrap_or(drive.start),
                position_m: frame.position_m,
                heading_rad: frame.heading_rad,
            }));
            motion.keyframes.sort_by_key(|frame| frame.time);
        }
    }
}

#[cfg(test)]
mod tests {
    use snapshot::Goal;

    use super::*;
    use crate::Grounds;
    use crate::traverse::Paths;

    /// The second rover parks on the way of the first one.
    const SOURCE: &str = "terrain \"flat\" cell 0.6;
location WEST (20, 20); location EAST (60, 20); location NORTH (40, 26); location MIDDLE (40, 20);
vehicle V0 : ATRV-Jr at WEST; vehicle V1 : ATRV-Jr at NORTH;
primitive Drive(r, to)[0,200] moves r speed (0.005, 0.3);
scenario S[0,600] = { Drive(V0, EAST), { delay; Drive(V1, MIDDLE) } }";

    /// A traverse that is driven again for one that starts later does what it did until then.
    #[test]
    fn what_has_happened_does_not_depend_on_what_starts_later() {
        let parse = rmpl::parse(SOURCE);
        let (program, mut diagnostics) = (parse.program(), parse.diagnostics());
        let network = crate::compile(&program, &Goal::Default, &mut diagnostics).expect("it compiles");
        let network = Arc::new(network);
        let (mut grounds, mut paths) = (Grounds::default(), Paths::default());
        let (ground, _) = grounds.resolve(&program);
        let (key, map) = ground.as_ref().expect("a map");
        let (mut driven_again, now) = (0, Time::new(1, 10).expect("it fits"));
        for seed in 0..12 {
            let problem = Problem { ground: Some((key, map)), seed, ..Problem::new(&network, &program) };
            let planned = planning::plan(&problem, &mut grounds, &mut paths, &mut || false);
            let courses = RefCell::new(Courses::default());
            courses.borrow_mut().learn(&program, &planned);
            let [first, second] = [0, 1].map(|index| planned.traverses[index].occurrence);
            let mut driving = Driving::new(&problem, map, &[], &courses, seed);
            let until_now = |driving: &Driving<'_>| {
                let frames = driving.drives[0].vehicles[0].frames.iter();
                frames.take_while(|frame| frame.time < now.to_f64()).cloned().collect::<Vec<_>>()
            };
            driving.start(&planned.network, first, Time::ZERO).expect("its times fit");
            let before = (until_now(&driving), driving.drives[0].clone());
            driving.revise();
            driving.start(&planned.network, second, now).expect("its times fit");
            assert_eq!(until_now(&driving), before.0, "seed {seed}");
            assert_eq!(driving.contact(), None, "seed {seed}");
            let is_revised = driving.revise().is_some_and(|it| it.executions.iter().any(|it| it.0 == first));
            assert_eq!(is_revised, driving.drives[0] != before.1, "seed {seed}");
            driven_again += usize::from(is_revised);
        }
        assert!(driven_again > 0, "none is driven again");
    }
}
