//! The bar below: the selection, the caret, problems, timings, the renderer.

use egui::{Align, Button, Frame, Layout, Margin, Panel, RichText, Ui};
use panels::Context;
use panels::counted;
use rmpl::Severity;
use theme::icon::{self, Icon};
use theme::space;
use theme::structure;
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::library::Keeping;
use workbench::library::LibraryCommand;
use workbench::state::window::WindowCommand;

/// Shows the bar.
pub fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let frame = Frame::new().fill(tokens.background).inner_margin(Margin::symmetric(10, 0));
    Panel::bottom("status-bar").exact_size(24.0).show_separator_line(false).frame(frame).show(ui, |ui| {
        structure::part(ui, egui::accesskit::Role::ContentInfo, "");
        ui.style_mut().override_text_style = Some(egui::TextStyle::Small);
        ui.horizontal_centered(|ui| {
            problems(ui, context, commands);
            keeping(ui, context, commands);
            caret(ui, context);
            selection(ui, context);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| figures(ui, context));
        });
    });
}

fn problems(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let count = |severity: Severity| {
        context.state.snapshots.problems().iter().filter(|it| it.severity == severity).count()
    };
    let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
    let color = match (errors, warnings) {
        (0, 0) => tokens.text_muted,
        (0, _) => tokens.warning,
        _ => tokens.error,
    };
    let name = format!("{}, {}", counted(errors as u64, "error"), counted(warnings as u64, "warning"));
    let font = egui::TextStyle::Small.resolve(ui.style());
    let counts =
        [errors, warnings].map(|count| ui.painter().layout_no_wrap(count.to_string(), font.clone(), color));
    let width = 58.0 + counts.iter().map(|count| count.size().x).sum::<f32>();
    let (rect, response) = ui.allocate_exact_size(egui::vec2(width, space::ROW), egui::Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 4.0, tokens.hover);
    }
    let mut x = rect.left() + 10.0;
    for (sign, count) in [Icon::Error, Icon::Warning].into_iter().zip(counts) {
        let at = egui::pos2(x, rect.center().y);
        icon::paint(ui.painter(), sign, egui::Rect::from_center_size(at, egui::Vec2::ZERO), 11.0, color);
        let size = count.size();
        ui.painter().galley(egui::pos2(x + 9.0, rect.center().y - size.y / 2.0), count, color);
        x += 25.0 + size.x;
    }
    if response.on_hover_text(name.clone()).clicked() {
        commands.send(Command::Window(WindowCommand::ShowPanel(PanelKind::Problems)));
    }
}

/// What a private window does with missions.
const PRIVATE: &str = "The browser deletes the missions when this window closes";

/// Says when something is not kept; that everything is, no one needs to be told.
fn keeping(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let (text, reason, color) = match &context.state.library.keeping {
        Keeping::Kept | Keeping::Opening => return,
        Keeping::UntilClosed => ("Private window", PRIVATE, tokens.warning),
        Keeping::LatestOnly(reason) => ("Only the latest text is saved", reason.as_str(), tokens.warning),
        Keeping::Nothing(reason) => ("Not saved", reason.as_str(), tokens.error),
    };
    let button = Button::new(RichText::new(text).color(color));
    if ui.add(button).on_hover_text(format!("{reason}. Click to save the mission to a file.")).clicked() {
        commands.send(Command::Library(LibraryCommand::SaveMissionFile));
    }
}

fn caret(ui: &mut Ui, context: &Context<'_>) {
    let document = &context.state.document;
    let head = document.caret().head;
    let line = document.line_in_file(document.line_at(head));
    let place = format!("Ln {line}, Col {}", document.column_at(head) + 1);
    ui.label(RichText::new(place).color(context.tokens.text_muted));
    let selected = document.selected_text().chars().count();
    if selected > 0 {
        ui.label(RichText::new(format!("({selected} selected)")).color(context.tokens.text_muted));
    }
}

fn selection(ui: &mut Ui, context: &Context<'_>) {
    let network = context.snapshot.and_then(|snapshot| snapshot.network.as_deref());
    let name = context.state.selection.name(network);
    if !name.is_empty() {
        ui.add_space(space::S);
        let name = egui::Label::new(RichText::new(name).color(context.tokens.accent));
        ui.add(name.truncate());
    }
}

fn figures(ui: &mut Ui, context: &Context<'_>) {
    let tokens = context.tokens;
    // What has no room is left out, the last ones first.
    let mut faint = |text: String| {
        let font = egui::TextStyle::Small.resolve(ui.style());
        let galley = ui.painter().layout_no_wrap(text.clone(), font, tokens.text_faint);
        if galley.size().x + space::S <= ui.available_width() {
            ui.label(RichText::new(text).color(tokens.text_faint));
        }
    };
    let frame = &context.state.frame;
    if !frame.renderer.is_empty() {
        faint(frame.renderer_name().to_owned());
    }
    let Some(snapshot) = context.snapshot else { return };
    let timings = snapshot.timings;
    let text = format!(
        "parse {:.1}  compile {:.1}  plan {:.1} ms",
        timings.parse_millis, timings.compile_millis, timings.plan_millis
    );
    faint(text);
    if let Some((events, constraints)) = snapshot.size() {
        faint(format!("{}  {}", counted(events as u64, "event"), counted(constraints as u64, "constraint")));
    }
    faint(format!("revision {}", context.state.document.revision()));
}
