//! Cards over the image: what is known of a path that was clicked, and what was measured.

use egui::{Frame, Pos2, Rect, RichText, Sense, Ui, UiBuilder, pos2, vec2};
use glam::Vec2;
use rmpl::program::TimeUnit;
use snapshot::{Snapshot, Traverse};
use theme::icon::{self, Icon};
use theme::{size, space, strong};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::time_text;

use super::measure::{Measurement, meters, show_chart, show_rows};
use crate::Context;

/// Cards are as wide as this, or as the panel allows.
const WIDTH: f32 = 232.0;

/// A card near `anchor`, kept inside `image`, clear of the anchor, and of what is at `others` as far as that goes. Returns
/// whether its cross was clicked.
pub fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    image: Rect,
    (anchor, others): (Pos2, &[Pos2]),
    title: &str,
    add: impl FnOnce(&mut Ui),
) -> bool {
    let tokens = context.tokens;
    let id = ui.scope_id().with(("card", title));
    let width = WIDTH.min(image.width() - 2.0 * space::M);
    let height = ui.ctx().data(|data| data.get_temp::<f32>(id)).unwrap_or(120.0);
    let corner = corner(image.shrink(space::M), anchor, others, vec2(width, height));
    let card = Rect::from_min_size(corner, vec2(width, height));
    let end = card.clamp(anchor);
    if end.distance(anchor) > 4.0 && image.contains(anchor) {
        let painter = ui.painter_at(image);
        painter.line_segment([anchor, end], egui::Stroke::new(1.4, tokens.accent));
        painter.circle(anchor, 4.0, tokens.raised, egui::Stroke::new(1.6, tokens.accent));
    }
    // What is clicked on a card does not reach the ground under it.
    ui.interact(card, id.with("block"), Sense::click_and_drag());
    let mut is_closed = false;
    let builder =
        UiBuilder::new().id_salt(id).max_rect(Rect::from_min_size(corner, vec2(width, f32::INFINITY)));
    let shown = ui.scope_builder(builder, |ui| {
        let frame = Frame::new()
            .fill(tokens.raised)
            .stroke(egui::Stroke::new(1.0, tokens.line_strong))
            .corner_radius(6.0)
            .inner_margin(space::M);
        frame.show(ui, |ui| {
            ui.set_width(width - 2.0 * space::M);
            ui.spacing_mut().item_spacing.y = space::XS;
            ui.horizontal(|ui| {
                let cross = space::ROW + space::S;
                ui.scope(|ui| {
                    ui.set_max_width(ui.available_width() - cross);
                    let name = strong(title).size(size::BODY).color(tokens.text);
                    ui.add(egui::Label::new(name).truncate());
                });
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    is_closed = icon::button(ui, tokens, Icon::Close, &format!("Close {title}")).clicked();
                });
            });
            add(ui);
        });
    });
    let found = shown.response.rect.height();
    if (found - height).abs() > 0.5 {
        ui.ctx().data_mut(|data| data.insert_temp(id, found));
        ui.ctx().request_repaint();
    }
    is_closed
}

/// The top left corner of a card that is inside `room`: beside its anchor, or in a corner of the room if it covers fewer of
/// the other places there.
fn corner(room: Rect, anchor: Pos2, others: &[Pos2], size: egui::Vec2) -> Pos2 {
    let far = (room.max - size).max(room.min);
    let corners = [pos2(far.x, far.y), pos2(room.left(), far.y), pos2(far.x, room.top()), room.min];
    let covered = |corner: Pos2| {
        let card = Rect::from_min_size(corner, size).expand(space::S);
        others.iter().chain([&anchor]).filter(|place| card.contains(**place)).count()
    };
    let first = beside(room, anchor, size);
    // Of equal ones the first, which is where one looks.
    [first].into_iter().chain(corners).min_by_key(|&corner| covered(corner)).unwrap_or(first)
}

/// The top left corner of a card that is beside its anchor and inside `room`.
fn beside(room: Rect, anchor: Pos2, size: egui::Vec2) -> Pos2 {
    let beside = if anchor.x + 18.0 + size.x <= room.right() {
        anchor.x + 18.0
    } else if anchor.x - 18.0 - size.x >= room.left() {
        anchor.x - 18.0 - size.x
    } else {
        room.right() - size.x
    };
    let up = anchor.y - size.y - 12.0;
    let top = if up >= room.top() { up } else { anchor.y + 18.0 };
    pos2(
        beside.clamp(room.left(), (room.right() - size.x).max(room.left())),
        top.clamp(room.top(), (room.bottom() - size.y).max(room.top())),
    )
}

/// The traverse that is selected, if one is.
pub fn selected_traverse<'a>(snapshot: &'a Snapshot, selection: &Selection) -> Option<&'a Traverse> {
    let occurrence = selection.occurrence(snapshot.network.as_deref()?)?;
    snapshot.traverses.iter().find(|it| it.occurrence == occurrence)
}

/// The rows of a path's card: the whole traverse, then the leg that was clicked, if it has several.
pub fn path_rows(
    context: &Context<'_>,
    traverse: &Traverse,
    leg: Option<usize>,
) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        ("Length", meters(traverse.length_m)),
        ("Clearance", room(traverse.clearance_m)),
        ("Steepest slope", format!("{:.0}°", traverse.slope_max_rad.to_degrees())),
    ];
    rows.extend(time_rows(context, traverse));
    let leg = leg.filter(|_| traverse.legs.len() > 1);
    let parts = leg.and_then(|leg| Some((traverse.legs.get(leg)?, traverse.leg_figures.get(leg)?)));
    if let Some((leg, figures)) = parts {
        let unit = time_text::unit(unit(context));
        rows.push(("This leg", format!("to {}, {}", leg.to, meters(figures.length_m))));
        rows.push(("Leg clearance", room(figures.min_clearance_m)));
        rows.push(("Leg steepest slope", format!("{:.0}°", figures.max_slope_deg)));
        rows.push(("Leg minimum duration", format!("{} {unit}", time_text::short(figures.min_duration))));
    }
    rows
}

