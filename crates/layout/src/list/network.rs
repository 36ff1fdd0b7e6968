//! A network as a display list: its structure and arcs, what a plan says of them, and what lies over them.

use std::collections::{BTreeMap, BTreeSet};

use display::geometry::segment_meets_rect;
use display::{
    Anchor, ColorRole, Detail, DisplayList, Fit, Group, Measure, PathEnd, Rect, Stroke, TargetKind, Text,
    approximate_text_width,
};
use tpn::{ArcId, ArcKind, LabelId, Network, NodeId, OccurrenceId, Plan, Role};

use crate::drawing::{ArcShape, BlockForm, BlockShape, Item, NetworkDrawing, NodeShape, Route, TextShape};
use crate::joints::Joints;
use crate::metrics::{DECISION_INSET, TextRole};
use crate::overlay::{OverlayCurve, OverlayKind};
use crate::progress::{Progress, elapsed};
use crate::style::{self, Parts, Standing};
use crate::threads::{thread_name, threads};

/// What of a network's drawing is shown.
#[derive(Clone, Copy, Debug, Default)]
pub struct NetworkState<'a> {
    /// The plan that is marked, if any.
    pub plan: Option<&'a Plan>,
    /// Curves over the drawing.
    pub overlays: &'a [OverlayCurve],
    /// Texts over the drawing, such as windows.
    pub notes: &'a [TextShape],
    /// Which parts are shown.
    pub parts: Parts,
}

/// Shapes that stand out, because they are selected, pointed at, or what a step is about.
#[derive(Clone, Copy, Debug)]
pub struct Emphasis<'a> {
    /// Rings around these.
    pub nodes: &'a [NodeId],
    /// A glow behind these.
    pub arcs: &'a [ArcId],
    /// A plate behind these, if there is a color for it.
    pub labels: &'a [LabelId],
    /// The outline of this activity.
    pub occurrence: Option<OccurrenceId>,
    /// The color of rings and glows, and how strong they are.
    pub color: (ColorRole, f32),
    /// The color of plates.
    pub plate: Option<ColorRole>,
}

/// Layers of the network's lists.
mod layer {
    pub(super) const LANES: u8 = 0;
    pub(super) const BLOCKS: u8 = 1;
    pub(super) const EMPHASIS: u8 = 2;
    pub(super) const ARCS: u8 = 3;
    pub(super) const ELAPSED: u8 = 4;
    pub(super) const OVERLAYS: u8 = 5;
    pub(super) const NODES: u8 = 6;
    pub(super) const HEADINGS: u8 = 7;
    pub(super) const TEXTS: u8 = 8;
    pub(super) const DONE: u8 = 9;
}

/// Below this zoom, activities are named by their outlines instead of their arcs.
const FAR_ZOOM: f64 = 0.42;
/// Below this zoom only activities and structure are drawn: single connections would run together.
const OVERVIEW_ZOOM: f64 = 0.06;
/// Below this zoom, rows lie too close for names between them.
const CROWDED_ZOOM: f64 = 0.28;
/// From this zoom on, the inner circle of a decision can be told from the outer one.
const INSET_ZOOM: f64 = 0.4;
/// With more curves over the drawing than this in view, they are drawn faint.
const MAX_CURVES: u32 = 80;
/// Size of headings, and from the corner of an area to its heading.
const HEADING: (f64, f64, f64) = (11.0, 4.0, 2.0);
/// How far a ring reaches around its node, and how broad a glow is.
const RING: (f64, f64) = (4.0, 9.0);

