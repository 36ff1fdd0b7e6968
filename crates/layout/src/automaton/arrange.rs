//! Sizes from the inside out, then places from the outside in; composites are numbered parents first, so both are one
//! loop.

use hca::{Automaton, Composite, CompositeId, CompositeKind, Element, LocationId, TransitionId};
use smol_str::{SmolStr, format_smolstr};

use super::{
    AutomatonDrawing, AutomatonItem, AutomatonText, CompositeShape, LocationShape, NOTE_SIZE, PREEMPTED,
    TransitionShape,
};
use crate::layered::level_curve;
use crate::metrics::{GUTTER, TEXT_LIFT, TEXT_PAD, TextRole};
use crate::text::{cut_to_width, text_width};
use display::list::ARROW_LENGTH;
use display::{Measure, Piece, Point, Rect, approximate_text_width, text_width_at};

/// Inside the box of a composite.
const PADDING: f64 = 9.0;
/// Below the padding of a composite that can be preempted: half of the note on its border, whose other half is outside.
const NOTE_ROOM: f64 = 4.0;
/// Between children.
const GAP: f64 = 11.0;
/// Between the children of a sequence, where an arrow goes.
const STEP: f64 = 32.0;
/// A sequence that is wider runs from top to bottom.
const EASY_ROW: f64 = 480.0;
/// Of a location with one line of text.
const LOCATION_HEIGHT: f64 = 30.0;
/// How high a transition from a location to itself rises.
const LOOP_HEIGHT: f64 = 18.0;
/// A condition that is wider is broken before its connectives.
const EASY_LINE: f64 = 132.0;
/// A line that cannot be broken is cut at this width.
const LONGEST_LINE: f64 = 300.0;
/// Around the whole drawing.
const MARGIN: f64 = 6.0;

#[derive(Clone, Copy, Debug, Default)]
struct Size {
    width: f64,
    height: f64,
    /// How far below its top an element is entered and left.
    axis: f64,
}

struct Text {
    lines: Vec<SmolStr>,
    role: TextRole,
    width: f64,
}

impl Text {
    /// A text in lines no wider than `easy`, where connectives allow it.
    fn wrapped(text: &str, role: TextRole, easy: f64, measure: &dyn Measure) -> Self {
        let width_of = |line: &str| text_width(line, role, measure);
        let mut lines: Vec<String> = Vec::new();
        for part in parts_of(text) {
            match lines.last_mut() {
                Some(line) if width_of(&format!("{line} {part}")) <= easy => {
                    line.push(' ');
                    line.push_str(part);
                }
                _ => lines.push(part.to_owned()),
            }
        }
        let lines: Vec<SmolStr> =
            lines.iter().map(|line| cut_to_width(line, role, LONGEST_LINE, measure)).collect();
        let width = lines.iter().map(|line| width_of(line)).fold(0.0, f64::max);
        Self { lines, role, width }
    }

    fn height(&self) -> f64 {
        self.lines.len() as f64 * self.role.line_height()
    }

    /// The text with its middle at `middle` and its upper border at `top`.
    fn drawn(&self, middle: f64, top: f64, owner: AutomatonItem) -> AutomatonText {
        let left = (middle - self.width / 2.0).floor();
        let rect = Rect::new(left, top, left + self.width, top + self.height());
        AutomatonText { lines: self.lines.clone(), role: self.role, rect, owner }
    }
}

/// The parts of a condition that stay together: each but the first begins with its connective.
fn parts_of(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let whole = rest?;
        let mut spaces = whole.match_indices(' ').map(|(at, _)| at);
        let begins = |at: &usize| ["AND ", "OR "].iter().any(|word| whole[at + 1..].starts_with(word));
        // No further than to the next connective, so that all parts together take one pass.
        let next = spaces.find(begins);
        let (part, after) = next.map_or((whole, None), |at| (&whole[..at], Some(&whole[at + 1..])));
        rest = after;
        Some(part)
    })
}

