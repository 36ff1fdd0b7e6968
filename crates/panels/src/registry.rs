//! The panels by kind.

use std::collections::BTreeMap;

use workbench::PanelKind;
use workbench::command::CommandSender;

use crate::{Context, Panel};

/// One panel of each kind.
pub struct Panels {
    panels: BTreeMap<PanelKind, Box<dyn Panel>>,
}

impl Panels {
    /// All panels, in their initial state.
    pub fn new() -> Self {
        let panels = PanelKind::ALL.into_iter().map(|kind| (kind, create(kind))).collect();
        Self { panels }
    }

    /// Shows the panel of this kind.
    pub fn show(
        &mut self,
        kind: PanelKind,
        ui: &mut egui::Ui,
        context: &Context<'_>,
        commands: &mut CommandSender,
    ) {
        if let Some(panel) = self.panels.get_mut(&kind) {
            panel.show(ui, context, commands);
        }
    }
}

impl Default for Panels {
    fn default() -> Self {
        Self::new()
    }
}

/// A panel in its initial state. A new panel is added here.
fn create(kind: PanelKind) -> Box<dyn Panel> {
    match kind {
        PanelKind::Outline => Box::new(crate::outline::OutlinePanel::default()),
        PanelKind::Problems => Box::new(crate::problems::ProblemsPanel::default()),
        PanelKind::Network => Box::new(crate::network::NetworkPanel::default()),
        PanelKind::Terrain => Box::new(crate::terrain::TerrainPanel::default()),
        PanelKind::Search => Box::new(crate::search::SearchPanel::default()),
        PanelKind::Distances => Box::new(crate::distances::DistancesPanel::default()),
        PanelKind::Strategy => Box::new(crate::strategy::StrategyPanel::default()),
        PanelKind::Automaton => Box::new(crate::automaton::AutomatonPanel::default()),
        PanelKind::Review => Box::new(crate::review::ReviewPanel::default()),
        PanelKind::Compare => Box::new(crate::compare::ComparePanel::default()),
        PanelKind::Execution => Box::new(crate::execution::ExecutionPanel::default()),
        PanelKind::Robustness => Box::new(crate::robustness::RobustnessPanel),
        PanelKind::Editor => Box::new(crate::mission_text::EditorPanel::default()),
        PanelKind::Plan => Box::new(crate::plan::PlanPanel::default()),
        PanelKind::Lesson => Box::new(crate::lesson::LessonPanel::default()),
        PanelKind::Manual => Box::new(crate::manual::ManualPanel::default()),
        PanelKind::Timeline => Box::new(crate::timeline::TimelinePanel::default()),
    }
}
