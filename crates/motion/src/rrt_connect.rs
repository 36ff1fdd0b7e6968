//! RRT-Connect (Kuffner and `LaValle` 2000): two trees, each reaching for what the other has just grown.

use crate::nearest::PointTree;
use crate::path::{Path, between};
use crate::query::{Context, Event, Growth, Query};
use crate::tree::{Root, Tree};
use nalgebra::{Point2, distance};

/// A tree from the start and one from the goal, until they meet.
#[derive(Clone, Debug)]
pub(crate) struct RrtConnect {
    trees: [Tree; 2],
    points: [PointTree; 2],
    /// The tree that grows toward the next sample.
    next: usize,
    /// The vertices of both trees at which they met.
    meeting: Option<[u32; 2]>,
}

impl RrtConnect {
    pub(crate) fn new(query: Query) -> Self {
        let mut points = [PointTree::default(), PointTree::default()];
        points[0].add(query.start_m);
        points[1].add(query.goal_m);
        Self {
            trees: [Tree::new(Root::Start, query.start_m), Tree::new(Root::Goal, query.goal_m)],
            points,
            next: 0,
            meeting: None,
        }
    }

    pub(crate) fn step(&mut self, context: &mut Context) -> Event {
        let (grown, other) = (self.next, 1 - self.next);
        self.next = other;
        // The first sample of each tree is the other's root: a goal in plain sight is found at once.
        let sample_m = match context.statistics.samples {
            1 => context.query.goal_m,
            2 => context.query.start_m,
            _ => context.uniform_sample(),
        };
        let (nearest, _) = self.points[grown].nearest(sample_m).unwrap_or((0, 0.0));
        let event = |growth: Growth| Event { sample_m, tree: grown as u32, nearest, growth };
        let vertex = self.extend(grown, nearest, sample_m, context);
        let Some(vertex) = vertex else { return event(Growth::Blocked { vertex: nearest }) };
        let target = self.trees[grown].point(vertex);
        let (mut reached, _) = self.points[other].nearest(target).unwrap_or((0, 0.0));
        while self.trees[other].point(reached) != target {
            match self.extend(other, reached, target, context) {
                Some(next) => reached = next,
                None => return event(Growth::Grew { vertex }),
            }
        }
        self.meeting = Some(if grown == 0 { [vertex, reached] } else { [reached, vertex] });
        let length_m = self.path().map_or(0.0, |path| path.length_m());
        event(Growth::Found { vertex, length_m })
    }

    pub(crate) fn path(&self) -> Option<Path> {
        let [from_start, from_goal] = self.meeting?;
        let mut path = self.trees[0].path_to(from_start);
        // Both trees have a vertex at the meeting point.
        path.points_m.extend(self.trees[1].path_to(from_goal).points_m.into_iter().rev().skip(1));
        Some(path)
    }

    pub(crate) const fn trees(&self) -> &[Tree; 2] {
        &self.trees
    }

    pub(crate) fn into_trees(self) -> [Tree; 2] {
        self.trees
    }

    /// Adds a vertex one step from another toward a target, if the way is free.
    fn extend(&mut self, tree: usize, from: u32, target: Point2<f64>, context: &mut Context) -> Option<u32> {
        let start = self.trees[tree].point(from);
        let length = distance(&start, &target);
        let to = if length > context.settings.step_m {
            between(start, target, context.settings.step_m / length)
        } else {
            target
        };
        if length == 0.0 || !context.is_edge_free(start, to) {
            return None;
        }
        self.points[tree].add(to);
        Some(self.trees[tree].add(to, from))
    }
}
