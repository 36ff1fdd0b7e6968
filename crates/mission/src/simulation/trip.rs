//! One traverse as it is driven, from its start until its last vehicle is there or none can continue.

use snapshot::ground::closed_to;
use snapshot::vehicle;
use std::cell::LazyCell;
use std::collections::BTreeMap;
use std::ops::Deref;

use exact::{Rational, Time};
use executive::Disturbance;
use motion::{
    Convoy, ConvoyMember, DriveEvent, DriveLimits, DriverSettings, FineWorld, OtherVehicle, Path,
    PlannerKind, Query, RangeScan, ShortcutSettings, Surroundings, VehicleModel,
};
use nalgebra::{Point2, Vector2, distance};
use smol_str::SmolStr;
use terrain::{CellState, ConfigurationSpace, Obstacle, Occupancy, Terrain};
use tpn::{ArcKind, EventEnd, EventRef, Network, OccurrenceId};

use super::seen::{SeenMap, is_blocked};
use super::way::{gets_past, nearest_free, rest_of, until};
use super::{Before, Course, DriveFrame, Driving, Lane, SimulatedVehicle};
use crate::driving;

/// Frames are kept this far apart, in meters and radians, and at least every so many steps.
const FRAME_M: f64 = 1.0;
const FRAME_RAD: f64 = 0.4;
const FRAME_STEPS: u32 = 40;
/// Of a vehicle that moves so many meters from another one, or nearer, every step is kept.
const CLOSE_M: f64 = 0.5;
/// How far ahead a frame shows the way, in meters.
const SHOWN_PLAN_M: f64 = 6.0;
/// The leader aims to be there early, because what it meets costs time: by this share of its time at least, or by some
/// seconds, which are another share at most. A vehicle that is early waits.
const EARLY_SHARE: f64 = 0.015;
const EARLY_S: f64 = 60.0;
const MAX_EARLY_SHARE: f64 = 0.1;
/// A driver looks so many seconds ahead at the ways of others that are this near its leader, in meters.
const FORESEEN_S: u32 = 30;
const NEAR_M: f64 = 40.0;
/// Vehicles give up after so many other ways, and after so many times the time that they were to take.
const MAX_REROUTES: u32 = 12;
const MAX_TIMES: f64 = 4.0;
/// Steps of simulation that one drive takes at most, so that none continues without end.
const MAX_STEPS: u32 = 500_000;
/// A follower that cannot continue looks for a way to its own path so many meters ahead, or else to its end.
const REJOINING_M: [f64; 3] = [8.0, 15.0, 30.0];
/// It stays where it is, when it is this near to the end of its way, in meters, and something stands no farther beside that
/// than it needs itself and so much more.
const STAYS_WITHIN_M: f64 = 4.0;
const BESIDE_M: f64 = 0.3;
/// What is seen this near to what the map shows, in meters, is taken for that.
const KNOWN_M: f64 = 0.9;
/// What sonars hear continues the map from this near on, in meters.
const HEARD_M: f64 = 1.5;
/// A vehicle that is blocked again within so many meters got no farther: its way is closed to it so far ahead, and so far around.
const SAME_PLACE_M: f64 = 0.5;
const CLOSED_AHEAD_M: f64 = 1.2;
const CLOSED_M: f64 = 0.4;
/// Another way is long if it is so many meters longer than the straight line to its end; less room is worth it if that saves so
/// many meters.
const LONG_M: f64 = 8.0;
const SAVED_M: f64 = 5.0;
/// Samples of a search for another way. Where it finds none, cells show ways up to so many times as long as the straight line,
/// and so many meters more.
const MAX_SAMPLES: u32 = 5_000;
const BOUND_SHARE: f64 = 2.0;
const BOUND_M: f64 = 60.0;
/// The places near the vehicle from which it is searched at most, and meters between them.
const STARTS: u32 = 4;
const STARTS_APART_M: f64 = 0.6;
/// Where no way is found, one is searched on a map whose cells are at most so large in meters, up to so many meters beside
/// the vehicle and its goal, if it is at most so many meters across.
const FINER_M: f64 = 0.2;
const BESIDE_FINER_M: f64 = 15.0;
const MAX_FINER_M: f64 = 80.0;
/// How finely the ways of others are put on a map, in meters.
const LANE_STEP_M: f64 = 0.5;
/// Meters beyond the path are counted by so many.
const COUNTED_M: f64 = 5.0;

/// A vehicle that is not part of a traverse.
struct Neighbor<'a> {
    /// Where it stands before it first moves.
    stands_m: Point2<f64>,
    /// What it drives while the traverse is under way, as far as that is known, in order.
    moves: Vec<&'a SimulatedVehicle>,
    radius_m: f64,
    flies: bool,
}

/// What sensors can see: on the ground, and above what stands there.
#[derive(Clone)]
struct Layers {
    ground: FineWorld,
    air: FineWorld,
}

