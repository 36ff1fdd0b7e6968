//! Vehicles that drive one behind the other in simulation: each follows its own path and avoids what it meets, the
//! leader keeps a pace, and the others keep up with it without touching each other (SPEC 7.4).

use nalgebra::{Point2, Vector2, distance};
use parry2d_f64::query::PointQuery as _;
use parry2d_f64::shape::Ball;
use terrain::ConfigurationSpace;

use crate::driver::{DriveEvent, Driver, DriverSettings, step_s};
use crate::fine_world::FineWorld;
use crate::path::Path;
use crate::range_sensor::RangeScan;
use crate::trajectory::MotionState;

/// Vehicles under way together; the first leads.
#[derive(Clone, Debug)]
pub struct Convoy {
    members: Vec<Member>,
    spacing_m: f64,
    step_s: f64,
    time_s: f64,
    stall: Stall,
}

/// How far the convoy could have come since it last came farther.
#[derive(Clone, Debug)]
struct Stall {
    /// What all its vehicles together still had to go then, in meters.
    remaining_m: f64,
    /// What its pace would have been since, in meters.
    commanded_m: f64,
    /// How often it stalled there.
    count: usize,
}

#[derive(Clone, Debug)]
struct Member {
    driver: Driver,
    flies: bool,
    /// The length of the path that it set out with, in meters: what the others expect it to drive.
    planned_m: f64,
    has_arrived: bool,
    /// Until it is this far along its path, in meters, it goes around the others rather than wait for them.
    passes_until_m: f64,
    /// What of the world is near, and where it was looked for.
    near: Option<(FineWorld, Point2<f64>)>,
}

impl Member {
    /// Meters that it still has to go.
    fn remaining_m(&self) -> f64 {
        if self.has_arrived { 0.0 } else { self.driver.length_m() - self.driver.progress_m() }
    }

    /// Returns whether it goes around the others rather than wait for them.
    fn passes(&self) -> bool {
        self.driver.progress_m() < self.passes_until_m
    }

    /// From now on it goes around the others, for so many meters.
    fn pass_for(&mut self, meters: f64) {
        self.passes_until_m = self.driver.progress_m() + meters;
    }

    /// Returns whether it is this near to the end of its path.
    fn is_within(&self, reach_m: f64) -> bool {
        let place = self.driver.state().position_m;
        self.driver.path().points_m.last().is_some_and(|&end| distance(&end, &place) <= reach_m)
    }
}

/// What a vehicle sets out with.
#[derive(Clone, Debug)]
pub struct ConvoyMember {
    /// Its path, from where it stands.
    pub path: Path,
    /// Its heading in radians.
    pub heading_rad: f64,
    /// How it drives.
    pub settings: DriverSettings,
    /// Whether it is above what drives.
    pub flies: bool,
}

/// What the surroundings of a step are.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// What range sensors see on the ground.
    pub world: &'a FineWorld,
    /// What those see that fly.
    pub air: &'a FineWorld,
    /// Whether the world has changed since the last step.
    pub has_changed: bool,
    /// For each vehicle, the map that keeps it off steep ground.
    pub maps: &'a [ConfigurationSpace],
    /// Other vehicles that move: a vehicle stands rather than drive at one, or to where one will be.
    pub others: &'a [OtherVehicle],
}

/// A vehicle that moves along a way of its own, which it does not leave for those that look at it.
#[derive(Clone, Debug)]
pub struct OtherVehicle {
    /// Where it is now, and where it will be soon.
    pub places_m: Vec<Point2<f64>>,
    /// Of the disc around its body, in meters.
    pub radius_m: f64,
    /// Whether it is above what drives.
    pub flies: bool,
}

/// A vehicle keeps so far from where another one will be, in meters.
const CROSSING_M: f64 = 0.1;

