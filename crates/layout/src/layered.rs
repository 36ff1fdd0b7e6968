//! Irregular graphs: nodes in columns, arcs through slots of their own, after Sugiyama, Tagawa and Toda (1981).
//!
//! Only what is left of an imported network after everything in series or side by side has been taken out comes here.
//! Columns by longest path, order by a few barycenter sweeps, heights by least squares (pool adjacent violators).

use display::geometry::{Piece, Point};

use crate::metrics::{GUTTER, LANE_GAP, TEXT_PAD};
use crate::size::{Size, Sizes};
use crate::tree::Core;

/// Where the nodes and edges of a core are, relative to its start node.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CoreLayout {
    pub(crate) size: Size,
    pub(crate) nodes: Vec<Point>,
    pub(crate) edges: Vec<EdgeLayout>,
}

/// The way of one edge: from its node to a slot, along the slot, and on to its other node.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct EdgeLayout {
    pub(crate) way_in: Vec<Piece>,
    pub(crate) slot: Point,
    pub(crate) slot_width: f64,
    pub(crate) way_out: Vec<Piece>,
}

/// Barycenter sweeps to and fro.
const SWEEPS: usize = 16;
/// Edges pass through this many places per node or edge at most; beyond, long edges go straight.
const PLACES_PER_EDGE: usize = 8;

/// Something that is in a column: a node, the slot of an edge, or a place that an edge passes.
#[derive(Clone, Copy, Debug, Default)]
struct Vertex {
    column: u32,
    width: f64,
    above: f64,
    below: f64,
    y: f64,
}

struct Columns {
    vertices: Vec<Vertex>,
    /// The vertices of each column, from top to bottom.
    members: Vec<Vec<u32>>,
    before: Vec<Vec<u32>>,
    after: Vec<Vec<u32>>,
}

/// Lays out `core`; its parts must have their sizes.
pub(crate) fn arrange(sizes: &Sizes<'_>, core: &Core) -> CoreLayout {
    let ranks = ranks(core);
    let last = ranks.last().copied().unwrap_or(0) * 2;
    let mut columns = Columns {
        vertices: Vec::new(),
        members: vec![Vec::new(); last as usize + 1],
        before: Vec::new(),
        after: Vec::new(),
    };
    for (node, &rank) in core.nodes.iter().zip(&ranks) {
        let clearance = sizes.clearance(*node);
        let half = clearance.radius.max(clearance.beneath);
        columns.add(Vertex {
            column: rank * 2,
            width: 2.0 * half,
            above: clearance.radius,
            below: clearance.below,
            y: 0.0,
        });
    }
    let most_places = PLACES_PER_EDGE * (core.nodes.len() + core.edges.len());
    let mut chains = Vec::with_capacity(core.edges.len());
    for &(from, to, part) in &core.edges {
        let size = sizes.of(part);
        let column = ranks[from as usize] * 2 + 1;
        let slot = columns.add(Vertex {
            column,
            width: size.width,
            above: size.above.max(TEXT_PAD),
            below: size.below.max(TEXT_PAD),
            y: 0.0,
        });
        columns.join(from, slot);
        let mut chain = vec![slot];
        let end_column = ranks[to as usize] * 2;
        if columns.vertices.len() < most_places {
            for column in column + 1..end_column {
                let vertex = Vertex { column, width: 0.0, above: TEXT_PAD, below: TEXT_PAD, y: 0.0 };
                let place = columns.add(vertex);
                columns.join(chain[chain.len() - 1], place);
                chain.push(place);
            }
        }
        columns.join(chain[chain.len() - 1], to);
        chains.push(chain);
    }
    columns.order();
    columns.spread();
    columns.layout(core, &chains)
}

/// The longest path from the start to each node, in edges; the end comes after all others.
fn ranks(core: &Core) -> Vec<u32> {
    let mut ranks = vec![0; core.nodes.len()];
    let mut outgoing = vec![Vec::new(); core.nodes.len()];
    for &(from, to, _) in &core.edges {
        outgoing[from as usize].push(to);
    }
    for from in 0..core.nodes.len() {
        for &to in &outgoing[from] {
            ranks[to as usize] = ranks[to as usize].max(ranks[from] + 1);
        }
    }
    ranks
}

impl Columns {
    fn add(&mut self, vertex: Vertex) -> u32 {
        let id = self.vertices.len() as u32;
        self.members[vertex.column as usize].push(id);
        self.vertices.push(vertex);
        self.before.push(Vec::new());
        self.after.push(Vec::new());
        id
    }