/// The display list of a network. Linear in the drawing.
pub fn network_list(drawing: &NetworkDrawing, network: &Network, state: &NetworkState<'_>) -> DisplayList {
    let mut list = DisplayList::new(drawing.bounds);
    let builder = Builder::new(drawing, network, state);
    let lanes = if state.parts.lanes { lanes(drawing, network) } else { Vec::new() };
    list.begin(Group { layer: layer::LANES, ..Group::default() });
    for lane in &lanes {
        let role = if lane.number.is_multiple_of(2) { ColorRole::Hover } else { ColorRole::Surface };
        let stroke = Stroke::solid(ColorRole::Line, 1.0);
        list.rectangle(lane.rect, 0.0, Some(role.into()), Some(stroke));
    }
    list.begin(Group { layer: layer::BLOCKS, ..Group::default() });
    for block in &drawing.blocks {
        builder.block(block, &mut list);
    }
    builder.arcs(&mut list);
    let (bundled, single): (Vec<&OverlayCurve>, Vec<&OverlayCurve>) = state
        .overlays
        .iter()
        .partition(|curve| matches!(curve.kind, OverlayKind::CausalLink | OverlayKind::Ordering));
    for (curves, crowd) in [(bundled, Some(MAX_CURVES)), (single, None)] {
        list.begin(Group { layer: layer::OVERLAYS, crowd, min_size: 1.2, ..Group::default() });
        for curve in curves {
            add_curve(curve, &mut list);
        }
    }
    list.begin(Group { layer: layer::NODES, ..Group::default() });
    for node in &drawing.nodes {
        builder.node(node, &mut list);
    }
    list.begin(Group { layer: layer::HEADINGS, ..Group::default() });
    for lane in &lanes {
        let text = heading(&lane.name, lane.rect, &approximate_text_width);
        list.write(Text { plate: Some(ColorRole::Surface.into()), ..text });
    }
    for block in drawing.blocks.iter().filter(|block| !block.title.is_empty()) {
        let text = heading(&block.title, block.rect, &approximate_text_width);
        list.write(Text { plate: Some(ColorRole::Surface.faint(0.8)), ..text })
            .at(Detail::below(builder.zoom(FAR_ZOOM)));
    }
    list.begin(Group { layer: layer::TEXTS, ..Group::default() });
    let crossed = crossed_texts(drawing, state);
    for (at, text) in drawing.texts.iter().chain(state.notes).enumerate() {
        builder.text(text, crossed.contains(&at), &mut list);
    }
    list
}

/// The texts that curves over the drawing run through, by their position, notes after those of the drawing. Of more curves
/// than are drawn in full none is looked at.
fn crossed_texts(drawing: &NetworkDrawing, state: &NetworkState<'_>) -> BTreeSet<usize> {
    let mut found = BTreeSet::new();
    if state.overlays.len() > MAX_CURVES as usize {
        return found;
    }
    for curve in state.overlays {
        let line = display::geometry::flatten(curve.start, &curve.pieces);
        let is_crossed = |text: &TextShape| {
            // Links begin and end at the edges of texts.
            let inside = text.rect.expanded(-1.0);
            line.windows(2).any(|ends| segment_meets_rect(ends[0], ends[1], inside))
        };
        drawing.visit(curve.bounds, 0.0, &mut |shape| {
            if let crate::Shape::Text(at) = shape
                && is_crossed(&drawing.texts[at as usize])
            {
                found.insert(at as usize);
            }
        });
        let notes = state.notes.iter().enumerate().filter(|(_, note)| note.rect.touches(curve.bounds));
        found.extend(notes.filter(|(_, note)| is_crossed(note)).map(|(at, _)| drawing.texts.len() + at));
    }
    found
}

/// Returns what time has done to a network, over its list: how far arcs are that are under way, and dots in the events
/// that have happened. Of the events, those in `area` that are at least `min_size` wide; all with `None`.
pub fn progress_list(
    drawing: &NetworkDrawing,
    network: &Network,
    state: &NetworkState<'_>,
    progress: &Progress,
    area: Option<(Rect, f64)>,
) -> DisplayList {
    let builder = Builder::new(drawing, network, state);
    let mut list = DisplayList::new(drawing.bounds);
    list.begin(Group { layer: layer::ELAPSED, min_size: 2.0, ..Group::default() });
    for &(arc, fraction) in &progress.under_way {
        let is_seen = |shape: &ArcShape| area.is_none_or(|(area, _)| shape.bounds.touches(area));
        let part = drawing.arc(arc).filter(|shape| is_seen(shape));
        if let Some((start, pieces)) = part.and_then(|_| elapsed(drawing, arc, fraction)) {
            list.path(start, &pieces, PathEnd::Open, Stroke::solid(ColorRole::Now, 4.0));
        }
    }
    list.begin(Group { layer: layer::DONE, ..Group::default() });
    let (area, min_size) = area.unwrap_or((drawing.bounds, 0.0));
    let mut done = Vec::new();
    drawing.visit(area, min_size, &mut |shape| {
        let crate::Shape::Node(at) = shape else { return };
        let node = drawing.nodes[at as usize].id;
        if progress.done.binary_search(&node).is_ok() && builder.parts.shows(builder.standing(node)) {
            done.push(at);
        }
    });
    done.sort_unstable();
    for &at in &done {
        let node = &drawing.nodes[at as usize];
        // Its number, which the dot would hide, is on the dot.
        builder.node(node, &mut list);
        list.circle(node.center, style::done_radius(node.radius), Some(ColorRole::Now.into()), None);
    }
    drawing.visit(area, min_size, &mut |shape| {
        let crate::Shape::Text(at) = shape else { return };
        let text = &drawing.texts[at as usize];
        if let (Item::Node(node), TextRole::Node) = (text.owner, text.role)
            && progress.done.binary_search(&node).is_ok()
            && builder.parts.shows(builder.standing(node))
        {
            let marked = builder.text_of(text, Standing::Plain).colored(ColorRole::NodeFill);
            list.write(marked).at(Detail::from(readable_from(text)));
        }
    });
    list
}

