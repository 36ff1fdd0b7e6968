//! Distances: one row on demand, windows relative to a point, or all pairs.
//!
//! With a feasible potential every edge has a reduced weight that is not negative, so rows are Dijkstra searches
//! (Johnson, 1977). Where the caller knows a good order, sweeps are faster still.

use crate::network::{NONE, Overflow, PointId, Stn, Window};

/// The distance where there is no path.
pub const INFINITE: i64 = i64::MAX;

/// All distances of a network: `get(from, to)` is the least upper bound of `to − from`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DistanceMatrix {
    points: usize,
    distances: Vec<i64>,
}

impl DistanceMatrix {
    /// The least upper bound of `to − from`, or [`INFINITE`].
    pub fn get(&self, from: PointId, to: PointId) -> i64 {
        self.distances[from.index() * self.points + to.index()]
    }

    /// Returns how many points there are.
    pub fn num_points(&self) -> usize {
        self.points
    }
}

impl Stn {
    /// Writes into `row` the distance from `source` to every point, [`INFINITE`] where there is no path.
    /// Takes `O(edges · log points)` time.
    pub fn distances_from(&mut self, source: PointId, row: &mut Vec<i64>) -> Result<(), Overflow> {
        self.dijkstra::<true>(source, row)
    }

    /// Writes into `row` the distance from every point to `target`.
    pub fn distances_to(&mut self, target: PointId, row: &mut Vec<i64>) -> Result<(), Overflow> {
        self.dijkstra::<false>(target, row)
    }

    /// The distance from every point to every point: Johnson's algorithm, `O(points · edges · log points)`.
    pub fn all_pairs(&mut self) -> Result<DistanceMatrix, Overflow> {
        let points = self.num_points();
        let mut distances = Vec::with_capacity(points * points);
        let mut row = Vec::new();
        for source in 0..points as u32 {
            self.distances_from(PointId(source), &mut row)?;
            distances.extend_from_slice(&row);
        }
        Ok(DistanceMatrix { points, distances })
    }

    /// The window of every point relative to `origin`.
    pub fn windows(&mut self, origin: PointId) -> Result<Vec<Window>, Overflow> {
        let (mut latest, mut least) = (Vec::new(), Vec::new());
        self.distances_from(origin, &mut latest)?;
        self.distances_to(origin, &mut least)?;
        Ok(latest
            .iter()
            .zip(&least)
            .map(|(&latest, &least)| Window {
                earliest: (least != INFINITE).then(|| -least),
                latest: (latest != INFINITE).then_some(latest),
            })
            .collect())
    }

    /// As [`Stn::distances_from`] and [`Stn::distances_to`] at once, by sweeps along `order`, which lists every point
    /// that can be reached: a few times the number of edges where the order suits the network.
    pub fn sweep_distances(
        &mut self,
        origin: PointId,
        order: &[PointId],
        from_origin: &mut Vec<i64>,
        to_origin: &mut Vec<i64>,
    ) -> Result<(), Overflow> {
        for row in [&mut *from_origin, &mut *to_origin] {
            row.clear();
            row.resize(self.num_points(), INFINITE);
            row[origin.index()] = 0;
        }
        self.dirty[origin.index()] = true;
        self.relax_sweeps::<true>(order, from_origin)?;
        self.dirty[origin.index()] = true;
        self.relax_sweeps::<false>(order, to_origin)
    }

    /// Brings distances found by [`Stn::sweep_distances`] when there were `first_edge` edges up to date with those
    /// inserted since; the earlier ones must still be there.
    pub fn tighten_distances(
        &mut self,
        first_edge: usize,
        order: &[PointId],
        from_origin: &mut [i64],
        to_origin: &mut [i64],
    ) -> Result<(), Overflow> {
        for edge in &self.edges[first_edge..] {
            self.dirty[edge.from as usize] |= from_origin[edge.from as usize] != INFINITE;
        }
        self.relax_sweeps::<true>(order, from_origin)?;
        for edge in &self.edges[first_edge..] {
            self.dirty[edge.to as usize] |= to_origin[edge.to as usize] != INFINITE;
        }
        self.relax_sweeps::<false>(order, to_origin)
    }

    /// Relaxes the edges at dirty points until none is left.
    fn relax_sweeps<const FORWARDS: bool>(
        &mut self,
        order: &[PointId],
        row: &mut [i64],
    ) -> Result<(), Overflow> {
        let mut ascending = true;
        loop {
            let mut moved = false;
            let mut visit = |point: PointId| -> Result<(), Overflow> {
                let point = point.index();
                if !self.dirty[point] {
                    return Ok(());
                }
                self.dirty[point] = false;
                let distance = row[point];
                let mut next = if FORWARDS { self.first_out[point] } else { self.first_in[point] };
                while next != NONE {
                    let edge = &self.edges[next as usize];
                    let target = if FORWARDS { edge.to } else { edge.from } as usize;
                    let reached = distance.checked_add(edge.weight).ok_or(Overflow::at(target))?;
                    if reached < row[target] {
                        row[target] = reached;
                        self.dirty[target] = true;
                        moved = true;
                    }
                    next = if FORWARDS { edge.next_out } else { edge.next_in };
                }
                Ok(())
            };
            let result = if ascending {
                order.iter().try_for_each(|&point| visit(point))
            } else {
                order.iter().rev().try_for_each(|&point| visit(point))
            };
            if result.is_err() {
                self.dirty.fill(false);
                return result;
            }
            if !moved {
                return Ok(());
            }
            ascending = !ascending;
        }
    }

    fn dijkstra<const FORWARDS: bool>(
        &mut self,
        origin: PointId,
        row: &mut Vec<i64>,
    ) -> Result<(), Overflow> {
        row.clear();
        row.resize(self.num_points(), INFINITE);
        // Keys are reduced distances; `scratch` holds them, `row` the true ones.
        self.scratch.clear();
        self.scratch.resize(self.num_points(), INFINITE);
        self.heap.clear();
        self.scratch[origin.index()] = 0;
        row[origin.index()] = 0;
        self.heap.push(0, origin.0);
        while let Some((key, point)) = self.heap.pop() {
            let point = point as usize;
            if self.scratch[point] != key {
                continue;
            }
            let mut next = if FORWARDS { self.first_out[point] } else { self.first_in[point] };
            while next != NONE {
                let edge = &self.edges[next as usize];
                let target = if FORWARDS { edge.to } else { edge.from } as usize;
                let reduced = self.potential[edge.from as usize]
                    .checked_add(edge.weight)
                    .and_then(|time| time.checked_sub(self.potential[edge.to as usize]))
                    .and_then(|reduced| key.checked_add(reduced))
                    .ok_or(Overflow::at(target))?;
                if reduced < self.scratch[target] {
                    self.scratch[target] = reduced;
                    row[target] = row[point].checked_add(edge.weight).ok_or(Overflow::at(target))?;
                    self.heap.push(reduced, target as u32);
                }
                next = if FORWARDS { edge.next_out } else { edge.next_in };
            }
        }
        Ok(())
    }
}