impl Layers {
    const fn of(&self, flies: bool) -> &FineWorld {
        if flies { &self.air } else { &self.ground }
    }

    const fn of_mut(&mut self, flies: bool) -> &mut FineWorld {
        if flies { &mut self.air } else { &mut self.ground }
    }
}

/// A follower that was led around something.
#[derive(Clone, Copy)]
struct LedAround {
    /// Where it is back on its own path, in meters before its end.
    rejoins_m: f64,
    /// How often it was led around something before it was back there.
    tries: usize,
}

impl Neighbor<'_> {
    /// Returns what it drives at a time, or drove last.
    fn last_move(&self, now: f64) -> Option<&SimulatedVehicle> {
        let has_begun = |it: &&&SimulatedVehicle| it.frames.first().is_some_and(|first| first.time <= now);
        self.moves.iter().rev().find(has_begun).copied()
    }

    /// Returns where it stands at a time, in mission units, if it does.
    fn standing_m(&self, now: f64) -> Option<Point2<f64>> {
        let Some(last_move) = self.last_move(now) else { return Some(self.stands_m) };
        let last = last_move.frames.last()?;
        (last.time <= now).then_some(last.position_m)
    }

    /// Returns where it is at a time, in mission units.
    fn place_m(&self, now: f64) -> Point2<f64> {
        self.last_move(now).and_then(|last_move| last_move.place_m(now)).unwrap_or(self.stands_m)
    }
}

/// One traverse under way.
pub(super) struct Trip<'a> {
    course: &'a Course,
    map: &'a Terrain,
    names: Vec<&'a str>,
    models: Vec<VehicleModel>,
    maps: Vec<ConfigurationSpace>,
    pub(super) convoy: Convoy,
    /// Which of its vehicles fly.
    flies: Vec<bool>,
    /// What its sensors see without the other vehicles.
    still: Layers,
    /// The same with the vehicles that stand there.
    world: Layers,
    /// What is still to happen to the world, with seconds from the start of the traverse, and whether only
    /// sonars hear it; the earliest last.
    coming: Vec<(f64, Obstacle, bool)>,
    /// Slow spells: the vehicle, the share of its speed, and from when to when in seconds.
    slow: Vec<(usize, f64, [f64; 2])>,
    neighbors: Vec<Neighbor<'a>>,
    /// Where each of them stands, if it does: to be seen, but not to be put on a map.
    standing: Vec<Option<Point2<f64>>>,
    start: f64,
    unit_s: f64,
    /// Least and greatest speed of the traverse.
    speeds_mps: [f64; 2],
    /// When it is to be there, in seconds from its start.
    wanted_s: f64,
    /// How far from the path's end its vertices are, in meters, with their events; the next first.
    vertices: Vec<(f64, EventRef)>,
    pub(super) frames: Vec<Vec<DriveFrame>>,
    steps_since_frame: Vec<u32>,
    pub(super) entries: Vec<(f64, String)>,
    pub(super) passes: Vec<(EventRef, f64)>,
    pub(super) reroutes: u32,
    /// How far the leader has driven, in meters.
    driven_m: f64,
    /// How many meters that is more than its path has, with seconds from the start: every so often.
    pub(super) extra_meters: Vec<(f64, f64)>,
    /// The same when it is there, or fewer than its path has.
    pub(super) arrived_m: Option<(f64, f64)>,
    pub(super) min_clearance_m: f64,
    /// What others had seen when it started, and what is seen on the way.
    known: Vec<Point2<f64>>,
    /// The ways of others, which another way keeps out of where it can.
    lanes: &'a [Lane],
    pub(super) seen: SeenMap,
    /// How far along the path each leg ends, in meters.
    leg_ends_m: Vec<f64>,
    /// Where each vehicle was blocked last, and where its way is closed to it because it got no farther there.
    blocked_m: Vec<Option<Point2<f64>>>,
    closed_m: Vec<Vec<Point2<f64>>>,
    /// How each follower was led around something last.
    led_around: Vec<Option<LedAround>>,
    /// Why it cannot set out.
    scattered: Option<String>,
}

