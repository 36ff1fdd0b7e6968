//! What is known about the text under the pointer: problems, signatures, bounds, windows.

use egui::{Response, RichText, TextStyle, Ui};
use mission::Problem;
use rmpl::Span;
use rmpl::editor::{Evaluation, Hover};
use theme::icon;
use theme::{Tokens, space};

use crate::Context;
use crate::problems::severity_sign;

/// Answers about places of the text, kept while nothing changes.
#[derive(Default)]
pub(crate) struct HoverCache {
    /// The revisions of the text and of the plan that the answers belong to.
    revisions: (u64, u64),
    evaluation: Evaluation,
    answered: Option<(usize, Option<Hover>)>,
}

impl HoverCache {
    fn hover(&mut self, context: &Context<'_>, offset: usize) -> Option<&Hover> {
        let shown = context.snapshot.filter(|_| !context.is_stale);
        let revisions = (context.state.document.revision(), shown.map_or(0, |shown| shown.revision));
        if self.revisions != revisions {
            self.revisions = revisions;
            self.evaluation = shown.map(|it| workbench::state::language::evaluation(it)).unwrap_or_default();
            self.answered = None;
        }
        if self.answered.as_ref().is_none_or(|(at, _)| *at != offset) {
            let parse = context.state.language.parse();
            let found = parse.and_then(|parse| rmpl::editor::hover(parse, offset as u32, &self.evaluation));
            self.answered = Some((offset, found));
        }
        self.answered.as_ref()?.1.as_ref()
    }

    /// Shows what is known at `offset` beside the pointer.
    pub(crate) fn show(
        &mut self,
        context: &Context<'_>,
        response: &Response,
        offset: Option<usize>,
        problems: &[(&Problem, Span)],
    ) {
        let Some(offset) = offset.filter(|_| context.state.editor.popup.is_none()) else { return };
        let touching: Vec<&Problem> = problems
            .iter()
            .filter(|(_, span)| span.touches(offset as u32))
            .map(|(problem, _)| *problem)
            .collect();
        let markdown = self.hover(context, offset).map(|hover| hover.markdown.clone());
        if touching.is_empty() && markdown.is_none() {
            return;
        }
        response.clone().on_hover_ui_at_pointer(|ui| {
            ui.set_max_width(460.0);
            for problem in &touching {
                show_problem(ui, context, problem);
            }
            if let Some(markdown) = &markdown {
                if !touching.is_empty() {
                    ui.separator();
                }
                show_markdown(ui, context.tokens, markdown);
            }
        });
    }
}

fn show_problem(ui: &mut Ui, context: &Context<'_>, problem: &Problem) {
    let tokens = context.tokens;
    let (sign, color) = severity_sign(tokens, problem.severity);
    ui.horizontal_top(|ui| {
        icon::label(ui, sign, color);
        ui.vertical(|ui| {
            show_markdown(ui, tokens, &problem.message);
            if let Some(hint) = &problem.hint {
                show_markdown(ui, tokens, hint);
            }
            let fix = if problem.fixes.is_empty() { "" } else { "   Ctrl+. to fix" };
            ui.label(RichText::new(format!("{}{fix}", problem.code)).small().color(tokens.text_muted));
        });
    });
}

/// The little Markdown that the language's texts use: paragraphs, lists, code in backticks or fences, bold.
pub fn show_markdown(ui: &mut Ui, tokens: &Tokens, markdown: &str) {
    let mut in_fence = false;
    for line in markdown.lines() {
        if line.trim_start().starts_with("```") {
            in_fence = !in_fence;
            continue;
        }
        if in_fence {
            ui.label(RichText::new(line).monospace().color(tokens.text));
        } else if line.trim().is_empty() {
            ui.add_space(space::XS);
        } else {
            ui.label(inline(ui, tokens, line));
        }
    }
}

/// One line: `code` in the font of code, **bold** in that of titles.
fn inline(ui: &Ui, tokens: &Tokens, line: &str) -> egui::text::LayoutJob {
    let body = TextStyle::Body.resolve(ui.style());
    let code = TextStyle::Monospace.resolve(ui.style());
    let title = line.trim_start_matches('#');
    let is_title = title.len() < line.len() && title.starts_with(' ');
    let strong = egui::FontId::new(body.size, theme::strong_family());
    let line = if is_title { title.trim_start() } else { line };
    let mut job = egui::text::LayoutJob::default();
    for (index, part) in line.split('`').enumerate() {
        if index % 2 == 1 {
            job.append(part, 0.0, egui::TextFormat::simple(code.clone(), tokens.syntax.activity));
            continue;
        }
        for (index, part) in part.split("**").enumerate() {
            let font = if index % 2 == 1 || is_title { strong.clone() } else { body.clone() };
            job.append(part, 0.0, egui::TextFormat::simple(font, tokens.text));
        }
    }
    job
}
