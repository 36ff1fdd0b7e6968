//! A vehicle in simulation: it follows its path and avoids what it meets (SPEC 7.4).
//!
//! Every tenth of a second, or every tenth of a meter when its pace is slow, it sweeps its range sensor and aims at a point ahead on the path (pure pursuit, Coulter 1992), or, when
//! something stands between, along a detour around what it has seen (`detour`). It picks the speed and turning rate that
//! serve this best among those it can reach and from which it can still stop in front of everything it has seen (dynamic
//! window, Fox, Burgard and Thrun 1997).

use nalgebra::{Point2, UnitComplex, Vector2, distance, distance_squared};
use serde::{Deserialize, Serialize};
use terrain::{ConfigurationSpace, Random, Rock, Terrain};

use crate::detour::{SeenPoints, find_detour, nearest_along};
use crate::fine_world::FineWorld;
use crate::path::{Path, between};
use crate::range_sensor::{RangeScan, RangeSensor};
use crate::sonar::SonarArray;
use crate::trajectory::{DriveLimits, MotionState, Trajectory, heading_difference};

/// How a vehicle drives by itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DriverSettings {
    /// What the vehicle can do.
    pub limits: DriveLimits,
    /// The speed it aims at, in meters per second.
    pub cruise_mps: f64,
    /// The disc that must not touch anything, in meters: the circumradius.
    pub radius_m: f64,
    /// What it keeps free around that disc for errors of its range sensor, in meters.
    pub margin_m: f64,
    /// How far ahead on the path it aims, in meters.
    pub lookahead_m: f64,
    /// How far it may stray from the path before it reports, in meters.
    pub corridor_m: f64,
    /// How long it may make no way at least before it reports, in seconds.
    pub blocked_timeout_s: f64,
    /// How far it must have been told to drive meanwhile, in meters: a vehicle with a slow pace has more patience.
    pub blocked_way_m: f64,
    /// Within this distance of the path's end it has arrived, in meters.
    pub arrival_m: f64,
    /// The time between two decisions, in seconds.
    pub step_s: f64,
    /// Its range finder.
    pub sensor: RangeSensor,
    pub sonars: SonarArray,
}

impl DriverSettings {
    /// For a vehicle with these limits and circumradius, at its greatest speed.
    pub const fn new(limits: DriveLimits, radius_m: f64) -> Self {
        Self {
            limits,
            cruise_mps: limits.speed_mps,
            radius_m,
            margin_m: 0.08,
            lookahead_m: 1.6,
            corridor_m: 5.0,
            blocked_timeout_s: 15.0,
            blocked_way_m: 10.0,
            arrival_m: 0.2,
            step_s: STEP_S,
            sensor: RangeSensor::SICK,
            sonars: SonarArray::POLAROID,
        }
    }

    /// The same for a vehicle that drives at most this fast: a slow one decides less often, at every tenth of a meter.
    pub fn at_most(self, speed_mps: f64) -> Self {
        Self { cruise_mps: speed_mps.min(self.limits.speed_mps), step_s: step_s(speed_mps), ..self }
    }
}

/// What one step of driving came to.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum DriveEvent {
    Driving,
    /// At the path's end.
    Arrived,
    /// It has made no way for the timeout, though told to drive: something blocks the path. Replan from here.
    Blocked {
        /// Seconds without way.
        seconds: f64,
    },
    /// It had to go too far from its path. Replan from here.
    OffCorridor {
        /// Meters from the path.
        deviation_m: f64,
    },
}

/// A vehicle that drives along a path.
#[derive(Clone, Debug)]
pub struct Driver {
    settings: DriverSettings,
    path: Path,
    length_m: f64,
    state: MotionState,
    time_s: f64,
    /// How far along the path it is.
    progress_m: f64,
    /// When it last made way, and how far it was.
    last_way: (f64, f64),
    /// How far it has been told to drive since, in meters.
    commanded_m: f64,
    seen: SeenPoints,
    /// The way around what stands in front, while something does.
    detour: Option<Path>,
    /// When a detour is looked for again after none was found.
    no_detour_until_s: f64,
    random: Random,
    /// Sonars have noise of their own.
    sonar_random: Random,
}

