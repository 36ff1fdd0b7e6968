//! Where the parts of a timeline are on the screen, and its display lists on it.

use display::DisplayList;
use egui::{Color32, FontId, Painter, Pos2, Rect, Stroke, StrokeKind, Ui, pos2, vec2};
use layout::list::timeline::{Track, axis_list};
use layout::timeline::{Bar, Chart};
use theme::icon::{self, Icon};
use theme::size;
use tpn::Network;

use super::view::TimeView;
use crate::Context;
use crate::painter::{DisplayPainter, Placement};

/// The height of a bar's row.
pub(super) const ROW_HEIGHT: f32 = layout::list::timeline::ROW_HEIGHT as f32;

/// The height of the legend.
pub(super) const LEGEND_HEIGHT: f32 = layout::list::timeline::LEGEND_HEIGHT as f32;

/// What all parts of one frame need.
pub(super) struct Painting<'a> {
    pub(super) context: &'a Context<'a>,
    pub(super) network: &'a Network,
    /// The rows and bars.
    pub(super) chart: &'a Chart,
    /// Where times are.
    pub(super) view: &'a TimeView,
    /// Where the bars are, all rows.
    pub(super) track: Rect,
    /// The part of it that is seen.
    pub(super) visible: Rect,
    /// The same for the display list, whose frame is the screen.
    pub(super) place: Track,
}

/// Returns where times and rows are, for a display list whose frame is the screen.
pub(super) fn place(view: &TimeView, track: Rect, visible: Rect, names_left: f32) -> Track {
    Track {
        frame: drawn(Rect::from_min_max(pos2(names_left, visible.top()), visible.max)),
        left: f64::from(track.left()),
        right: f64::from(track.right()),
        top: f64::from(track.top()),
        start: view.start,
        scale: view.scale,
        visible: drawn(visible),
    }
}

/// Shows a list whose frame is the screen.
pub(super) fn show(ui: &Ui, context: &Context<'_>, list: &DisplayList) {
    let painter = DisplayPainter::new(ui.painter(), ui.clip_rect(), Placement::SCREEN, context.tokens);
    painter.paint(&[list], Vec::new());
}

/// The axis with its numbers and the time's handle.
pub(super) fn axis(
    ui: &Ui,
    context: &Context<'_>,
    rect: Rect,
    view: &TimeView,
    (unit, names_left): (&str, f32),
) {
    let place = place(view, rect, rect, names_left);
    show(ui, context, &axis_list(&place, drawn(rect), unit, Some(context.state.playback.time)));
}

/// A rectangle of the screen as one of a list whose frame is the screen.
pub(crate) fn drawn(rect: Rect) -> display::Rect {
    let [left, top, right, bottom] = [rect.left(), rect.top(), rect.right(), rect.bottom()].map(f64::from);
    display::Rect::new(left, top, right, bottom)
}

impl Painting<'_> {
    /// The row of this number, name included.
    pub(super) fn row(&self, index: usize) -> Rect {
        Placement::SCREEN.screen_rect(self.place.row(index))
    }

    /// Returns where a time is.
    pub(super) fn x(&self, time: f64) -> f32 {
        self.place.x(time) as f32
    }

    /// A painter for what lies along time.
    pub(super) fn on_track(&self, ui: &Ui) -> Painter {
        ui.painter().with_clip_rect(self.visible)
    }

    /// The rectangle of a bar in a row, as it is scheduled now.
    pub(super) fn bar_rect(&self, bar: &Bar, index: usize) -> Rect {
        Placement::SCREEN.screen_rect(self.place.bar(bar, self.place.row(index)))
    }

    /// Returns where the sign is that opens and closes a row.
    pub(super) fn sign_rect(&self, index: usize) -> Rect {
        let shown = &self.chart.rows[index];
        Placement::SCREEN.screen_rect(self.place.sign(shown, self.place.row(index)))
    }

    /// The sign that opens and closes a row, if it has others below.
    pub(super) fn sign(&self, ui: &Ui, index: usize) {
        let shown = &self.chart.rows[index];
        if shown.key.is_some() {
            let sign = if shown.is_closed { Icon::ChevronRight } else { Icon::ChevronDown };
            let color = self.context.tokens.text_muted;
            icon::paint(ui.painter(), sign, self.sign_rect(index), 10.0, color);
        }
    }
}

/// A note at a place of the track, kept inside it.
pub(super) fn note(painter: &Painter, context: &Context<'_>, at: Pos2, text: &str, color: Color32) {
    let galley =
        painter.layout_no_wrap(text.to_owned(), FontId::proportional(size::SMALL), context.tokens.text);
    let clip = painter.clip_rect();
    let size = galley.size() + vec2(12.0, 6.0);
    let left = at.x.min(clip.right() - size.x - 2.0).max(clip.left() + 2.0);
    let top = at.y.min(clip.bottom() - size.y - 2.0).max(clip.top() + 2.0);
    let rect = Rect::from_min_size(pos2(left, top), size);
    painter.rect(rect, 4.0, context.tokens.raised, Stroke::new(1.0, color), StrokeKind::Inside);
    painter.galley(rect.min + vec2(6.0, 3.0), galley, color);
}
