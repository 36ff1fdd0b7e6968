//! Everything known of one revision of a mission, as immutable data that panels and reports read.

use std::sync::Arc;

use exact::{Bound, Time};
use motion::{GrowthTrace, HiddenRocks, Path};
use nalgebra::Point2;
use rmpl::program::{Program, World};
use rmpl::spans::Spans;
use rmpl::{Code, Span};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use tpn::{Choice, Network, OccurrenceId};

use crate::PartKeys;
use crate::Problem;

/// One revision of a mission, as far as it has been evaluated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// The revision of the text this belongs to.
    pub revision: u64,
    /// How far this snapshot goes.
    pub stage: Stage,
    pub source: Arc<str>,
    /// What is wrong with it, or could be.
    pub problems: Arc<[Problem]>,
    /// What it says, as far as it is well formed.
    pub program: Arc<Program>,
    /// The network, unless an error prevents one. Path vertices of planned traverses are part of it.
    pub network: Option<Arc<Network>>,
    /// What planning found; absent before it ran, or without a network.
    pub planning: Option<Arc<Planning>>,
    /// The ground, if the mission names one.
    pub map: Option<MapKey>,
    /// The traverses of the plan, in order of departure.
    pub traverses: Arc<[Traverse]>,
    /// Where every vehicle is over time, under the earliest schedule of the plan.
    pub motions: Arc<[VehicleMotion]>,
    /// Vehicles that come within their safety radius of each other in some schedule of the plan.
    pub separation_violations: Arc<[SeparationViolation]>,
    /// What is new in this snapshot, and what an earlier one had already.
    pub keys: PartKeys,
    /// How long the stages took.
    pub timings: Timings,
}

/// How far a snapshot goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Stage {
    /// The text is read and the network compiled, if it could be.
    Compiled,
    /// The best plan so far, with its paths: a better one may come.
    Improving,
    /// Planned, with paths where the plan has traverses: nothing more will come for this revision.
    Complete,
}

/// What planning found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Planning {
    /// The planner's answer.
    pub outcome: kirk::Outcome,
    /// What the independent checker says of the first plan.
    pub verdict: Option<verify::Verdict>,
    /// Traverses whose alternatives were given up because no path fits, with the reason.
    pub undrivable: Vec<Undrivable>,
    /// Plans that would be listed where several are asked for, but cannot be driven.
    pub left_out: Vec<LeftOut>,
    /// Without a plan: changes of the text that give one, other than of bounds. Each has been planned.
    pub repairs: Vec<rmpl::Fix>,
}

/// A traverse that could not be driven.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Undrivable {
    pub occurrence: OccurrenceId,
    /// The leg, from 1; 0 when it is the whole traverse that does not fit its bounds.
    pub leg: u32,
    /// Why, for the author.
    pub reason: String,
}

/// A plan that would be listed if it could be driven.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    pub choices: Vec<Choice>,
    /// Why it cannot be driven, for the author.
    pub reason: String,
}

/// Names a map so that it is sent to the page only once.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct MapKey {
    /// The asset or the imported file.
    pub asset: SmolStr,
    /// Meters per cell in millimeters.
    pub cell_mm: u32,
    /// Mission coordinates of the south-west corner in millimeters.
    pub origin_mm: [i64; 2],
    /// The SHA-256 of the file that was imported under this name; `None` for a map that comes with the program. The whole
    /// digest is kept: somebody could make another file that shares a part of it, and an approval would hold for that file.
    pub version: Option<[u8; 32]>,
}

/// A traverse of the plan with its path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Traverse {
    pub occurrence: OccurrenceId,
    /// The vehicles, as indices into the program's world; the first leads.
    pub vehicles: Vec<u32>,
    /// The legs between waypoints.
    pub legs: Vec<Leg>,
    /// The whole length in meters.
    pub length_m: f64,
    /// The least distance from the path of any of its vehicles to an obstacle, in meters, beyond the radius of the widest.
    pub clearance_m: f64,
    /// How many rocks it may meet that the map does not show.
    pub rocks: HiddenRocks,
    /// Where a rock that the map does not show could close the path of one of its vehicles, so that the way around is long
    /// (`motion::narrow_passage`); in meters.
    pub narrow_m: Option<Point2<f64>>,
    /// The steepest slope along the path of any of its vehicles, in radians.
    pub slope_max_rad: f64,
    /// What each leg comes to, in order.
    pub leg_figures: Vec<PathFigures>,
    /// How many others its leader drives with, or drove with when it came to where it starts.
    pub company: u32,
}

