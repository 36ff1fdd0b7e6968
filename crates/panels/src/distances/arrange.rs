//! Where the vertices of a distance graph stand: in columns, each after those that come before it, and ordered within
//! them so that edges cross little, after Sugiyama, Tagawa and Toda (1981).

use display::{Point, Rect};

use super::graph::{DistanceGraph, Edge};

/// A graph with places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arranged {
    /// The middle of each vertex.
    pub places: Vec<Point>,
    /// The way of each edge, from vertex to vertex.
    pub ways: Vec<Vec<Point>>,
    /// Everything lies inside.
    pub bounds: Rect,
}

/// From column to column, without the names.
const COLUMN_GAP: f64 = 96.0;
/// From row to row.
const ROW_GAP: f64 = 64.0;
/// How far the two directions between vertices are apart.
const LANE: f64 = 7.0;
/// Barycenter sweeps to and fro.
const SWEEPS: usize = 12;

/// Something that is in a column: a vertex, or a place that a long edge passes.
struct Slots {
    column: Vec<usize>,
    before: Vec<Vec<usize>>,
    after: Vec<Vec<usize>>,
    members: Vec<Vec<usize>>,
}

/// Finds places; `widths` are those of the vertices.
pub fn arrange(graph: &DistanceGraph, widths: &[f64]) -> Arranged {
    let count = graph.vertices.len();
    let pairs = pairs(graph);
    let columns = columns(count, &pairs);
    let mut slots = Slots {
        before: vec![Vec::new(); count],
        after: vec![Vec::new(); count],
        members: vec![Vec::new(); columns.iter().max().map_or(0, |last| last + 1)],
        column: columns,
    };
    for slot in 0..count {
        slots.members[slots.column[slot]].push(slot);
    }
    let chains: Vec<Vec<usize>> = pairs.iter().map(|&(from, to)| slots.connect(from, to)).collect();
    slots.order();
    let rows = slots.rows();
    let mut left = 0.0;
    let mut middles = Vec::new();
    for members in &slots.members {
        let width = members.iter().filter_map(|&slot| widths.get(slot)).copied().fold(24.0, f64::max);
        middles.push(left + width / 2.0);
        left += width + COLUMN_GAP;
    }
    let place = |slot: usize| Point::new(middles[slots.column[slot]], rows[slot] * ROW_GAP);
    let places: Vec<Point> = (0..count).map(place).collect();
    let ways = graph.edges.iter().map(|edge| {
        let at = pairs.iter().position(|&(from, to)| (from, to) == ordered(&slots.column, edge));
        let mut way: Vec<Point> =
            at.map_or_else(Vec::new, |at| chains[at].iter().map(|&slot| place(slot)).collect());
        let is_forward = ordered(&slots.column, edge) == (edge.from, edge.to);
        // From side to side of the names, not from middle to middle.
        if let [first, .., last] = way.as_mut_slice()
            && last.x > first.x
        {
            let (left, right) = ordered(&slots.column, edge);
            first.x += widths.get(left).copied().unwrap_or_default() / 2.0;
            last.x -= widths.get(right).copied().unwrap_or_default() / 2.0;
        }
        if !is_forward {
            way.reverse();
        }
        beside(&way, LANE)
    });
    let ways: Vec<Vec<Point>> = ways.collect();
    let mut bounds = places
        .iter()
        .zip(widths)
        .map(|(place, width)| {
            Rect::new(place.x - width / 2.0, place.y - 22.0, place.x + width / 2.0, place.y + 22.0)
        })
        .reduce(Rect::union)
        .unwrap_or_default();
    for point in ways.iter().flatten() {
        bounds = bounds.union(Rect { min: *point, max: *point });
    }
    Arranged { places, ways, bounds: bounds.expanded(12.0) }
}

/// The ends of an edge, the one further to the left first.
fn ordered(column: &[usize], edge: &Edge) -> (usize, usize) {
    let (from, to) = (edge.from, edge.to);
    if (column[from], from) <= (column[to], to) { (from, to) } else { (to, from) }
}

/// Returns which vertices are connected, the earlier one first: a bound from below says which that is.
fn pairs(graph: &DistanceGraph) -> Vec<(usize, usize)> {
    let mut pairs: Vec<(usize, usize)> = graph
        .edges
        .iter()
        .map(|edge| if edge.weight > exact::Time::ZERO { (edge.from, edge.to) } else { (edge.to, edge.from) })
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    // Both directions are one pair; that of the bound from above counts.
    let known = pairs.clone();
    let has_upper = |&(from, to): &(usize, usize)| {
        graph.edges.iter().any(|edge| (edge.from, edge.to) == (from, to) && edge.weight > exact::Time::ZERO)
    };
    pairs.retain(|&(from, to)| {
        let is_twice = known.binary_search(&(to, from)).is_ok();
        !is_twice
            || has_upper(&(from, to)) && (!has_upper(&(to, from)) || from < to)
            || (!has_upper(&(to, from)) && !has_upper(&(from, to)) && from < to)
    });
    pairs
}

