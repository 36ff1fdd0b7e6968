//! What is wrong with the text: a list that leads to the places, offers fixes and explains.

use editor::Severity;
use egui::{ScrollArea, Sense, Ui};
use rmpl::Span;
use snapshot::Problem;
use text_editing::{EditKind, TextCommand};
use theme::icon;
use theme::space;
use workbench::Dialog;
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::manual;
use workbench::sentence;
use workbench::state::editor::EditorCommand;
use workbench::state::manual::ManualCommand;
use workbench::state::no_plan::NO_PLAN;
use workbench::state::window::WindowCommand;

use crate::{Context, Panel, inline_code, keyboard_navigation, show_empty, without_backticks};

/// The list of problems.
#[derive(Default)]
pub struct ProblemsPanel {
    /// The problem whose details are open, by its place in the list.
    open: Option<usize>,
}

impl Panel for ProblemsPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let latest = context.state.snapshots.latest();
        let problems = context.state.snapshots.problems();
        if problems.is_empty() {
            let text = if latest.is_some() { "No problems." } else { "Checking…" };
            show_empty(ui, context, text);
            return;
        }
        // Answers belong to the text they were given for; fixes of an older one would land in the wrong place.
        let is_current = latest.is_some_and(|it| it.revision == context.state.document.revision());
        let selected = selected_span(context);
        if let Some(steps) = keyboard_navigation::arrows(ui, context, PanelKind::Problems) {
            let last = problems.len() - 1;
            let next = self.open.map_or(0, |open| open.saturating_add_signed(steps).min(last));
            self.open = Some(next);
            let span = problems[next].span;
            let (anchor, head) = (span.start as usize, span.end as usize);
            commands.send(Command::Text(TextCommand::Select { anchor, head }));
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.add_space(space::S);
            for (index, problem) in problems.iter().enumerate() {
                ui.push_id(index, |ui| {
                    let concerns =
                        |span: Span| span.start <= problem.span.end && problem.span.start <= span.end;
                    let is_selected =
                        self.open == Some(index) || is_current && selected.is_some_and(concerns);
                    let row = show_row(ui, context, problem, is_selected);
                    if row.clicked() {
                        commands.send(Command::Reveal(problem.span));
                        commands.send(Command::Editor(EditorCommand::Focus));
                        self.open = if self.open == Some(index) { None } else { Some(index) };
                    }
                    if self.open == Some(index) {
                        show_details(ui, context, problem, is_current, commands);
                    }
                });
            }
        });
    }
}

/// Returns how bad a problem is, for the editor and for whoever shows its sign.
pub const fn severity(of: rmpl::Severity) -> Severity {
    match of {
        rmpl::Severity::Error => Severity::Error,
        rmpl::Severity::Warning => Severity::Warning,
        rmpl::Severity::Note => Severity::Note,
    }
}

/// Returns where what is selected is written. A whole scenario or activity would be about every problem in it.
fn selected_span(context: &Context<'_>) -> Option<Span> {
    let snapshot = context.snapshot.filter(|_| !context.is_stale)?;
    let span = context.state.selection.span(snapshot)?;
    let is_short = snapshot.source.get(span.range()).is_some_and(|text| text.lines().count() <= 3);
    is_short.then_some(span)
}

fn show_row(ui: &mut Ui, context: &Context<'_>, problem: &Problem, is_selected: bool) -> egui::Response {
    let tokens = context.tokens;
    let (sign, color) = severity(problem.severity).sign(tokens);
    let body = egui::TextStyle::Body.resolve(ui.style());
    let small = egui::TextStyle::Small.resolve(ui.style());
    let width = ui.available_width();
    let text_width = (width - 28.0 - 120.0).max(80.0);
    let message = inline_code::job(&problem.message, &body, tokens.text, text_width);
    let message = ui.painter().layout_job(message);
    let height = (message.size().y + 6.0).max(space::ROW);
    let (rect, response) = ui.allocate_exact_size(egui::vec2(width, height), Sense::click());
    let name = format!("Line {}: {} {}", problem.line, problem.code, without_backticks(&problem.message));
    theme::structure::item(&response, is_selected, &name);
    if is_selected {
        ui.painter().rect_filled(rect, 0.0, tokens.selection);
    } else if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 0.0, tokens.hover);
    }
    let painter = ui.painter();
    let top = rect.left_top() + egui::vec2(space::M, 3.0);
    let sign_rect = egui::Rect::from_min_size(top, egui::vec2(14.0, 16.0));
    icon::paint(painter, sign, sign_rect, 13.0, color);
    painter.galley(top + egui::vec2(20.0, 0.0), message, tokens.text);
    let file = problem.file.as_ref().map_or_else(String::new, |file| format!("{file}:"));
    let place = format!("{}   {file}{}:{}", problem.code, problem.line, problem.column);
    let right = rect.right_top() + egui::vec2(-space::M, 5.0);
    painter.text(right, egui::Align2::RIGHT_TOP, place, small, tokens.text_muted);
    response
}

fn show_details(
    ui: &mut Ui,
    context: &Context<'_>,
    problem: &Problem,
    is_current: bool,
    commands: &mut CommandSender,
) {
    ui.indent("details", |ui| {
        if let Some(hint) = &problem.hint {
            let font = egui::TextStyle::Body.resolve(ui.style());
            ui.label(inline_code::job(hint, &font, context.tokens.text_muted, ui.available_width()));
        }
        let is_of_plan = problem.code == NO_PLAN;
        let explain = if is_of_plan { "Show why" } else { "Explain" };
        if ui.add(egui::Button::new(explain).frame_when_inactive(false)).clicked() {
            commands.send(if is_of_plan {
                Command::Window(WindowCommand::ShowPanel(PanelKind::Plan))
            } else {
                Command::Window(WindowCommand::ShowDialog(Dialog::Explain(problem.code.clone())))
            });
        }
        if is_of_plan
            && ui.add(egui::Button::new("Open in manual").frame_when_inactive(false)).clicked()
            && let Some((page, section)) = manual::about_code(&problem.code)
        {
            commands.send(Command::Manual(ManualCommand::Open(page, section)));
        }
        for fix in &problem.fixes {
            let label = without_backticks(&fix.label);
            let button = ui.add_enabled(is_current, egui::Button::new(sentence(&label)));
            if button.accessible_name(format!("Fix: {label}")).clicked() {
                commands.send(Command::Edit { edits: fix.edits.clone(), kind: EditKind::Single });
            }
        }
    });
}
