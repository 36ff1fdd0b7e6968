//! The kinds of panel, by name: what each shows is in the crate `app`.

use serde::{Deserialize, Serialize};

/// The kinds of panel. A layout holds at most one of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PanelKind {
    Editor,
    /// What the text declares.
    Outline,
    /// What is wrong with it.
    Problems,
    /// The temporal plan network.
    Network,
    /// Choices, windows, links, orderings and the verdict, or why there is no plan.
    Plan,
    /// The activities over time.
    Timeline,
    /// The ground and the vehicles.
    Terrain,
    /// The search that found the plan.
    Search,
    /// The distances between the events of the plan, or of the step that is looked at.
    Distances,
    /// A run against nature, whose durations are chosen one by one.
    Strategy,
    /// The run of a control program.
    Automaton,
    /// The checklist of the review, comments and approvals.
    Review,
    /// Two plans side by side.
    Compare,
    /// The run of a mission.
    Execution,
    /// Many runs of it with chance.
    Robustness,
    /// A lesson beside what it is about.
    Lesson,
    Manual,
}

impl PanelKind {
    /// All of them, as the menu lists them.
    pub const ALL: [Self; 17] = [
        Self::Editor,
        Self::Outline,
        Self::Problems,
        Self::Network,
        Self::Plan,
        Self::Timeline,
        Self::Terrain,
        Self::Search,
        Self::Distances,
        Self::Strategy,
        Self::Automaton,
        Self::Review,
        Self::Compare,
        Self::Execution,
        Self::Robustness,
        Self::Lesson,
        Self::Manual,
    ];

    /// Its name on screen.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Editor => "Mission text",
            Self::Outline => "Outline",
            Self::Problems => "Problems",
            Self::Network => "Network",
            Self::Plan => "Plan",
            Self::Timeline => "Timeline",
            Self::Terrain => "Terrain",
            Self::Search => "Search",
            Self::Distances => "Distances",
            Self::Strategy => "Against nature",
            Self::Automaton => "Automaton",
            Self::Review => "Review",
            Self::Compare => "Compare",
            Self::Execution => "Execution",
            Self::Robustness => "Robustness",
            Self::Lesson => "Lesson",
            Self::Manual => "Manual",
        }
    }

    /// Its name in commands.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Editor => "editor",
            Self::Outline => "outline",
            Self::Problems => "problems",
            Self::Network => "network",
            Self::Plan => "plan",
            Self::Timeline => "timeline",
            Self::Terrain => "terrain",
            Self::Search => "search",
            Self::Distances => "distances",
            Self::Strategy => "strategy",
            Self::Automaton => "automaton",
            Self::Review => "review",
            Self::Compare => "compare",
            Self::Execution => "execution",
            Self::Robustness => "robustness",
            Self::Lesson => "lesson",
            Self::Manual => "manual",
        }
    }

    /// The panel of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|panel| panel.name() == name)
    }

    /// Whether it has a view that can be zoomed and fitted.
    pub const fn is_zoomable(self) -> bool {
        matches!(
            self,
            Self::Network | Self::Timeline | Self::Terrain | Self::Search | Self::Distances | Self::Automaton
        )
    }
}
