//! A tree of points that a search grows, kept for display as it stands.

use nalgebra::Point2;
use serde::{Deserialize, Serialize};

use crate::path::Path;

/// Which end of the query a tree grows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Root {
    Start,
    Goal,
}

/// A point of a tree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Vertex {
    /// Meters east and north.
    pub point_m: Point2<f64>,
    /// The vertex that it was grown from; only the first vertex, the root, has none.
    pub parent: Option<u32>,
}

/// A tree of free points joined by free edges; the first vertex is the root.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tree {
    /// Where it starts.
    pub root: Root,
    /// In order of growth. RRT* changes parents later on.
    pub vertices: Vec<Vertex>,
    /// For a tree of motions, the points from each vertex's parent, without it, to the vertex; empty for a tree with
    /// straight edges.
    pub curves: Vec<Vec<Point2<f64>>>,
}

impl Tree {
    pub(crate) fn new(root: Root, point_m: Point2<f64>) -> Self {
        Self { root, vertices: vec![Vertex { point_m, parent: None }], curves: Vec::new() }
    }

    pub(crate) fn add(&mut self, point_m: Point2<f64>, parent: u32) -> u32 {
        self.vertices.push(Vertex { point_m, parent: Some(parent) });
        self.vertices.len() as u32 - 1
    }

    pub(crate) fn point(&self, vertex: u32) -> Point2<f64> {
        self.vertices[vertex as usize].point_m
    }

    /// The way from the root to a vertex.
    pub fn path_to(&self, vertex: u32) -> Path {
        let mut points_m = Vec::new();
        let mut next = Some(vertex);
        while let Some(Vertex { point_m, parent }) =
            next.and_then(|index| self.vertices.get(index as usize)).copied()
        {
            points_m.push(point_m);
            next = parent;
        }
        points_m.reverse();
        Path::new(points_m)
    }
}
