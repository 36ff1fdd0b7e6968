//! Where everything goes: top down over the tree, parents before children, into a display list.

use std::collections::BTreeSet;

use display::geometry::{Piece, Point, Rect};
use tpn::{Network, NodeId};

use crate::drawing::{ArcShape, BlockForm, BlockShape, NO_SLOT, NetworkDrawing, NodeShape, Route};
use crate::layered::level_curve;
use crate::metrics::{MARGIN, node_radius};
use crate::size::{Clearance, Sizes, fan_rows, lead_in, lead_out};
use crate::tree::{PartId, PartKind, Tree};

/// Where a part has been put: the middle of its start node, the distance to its end node, and how many outlines it
/// lies in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) start: Point,
    pub(crate) width: f64,
    pub(crate) depth: u32,
}

pub(crate) struct Placer<'a> {
    pub(crate) sizes: Sizes<'a>,
    pub(crate) network: &'a Network,
    pub(crate) tree: &'a Tree,
    /// Of each node, the box that hides it.
    hidden_nodes: &'a [Option<u32>],
    pub(crate) frames: Vec<Option<Frame>>,
    pub(crate) positions: Vec<Option<Point>>,
    pub(crate) arcs: Vec<Option<ArcShape>>,
    pub(crate) drawing: NetworkDrawing,
    /// The middle of each box, and its position among the blocks of the drawing.
    pub(crate) boxes: Vec<Option<(Point, u32)>>,
    /// The ends of collapsed parts: arcs between them are inside.
    pub(crate) collapsed_ends: BTreeSet<(NodeId, NodeId)>,
}

impl<'a> Placer<'a> {
    pub(crate) fn new(
        network: &'a Network,
        tree: &'a Tree,
        sizes: Sizes<'a>,
        hidden_nodes: &'a [Option<u32>],
    ) -> Self {
        Self {
            sizes,
            network,
            tree,
            hidden_nodes,
            frames: vec![None; tree.parts.len()],
            positions: vec![None; network.nodes.len()],
            arcs: vec![None; network.arcs.len()],
            drawing: NetworkDrawing::default(),
            boxes: vec![None; tree.folding.folds.len()],
            collapsed_ends: BTreeSet::new(),
        }
    }

    /// Places the whole tree with its start at the origin.
    pub(crate) fn place(&mut self) {
        let Some(root) = self.tree.root else { return };
        let width = self.sizes.of(root).width;
        self.frames[root.index()] = Some(Frame { start: Point::default(), width, depth: 0 });
        let mut captions = self.sizes.captions.len();
        for at in (0..self.tree.parts.len()).rev() {
            let is_collapsed = matches!(self.tree.parts[at].kind, PartKind::Collapsed(_));
            captions -= usize::from(is_collapsed);
            if let Some(frame) = self.frames[at] {
                self.part(PartId(at as u32), frame, captions);
            }
        }
    }

    /// Turns what has been placed into a drawing, whose arcs across the structure and whose index are still to come.
    pub(crate) fn finish(mut self) -> (NetworkDrawing, BTreeSet<(NodeId, NodeId)>) {
        self.place_leftovers();
        let mut drawing = self.drawing;
        drawing.node_slots = vec![NO_SLOT; self.network.nodes.len()];
        drawing.arc_slots = vec![NO_SLOT; self.network.arcs.len()];
        for (at, node) in self.network.nodes.iter().enumerate() {
            let hider = self.hidden_nodes[at];
            let hider = hider.and_then(|fold| self.boxes[fold as usize]);
            let anchor = self.positions[at].or(hider.map(|(middle, _)| middle));
            drawing.anchors.push(anchor.unwrap_or_default());
            let slot = hider.filter(|_| self.positions[at].is_none()).map(|(_, slot)| slot);
            drawing.box_slots.push(slot.unwrap_or(NO_SLOT));
            if let Some(center) = self.positions[at] {
                drawing.node_slots[at] = drawing.nodes.len() as u32;
                let (id, radius) = (NodeId::from_index(at), node_radius(self.network, node));
                drawing.nodes.push(NodeShape { id, center, radius, role: node.role });
            }
        }
        for (at, arc) in self.arcs.into_iter().enumerate() {
            if let Some(arc) = arc {
                drawing.arc_slots[at] = drawing.arcs.len() as u32;
                drawing.arcs.push(arc);
            }
        }
        drawing.bounds = content_bounds(&drawing);
        (drawing, self.collapsed_ends)
    }

    /// Puts nodes that the structure does not reach into a row below everything.
    fn place_leftovers(&mut self) {
        let is_hidden = |at: usize| self.hidden_nodes[at].is_some();
        let missing: Vec<usize> =
            (0..self.positions.len()).filter(|&at| self.positions[at].is_none() && !is_hidden(at)).collect();
        if missing.is_empty() {
            return;
        }
        let below = self.tree.root.map_or(0.0, |root| self.sizes.of(root).below);
        let width = self.tree.root.map_or(0.0, |root| self.sizes.of(root).width);
        let step = 8.0 * MARGIN;
        let columns = (width / step).max(8.0) as usize;
        for (slot, at) in missing.into_iter().enumerate() {
            let (row, column) = (slot / columns, slot % columns);
            self.positions[at] =
                Some(Point::new(column as f64 * step, below + (row as f64 + 1.0) * 4.0 * MARGIN));
        }
    }

