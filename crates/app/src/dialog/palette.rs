//! The command palette: every command, panel and example, found by the letters of its name or by another word for it.

use egui::{Key, Modifiers, RichText, Role, ScrollArea, Sense, TextEdit, Ui, WidgetInfo};
use panels::Context;
use theme::space;
use workbench::Dialog;
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::library::LibraryCommand;
use workbench::mission_file::EXAMPLES;
use workbench::registry;
use workbench::state::window::WindowCommand;

use crate::chord;

const WIDTH: f32 = 520.0;

/// One thing to choose.
struct Entry {
    /// By what other words find it: the name of a command, or the title of a panel.
    named: &'static str,
    group: &'static str,
    title: String,
    keys: String,
    unavailable: Option<&'static str>,
    command: Command,
}

/// Shows the palette.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    query: &str,
    chosen: usize,
    commands: &mut CommandSender,
) {
    ui.set_width(WIDTH);
    let entries = entries(ui, context, query);
    let mut chosen = chosen.min(entries.len().saturating_sub(1));
    let (up, down, enter) = ui.input_mut(|input| {
        (
            input.consume_key(Modifiers::NONE, Key::ArrowUp),
            input.consume_key(Modifiers::NONE, Key::ArrowDown),
            input.consume_key(Modifiers::NONE, Key::Enter),
        )
    });
    if down && chosen + 1 < entries.len() {
        chosen += 1;
    }
    chosen -= usize::from(up && chosen > 0);

    let mut text = query.to_owned();
    let field = TextEdit::singleline(&mut text)
        .hint_text("Search commands, panels and missions")
        .desired_width(f32::INFINITY);
    let field = ui.add(field).accessible_name("Command palette");
    field.request_focus();
    if field.changed() {
        chosen = 0;
    }
    ui.add_space(space::S);

    let mut run = enter.then_some(chosen);
    ScrollArea::vertical().max_height(360.0).auto_shrink([false, true]).show(ui, |ui| {
        theme::structure::options(ui, "Results");
        for (index, entry) in entries.iter().enumerate() {
            let response = show_entry(ui, context, entry, index == chosen);
            if index == chosen && (up || down) {
                response.scroll_to_me(None);
            }
            if response.clicked() {
                run = Some(index);
            }
        }
        if entries.is_empty() {
            ui.label(RichText::new("No matching commands").color(context.tokens.text_muted));
        }
    });
    commands.send(Command::Window(WindowCommand::ShowDialog(Dialog::Palette { query: text, chosen })));
    let run = run.and_then(|index| entries.get(index)).filter(|entry| entry.unavailable.is_none());
    if let Some(entry) = run {
        commands.send(Command::Window(WindowCommand::CloseDialog));
        commands.send(entry.command.clone());
    }
}

fn entries(ui: &Ui, context: &Context<'_>, query: &str) -> Vec<Entry> {
    let commands = registry::matching(query).into_iter().filter_map(|spec| {
        Some(Entry {
            named: spec.id,
            group: spec.group.title(),
            title: spec.title.to_owned(),
            keys: chord::texts(ui.ctx(), spec, context.state).into_iter().next().unwrap_or_default(),
            unavailable: (spec.available)(context.state).err(),
            command: spec.plain(context.state)?,
        })
    });
    let panels = PanelKind::ALL.iter().map(|&panel| Entry {
        named: panel.title(),
        group: "Panel",
        title: panel.title().to_owned(),
        keys: String::new(),
        unavailable: None,
        command: Command::Window(WindowCommand::ShowPanel(panel)),
    });
    let missions = context.state.library.missions().into_iter().map(|mission| Entry {
        named: "",
        group: "Mission",
        title: mission.name.to_string(),
        keys: String::new(),
        unavailable: None,
        command: Command::Library(LibraryCommand::Open(mission.id.clone())),
    });
    let examples = EXAMPLES.iter().map(|example| Entry {
        named: "",
        group: "Example",
        title: example.title.to_owned(),
        keys: String::new(),
        unavailable: None,
        command: Command::OpenExample(example.name.into()),
    });
    let others = panels.chain(missions).chain(examples).filter(|entry| score(entry, query).is_some());
    let mut entries: Vec<Entry> = commands.chain(others).collect();
    if !query.is_empty() {
        entries.sort_by_key(|entry| std::cmp::Reverse(score(entry, query)));
    }
    entries
}

fn score(entry: &Entry, query: &str) -> Option<i32> {
    registry::score_of_entry(entry.named, [entry.group, &entry.title], query)
}

fn show_entry(ui: &mut Ui, context: &Context<'_>, entry: &Entry, is_chosen: bool) -> egui::Response {
    let tokens = context.tokens;
    let size = egui::vec2(ui.available_width(), space::ROW + 2.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let is_enabled = entry.unavailable.is_none();
    response.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, is_enabled, is_chosen, &entry.title));
    let fill = match (is_chosen, response.hovered()) {
        (true, _) => Some(tokens.selection),
        (false, true) => Some(tokens.hover),
        (false, false) => None,
    };
    if let Some(fill) = fill {
        ui.painter().rect_filled(rect, 4.0, fill);
    }
    let color = if is_enabled { tokens.text } else { tokens.text_faint };
    let body = egui::TextStyle::Body.resolve(ui.style());
    let small = egui::TextStyle::Small.resolve(ui.style());
    let painter = ui.painter();
    let left = rect.left_center() + egui::vec2(space::M, 0.0);
    painter.text(left, egui::Align2::LEFT_CENTER, entry.group, small.clone(), tokens.text_muted);
    let title = left + egui::vec2(58.0, 0.0);
    painter.text(title, egui::Align2::LEFT_CENTER, &entry.title, body, color);
    let note = entry.unavailable.unwrap_or(&entry.keys);
    let right = rect.right_center() - egui::vec2(space::M, 0.0);
    painter.text(right, egui::Align2::RIGHT_CENTER, note, small, tokens.text_muted);
    response
}
