//! The table of windows: every event of the plan, sortable and searchable.

use egui::{Align2, RichText, Role, Sense, TextEdit, TextStyle, Ui, WidgetInfo};
use exact::{Bound, Time};
use theme::space;
use tpn::{EventEnd, EventRef, Network, NodeId, Plan};
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::settings::SettingsCommand;
use workbench::state::settings::WindowSort;
use workbench::time_text;

use crate::plan::section;
use crate::{Context, keyboard_navigation};

/// The table, with what was typed into its filter.
#[derive(Default)]
pub(crate) struct WindowTable {
    filter: String,
}

/// A row: an event and its window. Of thousands, names are written only for those on screen.
struct Row {
    node: NodeId,
    event: EventRef,
    earliest: Time,
    latest: Bound,
}

/// The widths of the columns of numbers.
const NUMBER_WIDTH: f32 = 78.0;

impl WindowTable {
    pub(crate) fn show(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        network: &Network,
        plan: &Plan,
        commands: &mut CommandSender,
    ) {
        let mut rows = self.rows(context, network, plan);
        if let Some(steps) =
            keyboard_navigation::arrows(ui, context, PanelKind::Plan).filter(|_| !rows.is_empty())
        {
            sort(&mut rows, context, network);
            let is_here = |row: &&Row| is_selected(context, network, row);
            let here = rows.iter().position(|row| is_here(&row));
            // One event can have several names, and rows.
            let next = match here {
                None => rows.first(),
                Some(here) if steps > 0 => rows[here..].iter().find(|row| !is_here(row)),
                Some(here) => rows[..here].iter().rev().find(|row| !is_here(row)),
            };
            if let Some(next) = next {
                commands.send(Command::Select(Selection::Node(next.node)));
            }
        }
        section(ui, context, "Windows", "earliest and latest times, from mission start");
        let field = TextEdit::singleline(&mut self.filter).hint_text("Filter events").desired_width(180.0);
        ui.horizontal(|ui| {
            ui.add(field).accessible_name("Filter events");
            let shown = context.state.settings.views.plan.path_points;
            if ui.add(egui::Button::selectable(shown, RichText::new("Path points").small())).clicked() {
                let mut views = context.state.settings.views.clone();
                views.plan.path_points = !shown;
                commands.send(Command::Settings(SettingsCommand::SetViews(Box::new(views))));
            }
        });
        ui.add_space(space::XS);
        ui.scope(|ui| show_table(ui, context, network, rows, commands));
    }

    /// The events that the filter leaves, in no order.
    fn rows(&self, context: &Context<'_>, network: &Network, plan: &Plan) -> Vec<Row> {
        let filter = self.filter.to_lowercase();
        let shows_path_points = context.state.settings.views.plan.path_points;
        network
            .nodes
            .iter()
            .zip(&plan.windows)
            .enumerate()
            .filter_map(|(index, (node, window))| Some((index, node, (*window)?)))
            .flat_map(|(index, node, window)| {
                let is_shown = move |event: &&EventRef| {
                    shows_path_points || !matches!(event.end, EventEnd::PathVertex { .. })
                };
                node.events.iter().filter(is_shown).map(move |&event| Row {
                    node: NodeId::from_index(index),
                    event,
                    earliest: window.earliest,
                    latest: window.latest,
                })
            })
            .filter(|row| filter.is_empty() || row.name(network).to_lowercase().contains(&filter))
            .collect()
    }
}

impl Row {
    fn name(&self, network: &Network) -> String {
        network.readable(&network.event_name(self.event))
    }
}

/// Sorts as the view says; what is equal comes in the order of the network.
fn sort(rows: &mut [Row], context: &Context<'_>, network: &Network) {
    let view = &context.state.settings.views.plan;
    let by_time = |row: &Row| (row.earliest, row.latest);
    match view.sort {
        WindowSort::Earliest => rows.sort_by_key(by_time),
        WindowSort::Latest => rows.sort_by_key(|row| (row.latest, by_time(row))),
        WindowSort::Slack => rows.sort_by_cached_key(|row| (slack(row), by_time(row))),
        WindowSort::Event => rows.sort_by_cached_key(|row| row.name(network)),
    }
    if view.descending {
        rows.reverse();
    }
}

fn slack(row: &Row) -> Bound {
    row.latest.checked_sub(row.earliest).unwrap_or(Bound::Infinite)
}

fn show_table(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    mut rows: Vec<Row>,
    commands: &mut CommandSender,
) {
    show_header(ui, context, commands);
    let height = space::ROW;
    let (table, _) =
        ui.allocate_exact_size(egui::vec2(ui.available_width(), height * rows.len() as f32), Sense::hover());
    theme::structure::part_in(ui, ui.min_rect(), egui::accesskit::Role::Table, "Windows");
    if !ui.is_rect_visible(table) {
        return;
    }
    sort(&mut rows, context, network);
    let clip = ui.clip_rect();
    let first = ((clip.top() - table.top()) / height).floor().max(0.0) as usize;
    let last = ((clip.bottom() - table.top()) / height).ceil().max(0.0) as usize;
    for (index, row) in rows.iter().enumerate().take(last).skip(first) {
        let top = table.top() + index as f32 * height;
        let rect =
            egui::Rect::from_min_size(egui::pos2(table.left(), top), egui::vec2(table.width(), height));
        show_row(ui, context, network, row, rect, commands);
    }
}

