//! Dialogs over the panels: the command palette, the key list, going to a line, explanations.

mod about;
mod epoch;
mod explain;
mod go_to_line;
mod keys;
mod palette;
mod rename;

use egui::{Align2, Area, Frame, Id, Order};
use smol_str::SmolStr;

use crate::command::{Command, CommandSender};
use crate::panel::Context;
use crate::state::documents::ScheduleForm;
use crate::theme::space;

/// Which dialog is open, and what the user has entered in it.
#[derive(Clone, Debug, PartialEq)]
pub enum Dialog {
    /// Finds commands by name.
    Palette {
        /// What was typed.
        query: String,
        /// Which of the found commands Enter runs.
        chosen: usize,
    },
    /// Asks for a line number.
    GoToLine {
        /// What was typed.
        line: String,
    },
    /// Asks for a new name.
    Rename {
        /// The name as it is.
        old: String,
        /// What was typed.
        name: String,
    },
    /// Asks when the mission starts.
    Epoch {
        /// The schedule that is to be written.
        form: ScheduleForm,
        /// What was typed.
        epoch: String,
    },
    /// Explains a kind of problem.
    Explain(SmolStr),
    /// Lists all keys.
    Keys,
    /// What this program is.
    About,
}

impl Dialog {
    /// Its name for programs.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Palette { .. } => "palette",
            Self::GoToLine { .. } => "go-to-line",
            Self::Rename { .. } => "rename",
            Self::Epoch { .. } => "epoch",
            Self::Explain(_) => "explain",
            Self::Keys => "keys",
            Self::About => "about",
        }
    }

    /// An empty palette.
    pub fn palette() -> Self {
        Self::Palette { query: String::new(), chosen: 0 }
    }

    /// An empty question for a line.
    pub fn go_to_line() -> Self {
        Self::GoToLine { line: String::new() }
    }
}

/// Shows the open dialog, if there is one.
pub fn show(egui: &egui::Context, context: &Context<'_>, commands: &mut CommandSender) {
    let Some(dialog) = &context.state.dialog else { return };
    let is_list = matches!(dialog, Dialog::Palette { .. } | Dialog::GoToLine { .. } | Dialog::Rename { .. });
    let anchor = if is_list { Align2::CENTER_TOP } else { Align2::CENTER_CENTER };
    let offset = if is_list { egui::vec2(0.0, 72.0) } else { egui::Vec2::ZERO };
    let id = Id::unique("dialog");
    let area = Area::new(id).order(Order::Foreground).anchor(anchor, offset).constrain(true);
    let modal = egui::Modal::new(id)
        .area(area)
        .backdrop_color(context.tokens.shadow)
        .frame(Frame::window(&egui.style_of(egui.theme())).inner_margin(space::L));
    let answer = modal.show(egui, |ui| match dialog {
        Dialog::Palette { query, chosen } => palette::show(ui, context, query, *chosen, commands),
        Dialog::GoToLine { line } => go_to_line::show(ui, context, line, commands),
        Dialog::Rename { old, name } => rename::show(ui, context, old, name, commands),
        Dialog::Epoch { form, epoch } => epoch::show(ui, context, *form, epoch, commands),
        Dialog::Explain(code) => explain::show(ui, context, code, commands),
        Dialog::Keys => keys::show(ui, context, commands),
        Dialog::About => about::show(ui, context, commands),
    });
    if answer.should_close() {
        commands.send(Command::CloseDialog);
    }
}
