//! The kinds of panel, in one table: names, titles, pages of the manual. What each shows is in the crate `panels`.

use serde::{Deserialize, Serialize};

/// Declares the kinds of panel, so that none is left out of what is true of all.
macro_rules! panel_kinds {
    ($(
        $(#[$comment:meta])*
        $kind:ident: $name:literal, $title:literal, $page:literal $section:literal $(, $property:ident)*;
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
                        manual: ($page, $section),
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
    manual: (&'static str, &'static str),
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

// Kind: name in commands, title on screen, page and section of the manual, and what else is true of it.
panel_kinds! {
    Editor: "editor", "Mission text", "language" "";
    /// What the text declares.
    Outline: "outline", "Outline", "language" "";
    /// What is wrong with it.
    Problems: "problems", "Problems", "diagnostics" "";
    /// The temporal plan network.
    Network: "network", "Network", "network" "", Zoomable;
    /// Choices, windows, links, orderings and the verdict, or why there is no plan.
    Plan: "plan", "Plan", "specification" "5-planning", MarkedWhenStale;
    /// The activities over time.
    Timeline: "timeline", "Timeline", "timeline" "", Zoomable, MarkedWhenStale;
    /// The ground and the vehicles.
    Terrain: "terrain", "Terrain", "terrain" "", Zoomable, MarkedWhenStale;
    /// The search that found the plan.
    Search: "search", "Search", "specification" "54-the-order-of-the-search-and-completeness", Zoomable, MarkedWhenStale;
    /// The distances between the events of the plan, or of the step that is looked at.
    Distances: "distances", "Distances", "specification" "61-the-dispatchable-form", Zoomable, MarkedWhenStale;
    /// A run against nature, whose durations are chosen one by one.
    Strategy: "strategy", "Controllability", "controllability" "on-screen", MarkedWhenStale;
    /// The run of a control program.
    Automaton: "automaton", "Automaton", "control-programs" "on-screen", Zoomable;
    /// The checklist of the review, comments and approvals.
    Review: "review", "Review", "reviews" "";
    /// Two plans side by side.
    Compare: "compare", "Compare", "reviews" "";
    /// The run of a mission.
    Execution: "execution", "Execution", "simulation" "";
    /// Many runs of it with chance.
    Robustness: "robustness", "Robustness", "robustness" "", MarkedWhenStale;
    /// A lesson beside what it is about.
    Lesson: "lesson", "Lesson", "lessons" "";
    Manual: "manual", "Manual", "glossary" "";
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

    /// The page of the manual that tells about it, and the section, which is empty for the whole page.
    pub const fn manual(self) -> (&'static str, &'static str) {
        self.entry().manual
    }

    /// The panel of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|panel| panel.name() == name)
    }

    /// Whether it has a view that can be zoomed and fitted.
    pub fn is_zoomable(self) -> bool {
        self.entry().properties.contains(&Property::Zoomable)
    }

    /// Whether it draws the mission as planned, and is marked while what is drawn is of an earlier text.
    pub fn is_marked_when_stale(self) -> bool {
        self.entry().properties.contains(&Property::MarkedWhenStale)
    }
}