struct Arranger<'a> {
    automaton: &'a Automaton,
    measure: &'a dyn Measure,
    /// What each location says, and each transition, and each composite.
    location_texts: Vec<Text>,
    transition_texts: Vec<Text>,
    titles: Vec<Option<Text>>,
    sizes: Vec<Size>,
    composite_rects: Vec<Rect>,
    location_rects: Vec<Rect>,
    drawing: AutomatonDrawing,
}

pub(super) fn arrange(automaton: &Automaton, measure: &dyn Measure) -> AutomatonDrawing {
    let text = |text: &str, role: TextRole| Text::wrapped(text, role, EASY_LINE, measure);
    let locations = automaton.locations.iter().map(|location| text(&location.label, TextRole::Name));
    let transitions = automaton.transitions.iter().map(|transition| {
        let condition = automaton.condition_text(transition);
        let condition = if condition == "true" && transition.guard.is_none() { "always" } else { &condition };
        text(condition, TextRole::Bounds)
    });
    let mut arranger = Arranger {
        automaton,
        measure,
        location_texts: locations.collect(),
        transition_texts: transitions.collect(),
        titles: automaton.composites.iter().map(|_| None).collect(),
        sizes: vec![Size::default(); automaton.composites.len()],
        composite_rects: vec![Rect::default(); automaton.composites.len()],
        location_rects: vec![Rect::default(); automaton.locations.len()],
        drawing: AutomatonDrawing::default(),
    };
    for at in (0..automaton.composites.len()).rev() {
        arranger.measure(CompositeId(at as u32));
    }
    arranger.place_all();
    arranger.finish()
}