/// Returns what stands out of a network, under and over its list. `chosen` are curves that are drawn in full however
/// many there are.
pub fn emphasis_list(
    drawing: &NetworkDrawing,
    network: &Network,
    state: &NetworkState<'_>,
    emphases: &[Emphasis<'_>],
    chosen: &[&OverlayCurve],
) -> DisplayList {
    let builder = Builder::new(drawing, network, state);
    let mut list = DisplayList::new(drawing.bounds);
    list.begin(Group { layer: layer::EMPHASIS, min_size: 4.0, ..Group::default() });
    for emphasis in emphases {
        let (role, strength) = emphasis.color;
        let color = role.faint(strength);
        let outlines = drawing.blocks.iter().filter(|block| block.occurrence.is_some());
        for block in outlines.filter(|block| block.occurrence == emphasis.occurrence) {
            let fill = role.faint(strength * 0.25);
            list.rectangle(block.rect, 6.0, Some(fill.into()), None);
        }
        let joints = Joints::new(drawing, network, emphasis.arcs.iter().copied());
        for arc in emphasis.arcs.iter().filter_map(|&arc| drawing.arc(arc)) {
            let (start, pieces) = joints.way(arc);
            list.path(start, &pieces, PathEnd::Open, Stroke::solid(color, RING.1));
        }
        for node in emphasis.nodes.iter().filter_map(|&node| drawing.node(node)) {
            list.circle(node.center, node.radius + RING.0, Some(color.into()), None);
        }
        let boxes = emphasis.nodes.iter().filter_map(|&node| drawing.box_of(node)).map(|shape| shape.rect);
        let boxes: Vec<Rect> = boxes.fold(Vec::new(), |mut found, rect| {
            if !found.contains(&rect) {
                found.push(rect);
            }
            found
        });
        for rect in boxes {
            list.rectangle(rect.expanded(RING.0), 8.0, Some(color.into()), None);
        }
    }
    list.begin(Group { layer: layer::EMPHASIS, ..Group::default() });
    for emphasis in emphases {
        let outlines = drawing.blocks.iter().filter(|block| block.occurrence.is_some());
        for block in outlines.filter(|block| block.occurrence == emphasis.occurrence) {
            let color = emphasis.color.0.faint(emphasis.color.1);
            list.rectangle(block.rect, 6.0, None, Some(Stroke::solid(color, 1.5)));
        }
    }
    list.begin(Group { layer: layer::OVERLAYS, min_size: 1.2, ..Group::default() });
    for curve in chosen {
        add_curve(curve, &mut list);
    }
    list.begin(Group { layer: layer::TEXTS, ..Group::default() });
    for emphasis in emphases.iter().filter(|it| !it.labels.is_empty()) {
        let Some(plate) = emphasis.plate else { continue };
        let is_marked =
            |text: &&TextShape| matches!(text.owner, Item::Label(it) if emphasis.labels.contains(&it));
        for text in drawing.texts.iter().filter(is_marked) {
            let standing = builder.standing_of(text.owner);
            if builder.parts.shows_text(text.role) && builder.parts.shows(standing) {
                let marked = builder.text_of(text, standing);
                list.write(Text { plate: Some(plate.into()), ..marked })
                    .at(Detail::from(readable_from(text)));
            }
        }
    }
    list
}

fn add_curve(curve: &OverlayCurve, list: &mut DisplayList) {
    let stroke = style::overlay_stroke(curve.kind);
    let item = list.path(curve.start, &curve.pieces, PathEnd::Head, stroke);
    match curve.kind {
        OverlayKind::CausalLink => item.stands_for(TargetKind::Link, curve.number),
        OverlayKind::Ordering => item.stands_for(TargetKind::Ordering, curve.number),
        OverlayKind::NegativeCycle | OverlayKind::Threat => item,
    };
}

/// The heading of an area.
fn heading(text: &str, area: Rect, measure: &dyn Measure) -> Text {
    let (size, x, y) = HEADING;
    let min = area.min.shifted(x, y);
    let width = display::text_width_at(text, size, measure);
    let rect = Rect { min, max: min.shifted(width, size + 4.0) };
    let text = Text::new(text, size, rect).anchored(Anchor::Start, Fit::Overflow);
    Text { heading: Some(area), ..text.colored(ColorRole::TextMuted) }
}

/// The band of a parallel branch.
struct Lane {
    rect: Rect,
    name: smol_str::SmolStr,
    /// Which of its fork's branches it is, from 1.
    number: usize,
}

fn lanes(drawing: &NetworkDrawing, network: &Network) -> Vec<Lane> {
    let shapes = drawing.blocks.iter().filter(|it| it.form == BlockForm::Lane);
    let shapes: BTreeMap<_, _> = shapes.filter_map(|lane| Some((lane.block?, lane.rect))).collect();
    let threads = threads(network);
    let named = threads.iter().enumerate().filter_map(|(at, thread)| {
        let rect = *shapes.get(&thread.block?)?;
        let name = thread_name(network, &threads[at..]).unwrap_or_default();
        Some(Lane { rect, name, number: thread.path.last().copied().unwrap_or(0) as usize })
    });
    named.collect()
}

/// The zoom from which a text can be read.
fn readable_from(text: &TextShape) -> f64 {
    FAR_ZOOM * text.role.size() / text.size
}

struct Builder<'a> {
    drawing: &'a NetworkDrawing,
    network: &'a Network,
    plan: Option<&'a Plan>,
    parts: Parts,
    /// By how much texts are larger than usual: a drawing in little room can be read at smaller zooms.
    enlarged: f64,
}

