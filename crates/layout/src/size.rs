//! How much room each part of the tree needs: bottom up, in time linear in the tree.

use std::collections::BTreeMap;

use display::list::ARROW_LENGTH;
use tpn::{ArcId, Network, NodeId, Role};

use crate::caption::{self, Caption};
use crate::contents::Contents;
use crate::layered::{self, CoreLayout};
use crate::metrics::{
    ARCH_CORNER, ARCH_FIRST, ARCH_FOOT, ARCH_GAP, ARCH_STEP, BEAD_STEP, GUTTER, LANE_GAP, OUTLINE_PAD,
    SHORTEST_RUN, TEXT_LIFT, TEXT_PAD, TextRole, VERTEX_RADIUS, node_radius,
};
use crate::options::Options;
use crate::rows::Rows;
use crate::text::{ArcTexts, Run, one_row_size, sizes_above_and_below};
use crate::tree::{Branch, Part, PartId, PartKind, Tree};

/// The room of a part: from its start node's middle to its end node's, and above and below the line between them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Size {
    pub(crate) width: f64,
    pub(crate) above: f64,
    pub(crate) below: f64,
}

/// The room of a branch between the places where its fork and join arcs run level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BranchSize {
    /// The level run of the fork arc.
    pub(crate) run_in: f64,
    /// The level run of the join arc.
    pub(crate) run_out: f64,
    pub(crate) room: Size,
}

/// How the branches of a fan are stacked.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FanRows {
    /// Each branch's line relative to the fork, in textual order from top to bottom.
    pub(crate) offsets: Vec<f64>,
    /// The space in which the arcs spread to their lines.
    pub(crate) gutter: f64,
}

/// The free space that texts and curves keep around a node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Clearance {
    pub(crate) radius: f64,
    /// To the right, above the line: past the arches that rise from the node.
    pub(crate) after: f64,
    /// To the left, above the line: past the arches that come down to it.
    pub(crate) before: f64,
    /// To both sides, below the line: past its window.
    pub(crate) beneath: f64,
    /// Increases downward.
    pub(crate) below: f64,
}

/// The sizes of everything in a tree.
pub(crate) struct Sizes<'a> {
    pub(crate) tree: &'a Tree,
    pub(crate) texts: &'a ArcTexts<'a>,
    pub(crate) clearances: Vec<Clearance>,
    pub(crate) parts: Vec<Size>,
    pub(crate) branches: Vec<BranchSize>,
    /// Of each spanning arc, how many arches rise further left at its start, and come down further right at its end.
    pub(crate) arch_ranks: Vec<(u32, u32)>,
    pub(crate) cores: Vec<CoreLayout>,
    /// The rows of the series that are broken into rows.
    pub(crate) rows: BTreeMap<PartId, Rows>,
    /// Series longer than this are.
    row_width: f64,
    /// Of each collapsed part, in the order of the parts, what its box says.
    pub(crate) captions: Vec<Caption>,
}

impl<'a> Sizes<'a> {
    pub(crate) fn new(
        network: &Network,
        contents: &Contents,
        tree: &'a Tree,
        texts: &'a ArcTexts<'a>,
        options: &Options,
    ) -> Self {
        let ArchRanks { ranks: arch_ranks, counts: arches } = arch_ranks(network, tree);
        let clearances = clearances(network, options, tree, &arches);
        let mut sizes = Self {
            tree,
            texts,
            clearances,
            parts: Vec::with_capacity(tree.parts.len()),
            branches: vec![BranchSize::default(); tree.branches.len()],
            arch_ranks,
            cores: Vec::with_capacity(tree.cores.len()),
            rows: BTreeMap::new(),
            row_width: options.row_width,
            captions: caption::captions(network, contents, tree, options, texts.measure),
        };
        sizes.measure();
        sizes
    }

    /// Breaks series that are longer than `width` into rows, and no others.
    pub(crate) fn break_rows(&mut self, width: f64) {
        self.row_width = width;
        self.parts.clear();
        self.cores.clear();
        self.rows.clear();
        self.measure();
    }

    fn measure(&mut self) {
        let mut next_caption = 0;
        for part in &self.tree.parts {
            let size = self.part(part, &mut next_caption);
            self.parts.push(size);
        }
    }

