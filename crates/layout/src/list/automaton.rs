//! An automaton as a display list: nested composites, locations with their marking, transitions with their guards.
//!
//! What is marked has a dot and a heavier border besides its color. Non-entailment is a bar over what is not entailed.

use display::{
    Anchor, ColorRole, Dash, DisplayList, Fit, Group, PathEnd, Piece, Point, Rect, Stroke, TargetKind, Text,
    approximate_text_width, text_width_at,
};
use hca::{Automaton, CompositeId, CompositeKind, LocationKind, Marking, TransitionId};

use crate::automaton::{
    AutomatonDrawing, AutomatonItem, AutomatonText, CompositeShape, LocationShape, NOTE_SIZE, PREEMPTED,
    TransitionShape,
};
use crate::metrics::TextRole;

/// How things stand with an automaton.
#[derive(Clone, Copy, Debug, Default)]
pub struct AutomatonState<'a> {
    /// What is marked; `None` before anything runs.
    pub marking: Option<&'a Marking>,
    /// The transitions that fired in the last step.
    pub fired: &'a [TransitionId],
    /// The composites that were preempted in it.
    pub preempted: &'a [CompositeId],
    pub selected: &'a [AutomatonItem],
}

/// Radius of the corners of composites and of locations that do not wait.
const CORNERS: (f64, f64) = (7.0, 5.0);
/// How far inside its border a start location has another one.
const INSET: f64 = 3.0;
/// Size of the name on a location's border, and of its dot.
const TAG: (f64, f64) = (11.5, 5.0);
/// From the right end of a composite's lower border to the note on it.
const NOTE_INSET: f64 = 10.0;

/// The display list of an automaton. Linear in the drawing.
pub fn automaton_list(
    drawing: &AutomatonDrawing,
    automaton: &Automaton,
    state: &AutomatonState<'_>,
) -> DisplayList {
    let mut list = DisplayList::new(drawing.bounds);
    let builder = Builder { automaton, state };
    list.begin(Group::default());
    for shape in &drawing.composites {
        builder.composite(shape, &mut list);
    }
    let stroke = Stroke::solid(ColorRole::TextMuted, 1.3).dashed(Dash::Dashed);
    for &(from, to) in &drawing.successions {
        list.path(from, &[Piece::Line(to)], PathEnd::Head, stroke);
    }
    for shape in &drawing.transitions {
        builder.transition(shape, &mut list);
    }
    for shape in &drawing.locations {
        builder.location(shape, &mut list);
    }
    for text in &drawing.texts {
        builder.text(text, &mut list);
    }
    list
}

struct Builder<'a> {
    automaton: &'a Automaton,
    state: &'a AutomatonState<'a>,
}

