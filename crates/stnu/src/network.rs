//! The network as data: time points, constraints, and links whose ends the environment chooses. It grows and is taken
//! back by trail; nothing is derived here.

use std::fmt;

pub use stn::PointId;

/// An ordinary constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EdgeId(pub u32);

/// A contingent link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LinkId(pub u32);

macro_rules! index {
    ($($id:ident),*) => {$(
        impl $id {
            /// The position in vectors indexed by it.
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}
index!(EdgeId, LinkId);

/// A requirement on the executive: `to − from ≤ weight`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Edge {
    /// Where the edge of the distance graph starts.
    pub from: PointId,
    /// Where it ends.
    pub to: PointId,
    pub weight: i64,
}

/// A duration that nature chooses: the executive decides when the activation happens, and sees when the end does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Link {
    /// What starts the duration.
    pub activation: PointId,
    /// What ends it; the environment's.
    pub end: PointId,
    /// The shortest duration, at least 0.
    pub lower: i64,
    /// The longest duration, at least the shortest.
    pub upper: i64,
}

impl Link {
    /// By how much the end is uncertain.
    pub const fn spread(&self) -> i64 {
        // Both bounds are at least 0.
        self.upper - self.lower
    }
}

/// Why a contingent link cannot be added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkError {
    /// Not `0 ≤ lower ≤ upper`.
    Range,
    /// A time point is not of the network.
    Point,
    /// Another link ends there.
    EndTaken(LinkId),
    /// The activation is the end itself, or only happens after it.
    Circular,
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Range => "the bounds of a contingent link must satisfy 0 ≤ minimum ≤ maximum",
            Self::Point => "both ends of a contingent link must be points of the network",
            Self::EndTaken(_) => "a time point can end only one contingent link",
            Self::Circular => "a contingent link cannot be activated by its own end",
        })
    }
}

impl std::error::Error for LinkError {}

/// How much there was of a network at some moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NetworkSize {
    pub(crate) points: usize,
    pub(crate) edges: usize,
    pub(crate) links: usize,
}

/// A simple temporal network with uncertainty (STNU; Vidal and Fargier, 1999).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Network {
    points: usize,
    edges: Vec<Edge>,
    links: Vec<Link>,
    /// By point, the link that ends there.
    ending: Vec<Option<LinkId>>,
}

impl Network {
    /// A network of `points` time points without constraints.
    pub fn new(points: usize) -> Self {
        Self { points, edges: Vec::new(), links: Vec::new(), ending: vec![None; points] }
    }

    /// Adds a time point.
    pub fn add_point(&mut self) -> PointId {
        self.points += 1;
        self.ending.push(None);
        PointId(self.points as u32 - 1)
    }

    /// Adds `to − from ≤ weight`. Both points must be of the network.
    pub fn add_edge(&mut self, from: PointId, to: PointId, weight: i64) -> EdgeId {
        assert!(from.index() < self.points && to.index() < self.points, "points of the network");
        self.edges.push(Edge { from, to, weight });
        EdgeId(self.edges.len() as u32 - 1)
    }

    /// Adds a contingent link.
    pub fn add_link(&mut self, link: Link) -> Result<LinkId, LinkError> {
        if link.lower < 0 || link.upper < link.lower {
            return Err(LinkError::Range);
        }
        if link.activation.index() >= self.points || link.end.index() >= self.points {
            return Err(LinkError::Point);
        }
        if let Some(other) = self.ending[link.end.index()] {
            return Err(LinkError::EndTaken(other));
        }
        let mut before = link.activation;
        while let Some(earlier) = self.ending[before.index()] {
            before = self.links[earlier.index()].activation;
        }
        // The points from the activation back to the root have ends before them; this end has none, so that it can
        // only be the root.
        if before == link.end {
            return Err(LinkError::Circular);
        }
        let id = LinkId(self.links.len() as u32);
        self.links.push(link);
        self.ending[link.end.index()] = Some(id);
        Ok(id)
    }

    /// Returns how many time points there are.
    pub const fn num_points(&self) -> usize {
        self.points
    }

    /// The ordinary constraints.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The contingent links.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// One constraint.
    pub fn edge(&self, id: EdgeId) -> &Edge {
        &self.edges[id.index()]
    }

    /// One contingent link.
    pub fn link(&self, id: LinkId) -> &Link {
        &self.links[id.index()]
    }

    /// The contingent link that ends at `point`: then the environment executes it.
    pub fn link_ending_at(&self, point: PointId) -> Option<LinkId> {
        self.ending[point.index()]
    }

    /// Gives a constraint another weight.
    pub fn set_weight(&mut self, id: EdgeId, weight: i64) {
        self.edges[id.index()].weight = weight;
    }

    /// Gives a contingent link another range.
    pub fn set_range(&mut self, id: LinkId, lower: i64, upper: i64) -> Result<(), LinkError> {
        if lower < 0 || upper < lower {
            return Err(LinkError::Range);
        }
        let link = &mut self.links[id.index()];
        (link.lower, link.upper) = (lower, upper);
        Ok(())
    }

    /// A place to come back to with [`Network::rollback`].
    pub const fn size(&self) -> NetworkSize {
        NetworkSize { points: self.points, edges: self.edges.len(), links: self.links.len() }
    }

    /// Takes back everything added since, in time linear in it.
    pub fn rollback(&mut self, size: NetworkSize) {
        for link in self.links.drain(size.links..) {
            self.ending[link.end.index()] = None;
        }
        self.edges.truncate(size.edges);
        self.ending.truncate(size.points);
        self.points = size.points;
    }
}