impl<'a> Trip<'a> {
    /// Of vehicles whose ways are `tracks`, the leader's first.
    pub(super) fn new(
        driving: &'a Driving<'_>,
        course: &'a Course,
        tracks: Vec<Path>,
        network: &Network,
        (start, before): (Time, &'a Before),
    ) -> Self {
        let world = &driving.problem.program.world;
        let unit_s = driving.problem.program.options.time_unit.seconds() as f64;
        let start = start.to_f64();
        let drive = &course.drive;
        let declared = |vehicle: u32| world.vehicles.get(vehicle as usize);
        let model = |vehicle: &u32| vehicle::model_of(world, *vehicle as usize).unwrap_or(course.route.model);
        let models: Vec<VehicleModel> = drive.vehicles.iter().map(model).collect();
        let mut scattered = None;
        let speeds_mps = [course.route.speed_mps.0, course.route.speed_mps.1].map(Rational::to_f64);
        let members: Vec<ConvoyMember> = drive
            .vehicles
            .iter()
            .zip(tracks)
            .zip(&models)
            .enumerate()
            .map(|(index, ((vehicle, track), model))| {
                let mut points = track.points_m;
                let stand = before.stand.get(vehicle);
                let place = driving.standing_m(&before.stand).find(|(other, _)| other == vehicle);
                if let (Some((_, place)), Some(first)) = (place, points.first_mut()) {
                    let away_m = distance(&place, first);
                    if away_m > driving::sets_out_within_m(drive, index) {
                        let name = declared(*vehicle).map_or("?", |it| it.name.text.as_str());
                        scattered = Some(format!("{name} is {away_m:.0} m from its start position"));
                    }
                    *first = place;
                }
                let ahead = points.get(1).zip(points.first()).map_or(Vector2::x(), |(to, from)| to - from);
                let limits = DriveLimits::of(model);
                ConvoyMember {
                    path: Path::new(points),
                    heading_rad: stand.map_or(libm::atan2(ahead.y, ahead.x), |&(_, heading_rad)| heading_rad),
                    settings: DriverSettings::new(limits, model.circumradius_m).at_most(speeds_mps[1]),
                    flies: vehicle::flies(world, *vehicle),
                }
            })
            .collect();
        let seconds = |time: Time| (time.to_f64() - start) * unit_s;
        let flies: Vec<bool> = drive.vehicles.iter().map(|&vehicle| vehicle::flies(world, vehicle)).collect();
        let is_flight = flies.iter().all(|flies| *flies);
        let mut coming: Vec<(f64, Obstacle, bool)> = Vec::new();
        let mut slow = Vec::new();
        for disturbance in driving.disturbances {
            match disturbance {
                Disturbance::Obstacle { at, x, y, radius, low } => {
                    coming.push((
                        seconds(*at),
                        Obstacle::Circle { center_m: Point2::new(*x, *y), radius_m: *radius },
                        *low,
                    ));
                }
                Disturbance::VehicleSlow { vehicle, factor, from, until } => {
                    let is_named = |it: &u32| declared(*it).is_some_and(|it| it.name.text == *vehicle);
                    if let Some(index) = drive.vehicles.iter().position(is_named) {
                        slow.push((
                            index,
                            factor.to_f64().clamp(0.0, 1.0),
                            [seconds(*from), seconds(*until)],
                        ));
                    }
                }
                _ => {}
            }
        }
        coming.sort_by(|a, b| b.0.total_cmp(&a.0));
        // What stands on the ground is below those that fly.
        let mut still = Layers { ground: driving.world.clone(), air: FineWorld::default() };
        // Nothing stands in an area that is closed to them, but their drivers stay out of it all the same.
        let activity = &network.occurrences[drive.occurrence.index()].activity;
        for closed in closed_to(world, &course.route.vehicles, activity).filter(|it| !it.is_solid()) {
            let closed = snapshot::ground::obstacle(&closed.shape);
            still.ground.add(&closed);
            still.air.add(&closed);
        }
        let others =
            driving.standing_m(&before.stand).filter(|(vehicle, _)| !drive.vehicles.contains(vehicle));
        let neighbor = |(vehicle, stands_m): (u32, Point2<f64>)| {
            let drives = driving.drives.iter().flat_map(|drive| &drive.vehicles);
            let is_coming = |it: &&SimulatedVehicle| {
                it.vehicle == vehicle && it.frames.last().is_some_and(|last| last.time > start)
            };
            let moves = drives.filter(is_coming).collect();
            let (radius_m, flies) = (vehicle::radius_m(world, vehicle), vehicle::flies(world, vehicle));
            Neighbor { stands_m, moves, radius_m, flies }
        };
        let neighbors = others.map(neighbor).collect();
        let length_m = drive.path.length_m();
        let mut along_m = 0.0;
        let mut passed_m: Vec<f64> = Vec::new();
        for (from, to) in drive.path.segments() {
            along_m += distance(&from, &to);
            passed_m.push(length_m - along_m);
        }
        let events = network.nodes.iter().flat_map(|node| &node.events).filter(|event| {
            event.occurrence == drive.occurrence && matches!(event.end, EventEnd::PathVertex { .. })
        });
        let count = drive.vehicles.len();
        Self {
            names: drive
                .vehicles
                .iter()
                .map(|&it| declared(it).map_or("?", |it| it.name.text.as_str()))
                .collect(),
            maps: models
                .iter()
                .zip(&flies)
                .map(|(model, flies)| {
                    let radius_m = model.circumradius_m;
                    if *flies && !is_flight {
                        // The map of those that drive is not that of one that flies above them.
                        ConfigurationSpace::new(Occupancy::free(*drive.space.frame()), radius_m)
                    } else {
                        drive.space.with_radius_m(radius_m)
                    }
                })
                .collect(),
            convoy: Convoy::new(members, drive.spacing_m, driving.seed),
            map: driving.map,
            vertices: passed_m.into_iter().zip(events.copied()).collect(),
            wanted_s: wanted_units(network, drive.occurrence, &driving.chosen) * unit_s,
            frames: vec![Vec::new(); count],
            steps_since_frame: vec![0; count],
            world: still.clone(),
            still,
            course,
            models,
            coming,
            slow,
            neighbors,
            standing: Vec::new(),
            start,
            unit_s,
            speeds_mps,
            entries: Vec::new(),
            passes: Vec::new(),
            reroutes: 0,
            driven_m: 0.0,
            extra_meters: Vec::new(),
            arrived_m: None,
            min_clearance_m: f64::INFINITY,
            known: if flies.first() == Some(&true) { Vec::new() } else { before.seen_m.clone() },
            lanes: &before.lanes,
            flies,
            seen: SeenMap::default(),
            leg_ends_m: course.leg_ends_m.clone(),
            blocked_m: vec![None; count],
            closed_m: vec![Vec::new(); count],
            led_around: vec![None; count],
            scattered,
        }
    }

    /// Returns how far the leader has driven, in meters.
    pub(super) const fn driven_m(&self) -> f64 {
        self.driven_m
    }

    /// Drives until all vehicles are there; an error says who got stuck where.
    pub(super) fn drive(&mut self) -> Result<(), String> {
        let most_s = MAX_TIMES * self.wanted_s + 600.0 * self.convoy.step_s();
        self.avoid_what_is_known();
        self.record_all(&[]);
        if let Some(reason) = self.scattered.take() {
            return Err(reason);
        }
        let mut steps_left = MAX_STEPS;
        while !self.convoy.has_arrived() {
            let time_s = self.convoy.time_s();
            if steps_left == 0 {
                return Err(format!(
                    "{} after {time_s:.0} s, the longest drive that is simulated",
                    self.stuck(0)
                ));
            }
            steps_left -= 1;
            if time_s > most_s {
                return Err(format!("{} after {:.0} times the planned duration", self.stuck(0), MAX_TIMES));
            }
            let now = self.start + time_s / self.unit_s;
            let has_changed = self.change_world(time_s, now);
            let others = self.others_from(now);
            let most: Vec<f64> = (0..self.models.len()).map(|index| self.max_speed_mps(index)).collect();
            let Layers { ground: world, air } = &self.world;
            let around = Surroundings { world, air, has_changed, maps: &self.maps, others: &others };
            let before = self.convoy.state(0).position_m;
            let steps = self.convoy.step(&around, self.pace_mps(), &most);
            self.driven_m += distance(&before, &self.convoy.state(0).position_m);
            self.note_extra_meters();
            self.note_passes();
            self.note_clearance();
            self.put_on_map(&steps, now);
            for (vehicle, (event, _)) in steps.iter().enumerate() {
                let is_off = matches!(event, DriveEvent::Blocked { .. } | DriveEvent::OffCorridor { .. });
                if is_off && !self.convoy.is_there(vehicle) {
                    self.reroute(vehicle)?;
                }
            }
            self.record_all(&steps);
        }
        self.arrived_m = Some((self.convoy.time_s(), self.driven_m - self.course.drive.path.length_m()));
        Ok(())
    }

    /// Returns what has appeared by now is in the world, and vehicles that stand are where they do. Returns whether it
    /// has changed.
    fn change_world(&mut self, time_s: f64, now: f64) -> bool {
        let mut has_changed = false;
        while let Some((_, obstacle, low)) = self.coming.pop_if(|(at_s, ..)| *at_s <= time_s) {
            if low {
                self.still.ground.add_low(&obstacle);
            } else {
                self.still.ground.add(&obstacle);
            }
            has_changed = true;
        }
        let standing: Vec<_> = self.neighbors.iter().map(|neighbor| neighbor.standing_m(now)).collect();
        has_changed |= standing != self.standing;
        if has_changed {
            self.world = self.still.clone();
            for (neighbor, center_m) in self.neighbors.iter().zip(&standing) {
                let Some(center_m) = *center_m else { continue };
                let standing = Obstacle::Circle { center_m, radius_m: neighbor.radius_m };
                self.world.of_mut(neighbor.flies).add(&standing);
            }
            self.standing = standing;
        }
        has_changed
    }

    /// Returns where others that move are now and will be soon. What is far away does not count.
    fn others_from(&self, now: f64) -> Vec<OtherVehicle> {
        let here_m = self.convoy.state(0).position_m;
        let other = |neighbor: &Neighbor<'_>| {
            if neighbor.standing_m(now).is_some() {
                return None;
            }
            let place = |second: u32| neighbor.place_m(now + f64::from(second) / self.unit_s);
            let is_near = distance(&place(0), &here_m) < NEAR_M;
            let seconds = if is_near { FORESEEN_S } else { 0 };
            Some(OtherVehicle {
                places_m: (0..=seconds).map(place).collect(),
                radius_m: neighbor.radius_m,
                flies: neighbor.flies,
            })
        };
        self.neighbors.iter().filter_map(other).collect()
    }

