//! The one channel from commands to what is on screen: what panels and their layout are to do, once, in order.

use crate::panel_kind::PanelKind;
use crate::state::editor::Reveal;

/// What can be done with a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewAction {
    ZoomIn,
    ZoomOut,
    /// Designed size.
    ZoomReset,
    /// Everything at once.
    Fit,
    /// What is selected.
    FitSelection,
    /// Straight down, north up; for the terrain.
    TopView,
    /// Keeps the selected vehicle in the middle, or the first one; lets it go if one is kept. For the terrain.
    Follow,
    /// Goes from vehicle to vehicle as they set out. For the terrain.
    Tour,
}

/// The formats that drawings are saved in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Lines and texts, sharp at any size.
    Svg,
    /// Pixels.
    Png,
}

impl PictureFormat {
    /// Returns what files of this format end in.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }
}

/// Something that a panel, or the layout of the panels, is to do once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PanelEffect {
    /// The layout brings a panel back, or to the front of its tabs.
    Show(PanelKind),
    /// The layout closes a panel.
    Close(PanelKind),
    /// The layout of the present workspace goes back to its default.
    ResetLayout,
    /// The layout of the present workspace is saved with the open mission, under this number.
    SaveLayout(usize),
    /// The layout of the present workspace becomes the one that the open mission has under this number.
    ShowLayout(usize),
    /// The layout of lessons becomes what the stop wants.
    Arrange,
    /// A panel moves its view.
    View(PanelKind, ViewAction),
    /// The network's drawing is saved.
    SaveDrawing(PictureFormat),
    /// The editor scrolls to a place.
    Reveal(Reveal),
    /// The editor takes the keyboard, when no dialog is open.
    FocusEditor,
    /// A panel takes the keyboard: plain keys go to it, and Tab to what it holds.
    FocusPanel(PanelKind),
}

/// What is still to be done, oldest first. What is meant for a panel waits until that panel is on screen and takes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PanelEffects {
    waiting: Vec<PanelEffect>,
}

impl PanelEffects {
    /// Adds an effect. It replaces the earlier ones that it makes pointless: only the last place is revealed, only the
    /// last view of a panel counts, and the keyboard goes where it was last sent.
    pub fn push(&mut self, effect: PanelEffect) {
        self.waiting.retain(|earlier| !replaces(effect, *earlier));
        self.waiting.push(effect);
    }

    /// Takes out everything that `wanted` makes something of, in order.
    pub fn take<T>(&mut self, mut wanted: impl FnMut(PanelEffect) -> Option<T>) -> Vec<T> {
        let mut taken = Vec::new();
        self.waiting.retain(|&effect| {
            let made = wanted(effect);
            let waits = made.is_none();
            taken.extend(made);
            waits
        });
        taken
    }

    /// Returns what waits, oldest first.
    pub fn waiting(&self) -> &[PanelEffect] {
        &self.waiting
    }
}

/// Returns whether `newer` makes `earlier` pointless.
fn replaces(newer: PanelEffect, earlier: PanelEffect) -> bool {
    use PanelEffect::{Arrange, FocusEditor, FocusPanel, ResetLayout, Reveal, View};
    match (newer, earlier) {
        (Reveal(_), Reveal(_))
        | (ResetLayout, ResetLayout)
        | (Arrange, Arrange)
        | (FocusEditor | FocusPanel(_), FocusEditor | FocusPanel(_)) => true,
        (View(newer, _), View(earlier, _)) => newer == earlier,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_are_taken_once_and_in_order_and_the_others_wait() {
        let mut effects = PanelEffects::default();
        effects.push(PanelEffect::Show(PanelKind::Editor));
        effects.push(PanelEffect::SaveDrawing(PictureFormat::Svg));
        effects.push(PanelEffect::Show(PanelKind::Automaton));
        effects.push(PanelEffect::SaveDrawing(PictureFormat::Svg));
        let shown = |effect| match effect {
            PanelEffect::Show(panel) => Some(panel),
            _ => None,
        };
        assert_eq!(effects.take(shown), [PanelKind::Editor, PanelKind::Automaton]);
        assert_eq!(effects.take(shown), []);
        assert_eq!(effects.waiting(), [PanelEffect::SaveDrawing(PictureFormat::Svg); 2]);
    }

    #[test]
    fn only_the_last_view_of_a_panel_counts_and_the_keyboard_goes_where_it_was_last_sent() {
        let mut effects = PanelEffects::default();
        effects.push(PanelEffect::View(PanelKind::Network, ViewAction::Fit));
        effects.push(PanelEffect::View(PanelKind::Terrain, ViewAction::Fit));
        effects.push(PanelEffect::FocusEditor);
        effects.push(PanelEffect::View(PanelKind::Network, ViewAction::ZoomIn));
        effects.push(PanelEffect::FocusPanel(PanelKind::Network));
        assert_eq!(
            effects.waiting(),
            [
                PanelEffect::View(PanelKind::Terrain, ViewAction::Fit),
                PanelEffect::View(PanelKind::Network, ViewAction::ZoomIn),
                PanelEffect::FocusPanel(PanelKind::Network),
            ]
        );
    }
}