    pub(crate) fn of(&self, part: PartId) -> Size {
        self.parts[part.index()]
    }

    pub(crate) fn clearance(&self, node: NodeId) -> Clearance {
        self.clearances[node.index()]
    }

    pub(crate) fn runs(&self, arc: ArcId) -> &'a [Run] {
        self.texts.of(arc)
    }

    fn part(&mut self, part: &Part, next_caption: &mut usize) -> Size {
        let (start, end) = (self.clearance(part.start), self.clearance(part.end));
        let ends =
            Size { width: 0.0, above: start.radius.max(end.radius), below: start.below.max(end.below) };
        match &part.kind {
            PartKind::Nothing if part.start == part.end => ends,
            PartKind::Nothing => Size { width: start.radius + SHORTEST_RUN + end.radius, ..ends },
            PartKind::Arc(arc) => cover(ends, self.straight(*arc, start, end)),
            PartKind::Series(range) => {
                let children: Vec<Size> =
                    self.tree.children(range).iter().map(|&child| self.of(child)).collect();
                let line = children.iter().fold(Size::default(), |sum, &size| Size {
                    width: sum.width + size.width,
                    ..cover(sum, size)
                });
                let rows = (line.width > self.row_width && !self.has_core(range))
                    .then(|| Rows::new(&children, self.row_width, end));
                match rows.filter(|rows| rows.starts.len() > 1) {
                    Some(rows) => {
                        let size = rows.size;
                        self.rows.insert(PartId(self.parts.len() as u32), rows);
                        cover(ends, size)
                    }
                    None => line,
                }
            }
            PartKind::Fan { branches, .. } => {
                let range = branches.start as usize..branches.end as usize;
                for (at, branch) in range.clone().zip(self.tree.branches(branches)) {
                    self.branches[at] = self.branch(branch);
                }
                let rows = fan_rows(&self.branches[range.clone()]);
                let widest =
                    self.branches[range.clone()].iter().map(|size| size.room.width).fold(0.0, f64::max);
                let (first, last) = (range.start, range.end - 1);
                let above = self.branches[first].room.above - rows.offsets.first().copied().unwrap_or(0.0);
                let below = self.branches[last].room.below + rows.offsets.last().copied().unwrap_or(0.0);
                let width = lead_out(start) + lead_in(end) + 2.0 * rows.gutter + widest;
                cover(ends, Size { width, above, below })
            }
            PartKind::Span { child, arcs, occurrence } => {
                let mut size = self.of(*child);
                let arches = self.arches(*child, arcs);
                for arch in &arches {
                    size.width = size.width.max(arch.min_width);
                }
                size.above = arches.first().map_or(size.above, Arch::top);
                if occurrence.is_some() {
                    size.above += OUTLINE_PAD;
                    size.below += OUTLINE_PAD;
                }
                cover(ends, size)
            }
            PartKind::Beads { arc, chain } => {
                let mut size = self.straight(*arc, start, end);
                let beads = self.beads(*arc, chain);
                size.width = size.width.max(beads.min_width);
                size.above = beads.height + VERTEX_RADIUS + TEXT_LIFT;
                cover(ends, size)
            }
            PartKind::Collapsed(_) => {
                let caption = &self.captions[*next_caption];
                *next_caption += 1;
                let (text, half) = (caption.width() + 4.0 * TEXT_PAD, caption.height() / 2.0);
                let width =
                    start.after.max(start.beneath) + text + end.before.max(end.beneath) + 4.0 * TEXT_PAD;
                cover(ends, Size { width, above: half, below: half })
            }
            PartKind::Core(core) => {
                let layout = layered::arrange(self, &self.tree.cores[*core as usize]);
                let size = layout.size;
                self.cores.push(layout);
                cover(ends, size)
            }
        }
    }

    /// Returns whether a series holds an irregular graph, whose nodes cannot begin in one row and end in the next.
    fn has_core(&self, range: &std::ops::Range<u32>) -> bool {
        self.tree.children(range).iter().any(|&child| matches!(self.tree.part(child).kind, PartKind::Core(_)))
    }

    /// An arc between two nodes on one line.
    pub(crate) fn straight(&self, arc: ArcId, start: Clearance, end: Clearance) -> Size {
        let (above, below) = sizes_above_and_below(self.runs(arc));
        let padded = |width: f64| if width > 0.0 { width + 2.0 * TEXT_PAD } else { 0.0 };
        let width = (start.after + padded(above.width) + end.before + ARROW_LENGTH)
            .max(start.beneath + padded(below.width) + end.beneath)
            .max(start.radius + SHORTEST_RUN + end.radius);
        Size { width, above: lifted(above.height), below: lifted(below.height) }
    }

    fn branch(&self, branch: &Branch) -> BranchSize {
        let none = Clearance::default();
        let child = branch.child.map(|child| (self.of(child), self.tree.part(child)));
        let mut room = child.map_or(Size::default(), |(size, _)| size);
        let (mut run_in, mut run_out) = (0.0, 0.0);
        if let Some(fork) = branch.fork {
            let target = child.map_or(none, |(_, part)| self.clearance(part.start));
            let run = self.straight(fork, none, target);
            run_in = run.width;
            room = cover(run, room);
        }
        if let Some(join) = branch.join {
            let source = child.map_or(none, |(_, part)| self.clearance(part.end));
            let run = self.straight(join, source, none);
            run_out = run.width;
            room = cover(run, room);
        }
        room.width += run_in + run_out;
        BranchSize { run_in, run_out, room }
    }

    /// The arch on which the vertices of a traverse's path are strung.
    pub(crate) fn beads(&self, arc: ArcId, chain: &std::ops::Range<u32>) -> Arch {
        let (above, _) = sizes_above_and_below(self.runs(arc));
        let height = lifted(above.height).max(ARCH_FOOT + ARCH_CORNER - ARCH_GAP) + ARCH_GAP;
        let (rank_out, rank_in) = self.arch_ranks[chain.start as usize];
        let (rise, fall) = (arch_offset(rank_out), arch_offset(rank_in));
        let beads = f64::from(chain.end - chain.start) - 1.0;
        let min_width = rise + fall + 2.0 * ARCH_CORNER + (beads + 1.0) * BEAD_STEP;
        Arch { arc, height, text_height: 0.0, text_width: 0.0, rise, fall, min_width }
    }

    /// The arches of a span, outermost first.
    pub(crate) fn arches(&self, child: PartId, arcs: &std::ops::Range<u32>) -> Vec<Arch> {
        let mut level = self.of(child).above.max(ARCH_FOOT + ARCH_CORNER - ARCH_GAP);
        let mut arches = Vec::with_capacity(arcs.len());
        for at in arcs.clone().rev() {
            let arc = self.tree.spanning[at as usize];
            let text = one_row_size(self.runs(arc));
            let (rank_out, rank_in) = self.arch_ranks[at as usize];
            let (rise, fall) = (arch_offset(rank_out), arch_offset(rank_in));
            level += ARCH_GAP;
            let min_width = rise + fall + 2.0 * ARCH_CORNER + text.width;
            arches.push(Arch {
                arc,
                height: level,
                text_height: text.height,
                text_width: text.width,
                rise,
                fall,
                min_width,
            });
            level += lifted(text.height);
        }
        arches.reverse();
        arches
    }
}

