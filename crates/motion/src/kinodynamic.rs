//! A kinodynamic RRT for skid-steer vehicles (`LaValle` and Kuffner 2001; SPEC 7.2).
//!
//! A vertex is a state of motion. It is extended by driving toward each of a few target speeds and turning rates for
//! up to some seconds; the free state on any of these that comes nearest to the sample is kept. Near the goal the
//! vehicle stops, turns on the spot and drives straight to it, so that the path ends there exactly and at rest.

use crate::nearest::PointTree;
use crate::path::Path;
use crate::query::{Context, Event, Growth, Query};
use crate::trajectory::{MotionState, Trajectory, heading_difference};
use crate::tree::{Root, Tree};
use nalgebra::{Point2, distance};

/// One tree of states from the start at rest.
#[derive(Clone, Debug)]
pub(crate) struct Kinodynamic {
    tree: Tree,
    points: PointTree,
    /// For each vertex, the states from its parent's, without it, to its own.
    motions: Vec<Vec<MotionState>>,
    /// The vertex from which the goal is reached, and the way from there.
    arrival: Option<(u32, Trajectory)>,
}

/// Target speeds as shares of the greatest.
const SPEEDS: [f64; 3] = [1.0, 0.5, 0.0];
/// Target turning rates as shares of the greatest.
const TURN_RATES: [f64; 5] = [0.0, -0.5, 0.5, -1.0, 1.0];
/// How far, in meters, a radian of heading counts.
const HEADING_WEIGHT_M: f64 = 1.5;

impl Kinodynamic {
    pub(crate) fn new(query: Query) -> Self {
        let ahead = query.goal_m - query.start_m;
        let start = MotionState::at_rest(query.start_m, libm::atan2(ahead.y, ahead.x));
        let mut points = PointTree::default();
        points.add(query.start_m);
        let mut tree = Tree::new(Root::Start, query.start_m);
        tree.curves.push(Vec::new());
        Self { tree, points, motions: vec![vec![start]], arrival: None }
    }

    pub(crate) fn step(&mut self, context: &mut Context) -> Event {
        let sample_m = context.sample();
        let nearest = self
            .points
            .nearest_by(sample_m, |vertex, _| {
                let measure = measure(self.state(vertex), sample_m);
                measure * measure
            })
            .map_or(0, |(vertex, _)| vertex);
        let event = |growth: Growth| Event { sample_m, tree: 0, nearest, growth };
        let Some(motion) = extend(self.state(nearest), sample_m, context) else {
            context.statistics.blocked_edges += 1;
            return event(Growth::Blocked { vertex: nearest });
        };
        let vertex = self.add(motion, nearest);
        if let Some(arrival) = arrive(self.state(vertex), context) {
            self.arrival = Some((vertex, arrival));
            let length_m = self.path().map_or(0.0, |path| path.length_m());
            return event(Growth::Found { vertex, length_m });
        }
        event(Growth::Grew { vertex })
    }

    /// The states from the start to the goal, at rest at both.
    pub(crate) fn trajectory(&self) -> Option<Trajectory> {
        let (last, arrival) = self.arrival.as_ref()?;
        let mut vertices = vec![*last];
        while let Some(parent) =
            vertices.last().and_then(|&vertex| self.tree.vertices[vertex as usize].parent)
        {
            vertices.push(parent);
        }
        let mut trajectory = Trajectory::default();
        for &vertex in vertices.iter().rev() {
            for &state in &self.motions[vertex as usize] {
                let seconds = if trajectory.states.is_empty() { 0.0 } else { Trajectory::STEP_S };
                trajectory.push(seconds, state);
            }
        }
        let start_s = trajectory.duration_s();
        trajectory.states.extend(arrival.states.iter().skip(1).map(|timed| {
            let mut timed = *timed;
            timed.time_s += start_s;
            timed
        }));
        Some(trajectory)
    }

    pub(crate) fn path(&self) -> Option<Path> {
        self.trajectory().map(|trajectory| trajectory.path())
    }

    pub(crate) const fn tree(&self) -> &Tree {
        &self.tree
    }

    pub(crate) fn into_tree(self) -> Tree {
        self.tree
    }

    fn state(&self, vertex: u32) -> MotionState {
        self.motions[vertex as usize].last().copied().unwrap_or_default()
    }

    fn add(&mut self, motion: Vec<MotionState>, parent: u32) -> u32 {
        let point = motion.last().map_or_else(Point2::origin, |state| state.position_m);
        self.points.add(point);
        self.tree.curves.push(motion.iter().map(|state| state.position_m).collect());
        self.motions.push(motion);
        self.tree.add(point, parent)
    }
}

/// Returns how far a state is from a place: the distance, and what it takes to face it. At least the distance.
fn measure(state: MotionState, place_m: Point2<f64>) -> f64 {
    let offset = place_m - state.position_m;
    let length = offset.norm();
    let turn = heading_difference(state.heading_rad, libm::atan2(offset.y, offset.x));
    // Right at the place it doesn't matter where it faces.
    length + HEADING_WEIGHT_M * turn.abs() * (length / HEADING_WEIGHT_M).min(1.0)
}

/// The free motion that ends nearest to a sample, over all controls and durations; none when every one hits something
/// at once.
fn extend(start: MotionState, sample_m: Point2<f64>, context: &mut Context) -> Option<Vec<MotionState>> {
    let limits = &{ context.settings.limits };
    let steps =
        (context.settings.step_m / limits.speed_mps / Trajectory::STEP_S).ceil().clamp(4.0, 120.0) as usize;
    let mut best: Option<(f64, Vec<MotionState>)> = None;
    let mut motion = Vec::with_capacity(steps);
    for speed in SPEEDS {
        for rate in TURN_RATES {
            if speed == 0.0 && rate == 0.0 {
                continue;
            }
            motion.clear();
            let mut state = start;
            let mut nearest = (f64::INFINITY, 0);
            for _ in 0..steps {
                let next = state.after(
                    speed * limits.speed_mps,
                    rate * limits.turn_rate_rps,
                    Trajectory::STEP_S,
                    limits,
                );
                if !context.is_free(state.position_m, next.position_m) {
                    break;
                }
                motion.push(next);
                state = next;
                let value = measure(next, sample_m);
                if value < nearest.0 {
                    nearest = (value, motion.len());
                }
            }
            if nearest.1 > 0 && best.as_ref().is_none_or(|(least, _)| nearest.0 < *least) {
                best = Some((nearest.0, motion[..nearest.1].to_vec()));
            }
        }
    }
    best.map(|(_, motion)| motion)
}

/// The way to the goal from a state within two steps of it: braking, turning on the spot, driving straight.
fn arrive(state: MotionState, context: &mut Context) -> Option<Trajectory> {
    let goal_m = context.query.goal_m;
    if distance(&state.position_m, &goal_m) > 2.0 * context.settings.step_m {
        return None;
    }
    let limits = &{ context.settings.limits };
    let mut trajectory = Trajectory::default();
    trajectory.push(0.0, state);
    trajectory.stop(limits);
    let brakes_freely = trajectory.path().segments().all(|(from, to)| context.is_free(from, to));
    if !brakes_freely || !context.is_free(trajectory.last().position_m, goal_m) {
        return None;
    }
    trajectory.drive_to(goal_m, limits);
    Some(trajectory)
}
