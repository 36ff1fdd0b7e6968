//! Series that are broken into rows, as a text is into lines.
//!
//! The first row lies on the line of the series. From the end of each row a line leads down and back to the beginning of
//! the next, and from the end of the last one up to where the series ends.

use display::geometry::{Piece, Point};

use crate::metrics::{ROW_CORNER, ROW_GAP, ROW_INDENT, ROW_TURN};
use crate::place::{Frame, Placer};
use crate::size::{Clearance, Size, lead_in};
use crate::tree::PartId;

/// How a series is broken into rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Rows {
    /// The position of each row's first child.
    pub(crate) starts: Vec<usize>,
    /// How far each row's line lies below the first.
    offsets: Vec<f64>,
    /// How far the middle of the gap above each row lies below the first line.
    gaps: Vec<f64>,
    /// The room of all rows.
    pub(crate) size: Size,
    /// How far left of its end the line comes up to it.
    riser: f64,
}

impl Rows {
    /// Breaks children before they get longer than `width`, in front of a node with clearance `end`.
    pub(crate) fn new(children: &[Size], width: f64, end: Clearance) -> Self {
        let riser = lead_in(end) + 2.0 * ROW_CORNER;
        let longest = width - ROW_INDENT - ROW_TURN - riser;
        let mut rows = Self { riser, ..Self::default() };
        let mut room: Vec<Size> = Vec::new();
        for (at, child) in children.iter().enumerate() {
            match room.last_mut() {
                Some(row) if row.width + child.width <= longest => {
                    row.width += child.width;
                    row.above = row.above.max(child.above);
                    row.below = row.below.max(child.below);
                }
                _ => {
                    rows.starts.push(at);
                    room.push(*child);
                }
            }
        }
        let mut line = 0.0;
        for (at, row) in room.iter().enumerate() {
            if let Some(before) = at.checked_sub(1).and_then(|before| room.get(before)) {
                rows.gaps.push(line + before.below + ROW_GAP / 2.0);
                line += before.below + ROW_GAP + row.above;
            } else {
                rows.gaps.push(0.0);
            }
            rows.offsets.push(line);
        }
        let longest = room.iter().map(|row| row.width).fold(0.0, f64::max);
        rows.size = Size {
            width: ROW_INDENT + longest + ROW_TURN + riser,
            above: room.first().map_or(0.0, |row| row.above),
            below: line + room.last().map_or(0.0, |row| row.below),
        };
        rows
    }
}

impl Placer<'_> {
    /// Places the children of series `id` in rows, and the lines from row to row.
    pub(crate) fn rows(&mut self, id: PartId, rows: &Rows, children: &[PartId], frame: Frame) {
        let end = self.tree.part(id).end;
        let target = frame.start.shifted(frame.width, 0.0);
        for (row, &first) in rows.starts.iter().enumerate() {
            let next = rows.starts.get(row + 1).copied();
            let members = &children[first..next.unwrap_or(children.len())];
            let indent = if row == 0 { 0.0 } else { ROW_INDENT };
            let mut at = frame.start.shifted(indent, rows.offsets[row]);
            for &child in members {
                let width = self.sizes.of(child).width;
                self.frames[child.index()] = Some(Frame { start: at, width, ..frame });
                at = at.shifted(width, 0.0);
            }
            let Some(&last) = members.last() else { continue };
            let node = self.tree.part(last).end;
            let Some(next) = next.map(|_| row + 1) else {
                let right = target.x - rows.riser + ROW_CORNER;
                let tip = target.shifted(-self.clearance_at(end, target).radius, 0.0);
                let way = [Point::new(right, at.y), Point::new(right, target.y), tip];
                self.connect_square(end, at, &way);
                continue;
            };
            self.set_position(node, at);
            let from = at.shifted(self.clearance_at(node, at).radius, 0.0);
            let gap = frame.start.y + rows.gaps[next];
            let begin = frame.start.shifted(ROW_INDENT, rows.offsets[next]);
            let right = at.x + ROW_TURN;
            let way = [
                Point::new(right, at.y),
                Point::new(right, gap),
                Point::new(frame.start.x, gap),
                Point::new(frame.start.x, begin.y),
                begin,
            ];
            self.connect_square(node, from, &way);
        }
    }

    /// A line of level and upright runs with round corners.
    fn connect_square(&mut self, node: tpn::NodeId, start: Point, way: &[Point]) {
        let mut pieces = Vec::with_capacity(2 * way.len());
        let mut from = start;
        for pair in way.windows(2) {
            let (corner, next) = (pair[0], pair[1]);
            let short = (from.distance(corner) / 2.0).min(corner.distance(next) / 2.0).min(ROW_CORNER);
            let before = toward(corner, from, short);
            let after = toward(corner, next, short);
            pieces.push(Piece::Line(before));
            pieces.push(Piece::Cubic(
                toward(before, corner, short * 0.55),
                toward(after, corner, short * 0.55),
                after,
            ));
            from = after;
        }
        pieces.extend(way.last().map(|&end| Piece::Line(end)));
        self.connect(node, start, &pieces);
    }
}

/// The point that lies `length` from `from` on the way to `to`.
fn toward(from: Point, to: Point, length: f64) -> Point {
    let whole = from.distance(to);
    if whole == 0.0 { from } else { from.lerp(to, length / whole) }
}