const STEP_S: f64 = Trajectory::STEP_S;
/// How far along a detour it looks for a place to aim at, in meters, farthest first.
const DETOUR_SIGHTS_M: [f64; 6] = [1.1, 0.9, 0.7, 0.5, 0.4, 0.3];
/// Steps for which no detour is looked for after none was found.
const DETOUR_PAUSE_STEPS: f64 = 8.0;
/// The way of a creeping vehicle between two decisions, in meters.
const STEP_M: f64 = 0.08;
/// The longest time between two decisions, in seconds.
const MAX_STEP_S: f64 = 20.0;
/// What a driver drives more and less than its path, as a share of it and in meters.
const MORE_SHARE: f64 = 0.04;
const MORE_M: f64 = 1.5;
const MORE_FOR_FOLLOWER_M: f64 = 2.0;
const DETOUR_M: f64 = 30.0;
const DETOUR_AMONG_MANY_M: f64 = 60.0;
const DETOUR_FOR_FOLLOWER_M: f64 = 5.0;
/// What it needs more time than its path, as a share of it, in seconds, and in meters that it could have driven meanwhile.
const LONGER_SHARE: f64 = 0.06;
const LONGER_S: f64 = 20.0;
const LONGER_FOR_FOLLOWER_M: f64 = 10.0;
const AROUND_ROCKS_M: f64 = 40.0;
const AROUND_MANY_ROCKS_M: f64 = 90.0;
/// Where rocks cover this share of the ground altogether, many are not on the map.
const MANY_ROCKS: f64 = 0.075;
const LESS_SHARE: f64 = 0.01;
const LESS_M: f64 = 2.5;
const LESS_FOR_FOLLOWER_M: f64 = 1.5;
const LESS_AROUND_ROCKS_M: f64 = 5.0;
/// The share of its margin that a vehicle keeps from what it is too near already.
const CLOSE_SHARE: f64 = 0.25;
/// The greatest turn between two decisions, in radians.
const STEP_TURN_RAD: f64 = 0.2;

/// How many rocks a vehicle may meet that its map does not show.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub enum HiddenRocks {
    None,
    Some,
    Many,
}

impl HiddenRocks {
    /// Those of a map, by what it shows of larger ones: sizes of rocks follow one distribution (Golombek and Rapp 1997).
    pub fn on(map: &Terrain) -> Self {
        let shown = terrain::cumulative_rock_area(MANY_ROCKS, Rock::MAPPED_DIAMETER_M);
        if map.mapped_rock_share() > shown { Self::Many } else { Self::Some }
    }

    const fn detour_m(self, followers: f64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Some => DETOUR_M + DETOUR_FOR_FOLLOWER_M * followers,
            Self::Many => DETOUR_AMONG_MANY_M + DETOUR_FOR_FOLLOWER_M * followers,
        }
    }

    const fn around_m(self, followers: f64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Some => AROUND_ROCKS_M * (1.0 + followers),
            Self::Many => AROUND_MANY_ROCKS_M * (1.0 + followers),
        }
    }

    const fn less_m(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Some | Self::Many => LESS_AROUND_ROCKS_M,
        }
    }
}

/// Returns how far the leader of some followers drives at most along a path of some meters where nothing disturbs it:
/// it goes around its followers where it turns back, and around rocks that the map does not show. Measured: see
/// `crates/mission/tests/it/margins.rs`, which holds it over random missions.
pub fn driven_at_most_m(length_m: f64, followers: usize, rocks: HiddenRocks) -> f64 {
    if length_m > 0.0 {
        let followers = followers as f64;
        let rocks_m = rocks.detour_m(followers);
        length_m * (1.0 + MORE_SHARE) + MORE_M + MORE_FOR_FOLLOWER_M * followers + rocks_m
    } else {
        0.0
    }
}

/// Returns how long a drive takes at most that takes some seconds at least by its path, in seconds: it turns before it
/// sets out and at corners, and goes around what the map does not show; followers have to sort themselves out.
/// `speed_mps` is the greatest speed of the traverse. Measured in the same way.
pub fn driven_within_s(min_s: f64, speed_mps: f64, followers: usize, rocks: HiddenRocks) -> f64 {
    if min_s > 0.0 {
        let followers = followers as f64;
        let rocks_m = rocks.around_m(followers);
        min_s * (1.0 + LONGER_SHARE) + LONGER_S + (LONGER_FOR_FOLLOWER_M * followers + rocks_m) / speed_mps
    } else {
        0.0
    }
}