/// The column of each vertex: one after the last of those before it. What goes in cycles is cut where it is met.
fn columns(count: usize, pairs: &[(usize, usize)]) -> Vec<usize> {
    let mut after = vec![Vec::new(); count];
    let mut waiting = vec![0_usize; count];
    for &(from, to) in pairs {
        after[from].push(to);
        waiting[to] += 1;
    }
    let mut column = vec![0; count];
    let mut is_done = vec![false; count];
    for _ in 0..count {
        let free =
            (0..count).filter(|&vertex| !is_done[vertex]).min_by_key(|&vertex| (waiting[vertex], vertex));
        let Some(next) = free else { break };
        is_done[next] = true;
        for &to in &after[next] {
            if !is_done[to] {
                waiting[to] -= 1;
                column[to] = column[to].max(column[next] + 1);
            }
        }
    }
    column
}

impl Slots {
    /// Connects two vertices through every column between theirs; answers the slots passed, ends included.
    fn connect(&mut self, from: usize, to: usize) -> Vec<usize> {
        let (from, to) = if self.column[from] <= self.column[to] { (from, to) } else { (to, from) };
        let mut chain = vec![from];
        let mut last = from;
        for column in self.column[from] + 1..self.column[to] {
            let slot = self.column.len();
            self.column.push(column);
            self.before.push(Vec::new());
            self.after.push(Vec::new());
            self.members[column].push(slot);
            self.link(last, slot);
            chain.push(slot);
            last = slot;
        }
        self.link(last, to);
        chain.push(to);
        chain
    }

    fn link(&mut self, from: usize, to: usize) {
        self.after[from].push(to);
        self.before[to].push(from);
    }

    /// Orders each column by the middle of its neighbors, to and fro.
    fn order(&mut self) {
        let mut position = vec![0.0; self.column.len()];
        for members in &self.members {
            for (at, &slot) in members.iter().enumerate() {
                position[slot] = at as f64;
            }
        }
        for sweep in 0..SWEEPS {
            let columns: Vec<usize> = match sweep % 2 {
                0 => (0..self.members.len()).collect(),
                _ => (0..self.members.len()).rev().collect(),
            };
            for column in columns {
                let neighbors = if sweep % 2 == 0 { &self.before } else { &self.after };
                let mut keyed: Vec<(f64, usize)> = self.members[column]
                    .iter()
                    .map(|&slot| (middle(&neighbors[slot], &position).unwrap_or(position[slot]), slot))
                    .collect();
                keyed.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
                self.members[column] = keyed.into_iter().map(|(_, slot)| slot).collect();
                for (at, &slot) in self.members[column].iter().enumerate() {
                    position[slot] = at as f64;
                }
            }
        }
    }

    /// The row of each slot: near its neighbors, and one apart from the others of its column.
    fn rows(&self) -> Vec<f64> {
        let mut rows = vec![0.0; self.column.len()];
        for members in &self.members {
            let first = -(members.len() as f64 - 1.0) / 2.0;
            for (at, &slot) in members.iter().enumerate() {
                rows[slot] = first + at as f64;
            }
        }
        for sweep in 0..SWEEPS {
            for members in &self.members {
                let wished: Vec<f64> = members
                    .iter()
                    .map(|&slot| {
                        let all: Vec<usize> =
                            self.before[slot].iter().chain(&self.after[slot]).copied().collect();
                        middle(&all, &rows).unwrap_or(rows[slot])
                    })
                    .collect();
                let placed = apart(&wished);
                for (&slot, row) in members.iter().zip(placed) {
                    rows[slot] = row;
                }
            }
            if sweep + 1 == SWEEPS {
                // Whole and half rows look tidy.
                for row in &mut rows {
                    *row = (*row * 2.0).round() / 2.0;
                }
                for members in &self.members {
                    let placed = apart(&members.iter().map(|&slot| rows[slot]).collect::<Vec<_>>());
                    for (&slot, row) in members.iter().zip(placed) {
                        rows[slot] = row;
                    }
                }
            }
        }
        rows
    }
}

