//! Nearest neighbors among points that are added one by one: a k-d tree whose leaves are small buckets.
//!
//! A full bucket is split at the median of its longer side, so adding costs the depth of the tree, and points that
//! come in any order but a hostile one keep the depth logarithmic. All answers are exact; of points at the same
//! distance the one added first is the nearest.

use nalgebra::{Point2, Vector2, distance_squared};

const BUCKET_SIZE: usize = 12;

/// Points in the plane with their numbers in order of adding.
#[derive(Clone, Debug)]
pub struct PointTree {
    nodes: Vec<Node>,
    count: u32,
}

#[derive(Clone, Debug)]
enum Node {
    Split { axis: usize, at: f64, low: u32, high: u32 },
    Bucket(Vec<(Point2<f64>, u32)>),
}

impl Default for PointTree {
    fn default() -> Self {
        Self { nodes: vec![Node::Bucket(Vec::with_capacity(BUCKET_SIZE + 1))], count: 0 }
    }
}

impl PointTree {
    /// The number of points.
    pub const fn len(&self) -> usize {
        self.count as usize
    }

    /// Returns whether there is no point.
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Adds a point and returns its number: 0 for the first, then one more each time.
    pub fn add(&mut self, point: Point2<f64>) -> u32 {
        let number = self.count;
        self.count += 1;
        let mut node = 0_usize;
        loop {
            match &mut self.nodes[node] {
                Node::Split { axis, at, low, high } => {
                    node = if point[*axis] < *at { *low } else { *high } as usize;
                }
                Node::Bucket(points) => {
                    points.push((point, number));
                    if points.len() > BUCKET_SIZE {
                        self.split(node);
                    }
                    return number;
                }
            }
        }
    }

    /// The number of the nearest point and its squared distance; `None` when there is no point.
    pub fn nearest(&self, point: Point2<f64>) -> Option<(u32, f64)> {
        self.nearest_by(point, |_, squared| squared)
    }

    /// The point with the least measure and that measure. `measure` gets a point's number and its squared distance, and
    /// must not be less than that squared distance.
    pub fn nearest_by(&self, point: Point2<f64>, measure: impl Fn(u32, f64) -> f64) -> Option<(u32, f64)> {
        let mut best: Option<(u32, f64)> = None;
        self.search(0, point, Vector2::zeros(), &mut |number, squared| {
            if best.is_none_or(|(_, least)| squared <= least) {
                let value = measure(number, squared);
                if best.is_none_or(|(first, least)| value < least || (value == least && number < first)) {
                    best = Some((number, value));
                }
            }
            best.map_or(f64::INFINITY, |(_, least)| least)
        });
        best
    }

    /// Calls `visit` with the number and squared distance of every point within a distance, in no particular but always
    /// the same order.
    pub fn for_each_within(&self, point: Point2<f64>, radius: f64, mut visit: impl FnMut(u32, f64)) {
        let limit = radius * radius;
        self.search(0, point, Vector2::zeros(), &mut |number, squared| {
            if squared <= limit {
                visit(number, squared);
            }
            limit
        });
    }

    /// Visits the points of a subtree whose box may come within the limit that `visit` last returned. `offsets` are
    /// the distances from the point to the subtree's box along each axis.
    fn search(
        &self,
        node: u32,
        point: Point2<f64>,
        offsets: Vector2<f64>,
        visit: &mut impl FnMut(u32, f64) -> f64,
    ) -> f64 {
        match &self.nodes[node as usize] {
            Node::Bucket(points) => {
                let mut limit = f64::INFINITY;
                for (other, number) in points {
                    limit = visit(*number, distance_squared(&point, other));
                }
                limit
            }
            Node::Split { axis, at, low, high } => {
                let beyond = point[*axis] - at;
                let (near, far) = if beyond < 0.0 { (*low, *high) } else { (*high, *low) };
                let limit = self.search(near, point, offsets, visit);
                let mut far_offsets = offsets;
                far_offsets[*axis] = beyond;
                if far_offsets.norm_squared() <= limit {
                    self.search(far, point, far_offsets, visit)
                } else {
                    limit
                }
            }
        }
    }

    /// Replaces a full bucket by a split and two buckets. Points that all coincide stay together.
    fn split(&mut self, node: usize) {
        let (low, high) = (self.nodes.len() as u32, self.nodes.len() as u32 + 1);
        let Node::Bucket(points) = &mut self.nodes[node] else { return };
        let span = |axis: usize| {
            let values = points.iter().map(|(point, _)| point[axis]);
            values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
        };
        let axis = usize::from(span(1) > span(0));
        points
            .sort_unstable_by(|(a, first), (b, second)| a[axis].total_cmp(&b[axis]).then(first.cmp(second)));
        let least = points[0].0[axis];
        let Some(start) = (points.len() / 2..points.len())
            .chain((1..points.len() / 2).rev())
            .find(|&index| points[index].0[axis] > points[index - 1].0[axis])
        else {
            return;
        };
        let at = points[start].0[axis];
        debug_assert!(at > least, "both buckets get points");
        let mut upper = Vec::with_capacity(BUCKET_SIZE + 1);
        upper.extend(points.drain(start..));
        let lower = std::mem::take(points);
        self.nodes[node] = Node::Split { axis, at, low, high };
        self.nodes.push(Node::Bucket(lower));
        self.nodes.push(Node::Bucket(upper));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::Random;

    fn points(seed: u64, count: usize) -> Vec<Point2<f64>> {
        let mut random = Random::from_seed(seed);
        // A coarse lattice makes many equal coordinates and coincident points.
        (0..count)
            .map(|_| {
                if seed.is_multiple_of(2) {
                    Point2::new(f64::from(random.below(9)), f64::from(random.below(9)))
                } else {
                    Point2::new(random.range(-5.0, 5.0), random.range(-1.0, 1.0))
                }
            })
            .collect()
    }

    #[test]
    fn nearest_is_the_least_distance_of_all_and_the_first_of_equals() {
        for seed in 0..12 {
            let points = points(seed, 300);
            let mut tree = PointTree::default();
            assert_eq!(tree.nearest(Point2::origin()), None);
            let mut random = Random::from_seed(seed + 100);
            for (index, &point) in points.iter().enumerate() {
                assert_eq!(tree.add(point) as usize, index);
                let query = Point2::new(random.range(-6.0, 10.0), random.range(-6.0, 10.0));
                let expected = points[..=index]
                    .iter()
                    .enumerate()
                    .map(|(number, &other)| (number as u32, distance_squared(&query, &other)))
                    .fold(None, |best: Option<(u32, f64)>, candidate| match best {
                        Some(best) if best.1 <= candidate.1 => Some(best),
                        _ => Some(candidate),
                    });
                assert_eq!(tree.nearest(query), expected, "seed {seed}, {index} points");
            }
        }
    }

    #[test]
    fn all_points_within_a_distance_are_visited_once() {
        for seed in 0..12 {
            let points = points(seed, 300);
            let mut tree = PointTree::default();
            for &point in &points {
                tree.add(point);
            }
            let center = Point2::new(1.0, 0.5);
            let mut found = Vec::new();
            tree.for_each_within(center, 2.0, |number, _| found.push(number));
            found.sort_unstable();
            let expected: Vec<u32> = (0..points.len() as u32)
                .filter(|&number| distance_squared(&center, &points[number as usize]) <= 4.0)
                .collect();
            assert_eq!(found, expected, "seed {seed}");
        }
    }
}
