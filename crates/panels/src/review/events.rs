//! The windows and the slack of every event, the tightest first, with the slack as a bar.

use egui::text::{LayoutJob, TextWrapping};
use egui::{Align2, Pos2, Rect, Sense, TextStyle, Ui};
use exact::Bound;
use review::{EventReview, Section};
use theme::space;
use workbench::command::CommandSender;
use workbench::state::playback::bound;

use super::{List, lines, row};

/// Events that are listed before "Show all".
pub(super) const FIRST_EVENTS: usize = 20;
/// Rows with less room put their numbers below the name.
const NARROW: f32 = 430.0;

/// Shows the first `count` events.
pub(super) fn show(ui: &mut Ui, list: &List<'_>, count: usize, commands: &mut CommandSender) {
    let events = &list.review.events[..count.min(list.review.events.len())];
    let width = ui.available_width();
    let is_narrow = width < NARROW;
    if !is_narrow {
        headings(ui, list, width);
    }
    // Bars compare the slack of the listed events; without bound is as long as the longest.
    let longest = list.review.events.iter().map(|event| bound(event.slack)).filter(|it| it.is_finite());
    let longest = longest.fold(0.0_f64, f64::max).max(1e-9);
    let height = if is_narrow { space::ROW + 14.0 } else { space::ROW };
    for event in events {
        let (rect, response) = ui.allocate_exact_size(egui::vec2(width, height), Sense::click());
        let is_selected = list.selected.contains(&event.name);
        let title = list.context.readable(&event.name);
        let name = format!("{title} {}, slack {}", window_text(event), time_text(event.slack));
        theme::structure::item(&response, is_selected, &name);
        if ui.is_rect_visible(rect) {
            row::background(ui, list.context, rect, &response, is_selected);
            paint(ui, list, (&title, event), rect, longest, is_narrow);
        }
        if response.clicked() {
            lines::go_to(list, Section::Events, &event.line, commands);
        }
    }
}

/// How wide the columns of numbers are.
const NUMBER: f32 = 64.0;
/// How wide the bars are.
const BAR: f32 = 56.0;

fn headings(ui: &mut Ui, list: &List<'_>, width: f32) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(width, 16.0), Sense::hover());
    let small = TextStyle::Small.resolve(ui.style());
    let muted = list.context.tokens.text_muted;
    let painter = ui.painter();
    painter.text(
        Pos2::new(rect.left() + row::INDENT, rect.center().y),
        Align2::LEFT_CENTER,
        "Event",
        small.clone(),
        muted,
    );
    for (index, title) in ["Slack", "Latest", "Earliest"].into_iter().enumerate() {
        let x = rect.right() - space::M - BAR - space::M - index as f32 * NUMBER;
        painter.text(Pos2::new(x, rect.center().y), Align2::RIGHT_CENTER, title, small.clone(), muted);
    }
}

fn paint(
    ui: &Ui,
    list: &List<'_>,
    (title, event): (&str, &EventReview),
    rect: Rect,
    longest: f64,
    is_narrow: bool,
) {
    let tokens = list.context.tokens;
    let body = TextStyle::Body.resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let name_right =
        if is_narrow { rect.right() } else { rect.right() - BAR - 3.0 * NUMBER - 2.0 * space::M };
    let name_middle = if is_narrow { rect.top() + 11.0 } else { rect.center().y };
    let left = rect.left() + row::INDENT;
    let mut job = LayoutJob::simple_singleline(title.to_owned(), body.clone(), tokens.text);
    job.wrap = TextWrapping::truncate_at_width(name_right - left);
    let names = ui.painter().layout_job(job);
    let at = Align2::LEFT_CENTER.anchor_size(Pos2::new(left, name_middle), names.size()).min;
    ui.painter().galley(at, names, tokens.text);
    let is_tight = event.slack == Bound::ZERO;
    let slack_color = if is_tight { tokens.warning } else { tokens.text };
    let painter = ui.painter();
    if is_narrow {
        let text = format!("{}   slack {}", window_text(event), time_text(event.slack));
        let at = Pos2::new(rect.left() + row::INDENT, rect.bottom() - 9.0);
        painter.text(at, Align2::LEFT_CENTER, text, small, tokens.text_muted);
    } else {
        let numbers = [
            (time_text(event.slack), slack_color),
            (time_text(event.window.latest), tokens.text),
            (time_text(Bound::Finite(event.window.earliest)), tokens.text),
        ];
        for (index, (text, color)) in numbers.into_iter().enumerate() {
            let x = rect.right() - space::M - BAR - space::M - index as f32 * NUMBER;
            painter.text(Pos2::new(x, rect.center().y), Align2::RIGHT_CENTER, text, body.clone(), color);
        }
    }
    let y = if is_narrow { rect.bottom() - 9.0 } else { rect.center().y };
    let track = Rect::from_min_max(
        Pos2::new(rect.right() - space::M - BAR, y - 3.0),
        Pos2::new(rect.right() - space::M, y + 3.0),
    );
    painter.rect_filled(track, 3.0, tokens.sunken);
    let part = (bound(event.slack) / longest).clamp(0.0, 1.0) as f32;
    let filled = Rect::from_min_size(track.min, egui::vec2((track.width() * part).max(2.0), track.height()));
    painter.rect_filled(filled, 3.0, if is_tight { tokens.warning } else { tokens.slack });
}

fn window_text(event: &EventReview) -> String {
    format!("[{}, {}]", time_text(Bound::Finite(event.window.earliest)), time_text(event.window.latest))
}

fn time_text(time: Bound) -> String {
    time.readable().replace("inf", "∞")
}