/// Returns how far it drives at least: it cuts corners, and has arrived a little before the path's end, or as near to
/// it as its followers leave it room; the way around rocks may be shorter than the path. Measured in the same way.
pub fn min_driven_m(length_m: f64, followers: usize, rocks: HiddenRocks) -> f64 {
    let less_m = LESS_M + LESS_FOR_FOLLOWER_M * followers as f64 + rocks.less_m();
    (length_m * (1.0 - LESS_SHARE) - less_m).max(0.0)
}

/// The time between two decisions of a vehicle that drives at most this fast, in seconds.
pub(crate) fn step_s(speed_mps: f64) -> f64 {
    (STEP_M / speed_mps).clamp(STEP_S, MAX_STEP_S)
}

impl Driver {
    /// A vehicle at rest at the start of a path.
    pub fn new(path: Path, heading_rad: f64, settings: DriverSettings, seed: u64) -> Self {
        let start = path.points_m.first().copied().unwrap_or_default();
        Self {
            settings,
            length_m: path.length_m(),
            path,
            state: MotionState::at_rest(start, heading_rad),
            time_s: 0.0,
            progress_m: 0.0,
            last_way: (0.0, 0.0),
            commanded_m: 0.0,
            seen: SeenPoints::default(),
            detour: None,
            no_detour_until_s: 0.0,
            random: Random::from_seed(seed),
            sonar_random: Random::from_seed(!seed),
        }
    }

    /// Returns where it is and how it moves.
    pub const fn state(&self) -> MotionState {
        self.state
    }

    /// Seconds driven.
    pub const fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Meters along the path that it has come.
    pub const fn progress_m(&self) -> f64 {
        self.progress_m
    }

    /// The length of the path in meters.
    pub const fn length_m(&self) -> f64 {
        self.length_m
    }

    /// The path that it follows.
    pub const fn path(&self) -> &Path {
        &self.path
    }

    /// Returns how it drives.
    pub const fn settings(&self) -> &DriverSettings {
        &self.settings
    }

    /// Returns what it has seen around it and still remembers, in meters.
    pub fn seen_m(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.seen.points_m()
    }

    /// Returns what its sonars have heard that its range finder cannot see, in meters.
    pub fn heard_m(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.seen.heard_m()
    }

    /// Returns where it means to drive next, in meters: along a detour while something stands in the way, otherwise
    /// along its path, for at most `length_m`.
    pub fn plan_m(&self, length_m: f64) -> Vec<Point2<f64>> {
        let (path, from_m) = match &self.detour {
            Some(detour) => (detour, nearest_along(detour, self.state.position_m, 0.0, detour.length_m()).0),
            None => (&self.path, self.progress_m),
        };
        let mut points = vec![self.state.position_m];
        let Some((_, first)) = path.point_at(from_m) else { return points };
        let mut along_m = 0.0;
        for (index, (a, b)) in path.segments().enumerate() {
            let start_m = along_m;
            along_m += distance(&a, &b);
            if index < first {
                continue;
            }
            if along_m >= from_m + length_m {
                let share = ((from_m + length_m - start_m) / (along_m - start_m)).clamp(0.0, 1.0);
                points.push(between(a, b, share));
                break;
            }
            points.push(b);
        }
        points
    }

    /// Returns where it is, and then every so many meters until it stands if it brakes now, in meters.
    pub(crate) fn braking_m(&self, step_m: f64) -> Vec<Point2<f64>> {
        let mut places = vec![self.state.position_m];
        let (mut state, mut last_m) = (self.state, self.state.position_m);
        loop {
            let next = state.after(0.0, state.turn_rate_rps, STEP_S, &self.settings.limits);
            if next.speed_mps >= state.speed_mps {
                return places;
            }
            state = next;
            if state.speed_mps <= 0.0 || distance(&last_m, &state.position_m) >= step_m {
                last_m = state.position_m;
                places.push(last_m);
            }
        }
    }

