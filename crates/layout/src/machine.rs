//! The state machine of a component: its modes in a row, the modes that only faults enter below, arcs between them.
//!
//! Not specific to any model: modes are widths, arcs are pairs of places.

use serde::{Deserialize, Serialize};

use display::geometry::{Piece, Point, Rect};

/// An arc from one mode to another, by their places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct MachineArc {
    /// The mode that it leaves.
    pub from: usize,
    /// The mode that it enters.
    pub to: usize,
    /// Whether it happens by chance and not on command.
    pub is_fault: bool,
}

/// A state machine as shapes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MachineDrawing {
    /// Everything lies inside.
    pub bounds: Rect,
    /// The boxes of the modes, in the order in which they were given.
    pub modes: Vec<Rect>,
    /// The arcs, in the order in which they were given.
    pub arcs: Vec<MachineArcShape>,
}

/// An arc as a curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MachineArcShape {
    /// Where the curve begins.
    pub start: Point,
    pub pieces: Vec<Piece>,
}

/// The height of a mode's box.
pub const MODE_HEIGHT: f64 = 28.0;
/// Between neighbors in a row.
const GAP: f64 = 30.0;
/// Between the rows.
const ROW_GAP: f64 = 26.0;
/// How far an arc and the one back stand apart.
const APART: f64 = 9.0;
/// How far an arc rises over the modes that it passes, for each of them.
const RISE: f64 = 12.0;
/// Up to so many modes, all orders of a row are tried.
const MAX_ORDERED: usize = 7;

/// Draws a state machine whose modes have boxes of these widths.
///
/// Modes that only faults enter stand in a row of their own; the others are ordered so that arcs are short. Linear in
/// modes and arcs, but for trying all orders of up to seven modes.
pub fn machine(widths: &[f64], arcs: &[MachineArc]) -> MachineDrawing {
    let is_below = |mode: usize| {
        let enters = |arc: &&MachineArc| arc.to == mode && arc.from != mode;
        arcs.iter().any(|arc| enters(&arc) && arc.is_fault)
            && !arcs.iter().any(|arc| enters(&arc) && !arc.is_fault)
    };
    let (mut below, above): (Vec<usize>, Vec<usize>) = (0..widths.len()).partition(|&mode| is_below(mode));
    // Where faults enter all modes, none is more of a fault than the others.
    let above = if above.is_empty() { std::mem::take(&mut below) } else { above };
    let above = ordered(above, arcs);
    let mut placed = vec![Rect::default(); widths.len()];
    let mut right = 0.0;
    for &mode in &above {
        placed[mode] = Rect::new(right, 0.0, right + widths[mode], MODE_HEIGHT);
        right += widths[mode] + GAP;
    }
    place_below(&below, widths, arcs, &mut placed);
    let mut place_in_row = vec![0; widths.len()];
    for row in [&above, &below] {
        for (place, &mode) in row.iter().enumerate() {
            place_in_row[mode] = place;
        }
    }
    let drawn = Drawn { arcs, placed: &placed, below: &below, place_in_row: &place_in_row };
    let shapes: Vec<MachineArcShape> = arcs.iter().map(|arc| drawn.arc(*arc)).collect();
    let mut bounds = placed.iter().copied().reduce(Rect::union).unwrap_or_default();
    for shape in &shapes {
        for point in display::geometry::flatten(shape.start, &shape.pieces) {
            bounds = bounds.union(Rect::around(point, 1.0));
        }
    }
    MachineDrawing { bounds, modes: placed, arcs: shapes }
}

/// The modes in the order that makes the arcs between them shortest; of several, the one nearest the given order.
fn ordered(modes: Vec<usize>, arcs: &[MachineArc]) -> Vec<usize> {
    if modes.len() > MAX_ORDERED {
        return modes;
    }
    let inside: Vec<(usize, usize)> = arcs
        .iter()
        .filter_map(|arc| {
            let place = |mode: usize| modes.iter().position(|known| *known == mode);
            Some((place(arc.from)?, place(arc.to)?))
        })
        .collect();
    // Places by mode; permuted in lexicographic order, so the first of equals is nearest the given order.
    let mut order: Vec<usize> = (0..modes.len()).collect();
    let mut best = (usize::MAX, order.clone());
    loop {
        let mut places = vec![0; order.len()];
        order.iter().enumerate().for_each(|(place, &mode)| places[mode] = place);
        let length = inside.iter().map(|&(from, to)| places[from].abs_diff(places[to])).sum();
        if length < best.0 {
            best = (length, order.clone());
        }
        if !permute(&mut order) {
            break;
        }
    }
    best.1.into_iter().map(|at| modes[at]).collect()
}