/// How a composite's children are put beside each other.
enum Shape<'a> {
    Row(&'a [Element]),
    /// A sequence that would be too wide as a row.
    Column(&'a [Element]),
    Stack(&'a [Element]),
    /// A location and what it starts.
    Fork(LocationId, &'a [Element]),
}

impl<'a> Arranger<'a> {
    fn composite(&self, id: CompositeId) -> &'a Composite {
        &self.automaton.composites[id.0 as usize]
    }

    fn shape(&self, id: CompositeId) -> Shape<'a> {
        let composite = self.composite(id);
        match (composite.kind, composite.children.as_slice()) {
            (CompositeKind::Guarded, [Element::Location(first), rest @ ..]) => Shape::Fork(*first, rest),
            (CompositeKind::Sequence, children) => {
                let width = row(children.iter().map(|&child| self.element_size(child))).width;
                if width > EASY_ROW { Shape::Column(children) } else { Shape::Row(children) }
            }
            (_, children) => Shape::Stack(children),
        }
    }

    /// Returns what surrounds a composite's children: left and right, above, below.
    fn frame(&self, id: CompositeId) -> (f64, f64, f64) {
        let composite = self.composite(id);
        let is_box = self.titles[id.0 as usize].is_some() || composite.kind == CompositeKind::Program;
        let title = self.titles[id.0 as usize].as_ref().map_or(0.0, Text::height);
        let note = if composite.maintenance.is_some() { NOTE_ROOM } else { 0.0 };
        if is_box { (PADDING, PADDING + title, PADDING + note) } else { (0.0, 0.0, 0.0) }
    }

    fn element_size(&self, element: Element) -> Size {
        match element {
            Element::Composite(id) => self.sizes[id.0 as usize],
            Element::Location(id) => {
                let text = &self.location_texts[id.0 as usize];
                let height = LOCATION_HEIGHT + text.height() - text.role.line_height();
                Size { width: text.width + 4.0 * TEXT_PAD, height, axis: height / 2.0 }
            }
        }
    }

    /// Returns what a location starts, with room above the arrow to it for the guard that is there.
    fn started_size(&self, location: LocationId, element: Element) -> Size {
        let size = self.element_size(element);
        let guards = self.transitions_of(location).filter(|(_, target)| *target == element);
        let heights = guards.map(|(id, _)| self.transition_texts[id.0 as usize].height() + TEXT_LIFT);
        let above = (heights.fold(0.0, f64::max) - size.axis).max(0.0).ceil();
        Size { height: size.height + above, axis: size.axis + above, ..size }
    }

    fn started_sizes(&self, location: LocationId, elements: &[Element]) -> impl Iterator<Item = Size> {
        elements.iter().map(move |&element| self.started_size(location, element))
    }

    /// Returns what a composite maintains, or how it runs what is in it.
    fn title(&self, id: CompositeId, room: f64) -> Option<Text> {
        let composite = self.composite(id);
        let guard = composite.maintenance.and_then(|test| self.automaton.guard(test));
        let text = match (guard, composite.kind) {
            (Some(guard), _) => format_smolstr!("maintain {guard}"),
            (None, CompositeKind::Sequence) => SmolStr::new_static("sequence"),
            (None, CompositeKind::Parallel) => SmolStr::new_static("parallel"),
            (None, _) => self.automaton.title(id)?,
        };
        Some(Text::wrapped(&text, TextRole::Muted, room.max(EASY_LINE), self.measure))
    }

    /// The size of a composite and its title, which takes the width that is there.
    fn measure(&mut self, id: CompositeId) {
        let inner = match self.shape(id) {
            Shape::Row(children) => row(children.iter().map(|&child| self.element_size(child))),
            Shape::Column(children) => column(children.iter().map(|&child| self.element_size(child))),
            Shape::Stack(children) => stack(children.iter().map(|&child| self.element_size(child))),
            Shape::Fork(location, children) => {
                let source = self.element_size(Element::Location(location));
                let bodies = stack(self.started_sizes(location, children));
                let loop_height = self.loop_height(location);
                let room = if children.is_empty() { 0.0 } else { self.guard_room(location) };
                let axis = (source.axis + loop_height).max(bodies.axis);
                let height = axis + source.axis.max(bodies.height - bodies.axis);
                Size {
                    width: source.width.max(self.loop_width(location)) + room + bodies.width,
                    height,
                    axis,
                }
            }
        };
        self.titles[id.0 as usize] = self.title(id, inner.width);
        let (side, above, below) = self.frame(id);
        let title = self.titles[id.0 as usize].as_ref().map_or(0.0, |title| title.width);
        let is_watching = self.composite(id).maintenance.is_some();
        let note =
            if is_watching { text_width_at(PREEMPTED, NOTE_SIZE, &approximate_text_width) } else { 0.0 };
        self.sizes[id.0 as usize] = Size {
            width: (inner.width.max(title).max(note) + 2.0 * side).ceil(),
            height: (inner.height + above + below).ceil(),
            axis: (inner.axis + above).floor(),
        };
    }

    fn transitions_of(&self, location: LocationId) -> impl Iterator<Item = (TransitionId, Element)> + 'a {
        let range = self.automaton.locations[location.0 as usize].transitions.clone();
        let automaton = self.automaton;
        range.filter_map(move |at| {
            automaton.transitions.get(at as usize).map(|transition| (TransitionId(at), transition.target))
        })
    }

    /// The transition from a location to itself.
    fn own_loop(&self, location: LocationId) -> Option<TransitionId> {
        let mut all = self.transitions_of(location);
        all.find(|(_, target)| *target == Element::Location(location)).map(|(id, _)| id)
    }

    fn loop_height(&self, location: LocationId) -> f64 {
        self.own_loop(location)
            .map_or(0.0, |id| LOOP_HEIGHT + TEXT_LIFT + self.transition_texts[id.0 as usize].height())
    }

    fn loop_width(&self, location: LocationId) -> f64 {
        self.own_loop(location).map_or(0.0, |id| self.transition_texts[id.0 as usize].width)
    }

    /// The space between a location and what it starts: to spread, and for the longest guard.
    fn guard_room(&self, location: LocationId) -> f64 {
        let others =
            self.transitions_of(location).filter(|(_, target)| *target != Element::Location(location));
        let widths = others.map(|(id, _)| self.transition_texts[id.0 as usize].width);
        GUTTER.0 + widths.fold(0.0, f64::max) + 2.0 * TEXT_PAD + ARROW_LENGTH
    }

    fn place_all(&mut self) {
        let whole = self.sizes.first().copied().unwrap_or_default();
        if let Some(rect) = self.composite_rects.first_mut() {
            *rect = Rect::new(0.0, 0.0, whole.width, whole.height);
        }
        for at in 0..self.automaton.composites.len() {
            let id = CompositeId(at as u32);
            let rect = self.composite_rects[at];
            let (side, above, below) = self.frame(id);
            let inner =
                Rect::new(rect.min.x + side, rect.min.y + above, rect.max.x - side, rect.max.y - below);
            self.outline(id, rect, side);
            match self.shape(id) {
                Shape::Row(children) => self.place_row(children, inner, rect.min.y + self.sizes[at].axis),
                Shape::Column(children) => self.place_column(children, inner.min),
                Shape::Stack(children) => {
                    let sizes: Vec<_> = children.iter().map(|&child| self.element_size(child)).collect();
                    self.place_stack(children, &sizes, inner.min);
                }
                Shape::Fork(location, children) => {
                    let size = self.element_size(Element::Location(location));
                    let wide = size.width.max(self.loop_width(location));
                    let left = inner.min.x + ((wide - size.width) / 2.0).floor();
                    let line = rect.min.y + self.sizes[at].axis;
                    self.put(Element::Location(location), Point::new(left, line - size.axis));
                    let room = if children.is_empty() { 0.0 } else { self.guard_room(location) };
                    let sizes: Vec<_> = self.started_sizes(location, children).collect();
                    let top = line - stack(sizes.iter().copied()).axis;
                    self.place_stack(children, &sizes, Point::new(inner.min.x + wide + room, top));
                }
            }
        }
    }

    fn outline(&mut self, id: CompositeId, rect: Rect, side: f64) {
        let composite = self.composite(id);
        if side == 0.0 {
            return;
        }
        let is_watching = composite.maintenance.is_some();
        self.drawing.composites.push(CompositeShape { id, rect, kind: composite.kind, is_watching });
        if let Some(title) = &self.titles[id.0 as usize] {
            let middle = rect.min.x + PADDING + title.width / 2.0;
            let text = title.drawn(middle, rect.min.y + TEXT_PAD, AutomatonItem::Composite(id));
            self.drawing.texts.push(text);
        }
    }

    fn put(&mut self, element: Element, corner: Point) {
        let size = self.element_size(element);
        let rect = Rect { min: corner, max: corner.shifted(size.width, size.height) };
        match element {
            Element::Composite(id) => self.composite_rects[id.0 as usize] = rect,
            Element::Location(id) => self.location_rects[id.0 as usize] = rect,
        }
    }

    fn place_row(&mut self, children: &[Element], inner: Rect, line: f64) {
        let mut left = inner.min.x;
        for (at, &child) in children.iter().enumerate() {
            let size = self.element_size(child);
            if at > 0 {
                self.drawing
                    .successions
                    .push((Point::new(left + 2.0, line), Point::new(left + STEP - 2.0, line)));
                left += STEP;
            }
            self.put(child, Point::new(left, line - size.axis));
            left += size.width;
        }
    }

    fn place_column(&mut self, children: &[Element], corner: Point) {
        let mut top = corner.y;
        let mut above: Option<f64> = None;
        for &child in children {
            let size = self.element_size(child);
            if let Some(above) = above {
                let x = corner.x + (above.min(size.width) / 4.0).floor();
                self.drawing.successions.push((Point::new(x, top + 2.0), Point::new(x, top + STEP - 2.0)));
                top += STEP;
            }
            self.put(child, Point::new(corner.x, top));
            top += size.height;
            above = Some(size.width);
        }
    }

    /// Below each other, each at the bottom of the room that it has.
    fn place_stack(&mut self, children: &[Element], rooms: &[Size], corner: Point) {
        let mut bottom = corner.y;
        for (&child, room) in children.iter().zip(rooms) {
            bottom += room.height;
            self.put(child, Point::new(corner.x, bottom - self.element_size(child).height));
            bottom += GAP;
        }
    }

    /// Returns where an element is entered from the left.
    fn entry(&self, element: Element) -> Point {
        let corner = match element {
            Element::Composite(id) => self.composite_rects[id.0 as usize].min,
            Element::Location(id) => self.location_rects[id.0 as usize].min,
        };
        corner.shifted(0.0, self.element_size(element).axis)
    }

    fn finish(mut self) -> AutomatonDrawing {
        let starts = self.automaton.start();
        for at in 0..self.automaton.locations.len() {
            let id = LocationId(at as u32);
            let (rect, kind) = (self.location_rects[at], self.automaton.locations[at].kind);
            let is_start = starts.contains(id);
            self.drawing.locations.push(LocationShape { id, rect, kind, is_start });
            let (text, middle) = (&self.location_texts[at], rect.center());
            let top = middle.y - text.height() / 2.0;
            self.drawing.texts.push(text.drawn(middle.x, top, AutomatonItem::Location(id)));
            for (transition, target) in self.transitions_of(id) {
                self.transition(transition, id, target);
            }
        }
        self.drawing.transitions.sort_by_key(|transition| transition.id);
        self.drawing.bounds = self.composite_rects.first().copied().unwrap_or_default().expanded(MARGIN);
        self.drawing
    }

    fn transition(&mut self, id: TransitionId, source: LocationId, target: Element) {
        let from = self.location_rects[source.0 as usize];
        let text = &self.transition_texts[id.0 as usize];
        let (start, pieces, text_at) = if target == Element::Location(source) {
            let (left, right) = (Point::new(from.center().x - 14.0, from.min.y), from.center().x + 14.0);
            let start = Point::new(right, from.min.y);
            let top = from.min.y - LOOP_HEIGHT * 4.0 / 3.0;
            let piece = Piece::Cubic(Point::new(right + 10.0, top), Point::new(left.x - 10.0, top), left);
            (start, vec![piece], Point::new(from.center().x, from.min.y - LOOP_HEIGHT - TEXT_LIFT))
        } else {
            let start = Point::new(from.max.x, from.center().y);
            let end = self.entry(target);
            let run = self.guard_room(source) - GUTTER.0;
            let level = Point::new(end.x - run, end.y);
            let middle = f64::midpoint(level.x, end.x - ARROW_LENGTH);
            let text_at = Point::new(middle, end.y - TEXT_LIFT);
            (start, vec![level_curve(start, level), Piece::Line(end)], text_at)
        };
        self.drawing.transitions.push(TransitionShape { id, start, pieces });
        let text = text.drawn(text_at.x, text_at.y - text.height(), AutomatonItem::Transition(id));
        self.drawing.texts.push(text);
    }
}

fn row(sizes: impl Iterator<Item = Size>) -> Size {
    let (mut width, mut above, mut below) = (0.0, 0.0_f64, 0.0_f64);
    for (at, size) in sizes.enumerate() {
        width += size.width + if at > 0 { STEP } else { 0.0 };
        above = above.max(size.axis);
        below = below.max(size.height - size.axis);
    }
    Size { width, height: above + below, axis: above }
}

/// Below each other, one after the other; entered where the first one is.
fn column(sizes: impl Iterator<Item = Size>) -> Size {
    let mut whole = Size::default();
    for (at, size) in sizes.enumerate() {
        whole.height += size.height + if at > 0 { STEP } else { 0.0 };
        whole.width = whole.width.max(size.width);
        whole.axis = if at == 0 { size.axis } else { whole.axis };
    }
    whole
}

/// Below each other; entered in the middle, or as its only member is.
fn stack(sizes: impl Iterator<Item = Size>) -> Size {
    let mut whole = Size::default();
    for (at, size) in sizes.enumerate() {
        whole.height += size.height + if at > 0 { GAP } else { 0.0 };
        whole.width = whole.width.max(size.width);
        whole.axis = if at == 0 { size.axis } else { (whole.height / 2.0).floor() };
    }
    whole
}