/// A part of the world this far around a vehicle is kept at hand, in meters.
const AT_HAND_M: f64 = 14.0;
/// It is looked for again after so many meters.
const AT_HAND_STEP_M: f64 = 4.0;
/// The leader waits when a follower is this many spacings behind its place.
const WAITING_SPACINGS: f64 = 3.0;

/// A follower that drives at less than this share of the leader's pace waits for it. It is not zero: the leader may wait for
/// one that is beside it, and each then drives more slowly as the other does, without ever standing.
const WAITING_SHARE: f64 = 0.5;
/// Who has come no farther together, though the leader's pace was so many meters meanwhile, has stalled.
const STALL_M: f64 = 4.0;
/// The places of a vehicle that brakes are at least so far apart, in meters.
const BRAKING_STEP_M: f64 = 0.15;
/// A vehicle waits while another one within so many meters drives around it.
const PASSING_M: f64 = 0.6;
/// Coming farther means so many meters less to go for all together.
const STALL_WAY_M: f64 = 0.5;

/// The share of the leader's pace at which a follower keeps up that is so many meters behind its place; none, and it
/// waits for the leader, where it is far ahead of it.
fn follower_share(lag_m: f64) -> f64 {
    (1.0 + 0.5 * lag_m).max(0.0)
}

impl Convoy {
    /// Vehicles at rest; all decide as often as the fastest of them needs to.
    pub fn new(members: Vec<ConvoyMember>, spacing_m: f64, seed: u64) -> Self {
        let step_s = members.iter().map(|member| member.settings.step_s).fold(f64::INFINITY, f64::min);
        let members = members
            .into_iter()
            .enumerate()
            .map(|(index, ConvoyMember { path, heading_rad, settings, flies })| {
                let settings = DriverSettings { step_s, ..settings };
                let driver = Driver::new(path, heading_rad, settings, seed.wrapping_add(index as u64));
                let planned_m = driver.length_m();
                Member { driver, flies, planned_m, has_arrived: false, passes_until_m: 0.0, near: None }
            })
            .collect();
        let stall = Stall { remaining_m: f64::INFINITY, commanded_m: 0.0, count: 0 };
        Self { members, spacing_m, step_s, time_s: 0.0, stall }
    }

    /// Seconds driven.
    pub const fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Seconds between the last two decisions; before there are two, seconds to the next one.
    pub const fn step_s(&self) -> f64 {
        self.step_s
    }

    /// A vehicle's driver; the leader is 0.
    pub fn driver(&self, vehicle: usize) -> Option<&Driver> {
        Some(&self.members.get(vehicle)?.driver)
    }

    /// Returns whether all have arrived.
    pub fn has_arrived(&self) -> bool {
        self.members.iter().all(|member| member.has_arrived)
    }

    /// Returns whether a vehicle is where it stays.
    pub fn is_there(&self, vehicle: usize) -> bool {
        self.members.get(vehicle).is_some_and(|member| member.has_arrived)
    }

    /// Meters that the leader still has to go.
    pub fn remaining_m(&self) -> f64 {
        self.members.first().map_or(0.0, Member::remaining_m)
    }

    /// Sends a vehicle along another path from where it is.
    pub fn follow(&mut self, vehicle: usize, path: Path) {
        if let Some(member) = self.members.get_mut(vehicle) {
            member.driver.follow(path);
            member.has_arrived = false;
            member.passes_until_m = 0.0;
            self.stall.remaining_m = f64::INFINITY;
        }
    }

    /// Those that stand close to a vehicle that cannot continue drive on rather than wait for the leader.
    pub fn make_room(&mut self, vehicle: usize) {
        let close: Vec<usize> = self.close_to(vehicle).map(|(other, _)| other).collect();
        for other in close {
            self.members[other].pass_for(self.spacing_m);
        }
    }

    /// A vehicle is to stay where it is.
    pub fn stay(&mut self, vehicle: usize) {
        if let Some(member) = self.members.get_mut(vehicle) {
            member.has_arrived = true;
        }
    }