/// The next permutation in lexicographic order; false after the last.
fn permute(order: &mut [usize]) -> bool {
    let Some(pivot) = order.windows(2).rposition(|pair| pair[0] < pair[1]) else { return false };
    if let Some(next) = order.iter().rposition(|&value| value > order[pivot]) {
        order.swap(pivot, next);
    }
    order[pivot + 1..].reverse();
    true
}

/// Puts each mode of the lower row under the modes that lead to it, as far as its neighbors leave room.
fn place_below(below: &[usize], widths: &[f64], arcs: &[MachineArc], placed: &mut [Rect]) {
    let top = MODE_HEIGHT + ROW_GAP;
    let mut wanted: Vec<(usize, f64)> = below
        .iter()
        .map(|&mode| {
            let sources: Vec<f64> = arcs
                .iter()
                .filter(|arc| arc.to == mode && !below.contains(&arc.from))
                .map(|arc| placed[arc.from].center().x)
                .collect();
            let middle = sources.iter().sum::<f64>() / sources.len().max(1) as f64;
            (mode, middle.round())
        })
        .collect();
    wanted.sort_by(|left, right| left.1.total_cmp(&right.1).then(left.0.cmp(&right.0)));
    // Neighbors that want the same place share it: a group stands around the middle of what its members want.
    let total = |group: &[(usize, f64)]| {
        group.iter().map(|(mode, _)| widths[*mode]).sum::<f64>() + GAP * (group.len() as f64 - 1.0)
    };
    let left_of = |group: &[(usize, f64)]| {
        let middle = group.iter().map(|(_, middle)| middle).sum::<f64>() / group.len() as f64;
        (middle - total(group) / 2.0).max(0.0)
    };
    let mut groups: Vec<Vec<(usize, f64)>> = Vec::new();
    for one in wanted {
        let mut group = vec![one];
        while let Some(before) = groups.last() {
            if left_of(before) + total(before) + GAP <= left_of(&group) {
                break;
            }
            let mut joined = groups.pop().unwrap_or_default();
            joined.append(&mut group);
            group = joined;
        }
        groups.push(group);
    }
    for group in &groups {
        let mut left = left_of(group);
        for (mode, _) in group {
            placed[*mode] = Rect::new(left, top, left + widths[*mode], top + MODE_HEIGHT);
            left += widths[*mode] + GAP;
        }
    }
}

struct Drawn<'a> {
    arcs: &'a [MachineArc],
    placed: &'a [Rect],
    below: &'a [usize],
    place_in_row: &'a [usize],
}

impl Drawn<'_> {
    fn arc(&self, arc: MachineArc) -> MachineArcShape {
        let (from, to) = (self.placed[arc.from], self.placed[arc.to]);
        let is_below = |mode: usize| self.below.contains(&mode);
        if arc.from == arc.to {
            return around(from, if is_below(arc.from) { 1.0 } else { -1.0 });
        }
        if is_below(arc.from) != is_below(arc.to) {
            return self.between_rows(arc);
        }
        let is_neighbor = self.place_in_row[arc.from].abs_diff(self.place_in_row[arc.to]) == 1;
        let has_twin = |is_fault: bool| {
            let twin = MachineArc { from: arc.from, to: arc.to, is_fault };
            self.arcs.contains(&twin)
        };
        if is_neighbor && (!arc.is_fault || !has_twin(false)) {
            let is_back = self.arcs.iter().any(|other| (other.from, other.to) == (arc.to, arc.from));
            let shift = match (is_back, from.center().x < to.center().x) {
                (false, _) => 0.0,
                (true, true) => -APART / 2.0,
                (true, false) => APART / 2.0,
            };
            let y = from.center().y + shift;
            let (start, end) =
                if from.center().x < to.center().x { (from.max.x, to.min.x) } else { (from.min.x, to.max.x) };
            return MachineArcShape {
                start: Point::new(start, y),
                pieces: vec![Piece::Line(Point::new(end, y))],
            };
        }
        // Faults pass on the inner side, between the rows; commands on the outer one.
        let passed = self.place_in_row[arc.from].abs_diff(self.place_in_row[arc.to]) as f64;
        let is_up = is_below(arc.from) == arc.is_fault;
        let (rise, side) = if is_up { (-RISE * passed, Side::Top) } else { (RISE * passed, Side::Bottom) };
        let toward = if from.center().x < to.center().x { APART / 2.0 } else { -APART / 2.0 };
        let (start, end) = (side.of(from).shifted(toward, 0.0), side.of(to).shifted(-toward, 0.0));
        let bend = rise * 4.0 / 3.0;
        MachineArcShape {
            start,
            pieces: vec![Piece::Cubic(start.shifted(0.0, bend), end.shifted(0.0, bend), end)],
        }
    }

    /// A straight line between the rows, beside the one that leads back.
    fn between_rows(&self, arc: MachineArc) -> MachineArcShape {
        let (from, to) = (self.placed[arc.from], self.placed[arc.to]);
        let is_down = self.below.contains(&arc.to);
        let (leaving, entering) = if is_down { (Side::Bottom, Side::Top) } else { (Side::Top, Side::Bottom) };
        let is_back = self.arcs.iter().any(|other| (other.from, other.to) == (arc.to, arc.from));
        let shift = match (is_back, is_down) {
            (false, _) => 0.0,
            (true, true) => -APART / 2.0,
            (true, false) => APART / 2.0,
        };
        // Lines that end at one mode are spread over its edge, in the order in which they come.
        let spread = |mode: Rect, other: Rect| {
            let reach = mode.width() / 2.0 - 7.0;
            ((other.center().x - mode.center().x) / 4.0).clamp(-reach, reach)
        };
        let start = leaving.of(from).shifted(spread(from, to) + shift, 0.0);
        let end = entering.of(to).shifted(spread(to, from) + shift, 0.0);
        MachineArcShape { start, pieces: vec![Piece::Line(end)] }
    }
}

