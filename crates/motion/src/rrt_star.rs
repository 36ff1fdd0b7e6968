//! RRT* (Karaman and Frazzoli 2011) that, once it has a path, samples only where a shorter one can pass (informed
//! RRT*, Gammell, Srinivasa and Barfoot 2014).

use crate::nearest::PointTree;
use crate::path::{Path, between};
use crate::query::{Context, Event, Growth, Query};
use crate::tree::{Root, Tree};
use nalgebra::{Point2, Vector2, distance};

/// One tree from the start whose vertices keep the shortest way back that their neighbors offer.
#[derive(Clone, Debug)]
pub(crate) struct RrtStar {
    tree: Tree,
    points: PointTree,
    /// Length of the way from the start to each vertex, in meters.
    costs_m: Vec<f64>,
    children: Vec<Vec<u32>>,
    /// Vertices at the goal, one for each edge to it.
    goals: Vec<u32>,
    best: Option<Best>,
    /// Kept between steps for its storage: neighbors with their distances.
    near: Vec<(u32, f64)>,
}

#[derive(Clone, Copy, Debug)]
struct Best {
    vertex: u32,
    length_m: f64,
}

impl RrtStar {
    pub(crate) fn new(query: Query) -> Self {
        let mut points = PointTree::default();
        points.add(query.start_m);
        Self {
            tree: Tree::new(Root::Start, query.start_m),
            points,
            costs_m: vec![0.0],
            children: vec![Vec::new()],
            goals: Vec::new(),
            best: None,
            near: Vec::new(),
        }
    }

    pub(crate) fn step(&mut self, context: &mut Context) -> Event {
        let sample_m = match self.best {
            Some(best) => informed_sample(context, best.length_m),
            None => context.sample(),
        };
        let (nearest, squared) = self.points.nearest(sample_m).unwrap_or((0, 0.0));
        let event = |growth: Growth| Event { sample_m, tree: 0, nearest, growth };
        let from = self.tree.point(nearest);
        let length = squared.sqrt();
        let step_m = context.settings.step_m;
        let to = if length > step_m { between(from, sample_m, step_m / length) } else { sample_m };
        if length == 0.0 || !context.is_edge_free(from, to) {
            return event(Growth::Blocked { vertex: nearest });
        }
        self.find_near(to, context);
        let vertex = self.add(to, nearest, length.min(step_m), context);
        self.rewire(vertex, context);
        self.reach_for_goal(vertex, context);
        match self.update_best() {
            Some(length_m) => event(Growth::Found { vertex, length_m }),
            None => event(Growth::Grew { vertex }),
        }
    }

    pub(crate) fn path(&self) -> Option<Path> {
        self.best.map(|best| self.tree.path_to(best.vertex))
    }

    pub(crate) fn length_m(&self) -> Option<f64> {
        self.best.map(|best| best.length_m)
    }

    pub(crate) const fn tree(&self) -> &Tree {
        &self.tree
    }

    pub(crate) fn into_tree(self) -> Tree {
        self.tree
    }

    /// The vertices within the radius that keeps RRT* asymptotically optimal, but not beyond one step.
    fn find_near(&mut self, point: Point2<f64>, context: &Context) {
        let [low, high] = context.space.free_box_m();
        let extent = high - low;
        let area = extent.x * extent.y;
        let count = self.points.len() as f64 + 1.0;
        let optimal = 1.1 * (3.0 * area / std::f64::consts::PI * libm::log(count) / count).sqrt();
        self.near.clear();
        let near = &mut self.near;
        self.points.for_each_within(point, optimal.min(context.settings.step_m), |vertex, squared| {
            near.push((vertex, squared.sqrt()));
        });
    }

    /// Adds a vertex under the neighbor that offers the shortest free way; `nearest` is known to be free.
    fn add(&mut self, point: Point2<f64>, nearest: u32, length: f64, context: &mut Context) -> u32 {
        let mut parent = (nearest, self.costs_m[nearest as usize] + length);
        let costs = &self.costs_m;
        self.near.sort_unstable_by(|&(a, to_a), &(b, to_b)| {
            (costs[a as usize] + to_a).total_cmp(&(costs[b as usize] + to_b)).then(a.cmp(&b))
        });
        for &(vertex, length) in &self.near {
            let cost = self.costs_m[vertex as usize] + length;
            if cost >= parent.1 {
                break;
            }
            if context.is_edge_free(self.tree.point(vertex), point) {
                parent = (vertex, cost);
                break;
            }
        }
        self.attach(point, parent.0, parent.1)
    }