    /// What the leader drives beyond its path counts soon after it is driven.
    fn note_extra_meters(&mut self) {
        let extra_m = self.driven_m - self.course.drive.path.length_m();
        let known_m = self.extra_meters.last().map_or(0.0, |&(_, meters)| meters);
        if extra_m >= known_m + COUNTED_M {
            self.extra_meters.push((self.convoy.time_s(), extra_m));
        }
    }

    /// The speed at which the leader is there when the traverse is to end, within the traverse's speeds.
    fn pace_mps(&self) -> f64 {
        let early_s = EARLY_S.min(MAX_EARLY_SHARE * self.wanted_s).max(EARLY_SHARE * self.wanted_s);
        let left_s = self.wanted_s - early_s - self.convoy.time_s();
        let [least, greatest] = self.speeds_mps;
        if left_s <= self.convoy.step_s() {
            return greatest;
        }
        (self.convoy.remaining_m() / left_s).clamp(least, greatest)
    }

    /// Returns how fast a vehicle can be where it is: by the traverse, its slope, and what slows it down.
    fn max_speed_mps(&self, index: usize) -> f64 {
        let state = self.convoy.state(index);
        let gradient = self.map.gradient_at(state.position_m).unwrap_or_default();
        let grade = gradient.dot(&(state.world_from_body() * Vector2::x()));
        let model = self.models[index];
        // Followers may catch up.
        let share = if index == 0 { 1.0 } else { 1.25 };
        let time_s = self.convoy.time_s();
        let factor = (self.slow.iter())
            .filter(|(vehicle, _, [from, until])| *vehicle == index && (*from..*until).contains(&time_s))
            .map(|&(_, factor, _)| factor)
            .fold(1.0, f64::min);
        (share * self.speeds_mps[1]).min(model.speed_on_grade_mps(grade)) * factor
    }

