//! The graph of ordinary and lower-case edges: a simple temporal network, each edge with what it represents.
//!
//! Its schedule is a potential, which makes Dijkstra searches possible in spite of negative weights (Johnson, 1977).

use stn::{Checkpoint, CycleEdge, Inconsistency, PointId, Stn};

/// What an arc represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// An ordinary constraint of the network.
    Edge(u32),
    /// The lower case of a contingent link.
    Lower(u32),
    /// A path to the link's end, followed by its upper case; `node` is where the path starts.
    Bypass { link: u32, node: u32 },
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    /// The tag of an arc is its position.
    stn: Stn,
    /// By position; also of those that were refused last, as long as the cycle that they close is told.
    origins: Vec<Origin>,
}

impl Graph {
    pub(crate) fn resize(&mut self, points: usize) {
        self.stn.resize(points);
    }

    /// A schedule that keeps all arcs.
    pub(crate) fn potential(&self) -> &[i64] {
        self.stn.schedule()
    }

    pub(crate) fn origin(&self, arc: u32) -> Origin {
        self.origins[arc as usize]
    }

    /// The point where an arc ends, if it is one.
    pub(crate) fn end(&self, arc: u32) -> Option<PointId> {
        self.stn.edge(arc as usize).map(|edge| edge.to)
    }

    /// The arcs that end at a point; their tags are their positions.
    pub(crate) fn arcs_into(&self, point: u32) -> impl Iterator<Item = CycleEdge> {
        self.stn.edges_into(PointId(point))
    }

    /// The arcs of the negative cycle that was found last, in order.
    pub(crate) fn negative_cycle(&self) -> impl Iterator<Item = u32> {
        self.stn.cycle().iter().map(|edge| edge.tag)
    }

    /// Adds an arc, which [`Graph::settle`] must follow.
    pub(crate) fn push(&mut self, from: PointId, to: PointId, weight: i64, origin: Origin) {
        self.stn.push(from, to, weight, self.origins.len() as u32);
        self.origins.push(origin);
    }

    /// Makes the potential feasible after any number of arcs were pushed.
    pub(crate) fn settle(&mut self) -> Result<(), Inconsistency> {
        // The order of points mostly follows time.
        let order: Vec<PointId> = (0..self.stn.num_points() as u32).map(PointId).collect();
        self.stn.settle(&order)
    }

    /// Adds arcs that end at one point.
    pub(crate) fn insert(
        &mut self,
        to: PointId,
        arcs: impl Iterator<Item = (PointId, i64, Origin)>,
    ) -> Result<(), Inconsistency> {
        let origins = &mut self.origins;
        let tagged = arcs.map(|(from, weight, origin)| {
            origins.push(origin);
            (from, weight, origins.len() as u32 - 1)
        });
        self.stn.insert_into(to, tagged)
    }

    pub(crate) fn checkpoint(&self) -> Checkpoint {
        self.stn.checkpoint()
    }

    /// Takes back all arcs since `checkpoint`.
    pub(crate) fn rollback(&mut self, checkpoint: Checkpoint) {
        self.stn.rollback(checkpoint);
        self.origins.truncate(self.stn.num_edges());
    }
}