    fn join(&mut self, from: u32, to: u32) {
        self.after[from as usize].push(to);
        self.before[to as usize].push(from);
    }

    /// Orders each column by the mean position of the neighbors in the column before, then after, and so on; keeps the
    /// order with the fewest crossings. Neighbors with the same mean change places in every second round, so that
    /// a tie is tried both ways.
    fn order(&mut self) {
        let mut position = vec![0.0; self.vertices.len()];
        let mut best = (self.crossings(), self.members.clone());
        for sweep in 0..SWEEPS {
            let forwards = sweep % 2 == 0;
            let count = self.members.len();
            for step in 0..count {
                let column = if forwards { step } else { count - 1 - step };
                self.order_column(column, forwards, sweep as u32 / 2, &mut position);
            }
            let crossings = self.crossings();
            if crossings < best.0 {
                best = (crossings, self.members.clone());
            }
        }
        self.members = best.1;
    }

    fn order_column(&mut self, column: usize, forwards: bool, variation: u32, position: &mut [f64]) {
        let neighbors = if forwards { &self.before } else { &self.after };
        let members = self.members[column].iter().enumerate();
        let mut keyed: Vec<(f64, u32)> = members
            .map(|(at, &vertex)| {
                let near = &neighbors[vertex as usize];
                let sum: f64 = near.iter().map(|&other| position[other as usize]).sum();
                (if near.is_empty() { at as f64 } else { sum / near.len() as f64 }, vertex)
            })
            .collect();
        let tie =
            |vertex: u32| vertex.wrapping_mul(variation.wrapping_mul(0x9E37_79B9)).rotate_left(variation * 5);
        keyed.sort_by(|left, right| left.0.total_cmp(&right.0).then(tie(left.1).cmp(&tie(right.1))));
        let size = keyed.len() as f64;
        for (at, &(_, vertex)) in keyed.iter().enumerate() {
            // Fractions of the column, so that columns of different sizes compare.
            position[vertex as usize] = (at as f64 + 0.5) / size;
        }
        self.members[column] = keyed.into_iter().map(|(_, vertex)| vertex).collect();
    }

    /// Returns how many pairs of lines between neighboring columns cross, counted by a tree of partial sums (Barth,
    /// Mutzel and Jünger 2004).
    fn crossings(&self) -> usize {
        let mut place = vec![0_usize; self.vertices.len()];
        for column in &self.members {
            for (at, &vertex) in column.iter().enumerate() {
                place[vertex as usize] = at;
            }
        }
        let mut count = 0;
        for (column, members) in self.members.iter().enumerate() {
            let width = self.members.get(column + 1).map_or(0, Vec::len);
            let mut sums = vec![0_usize; width + 1];
            let mut total = 0;
            for &vertex in members {
                let mut ends: Vec<usize> = self.after[vertex as usize]
                    .iter()
                    .filter(|&&other| self.vertices[other as usize].column as usize == column + 1)
                    .map(|&other| place[other as usize])
                    .collect();
                ends.sort_unstable();
                for &end in &ends {
                    let (mut at, mut up_to_end) = (end + 1, 0);
                    while at > 0 {
                        up_to_end += sums[at];
                        at &= at - 1;
                    }
                    count += total - up_to_end;
                }
                for end in ends {
                    let mut at = end + 1;
                    while at <= width {
                        sums[at] += 1;
                        at += at & at.wrapping_neg();
                    }
                    total += 1;
                }
            }
        }
        count
    }

    /// Gives each vertex a height near the mean of its neighbors', in the order of its column.
    fn spread(&mut self) {
        for column in 0..self.members.len() {
            let desired = vec![0.0; self.members[column].len()];
            self.place_column(column, &desired);
        }
        for sweep in 0..SWEEPS {
            let count = self.members.len();
            for step in 0..count {
                let column = if sweep % 2 == 0 { step } else { count - 1 - step };
                let desired: Vec<f64> =
                    self.members[column].iter().map(|&vertex| self.mean_height(vertex)).collect();
                self.place_column(column, &desired);
            }
        }
    }

    fn mean_height(&self, vertex: u32) -> f64 {
        let near = self.before[vertex as usize].iter().chain(&self.after[vertex as usize]);
        let (sum, count) = near
            .fold((0.0, 0.0), |(sum, count), &other| (sum + self.vertices[other as usize].y, count + 1.0));
        if count == 0.0 { self.vertices[vertex as usize].y } else { sum / count }
    }

