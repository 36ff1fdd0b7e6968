//! The layout of a network: what is where, and the way back from a place to what is there.
//!
//! It knows nothing of lines and colors: [`crate::list`] makes the display list of it.

use display::geometry::distance_point_curve;
use display::{Piece, Point, Rect, SpatialIndex};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use tpn::{ArcId, ArcKind, BlockId, LabelId, NodeId, OccurrenceId, Role};

use crate::metrics::TextRole;

/// A network as shapes. Nodes and arcs are in the order of their ids; blocks come parents first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct NetworkDrawing {
    /// Everything lies inside.
    pub bounds: Rect,
    /// The events that are visible.
    pub nodes: Vec<NodeShape>,
    /// The constraints that are visible.
    pub arcs: Vec<ArcShape>,
    pub texts: Vec<TextShape>,
    /// Outlines of activities, lanes of branches, and boxes of collapsed blocks.
    pub blocks: Vec<BlockShape>,
    /// Lines that belong to no arc: where a node is drawn out to several places.
    pub connectors: Vec<Connector>,
    /// The pieces of all curves; an arc's are a range of these.
    pub pieces: Vec<Piece>,
    pub(crate) node_slots: Vec<u32>,
    pub(crate) arc_slots: Vec<u32>,
    /// Where every node is, or, if it is hidden, the box that hides it.
    pub(crate) anchors: Vec<Point>,
    /// Of every node that is hidden, the position of its box in `blocks`.
    pub(crate) box_slots: Vec<u32>,
    pub(crate) index: SpatialIndex<Shape>,
}

/// Where an event of the network is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NodeShape {
    pub id: NodeId,
    pub center: Point,
    /// Its outer radius.
    pub radius: f64,
    /// Circle, dot, or double circle.
    pub role: Role,
}

/// A constraint as a curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArcShape {
    pub id: ArcId,
    /// What it represents.
    pub kind: ArcKind,
    /// Whether the environment chooses the duration.
    pub is_contingent: bool,
    /// How it is routed.
    pub route: Route,
    /// Where the curve begins.
    pub start: Point,
    /// First of its pieces in [`NetworkDrawing::pieces`].
    pub first_piece: u32,
    /// How many pieces.
    pub piece_count: u32,
    /// The curve lies inside.
    pub bounds: Rect,
}

/// How an arc is routed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Route {
    /// Along the line between its nodes, or out of a fork, or into a join.
    Along,
    /// Over what it spans.
    Arch,
    /// Across the structure, which does not have it.
    Across,
}

/// A text in the rectangle that is reserved for it alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TextShape {
    pub text: SmolStr,
    pub role: TextRole,
    /// Text size, at most that of the role.
    pub size: f64,
    /// The text fills its width; it is centered in its height.
    pub rect: Rect,
    /// What it belongs to.
    pub owner: Item,
    /// Present if the text may be moved along its line to stay in view.
    pub slide: Option<Slide>,
}

/// How far a row of texts may be moved along a long arc.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slide {
    pub arc: ArcId,
    /// The left edge and the width of the row that the text is part of.
    pub row: (f64, f64),
    /// The least and greatest left edge that the row may have.
    pub limits: (f64, f64),
}

impl Slide {
    /// The same without the arc.
    pub(crate) const fn along_row(self) -> display::Slide {
        display::Slide { row: self.row, limits: self.limits }
    }
}

impl TextShape {
    /// Returns where the text is when its row is moved, as far as it may be, between `left` and `right`.
    pub fn rect_in_view(&self, left: f64, right: f64) -> Rect {
        let Some(slide) = self.slide else { return self.rect };
        slide.along_row().moved(self.rect, left, right)
    }
}

/// A piece of the program's structure as a rectangle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlockShape {
    /// Which one; `None` for structure that was recovered from the graph.
    pub block: Option<BlockId>,
    /// The last one, if it is a box for several neighbors; otherwise the same.
    pub last: Option<BlockId>,
    pub form: BlockForm,
    pub rect: Rect,
    /// How many outlines it lies in.
    pub depth: u32,
    /// The activity instance or scenario, if it is one.
    pub occurrence: Option<OccurrenceId>,
    /// Its name, for views so far out that nothing else can be read.
    pub title: SmolStr,
}

/// What a [`BlockShape`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum BlockForm {
    /// The outline of an activity instance or scenario.
    Activity,
    /// The lane of a parallel branch.
    Lane,
    /// The lane of an alternative.
    Alternative,
    /// A block whose inside is hidden.
    Collapsed,
}

/// A line from a node to another place that represents the same node.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Connector {
    pub node: NodeId,
    /// Where the curve begins.
    pub start: Point,
    /// Its only piece.
    pub piece: Piece,
}

/// Something on the drawing that can be pointed at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Item {
    Node(NodeId),
    /// A condition on an arc.
    Label(LabelId),
    Arc(ArcId),
    Block(BlockId),
}

/// A shape, by its position in the list of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Shape {
    /// In [`NetworkDrawing::blocks`].
    Block(u32),
    /// In [`NetworkDrawing::connectors`].
    Connector(u32),
    /// In [`NetworkDrawing::arcs`].
    Arc(u32),
    /// In [`NetworkDrawing::nodes`].
    Node(u32),
    /// In [`NetworkDrawing::texts`].
    Text(u32),
}

/// Stands in a slot table for "not drawn".
pub(crate) const NO_SLOT: u32 = u32::MAX;

