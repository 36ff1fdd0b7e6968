//! Arcs that the structure does not have: drawn as free curves over everything, their texts wherever there is room.

use std::collections::{BTreeMap, BTreeSet};

use display::geometry::curve_bounds;
use display::{Piece, Point, Rect, SpatialIndex};
use tpn::{ArcId, Network, NodeId};

use crate::drawing::{ArcShape, NO_SLOT, NetworkDrawing, Route, Shape, TextShape};
use crate::metrics::{TEXT_LIFT, WORD_GAP, rounded_up};
use crate::overlay::free_curve;
use crate::text::{ArcTexts, one_row_size};
use crate::tree::Tree;

/// Where along its curve a text is tried, from best to worst.
const TRIES: [f64; 7] = [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8];
/// Size of the cells in which the texts placed here are looked up.
const CELL: f64 = 128.0;

/// Adds the arcs that are neither drawn nor inside a collapsed block.
pub(crate) fn add_arcs_across(
    network: &Network,
    tree: &Tree,
    texts: &ArcTexts<'_>,
    hidden_nodes: &[Option<u32>],
    collapsed_ends: &BTreeSet<(NodeId, NodeId)>,
    drawing: &mut NetworkDrawing,
) {
    let folding = &tree.folding;
    let hidden = |node: NodeId| hidden_nodes[node.index()].filter(|_| drawing.node(node).is_none());
    let is_end = |fold: u32, node: NodeId| {
        let fold = folding.folds[fold as usize];
        fold.start == node || fold.end == node
    };
    let is_inside = |from: NodeId, to: NodeId| match (hidden(from), hidden(to)) {
        (None, None) => collapsed_ends.contains(&(from, to)),
        (Some(left), Some(right)) => left == right,
        (Some(fold), None) => is_end(fold, to),
        (None, Some(fold)) => is_end(fold, from),
    };
    let missing: Vec<ArcId> = (0..network.arcs.len())
        .filter(|&at| drawing.arc_slots[at] == NO_SLOT)
        .filter(|&at| !is_inside(network.arcs[at].from, network.arcs[at].to))
        .map(ArcId::from_index)
        .collect();
    if missing.is_empty() {
        return;
    }
    let index = drawing.indexed();
    let mut taken = Taken { index: &index, cells: BTreeMap::new() };
    for id in missing {
        add_arc(network, texts, id, &mut taken, drawing);
    }
    renumber(network, drawing);
}

/// The room that is taken: what the index knows, and the texts placed since.
struct Taken<'a> {
    index: &'a SpatialIndex<Shape>,
    cells: BTreeMap<(i64, i64), Vec<Rect>>,
}

impl Taken<'_> {
    fn is_free(&self, rect: Rect) -> bool {
        let mut free = true;
        self.index.visit(rect, 0.0, &mut |shape| free &= !matches!(shape, Shape::Node(_) | Shape::Text(_)));
        free && cells(rect).all(|cell| {
            self.cells.get(&cell).is_none_or(|others| others.iter().all(|other| !other.overlaps(rect)))
        })
    }

    fn take(&mut self, rect: Rect) {
        for cell in cells(rect) {
            self.cells.entry(cell).or_default().push(rect);
        }
    }
}

fn cells(rect: Rect) -> impl Iterator<Item = (i64, i64)> {
    let cell = |length: f64| (length / CELL).floor() as i64;
    let (left, right, top, bottom) = (cell(rect.min.x), cell(rect.max.x), cell(rect.min.y), cell(rect.max.y));
    (top..=bottom).flat_map(move |row| (left..=right).map(move |column| (row, column)))
}

fn add_arc(
    network: &Network,
    texts: &ArcTexts<'_>,
    id: ArcId,
    taken: &mut Taken<'_>,
    drawing: &mut NetworkDrawing,
) {
    let arc = &network.arcs[id.index()];
    let radius = |node: NodeId| drawing.node(node).map_or(0.0, |shape| shape.radius);
    let (start, piece) =
        free_curve(drawing.anchor(arc.from), radius(arc.from), drawing.anchor(arc.to), radius(arc.to));
    let first_piece = drawing.pieces.len() as u32;
    drawing.pieces.push(piece);
    drawing.arcs.push(ArcShape {
        id,
        kind: arc.kind,
        is_contingent: network.is_uncertain(id),
        route: Route::Across,
        start,
        first_piece,
        piece_count: 1,
        bounds: curve_bounds(start, &[piece]),
    });
    write_texts(texts, id, start, piece, taken, drawing);
}

/// Writes the arc's texts in one row beside its curve, where nothing else is; nowhere if there is no such place.
fn write_texts(
    texts: &ArcTexts<'_>,
    id: ArcId,
    start: Point,
    piece: Piece,
    taken: &mut Taken<'_>,
    drawing: &mut NetworkDrawing,
) {
    let runs = texts.of(id);
    let size = one_row_size(runs);
    let row = TRIES.into_iter().flat_map(|fraction| {
        let at = piece.at(start, fraction);
        let left = rounded_up(at.x - size.width / 2.0);
        let above = rounded_up(at.y) - TEXT_LIFT - size.height;
        let below = rounded_up(at.y) + TEXT_LIFT;
        [above, below].map(|top| Rect::new(left, top, left + size.width, top + size.height))
    });
    let Some(row) = row.into_iter().find(|row| taken.is_free(row.expanded(1.0))) else { return };
    taken.take(row);
    let mut left = row.min.x;
    for run in runs {
        drawing.texts.push(TextShape {
            text: run.text.clone(),
            role: run.role,
            size: run.size,
            rect: Rect::new(left, row.min.y, left + run.width, row.max.y),
            owner: run.owner,
            slide: None,
        });
        left += run.width + WORD_GAP;
    }
}

/// Puts the arcs back into the order of their ids.
fn renumber(network: &Network, drawing: &mut NetworkDrawing) {
    drawing.arcs.sort_by_key(|arc| arc.id);
    drawing.arc_slots = vec![NO_SLOT; network.arcs.len()];
    for (slot, arc) in drawing.arcs.iter().enumerate() {
        drawing.arc_slots[arc.id.index()] = slot as u32;
    }
}
