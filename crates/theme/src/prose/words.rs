//! Words that are wrapped together, and the links in them.

use std::sync::Arc;

use egui::text::{CCursor, LayoutJob, TextFormat};
use egui::{
    Color32, CursorIcon, FontFamily, FontId, Galley, Pos2, Rect, Role, Sense, Stroke, Ui, WidgetInfo,
};
use markdown::{Run, plain};

use super::Prose;
use crate::{strong_family, structure::mark_heading};

/// How words look where their own style says nothing else.
#[derive(Clone, Copy)]
pub(super) struct Look {
    /// In points.
    pub size: f32,
    /// Whether all of them carry weight.
    pub is_strong: bool,
    pub color: Color32,
}

/// Room between lines, as a share of the type size.
const LINE_HEIGHT: f32 = 1.42;

/// Shows words over the width there is; as a heading of a level, if one is given. Returns the link that was clicked.
pub(super) fn show_words(
    ui: &mut Ui,
    prose: &Prose<'_>,
    runs: &[Run],
    look: Look,
    heading: Option<u8>,
) -> Option<String> {
    let galley = layout(ui, prose, runs, look, ui.available_width());
    let (rect, response) = ui.allocate_exact_size(galley.size(), Sense::hover());
    let role = if heading.is_some() { Role::Heading } else { Role::Label };
    response.widget_info(|| WidgetInfo::labeled(role, true, plain(runs)));
    if let Some(level) = heading {
        // A page of prose is in a panel, whose own heading is of level 2.
        mark_heading(&response, usize::from(level) + 1);
    }
    place(ui, prose, runs, rect.min, &galley)
}

/// Lays words out in a width.
pub(super) fn layout(ui: &Ui, prose: &Prose<'_>, runs: &[Run], look: Look, width: f32) -> Arc<Galley> {
    let tokens = prose.tokens;
    let mut job = LayoutJob::default();
    job.wrap.max_width = width.max(1.0);
    for run in runs {
        let family = if run.style.code {
            FontFamily::Monospace
        } else if look.is_strong || run.style.strong {
            strong_family()
        } else {
            FontFamily::Proportional
        };
        let is_term = run.link.as_deref().is_some_and(|link| (prose.hover)(link).is_some());
        let color = match (&run.link, run.style.code) {
            (Some(_), _) if !is_term => tokens.accent,
            (None, true) => tokens.syntax.activity,
            _ => look.color,
        };
        // The font sizes of code look larger than those of text.
        let size = if run.style.code { look.size - 1.0 } else { look.size };
        let mut format = TextFormat::simple(FontId::new(size, family), color);
        format.line_height = Some((look.size * LINE_HEIGHT).round());
        format.valign = egui::Align::Center;
        format.italics = run.style.emphasis;
        job.append(&run.text, 0.0, format);
    }
    ui.painter().layout_job(job)
}

/// Paints laid-out words at a place, with their links. Returns the link that was clicked.
pub(super) fn place(
    ui: &mut Ui,
    prose: &Prose<'_>,
    runs: &[Run],
    at: Pos2,
    galley: &Arc<Galley>,
) -> Option<String> {
    if !ui.is_rect_visible(Rect::from_min_size(at, galley.size())) {
        return None;
    }
    ui.painter().galley(at, Arc::clone(galley), prose.tokens.text);
    let (mut clicked, mut from) = (None, 0);
    for (number, run) in runs.iter().enumerate() {
        let to = from + run.text.chars().count();
        if let Some(link) = &run.link {
            let rects = rects_of(galley, from, to);
            let is_term = (prose.hover)(link).is_some();
            let color = if is_term { prose.tokens.text_faint } else { prose.tokens.accent };
            for rect in &rects {
                // Close below the letters, which stand in the middle of their line.
                let y = (at.y + rect.center().y + rect.height() / LINE_HEIGHT * 0.5).round() + 0.5;
                ui.painter().hline((at.x + rect.left())..=(at.x + rect.right()), y, Stroke::new(1.0, color));
            }
            let longest = rects.into_iter().max_by(|one, other| one.width().total_cmp(&other.width()));
            let rect = longest.unwrap_or(Rect::NOTHING).translate(at.to_vec2());
            let id = ui.scope_id().with(("link", at.x as i32, at.y as i32, number));
            let response = ui.interact(rect, id, Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
            response.widget_info(|| WidgetInfo::labeled(Role::Link, true, &run.text));
            if response.has_focus() {
                let stroke = Stroke::new(1.0, prose.tokens.accent);
                ui.painter().rect_stroke(rect.expand(1.0), 2.0, stroke, egui::StrokeKind::Outside);
            }
            clicked = prose.show_hover(response, link).or(clicked);
        }
        from = to;
    }
    clicked
}

/// Around the letters from one to another, line by line.
fn rects_of(galley: &Galley, from: usize, to: usize) -> Vec<Rect> {
    let cursor = |index: usize, prefer_next_row| CCursor { index: index.into(), prefer_next_row };
    let begin = galley.pos_from_cursor(cursor(from, true));
    let end = galley.pos_from_cursor(cursor(to, false));
    if (begin.min.y - end.min.y).abs() < 1.0 {
        return vec![begin.union(end)];
    }
    let first = Rect::from_min_max(begin.min, egui::pos2(galley.size().x, begin.max.y));
    let last = Rect::from_min_max(egui::pos2(0.0, end.min.y), end.max);
    let between = Rect::from_min_max(first.left_bottom(), last.right_top());
    let middle =
        Rect::from_min_max(egui::pos2(0.0, between.top()), egui::pos2(galley.size().x, between.bottom()));
    let has_middle = middle.height() > 1.0;
    std::iter::once(first).chain(has_middle.then_some(middle)).chain([last]).collect()
}