impl<'a> Builder<'a> {
    fn new(drawing: &'a NetworkDrawing, network: &'a Network, state: &NetworkState<'a>) -> Self {
        let sizes = drawing.texts.iter().map(|text| text.size / text.role.size());
        let enlarged = sizes.fold(1.0, f64::max);
        Self { drawing, network, plan: state.plan, parts: state.parts, enlarged }
    }

    /// Returns where texts are as small on the screen as usual ones are at this zoom.
    fn zoom(&self, usual: f64) -> f64 {
        usual / self.enlarged
    }

    fn standing(&self, node: NodeId) -> Standing {
        style::node_standing(self.plan, node)
    }

    fn standing_of(&self, item: Item) -> Standing {
        style::item_standing(self.plan, item, |label| self.network.labels[label.index()].arc)
    }

    fn block(&self, block: &BlockShape, list: &mut DisplayList) {
        const CORNER: f64 = 6.0;
        let (fill, stroke) = style::block_style(block.form);
        let is_shown = self.parts.structure || block.form == BlockForm::Collapsed;
        // From afar, outlines tell more than areas do.
        let outlined = match (is_shown, fill, block.form) {
            (true, None, _) => Detail::ALWAYS,
            (false, _, BlockForm::Activity) => Detail::below(self.zoom(FAR_ZOOM)),
            _ => Detail::below(OVERVIEW_ZOOM),
        };
        let target = block.block.map(|block| block.0);
        let mut add = |fill: Option<ColorRole>, detail: Detail| {
            let item = list.rectangle(block.rect, CORNER, fill.map(Into::into), Some(stroke));
            item.at(detail);
            if let Some(id) = target {
                item.stands_for(TargetKind::Block, id);
            }
        };
        add(None, outlined);
        if is_shown && fill.is_some() {
            add(fill, Detail::from(OVERVIEW_ZOOM));
        }
    }