impl Builder<'_> {
    fn is_selected(&self, item: AutomatonItem) -> bool {
        self.state.selected.contains(&item)
    }

    fn composite(&self, shape: &CompositeShape, list: &mut DisplayList) {
        let is_active = self.state.marking.is_some_and(|it| self.automaton.is_active(shape.id, it));
        // Faint, so that what is written inside stays legible.
        let selected = self.is_selected(AutomatonItem::Composite(shape.id));
        let fill = match (selected, shape.is_watching) {
            (true, _) => Some(ColorRole::Selection.mixed(0.5).into()),
            (false, true) => Some(ColorRole::Raised.into()),
            (false, false) => None,
        };
        let role = match (shape.is_watching, is_active || self.state.marking.is_none()) {
            (true, true) => ColorRole::Decision,
            (false, true) if is_active => ColorRole::TextMuted,
            _ => ColorRole::LineStrong,
        };
        let is_solid = shape.is_watching || shape.kind == CompositeKind::Program;
        let dash = if is_solid { Dash::Solid } else { Dash::Dashed };
        let stroke = Stroke::solid(role, if is_active { 1.8 } else { 1.0 }).dashed(dash);
        list.rectangle(shape.rect, CORNERS.0, fill, Some(stroke))
            .stands_for(TargetKind::Composite, shape.id.0);
        if self.state.preempted.contains(&shape.id) {
            let stroke = Stroke::solid(ColorRole::Threat, 1.5);
            list.rectangle(shape.rect.expanded(2.5), CORNERS.0 + 1.0, None, Some(stroke));
            // On the lower border: at the upper one stands the title.
            let width = text_width_at(PREEMPTED, NOTE_SIZE, &approximate_text_width).ceil();
            let (right, half) = (shape.rect.max.x - NOTE_INSET, NOTE_SIZE / 2.0);
            let border = shape.rect.max.y;
            let rect = Rect::new(right - width, border - half, right, border + half);
            let text = Text::new(PREEMPTED, NOTE_SIZE, rect).colored(ColorRole::Threat);
            let text = text.anchored(Anchor::End, Fit::Overflow);
            list.write(Text { plate: Some(ColorRole::Surface.into()), ..text });
        }
    }

    fn transition(&self, shape: &TransitionShape, list: &mut DisplayList) {
        let has_fired = self.state.fired.contains(&shape.id);
        let (role, width) = match (has_fired, self.state.marking) {
            (true, _) => (ColorRole::Accent, 2.6),
            (false, None) => (ColorRole::Path, 1.3),
            (false, Some(_)) => (ColorRole::PathUnselected, 1.3),
        };
        if self.is_selected(AutomatonItem::Transition(shape.id)) {
            list.path(shape.start, &shape.pieces, PathEnd::Open, Stroke::solid(ColorRole::Selection, 9.0));
        }
        list.path(shape.start, &shape.pieces, PathEnd::Head, Stroke::solid(role, width))
            .stands_for(TargetKind::Transition, shape.id.0);
    }

    fn location(&self, shape: &LocationShape, list: &mut DisplayList) {
        let is_marked = self.state.marking.is_some_and(|marking| marking.contains(shape.id));
        let corner = if shape.kind == LocationKind::Assert { CORNERS.1 } else { shape.rect.height() / 2.0 };
        let (role, fill, width) = match (is_marked, self.state.marking) {
            (true, _) => (ColorRole::Tell, ColorRole::GoodSoft, 2.6),
            (false, None) => (ColorRole::Path, ColorRole::NodeFill, 1.3),
            (false, Some(_)) => (ColorRole::PathUnselected, ColorRole::NodeFill, 1.3),
        };
        if self.is_selected(AutomatonItem::Location(shape.id)) {
            let fill = Some(ColorRole::Selection.into());
            list.rectangle(shape.rect.expanded(4.0), corner + 4.0, fill, None);
        }
        list.rectangle(shape.rect, corner, Some(fill.into()), Some(Stroke::solid(role, width)))
            .stands_for(TargetKind::Location, shape.id.0);
        if shape.is_start {
            let (inner, stroke) = (shape.rect.expanded(-INSET), Stroke::solid(role, 0.8));
            list.rectangle(inner, (corner - INSET).max(1.0), None, Some(stroke));
        }
        self.tag(shape, list);
        if is_marked {
            let center = shape.rect.min.shifted(TAG.1, 0.0);
            let stroke = Stroke::solid(ColorRole::Surface, 1.5);
            list.circle(center, TAG.1, Some(ColorRole::Tell.into()), Some(stroke));
        }
    }

    /// The name of a location on its border, so that it cannot be taken for the name of what lies below.
    fn tag(&self, shape: &LocationShape, list: &mut DisplayList) {
        let name = self.automaton.location_name(shape.id);
        let size = TAG.0;
        let width = text_width_at(&name, size, &approximate_text_width).ceil();
        let right = shape.rect.max.x - 8.0;
        let half = size / 2.0;
        let rect = Rect::new(right - width, shape.rect.max.y - half, right, shape.rect.max.y + half);
        // Never cut: its width is an estimate, and letters can be a little wider.
        let text = Text::new(name, size, rect).anchored(Anchor::End, Fit::Overflow);
        let text = text.colored(ColorRole::TextMuted);
        list.write(Text { plate: Some(ColorRole::Surface.into()), ..text })
            .stands_for(TargetKind::Location, shape.id.0);
    }

    /// Writes a text into its place; what follows `~` gets a bar over it instead, of several lines one over all.
    fn text(&self, text: &AutomatonText, list: &mut DisplayList) {
        let role = match (text.role, text.owner) {
            (TextRole::Name, _) => ColorRole::Text,
            (_, AutomatonItem::Composite(_)) => ColorRole::Decision,
            (_, AutomatonItem::Transition(id)) if self.state.fired.contains(&id) => ColorRole::Accent,
            _ => ColorRole::TextMuted,
        };
        let (kind, id) = match text.owner {
            AutomatonItem::Location(id) => (TargetKind::Location, id.0),
            AutomatonItem::Transition(id) => (TargetKind::Transition, id.0),
            AutomatonItem::Composite(id) => (TargetKind::Composite, id.0),
        };
        let anchor =
            if matches!(text.owner, AutomatonItem::Composite(_)) { Anchor::Start } else { Anchor::Middle };
        let is_plated = matches!(text.owner, AutomatonItem::Transition(_)) && self.is_selected(text.owner);
        let height = text.rect.height() / text.lines.len().max(1) as f64;
        let is_block = text.lines.len() > 1;
        for (at, line) in text.lines.iter().enumerate() {
            let top = text.rect.min.y + at as f64 * height;
            let rect = Rect::new(text.rect.min.x, top, text.rect.max.x, top + height);
            let begins = line.find('~');
            let words =
                begins.map_or_else(|| line.clone(), |at| [&line[..at], &line[at + 1..]].concat().into());
            if let Some(begins) = begins.filter(|_| is_block) {
                let lead = text_width_at(&line[..begins], text.role.size(), &approximate_text_width);
                let ends = [rect.min.x + lead, rect.max.x].map(|x| Point::new(x, rect.min.y));
                list.line(ends[0], ends[1], Stroke::solid(role, 1.2)).stands_for(kind, id);
            }
            let shown = Text {
                overbar: begins.filter(|_| !is_block).map(|at| at as u32),
                plate: is_plated.then_some(ColorRole::Selection.into()),
                ..Text::new(words, text.role.size(), rect).colored(role).anchored(anchor, Fit::Shrink)
            };
            list.write(shown).stands_for(kind, id);
        }
    }
}
