//! The bounds of the selected bar as a ruler over it: dragging an end writes the number into the text.

use std::ops::Range;

use egui::{CursorIcon, Rect, Sense, Shape, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};
use exact::Time;
use layout::timeline::Bar;
use rmpl::{Edit, Span};
use text_editing::EditKind;
use workbench::command::{Command, CommandSender};
use workbench::state::playback::{bound, number};

use super::handle::round_time;
use super::paint::{Painting, note};

/// A bound that is being dragged.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BoundDrag {
    /// Known to the history, so that the whole drag is undone at once.
    number: u64,
    /// Where the number is written.
    place: Range<usize>,
    /// What is written there.
    text: String,
    is_upper: bool,
    /// The time that durations are drawn from, in mission units.
    from: f64,
    /// The other bound, which this one does not pass.
    other: f64,
}

/// Numbers of drags on the timeline start here, apart from those of other panels.
const FIRST_NUMBER: u64 = 1 << 32;
/// Half the side of a handle.
const HALF: f32 = 4.0;

/// Shows the bounds of `bar` and drags them. `count` counts the drags.
pub(super) fn show(
    ui: &Ui,
    painting: &Painting<'_>,
    (row_index, bar): (usize, &Bar),
    drag: &mut Option<BoundDrag>,
    count: &mut u64,
    commands: &mut CommandSender,
) {
    let context = painting.context;
    let occurrence = bar.occurrence.and_then(|id| painting.network.occurrences.get(id.index()));
    let Some((occurrence, arc)) = occurrence.and_then(|it| Some((it, it.arc?))) else { return };
    let arc = &painting.network.arcs[arc.index()];
    let written = arc.span.filter(|_| !context.is_stale || drag.is_some());
    let from = drag.as_ref().map_or(bar.start[0], |drag| drag.from);
    let values = [number(arc.lower), bound(arc.upper)];
    let row = painting.row(row_index);
    let y = row.top() + 1.0;
    let tokens = context.tokens;
    let painter = painting.on_track(ui);
    let [start, lower, upper] = [from, from + values[0], from + values[1]].map(|time| painting.x(time));
    let line = Stroke::new(1.5, tokens.text_muted);
    painter.hline(start..=lower, y, line);
    painter.extend(Shape::dashed_line(
        &[pos2(lower, y), pos2(upper.min(painting.visible.right()), y)],
        line,
        3.0,
        3.0,
    ));
    painter.vline(start, y - 3.0..=y + 3.0, line);
    for (is_upper, x) in [(false, lower), (true, upper)] {
        let value = if is_upper { arc.upper.finite() } else { Some(arc.lower) };
        let number_at = |span: Span| {
            let place = literal(context.state.document.text(), span, is_upper)?;
            // Bounds that are computed, or come from somewhere else, are not this number.
            (Some(place.1) == value).then_some(place.0)
        };
        let is_dragged = drag.as_ref().is_some_and(|drag| drag.is_upper == is_upper);
        let place = written.and_then(number_at);
        if place.is_none() && !is_dragged || value.is_none() {
            continue;
        }
        // Bounds that are equal have their handles side by side.
        let x = if values[0] == values[1] { x + if is_upper { HALF } else { -HALF } } else { x };
        let area = Rect::from_center_size(pos2(x, y), vec2(2.5 * HALF, 2.5 * HALF));
        let id = ui.scope_id().with(("bound", is_upper));
        let response = ui.interact(area.intersect(painting.visible), id, Sense::click_and_drag());
        response.widget_info(|| {
            let side = if is_upper { "maximum" } else { "minimum" };
            let label =
                format!("Change the {side} duration of {}", painting.network.readable(&occurrence.name));
            WidgetInfo::slider(true, value.map_or(0.0, number), label)
        });
        if response.drag_started()
            && let Some(place) = place
        {
            *count += 1;
            let text = context.state.document.text().get(place.clone()).unwrap_or_default().to_owned();
            let other = values[usize::from(!is_upper)];
            *drag = Some(BoundDrag { number: FIRST_NUMBER + *count, place, text, is_upper, from, other });
        }
        if let Some(drag) = drag.as_mut().filter(|_| is_dragged && response.dragged())
            && let Some(pointer) = response.interact_pointer_pos()
        {
            drag.follow(painting, pointer.x, commands);
            let text = format!("{} {}", if is_upper { "maximum" } else { "minimum" }, drag.text);
            note(&painter, context, pos2(x + 8.0, y - 24.0), &text, tokens.text_muted);
        }
        if is_dragged && response.drag_stopped() {
            *drag = None;
        }
        let is_strong = response.hovered() || is_dragged || response.has_focus();
        let fill = if is_strong { tokens.accent } else { tokens.surface };
        let square = Rect::from_center_size(pos2(x, y), vec2(2.0 * HALF - 1.0, 2.0 * HALF - 1.0));
        painter.rect(square, 1.0, fill, Stroke::new(1.5, tokens.text_muted), StrokeKind::Middle);
        let side = if is_upper { "Maximum" } else { "Minimum" };
        let text = value.map(workbench::time_text::time).unwrap_or_default();
        response
            .on_hover_cursor(CursorIcon::ResizeHorizontal)
            .on_hover_text_at_pointer(format!("{side} duration {text}. Drag to change the text."));
    }
}

impl BoundDrag {
    /// Writes the duration under the pointer into the text.
    fn follow(&mut self, painting: &Painting<'_>, x: f32, commands: &mut CommandSender) {
        let wanted = painting.view.time(painting.track, x) - self.from;
        let wanted = if self.is_upper { wanted.max(self.other) } else { wanted.min(self.other) };
        let value = round_time(painting.view, wanted.max(0.0));
        let Some(text) = value.decimal().filter(|text| *text != self.text) else { return };
        let source = painting.context.state.document.text();
        if source.get(self.place.clone()) != Some(self.text.as_str()) {
            return;
        }
        let span = Span::new(self.place.start as u32, self.place.end as u32);
        let edits = vec![Edit { span, text: text.clone() }];
        commands.send(Command::Edit { edits, kind: EditKind::Drag(self.number) });
        self.place.end = self.place.start + text.len();
        self.text = text;
    }
}

/// Returns where one side of `[lower, upper]` at `span` is written, and its value, if it is a plain number.
fn literal(source: &str, span: Span, is_upper: bool) -> Option<(Range<usize>, Time)> {
    let text = source.get(span.range())?;
    let inside = text.strip_prefix('[')?.strip_suffix(']')?;
    let comma = inside.find(',')?;
    let (side, offset) = if is_upper { (&inside[comma + 1..], comma + 1) } else { (&inside[..comma], 0) };
    let digits = side.trim();
    let start = span.start as usize + 1 + offset + (side.len() - side.trim_start().len());
    Some((start..start + digits.len(), plain_number(digits)?))
}

fn plain_number(text: &str) -> Option<Time> {
    let is_plain = text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    text.parse().ok().filter(|_| is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_plain_numbers_can_be_dragged() {
        let source = "Drive()[ 4.5 , 20];";
        let span = Span::new(7, 18);
        assert_eq!(literal(source, span, false), Some((9..12, Time::new(9, 2).unwrap())));
        assert_eq!(literal(source, span, true), Some((15..17, Time::from(20))));
        assert_eq!(literal("[l*50%,inf]", Span::new(0, 11), false), None);
        assert_eq!(literal("[l*50%,inf]", Span::new(0, 11), true), None);
        assert_eq!(literal("Drive()", Span::new(0, 7), false), None);
    }
}