impl NetworkDrawing {
    /// The shape of a node, unless it is hidden in a collapsed block.
    pub fn node(&self, id: NodeId) -> Option<&NodeShape> {
        self.node_slots.get(id.index()).and_then(|&slot| self.nodes.get(slot as usize))
    }

    /// The shape of an arc, unless it is hidden in a collapsed block.
    pub fn arc(&self, id: ArcId) -> Option<&ArcShape> {
        self.arc_slots.get(id.index()).and_then(|&slot| self.arcs.get(slot as usize))
    }

    /// Returns where a node is, or the middle of the collapsed block that hides it.
    pub fn anchor(&self, id: NodeId) -> Point {
        self.anchors.get(id.index()).copied().unwrap_or_default()
    }

    /// The box that hides a node, if one does.
    pub fn box_of(&self, id: NodeId) -> Option<&BlockShape> {
        self.box_slots.get(id.index()).and_then(|&slot| self.blocks.get(slot as usize))
    }

    /// The pieces of an arc's curve.
    pub fn pieces(&self, arc: &ArcShape) -> &[Piece] {
        let first = arc.first_piece as usize;
        self.pieces.get(first..first + arc.piece_count as usize).unwrap_or(&[])
    }

    /// The tip of an arc's head and the point it comes from. Pieces of a path have none: they are too short.
    pub fn arrow(&self, arc: &ArcShape) -> Option<(Point, Point)> {
        if arc.kind == ArcKind::Path {
            return None;
        }
        let pieces = self.pieces(arc);
        let (last, before) = pieces.split_last()?;
        let start = before.last().map_or(arc.start, |piece| piece.end());
        Some((last.end(), last.before_end(start)))
    }

    /// Calls `visit` for every shape that touches `area` and is at least `min_size` wide or high, in an order that
    /// depends on the drawing alone. Takes time in proportion to what is found, not to the drawing.
    pub fn visit(&self, area: Rect, min_size: f64, visit: &mut dyn FnMut(Shape)) {
        self.index.visit(area, min_size, visit);
    }

    /// The index of all shapes by place.
    pub(crate) fn indexed(&self) -> SpatialIndex<Shape> {
        let counts = [self.blocks.len(), self.connectors.len(), self.arcs.len(), self.nodes.len()];
        let mut shapes = Vec::with_capacity(counts.iter().sum::<usize>() + self.texts.len());
        let mut add = |count: usize, shape: fn(u32) -> Shape| {
            shapes.extend((0..count as u32).map(|at| (self.shape_bounds(shape(at)), shape(at))));
        };
        add(counts[0], Shape::Block);
        add(counts[1], Shape::Connector);
        add(counts[2], Shape::Arc);
        add(counts[3], Shape::Node);
        add(self.texts.len(), Shape::Text);
        SpatialIndex::new(self.bounds, shapes)
    }

    /// The rectangle of a shape.
    pub fn shape_bounds(&self, shape: Shape) -> Rect {
        match shape {
            Shape::Block(at) => self.blocks.get(at as usize).map_or(Rect::default(), |block| block.rect),
            Shape::Connector(at) => self.connectors.get(at as usize).map_or(Rect::default(), |connector| {
                display::geometry::curve_bounds(connector.start, &[connector.piece])
            }),
            Shape::Arc(at) => self.arcs.get(at as usize).map_or(Rect::default(), |arc| arc.bounds),
            Shape::Node(at) => self
                .nodes
                .get(at as usize)
                .map_or(Rect::default(), |node| Rect::around(node.center, node.radius)),
            Shape::Text(at) => self.texts.get(at as usize).map_or(Rect::default(), |text| text.rect),
        }
    }

    /// Returns what lies at `point`, or at most `tolerance` beside it: a node before a text before the nearest arc
    /// before the innermost block.
    pub fn pick(&self, point: Point, tolerance: f64) -> Option<Item> {
        let mut best: Option<(u8, f64, Item)> = None;
        self.index.visit(Rect::around(point, tolerance), 0.0, &mut |shape| {
            if let Some(found) = self.pick_shape(shape, point, tolerance)
                && best.is_none_or(|known| (found.0, found.1) < (known.0, known.1))
            {
                best = Some(found);
            }
        });
        best.map(|(_, _, item)| item)
    }

    /// The rank, distance and item of `shape` if it is at `point`; smaller ranks win.
    fn pick_shape(&self, shape: Shape, point: Point, tolerance: f64) -> Option<(u8, f64, Item)> {
        match shape {
            Shape::Node(at) => {
                let node = self.nodes.get(at as usize)?;
                let beyond = node.center.distance(point) - node.radius;
                (beyond <= tolerance).then_some((0, beyond, Item::Node(node.id)))
            }
            Shape::Text(at) => {
                let text = self.texts.get(at as usize)?;
                text.rect.contains(point).then_some((1, 0.0, text.owner))
            }
            Shape::Arc(at) => {
                let arc = self.arcs.get(at as usize)?;
                let distance = distance_point_curve(point, arc.start, self.pieces(arc));
                (distance <= tolerance).then_some((2, distance, Item::Arc(arc.id)))
            }
            Shape::Connector(at) => {
                let connector = self.connectors.get(at as usize)?;
                let distance = distance_point_curve(point, connector.start, &[connector.piece]);
                (distance <= tolerance).then_some((3, distance, Item::Node(connector.node)))
            }
            Shape::Block(at) => {
                let block = self.blocks.get(at as usize)?;
                let id = block.block.filter(|_| block.rect.contains(point))?;
                Some((4, -f64::from(block.depth), Item::Block(id)))
            }
        }
    }
}