impl Traverse {
    /// Returns whether rocks that the map does not show could close its path, so that it may take longer than drivers
    /// were measured to take.
    pub fn may_be_closed(&self) -> bool {
        self.narrow_m.is_some() || self.rocks == HiddenRocks::Many
    }
}

/// What a path comes to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathFigures {
    /// Length over the ground in meters, or through the air.
    pub length_m: f64,
    /// The least distance from the leader's rim and margin to an obstacle, in meters; infinite without obstacles.
    pub min_clearance_m: f64,
    /// The steepest slope in degrees.
    pub max_slope_deg: f64,
    /// Least duration in mission units, from length, slope and the greatest speed.
    pub min_duration: Time,
    /// Greatest duration, from length and the least speed.
    pub max_duration: Bound,
}

/// The path between two waypoints.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Leg {
    /// The name of the location it leads to.
    pub to: SmolStr,
    /// The path, waypoints included, in meters.
    pub points_m: Vec<Point2<f64>>,
    /// The search tree that found it, as segments, for display.
    pub tree_m: Arc<Vec<[Point2<f64>; 2]>>,
    /// How the search grew, sample by sample, for showing it step by step.
    pub growth: Arc<GrowthTrace>,
    /// Samples that the search drew.
    pub samples: u32,
}

impl Leg {
    /// Returns how a vehicle faces at its end, in radians counter-clockwise from east; `None` of a leg without length.
    pub fn heading_rad(&self) -> Option<f64> {
        let ahead =
            self.points_m.windows(2).rev().map(|pair| pair[1] - pair[0]).find(|ahead| ahead.norm() > 0.0)?;
        Some(libm::atan2(ahead.y, ahead.x))
    }
}

/// The points of all legs, each waypoint once.
pub fn joined(legs: &[Leg]) -> Path {
    let mut points: Vec<Point2<f64>> = Vec::new();
    for leg in legs {
        let repeated = usize::from(!points.is_empty());
        points.extend(leg.points_m.iter().skip(repeated));
    }
    Path::new(points)
}

/// Where a vehicle is over time: still between keyframes with equal positions, otherwise at constant speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VehicleMotion {
    /// Index into the program's world.
    pub vehicle: u32,
    /// Times in mission units from the start, ascending, and positions in meters.
    pub keyframes: Vec<Keyframe>,
}

/// A place at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Keyframe {
    /// In mission time units from the start.
    pub time: Time,
    /// In meters.
    pub position_m: Point2<f64>,
    /// Direction of travel in radians, counter-clockwise from east.
    pub heading_rad: f64,
}

/// When an activity that moves vehicles starts and ends in a schedule, in mission units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MovementTimes {
    pub occurrence: OccurrenceId,
    pub start: f64,
    pub end: f64,
}

/// Two vehicles nearer to each other than they may be, in some schedule of the plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeparationViolation {
    /// The vehicles, as indices into the program's world.
    pub vehicles: [u32; 2],
    /// When they first come within their safety radius, in mission units.
    pub since: f64,
    /// When they are nearest.
    pub time: f64,
    /// Half way between them, in meters.
    pub position_m: Point2<f64>,
    /// How near they come, in meters, from center to center.
    pub distance_m: f64,
    /// How near they may come, in meters.
    pub min_m: f64,
    /// The schedule in which they do: when what they drive starts and ends. Empty for the earliest schedule.
    pub schedule: Vec<MovementTimes>,
}

impl SeparationViolation {
    /// The warning of one.
    pub const CODE: Code = Code("W-ENCOUNTER");

    /// Returns who comes how near whom, where, and in which schedule.
    pub fn words(&self, world: &World, network: &Network) -> String {
        let vehicle = |index: u32| world.vehicles.get(index as usize).map_or("?", |it| it.name.text.as_str());
        let [first, second] = self.vehicles.map(vehicle);
        let movement = |times: &MovementTimes| {
            let name = network.occurrences.get(times.occurrence.index()).map_or("?", |it| it.name.as_str());
            format!("{name} lasts from {:.1} to {:.1}", times.start, times.end)
        };
        let schedule = match self.schedule.as_slice() {
            [] => "in the plan's earliest schedule".to_owned(),
            times => {
                let times: Vec<String> = times.iter().map(movement).collect();
                format!("in a schedule in which {}", times.join(" and "))
            }
        };
        let place = self.position_m;
        format!(
            "{first} and {second} come within {:.2} m of each other near ({:.0}, {:.0}) at {:.1}, {schedule}; they need at least {:.2} m",
            self.distance_m, place.x, place.y, self.time, self.min_m
        )
    }
}

