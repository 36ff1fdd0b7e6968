//! The rapidly-exploring random tree (`LaValle` 1998) as SPEC 7.2 has it.

use crate::nearest::PointTree;
use crate::path::{Path, between};
use crate::query::{Context, Event, Growth, Query};
use crate::tree::{Root, Tree};
use nalgebra::{Point2, distance};

/// One tree from the start, until a vertex can be joined to the goal.
#[derive(Clone, Debug)]
pub(crate) struct Rrt {
    tree: Tree,
    points: PointTree,
    goal: Option<u32>,
}

impl Rrt {
    pub(crate) fn new(query: Query) -> Self {
        let mut points = PointTree::default();
        points.add(query.start_m);
        Self { tree: Tree::new(Root::Start, query.start_m), points, goal: None }
    }

    pub(crate) fn step(&mut self, context: &mut Context) -> Event {
        let sample_m = context.sample();
        let goal_m = context.query.goal_m;
        let (nearest, squared) = self.points.nearest(sample_m).unwrap_or((0, 0.0));
        let event = |growth: Growth| Event { sample_m, tree: 0, nearest, growth };
        let from = self.tree.point(nearest);
        let length = squared.sqrt();
        let to = if length > context.settings.step_m {
            between(from, sample_m, context.settings.step_m / length)
        } else {
            sample_m
        };
        if length == 0.0 || !context.is_edge_free(from, to) {
            return event(Growth::Blocked { vertex: nearest });
        }
        let vertex = self.add(to, nearest);
        if to == goal_m {
            self.goal = Some(vertex);
        } else if distance(&to, &goal_m) <= context.settings.step_m && context.is_edge_free(to, goal_m) {
            self.goal = Some(self.add(goal_m, vertex));
        }
        match self.goal {
            Some(vertex) => event(Growth::Found { vertex, length_m: self.tree.path_to(vertex).length_m() }),
            None => event(Growth::Grew { vertex }),
        }
    }

    pub(crate) fn path(&self) -> Option<Path> {
        self.goal.map(|vertex| self.tree.path_to(vertex))
    }

    pub(crate) const fn tree(&self) -> &Tree {
        &self.tree
    }

    pub(crate) fn into_tree(self) -> Tree {
        self.tree
    }

    fn add(&mut self, point_m: Point2<f64>, parent: u32) -> u32 {
        self.points.add(point_m);
        self.tree.add(point_m, parent)
    }
}
