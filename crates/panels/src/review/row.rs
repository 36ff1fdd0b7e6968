//! The rows of the checklist: drawn as one piece, so that they wrap well and are one stop for the keyboard.

use egui::{Align2, Color32, Pos2, Rect, Response, Sense, Stroke, StrokeKind, TextStyle, Ui};
use review::Status;
use theme::icon::{self, Icon};
use theme::{space, strong_family};
use tpn::Network;
use workbench::state::Selection;

use super::{is_stale, status_look};
use crate::{Context, inline_code};

/// How far the text of lines is from the left.
pub(super) const INDENT: f32 = 26.0;
/// Room for the line number on the right, and for all that is there, at least.
const PLACE: f32 = 54.0;
const MIN_META: f32 = 118.0;
/// Narrower rows put what is on the right below the text.
const NARROW: f32 = 430.0;

/// A line of the checklist.
pub(super) struct Row<'a> {
    /// How it stands.
    pub(super) status: Option<Status>,
    pub(super) text: &'a str,
    /// What it is held against; below it.
    pub(super) criterion: &'a str,
    /// What is on the right: a line number.
    pub(super) place: &'a str,
    /// Whether what it is about is selected.
    pub(super) is_selected: bool,
    /// Further to the right than other rows.
    pub(super) indent: f32,
    /// Whether the text matters less.
    pub(super) is_muted: bool,
}

pub(super) fn show(ui: &mut Ui, context: &Context<'_>, row: &Row<'_>) -> Response {
    let tokens = context.tokens;
    let body = TextStyle::Body.resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let width = ui.available_width();
    let left = INDENT + row.indent;
    let look = row.status.map(|status| status_look(tokens, status, is_stale(context)));
    let word = look.map_or("", |(_, word, _)| word);
    let is_narrow = width < NARROW;
    let color = if row.is_muted { tokens.text_muted } else { tokens.text };
    let word_color = look.map_or(tokens.text_muted, |(_, _, color)| color);
    let word_galley = ui.fonts_mut(|fonts| fonts.layout_no_wrap(word.to_owned(), small.clone(), word_color));
    let meta_width = if is_narrow { 0.0 } else { (PLACE + word_galley.size().x + space::M).max(MIN_META) };
    let wrap = (width - left - space::M - meta_width).max(60.0);
    let mut job = inline_code::job(row.text, &body, color, wrap);
    if !row.criterion.is_empty() {
        inline_code::append(&mut job, &format!("\n{}", row.criterion), &small, tokens.text_muted);
    }
    let galley = ui.fonts_mut(|fonts| fonts.layout_job(job));
    let below = if is_narrow && !(word.is_empty() && row.place.is_empty()) { 15.0 } else { 0.0 };
    let height = (galley.size().y + below + 6.0).max(space::ROW);
    let (rect, response) = ui.allocate_exact_size(egui::vec2(width, height), Sense::click());
    let parts = [word, row.text, row.criterion, row.place].into_iter().filter(|part| !part.is_empty());
    let name = inline_code::without_backticks(&parts.collect::<Vec<_>>().join(": "));
    theme::structure::item(&response, row.is_selected, &name);
    if !ui.is_rect_visible(rect) {
        return response;
    }
    background(ui, context, rect, &response, row.is_selected);
    let painter = ui.painter();
    if let Some((sign, _, color)) = look {
        let at = Pos2::new(rect.left() + left - 18.0, rect.top() + 3.0);
        icon::paint(painter, sign, Rect::from_min_size(at, egui::vec2(14.0, 17.0)), 13.0, color);
    }
    let text_at = Pos2::new(rect.left() + left, rect.top() + 3.0);
    let text_bottom = text_at.y + galley.size().y;
    painter.galley(text_at, galley, color);
    let muted = tokens.text_muted;
    if is_narrow {
        let at = Pos2::new(text_at.x, text_bottom + 1.0);
        let gap = if word.is_empty() { 0.0 } else { word_galley.size().x + 10.0 };
        painter.galley(at, word_galley, word_color);
        painter.text(at + egui::vec2(gap, 0.0), Align2::LEFT_TOP, row.place, small, muted);
    } else {
        let right = rect.right_top() + egui::vec2(-space::M, 5.0);
        painter.text(right, Align2::RIGHT_TOP, row.place, small, muted);
        painter.galley(right - egui::vec2(PLACE + word_galley.size().x, 0.0), word_galley, word_color);
    }
    response
}

