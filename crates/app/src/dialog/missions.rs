//! The list of missions: to open, begin, name, copy, delete and bring back.

use egui::{Align, Key, Layout, Rect, RichText, ScrollArea, Sense, Stroke, StrokeKind, TextEdit, Ui, Vec2};
use panels::{Context, counted};
use theme::space;
use workbench::Dialog;
use workbench::command::{Command, CommandSender};
use workbench::host::FileKind;
use workbench::lesson::TOUR;
use workbench::library::LibraryCommand;
use workbench::library::{Keeping, Mission, MissionId, TEMPLATES};
use workbench::mission_file::{self, EXAMPLES, Example};
use workbench::state::lesson::LessonCommand;
use workbench::state::window::WindowCommand;

const WIDTH: f32 = 720.0;
const ROW: f32 = 48.0;
const PICTURE: Vec2 = Vec2::new(72.0, 36.0);
/// The least width of an example, and its height.
const CARD: Vec2 = Vec2::new(210.0, 132.0);
const CARD_PICTURE: f32 = 44.0;
/// The greatest height of a bar in a picture.
const MAX_BAR: f32 = 11.0;
/// The seconds in which the time of a picture runs from start to end.
const CARD_SECS: f64 = 4.0;

/// What the list asks for; it is sent when everything is shown.
type Renaming = Option<(MissionId, String)>;

/// Shows the list.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    query: &str,
    renaming: &Renaming,
    commands: &mut CommandSender,
) {
    let screen = ui.ctx().content_rect().size();
    ui.set_width(WIDTH.min(screen.x - 64.0));
    let mut query = query.to_owned();
    let mut renaming = renaming.clone();
    let before = (query.clone(), renaming.clone());
    heading(ui, context, &mut query, commands);
    keeping(ui, context, commands);
    ui.add_space(space::S);
    let found = |name: &str| name.to_lowercase().contains(&query.trim().to_lowercase());
    // Fewer missions take less room; more of them have all of it, however small the list was before.
    let height = (screen.y - 240.0).max(160.0);
    let area = ScrollArea::vertical().min_scrolled_height(height).max_height(height);
    area.auto_shrink([false, true]).show(ui, |ui| {
        let missions = context.state.library.missions();
        if missions.is_empty() {
            let text = "You have no missions yet. Edit an example to save it as your own.";
            ui.label(RichText::new(text).color(context.tokens.text_muted));
        }
        for mission in missions.into_iter().filter(|mission| found(&mission.name)) {
            ui.push_id(&mission.id.0, |ui| row(ui, context, mission, &mut renaming, commands));
        }
        versions(ui, context, commands);
        examples(ui, context, &found, commands);
        deleted(ui, context, commands);
        unreadable(ui, context, commands);
    });
    if (&query, &renaming) != (&before.0, &before.1) {
        commands.send(Command::Window(WindowCommand::ShowDialog(Dialog::Missions { query, renaming })));
    }
}

fn heading(ui: &mut Ui, context: &Context<'_>, query: &mut String, commands: &mut CommandSender) {
    let library = &context.state.library;
    let last = library.missions().into_iter().next().filter(|last| library.open_id() != Some(&last.id));
    ui.horizontal(|ui| {
        theme::structure::mark_heading(&ui.heading("Missions"), 2);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.button("Close").clicked() {
                commands.send(Command::Window(WindowCommand::CloseDialog));
            }
        });
    });
    ui.add_space(space::S);
    ui.horizontal(|ui| {
        if let Some(last) = last
            && ui.button("Continue").on_hover_text(format!("Open {}, modified last", last.name)).clicked()
        {
            commands.send(Command::Library(LibraryCommand::Open(last.id.clone())));
        }
        if ui.button("New mission").clicked() {
            commands.send(Command::Library(LibraryCommand::New(&TEMPLATES[0])));
        }
        ui.menu_button("From a template", |ui| {
            for template in TEMPLATES.iter().filter(|template| !template.source.is_empty()) {
                if ui.button(template.title).on_hover_text(template.about).clicked() {
                    commands.send(Command::Library(LibraryCommand::New(template)));
                    ui.close();
                }
            }
            ui.separator();
            for example in EXAMPLES {
                if ui.button(example.title).clicked() {
                    commands.send(Command::Library(LibraryCommand::NewFromExample(example.name.into())));
                    ui.close();
                }
            }
        });
        if ui
            .button("Take the tour")
            .on_hover_text("Plan, break, fix and drive a mission in five minutes")
            .clicked()
        {
            commands.send(Command::Lesson(LessonCommand::Open(TOUR.name.into(), 0)));
        }
        if ui.button("Open file…").clicked() {
            commands.send(Command::Window(WindowCommand::OpenFile(FileKind::Mission)));
        }
        let field = TextEdit::singleline(query).hint_text("Search missions").desired_width(f32::INFINITY);
        ui.add(field).accessible_name("Search missions");
    });
}