    /// Changes the speed that it aims at, in meters per second. Standing on command is not being blocked, and the time that
    /// it takes does not count.
    pub const fn set_cruise(&mut self, speed_mps: f64) {
        self.settings.cruise_mps = speed_mps;
    }

    /// Changes the time between two decisions, in seconds.
    pub(crate) const fn set_step(&mut self, step_s: f64) {
        self.settings.step_s = step_s;
    }

    /// Sets the vehicles that it drives around, as place and radius in meters; they replace the previous ones.
    pub fn set_vehicles(&mut self, vehicles: &[(Point2<f64>, f64)]) {
        self.seen.set_vehicles(vehicles);
    }

    /// Continues along another path from where it is, at its speed: after a report.
    pub fn follow(&mut self, path: Path) {
        self.length_m = path.length_m();
        self.path = path;
        self.progress_m = 0.0;
        self.last_way = (self.time_s, 0.0);
        self.commanded_m = 0.0;
        self.detour = None;
    }

    /// Drives for one step, and returns what came of it with the sweep it was based on. Besides what the
    /// sensor sees, `map` keeps the vehicle off steep ground; its radius should be the circumradius.
    pub fn step(&mut self, world: &FineWorld, map: Option<&ConfigurationSpace>) -> (DriveEvent, RangeScan) {
        let scan =
            self.settings.sensor.scan(world, self.state.position_m, self.state.heading_rad, &mut self.random);
        self.seen.add(&scan);
        // Where nothing is low, sonars hear nothing that the range finder does not see.
        if world.has_low() || self.seen.heard_m().next().is_some() {
            let (place, heading) = (self.state.position_m, self.state.heading_rad);
            let echoes = self.settings.sonars.sweep(world, place, heading, &mut self.sonar_random);
            self.seen.hear(&self.settings.sonars, &echoes, &scan);
        }
        let remaining = (self.length_m - self.progress_m).max(0.0);
        let target = self.aim(map);
        let (speed, rate) = self.choose(target, remaining, map);
        // Speed and turning rate change within a moment, however long they are then kept.
        let moments = (self.settings.step_s / STEP_S).round().max(1.0);
        for _ in 0..moments as u32 {
            self.state = self.state.after(speed, rate, self.settings.step_s / moments, &self.settings.limits);
        }
        self.time_s += self.settings.step_s;
        if self.settings.cruise_mps <= 0.0 {
            self.last_way.0 += self.settings.step_s;
        }
        self.commanded_m += self.settings.cruise_mps * self.settings.step_s;
        (self.judge(), scan)
    }

    /// Returns where to drive to: a lookahead ahead on the path, or on the detour when something stands in the way
    /// there.
    fn aim(&mut self, map: Option<&ConfigurationSpace>) -> Point2<f64> {
        let here = self.state.position_m;
        let settings = &self.settings;
        let ahead = |path: &Path, along_m: f64| path.point_at(along_m + settings.lookahead_m).map(|it| it.0);
        let target = ahead(&self.path, self.progress_m).unwrap_or(here);
        let reach = settings.radius_m + settings.margin_m;
        let is_free = |place| map.is_none_or(|map| !map.is_free(here) || map.is_segment_free(here, place));
        if self.seen.is_open(here, target, reach + 0.5 * settings.margin_m) && is_free(target) {
            self.detour = None;
            return target;
        }
        // A little room for following the detour inexactly.
        let surroundings = self.seen.surroundings(here, reach + 0.5 * settings.margin_m, map);
        let kept = self.detour.take().filter(|detour| {
            let (along, away) = nearest_along(detour, here, 0.0, detour.length_m());
            let segment = detour.point_at(along).map_or(0, |(_, segment)| segment);
            let rest = detour.points_m.get(segment + 1..).unwrap_or_default();
            let start = Some(here).filter(|&here| surroundings.is_free(here));
            let ahead: Vec<Point2<f64>> = start.into_iter().chain(rest.iter().copied()).collect();
            away < 0.5 && detour.length_m() - along > 0.3 && Path::new(ahead).is_free(&surroundings)
        });
        // Looking for a way where there was none a moment ago is of little use, and costs the most of all.
        self.detour = kept;
        if self.detour.is_none() && self.time_s >= self.no_detour_until_s {
            self.detour = find_detour(&surroundings, here, &self.path, self.progress_m);
            if self.detour.is_none() {
                self.no_detour_until_s = self.time_s + DETOUR_PAUSE_STEPS * settings.step_s;
            }
        }
        // As far along the detour as the way there is straight and open: cutting its corners would lead too near.
        let Some(detour) = &self.detour else { return target };
        let (along, _) = nearest_along(detour, here, 0.0, detour.length_m());
        let place = |ahead_m: f64| detour.point_at(along + ahead_m).map(|(place, _)| place);
        let in_sight = DETOUR_SIGHTS_M.iter().filter_map(|&ahead_m| place(ahead_m)).find(|&place| {
            self.seen.is_open(here, place, reach + 0.25 * settings.margin_m) && is_free(place)
        });
        in_sight.or_else(|| place(0.25)).unwrap_or(target)
    }

