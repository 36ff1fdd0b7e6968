//! All rows of a long timeline at a glance, in a column beside it: where in time each part of the rows lies, and which
//! part is in view. Pressing or dragging in it goes there.

use egui::{Mesh, Rect, Sense, Shape, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2};
use layout::timeline::{BarKind, Chart};

use super::view::TimeView;
use crate::Context;

/// The width of the column, in points.
const WIDTH: f32 = 84.0;
/// A chart that is this many times as high as the room for it has the column beside it.
const MIN_PAGES: f32 = 4.0;
/// Narrower timelines need all their width for themselves.
const MIN_ROOM: f32 = 420.0;
/// Pieces into which the rows are put together, from top to bottom.
const PIECES: usize = 240;
/// Parts of time that are told apart: the bits of a number.
const PARTS: f64 = 64.0;

/// What a chart looks like from afar.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Silhouette {
    /// For each piece, the parts of time in which there is an activity, and those in which there is a condition.
    pieces: Vec<[u64; 2]>,
}

impl Silhouette {
    /// That of `chart`, without what pinned events change.
    pub(super) fn new(chart: &Chart) -> Self {
        let count = PIECES.min(chart.rows.len());
        let mut pieces = vec![[0; 2]; count];
        for (index, row) in chart.rows.iter().enumerate() {
            let piece = &mut pieces[index * count / chart.rows.len()];
            for bar in &chart.bars[row.bars.clone()] {
                let kind = match bar.kind {
                    BarKind::Activity | BarKind::Past | BarKind::Aborted => 0,
                    BarKind::Tell | BarKind::Ask | BarKind::Changing | BarKind::Need => 1,
                    // A value lasts nearly everywhere, which says nothing from afar.
                    BarKind::Composite | BarKind::Delay | BarKind::Value => continue,
                };
                piece[kind] |= parts(bar.free[0][0] / chart.horizon, bar.free[1][0] / chart.horizon);
            }
        }
        Self { pieces }
    }
}

/// The parts of time between two fractions of all of it.
fn parts(from: f64, to: f64) -> u64 {
    let part = |fraction: f64| (fraction * PARTS).clamp(0.0, PARTS - 1.0) as u32;
    let (from, to) = (part(from), part(to).max(part(from)));
    (u64::MAX >> (63 - (to - from))) << from
}

/// Returns where the column is in a timeline with rows of this height in all, if it has one.
pub(super) fn place(timeline: Rect, top: f32, height: f32) -> Option<Rect> {
    let is_long = height > MIN_PAGES * (timeline.bottom() - top);
    (is_long && timeline.width() >= MIN_ROOM).then(|| {
        Rect::from_min_max(pos2(timeline.right() - WIDTH, top), timeline.max).shrink2(vec2(4.0, 2.0))
    })
}

/// Answers how far down the part of the rows to be seen begins, from 0 to 1, if that is chosen here.
pub(super) fn follow(ui: &Ui, place: Rect, seen: f32) -> Option<f32> {
    let response = ui.interact(place, ui.scope_id().with("overview"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Slider, true, "Overview of the timeline"));
    let pointer = response.interact_pointer_pos().filter(|_| crate::is_pressed(&response))?;
    Some(((pointer.y - place.top()) / place.height() - seen / 2.0).clamp(0.0, 1.0 - seen.min(1.0)))
}

/// Paints the column; `from` and `seen` are where the rows in view begin and how many they are, as parts of all.
pub(super) fn paint(
    ui: &Ui,
    context: &Context<'_>,
    place: Rect,
    silhouette: &Silhouette,
    (from, seen): (f32, f32),
    (view, axis, horizon): (&TimeView, Rect, f64),
) {
    let tokens = context.tokens;
    let painter = ui.painter_at(place);
    painter.rect_filled(place, 3.0, tokens.sunken);
    let mut mesh = Mesh::default();
    let cell = vec2(place.width() / PARTS as f32, place.height() / silhouette.pieces.len().max(1) as f32);
    for (index, piece) in silhouette.pieces.iter().enumerate() {
        let top = place.top() + index as f32 * cell.y;
        for (mut left, color) in [(piece[1], tokens.tell), (piece[0], tokens.slack)] {
            while left != 0 {
                let first = left.trailing_zeros();
                let length = (left >> first).trailing_ones();
                let x = place.left() + first as f32 * cell.x;
                let size = vec2(length as f32 * cell.x, cell.y.max(1.0));
                mesh.add_colored_rect(Rect::from_min_size(pos2(x, top), size), tokens.mixed(color, 0.75));
                left &= !((u64::MAX >> (64 - length)) << first);
            }
        }
    }
    painter.add(Shape::mesh(mesh));
    let x = |at: f32| {
        let fraction = (view.time(axis, at) / horizon).clamp(0.0, 1.0) as f32;
        place.left() + fraction * place.width()
    };
    let top = place.top() + from * place.height();
    let in_view = Rect::from_min_max(
        pos2(x(axis.left()), top),
        pos2(x(axis.right()), (top + seen * place.height()).max(top + 3.0)),
    );
    painter.rect(
        in_view.intersect(place),
        1.0,
        tokens.accent.gamma_multiply(0.12),
        Stroke::new(1.0, tokens.accent),
        StrokeKind::Inside,
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_covers_its_parts_of_time_and_an_instant_one() {
        assert_eq!(parts(0.0, 1.0), u64::MAX);
        assert_eq!(parts(0.0, 0.0), 1);
        assert_eq!(parts(1.0, 1.0), 1 << 63);
        assert_eq!(parts(0.5, f64::INFINITY), u64::MAX << 32);
        assert_eq!(parts(2.0 / 64.0, 3.0 / 64.0), 0b1100);
    }

    #[test]
    fn only_long_timelines_with_room_have_the_column() {
        let timeline = Rect::from_min_size(pos2(0.0, 0.0), vec2(800.0, 200.0));
        assert!(place(timeline, 20.0, 5_000.0).is_some_and(|place| timeline.contains_rect(place)));
        assert_eq!(place(timeline, 20.0, 600.0), None);
        assert_eq!(place(timeline.with_max_x(300.0), 20.0, 5_000.0), None);
    }
}