fn show_header(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let view = &context.state.settings.views.plan;
    let width = ui.available_width();
    let (rect, _) = ui.allocate_exact_size(egui::vec2(width, space::ROW), Sense::hover());
    let name_width = (width - 3.0 * NUMBER_WIDTH).max(60.0);
    let columns = [
        ("Event", WindowSort::Event, 0.0, name_width),
        ("Earliest", WindowSort::Earliest, name_width, NUMBER_WIDTH),
        ("Latest", WindowSort::Latest, name_width + NUMBER_WIDTH, NUMBER_WIDTH),
        ("Slack", WindowSort::Slack, name_width + 2.0 * NUMBER_WIDTH, NUMBER_WIDTH),
    ];
    for (title, sort, left, width) in columns {
        let cell =
            egui::Rect::from_min_size(rect.min + egui::vec2(left, 0.0), egui::vec2(width, rect.height()));
        let response = ui.interact(cell, ui.scope_id().with(title), Sense::click());
        let is_sorted = view.sort == sort;
        let name = format!("Sort by {}", title.to_lowercase());
        theme::structure::sorting(&response, is_sorted.then_some(view.descending), &name);
        let color =
            if is_sorted || response.hovered() { context.tokens.text } else { context.tokens.text_muted };
        let arrow = match (is_sorted, view.descending) {
            (true, false) => " ↑",
            (true, true) => " ↓",
            _ => "",
        };
        let font = TextStyle::Small.resolve(ui.style());
        let (at, align) = if sort == WindowSort::Event {
            (cell.left_center() + egui::vec2(space::S, 0.0), Align2::LEFT_CENTER)
        } else {
            (cell.right_center() - egui::vec2(space::S, 0.0), Align2::RIGHT_CENTER)
        };
        ui.painter().text(at, align, format!("{title}{arrow}"), font, color);
        if response.clicked() {
            let mut views = context.state.settings.views.clone();
            views.plan.descending = is_sorted && !view.descending;
            views.plan.sort = sort;
            commands.send(Command::Settings(SettingsCommand::SetViews(Box::new(views))));
        }
    }
    ui.painter().hline(rect.x_range(), rect.bottom(), egui::Stroke::new(1.0, context.tokens.line));
}

fn show_row(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    row: &Row,
    rect: egui::Rect,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let name = row.name(network);
    let response = ui.interact(rect, ui.scope_id().with(&name), Sense::click());
    let is_selected = is_selected(context, network, row);
    let window = time_text::interval(row.earliest, row.latest);
    theme::structure::item(&response, is_selected, &format!("{name} {window}"));
    if is_selected {
        ui.painter().rect_filled(rect, 3.0, tokens.selection);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 3.0, tokens.hover);
    }
    let body = TextStyle::Body.resolve(ui.style());
    let name_width = (rect.width() - 3.0 * NUMBER_WIDTH).max(60.0);
    let name_rect = egui::Rect::from_min_size(rect.min, egui::vec2(name_width, rect.height()));
    let at = rect.left_center() + egui::vec2(space::S, 0.0);
    ui.painter().with_clip_rect(name_rect.intersect(ui.clip_rect())).text(
        at,
        Align2::LEFT_CENTER,
        &name,
        body.clone(),
        tokens.text,
    );
    let numbers = [
        (time_text::short(row.earliest), tokens.text),
        (time_text::short_bound(row.latest), tokens.text),
        (time_text::slack(row.earliest, row.latest), tokens.slack),
    ];
    for (column, (text, color)) in numbers.into_iter().enumerate() {
        let right = rect.left() + name_width + (column + 1) as f32 * NUMBER_WIDTH - space::S;
        let at = egui::pos2(right, rect.center().y);
        // A cell of its own for those who read the table.
        let cell = ui.painter().text(at, Align2::RIGHT_CENTER, &text, body.clone(), color);
        let cell = ui.interact(cell, response.id.with(column), Sense::hover());
        cell.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
    }
    if response.clicked() {
        commands.send(Command::Select(Selection::Node(row.node)));
    }
    if response.double_clicked() {
        commands.send(Command::SelectAndReveal(Selection::Node(row.node)));
    }
    response.on_hover_ui(|ui| {
        ui.label(&name);
        ui.label(RichText::new(window).color(tokens.text_muted));
    });
}

/// An event is selected by itself or with its activity.
fn is_selected(context: &Context<'_>, network: &Network, row: &Row) -> bool {
    match &*context.state.selection {
        Selection::Node(node) => *node == row.node,
        selection @ (Selection::Occurrence(_) | Selection::Label(_)) => {
            selection.occurrence(network).is_some_and(|occurrence| row.event.occurrence == occurrence)
        }
        _ => false,
    }
}