    /// Looks for another way for a vehicle that can't continue: around what it has seen, to the end of its leg.
    fn reroute(&mut self, vehicle: usize) -> Result<(), String> {
        self.reroutes += 1;
        let stuck = self.stuck(vehicle);
        let Some(driver) = self.convoy.driver(vehicle).filter(|_| self.reroutes <= MAX_REROUTES) else {
            return Err(stuck);
        };
        let here = driver.state().position_m;
        let model = self.models[vehicle];
        // A way on which it got no farther is closed to it.
        let is_same = |before: &Point2<f64>| distance(before, &here) <= SAME_PLACE_M;
        if self.blocked_m[vehicle].replace(here).as_ref().is_some_and(is_same) {
            let ahead = driver.path().point_at(driver.progress_m() + CLOSED_AHEAD_M);
            self.closed_m[vehicle].extend(ahead.map(|(place, _)| place));
        }
        let map = self.course.drive.space.occupancy();
        let seen_on = |mut map: Occupancy| {
            mark(&mut map, driver.seen_m(), 0.0);
            map
        };
        let occupancy = seen_on(map.clone());
        let remaining_m = driver.length_m() - driver.progress_m();
        let (path, ends_m) = (driver.path().clone(), &self.leg_ends_m);
        let total_m = ends_m.last().copied().unwrap_or(0.0);
        let reach_m = model.circumradius_m + model.margin_m + BESIDE_M;
        let is_taken = |place: Point2<f64>| driver.seen_m().any(|point| distance(&point, &place) <= reach_m);
        // The end of the leg under way, or for a follower a place on its way not far ahead, so that it stays with the others.
        let mut rests_m: Vec<f64> = if vehicle == 0 {
            let rests_m = ends_m.iter().map(|end_m| total_m - end_m);
            rests_m.filter(|it| *it < remaining_m - 1.0).take(1).collect()
        } else {
            // A way that led it around something is not its own. Where it does not get back from there, it tries farther on.
            let (rejoins_m, tries) = match self.led_around[vehicle] {
                Some(led) if led.rejoins_m < remaining_m => (led.rejoins_m, led.tries),
                _ => (remaining_m, 0),
            };
            self.led_around[vehicle] = Some(LedAround { rejoins_m, tries: tries + 1 });
            let ahead_m = REJOINING_M.into_iter().cycle().skip(tries % REJOINING_M.len());
            let rests_m = ahead_m.take(REJOINING_M.len()).map(|ahead_m| rejoins_m - ahead_m);
            rests_m.filter(|it| *it > 1.0).collect()
        };
        if vehicle > 0 || rests_m.is_empty() {
            rests_m.push(0.0);
        }
        let Some(&end_m) = path.points_m.last() else { return Err(stuck) };
        // Where something that the map does not show leaves no room at the end of its way, it stays beside that.
        if rests_m == [0.0] && is_taken(end_m) && distance(&here, &end_m) <= STAYS_WITHIN_M {
            self.convoy.stay(vehicle);
            return Ok(());
        }
        // What others have seen counts while it leaves a way: whole cells are taken for what fills a part of them.
        let mut shared = occupancy.clone();
        mark(&mut shared, self.known.iter().copied(), 0.0);
        mark(&mut shared, self.closed_m[vehicle].iter().copied(), CLOSED_M);
        let rooms_m = [0.3, model.margin_m, 0.0];
        let maps = self.apart_from_others(&shared).into_iter().chain([shared]);
        let space = |map| LazyCell::new(move || ConfigurationSpace::new(map, model.circumradius_m));
        let shared: Vec<_> = maps.map(space).collect();
        let own = [space(occupancy)];
        let found = rests_m.into_iter().find_map(|rest_m| {
            let after = rest_of(&path, path.length_m() - rest_m);
            let &goal_m =
                after.first().filter(|place| rest_m <= 0.0 || vehicle == 0 || !is_taken(**place))?;
            let way = |spaces: &[_]| {
                let gets_past = |to| gets_past(driver.seen_m(), [here, to], model.circumradius_m);
                way_between(spaces, &rooms_m, [here, goal_m], gets_past, &model, self.reroutes)
            };
            // Whole cells may close a way that is wide enough.
            let finer = || {
                let parts = (map.frame().cell_size_m / FINER_M).ceil() as u32;
                let across_m = distance(&here, &goal_m) + 2.0 * BESIDE_FINER_M;
                let is_wanted = parts > 1 && across_m <= MAX_FINER_M;
                let map = is_wanted.then(|| map.around(nalgebra::center(&here, &goal_m), across_m, parts))?;
                way(&[space(seen_on(map))])
            };
            Some((way(&shared).or_else(|| way(&own)).or_else(finer)?, after))
        });
        let Some((mut way, after)) = found else { return Err(stuck) };
        let length_m = way.length_m();
        if let Some(led) = &mut self.led_around[vehicle] {
            led.rejoins_m = motion::length_m(&after);
        }
        way.points_m.extend(after.into_iter().skip(1));
        let name = self.names[vehicle];
        self.entries.push((
            self.convoy.time_s(),
            format!(
                "{name} is blocked near ({:.0}, {:.0}) and takes another path of {length_m:.0} m",
                here.x, here.y
            ),
        ));
        self.send(vehicle, way);
        self.convoy.make_room(vehicle);
        Ok(())
    }