/// An arc over what it spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Arch {
    pub(crate) arc: ArcId,
    /// How high its level run lies above the line of its nodes.
    pub(crate) height: f64,
    pub(crate) text_height: f64,
    pub(crate) text_width: f64,
    /// How far right of its start it rises.
    pub(crate) rise: f64,
    /// How far left of its end it comes down.
    pub(crate) fall: f64,
    pub(crate) min_width: f64,
}

impl Arch {
    /// Returns how high its text reaches.
    pub(crate) fn top(&self) -> f64 {
        self.height + lifted(self.text_height)
    }
}

/// Returns how far right of a fork its arcs begin to spread.
pub(crate) fn lead_out(start: Clearance) -> f64 {
    start.after.max(start.beneath) + 2.0
}

/// Returns how far left of a join its arcs have come together.
pub(crate) fn lead_in(end: Clearance) -> f64 {
    end.before.max(end.beneath) + 2.0 + ARROW_LENGTH
}

/// Stacks branches; the fork is in the middle, on the line of the middle branch if that is near.
pub(crate) fn fan_rows(branches: &[BranchSize]) -> FanRows {
    let mut offsets = Vec::with_capacity(branches.len());
    let mut line = 0.0;
    let mut below = None;
    for branch in branches {
        if let Some(below) = below {
            line += below + LANE_GAP + branch.room.above;
        }
        below = Some(branch.room.below);
        offsets.push(line);
    }
    let mut center = (line / 2.0).floor();
    let middle = offsets.get(branches.len() / 2).copied().unwrap_or(0.0);
    if branches.len() % 2 == 1 && (middle - center).abs() <= 2.0 * LANE_GAP {
        center = middle;
    }
    for offset in &mut offsets {
        *offset -= center;
    }
    let farthest = center.max(line - center);
    let gutter = if branches.len() == 1 { 0.0 } else { (farthest * 0.35).clamp(GUTTER.0, GUTTER.1).floor() };
    FanRows { offsets, gutter }
}