    fn attach(&mut self, point: Point2<f64>, parent: u32, cost_m: f64) -> u32 {
        self.points.add(point);
        self.costs_m.push(cost_m);
        self.children.push(Vec::new());
        let vertex = self.tree.add(point, parent);
        self.children[parent as usize].push(vertex);
        vertex
    }

    /// Moves neighbors under the new vertex where that shortens their way.
    fn rewire(&mut self, vertex: u32, context: &mut Context) {
        let point = self.tree.point(vertex);
        let cost = self.costs_m[vertex as usize];
        for index in 0..self.near.len() {
            let (other, length) = self.near[index];
            let gain = self.costs_m[other as usize] - (cost + length);
            if gain > 1e-12 && context.is_edge_free(point, self.tree.point(other)) {
                if let Some(parent) = self.tree.vertices[other as usize].parent {
                    self.children[parent as usize].retain(|&child| child != other);
                }
                self.tree.vertices[other as usize].parent = Some(vertex);
                self.children[vertex as usize].push(other);
                self.shorten_subtree(other, gain);
            }
        }
    }

    fn shorten_subtree(&mut self, vertex: u32, gain: f64) {
        let mut pending = vec![vertex];
        while let Some(vertex) = pending.pop() {
            self.costs_m[vertex as usize] -= gain;
            pending.extend(&self.children[vertex as usize]);
        }
    }

    /// Adds the goal under a new vertex that is near enough to it and in sight.
    fn reach_for_goal(&mut self, vertex: u32, context: &mut Context) {
        let (point, goal_m) = (self.tree.point(vertex), context.query.goal_m);
        let length = distance(&point, &goal_m);
        let useful = self.best.is_none_or(|best| self.costs_m[vertex as usize] + length < best.length_m);
        if point == goal_m {
            self.goals.push(vertex);
        } else if useful && length <= context.settings.step_m && context.is_edge_free(point, goal_m) {
            let goal = self.attach(goal_m, vertex, self.costs_m[vertex as usize] + length);
            self.goals.push(goal);
        }
    }

    /// The length of the best path, if it has become shorter.
    fn update_best(&mut self) -> Option<f64> {
        let before = self.best.map_or(f64::INFINITY, |best| best.length_m);
        for &vertex in &self.goals {
            let length_m = self.costs_m[vertex as usize];
            if self.best.is_none_or(|best| length_m < best.length_m) {
                self.best = Some(Best { vertex, length_m });
            }
        }
        self.best.map(|best| best.length_m).filter(|&length_m| length_m < before)
    }
}

/// A sample in the ellipse of points through which a path of less than `length_m` can lead.
fn informed_sample(context: &mut Context, length_m: f64) -> Point2<f64> {
    let Query { start_m, goal_m } = context.query;
    let straight = distance(&start_m, &goal_m);
    let (half_major, half_minor) =
        (0.5 * length_m, 0.5 * (length_m * length_m - straight * straight).max(0.0).sqrt());
    let ahead = if straight > 0.0 { (goal_m - start_m) / straight } else { Vector2::x() };
    let left = Vector2::new(-ahead.y, ahead.x);
    let [low, high] = context.space.free_box_m();
    // A narrow ellipse may lie mostly off the map; the bound keeps a step from taking forever.
    for _ in 0..64 {
        let (u, v) = (context.random.range(-1.0, 1.0), context.random.range(-1.0, 1.0));
        if u * u + v * v > 1.0 {
            continue;
        }
        let (along, across) = (u * half_major, v * half_minor);
        let point = Point2::from(0.5 * (start_m.coords + goal_m.coords)) + along * ahead + across * left;
        if (0..2).all(|axis| point[axis] >= low[axis] && point[axis] <= high[axis]) {
            return point;
        }
    }
    context.uniform_sample()
}