    /// The map with the ways of others as obstacles; `None` if there are none.
    fn apart_from_others(&self, occupancy: &Occupancy) -> Option<Occupancy> {
        if self.lanes.is_empty() {
            return None;
        }
        let mut occupancy = occupancy.clone();
        for Lane { path, radius_m } in self.lanes {
            let length_m = path.length_m();
            let steps = (length_m / LANE_STEP_M).ceil() as u32;
            let place = |step| path.point_at((f64::from(step) * LANE_STEP_M).min(length_m));
            mark(&mut occupancy, (0..=steps).filter_map(place).map(|(place, _)| place), radius_m + BESIDE_M);
        }
        Some(occupancy)
    }

    /// Sends a vehicle along another way, and the others after the leader.
    fn send(&mut self, vehicle: usize, way: Path) {
        if vehicle == 0 {
            for follower in 1..self.models.len() {
                let own = self.convoy.state(follower).position_m;
                let short_m = self.course.drive.spacing_m * follower as f64;
                let mut points = vec![own];
                points.extend(until(&way, way.length_m() - short_m));
                self.led_around[follower] = None;
                self.convoy.follow(follower, Path::new(points));
            }
        }
        self.convoy.follow(vehicle, way);
    }

    /// A way that was planned without what vehicles have seen since leads around it.
    fn avoid_what_is_known(&mut self) {
        let (Some(driver), Some(model)) = (self.convoy.driver(0), self.models.first()) else { return };
        let (path, reach) = (driver.path().clone(), model.circumradius_m);
        if self.known.is_empty() || !is_blocked(&path.points_m, &self.known, reach) {
            return;
        }
        let mut occupancy = self.course.drive.space.occupancy().clone();
        mark(&mut occupancy, self.known.iter().copied(), 0.0);
        let maps = self.apart_from_others(&occupancy).into_iter().chain([occupancy]);
        let spaces: Vec<_> =
            maps.map(|map| Box::new(ConfigurationSpace::new(map, model.radius_m()))).collect();
        let (mut points, mut ends_m, mut from_m) = (Vec::new(), Vec::new(), 0.0);
        let mut is_new = false;
        let length_m = path.length_m();
        let legs = self.leg_ends_m.len();
        for (leg, &end_m) in self.leg_ends_m.iter().enumerate() {
            let end_m = if leg + 1 == legs { length_m } else { end_m };
            let before = Path::new(until(&path, end_m));
            let mut piece = rest_of(&before, from_m);
            let past_known = |to| {
                piece.first().is_none_or(|&from| gets_past(self.known.iter().copied(), [from, to], reach))
            };
            if let (true, Some(&start_m), Some(&goal_m)) =
                (is_blocked(&piece, &self.known, reach), piece.first(), piece.last())
                && let Some(way) = way_between(&spaces, &[0.0, 0.1], [start_m, goal_m], past_known, model, 0)
            {
                piece = way.points_m;
                is_new = true;
            }
            points.extend(piece.into_iter().skip(usize::from(!points.is_empty())));
            ends_m.push(Path::new(points.clone()).length_m());
            from_m = end_m;
        }
        if !is_new || points.len() < 2 {
            return;
        }
        let way = Path::new(points);
        let text = format!(
            "{} takes another path of {:.0} m, around an obstacle that was seen before",
            self.names[0],
            way.length_m()
        );
        self.entries.push((0.0, text));
        self.leg_ends_m = ends_m;
        self.send(0, way);
    }