    /// Drives for one step. The leader aims at `pace_mps`; no vehicle drives faster than its entry in `most_mps`.
    pub fn step(
        &mut self,
        around: &Surroundings<'_>,
        pace_mps: f64,
        most_mps: &[f64],
    ) -> Vec<(DriveEvent, RangeScan)> {
        let share = self.leader_share();
        // By what is left to drive, so that a detour counts as lag and what lies behind a vehicle does not.
        let lag_m = |member: &Member| member.remaining_m() - (1.0 - share) * member.planned_m;
        let lags_m: Vec<f64> = self.members.iter().map(lag_m).collect();
        self.give_way(&lags_m);
        self.end_stall(pace_mps, most_mps);
        let leader_waits = !self.members.first().is_some_and(Member::passes)
            && lags_m.iter().skip(1).any(|&lag_m| self.is_far_behind(lag_m));
        let wanted_mps = |(index, member): (usize, &Member)| {
            let wanted = match index {
                0 if leader_waits => 0.0,
                0 => pace_mps,
                _ if member.passes() => pace_mps,
                _ => pace_mps * follower_share(lags_m[index]),
            };
            wanted.min(most_mps.get(index).copied().unwrap_or(0.0))
        };
        let wanted_mps: Vec<f64> = self.members.iter().enumerate().map(wanted_mps).collect();
        self.step_s = self.next_step_s(&wanted_mps);
        self.time_s += self.step_s;
        let mut steps = Vec::with_capacity(self.members.len());
        for (index, &wanted) in wanted_mps.iter().enumerate() {
            let in_its_way = self.in_its_way(index);
            let is_held = in_its_way.iter().any(|&other| self.waits_behind(index, other))
                || self.lets_pass(index)
                || self.is_held_by(index, around.others);
            let must_stand = is_held || self.members[index].has_arrived;
            let mut others = self.members.iter().enumerate().filter(|(other, _)| *other != index);
            let others_are_there = others.all(|(_, other)| other.has_arrived) && self.members.len() > 1;
            let to_pass = self.to_pass(index);
            let member = &mut self.members[index];
            member.driver.set_step(self.step_s);
            member.driver.set_cruise(if must_stand { 0.0 } else { wanted });
            member.driver.set_vehicles(&to_pass);
            let here = member.driver.state().position_m;
            let is_at_hand = |near: &(FineWorld, Point2<f64>)| distance(&near.1, &here) <= AT_HAND_STEP_M;
            if around.has_changed || !member.near.as_ref().is_some_and(is_at_hand) {
                let world = if member.flies { around.air } else { around.world };
                member.near = Some((world.around(here, AT_HAND_M), here));
            }
            let world = member.near.as_ref().map_or(around.world, |(near, _)| near);
            let (event, scan) = member.driver.step(world, around.maps.get(index));
            member.has_arrived |= event == DriveEvent::Arrived;
            // One that came another way than planned has its place wherever the others leave it room.
            let is_near_its_place = others_are_there && member.is_within(2.0 * self.spacing_m);
            member.has_arrived |= is_near_its_place && !in_its_way.is_empty();
            steps.push((event, scan));
        }
        steps
    }

    /// Seconds until all decide again: by the fastest of them, as it is and as it wants to be.
    fn next_step_s(&self, wanted_mps: &[f64]) -> f64 {
        let speeds = self.members.iter().map(|member| member.driver.state().speed_mps);
        let fastest_mps = speeds.chain(wanted_mps.iter().copied()).fold(0.0, f64::max);
        // While all stand, they look about as they did before.
        if fastest_mps > 0.0 { step_s(fastest_mps) } else { self.step_s }
    }

    /// Returns where a vehicle is and how it moves.
    pub fn state(&self, vehicle: usize) -> MotionState {
        self.members.get(vehicle).map(|member| member.driver.state()).unwrap_or_default()
    }

    /// The share of its planned path that the leader has behind it; less when it was led another way.
    fn leader_share(&self) -> f64 {
        let Some(leader) = self.members.first().filter(|leader| leader.planned_m > 0.0) else { return 1.0 };
        (1.0 - leader.remaining_m() / leader.planned_m).clamp(0.0, 1.0)
    }

