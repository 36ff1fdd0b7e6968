//! Texts: as large as their place, cut or left out where they could not be read, moved where they can be seen.

use std::sync::Arc;

use display::{Anchor, Fit, Text, Weight};
use egui::text::{LayoutJob, TextWrapping};
use egui::{Align2, Color32, FontFamily, FontId, Galley, Rect, Stroke, pos2, vec2};

use super::DisplayPainter;

/// Names that would be smaller than this in points keep this size instead, and are cut to the room there is.
const LEGIBLE: f64 = 11.0;
/// What is shown whole or not at all may be so much wider than its place.
const WHOLE_SPARE: f32 = 5.0;
/// Other texts that would be smaller than that keep it too, where they would be no smaller than this: there is room for
/// so much more around them.
const RAISED_FROM: f64 = 7.9;
/// A name with less room than this on the screen is left out.
const MIN_NAME: f32 = 30.0;
/// From the ends of a line to the name over it, together, in points.
const NAME_INSET: f32 = 6.0;
/// How far from the corner of its area a heading may begin that finds others there, in points.
const FARTHEST_HEADING: f32 = 70.0;
/// An area smaller than this on the screen has no heading.
const MIN_AREA: [f32; 2] = [40.0, 16.0];
/// From the edge of the panel to a text that was moved into view.
const SLIDE_INSET: f64 = 16.0;

impl DisplayPainter<'_> {
    pub(super) fn text(&self, text: &Text, taken: &mut Vec<Rect>) {
        if let Some(area) = text.heading {
            self.heading(text, area, taken);
            return;
        }
        let zoom = self.placement.zoom;
        let inset = SLIDE_INSET / zoom;
        let rect = text.rect_in_view(self.visible.min.x + inset, self.visible.max.x - inset);
        if text.slide.is_some() && !rect.touches(self.visible) {
            return;
        }
        let place = self.placement.screen_rect(rect);
        let size = text.size * zoom;
        if let Some(room) = text.legible.filter(|_| size < LEGIBLE) {
            self.legible(text, place, (room * zoom) as f32 - NAME_INSET, taken);
            return;
        }
        if size < RAISED_FROM {
            return;
        }
        let color = self.color(text.color);
        let size = size.max(LEGIBLE);
        let Some((galley, font)) = self.fitted(text, size, place, color) else { return };
        let left = match text.anchor {
            Anchor::Start => place.left(),
            Anchor::Middle => place.center().x - galley.size().x / 2.0,
            Anchor::End => place.right() - galley.size().x,
        };
        let corner = pos2(left, place.center().y - galley.size().y / 2.0);
        if let Some(plate) = text.plate {
            let behind =
                if text.fit.fills_its_place() { place } else { Rect::from_min_size(corner, galley.size()) };
            self.painter.rect_filled(behind.expand(2.0), 3.0, self.color(plate));
        }
        if let Some(before) = text.overbar.and_then(|at| text.text.get(..at as usize)) {
            let lead = self.painter.layout_no_wrap(before.to_owned(), font, color).size().x;
            let top = corner.y + 0.5;
            let ends = [pos2(corner.x + lead, top), pos2(corner.x + galley.size().x, top)];
            self.painter.line_segment(ends, Stroke::new(1.2, color));
        }
        self.painter.galley(corner, galley, color);
    }

    /// The text at `size`, made to fit into `place` as it says; nothing where it is left out.
    fn fitted(&self, text: &Text, size: f64, place: Rect, color: Color32) -> Option<(Arc<Galley>, FontId)> {
        // Whole and half sizes only, so that zooming does not fill the font atlas.
        let font = |size: f64| font(text.weight, ((size * 2.0).floor() / 2.0) as f32);
        let used = font(size);
        if text.fit == Fit::Cut {
            let mut job = LayoutJob::simple_singleline(text.text.to_string(), used.clone(), color);
            job.wrap = TextWrapping::truncate_at_width(place.width().max(12.0));
            return Some((self.painter.layout_job(job), used));
        }
        let galley = self.painter.layout_no_wrap(text.text.to_string(), used.clone(), color);
        if text.fit == Fit::Overflow || galley.size().x <= place.width() + 1.0 {
            return Some((galley, used));
        }
        // No smaller than it can be read: the rest is cut.
        let smaller = font((size * f64::from(place.width() / galley.size().x)).max(LEGIBLE.min(size)));
        let mut job = LayoutJob::simple_singleline(text.text.to_string(), smaller.clone(), color);
        if text.fit == Fit::Unabridged {
            let galley = self.painter.layout_job(job);
            return (galley.size().x <= place.width() + WHOLE_SPARE).then_some((galley, smaller));
        }
        job.wrap = TextWrapping::truncate_at_width(place.width().max(12.0) + 1.0);
        Some((self.painter.layout_job(job), smaller))
    }

    /// A name at the least legible size over the middle of its place, cut to its room, if there is any between what is
    /// `taken`.
    fn legible(&self, text: &Text, place: Rect, room: f32, taken: &mut Vec<Rect>) {
        if room < MIN_NAME {
            return;
        }
        let color = self.color(text.color);
        let mut job =
            LayoutJob::simple_singleline(text.text.to_string(), font(text.weight, LEGIBLE as f32), color);
        job.wrap = TextWrapping::truncate_at_width(room);
        let galley = self.painter.layout_job(job);
        let rect = Align2::CENTER_BOTTOM.anchor_size(place.center_bottom() + vec2(0.0, 1.0), galley.size());
        if taken.iter().all(|other| !other.intersects(rect)) {
            // What passes behind would make so small a text hard to read.
            let plate = text.plate.map_or(self.tokens.surface.gamma_multiply(0.8), |plate| self.color(plate));
            self.painter.rect_filled(rect, 2.0, plate);
            self.painter.galley(rect.min, galley, color);
            taken.push(rect);
        }
    }

    /// The heading of an area at its own size, where it has room; those before it come first.
    fn heading(&self, text: &Text, area: display::Rect, taken: &mut Vec<Rect>) {
        let rect = self.placement.screen_rect(area).intersect(self.area);
        if rect.width() < MIN_AREA[0] || rect.height() < MIN_AREA[1] {
            return;
        }
        let color = self.color(text.color);
        let font = font(text.weight, text.size as f32);
        let galley = self.painter.layout_no_wrap(text.text.to_string(), font, color);
        let inset = vec2((text.rect.min.x - area.min.x) as f32, (text.rect.min.y - area.min.y) as f32);
        let mut place = Rect::from_min_size(rect.min + inset, galley.size());
        // Beside what is there already, as far as the area goes.
        let farthest = rect.left() + FARTHEST_HEADING;
        while let Some(other) = taken.iter().find(|other| other.intersects(place)) {
            place = place.translate(vec2(other.right() + 6.0 - place.left(), 0.0));
            if place.left() >= farthest {
                return;
            }
        }
        if rect.expand(1.0).contains_rect(place) {
            if let Some(plate) = text.plate {
                self.painter.rect_filled(place.expand(1.0), 2.0, self.color(plate));
            }
            self.painter.galley(place.min, galley, color);
            taken.push(place);
        }
    }
}

fn font(weight: Weight, size: f32) -> FontId {
    let family = match weight {
        Weight::Regular => FontFamily::Proportional,
        Weight::Strong => theme::strong_family(),
    };
    FontId::new(size, family)
}