/// What the user must know of keeping.
fn keeping(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let (text, color) = match &context.state.library.keeping {
        Keeping::Kept => return,
        Keeping::Opening => ("Loading your missions…".to_owned(), tokens.info),
        Keeping::UntilClosed => {
            let text = "Private window: the browser deletes your missions when the window closes.";
            (text.to_owned(), tokens.warning)
        }
        Keeping::LatestOnly(reason) => {
            (format!("Only your latest text is saved, without maps and versions: {reason}."), tokens.warning)
        }
        Keeping::Nothing(reason) => (format!("Closing this window loses your work: {reason}."), tokens.error),
    };
    ui.add_space(space::S);
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(text).color(color));
        if context.state.library.keeping != Keeping::Opening && ui.button("Save mission to file").clicked() {
            commands.send(Command::Library(LibraryCommand::SaveMissionFile));
        }
    });
}

fn row(
    ui: &mut Ui,
    context: &Context<'_>,
    mission: &Mission,
    renaming: &mut Renaming,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let is_open = context.state.library.open_id() == Some(&mission.id);
    let size = egui::vec2(ui.available_width(), ROW);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let label = format!("Open {}", mission.name);
    theme::structure::item(&response, is_open, &label);
    let fill = match (is_open, response.hovered() || response.has_focus()) {
        (true, _) => Some(tokens.selection),
        (false, true) => Some(tokens.hover),
        (false, false) => None,
    };
    if let Some(fill) = fill {
        ui.painter().rect_filled(rect, 4.0, fill);
    }
    if response.clicked() {
        commands.send(Command::Library(LibraryCommand::Open(mission.id.clone())));
    }
    let place = Rect::from_min_size(rect.left_top() + egui::vec2(6.0, (ROW - PICTURE.y) / 2.0), PICTURE);
    picture(ui, context, place, &mission.picture);
    let inner = Rect::from_min_max(egui::pos2(place.right() + space::M, rect.top()), rect.max);
    let layout = Layout::right_to_left(Align::Center);
    let mut ui = ui
        .new_child(egui::UiBuilder::new().max_rect(inner.shrink2(egui::vec2(space::S, 0.0))).layout(layout));
    let ui = &mut ui;
    let named = |text: &str| format!("{text} {}", mission.name);
    if ui.button("Delete").accessible_name(named("Delete")).clicked() {
        commands.send(Command::Library(LibraryCommand::Delete(Some(mission.id.clone()))));
    }
    if ui.button("Duplicate").accessible_name(named("Duplicate")).clicked() {
        commands.send(Command::Library(LibraryCommand::Duplicate(Some(mission.id.clone()))));
    }
    if ui.button("Rename").accessible_name(named("Rename")).clicked() {
        *renaming = Some((mission.id.clone(), mission.name.to_string()));
    }
    ui.with_layout(Layout::top_down(Align::Min), |ui| {
        ui.add_space(5.0);
        match renaming.clone().filter(|(id, _)| *id == mission.id) {
            Some((id, mut name)) => {
                let field = ui.add(TextEdit::singleline(&mut name).desired_width(f32::INFINITY));
                let field = field.accessible_name("New mission name");
                let enter = ui.input(|input| input.key_pressed(Key::Enter));
                if enter || field.lost_focus() {
                    commands.send(Command::Library(LibraryCommand::Rename { id: Some(id), name }));
                    *renaming = None;
                } else {
                    field.request_focus();
                    *renaming = Some((id, name));
                }
            }
            None => {
                ui.add(egui::Label::new(theme::strong(mission.name.as_str())).truncate().selectable(false));
            }
        }
        let about = RichText::new(about(context, mission)).small().color(tokens.text_muted);
        ui.add(egui::Label::new(about).truncate().selectable(false));
    });
}

