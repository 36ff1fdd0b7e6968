//! Prose as it is read: headings, paragraphs, lists, tables and code, wrapped to the room there is, with links.
//!
//! What a link means is the caller's: it hears which one was clicked, and says what its hover shows. Short explanations
//! in popups use [`show_markdown`](crate::show_markdown) instead.

mod table;
mod words;

use egui::{Frame, Margin, Response, RichText, ScrollArea, Ui};
use markdown::{Block, Content};

use crate::{Tokens, size, space};
use words::{Look, show_words};

/// How prose looks, and what its links lead to.
#[derive(Clone, Copy)]
pub struct Prose<'a> {
    pub tokens: &'a Tokens,
    /// What the hover of a link shows; nothing for links that show nothing.
    pub hover: &'a dyn Fn(&str) -> Option<&'a [Block]>,
}

/// Prose is a little larger than what is on buttons.
const TEXT: f32 = size::BODY + 1.0;
const CODE: f32 = size::CODE;
/// Sizes of headings by level.
const HEADINGS: [f32; 3] = [20.0, 17.0, 15.0];
/// A popup over a link is no wider.
const POPUP: f32 = 380.0;

impl Prose<'_> {
    /// Shows blocks below each other. Returns the link that was clicked, if one was.
    pub fn show(&self, ui: &mut Ui, blocks: &[Block]) -> Option<String> {
        let mut clicked = None;
        for block in blocks {
            clicked = self.show_block(ui, block).1.or(clicked);
        }
        clicked
    }

    /// Shows a block, with the room that it needs below. Returns where it is, and the link that was clicked.
    pub fn show_block(&self, ui: &mut Ui, block: &Block) -> (Response, Option<String>) {
        let mut clicked = None;
        let shown = ui.scope(|ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            clicked = self.content(ui, block);
        });
        (shown.response, clicked)
    }

    fn content(&self, ui: &mut Ui, block: &Block) -> Option<String> {
        let tokens = self.tokens;
        match &block.content {
            Content::Heading { level, text } => {
                let index = usize::from(*level).saturating_sub(1).min(HEADINGS.len() - 1);
                ui.add_space(if *level == 1 { space::S } else { space::M });
                let look = Look { size: HEADINGS[index], is_strong: true, color: tokens.text };
                let clicked = show_words(ui, self, text, look, Some(*level));
                ui.add_space(space::M);
                clicked
            }
            Content::Paragraph(text) => {
                let clicked = show_words(ui, self, text, self.look(), None);
                ui.add_space(space::M + space::XS);
                clicked
            }
            Content::Code { text, .. } => {
                show_code(ui, tokens, text, block.line);
                ui.add_space(space::M + space::XS);
                None
            }
            Content::List { first, items } => self.list(ui, *first, items),
            Content::Quote(blocks) => {
                let mut clicked = None;
                Frame::new().inner_margin(Margin { left: 12, ..Margin::ZERO }).show(ui, |ui| {
                    clicked = self.show(ui, blocks);
                });
                clicked
            }
            Content::Table { head, rows } => {
                let clicked = table::show(ui, self, head, rows);
                ui.add_space(space::M + space::XS);
                clicked
            }
            Content::Rule => {
                ui.add_space(space::S);
                ui.separator();
                ui.add_space(space::M);
                None
            }
        }
    }

    fn look(&self) -> Look {
        Look { size: TEXT, is_strong: false, color: self.tokens.text }
    }

    fn list(&self, ui: &mut Ui, first: Option<u64>, items: &[Vec<Block>]) -> Option<String> {
        let mut clicked = None;
        for (item, at) in items.iter().zip(0_u64..) {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = space::S;
                let sign = first.map_or_else(|| "•".to_owned(), |first| format!("{}.", first + at));
                ui.label(RichText::new(sign).size(TEXT).color(self.tokens.text_muted));
                ui.vertical(|ui| clicked = self.show(ui, item).or(clicked.take()));
            });
        }
        clicked
    }

    /// What the hover of a link shows. Returns the link in there that was clicked, or this one if it was.
    fn show_hover(&self, response: Response, link: &str) -> Option<String> {
        let mut clicked = response.clicked().then(|| link.to_owned());
        if let Some(blocks) = (self.hover)(link) {
            response.on_hover_ui(|ui| {
                ui.set_max_width(POPUP);
                clicked = self.show(ui, blocks).or(clicked.take());
            });
        }
        clicked
    }
}

/// Lines of code as they are; long ones can be scrolled to.
fn show_code(ui: &mut Ui, tokens: &Tokens, text: &str, line: u32) {
    let frame = Frame::new().fill(tokens.sunken).corner_radius(4.0).inner_margin(Margin::same(8));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ScrollArea::horizontal().id_salt(("code", line)).auto_shrink([false, true]).show(ui, |ui| {
            let text = RichText::new(text.trim_end()).monospace().size(CODE).color(tokens.text);
            ui.add(egui::Label::new(text).extend());
        });
    });
}
