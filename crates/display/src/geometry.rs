//! Points, rectangles and curves of a drawing, in drawing units: x grows to the right with time, y grows downwards.
//!
//! Every length that the layout chooses is a multiple of a half, so sums are exact and equal parts of two drawings are
//! equal to the bit, wherever they lie.

use serde::{Deserialize, Serialize};

/// A place on the drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Increases to the right.
    pub x: f64,
    /// Increases downward.
    pub y: f64,
}

/// An upright rectangle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rect {
    /// The upper left corner.
    pub min: Point,
    /// The lower right corner.
    pub max: Point,
}

/// One piece of a curve; it begins where the piece before it ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Piece {
    /// A straight line to a point.
    Line(Point),
    /// A cubic Bézier curve: two control points and its end.
    Cubic(Point, Point, Point),
}

/// How many straight lines represent one Bézier piece in [`flatten`].
const LINES_PER_CUBIC: u32 = 16;

impl Point {
    /// The point at (`x`, `y`).
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// This point moved by (`dx`, `dy`).
    pub fn shifted(self, dx: f64, dy: f64) -> Self {
        Self::new(self.x + dx, self.y + dy)
    }

    /// The distance to `other`.
    pub fn distance(self, other: Self) -> f64 {
        let (dx, dy) = (self.x - other.x, self.y - other.y);
        (dx * dx + dy * dy).sqrt()
    }

    /// The point `fraction` of the way to `other`.
    pub fn lerp(self, other: Self, fraction: f64) -> Self {
        Self::new(self.x + (other.x - self.x) * fraction, self.y + (other.y - self.y) * fraction)
    }

    /// The unit vector from here toward `other`; to the right where they coincide.
    pub fn direction_to(self, other: Self) -> Self {
        let length = self.distance(other);
        if length == 0.0 {
            return Self::new(1.0, 0.0);
        }
        Self::new((other.x - self.x) / length, (other.y - self.y) / length)
    }
}

impl Rect {
    /// The rectangle with these edges.
    pub const fn new(left: f64, top: f64, right: f64, bottom: f64) -> Self {
        Self { min: Point::new(left, top), max: Point::new(right, bottom) }
    }

    /// The square around `center` that reaches `radius` to each side.
    pub fn around(center: Point, radius: f64) -> Self {
        Self { min: center.shifted(-radius, -radius), max: center.shifted(radius, radius) }
    }

    /// From its left to its right side.
    pub fn width(self) -> f64 {
        self.max.x - self.min.x
    }

    /// From its upper to its lower side.
    pub fn height(self) -> f64 {
        self.max.y - self.min.y
    }

    /// The point in the middle.
    pub fn center(self) -> Point {
        self.min.lerp(self.max, 0.5)
    }

    /// The smallest rectangle that holds both.
    pub fn union(self, other: Self) -> Self {
        Self {
            min: Point::new(self.min.x.min(other.min.x), self.min.y.min(other.min.y)),
            max: Point::new(self.max.x.max(other.max.x), self.max.y.max(other.max.y)),
        }
    }

    /// This rectangle with `margin` added on every side.
    pub fn expanded(self, margin: f64) -> Self {
        Self { min: self.min.shifted(-margin, -margin), max: self.max.shifted(margin, margin) }
    }

    /// Returns whether the two share a point.
    pub fn touches(self, other: Self) -> bool {
        self.min.x <= other.max.x
            && other.min.x <= self.max.x
            && self.min.y <= other.max.y
            && other.min.y <= self.max.y
    }

    /// Returns whether the two share more than their edges.
    pub fn overlaps(self, other: Self) -> bool {
        self.min.x < other.max.x
            && other.min.x < self.max.x
            && self.min.y < other.max.y
            && other.min.y < self.max.y
    }

    /// Returns whether `point` lies inside or on the edge.
    pub fn contains(self, point: Point) -> bool {
        self.min.x <= point.x && point.x <= self.max.x && self.min.y <= point.y && point.y <= self.max.y
    }
}

impl Piece {
    /// Returns where the piece ends.
    pub fn end(self) -> Point {
        match self {
            Self::Line(end) | Self::Cubic(_, _, end) => end,
        }
    }

    /// The point at `fraction` of the piece's parameter, when the piece begins at `start`.
    pub fn at(self, start: Point, fraction: f64) -> Point {
        match self {
            Self::Line(end) => start.lerp(end, fraction),
            Self::Cubic(first, second, end) => {
                let (a, b, c) =
                    (start.lerp(first, fraction), first.lerp(second, fraction), second.lerp(end, fraction));
                a.lerp(b, fraction).lerp(b.lerp(c, fraction), fraction)
            }
        }
    }

    /// The piece up to `fraction` of its parameter, when it begins at `start` (de Casteljau).
    pub fn first_part(self, start: Point, fraction: f64) -> Self {
        match self {
            Self::Line(end) => Self::Line(start.lerp(end, fraction)),
            Self::Cubic(first, second, end) => {
                let (a, b, c) =
                    (start.lerp(first, fraction), first.lerp(second, fraction), second.lerp(end, fraction));
                let (d, e) = (a.lerp(b, fraction), b.lerp(c, fraction));
                Self::Cubic(a, d, d.lerp(e, fraction))
            }
        }
    }

    /// The point that the end of the piece is reached from; gives the direction of an arrow head.
    pub fn before_end(self, start: Point) -> Point {
        match self {
            Self::Line(_) => start,
            Self::Cubic(first, second, end) => {
                if second != end {
                    second
                } else if first != end {
                    first
                } else {
                    start
                }
            }
        }
    }
}

