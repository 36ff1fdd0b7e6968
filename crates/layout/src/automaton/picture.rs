//! The drawing of an automaton as a standalone SVG file.

use hca::{CompositeKind, Marking};

use super::arrange::is_waiting;
use super::{AutomatonDrawing, AutomatonItem};
use crate::geometry::Piece;
use crate::look::{Dash, Ink, Stroke, arrow_head};
use crate::metrics::TextRole;
use crate::palette::Palette;
use crate::svg::Canvas;

/// Writes a drawing as an SVG file; the locations of `marking`, if there is one, are filled.
pub fn automaton_svg(
    drawing: &AutomatonDrawing,
    marking: Option<&Marking>,
    palette: &Palette,
    title: &str,
) -> String {
    let mut canvas = Canvas::new(drawing.bounds, palette, title);
    for composite in &drawing.composites {
        let stroke = match (composite.is_watching, composite.kind) {
            (true, _) => Stroke::solid(Ink::Decision, 1.4),
            (false, CompositeKind::Program) => Stroke::solid(Ink::LineStrong, 1.0),
            (false, _) => Stroke { dash: Dash::Dashed, ..Stroke::solid(Ink::LineStrong, 1.0) },
        };
        let fill = if composite.is_watching { Ink::Raised } else { Ink::Sunken };
        canvas.rectangle(composite.rect, 8.0, fill, stroke);
    }
    for &(from, to) in &drawing.successions {
        canvas.curve(
            from,
            &[Piece::Line(to)],
            Stroke { dash: Dash::Dashed, ..Stroke::solid(Ink::TextMuted, 1.4) },
        );
        canvas.polygon(&arrow_head(to, from), Ink::TextMuted);
    }
    for transition in &drawing.transitions {
        canvas.curve(transition.start, &transition.pieces, Stroke::solid(Ink::Path, 1.4));
        if let Some((last, before)) = transition.pieces.split_last() {
            let start = before.last().map_or(transition.start, |piece| piece.end());
            canvas.polygon(&arrow_head(last.end(), last.before_end(start)), Ink::Path);
        }
    }
    for location in &drawing.locations {
        let is_marked = marking.is_some_and(|marking| marking.contains(location.id));
        let width = if is_marked { 2.6 } else { 1.4 };
        let stroke = Stroke::solid(if is_marked { Ink::Tell } else { Ink::Path }, width);
        let corner = if is_waiting(location.kind) { location.rect.height() / 2.0 } else { 6.0 };
        canvas.rectangle(location.rect, corner, Ink::NodeFill, stroke);
        if location.is_start {
            canvas.rectangle(
                location.rect.expanded(-3.0),
                corner - 3.0,
                Ink::NodeFill,
                Stroke::solid(stroke.ink, 0.8),
            );
        }
    }
    for text in &drawing.texts {
        let ink = match (text.role, text.owner) {
            (TextRole::Name, _) => Ink::Text,
            (_, AutomatonItem::Composite(_)) => Ink::Decision,
            _ => Ink::TextMuted,
        };
        canvas.text(&text.text, text.role.size(), text.rect, ink);
    }
    canvas.finish()
}
