//! The little Markdown that short explanations use.

use egui::{RichText, TextStyle, Ui};

use crate::{Tokens, space, strong_family};

/// Shows Markdown: paragraphs, lists, code in backticks or fences, bold.
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
    let strong = egui::FontId::new(body.size, strong_family());
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
