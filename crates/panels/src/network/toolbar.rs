//! The row above the drawing: the search field, what is shown, and how much detail.

use egui::{RichText, TextEdit, Ui};
use theme::space;
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::settings::NetworkView;
use workbench::state::window::WindowCommand;

use super::search::Search;
use crate::Context;

/// What the user asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    Nothing,
    /// The next match of the search.
    NextMatch,
    /// The match before.
    PreviousMatch,
    /// Everything is drawn, however small.
    OpenAll,
    /// As much is drawn as can be read.
    FitAll,
    /// The outermost activities are collapsed.
    CloseAll,
}

/// Shows the switches and answers what was asked for besides.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    view: &mut NetworkView,
    search: &mut Search,
    (has_boxes, is_changed): (bool, bool),
    commands: &mut CommandSender,
) -> Asked {
    let mut asked = Asked::Nothing;
    ui.add_space(space::XS);
    ui.horizontal_wrapped(|ui| {
        ui.add_space(space::S);
        ui.spacing_mut().item_spacing.x = space::S;
        let field = TextEdit::singleline(&mut search.text).hint_text("Find…").desired_width(110.0);
        let field = ui.add(field).on_hover_text("Search activities, events, decisions and conditions");
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search the network"));
        if field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
            let back = ui.input(|input| input.modifiers.shift);
            asked = if back { Asked::PreviousMatch } else { Asked::NextMatch };
            field.request_focus();
        }
        if !search.text.trim().is_empty() {
            let text = match search.count() {
                (0, _) => "none".to_owned(),
                (count, None) => format!("{count}"),
                (count, Some(at)) => format!("{at}/{count}"),
            };
            ui.label(RichText::new(text).small().color(context.tokens.text_muted));
        }
        ui.add_space(space::S);
        ui.menu_button(RichText::new("Show").small(), |ui| {
            for (value, name, help) in switches(view) {
                ui.checkbox(value, name).on_hover_text(help);
            }
        });
        let small = |name: &str| egui::Button::new(RichText::new(name).small());
        if ui.add(small("Fit")).on_hover_text("Zoom to fit (F)").clicked() {
            commands.send(Command::Window(WindowCommand::ViewOf(PanelKind::Network, ViewAction::Fit)));
        }
        let buttons = [
            (has_boxes, "Expand all", "Show all details", Asked::OpenAll),
            (is_changed, "Fit detail", "Show as much detail as is readable", Asked::FitAll),
            (!has_boxes, "Collapse all", "Collapse top-level activities", Asked::CloseAll),
        ];
        for (is_offered, name, help, answer) in buttons {
            if is_offered && ui.add(small(name)).on_hover_text(help).clicked() {
                asked = answer;
            }
        }
    });
    asked
}

/// Returns what can be switched on and off, with its name and what it means.
fn switches(view: &mut NetworkView) -> [(&mut bool, &'static str, &'static str); 12] {
    [
        (&mut view.names, "Names", "Names of activities"),
        (&mut view.bounds, "Bounds", "Bounds of each constraint"),
        (&mut view.labels, "Conditions", "Required and asserted conditions"),
        (&mut view.windows, "Windows", "Time windows of events"),
        (&mut view.links, "Links", "Causal links from assertions to requirements"),
        (&mut view.orderings, "Orderings", "Orderings added to resolve threats"),
        (&mut view.unselected, "Unselected", "Unselected alternatives"),
        (&mut view.structure, "Structure", "Activity outlines and branch lanes"),
        (&mut view.lanes, "Lanes", "A named band for each parallel branch"),
        (&mut view.now, "Time", "Past and ongoing activities at the current time"),
        (&mut view.problems, "Problems", "Errors and warnings"),
        (&mut view.minimap, "Minimap", "The whole network in a corner"),
    ]
}