fn middle(slots: &[usize], position: &[f64]) -> Option<f64> {
    if slots.is_empty() {
        return None;
    }
    Some(slots.iter().map(|&slot| position[slot]).sum::<f64>() / slots.len() as f64)
}

/// Rows as near to the wished ones as they can be one apart in this order: pools of those that would overlap stand
/// around the mean of what they wish.
fn apart(wished: &[f64]) -> Vec<f64> {
    let mut pools: Vec<(f64, usize)> = Vec::new();
    for (at, &wish) in wished.iter().enumerate() {
        let mut pool = (wish - at as f64, 1_usize);
        while let Some(&(value, count)) = pools.last() {
            if value <= pool.0 {
                break;
            }
            pools.pop();
            let total = count + pool.1;
            pool = ((value * count as f64 + pool.0 * pool.1 as f64) / total as f64, total);
        }
        pools.push(pool);
    }
    let values = pools.into_iter().flat_map(|(value, count)| std::iter::repeat_n(value, count));
    values.enumerate().map(|(at, value)| value + at as f64).collect()
}

/// A way moved to its right by `lane`, so that the way back lies beside it.
fn beside(way: &[Point], lane: f64) -> Vec<Point> {
    let direction = |at: usize| {
        let before = way[at.saturating_sub(1)];
        let after = way[(at + 1).min(way.len() - 1)];
        before.direction_to(after)
    };
    way.iter()
        .enumerate()
        .map(|(at, point)| {
            let along = direction(at);
            point.shifted(-along.y * -lane, along.x * -lane)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use exact::Time;
    use kirk::Constraint;
    use tpn::ArcId;

    use super::*;
    use crate::distances::graph::Vertex;

    fn graph(count: usize, bounds: &[(usize, usize, i64, i64)]) -> DistanceGraph {
        let edges = bounds.iter().enumerate().flat_map(|(arc, &(from, to, lower, upper))| {
            let arc = ArcId::from_index(arc);
            let edge = |from, to, weight: i64, constraint| Edge {
                from,
                to,
                weight: Time::from(weight),
                constraint,
                is_in_cycle: false,
            };
            [edge(from, to, upper, Constraint::Upper(arc)), edge(to, from, -lower, Constraint::Lower(arc))]
        });
        DistanceGraph { edges: edges.collect(), vertices: (0..count).map(|_| Vertex::default()).collect() }
    }

    #[test]
    fn what_comes_later_stands_further_to_the_right_and_nothing_covers_another() {
        let graph = graph(
            6,
            &[
                (0, 1, 1, 2),
                (1, 5, 1, 2),
                (0, 2, 3, 4),
                (2, 3, 1, 9),
                (3, 5, 0, 2),
                (0, 5, 1, 20),
                (0, 4, 1, 3),
                (4, 5, 1, 2),
            ],
        );
        let widths = [80.0; 6];
        let arranged = arrange(&graph, &widths);
        for edge in graph.edges.iter().filter(|edge| edge.weight > Time::ZERO) {
            assert!(arranged.places[edge.from].x < arranged.places[edge.to].x);
        }
        for (index, one) in arranged.places.iter().enumerate() {
            for other in &arranged.places[index + 1..] {
                assert!((one.x - other.x).abs() > 80.0 || (one.y - other.y).abs() > 40.0);
            }
        }
        for (edge, way) in graph.edges.iter().zip(&arranged.ways) {
            assert!(way.first().is_some_and(|start| start.distance(arranged.places[edge.from]) < 50.0));
            assert!(way.last().is_some_and(|end| end.distance(arranged.places[edge.to]) < 50.0));
        }
    }

    #[test]
    fn a_long_edge_passes_beside_what_stands_in_its_way() {
        let graph = graph(3, &[(0, 1, 1, 2), (1, 2, 1, 2), (0, 2, 1, 9)]);
        let arranged = arrange(&graph, &[60.0; 3]);
        let long = graph.edges.iter().position(|edge| (edge.from, edge.to) == (0, 2)).expect("it exists");
        let nearest = arranged.ways[long]
            .iter()
            .map(|point| point.distance(arranged.places[1]))
            .fold(f64::MAX, f64::min);
        assert!(nearest > 30.0, "{nearest}");
    }

    #[test]
    fn a_graph_that_goes_in_circles_is_arranged_all_the_same() {
        let graph = graph(3, &[(0, 1, 1, 2), (1, 2, 1, 2), (2, 0, 1, 2)]);
        assert_eq!(arrange(&graph, &[60.0; 3]).places.len(), 3);
    }
}