fn unit(context: &Context<'_>) -> TimeUnit {
    context.snapshot.map_or(TimeUnit::Minute, |snapshot| snapshot.program.options.time_unit)
}

/// Room between a vehicle and the nearest obstacle.
fn room(clearance_m: f64) -> String {
    if clearance_m.is_finite() { format!("{clearance_m:.1} m") } else { "no obstacle".to_owned() }
}

/// When the traverse is driven and how fast, under the earliest schedule of the plan.
fn time_rows(context: &Context<'_>, traverse: &Traverse) -> Vec<(&'static str, String)> {
    let times = context.plan().and_then(|(network, plan)| {
        let occurrence = network.occurrences.get(traverse.occurrence.index())?;
        let window = |node: tpn::NodeId| plan.windows.get(node.index()).copied().flatten();
        Some((window(occurrence.start)?.earliest, window(occurrence.end)?.earliest))
    });
    let Some((start, end)) = times else { return Vec::new() };
    let unit = unit(context);
    let name = time_text::unit(unit);
    let mut rows = vec![
        ("Duration", format!("{} {name}", time_text::slack(start, exact::Bound::Finite(end)))),
        ("Start and end", format!("{} to {} {name}", time_text::short(start), time_text::short(end))),
    ];
    let seconds = (end.to_f64() - start.to_f64()) * unit.seconds() as f64;
    if seconds > 0.0 {
        rows.push(("Mean speed", format!("{:.2} cm/s", 100.0 * traverse.length_m / seconds)));
    }
    rows
}

/// The card of the selected traverse.
pub fn show_path(
    ui: &mut Ui,
    context: &Context<'_>,
    image: Rect,
    (anchor, path): (Pos2, &[Pos2]),
    (traverse, leg): (&Traverse, Option<usize>),
    commands: &mut CommandSender,
) {
    let network = context.snapshot.and_then(|snapshot| snapshot.network.as_deref());
    let title = network
        .and_then(|network| network.occurrences.get(traverse.occurrence.index()))
        .map_or("Path", |occurrence| occurrence.name.as_str());
    let title = &network.map_or_else(|| title.to_owned(), |network| network.readable(title));
    let rows = path_rows(context, traverse, leg);
    let is_closed = show(ui, context, image, (anchor, path), title, |ui| {
        show_rows(ui, context.tokens, &rows);
        if context.is_stale {
            ui.label(RichText::new("from the previous text").small().color(context.tokens.warning));
        }
    });
    if is_closed {
        commands.send(Command::Select(Selection::None));
    }
}

/// The card of a measurement; returns whether it was closed.
pub fn show_measurement(
    ui: &mut Ui,
    context: &Context<'_>,
    image: Rect,
    anchor: Pos2,
    measured: &Measurement,
) -> bool {
    show(ui, context, image, (anchor, &[]), "Measurement", |ui| {
        show_rows(ui, context.tokens, &measured.rows());
        ui.add_space(space::XS);
        show_chart(ui, context.tokens, measured);
    })
}

/// Returns where the card of a traverse points: the place that was clicked if it is on it still, otherwise its middle.
pub fn path_anchor(traverse: &Traverse, clicked_m: Option<Vec2>) -> Option<Vec2> {
    let points: Vec<Vec2> = path_points(traverse).collect();
    clicked_m.or_else(|| points.get(points.len() / 2).copied())
}

/// The points of a traverse's path.
pub fn path_points(traverse: &Traverse) -> impl Iterator<Item = Vec2> {
    traverse.legs.iter().flat_map(|leg| &leg.points_m).map(|&point| terrain_view::scene::place(point))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_stays_in_the_image_and_off_its_anchor_where_there_is_room() {
        let room = Rect::from_min_size(pos2(0.0, 0.0), vec2(800.0, 600.0));
        let size = vec2(200.0, 150.0);
        for anchor in [pos2(10.0, 10.0), pos2(790.0, 590.0), pos2(400.0, 300.0), pos2(790.0, 10.0)] {
            let card = Rect::from_min_size(corner(room, anchor, &[], size), size);
            assert!(room.contains_rect(card), "{anchor:?} {card:?}");
            assert!(!card.contains(anchor), "{anchor:?} {card:?}");
        }
        let narrow = Rect::from_min_size(pos2(0.0, 0.0), vec2(210.0, 160.0));
        assert!(
            narrow.contains_rect(Rect::from_min_size(corner(narrow, pos2(100.0, 80.0), &[], size), size))
        );
    }

    #[test]
    fn a_card_goes_to_a_corner_where_it_would_cover_the_path() {
        let room = Rect::from_min_size(pos2(0.0, 0.0), vec2(800.0, 600.0));
        let size = vec2(200.0, 150.0);
        let anchor = pos2(400.0, 300.0);
        let path: Vec<Pos2> =
            (0..40).map(|at| pos2(at as f32 * 20.0, 300.0 - (at as f32 - 20.0) * 8.0)).collect();
        let covers =
            |corner: Pos2| path.iter().filter(|it| Rect::from_min_size(corner, size).contains(**it)).count();
        assert!(covers(beside(room, anchor, size)) > 0, "beside its anchor it is in the way");
        assert_eq!(covers(corner(room, anchor, &path, size)), 0);
    }
}