/// When a mission was changed, and what it has.
fn about(context: &Context<'_>, mission: &Mission) -> String {
    let changed = when(mission.changed_millis, context.state.frame.unix_millis);
    let count = |count: usize, noun: &str| (count > 0).then(|| counted(count as u64, noun));
    let kind = mission.kind.title();
    let parts = [
        (!kind.is_empty()).then(|| kind.to_owned()),
        Some(format!("modified {changed}")),
        Some(format!("created {}", when(mission.created_millis, context.state.frame.unix_millis))),
        count(mission.maps.len(), "map"),
        count(mission.versions.len(), "version"),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(" · ")
}

/// A moment as people say it: how long ago, or the date.
fn when(millis: i64, now_millis: i64) -> String {
    let minutes = (now_millis - millis).max(0) / 60_000;
    match minutes {
        0 => "just now".to_owned(),
        1..60 => format!("{minutes} min ago"),
        60..1440 => format!("{} h ago", minutes / 60),
        _ => report::calendar::utc_text(millis).chars().take(10).collect(),
    }
}

/// The plan as bars over time.
fn picture(ui: &Ui, context: &Context<'_>, place: Rect, bars: &[[u16; 3]]) {
    let tokens = context.tokens;
    ui.painter().rect_filled(place, 3.0, tokens.sunken);
    let rows = bars.iter().map(|&[_, _, row]| row).max().map_or(1.0, |last| f32::from(last) + 1.0);
    let inner = place.shrink(3.0);
    let height = (inner.height() / rows).min(MAX_BAR);
    // Few rows are in the middle.
    let first = inner.center().y - rows * height / 2.0;
    for &[start, end, row] in bars {
        let x = |share: u16| inner.left() + inner.width() * f32::from(share.min(1000)) / 1000.0;
        let top = first + f32::from(row) * height;
        let bar = Rect::from_min_max(
            egui::pos2(x(start), top),
            egui::pos2(x(end).max(x(start) + 1.5), top + (height - 1.0).max(1.0)),
        );
        ui.painter().rect_filled(bar, 1.0, tokens.series[usize::from(row) % tokens.series.len()]);
    }
}

fn section(ui: &mut Ui, context: &Context<'_>, title: &str) {
    ui.add_space(space::L);
    ui.label(theme::strong(title).color(context.tokens.text_muted));
    ui.add_space(space::XS);
}

fn versions(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let Some(open) = context.state.library.open_mission() else { return };
    section(ui, context, &format!("Versions of {}", open.name));
    for (index, version) in open.versions.iter().enumerate().rev() {
        ui.horizontal(|ui| {
            let back = ui.button("Restore").accessible_name(format!("Restore {}", version.name));
            if back.clicked() {
                commands.send(Command::Library(LibraryCommand::RestoreVersion(index)));
            }
            ui.label(version.name.as_str());
            let kept = when(version.at_millis, context.state.frame.unix_millis);
            ui.label(RichText::new(kept).small().color(context.tokens.text_muted));
        });
    }
    if ui.button("Save version…").clicked() {
        commands
            .send(Command::Window(WindowCommand::ShowDialog(Dialog::VersionName { name: String::new() })));
    }
}

fn examples(ui: &mut Ui, context: &Context<'_>, found: &dyn Fn(&str) -> bool, commands: &mut CommandSender) {
    section(ui, context, "Examples");
    let room = ui.available_width();
    let columns = (room / CARD.x).floor().max(1.0);
    let width = (room - (columns - 1.0) * space::M) / columns;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = Vec2::splat(space::M);
        let is_found = |example: &&Example| found(example.title) || found(example.about);
        for example in EXAMPLES.iter().filter(is_found) {
            card(ui, context, example, width - 0.5, commands);
        }
    });
}