/// Returns how far from its node an arch stands.
fn arch_offset(rank: u32) -> f64 {
    ARCH_FIRST + ARCH_STEP * f64::from(rank)
}

/// The height of a text and its distance from the line.
pub(crate) fn lifted(height: f64) -> f64 {
    if height > 0.0 { height + TEXT_LIFT } else { 0.0 }
}

/// The heights of both, the width of the second.
fn cover(first: Size, second: Size) -> Size {
    Size { width: second.width, above: first.above.max(second.above), below: first.below.max(second.below) }
}

/// How arches stand beside each other at their nodes.
struct ArchRanks {
    /// Of each spanning arc, how many stand further out at its start, and at its end.
    ranks: Vec<(u32, u32)>,
    /// Of each node, how many rise from it, and how many come down to it.
    counts: Vec<(u32, u32)>,
}

/// The rank of each spanning arc at its two nodes, and how many arches each node has on either side.
/// Parents come later in the tree, so going backwards meets the outer arches first.
fn arch_ranks(network: &Network, tree: &Tree) -> ArchRanks {
    let mut counts = vec![(0, 0); network.nodes.len()];
    let mut ranks = vec![(0, 0); tree.spanning.len()];
    for part in tree.parts.iter().rev() {
        let arches = match &part.kind {
            PartKind::Span { arcs, .. } => arcs.clone(),
            // A path is on its traverse as one arch.
            PartKind::Beads { chain, .. } => chain.start..chain.start + 1,
            _ => continue,
        };
        for at in arches {
            let (start, end) = (part.start.index(), part.end.index());
            ranks[at as usize] = (counts[start].0, counts[end].1);
            counts[start].0 += 1;
            counts[end].1 += 1;
        }
    }
    ArchRanks { ranks, counts }
}

/// The space around each node at which a part begins or ends.
fn clearances(network: &Network, options: &Options, tree: &Tree, arches: &[(u32, u32)]) -> Vec<Clearance> {
    let half_window = (options.window_width / 2.0).ceil();
    let side = |radius: f64, count: u32| {
        if count == 0 { radius } else { radius.max(arch_offset(count - 1) + TEXT_LIFT) }
    };
    let clearance = |at: usize| {
        let (node, (after, before)) = (&network.nodes[at], arches[at]);
        let radius = node_radius(network, node);
        let has_window =
            options.window_width > 0.0 && node.role != Role::Structural && radius > VERTEX_RADIUS;
        let (beneath, below) = if has_window {
            (radius.max(half_window), radius + 2.0 + TextRole::Window.line_height())
        } else {
            (radius, radius)
        };
        Clearance { radius, after: side(radius, after), before: side(radius, before), beneath, below }
    };
    let mut clearances = vec![Clearance::default(); network.nodes.len()];
    for part in &tree.parts {
        for node in [part.start.index(), part.end.index()] {
            clearances[node] = clearance(node);
        }
    }
    for part in &tree.parts {
        // Outside an activity, texts begin beyond its outline.
        if let PartKind::Span { occurrence: Some(_), .. } = part.kind {
            let start = &mut clearances[part.start.index()];
            start.before = start.before.max(start.radius + OUTLINE_PAD);
            let end = &mut clearances[part.end.index()];
            end.after = end.after.max(end.radius + OUTLINE_PAD);
        }
    }
    clearances
}