    /// What range finders see and sonars hear that the map does not show continues the map that all share.
    fn put_on_map(&mut self, steps: &[(DriveEvent, RangeScan)], now: f64) {
        let space = &self.course.drive.space;
        for (_, scan) in steps {
            for point in scan.points_m() {
                let away_m = space.clearance_m(point).map(|clearance| clearance + space.radius_m());
                let is_vehicle = self.neighbors.iter().zip(&self.standing).any(|(neighbor, place)| {
                    place.is_some_and(|place| distance(&place, &point) <= neighbor.radius_m + KNOWN_M)
                });
                if away_m.is_some_and(|away_m| away_m > KNOWN_M) && !is_vehicle {
                    self.seen.add(point, now);
                }
            }
        }
        for vehicle in 0..self.models.len() {
            let Some(driver) = self.convoy.driver(vehicle) else { continue };
            let here = driver.state().position_m;
            // From afar an arc is much wider than what is heard.
            for point in driver.heard_m().filter(|point| distance(point, &here) <= HEARD_M) {
                self.seen.add(point, now);
            }
        }
    }

    fn stuck(&self, vehicle: usize) -> String {
        let here = self.convoy.state(vehicle).position_m;
        format!("{} finds no path near ({:.0}, {:.0})", self.names[vehicle], here.x, here.y)
    }

    fn note_passes(&mut self) {
        let remaining_m = self.convoy.remaining_m();
        while let Some(&(rest_m, event)) = self.vertices.first().filter(|(rest_m, _)| remaining_m <= *rest_m)
        {
            let _ = rest_m;
            self.passes.push((event, self.convoy.time_s()));
            self.vertices.remove(0);
        }
    }

    fn note_clearance(&mut self) {
        for (index, (model, flies)) in self.models.iter().zip(&self.flies).enumerate() {
            let place = self.convoy.state(index).position_m;
            let away_m = self.world.of(*flies).around(place, 12.0).distance_m(place) - model.circumradius_m;
            self.min_clearance_m = self.min_clearance_m.min(away_m);
        }
    }

    /// Returns whether others are so near a vehicle that contact is told by every step.
    fn is_close_to_others(&self, vehicle: usize) -> bool {
        let own_m = self.models[vehicle].circumradius_m + CLOSE_M;
        let here = self.convoy.state(vehicle).position_m;
        let now = self.start + self.convoy.time_s() / self.unit_s;
        let mut members = self.models.iter().enumerate().filter(|(index, _)| *index != vehicle);
        members.any(|(index, model)| {
            distance(&self.convoy.state(index).position_m, &here) <= own_m + model.circumradius_m
        }) || self
            .neighbors
            .iter()
            .any(|neighbor| distance(&neighbor.place_m(now), &here) <= own_m + neighbor.radius_m)
    }

    /// Keeps a frame of each vehicle that has moved or turned since its last one, set out or stopped, or is close to others.
    fn record_all(&mut self, steps: &[(DriveEvent, RangeScan)]) {
        let is_over = self.convoy.has_arrived();
        for index in 0..self.models.len() {
            let Some(driver) = self.convoy.driver(index) else { continue };
            let state = driver.state();
            self.steps_since_frame[index] += 1;
            let last = self.frames[index].last();
            let is_due = last.is_none_or(|last| {
                let turned = motion::heading_difference(last.heading_rad, state.heading_rad).abs();
                distance(&last.position_m, &state.position_m) >= FRAME_M
                    || turned >= FRAME_RAD
                    || (last.speed_mps > 0.0) != (state.speed_mps > 0.0)
                    || self.steps_since_frame[index] >= FRAME_STEPS
            }) || (state.speed_mps > 0.0 && self.is_close_to_others(index));
            if !is_due && !is_over {
                continue;
            }
            let single = |point_m: Point2<f64>| point_m.map(|meters| meters as f32);
            self.steps_since_frame[index] = 0;
            let frame = DriveFrame {
                time: self.start + self.convoy.time_s() / self.unit_s,
                position_m: state.position_m,
                heading_rad: state.heading_rad,
                speed_mps: state.speed_mps,
                rays_m: steps
                    .get(index)
                    .map(|(_, scan)| scan.points_m().map(single).collect())
                    .unwrap_or_default(),
                plan_m: driver.plan_m(SHOWN_PLAN_M).into_iter().map(single).collect(),
            };
            self.frames[index].push(frame);
        }
    }
}