/// The heading of a section.
pub(super) fn heading(
    ui: &mut Ui,
    context: &Context<'_>,
    title: &str,
    status: Option<Status>,
    note: &str,
    is_open: bool,
) -> Response {
    let tokens = context.tokens;
    let width = ui.available_width();
    let (rect, response) = ui.allocate_exact_size(egui::vec2(width, space::ROW + 4.0), Sense::click());
    let look = status.map_or("", |status| status_look(tokens, status, is_stale(context)).1);
    let parts = [title, look, note].into_iter().filter(|part| !part.is_empty());
    theme::structure::folding(&response, is_open, &parts.collect::<Vec<_>>().join(", "));
    if !ui.is_rect_visible(rect) {
        return response;
    }
    let painter = ui.painter();
    let fill = if response.hovered() { tokens.hover } else { tokens.raised };
    painter.rect_filled(rect, 4.0, fill);
    if response.has_focus() {
        painter.rect_stroke(rect, 4.0, Stroke::new(1.5, tokens.accent), StrokeKind::Inside);
    }
    let middle = rect.center().y;
    let slot = |x: f32| Rect::from_center_size(Pos2::new(rect.left() + x, middle), egui::vec2(14.0, 14.0));
    let chevron = if is_open { Icon::ChevronDown } else { Icon::ChevronRight };
    icon::paint(painter, chevron, slot(11.0), 13.0, tokens.text_muted);
    let mut x = 26.0;
    if let Some((sign, _, color)) = status.map(|status| status_look(tokens, status, is_stale(context))) {
        icon::paint(painter, sign, slot(x + 5.0), 13.0, color);
        x += 18.0;
    }
    let font = egui::FontId::new(theme::size::BODY, strong_family());
    let at = Pos2::new(rect.left() + x, middle);
    let title = painter.text(at, Align2::LEFT_CENTER, title, font, tokens.text);
    let small = TextStyle::Small.resolve(ui.style());
    let color = status
        .filter(|it| *it != Status::Passed)
        .map_or(tokens.text_muted, |it| status_look(tokens, it, is_stale(context)).2);
    let room = rect.right() - title.right() - 2.0 * space::M;
    let note = painter.layout_no_wrap(note.to_owned(), small, color);
    if note.size().x < room {
        let at = Pos2::new(rect.right() - space::M - note.size().x, middle - note.size().y / 2.0);
        painter.galley(at, note, color);
    }
    response
}

/// A word beside a field.
pub(super) fn muted_word(ui: &mut Ui, text: &str) {
    ui.label(egui::RichText::new(text).weak());
}

/// A sentence that is not a line of the checklist.
pub(super) fn muted(ui: &mut Ui, context: &Context<'_>, text: &str) {
    ui.horizontal(|ui| {
        ui.add_space(INDENT);
        // All of its lines begin at the indentation.
        ui.vertical(|ui| ui.label(egui::RichText::new(text).color(context.tokens.text_muted)));
    });
}

/// What lies behind a row that can be pressed.
pub(super) fn background(ui: &Ui, context: &Context<'_>, rect: Rect, response: &Response, is_selected: bool) {
    let tokens = context.tokens;
    let fill: Option<Color32> = if is_selected {
        Some(tokens.accent_soft)
    } else if response.hovered() || response.has_focus() {
        Some(tokens.hover)
    } else {
        None
    };
    if let Some(fill) = fill {
        ui.painter().rect_filled(rect, 3.0, fill);
    }
    if response.has_focus() {
        ui.painter().rect_stroke(rect, 3.0, Stroke::new(1.0, tokens.accent), StrokeKind::Inside);
    }
}

/// The names of what is selected, as the lines of a review name things.
pub(super) fn selected_names(context: &Context<'_>) -> Vec<String> {
    let network = context.snapshot.and_then(|snapshot| snapshot.network.as_deref());
    let selection = &*context.state.selection;
    match (selection, network) {
        (Selection::None, _) => Vec::new(),
        (Selection::Node(id), Some(network)) => network
            .nodes
            .get(id.index())
            .map(|node| {
                let mut names: Vec<String> =
                    node.events.iter().map(|&event| network.event_name(event)).collect();
                names.extend(node.decision.map(Network::decision_name));
                names
            })
            .unwrap_or_default(),
        _ => vec![selection.name(network)],
    }
}