    fn arcs(&self, list: &mut DisplayList) {
        list.begin(Group { layer: layer::ARCS, ..Group::default() });
        for connector in &self.drawing.connectors {
            let standing = self.standing(connector.node);
            if self.parts.shows(standing) {
                let stroke = style::arc_stroke(ArcKind::Glue, Route::Along, false, standing);
                list.path(connector.start, &[connector.piece], PathEnd::Open, stroke);
            }
        }
        // What the plan selects lies over what it does not.
        for is_selected in [false, true] {
            list.begin(Group { layer: layer::ARCS, is_dense: true, ..Group::default() });
            for arc in &self.drawing.arcs {
                let standing = style::arc_standing(self.plan, arc.id);
                if (standing == Standing::Selected) == is_selected && self.parts.shows(standing) {
                    self.arc(arc, standing, list);
                }
            }
        }
    }

    fn arc(&self, arc: &ArcShape, standing: Standing, list: &mut DisplayList) {
        let stroke = style::arc_stroke(arc.kind, arc.route, arc.is_contingent, standing);
        // Pieces of a path have no heads: they are too short.
        let end = if arc.kind == ArcKind::Path { PathEnd::Open } else { PathEnd::Head };
        let is_connection = matches!(
            arc.kind,
            ArcKind::Glue | ArcKind::Fork | ArcKind::Join | ArcKind::Choice | ArcKind::Merge
        );
        let detail = if is_connection { Detail::from(OVERVIEW_ZOOM) } else { Detail::ALWAYS };
        list.path(arc.start, self.drawing.pieces(arc), end, stroke)
            .at(detail)
            .stands_for(TargetKind::Arc, arc.id.0);
    }

    fn node(&self, node: &NodeShape, list: &mut DisplayList) {
        let standing = self.standing(node.id);
        if !self.parts.shows(standing) {
            return;
        }
        let stroke = style::node_stroke(node.role, node.radius, standing);
        let fill = style::node_fill(node.role, node.radius, standing);
        list.circle(node.center, node.radius, Some(fill.into()), Some(stroke))
            .stands_for(TargetKind::Node, node.id.0);
        if node.role == Role::Decision {
            let (radius, stroke) = (node.radius - DECISION_INSET, Stroke { width: 1.0, ..stroke });
            let fill = Some(ColorRole::NodeFill.into());
            list.circle(node.center, radius, fill, Some(stroke)).at(Detail::from(INSET_ZOOM));
        }
    }

    fn text(&self, text: &TextShape, is_crossed: bool, list: &mut DisplayList) {
        let standing = self.standing_of(text.owner);
        if !self.parts.shows_text(text.role) || !self.parts.shows(standing) {
            return;
        }
        let is_name = text.role == TextRole::Name && text.slide.is_none();
        let detail = Detail::from(if is_name { self.zoom(CROWDED_ZOOM) } else { readable_from(text) });
        let (kind, id) = match text.owner {
            Item::Node(node) => (TargetKind::Node, node.0),
            Item::Label(label) => (TargetKind::Label, label.0),
            Item::Arc(arc) => (TargetKind::Arc, arc.0),
            Item::Block(block) => (TargetKind::Block, block.0),
        };
        let plate = (is_crossed && text.role != TextRole::Node).then(|| ColorRole::Surface.into());
        list.write(Text { plate, ..self.text_of(text, standing) }).at(detail).stands_for(kind, id);
    }

    fn text_of(&self, text: &TextShape, standing: Standing) -> Text {
        let room = || match text.owner {
            Item::Arc(arc) => self.drawing.arc(arc).map(|arc| arc.bounds.width()),
            _ => None,
        };
        let is_number = matches!(
            text.role,
            TextRole::Node | TextRole::Bounds | TextRole::Nature | TextRole::ZeroBounds | TextRole::Window
        );
        let fit = if is_number { Fit::Unabridged } else { Fit::Shrink };
        Text {
            fit,
            legible: (text.role == TextRole::Name).then(|| room().unwrap_or_else(|| text.rect.width())),
            slide: text.slide.map(crate::drawing::Slide::along_row),
            ..Text::new(text.text.clone(), text.size, text.rect)
                .colored(style::text_color(text.role, standing))
        }
    }
}