    /// The heights nearest to `desired`, in least squares, that keep the column's order and distances.
    fn place_column(&mut self, column: usize, desired: &[f64]) {
        let members = &self.members[column];
        let mut separation = 0.0;
        let mut separations = Vec::with_capacity(members.len());
        let mut pools: Vec<(f64, f64)> = Vec::with_capacity(members.len());
        for (at, &vertex) in members.iter().enumerate() {
            if at > 0 {
                let above = &self.vertices[members[at - 1] as usize];
                separation += above.below + LANE_GAP + self.vertices[vertex as usize].above;
            }
            separations.push(separation);
            pools.push((desired[at] - separation, 1.0));
            while let [.., (upper, upper_count), (lower, lower_count)] = pools[..]
                && upper > lower
            {
                let count = upper_count + lower_count;
                pools.truncate(pools.len() - 2);
                pools.push(((upper * upper_count + lower * lower_count) / count, count));
            }
        }
        let mut at = 0;
        for (height, count) in pools {
            for _ in 0..count as usize {
                self.vertices[self.members[column][at] as usize].y = height.floor() + separations[at];
                at += 1;
            }
        }
    }

    fn layout(&mut self, core: &Core, chains: &[Vec<u32>]) -> CoreLayout {
        // The ends of a core are on one line, whatever lies between.
        let last = core.nodes.len().saturating_sub(1);
        let line = self.vertices.first().map_or(0.0, |start| start.y);
        if let Some(end) = self.vertices.get_mut(last) {
            end.y = line;
        }
        let (lefts, widths) = self.column_places();
        let center = |vertex: &Vertex| {
            let column = vertex.column as usize;
            Point::new(lefts[column] + widths[column] / 2.0, vertex.y - line)
        };
        let origin = self.vertices.first().map_or(0.0, |start| center(start).x);
        let nodes: Vec<Point> = self.vertices[..core.nodes.len()]
            .iter()
            .map(|vertex| center(vertex).shifted(-origin, 0.0))
            .collect();
        let mut edges = Vec::with_capacity(chains.len());
        for (chain, &(from, to, _)) in chains.iter().zip(&core.edges) {
            let place = |vertex: u32| {
                let vertex = &self.vertices[vertex as usize];
                let column = vertex.column as usize;
                let left = Point::new(lefts[column] - origin, vertex.y - line);
                (left, left.shifted(widths[column], 0.0))
            };
            let (slot, slot_right) = place(chain[0]);
            let slot_width = self.vertices[chain[0] as usize].width;
            let mut way_out = vec![Piece::Line(slot_right)];
            let mut at = slot_right;
            for &passed in &chain[1..] {
                let (left, right) = place(passed);
                way_out.extend([level_curve(at, left), Piece::Line(right)]);
                at = right;
            }
            way_out.push(level_curve(at, nodes[to as usize]));
            let way_in = vec![level_curve(nodes[from as usize], slot)];
            edges.push(EdgeLayout { way_in, slot, slot_width, way_out });
        }
        let above = self.vertices.iter().map(|vertex| line - vertex.y + vertex.above).fold(0.0, f64::max);
        let below = self.vertices.iter().map(|vertex| vertex.y - line + vertex.below).fold(0.0, f64::max);
        let width = nodes.last().map_or(0.0, |end| end.x);
        CoreLayout { size: Size { width, above, below }, nodes, edges }
    }

    /// The left edge and the width of each column.
    fn column_places(&self) -> (Vec<f64>, Vec<f64>) {
        let mut lefts = Vec::with_capacity(self.members.len());
        let mut widths = Vec::with_capacity(self.members.len());
        let mut left = 0.0;
        for column in &self.members {
            let width = column.iter().map(|&vertex| self.vertices[vertex as usize].width).fold(0.0, f64::max);
            let width = (width / 2.0).ceil() * 2.0;
            lefts.push(left);
            widths.push(width);
            left += width + GUTTER.0 + (4.0 * column.len() as f64).min(GUTTER.1);
        }
        (lefts, widths)
    }
}

/// A curve that leaves and arrives level.
pub(crate) fn level_curve(from: Point, to: Point) -> Piece {
    if from.y == to.y {
        return Piece::Line(to);
    }
    let middle = f64::midpoint(from.x, to.x);
    Piece::Cubic(Point::new(middle, from.y), Point::new(middle, to.y), to)
}