    fn part(&mut self, id: PartId, frame: Frame, caption: usize) {
        let part = self.tree.part(id);
        let (start, end) = (frame.start, frame.start.shifted(frame.width, 0.0));
        self.set_position(part.start, start);
        self.set_position(part.end, end);
        match &part.kind {
            PartKind::Nothing => {}
            PartKind::Arc(arc) => {
                let ends = (self.clearance_at(part.start, start), self.clearance_at(part.end, end));
                self.level_arc(*arc, start, end, ends);
            }
            PartKind::Series(range) => match self.sizes.rows.get(&id) {
                Some(rows) => {
                    let rows = rows.clone();
                    self.rows(id, &rows, self.tree.children(range), frame);
                }
                None => self.series(self.tree.children(range), frame),
            },
            PartKind::Fan { branches, is_choice } => self.fan(id, branches.clone(), *is_choice, frame),
            PartKind::Span { child, arcs, occurrence } => {
                let arches = self.sizes.arches(*child, arcs);
                let mut depth = frame.depth;
                if let Some(occurrence) = *occurrence {
                    self.outline(id, frame, occurrence);
                    depth += 1;
                }
                for arch in &arches {
                    self.arch(arch, start, end, (part.start, part.end));
                }
                self.frames[child.index()] = Some(Frame { depth, ..frame });
            }
            PartKind::Beads { arc, chain } => {
                let ends = (self.clearance_at(part.start, start), self.clearance_at(part.end, end));
                self.level_arc(*arc, start, end, ends);
                self.beads(*arc, chain, (start, end), (part.start, part.end));
            }
            PartKind::Collapsed(fold) => self.collapsed(id, *fold, frame, caption),
            PartKind::Core(core) => self.core(*core as usize, frame),
        }
    }

    pub(crate) fn set_position(&mut self, node: NodeId, at: Point) {
        self.positions[node.index()].get_or_insert(at);
    }

    /// The clearance of a node where it is, and none where a connector represents it.
    pub(crate) fn clearance_at(&self, node: NodeId, at: Point) -> Clearance {
        if self.positions[node.index()] == Some(at) {
            self.sizes.clearance(node)
        } else {
            Clearance::default()
        }
    }

    fn series(&mut self, children: &[PartId], frame: Frame) {
        let natural: f64 = children.iter().map(|&child| self.sizes.of(child).width).sum();
        // Room to spare goes to both ends, so that what is between stays together.
        let before = ((frame.width - natural) / 2.0).floor();
        let mut x = frame.start.x;
        for (at, &child) in children.iter().enumerate() {
            let mut width = self.sizes.of(child).width;
            if at == 0 {
                width += before;
            }
            if at + 1 == children.len() {
                width = frame.start.x + frame.width - x;
            }
            self.frames[child.index()] = Some(Frame { start: Point::new(x, frame.start.y), width, ..frame });
            x += width;
        }
    }