    const fn is_far_behind(&self, lag_m: f64) -> bool {
        lag_m > WAITING_SPACINGS * self.spacing_m
    }

    /// Of vehicles that wait for each other in a ring, the first of the convoy continues, around the others.
    fn give_way(&mut self, lags_m: &[f64]) {
        let count = self.members.len();
        let waits_for = |vehicle: usize| -> Vec<usize> {
            let member = &self.members[vehicle];
            if member.has_arrived || member.passes() {
                return Vec::new();
            }
            let mut found = self.in_its_way(vehicle);
            if vehicle == 0 {
                found.extend((1..count).filter(|&other| self.is_far_behind(lags_m[other])));
            } else if follower_share(lags_m[vehicle]) < WAITING_SHARE {
                found.push(0);
            }
            found
        };
        let waiting: Vec<Vec<usize>> = (0..count).map(waits_for).collect();
        let is_first_of_ring = |first: &usize| {
            let (mut reached, mut open) = (vec![false; count], vec![*first]);
            while let Some(vehicle) = open.pop() {
                for &other in waiting[vehicle].iter().filter(|other| *other >= first) {
                    if !std::mem::replace(&mut reached[other], true) {
                        open.push(other);
                    }
                }
            }
            reached[*first]
        };
        let going: Vec<usize> = (0..count).filter(is_first_of_ring).collect();
        for vehicle in going {
            let member = &mut self.members[vehicle];
            member.pass_for(self.spacing_m);
        }
    }

    /// If all wait and there is no ring, they take turns: one vehicle after the other drives around the others.
    fn end_stall(&mut self, pace_mps: f64, most_mps: &[f64]) {
        let remaining_m = self.members.iter().map(Member::remaining_m).sum();
        // Who waits for one that cannot drive waits for as long as that takes.
        let is_stopped = |(member, &most_mps): (&Member, &f64)| !member.has_arrived && most_mps <= 0.0;
        let waits_for_one = self.members.iter().zip(most_mps).any(is_stopped);
        if waits_for_one || remaining_m < self.stall.remaining_m - STALL_WAY_M {
            self.stall = Stall { remaining_m, commanded_m: 0.0, count: 0 };
            return;
        }
        self.stall.commanded_m += pace_mps * self.step_s;
        if self.stall.commanded_m < STALL_M {
            return;
        }
        let under_way: Vec<usize> =
            (0..self.members.len()).filter(|&vehicle| !self.members[vehicle].has_arrived).collect();
        if let Some(&vehicle) = under_way.get(self.stall.count % under_way.len().max(1)) {
            for member in &mut self.members {
                member.passes_until_m = 0.0;
            }
            let member = &mut self.members[vehicle];
            member.pass_for(self.spacing_m);
        }
        self.stall.commanded_m = 0.0;
        self.stall.count += 1;
    }

    /// Returns whether a vehicle stands behind another that is in its way, rather than go around it.
    fn waits_behind(&self, vehicle: usize, other: usize) -> bool {
        !self.members[vehicle].passes() && !self.members[other].has_arrived
    }

    /// The others that can be in a vehicle's way, with their positions in the convoy: what flies is above what drives.
    fn beside(&self, vehicle: usize) -> impl Iterator<Item = (usize, &Member)> {
        let flies = self.members[vehicle].flies;
        let all = self.members.iter().enumerate();
        all.filter(move |(other, member)| *other != vehicle && member.flies == flies)
    }

    /// Returns whether a vehicle stands because another one goes around it close by, before it if both do.
    fn lets_pass(&self, vehicle: usize) -> bool {
        let passes = self.members[vehicle].passes();
        self.close_to(vehicle)
            .any(|(index, other)| other.passes() && !other.has_arrived && (!passes || index < vehicle))
    }

