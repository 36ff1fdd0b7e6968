//! The window around the mission: its workspace, panels, dialog and messages, and what it and the host are to do.

use link::Request;
use rmpl::Span;

use crate::dialog::Dialog;
use crate::effect::Effect;
use crate::host::FileKind;
use crate::panel_effect::{PanelEffect, PanelEffects, PictureFormat, ViewAction};
use crate::panel_kind::PanelKind;
use crate::state::editor::Reveal;
use crate::state::toast::{ToastKind, Toasts};
use crate::workspace::Workspace;

/// The window as it stands, and what commands have left to be done.
#[derive(Debug)]
pub struct Window {
    /// Which workspace is shown.
    pub workspace: Workspace,
    /// The panel that was used last; view actions go to it.
    pub active_panel: PanelKind,
    /// The panel that has the window to itself, if one has.
    pub maximized: Option<PanelKind>,
    /// The panels that were on screen in the last frame, in the order of the layout.
    pub panels_on_screen: Vec<PanelKind>,
    /// The dialog on top, if any.
    pub dialog: Option<Dialog>,
    /// Short messages.
    pub toasts: Toasts,
    /// What panels and their layout are to do.
    pub panel_effects: PanelEffects,
    /// What the host is to do.
    effects: Vec<Effect>,
}

/// What can be asked of the window.
#[derive(Clone, Debug, PartialEq)]
pub enum WindowCommand {
    /// Puts the panels of the present workspace back where they were at first.
    ResetWorkspace,
    /// Brings a panel back or to the front.
    ShowPanel(PanelKind),
    /// Closes a panel.
    ClosePanel(PanelKind),
    /// Gives a panel the whole window, the one used last if none is named, or puts all panels back.
    Maximize(Option<PanelKind>),
    /// The user turned to a panel.
    Activate(PanelKind),
    /// Gives the keyboard to the next (`true`) or the previous (`false`) panel on screen.
    TurnPanel(bool),
    /// A view action for the panel used last.
    View(ViewAction),
    ViewOf(PanelKind, ViewAction),
    /// Saves the drawing of the network.
    SaveNetwork(PictureFormat),
    /// Opens a dialog over everything.
    ShowDialog(Dialog),
    CloseDialog,
    /// Says something for a moment.
    Notify(ToastKind, String),
    /// Takes a message away.
    DismissToast(usize),
    /// Puts text on the clipboard.
    Copy(String),
    /// Pastes what is on the clipboard into the text.
    Paste,
    /// Puts a link to the mission on the clipboard.
    CopyLink,
    /// Lets the user choose a file.
    OpenFile(FileKind),
    /// Lets the user save a file.
    SaveFile {
        /// The name to suggest.
        name: String,
        bytes: Vec<u8>,
    },
    /// Lets the user save a picture as a PNG.
    SavePicture {
        /// The name to suggest.
        name: String,
        /// The picture as an SVG.
        svg: String,
        /// Width and height in pixels.
        size: [u32; 2],
    },
}

impl Default for Window {
    fn default() -> Self {
        Self {
            workspace: Workspace::default(),
            active_panel: PanelKind::Editor,
            maximized: None,
            panels_on_screen: Vec::new(),
            dialog: None,
            toasts: Toasts::default(),
            panel_effects: PanelEffects::default(),
            effects: vec![Effect::RecallKeys, Effect::RecallReview],
        }
    }
}