/// The curve as straight lines, its start included.
pub fn flatten(start: Point, pieces: &[Piece]) -> Vec<Point> {
    let mut points = vec![start];
    let mut from = start;
    for piece in pieces {
        match *piece {
            Piece::Line(end) => points.push(end),
            Piece::Cubic(..) => {
                let steps = 1..=LINES_PER_CUBIC;
                points.extend(steps.map(|step| piece.at(from, f64::from(step) / f64::from(LINES_PER_CUBIC))));
            }
        }
        from = piece.end();
    }
    points
}

/// The first `fraction` of a curve, measured along it; all pieces count by the length of their chords.
pub fn first_part(start: Point, pieces: &[Piece], fraction: f64) -> Vec<Piece> {
    let starts = std::iter::once(start).chain(pieces.iter().map(|piece| piece.end()));
    let lengths: Vec<f64> =
        starts.clone().zip(pieces).map(|(from, piece)| from.distance(piece.end())).collect();
    let mut left = lengths.iter().sum::<f64>() * fraction.clamp(0.0, 1.0);
    let mut part = Vec::new();
    for ((from, &piece), length) in starts.zip(pieces).zip(lengths) {
        if length > left {
            part.push(piece.first_part(from, left / length));
            break;
        }
        left -= length;
        part.push(piece);
    }
    part
}

/// A rectangle that holds the curve: that of its points and control points.
pub fn curve_bounds(start: Point, pieces: &[Piece]) -> Rect {
    let mut bounds = Rect { min: start, max: start };
    let mut add = |point: Point| bounds = bounds.union(Rect { min: point, max: point });
    for piece in pieces {
        match *piece {
            Piece::Line(end) => add(end),
            Piece::Cubic(first, second, end) => [first, second, end].into_iter().for_each(&mut add),
        }
    }
    bounds
}

/// The distance of `point` to the curve.
pub fn distance_point_curve(point: Point, start: Point, pieces: &[Piece]) -> f64 {
    let line = flatten(start, pieces);
    let segments = line.windows(2).map(|ends| distance_point_segment(point, ends[0], ends[1]));
    segments.fold(point.distance(start), f64::min)
}

/// The distance of `point` to the segment between `from` and `to`.
pub fn distance_point_segment(point: Point, from: Point, to: Point) -> f64 {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let squared = dx * dx + dy * dy;
    if squared == 0.0 {
        return point.distance(from);
    }
    let along = ((point.x - from.x) * dx + (point.y - from.y) * dy) / squared;
    point.distance(from.lerp(to, along.clamp(0.0, 1.0)))
}

/// Returns whether the segment between `from` and `to` passes through the inside of `rect` (clipped slab by slab).
pub fn segment_meets_rect(from: Point, to: Point, rect: Rect) -> bool {
    let sides = [(from.x, to.x, rect.min.x, rect.max.x), (from.y, to.y, rect.min.y, rect.max.y)];
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for (from, to, least, greatest) in sides {
        let along = to - from;
        if along == 0.0 {
            if from <= least || greatest <= from {
                return false;
            }
            continue;
        }
        let [one, other] = [(least - from) / along, (greatest - from) / along];
        enters = enters.max(one.min(other));
        leaves = leaves.min(one.max(other));
    }
    enters < leaves
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_that_touches_a_rectangle_from_outside_does_not_meet_it() {
        let rect = Rect::new(10.0, 10.0, 20.0, 14.0);
        let meets = |from: [f64; 2], to: [f64; 2]| {
            segment_meets_rect(Point::new(from[0], from[1]), Point::new(to[0], to[1]), rect)
        };
        assert!(meets([0.0, 12.0], [30.0, 12.0]) && meets([15.0, 0.0], [15.0, 30.0]), "across and down");
        assert!(meets([11.0, 11.0], [12.0, 12.0]), "within");
        assert!(meets([9.0, 9.0], [21.0, 15.0]), "from corner to corner");
        assert!(!meets([15.0, 0.0], [15.0, 10.0]), "ends at the edge");
        assert!(!meets([10.0, 0.0], [10.0, 30.0]), "along the edge");
        assert!(!meets([0.0, 0.0], [9.0, 30.0]) && !meets([19.0, 8.0], [22.0, 11.0]), "past it");
        assert!(!segment_meets_rect(Point::default(), Point::default(), rect));
    }

    #[test]
    fn the_distance_to_a_curve_is_that_to_its_nearest_piece() {
        let pieces = [Piece::Line(Point::new(10.0, 0.0)), Piece::Line(Point::new(10.0, 10.0))];
        assert_eq!(distance_point_curve(Point::new(13.0, 5.0), Point::default(), &pieces), 3.0);
        assert_eq!(distance_point_curve(Point::new(-4.0, 3.0), Point::default(), &pieces), 5.0);
    }

    #[test]
    fn the_first_part_of_a_curve_ends_on_it() {
        let (corner, end) = (Point::new(10.0, 0.0), Point::new(10.0, 30.0));
        let pieces = [Piece::Line(corner), Piece::Line(end)];
        assert_eq!(
            first_part(Point::default(), &pieces, 0.5),
            [pieces[0], Piece::Line(Point::new(10.0, 10.0))]
        );
        assert_eq!(first_part(Point::default(), &pieces, 1.0), pieces);
        let cubic = Piece::Cubic(Point::new(0.0, 10.0), Point::new(20.0, 10.0), Point::new(20.0, 0.0));
        assert_eq!(cubic.first_part(Point::default(), 0.25).end(), cubic.at(Point::default(), 0.25));
    }

    #[test]
    fn a_flattened_curve_keeps_its_ends() {
        let end = Point::new(40.0, 20.0);
        let points =
            flatten(Point::default(), &[Piece::Cubic(Point::new(20.0, 0.0), Point::new(20.0, 20.0), end)]);
        assert_eq!(points.first(), Some(&Point::default()));
        assert_eq!(points.last(), Some(&end));
    }
}