    /// The reachable speed and turning rate that bring it best toward the target and still let it stop.
    fn choose(&self, target: Point2<f64>, remaining_m: f64, map: Option<&ConfigurationSpace>) -> (f64, f64) {
        const SPEEDS: u32 = 6;
        const RATES: u32 = 14;
        let limits = &self.settings.limits;
        let step_s = self.settings.step_s;
        let (slowing, turning) = (limits.acceleration_mps2 * step_s, limits.turn_acceleration_rps2 * step_s);
        let brake_for_end = (2.0 * limits.acceleration_mps2 * remaining_m).sqrt().max(0.05);
        let slowest = (self.state.speed_mps - slowing).max(0.0);
        let fastest = (self.state.speed_mps + slowing)
            .min(self.settings.cruise_mps)
            .min(brake_for_end)
            .min(limits.speed_mps)
            .max(slowest);
        let sharpest = limits.turn_rate_rps.min(STEP_TURN_RAD / step_s);
        let (rightmost, leftmost) = (
            (self.state.turn_rate_rps - turning).clamp(-sharpest, sharpest),
            (self.state.turn_rate_rps + turning).clamp(-sharpest, sharpest),
        );
        let needed_at = |speed: f64| speed * speed / (2.0 * limits.acceleration_mps2) + speed * step_s;
        let horizon = needed_at(fastest) + 1.0 + self.settings.radius_m + self.settings.margin_m;
        let here = self.state.position_m;
        let near: Vec<Point2<f64>> = self
            .seen
            .points_m()
            .filter(|&point| distance_squared(&point, &here) <= horizon * horizon)
            .collect();
        let share = |low: f64, high: f64, index: u32, count: u32| {
            low + (high - low) * f64::from(index) / f64::from(count)
        };
        // Standing and turning to the target is always possible: the vehicle is a disc.
        let bearing = bearing_error(self.state, target);
        let turn = ((0.5 / step_s).min(2.0) * bearing).clamp(rightmost, leftmost);
        let is_open = near.is_empty()
            && map.is_none_or(|map| map.clearance_m(here).is_some_and(|clearance| clearance > horizon));
        let mut best = (self.score(slowest, turn, target, fastest, 0.0), slowest, turn);
        for speed_index in 0..=SPEEDS {
            let speed = share(slowest, fastest, speed_index, SPEEDS);
            for rate_index in 0..=RATES {
                let rate = share(rightmost, leftmost, rate_index, RATES);
                if speed + rate.abs() * limits.half_track_m > limits.speed_mps || speed < 1e-3 {
                    continue;
                }
                let needed = needed_at(speed);
                let free =
                    if is_open { needed + 1.0 } else { self.free_way(speed, rate, needed + 1.0, &near, map) };
                if free <= needed {
                    continue;
                }
                let score = self.score(speed, rate, target, fastest, free.min(1.0));
                if score > best.0 {
                    best = (score, speed, rate);
                }
            }
        }
        (best.1, best.2)
    }

