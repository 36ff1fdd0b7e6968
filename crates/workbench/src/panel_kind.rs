//! The kinds of panel, in one table: names, titles, pages of the manual. What each shows is in the crate `panels`.

use serde::{Deserialize, Serialize};

/// Declares the kinds of panel, so that none is left out of what is true of all.
macro_rules! panel_kinds {
    ($(
        $(#[$comment:meta])*
        $kind:ident: $name:literal, $title:literal, $page:literal $(, $property:ident)*;
    )*) => {
        /// The kinds of panel. A layout holds at most one of each.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum PanelKind {
            $($(#[$comment])* $kind,)*
        }

        impl PanelKind {
            /// All of them, as the menu lists them.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$kind),*];

            const fn entry(self) -> Entry {
                match self {
                    $(Self::$kind => Entry {
                        name: $name,
                        title: $title,
                        manual: $page,
                        properties: &[$(Property::$property),*],
                    },)*
                }
            }
        }
    };
}

/// What is true of a kind of panel.
struct Entry {
    name: &'static str,
    title: &'static str,
    manual: &'static str,
    properties: &'static [Property],
}

/// What is true of some kinds of panel.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Property {
    /// It has a view that can be zoomed and fitted.
    Zoomable,
    /// It draws the mission as planned, and is marked while what it draws is of an earlier text.
    MarkedWhenStale,
}

// Kind: name in commands, title on screen, page of the manual, and what else is true of it.
panel_kinds! {
    Editor: "editor", "Mission text", "mission-text-panel";
    /// What the text declares.
    Outline: "outline", "Outline", "outline-panel";
    /// What is wrong with it.
    Problems: "problems", "Problems", "problems-panel";
    /// The temporal plan network.
    Network: "network", "Network", "network-panel", Zoomable;
    /// Choices, windows, links, orderings and the verdict, or why there is no plan.
    Plan: "plan", "Plan", "plan-panel", MarkedWhenStale;
    /// The activities over time.
    Timeline: "timeline", "Timeline", "timeline-panel", Zoomable, MarkedWhenStale;
    /// The ground and the vehicles.
    Terrain: "terrain", "Terrain", "terrain-panel", Zoomable, MarkedWhenStale;
    /// The search that found the plan.
    Search: "search", "Search", "search-panel", Zoomable, MarkedWhenStale;
    /// The distances between the events of the plan, or of the step that is looked at.
    Distances: "distances", "Distances", "distances-panel", Zoomable, MarkedWhenStale;
    /// A run against the environment, whose durations are chosen one by one.
    Strategy: "strategy", "Controllability", "controllability-panel", MarkedWhenStale;
    /// The run of a control program.
    Automaton: "automaton", "Automaton", "automaton-panel", Zoomable;
    /// The checklist of the review, comments and approvals.
    Review: "review", "Review", "review-panel";
    /// Two plans side by side.
    Compare: "compare", "Compare", "compare-panel";
    /// The run of a mission.
    Execution: "execution", "Execution", "execution-panel";
    /// Many runs of it with chance.
    Robustness: "robustness", "Robustness", "robustness-panel", MarkedWhenStale;
    /// A lesson beside what it is about.
    Lesson: "lesson", "Lesson", "lesson-panel";
    Manual: "manual", "Manual", "manual-panel";
}

impl PanelKind {
    /// Its name on screen.
    pub const fn title(self) -> &'static str {
        self.entry().title
    }

    /// Its name in commands.
    pub const fn name(self) -> &'static str {
        self.entry().name
    }

    /// The page of the manual that explains it.
    pub const fn manual(self) -> &'static str {
        self.entry().manual
    }

    /// The panel of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|panel| panel.name() == name)
    }

    /// Returns whether it has a view that can be zoomed and fitted.
    pub fn is_zoomable(self) -> bool {
        self.entry().properties.contains(&Property::Zoomable)
    }

    /// Returns whether it draws the mission as planned, and is marked while what is drawn is of an earlier text.
    pub fn is_marked_when_stale(self) -> bool {
        self.entry().properties.contains(&Property::MarkedWhenStale)
    }
}