    fn fan(&mut self, id: PartId, range: std::ops::Range<u32>, is_choice: bool, frame: Frame) {
        let part = self.tree.part(id);
        let sizes = &self.sizes.branches[range.start as usize..range.end as usize];
        let rows = fan_rows(sizes);
        let rooms: Vec<_> = sizes.to_vec();
        let (from, to) = (frame.start, frame.start.shifted(frame.width, 0.0));
        let (start, end) = (self.clearance_at(part.start, from), self.clearance_at(part.end, to));
        let fork = from.shifted(lead_out(self.sizes.clearance(part.start)), 0.0);
        let join = to.shifted(-lead_in(self.sizes.clearance(part.end)), 0.0);
        for ((branch, size), &offset) in self.tree.branches(&range).iter().zip(&rooms).zip(&rows.offsets) {
            let left = Point::new(fork.x + rows.gutter, fork.y + offset);
            let right = Point::new(join.x - rows.gutter, join.y + offset);
            let child_start = left.shifted(size.run_in, 0.0);
            let child_width = branch.child.map_or(0.0, |child| self.sizes.of(child).width);
            let child_end = if branch.child.is_some() && branch.join.is_none() {
                right
            } else {
                child_start.shifted(child_width, 0.0)
            };
            let enter = [Piece::Line(fork), level_curve(fork, left)];
            let leave = [level_curve(right, join), Piece::Line(to.shifted(-end.radius, 0.0))];
            let source = from.shifted(start.radius, 0.0);
            if let Some(child) = branch.child {
                let width = child_end.x - child_start.x;
                self.frames[child.index()] =
                    Some(Frame { start: child_start, width, depth: frame.depth + 1 });
                self.set_position(self.tree.part(child).start, child_start);
                self.set_position(self.tree.part(child).end, child_end);
                let (first, last) = (self.tree.part(child).start, self.tree.part(child).end);
                match branch.fork {
                    Some(arc) => {
                        let clearance = self.clearance_at(first, child_start);
                        let tip = child_start.shifted(-clearance.radius, 0.0);
                        self.curve(arc, Route::Along, source, &[enter[0], enter[1], Piece::Line(tip)]);
                        self.texts_along(arc, left, child_start, (Clearance::default(), clearance));
                    }
                    None if self.tree.begins_with_nothing(child) => {}
                    None => self.connect(part.start, source, &enter),
                }
                match branch.join {
                    Some(arc) => {
                        let clearance = self.clearance_at(last, child_end);
                        let tail = child_end.shifted(clearance.radius, 0.0);
                        self.curve(arc, Route::Along, tail, &[Piece::Line(right), leave[0], leave[1]]);
                        let text_end = child_end.shifted(size.run_out, 0.0);
                        self.texts_along(arc, child_end, text_end, (clearance, Clearance::default()));
                    }
                    None if self.tree.ends_with_nothing(child) => {}
                    None => self.connect(part.end, right, &leave),
                }
            } else if let Some(arc) = branch.fork {
                let pieces = [enter[0], enter[1], Piece::Line(right), leave[0], leave[1]];
                self.curve(arc, Route::Along, source, &pieces);
                let text_end = left.shifted(size.run_in, 0.0);
                self.texts_along(arc, left, text_end, (Clearance::default(), Clearance::default()));
            }
            let rect = Rect::new(left.x, left.y - size.room.above, right.x, left.y + size.room.below);
            self.drawing.blocks.push(BlockShape {
                block: branch.block,
                last: branch.block,
                form: if is_choice { BlockForm::Alternative } else { BlockForm::Lane },
                rect,
                depth: frame.depth,
                occurrence: None,
                title: smol_str::SmolStr::default(),
            });
        }
    }

    fn core(&mut self, at: usize, frame: Frame) {
        let layout = std::mem::take(&mut self.sizes.cores[at]);
        let core = &self.tree.cores[at];
        let moved = |point: Point| point.shifted(frame.start.x, frame.start.y);
        for (node, point) in core.nodes.iter().zip(&layout.nodes) {
            self.set_position(*node, moved(*point));
        }
        for (&(from, to, part), edge) in core.edges.iter().zip(&layout.edges) {
            let (from, to) = (core.nodes[from as usize], core.nodes[to as usize]);
            let shift = |piece: &Piece| match *piece {
                Piece::Line(end) => Piece::Line(moved(end)),
                Piece::Cubic(first, second, end) => Piece::Cubic(moved(first), moved(second), moved(end)),
            };
            let mut way_in: Vec<Piece> = edge.way_in.iter().map(shift).collect();
            let mut way_out: Vec<Piece> = edge.way_out.iter().map(shift).collect();
            let source = self.positions[from.index()].unwrap_or_default();
            let target = self.positions[to.index()].unwrap_or_default();
            shorten_ends(&mut way_in, &mut way_out, target, self.sizes.clearance(to).radius);
            let source = source.shifted(self.sizes.clearance(from).radius, 0.0);
            let slot = moved(edge.slot);
            let slot_end = slot.shifted(edge.slot_width, 0.0);
            if let PartKind::Arc(arc) = self.tree.part(part).kind {
                let pieces: Vec<Piece> = way_in.into_iter().chain(way_out).collect();
                self.curve(arc, Route::Along, source, &pieces);
                self.texts_along(arc, slot, slot_end, (Clearance::default(), Clearance::default()));
            } else {
                self.connect(from, source, &way_in);
                self.connect(to, slot_end, &way_out);
                self.frames[part.index()] =
                    Some(Frame { start: slot, width: edge.slot_width, depth: frame.depth + 1 });
            }
        }
    }
}

/// Ends the way at the rim of the target's circle.
fn shorten_ends(way_in: &mut [Piece], way_out: &mut [Piece], target: Point, radius: f64) {
    let last = way_out.last_mut().or_else(|| way_in.last_mut());
    if let Some(piece) = last {
        let rim = target.shifted(-radius, 0.0);
        *piece = match *piece {
            Piece::Line(_) => Piece::Line(rim),
            Piece::Cubic(first, second, _) => Piece::Cubic(first, second.shifted(-radius, 0.0), rim),
        };
    }
}

/// The rectangle of all shapes, with a margin.
pub(crate) fn content_bounds(drawing: &NetworkDrawing) -> Rect {
    let nodes = drawing.nodes.iter().map(|node| Rect::around(node.center, node.radius));
    let arcs = drawing.arcs.iter().map(|arc| arc.bounds);
    let texts = drawing.texts.iter().map(|text| text.rect);
    let blocks = drawing.blocks.iter().map(|block| block.rect);
    let all = nodes.chain(arcs).chain(texts).chain(blocks);
    all.reduce(Rect::union).unwrap_or_default().expanded(MARGIN)
}