/// An example: its plan, its title, and what it shows. While the pointer is over it, its time runs.
fn card(ui: &mut Ui, context: &Context<'_>, example: &Example, width: f32, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let is_open = context.state.library.open_id().is_none() && context.state.mission == example.name;
    let (rect, response) = ui.allocate_exact_size(egui::vec2(width, CARD.y), Sense::click());
    theme::structure::item(&response, is_open, example.title);
    let is_pointed = response.hovered() || response.has_focus();
    let fill = match (is_open, is_pointed) {
        (true, _) => tokens.selection,
        (false, true) => tokens.hover,
        (false, false) => tokens.raised,
    };
    let line = if is_pointed { tokens.accent } else { tokens.line };
    ui.painter().rect(rect, 6.0, fill, Stroke::new(1.0, line), StrokeKind::Inside);
    let inner = rect.shrink(space::M);
    let place = inner.with_max_y(inner.top() + CARD_PICTURE);
    let bars = mission_file::example_picture(example.name);
    picture(ui, context, place, bars);
    if bars.is_empty() {
        let is_control = rmpl::control::is_control_text(example.source);
        let text = if is_control { "control program" } else { "no plan" };
        let font = egui::TextStyle::Small.resolve(ui.style());
        ui.painter().text(place.center(), egui::Align2::CENTER_CENTER, text, font, tokens.text_muted);
    } else if is_pointed && !context.state.system.reduces_motion {
        let share = (context.now_secs / CARD_SECS).fract() as f32;
        let x = place.left() + 3.0 + (place.width() - 6.0) * share;
        ui.painter().rect_filled(place.with_min_x(x), 3.0, fill.gamma_multiply(0.6));
        ui.painter().vline(x, place.y_range(), Stroke::new(1.5, tokens.accent));
        ui.ctx().request_repaint();
    }
    let text = inner.with_min_y(place.bottom() + space::S);
    let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(text).layout(Layout::top_down(Align::Min)));
    ui.shrink_clip_rect(text.expand(1.0));
    ui.spacing_mut().item_spacing.y = 2.0;
    let font = egui::TextStyle::Body.resolve(ui.style());
    let (title, _) = ui.allocate_exact_size(egui::vec2(text.width(), font.size * 1.3), Sense::hover());
    ui.painter().text(title.left_top(), egui::Align2::LEFT_TOP, example.title, font, tokens.text);
    let about = RichText::new(example.about).small().color(tokens.text_muted);
    ui.add(egui::Label::new(about).wrap().selectable(false));
    if response.clicked() {
        commands.send(Command::OpenExample(example.name.into()));
    }
}

fn deleted(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let deleted = context.state.library.deleted();
    if deleted.is_empty() {
        return;
    }
    section(ui, context, "Recently deleted (30 days)");
    for mission in deleted {
        ui.horizontal(|ui| {
            let back = ui.button("Restore").accessible_name(format!("Restore {}", mission.name));
            if back.clicked() {
                commands.send(Command::Library(LibraryCommand::Restore(Some(mission.id.clone()))));
            }
            ui.label(mission.name.as_str());
        });
    }
}

fn unreadable(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let unreadable = &context.state.library.unreadable;
    if unreadable.is_empty() {
        return;
    }
    section(ui, context, "Saved, but can't be opened");
    for (index, one) in unreadable.iter().enumerate() {
        ui.horizontal(|ui| {
            if ui.button("Save to file").clicked() {
                commands.send(Command::Library(LibraryCommand::SaveUnreadable(index)));
            }
            ui.add(egui::Label::new(format!("{}: {}", one.key, one.reason)).truncate());
        });
    }
}
