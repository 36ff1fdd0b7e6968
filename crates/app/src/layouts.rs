//! The layouts of the workspaces while the app runs, and how they are remembered.

use std::collections::BTreeMap;

use egui_tiles::Tree;
use workbench::host::Host;
use workbench::state::AppState;
use workbench::workspace::Arrangement;
use workbench::{PanelEffect, PanelKind};

use crate::default_layout::{self, SizeClass, default_layout};

/// One layout per workspace, and one for control programs.
pub struct Layouts {
    trees: BTreeMap<Arrangement, Tree<PanelKind>>,
    stored: BTreeMap<Arrangement, String>,
    size: SizeClass,
    /// The panels that the last stop of a lesson wanted beside it: rows of columns of tabs.
    lesson_rows: Vec<Vec<Vec<PanelKind>>>,
}

fn key(arrangement: Arrangement) -> String {
    format!("enroute/layout-2/{}", arrangement.name())
}

impl Layouts {
    /// The layouts that the host remembers; the default ones where it does not.
    pub fn remembered(host: &dyn Host) -> Self {
        let mut trees = BTreeMap::new();
        let mut stored = BTreeMap::new();
        for arrangement in Arrangement::ALL {
            let text = host.stored(&key(arrangement));
            let tree = text.as_deref().and_then(default_layout::from_text);
            let tree = tree.unwrap_or_else(|| default_layout(arrangement, SizeClass::default()));
            stored.insert(arrangement, default_layout::to_text(&tree).unwrap_or_default());
            trees.insert(arrangement, tree);
        }
        Self { trees, stored, size: SizeClass::default(), lesson_rows: Vec::new() }
    }

    /// Adapts to the window's size class: layouts that the user has not changed become those that fit it.
    pub fn fit(&mut self, size: SizeClass) {
        if self.size == size {
            return;
        }
        let of_lesson = |size| default_layout::lesson_layout(&self.lesson_rows, size);
        if let Some(tree) = self.trees.get_mut(&Arrangement::Lesson) {
            default_layout::refit(tree, &of_lesson(self.size), of_lesson(size));
        }
        for (&arrangement, tree) in &mut self.trees {
            let [before, after] = [self.size, size].map(|size| default_layout(arrangement, size));
            if default_layout::refit(tree, &before, after) {
                self.stored.insert(arrangement, default_layout::to_text(tree).unwrap_or_default());
            }
        }
        self.size = size;
    }

    /// The layout of a workspace.
    pub fn tree_mut(&mut self, arrangement: Arrangement) -> &mut Tree<PanelKind> {
        let size = self.size;
        self.trees.entry(arrangement).or_insert_with(|| default_layout(arrangement, size))
    }

    /// Does what the state wants done to the present layout.
    pub fn follow(&mut self, state: &mut AppState) {
        let arrangement = state.arrangement();
        let layout = |effect| match effect {
            PanelEffect::Show(_)
            | PanelEffect::Close(_)
            | PanelEffect::ResetLayout
            | PanelEffect::SaveLayout(_)
            | PanelEffect::ShowLayout(_)
            | PanelEffect::Arrange => Some(effect),
            _ => None,
        };
        for effect in state.window.panel_effects.take(layout) {
            match effect {
                PanelEffect::Show(panel) => default_layout::show_panel(self.tree_mut(arrangement), panel),
                PanelEffect::Close(panel) => default_layout::close_panel(self.tree_mut(arrangement), panel),
                PanelEffect::SaveLayout(number) => {
                    let tiles = default_layout::to_text(self.tree_mut(arrangement)).unwrap_or_default();
                    state.library.set_layout(number, tiles);
                }
                PanelEffect::ShowLayout(number) => {
                    let saved = state.library.open_mission().and_then(|it| it.layouts.get(number));
                    if let Some(tree) = saved.and_then(|saved| default_layout::from_text(&saved.tiles)) {
                        self.trees.insert(arrangement, tree);
                    }
                }
                PanelEffect::Arrange => {
                    self.lesson_rows = state.lesson.panels().to_vec();
                    let layout = default_layout::lesson_layout(&self.lesson_rows, self.size);
                    self.trees.insert(Arrangement::Lesson, layout);
                }
                _ => {
                    self.trees.insert(arrangement, default_layout(arrangement, self.size));
                }
            }
        }
    }

    /// Lets the host keep what has changed.
    pub fn remember(&mut self, host: &mut dyn Host) {
        for (&arrangement, tree) in &self.trees {
            let Some(text) = default_layout::to_text(tree) else { continue };
            if self.stored.get(&arrangement) != Some(&text) {
                // A full storage only means that the layout is not remembered.
                let _ = host.store(&key(arrangement), &text);
                self.stored.insert(arrangement, text);
            }
        }
    }
}