impl Window {
    /// Does what a command asks for.
    pub(crate) fn apply(&mut self, command: WindowCommand) {
        match command {
            WindowCommand::ResetWorkspace => {
                self.maximized = None;
                self.panel_effects.push(PanelEffect::ResetLayout);
            }
            WindowCommand::ShowPanel(panel) => {
                self.maximized = self.maximized.filter(|&maximized| maximized == panel);
                self.turn_to(panel);
            }
            WindowCommand::ClosePanel(panel) => {
                self.maximized = self.maximized.filter(|&maximized| maximized != panel);
                self.panel_effects.push(PanelEffect::Close(panel));
            }
            WindowCommand::Maximize(panel) => {
                self.maximized = match self.maximized {
                    Some(_) => None,
                    None => Some(panel.unwrap_or(self.active_panel)),
                };
                if let Some(panel) = self.maximized {
                    self.turn_to(panel);
                }
            }
            WindowCommand::Activate(panel) => self.active_panel = panel,
            WindowCommand::TurnPanel(forwards) => self.turn_panel(forwards),
            WindowCommand::View(action) => {
                let active = self.active_panel;
                self.view(if active.is_zoomable() { active } else { PanelKind::Network }, action);
            }
            WindowCommand::ViewOf(panel, action) => self.view(panel, action),
            WindowCommand::SaveNetwork(format) => {
                self.panel_effects.push(PanelEffect::SaveDrawing(format));
                self.show(PanelKind::Network);
            }
            WindowCommand::ShowDialog(dialog) => self.dialog = Some(dialog),
            WindowCommand::CloseDialog => self.dialog = None,
            WindowCommand::Notify(kind, text) => self.toasts.add(kind, text),
            WindowCommand::DismissToast(index) => self.toasts.dismiss(index),
            WindowCommand::Copy(text) => self.ask(Effect::Copy(text)),
            WindowCommand::Paste => self.ask(Effect::Paste),
            WindowCommand::CopyLink => self.ask(Effect::CopyLink),
            WindowCommand::OpenFile(kind) => self.ask(Effect::OpenFile(kind)),
            WindowCommand::SaveFile { name, bytes } => self.save_file(name, bytes),
            WindowCommand::SavePicture { name, svg, size } => {
                self.ask(Effect::SavePicture { name, svg, size });
            }
        }
    }

    /// Says that something was done.
    pub(crate) fn done(&mut self, text: impl Into<String>) {
        self.toasts.add(ToastKind::Done, text);
    }

    /// Says something worth knowing.
    pub(crate) fn info(&mut self, text: impl Into<String>) {
        self.toasts.add(ToastKind::Info, text);
    }

    /// Says that something could not be done.
    pub(crate) fn failed(&mut self, text: impl Into<String>) {
        self.toasts.add(ToastKind::Failed, text);
    }

    /// Leaves something for the host to do.
    pub(crate) fn ask(&mut self, effect: Effect) {
        self.effects.push(effect);
    }

    /// Sends something to the planning core.
    pub(crate) fn post(&mut self, request: Request) {
        self.ask(Effect::Post(request));
    }

    /// Lets the user save a file.
    pub(crate) fn save_file(&mut self, name: String, bytes: Vec<u8>) {
        self.ask(Effect::SaveFile { name, bytes });
    }

    /// Takes what the host is to do.
    pub(crate) fn take_effects(&mut self) -> Vec<Effect> {
        std::mem::take(&mut self.effects)
    }

    /// Asks the layout to bring a panel back, or to the front of its tabs.
    pub(crate) fn show(&mut self, panel: PanelKind) {
        self.panel_effects.push(PanelEffect::Show(panel));
    }

    /// Shows a panel, which is the one in use then.
    pub(crate) fn turn_to(&mut self, panel: PanelKind) {
        self.show(panel);
        self.active_panel = panel;
    }

    /// Asks a panel to move its view.
    pub(crate) fn view(&mut self, panel: PanelKind, action: ViewAction) {
        self.panel_effects.push(PanelEffect::View(panel, action));
    }

    /// Asks the editor to scroll to a place; with `center` to the middle, even when the place can be seen.
    pub(crate) fn scroll_to(&mut self, span: Span, center: bool) {
        self.panel_effects.push(PanelEffect::Reveal(Reveal { span, center }));
    }

    /// Gives the editor the keyboard.
    pub(crate) fn focus_editor(&mut self) {
        self.panel_effects.push(PanelEffect::FocusEditor);
    }

    /// Gives a panel the keyboard.
    pub(crate) fn focus_panel(&mut self, panel: PanelKind) {
        self.active_panel = panel;
        if panel == PanelKind::Editor {
            self.focus_editor();
        } else {
            self.panel_effects.push(PanelEffect::FocusPanel(panel));
        }
    }

    /// Turns to the next or the previous panel on screen, and gives it the keyboard.
    fn turn_panel(&mut self, forwards: bool) {
        let panels = &self.panels_on_screen;
        let at = panels.iter().position(|&panel| panel == self.active_panel);
        let next = match (at, forwards) {
            (None, _) => 0,
            (Some(at), true) => (at + 1) % panels.len(),
            (Some(at), false) => (at + panels.len() - 1) % panels.len(),
        };
        if let Some(&panel) = panels.get(next) {
            self.focus_panel(panel);
        }
    }
}