/// Milliseconds per stage, as measured by the host; zero where it has no clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timings {
    /// Reading the text.
    pub parse_millis: f64,
    /// Compiling the network.
    pub compile_millis: f64,
    /// Planning, paths included.
    pub plan_millis: f64,
}

impl Planning {
    /// The changes that would give a plan, in the author's terms: of the text, then of single bounds.
    pub fn ways_out(&self) -> Vec<&str> {
        let Some(failure) = &self.outcome.failure else { return Vec::new() };
        let gap = failure.is_of_gap.then_some(kirk::GAP_LABEL);
        let repairs = self.repairs.iter().map(|repair| repair.label.as_str());
        let bounds = failure.relaxations.iter().map(|change| change.label.as_str());
        gap.into_iter().chain(repairs).chain(bounds).collect()
    }

    /// Returns why it is not known whether there is a plan, in one sentence without an end; nothing if that is known.
    pub fn undecided(&self) -> Option<&'static str> {
        let is_open = self.outcome.status == kirk::Status::Limit && self.outcome.plans.is_empty();
        let why = if self.undrivable.is_empty() {
            "planning was stopped before it found an answer"
        } else {
            "no plan was found, but there may be one in which vehicles stop elsewhere"
        };
        is_open.then_some(why)
    }

    /// Returns whether anything in it refers to places in the text.
    pub fn refers_to_places(&self) -> bool {
        self.outcome.failure.is_some()
    }
}

impl Spans for Planning {
    fn visit_spans(&mut self, visit: &mut dyn FnMut(&mut Span)) {
        let Some(failure) = &mut self.outcome.failure else { return };
        for reason in &mut failure.reasons {
            reason.spans.visit_spans(visit);
        }
        for relaxation in &mut failure.relaxations {
            relaxation.span.visit_spans(visit);
        }
        for edit in self.repairs.iter_mut().flat_map(|repair| &mut repair.edits) {
            edit.span.visit_spans(visit);
        }
    }
}

impl Snapshot {
    /// A text of which nothing is known yet.
    pub fn empty(revision: u64, source: Arc<str>) -> Self {
        Self {
            revision,
            stage: Stage::Compiled,
            source,
            problems: Arc::default(),
            program: Arc::default(),
            network: None,
            planning: None,
            map: None,
            traverses: Arc::default(),
            motions: Arc::default(),
            separation_violations: Arc::default(),
            keys: PartKeys::default(),
            timings: Timings::default(),
        }
    }

    /// Returns whether both hold the same, but for the problems of their texts and where in those things are written.
    pub fn shows_same(&self, other: &Self) -> bool {
        let is_known =
            self.keys != PartKeys::default() && self.keys == other.keys && self.stage == other.stage;
        std::ptr::eq(self, other) || is_known
    }

    /// The plan, if there is one.
    pub fn plan(&self) -> Option<&tpn::Plan> {
        self.planning.as_ref()?.outcome.plans.first()
    }

    /// How many events and constraints the plan has, as the review counts events; without a plan, the network.
    pub fn size(&self) -> Option<(usize, usize)> {
        let (network, plan) = (self.network.as_deref()?, self.plan());
        let is_planned =
            |node: usize| plan.is_none_or(|plan| matches!(plan.windows.get(node), Some(Some(_))));
        let nodes = network.nodes.iter().enumerate().filter(|(node, _)| is_planned(*node));
        let events = nodes.map(|(_, node)| node.events.len()).sum();
        let selected =
            |plan: &tpn::Plan| plan.selected_arcs.iter().filter(|is_selected| **is_selected).count();
        Some((events, plan.map_or(network.arcs.len(), selected)))
    }
}

impl VehicleMotion {
    /// Returns where the vehicle is at `time`, in mission units, and its heading in radians; `None` without keyframes.
    pub fn at(&self, time: f64) -> Option<(Point2<f64>, f64)> {
        let seconds = |frame: &Keyframe| frame.time.to_f64();
        let after = self.keyframes.partition_point(|frame| seconds(frame) <= time);
        let before = self.keyframes.get(after.saturating_sub(1))?;
        let Some(next) = self.keyframes.get(after).filter(|_| after > 0) else {
            return Some((before.position_m, before.heading_rad));
        };
        let (from, to) = (seconds(before), seconds(next));
        let part = if to > from { (time - from) / (to - from) } else { 0.0 };
        let position_m = before.position_m + (next.position_m - before.position_m) * part;
        Some((position_m, before.heading_rad))
    }
}