    /// The others beside a vehicle that leave too little room between to go through, when both stand.
    fn close_to(&self, vehicle: usize) -> impl Iterator<Item = (usize, &Member)> {
        let own = &self.members[vehicle].driver;
        let (here, radius_m, stopping_m) =
            (own.state().position_m, own.settings().radius_m, self.stopping_m(vehicle));
        self.beside(vehicle).filter(move |(index, other)| {
            let driver = &other.driver;
            let room_m = PASSING_M.max(stopping_m + self.stopping_m(*index));
            distance(&driver.state().position_m, &here) <= radius_m + driver.settings().radius_m + room_m
        })
    }

    /// The vehicles of the convoy that one goes around, as places and radii in meters: where they are, and where they are
    /// until they stand if they brake now.
    fn to_pass(&self, vehicle: usize) -> Vec<(Point2<f64>, f64)> {
        let passed = self.beside(vehicle).filter(|(other, _)| !self.waits_behind(vehicle, *other));
        let places = |(_, other): (usize, &Member)| {
            let radius_m = other.driver.settings().radius_m;
            other.driver.braking_m(BRAKING_STEP_M).into_iter().map(move |place| (place, radius_m))
        };
        passed.flat_map(places).collect()
    }

    /// The vehicles of the convoy that are close in front of one.
    fn in_its_way(&self, vehicle: usize) -> Vec<usize> {
        let radius_m = self.members[vehicle].driver.settings().radius_m;
        let is_in_its_way = |(index, other): (usize, &Member)| {
            let reach_m = if index < vehicle {
                0.85 * self.spacing_m
            } else {
                radius_m + other.driver.settings().radius_m + 0.2
            };
            self.is_ahead(vehicle, other.driver.state().position_m, reach_m).then_some(index)
        };
        self.beside(vehicle).filter_map(is_in_its_way).collect()
    }

    /// Returns whether others that move are close in front of a vehicle, or will soon be where it drives to.
    fn is_held_by(&self, vehicle: usize, others: &[OtherVehicle]) -> bool {
        let Member { driver, flies, .. } = &self.members[vehicle];
        let radius_m = driver.settings().radius_m;
        others.iter().filter(|other| other.flies == *flies).any(|other| {
            let reach_m = radius_m + other.radius_m;
            let is_at = |&place: &Point2<f64>| self.is_ahead(vehicle, place, reach_m + 0.5);
            other.places_m.first().is_some_and(is_at)
                || other.places_m.iter().any(|&place| self.drives_to(vehicle, place, reach_m + CROSSING_M))
        })
    }

    /// Returns whether the next step brings a vehicle nearer to a place, and nearer than a reach in meters.
    fn drives_to(&self, vehicle: usize, place: Point2<f64>, reach_m: f64) -> bool {
        let state = self.members[vehicle].driver.state();
        let step_m = self.stopping_m(vehicle).max(CROSSING_M);
        let next = state.position_m + state.world_from_body() * (Vector2::x() * step_m);
        let then_m = distance(&next, &place);
        then_m < reach_m && then_m < distance(&state.position_m, &place)
    }

    /// Returns how far a vehicle drives before it stands, in meters.
    fn stopping_m(&self, vehicle: usize) -> f64 {
        let own = &self.members[vehicle].driver;
        let speed_mps = own.state().speed_mps;
        speed_mps * speed_mps / (2.0 * own.settings().limits.acceleration_mps2) + speed_mps * self.step_s
    }

    /// Returns whether a place is in front of a vehicle, and nearer than it can stop and a reach in meters.
    fn is_ahead(&self, vehicle: usize, place: Point2<f64>, reach_m: f64) -> bool {
        let state = self.members[vehicle].driver.state();
        let stopping_m = self.stopping_m(vehicle);
        let place_in_body = state.world_from_body().inverse_transform_point(&place);
        place_in_body.x > 0.0 && Ball::new(reach_m + stopping_m).contains_local_point(&place_in_body)
    }
}