    /// Returns how well a speed and rate serve: facing the target soon, the share of the way that the fastest speed
    /// within reach would make toward it, and a little for room ahead.
    fn score(&self, speed: f64, rate: f64, target: Point2<f64>, fastest: f64, room_m: f64) -> f64 {
        let look_s = (5.0 * self.settings.step_s).max(1.0);
        let mut state = self.state;
        state.speed_mps = speed;
        state.turn_rate_rps = rate;
        let steps = 5;
        for _ in 0..steps {
            state = coast(state, look_s / f64::from(steps));
        }
        let error = bearing_error(state, target).abs() / std::f64::consts::PI;
        let approach = (distance(&self.state.position_m, &target) - distance(&state.position_m, &target))
            / (fastest.max(1e-3) * look_s);
        1.5 * (1.0 - error) + approach + 0.1 * room_m
    }

    /// The length of the way along an arc, in meters, before the vehicle would touch something, up to `most`.
    fn free_way(
        &self,
        speed: f64,
        rate: f64,
        most: f64,
        near: &[Point2<f64>],
        map: Option<&ConfigurationSpace>,
    ) -> f64 {
        const PIECE_M: f64 = 0.06;
        let reach = self.settings.radius_m + self.settings.margin_m;
        let here = self.state.position_m;
        let mut state = MotionState { speed_mps: speed, turn_rate_rps: rate, ..self.state };
        let mut way = 0.0;
        // A vehicle that is nearer to something than its margin may leave it, past it where that does not touch it.
        let least = self.settings.radius_m + CLOSE_SHARE * self.settings.margin_m;
        let room = |before: f64| if before < reach * reach { least } else { reach };
        let mut before: Vec<(f64, f64)> = near
            .iter()
            .map(|&point| distance_squared(&point, &here))
            .map(|squared| (squared, room(squared)))
            .collect();
        while way < most {
            let next = coast(state, PIECE_M / speed);
            let touches = near.iter().zip(&mut before).any(|(&point, (before, room))| {
                let squared = distance_squared(&point, &next.position_m);
                let nearer = squared < *before;
                *before = squared;
                nearer && squared < *room * *room
            });
            let leaves_map = map.is_some_and(|map| {
                map.is_free(state.position_m) && !map.is_segment_free(state.position_m, next.position_m)
            });
            if touches || leaves_map {
                return way;
            }
            way += PIECE_M;
            state = next;
        }
        most
    }

    /// Notes the way made, and says what there is to report.
    fn judge(&mut self) -> DriveEvent {
        let here = self.state.position_m;
        let (progress, deviation_m) =
            nearest_along(&self.path, here, self.progress_m, 2.0 * self.settings.corridor_m);
        self.progress_m = self.progress_m.max(progress);
        let end = self.path.points_m.last().copied().unwrap_or(here);
        let near_end = self.length_m - self.progress_m <= self.settings.lookahead_m;
        if near_end && distance(&here, &end) <= self.settings.arrival_m {
            return DriveEvent::Arrived;
        }
        if deviation_m > self.settings.corridor_m {
            return DriveEvent::OffCorridor { deviation_m };
        }
        let (since, way) = self.last_way;
        if self.progress_m > way + 0.25 {
            self.last_way = (self.time_s, self.progress_m);
            self.commanded_m = 0.0;
        } else if self.time_s - since >= self.settings.blocked_timeout_s
            && self.commanded_m >= self.settings.blocked_way_m
        {
            return DriveEvent::Blocked { seconds: self.time_s - since };
        }
        DriveEvent::Driving
    }
}

/// The state after some time at the same speed and turning rate.
fn coast(state: MotionState, seconds: f64) -> MotionState {
    let heading_rad = state.heading_rad + state.turn_rate_rps * seconds;
    let middle = 0.5 * (state.heading_rad + heading_rad);
    let ahead = state.speed_mps * seconds;
    MotionState {
        position_m: state.position_m + UnitComplex::new(middle) * Vector2::new(ahead, 0.0),
        heading_rad,
        ..state
    }
}

/// The turn that would make a state face a place, in radians.
fn bearing_error(state: MotionState, target: Point2<f64>) -> f64 {
    let offset = target - state.position_m;
    if offset.norm_squared() < 1e-6 {
        return 0.0;
    }
    heading_difference(state.heading_rad, libm::atan2(offset.y, offset.x))
}