/// Puts round obstacles on a map.
fn mark(map: &mut Occupancy, centers_m: impl IntoIterator<Item = Point2<f64>>, radius_m: f64) {
    for center_m in centers_m {
        map.mark(&Obstacle::Circle { center_m, radius_m }, CellState::Obstacle);
    }
}

/// A way from a place to another one on the first of some maps that has one, with the first of some rooms around the vehicle that
/// leaves one; on a later map or with less room where that saves a long way around. It starts at the nearest free place that
/// is reached straight.
fn way_between<Space: Deref<Target = ConfigurationSpace>>(
    spaces: &[Space],
    rooms_m: &[f64],
    [here, goal_m]: [Point2<f64>; 2],
    is_reached: impl Fn(Point2<f64>) -> bool,
    model: &VehicleModel,
    seed: u32,
) -> Option<Path> {
    let long_m = distance(&here, &goal_m) + LONG_M;
    let mut best: Option<Path> = None;
    for (space, room_m) in spaces.iter().flat_map(|space| rooms_m.iter().map(move |room_m| (space, room_m))) {
        if best.as_ref().is_some_and(|best| best.length_m() <= long_m) {
            break;
        }
        let space = space.with_radius_m(model.circumradius_m + room_m);
        if let Some(way) = way_within(&space, [here, goal_m], &is_reached, seed)
            && best.as_ref().is_none_or(|best| way.length_m() + SAVED_M < best.length_m())
        {
            best = Some(way);
        }
    }
    best
}

/// A way in the free places of a vehicle, which starts at the nearest one that is reached and leads on, and ends at the one
/// nearest to the goal.
fn way_within(
    space: &ConfigurationSpace,
    [here, goal_m]: [Point2<f64>; 2],
    is_reached: impl Fn(Point2<f64>) -> bool,
    seed: u32,
) -> Option<Path> {
    let settings = motion::Settings {
        seed: u64::from(seed),
        max_samples: MAX_SAMPLES,
        ..motion::Settings::of(PlannerKind::RrtConnect)
    };
    // What was seen near the goal fills whole cells as well.
    let end_m = nearest_free(|place| space.is_free(place), goal_m)?;
    let mut tried_m: Vec<Point2<f64>> = Vec::new();
    let (start_m, mut way) = (0..STARTS).find_map(|_| {
        // Cells that are taken for what was seen may leave free places that lead nowhere.
        let is_new = |place| tried_m.iter().all(|tried| distance(tried, &place) >= STARTS_APART_M);
        let leads_on = |place| {
            is_new(place) && space.is_free(place) && !space.are_separated(place, end_m) && is_reached(place)
        };
        let start_m = nearest_free(leads_on, here)?;
        tried_m.push(start_m);
        let query = Query { start_m, goal_m: end_m };
        let shortcut = ShortcutSettings::default();
        let found = motion::find_shortest_path(space, query, &settings, &shortcut, 3, &mut |_| false);
        let bound_m = BOUND_SHARE * distance(&start_m, &end_m) + BOUND_M;
        let way = found.path.ok().or_else(|| motion::way_over_cells(space, [start_m, end_m], bound_m))?;
        Some((start_m, way))
    })?;
    if start_m != here {
        way.points_m.insert(0, here);
    }
    if end_m != goal_m {
        way.points_m.push(goal_m);
    }
    Some(way)
}

/// The time that a traverse is to take, in mission units: what the environment chose of its range, or otherwise that of
/// its plan's earliest schedule, as far as its own bounds say.
fn wanted_units(network: &Network, occurrence: OccurrenceId, chosen: &BTreeMap<SmolStr, Time>) -> f64 {
    let described = &network.occurrences[occurrence.index()];
    let own = described.arc.map(|arc| {
        let (lower, upper) = (network.arcs[arc.index()].lower, network.arcs[arc.index()].upper.finite());
        let natures = chosen.get(&described.name).filter(|_| network.is_uncertain(arc));
        natures.zip(upper).map_or(lower, |(&chosen, upper)| chosen.min(upper).max(lower))
    });
    let path = network
        .arcs
        .iter()
        .filter(|arc| arc.kind == ArcKind::Path && arc.occurrence == Some(occurrence))
        .map(|arc| arc.lower);
    own.into_iter().chain(Time::checked_sum(path)).max().unwrap_or_default().to_f64()
}
