//! What the text declares, in order; a click leads there.

use egui::{RichText, ScrollArea, Sense, Ui};
use rmpl::Span;
use rmpl::program::Program;
use text_editing::TextCommand;
use theme::{Tokens, space};
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::state::editor::EditorCommand;

use crate::{Context, Panel, keyboard_navigation, show_empty};

#[derive(Default)]
pub struct OutlinePanel {}

/// One declaration.
struct Item<'a> {
    kind: &'static str,
    name: &'a str,
    detail: String,
    span: Span,
    full: Span,
    color: egui::Color32,
}

impl Panel for OutlinePanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let Some(latest) = context.state.snapshots.latest() else { return };
        let mut items = items(&latest.program, context.tokens);
        items.sort_by_key(|item| item.full);
        if items.is_empty() {
            show_empty(ui, context, "No declarations.");
            return;
        }
        let caret = context.state.document.caret().head as u32;
        if let Some(steps) = keyboard_navigation::arrows(ui, context, PanelKind::Outline) {
            let here = items.iter().position(|item| item.full.touches(caret));
            let next = here.map_or(0, |here| here.saturating_add_signed(steps).min(items.len() - 1));
            let span = items[next].span;
            let (anchor, head) = (span.start as usize, span.end as usize);
            commands.send(Command::Text(TextCommand::Select { anchor, head }));
        }
        ScrollArea::vertical().auto_shrink(false).show_rows(
            ui,
            space::ROW - ui.spacing().item_spacing.y,
            items.len(),
            |ui, rows| {
                for item in items.get(rows).unwrap_or_default() {
                    let response = show_item(ui, context, item, item.full.touches(caret));
                    if response.clicked() {
                        commands.send(Command::Reveal(item.span));
                        commands.send(Command::Editor(EditorCommand::Focus));
                    }
                }
            },
        );
    }
}

fn items<'a>(program: &'a Program, tokens: &Tokens) -> Vec<Item<'a>> {
    let syntax = &tokens.syntax;
    let mut items = Vec::new();
    let mut add = |kind, name: &'a rmpl::program::Name, detail: String, full, color| {
        items.push(Item { kind, name: &name.text, detail, span: name.span, full, color });
    };
    let formals = |names: &[rmpl::program::Name]| {
        let names: Vec<&str> = names.iter().map(|name| name.text.as_str()).collect();
        format!("({})", names.join(", "))
    };
    for it in &program.scenarios {
        add("scenario", &it.name, String::new(), it.span, syntax.activity);
    }
    for it in &program.activities {
        add("activity", &it.name, formals(&it.formals), it.span, syntax.activity);
    }
    for it in &program.primitives {
        add("primitive", &it.name, formals(&it.formals), it.span, syntax.activity);
    }
    for it in &program.variables {
        let values: Vec<&str> = it.values.iter().map(|value| value.text.as_str()).collect();
        add("variable", &it.name, format!("{{{}}}", values.join(", ")), it.span, syntax.variable);
    }
    for it in &program.world.locations {
        let [x, y] = it.position_m;
        add("location", &it.name, format!("({x}, {y})"), it.span, syntax.place);
    }
    for it in &program.world.obstacles {
        let kind = if it.is_solid() { "obstacle" } else { "keep-out area" };
        add(kind, &it.name, String::new(), it.span, syntax.place);
    }
    for it in &program.world.vehicles {
        let detail = format!("{} at {}", it.model.text, it.start.text);
        add("vehicle", &it.name, detail, it.span, syntax.place);
    }
    items
}

fn show_item(ui: &mut Ui, context: &Context<'_>, item: &Item<'_>, is_here: bool) -> egui::Response {
    let tokens = context.tokens;
    let size = egui::vec2(ui.available_width(), space::ROW - ui.spacing().item_spacing.y);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    let name = format!("{} {}", item.kind, item.name);
    theme::structure::item(&response, is_here, &name);
    let row = rect.expand2(egui::vec2(0.0, ui.spacing().item_spacing.y / 2.0));
    if is_here {
        ui.painter().rect_filled(row, 0.0, tokens.accent_soft);
    } else if response.hovered() {
        ui.painter().rect_filled(row, 0.0, tokens.hover);
    }
    let mut content = ui.new_child(
        egui::UiBuilder::new()
            .max_rect(rect.shrink2(egui::vec2(space::M, 0.0)))
            .layout(egui::Layout::left_to_right(egui::Align::Center)),
    );
    let small = |text: &str| RichText::new(text).small().color(tokens.text_faint);
    content.add_sized(
        [60.0, rect.height()],
        egui::Label::new(small(item.kind)).selectable(false).halign(egui::Align::LEFT),
    );
    let name = RichText::new(item.name).monospace().color(item.color);
    content.add(egui::Label::new(name).selectable(false));
    let detail = RichText::new(&item.detail).small().color(tokens.text_muted);
    content.add(egui::Label::new(detail).selectable(false).truncate());
    response
}
