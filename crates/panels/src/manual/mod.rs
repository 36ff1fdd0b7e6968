//! The manual: its pages as prose, and a search over all of them.

use egui::{Button, Frame, Link, Margin, RichText, ScrollArea, TextEdit, Ui};
use theme::icon::{self, Icon};
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::manual::{self, Page};
use workbench::state::manual::ManualCommand;

use crate::lesson::{follow_link, prose};
use crate::{Context, Panel};

/// The panel, with what concerns only it: what is being looked for, and which place it has scrolled to.
#[derive(Default)]
pub struct ManualPanel {
    query: String,
    scrolled_to: u64,
}

/// Lines are not longer than can be read well.
const WIDEST: f32 = 760.0;

impl Panel for ManualPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        self.controls(ui, context, commands);
        let state = &context.state.manual;
        let is_new = self.scrolled_to != state.opened();
        let page = state.place().and_then(|(page, section)| Some((manual::page_named(page)?, section)));
        // What is found of other words begins at the top, and the page stays where it was.
        let salt = ("manual", state.query());
        let mut area = ScrollArea::vertical().auto_shrink([false, false]).id_salt(salt);
        if is_new {
            area = area.vertical_scroll_offset(0.0);
        }
        area.show(ui, |ui| {
            Frame::new().inner_margin(Margin::symmetric(14, 6)).show(ui, |ui| {
                ui.set_width(ui.available_width().min(WIDEST));
                match page {
                    _ if !state.query().is_empty() => found(ui, context, commands),
                    Some((page, section)) => show_page(ui, context, page, section, is_new, commands),
                    None => contents(ui, context, commands),
                }
            });
        });
        self.scrolled_to = state.opened();
    }
}

impl ManualPanel {
    fn controls(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let state = &context.state.manual;
        Frame::new().inner_margin(Margin::symmetric(14, 6)).show(ui, |ui| {
            ui.horizontal(|ui| {
                let can_go_back = state.can_go_back();
                if ui.add_enabled(can_go_back, Button::new("Back")).clicked() {
                    commands.send(Command::Manual(ManualCommand::Back));
                }
                let shows_contents = state.place().is_none() && state.query().is_empty();
                if ui.add_enabled(!shows_contents, Button::new("Contents")).clicked() {
                    commands.send(Command::Manual(ManualCommand::Contents));
                }
                if self.query.trim() != state.query().trim()
                    && !ui.memory(|memory| memory.has_focus(field_id()))
                {
                    state.query().clone_into(&mut self.query);
                }
                let field =
                    TextEdit::singleline(&mut self.query).id(field_id()).hint_text("Search the manual");
                let width = (ui.available_width() - space::M).clamp(60.0, 260.0);
                let response = ui.add(field.desired_width(width)).accessible_name("Search the manual");
                if response.changed() {
                    commands.send(Command::Manual(ManualCommand::Search(self.query.clone())));
                }
            });
        });
    }
}

fn field_id() -> egui::Id {
    egui::Id::unique("manual-search")
}

fn show_page(
    ui: &mut Ui,
    context: &Context<'_>,
    page: &Page,
    section: &str,
    is_new: bool,
    commands: &mut CommandSender,
) {
    let prose = prose(context);
    let target = if is_new && !section.is_empty() { page.document.heading(section) } else { None };
    for (at, block) in page.document.blocks.iter().enumerate() {
        let (response, clicked) = prose.show_block(ui, block);
        follow_link(clicked, page.name, commands);
        if target == Some(at) {
            response.scroll_to_me(Some(egui::Align::Min));
        }
    }
}

fn contents(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    theme::structure::mark_heading(&ui.heading("Manual"), 2);
    for pages in manual::pages().chunk_by(|left, right| left.group == right.group) {
        ui.add_space(space::M);
        theme::structure::heading(ui, theme::strong(pages[0].group).color(context.tokens.text), 3);
        for page in pages {
            ui.horizontal(|ui| {
                icon::label(ui, Icon::ChevronRight, context.tokens.text_faint);
                if ui.add(Button::new(&page.title).frame_when_inactive(false).wrap()).clicked() {
                    commands.send(Command::Manual(ManualCommand::Open(page.name, String::new())));
                }
            });
        }
    }
}

fn found(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let state = &context.state.manual;
    if state.found().is_empty() {
        let text = format!("No results for “{}”", state.query());
        ui.add(egui::Label::new(RichText::new(text).color(context.tokens.text_muted)).wrap());
    }
    for place in state.found() {
        let title = RichText::new(&place.title).color(context.tokens.accent);
        if ui.add(Link::new(title)).clicked() {
            commands.send(Command::Manual(ManualCommand::Open(place.page, place.section.clone())));
        }
        ui.add(egui::Label::new(RichText::new(&place.excerpt).color(context.tokens.text_muted)).wrap());
        ui.add_space(space::S);
    }
}
