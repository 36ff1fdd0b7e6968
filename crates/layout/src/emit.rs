//! The shapes of a part that has been placed: curves, arches, boxes, outlines, and texts beside them.

use display::geometry::{Piece, Point, Rect, curve_bounds};
use display::list::ARROW_LENGTH;
use tpn::{ArcId, NodeId, OccurrenceId};

use crate::caption::Line;
use crate::drawing::{ArcShape, BlockForm, BlockShape, Connector, Item, Route, Slide, TextShape};
use crate::metrics::{ARCH_CORNER, ARCH_FOOT, OUTLINE_PAD, TEXT_LIFT, TEXT_PAD, WORD_GAP};
use crate::overlay::reversed;
use crate::place::{Frame, Placer};
use crate::size::{Arch, Clearance};
use crate::text::{Run, line_size};
use crate::tree::PartId;

impl Placer<'_> {
    pub(crate) fn outline(&mut self, id: PartId, frame: Frame, occurrence: OccurrenceId) {
        let part = self.tree.part(id);
        let size = self.sizes.of(id);
        let (left, right) = (self.sizes.clearance(part.start).radius, self.sizes.clearance(part.end).radius);
        let (x, y) = (frame.start.x, frame.start.y);
        self.drawing.blocks.push(BlockShape {
            block: part.block,
            last: part.block,
            form: BlockForm::Activity,
            rect: Rect::new(
                x - left - OUTLINE_PAD,
                y - size.above,
                x + frame.width + right + OUTLINE_PAD,
                y + size.below,
            ),
            depth: frame.depth,
            occurrence: Some(occurrence),
            title: self.network.occurrences[occurrence.index()].activity.clone(),
        });
    }

    pub(crate) fn arch(&mut self, arch: &Arch, start: Point, end: Point, nodes: (NodeId, NodeId)) {
        let radii = (self.clearance_at(nodes.0, start).radius, self.clearance_at(nodes.1, end).radius);
        let top = start.y - arch.height;
        let (left, right) = (start.x + arch.rise, end.x - arch.fall);
        let (from, up) = rise_of_arch(start, left, top, radii.0, 1.0);
        let (to, down) = rise_of_arch(end, right, top, radii.1, -1.0);
        let mut pieces = up.to_vec();
        pieces.push(Piece::Line(down[2].end()));
        pieces.extend(reversed(to, &down).1);
        self.curve(arch.arc, Route::Arch, from, &pieces);
        let runs = self.sizes.runs(arch.arc);
        let limits = (left + ARCH_CORNER, right - ARCH_CORNER - arch.text_width);
        let text_left = (f64::midpoint(limits.0, limits.1)).floor();
        let bottom = top - TEXT_LIFT;
        let row = Rect::new(text_left, bottom - arch.text_height, text_left + arch.text_width, bottom);
        let slide = Slide {
            arc: arch.arc,
            row: (text_left, arch.text_width),
            limits: (limits.0.min(text_left), limits.1.max(text_left)),
        };
        self.write_row(runs.iter(), row, Some(slide));
    }

    /// The path of a traverse over its arc: an arch with the vertices strung along its level run.
    pub(crate) fn beads(
        &mut self,
        arc: ArcId,
        chain: &std::ops::Range<u32>,
        ends: (Point, Point),
        nodes: (NodeId, NodeId),
    ) {
        let arch = self.sizes.beads(arc, chain);
        let chain = self.tree.spanning(chain);
        let radii = (self.clearance_at(nodes.0, ends.0).radius, self.clearance_at(nodes.1, ends.1).radius);
        let top = ends.0.y - arch.height;
        let (from, up) = rise_of_arch(ends.0, ends.0.x + arch.rise, top, radii.0, 1.0);
        let (to, down) = rise_of_arch(ends.1, ends.1.x - arch.fall, top, radii.1, -1.0);
        let (left, right) = (up[2].end().x, down[2].end().x);
        let count = chain.len();
        let bead =
            |number: usize| Point::new((left + (right - left) * number as f64 / count as f64).floor(), top);
        for (at, &piece) in chain.iter().enumerate() {
            let (is_first, is_last) = (at == 0, at + 1 == count);
            let mut pieces = Vec::with_capacity(7);
            if is_first {
                pieces.extend(up);
            }
            if is_last {
                pieces.push(Piece::Line(down[2].end()));
                pieces.extend(reversed(to, &down).1);
            } else {
                pieces.push(Piece::Line(bead(at + 1)));
                self.set_position(self.network.arcs[piece.index()].to, bead(at + 1));
            }
            self.curve(piece, Route::Along, if is_first { from } else { bead(at) }, &pieces);
        }
    }

    pub(crate) fn collapsed(&mut self, id: PartId, fold: u32, frame: Frame, caption: usize) {
        let part = self.tree.part(id);
        let Some(block) = part.block else { return };
        let end = frame.start.shifted(frame.width, 0.0);
        let caption = self.sizes.captions[caption].clone();
        let height = caption.height();
        let gap = |clearance: Clearance, side: f64| side.max(clearance.beneath) + 2.0 * TEXT_PAD;
        let (first, last) = (self.sizes.clearance(part.start), self.sizes.clearance(part.end));
        let rect = Rect::new(
            frame.start.x + gap(first, first.after),
            frame.start.y - height / 2.0,
            end.x - gap(last, last.before),
            frame.start.y + height / 2.0,
        );
        let from = frame.start.shifted(self.clearance_at(part.start, frame.start).radius, 0.0);
        let to = end.shifted(-self.clearance_at(part.end, end).radius, 0.0);
        self.connect(part.start, from, &[Piece::Line(Point::new(rect.min.x, frame.start.y))]);
        self.connect(part.end, Point::new(rect.max.x, end.y), &[Piece::Line(to)]);
        self.boxes[fold as usize] = Some((rect.center(), self.drawing.blocks.len() as u32));
        self.collapsed_ends.insert((part.start, part.end));
        let title = caption.title();
        let mut top = rect.center().y - caption.text_height() / 2.0;
        for Line { text, role, width, size } in caption.lines {
            let left = (rect.center().x - width / 2.0).floor();
            let line = Rect::new(left, top, left + width, top + role.line_height());
            top = line.max.y;
            self.drawing.texts.push(TextShape {
                text,
                role,
                size,
                rect: line,
                owner: Item::Block(block),
                slide: None,
            });
        }
        self.drawing.blocks.push(BlockShape {
            block: Some(block),
            last: Some(self.tree.folding.folds[fold as usize].last),
            form: BlockForm::Collapsed,
            rect,
            depth: frame.depth,
            occurrence: caption.occurrence,
            title,
        });
    }

    pub(crate) fn connect(&mut self, node: NodeId, start: Point, pieces: &[Piece]) {
        let mut from = start;
        for &piece in pieces {
            if piece.end() != from {
                self.drawing.connectors.push(Connector { node, start: from, piece });
            }
            from = piece.end();
        }
    }

    /// A straight arc between two nodes on one line.
    pub(crate) fn level_arc(&mut self, arc: ArcId, start: Point, end: Point, ends: (Clearance, Clearance)) {
        let (from, to) = (start.shifted(ends.0.radius, 0.0), end.shifted(-ends.1.radius, 0.0));
        self.curve(arc, Route::Along, from, &[Piece::Line(to)]);
        self.texts_along(arc, start, end, ends);
    }

    pub(crate) fn curve(&mut self, id: ArcId, route: Route, start: Point, pieces: &[Piece]) {
        let first_piece = self.drawing.pieces.len() as u32;
        let mut from = start;
        for &piece in pieces {
            if piece.end() != from {
                self.drawing.pieces.push(piece);
            }
            from = piece.end();
        }
        let kept = &self.drawing.pieces[first_piece as usize..];
        let bounds = curve_bounds(start, kept);
        let piece_count = kept.len() as u32;
        let kind = self.network.arcs[id.index()].kind;
        let is_contingent = self.network.is_uncertain(id);
        self.arcs[id.index()] =
            Some(ArcShape { id, kind, is_contingent, route, start, first_piece, piece_count, bounds });
    }

    /// Writes an arc's texts above and below the level run between two points.
    pub(crate) fn texts_along(&mut self, arc: ArcId, start: Point, end: Point, ends: (Clearance, Clearance)) {
        let runs = self.sizes.runs(arc);
        let Some(last) = runs.last() else { return };
        let above = (start.x + ends.0.after, end.x - ends.1.before - ARROW_LENGTH);
        let below = (start.x + ends.0.beneath, end.x - ends.1.beneath);
        let mut top = start.y + TEXT_LIFT;
        for line in -1..=last.line {
            let size = line_size(runs, line);
            let span = if line < 0 { above } else { below };
            let left = (f64::midpoint(span.0, span.1) - size.width / 2.0).floor();
            let row_top = if line < 0 { start.y - TEXT_LIFT - size.height } else { top };
            if line >= 0 {
                top += size.height;
            }
            let row = Rect::new(left, row_top, left + size.width, row_top + size.height);
            self.write_row(runs.iter().filter(|run| run.line == line), row, None);
        }
    }

    fn write_row<'r>(&mut self, runs: impl Iterator<Item = &'r Run>, row: Rect, slide: Option<Slide>) {
        let mut left = row.min.x;
        for run in runs {
            self.drawing.texts.push(TextShape {
                text: run.text.clone(),
                role: run.role,
                size: run.size,
                rect: Rect::new(left, row.min.y, left + run.width, row.max.y),
                owner: run.owner,
                slide,
            });
            left += run.width + WORD_GAP;
        }
    }
}

/// The left leg of an arch, or with `side` −1 the right one: where it leaves its node, and three pieces that lead up
/// and around the corner onto the level run.
fn rise_of_arch(node: Point, x: f64, top: f64, radius: f64, side: f64) -> (Point, [Piece; 3]) {
    let foot = node.y - ARCH_FOOT;
    let toward = node.direction_to(Point::new(x, foot + ARCH_CORNER / 2.0));
    let from = node.shifted(toward.x * radius, toward.y * radius);
    let upright = Point::new(x, f64::midpoint(foot, from.y));
    let corner = ARCH_CORNER * side;
    let pieces = [
        Piece::Cubic(from.lerp(upright, 0.5), upright, Point::new(x, foot)),
        Piece::Line(Point::new(x, top + ARCH_CORNER)),
        Piece::Cubic(
            Point::new(x, top + ARCH_CORNER / 2.0),
            Point::new(x + corner / 2.0, top),
            Point::new(x + corner, top),
        ),
    ];
    (from, pieces)
}