#[derive(Clone, Copy)]
enum Side {
    Top,
    Bottom,
}

impl Side {
    fn of(self, mode: Rect) -> Point {
        let y = match self {
            Self::Top => mode.min.y,
            Self::Bottom => mode.max.y,
        };
        Point::new(mode.center().x, y)
    }
}

/// A loop over a mode, or under it where `way` is positive.
fn around(mode: Rect, way: f64) -> MachineArcShape {
    let side = if way < 0.0 { Side::Top } else { Side::Bottom };
    let (start, end) = (side.of(mode).shifted(-APART / 2.0, 0.0), side.of(mode).shifted(APART / 2.0, 0.0));
    let rise = way * RISE * 4.0 / 3.0;
    MachineArcShape {
        start,
        pieces: vec![Piece::Cubic(start.shifted(-APART, rise), end.shifted(APART, rise), end)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn arc(from: usize, to: usize, is_fault: bool) -> MachineArc {
        MachineArc { from, to, is_fault }
    }

    /// Standby, Failed, Firing, Off, as someone might declare them.
    fn engine() -> MachineDrawing {
        let arcs = [
            arc(3, 0, false),
            arc(0, 2, false),
            arc(2, 0, false),
            arc(0, 3, false),
            arc(0, 1, true),
            arc(2, 1, true),
        ];
        machine(&[60.0, 50.0, 46.0, 30.0], &arcs)
    }

    #[test]
    fn modes_that_follow_each_other_stand_beside_each_other_and_failures_below() {
        let drawing = engine();
        let [standby, failed, firing, off] = drawing.modes.as_slice() else { panic!("four modes") };
        assert_eq!((standby.min.y, firing.min.y, off.min.y), (0.0, 0.0, 0.0));
        assert!(failed.min.y > standby.max.y);
        let between = standby.center().x;
        assert!((off.center().x < between) != (firing.center().x < between), "Standby is between the two");
    }

    #[test]
    fn an_arc_and_the_one_back_do_not_lie_on_each_other() {
        let drawing = engine();
        let heights: Vec<f64> = [0, 3].iter().map(|&at: &usize| drawing.arcs[at].start.y).collect();
        assert!((heights[0] - heights[1]).abs() >= APART, "{heights:?}");
    }

    #[test]
    fn boxes_never_overlap_and_everything_lies_inside() {
        // Five modes, of which two only fail, one of them repaired; and a fault beside a command.
        let arcs = [
            arc(0, 1, false),
            arc(1, 0, false),
            arc(1, 2, true),
            arc(1, 3, true),
            arc(0, 3, true),
            arc(2, 0, false),
            arc(0, 1, true),
            arc(4, 0, false),
            arc(1, 4, true),
            arc(2, 2, false),
        ];
        let drawing = machine(&[40.0, 90.0, 70.0, 50.0, 64.0], &arcs);
        for (at, one) in drawing.modes.iter().enumerate() {
            for other in &drawing.modes[at + 1..] {
                assert!(!one.overlaps(*other), "{drawing:?}");
            }
            assert_eq!(drawing.bounds.union(*one), drawing.bounds);
        }
        for shape in &drawing.arcs {
            let end = shape.pieces.last().expect("a piece").end();
            for point in [shape.start, end] {
                assert!(drawing.bounds.contains(point), "{shape:?}");
                assert!(drawing.modes.iter().any(|mode| mode.expanded(0.5).contains(point)), "{shape:?}");
            }
        }
        assert_eq!(machine(&[], &[]), MachineDrawing::default());
    }
}
