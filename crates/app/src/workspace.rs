//! The workspaces and where their panels stand.

use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

use crate::panel::PanelKind;

/// What the user has come to do (DESIGN 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Workspace {
    /// Write a mission.
    #[default]
    Author,
    /// See how planning works.
    Teach,
    /// Judge a plan.
    Review,
    /// Run a mission or a control program.
    Execute,
}

/// What has a layout of its own: a workspace, where missions and control programs need other panels also by notation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Arrangement {
    /// A workspace with a mission, or where both are worked on alike.
    Of(Workspace),
    /// A control program as it runs: there is nothing to show over time or on the ground.
    Program,
}

impl Arrangement {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Of(Workspace::Author),
        Self::Of(Workspace::Teach),
        Self::Of(Workspace::Review),
        Self::Of(Workspace::Execute),
        Self::Program,
    ];

    /// That of a workspace with a mission or a control program in it.
    pub const fn new(workspace: Workspace, is_control: bool) -> Self {
        match (workspace, is_control) {
            (Workspace::Execute, true) => Self::Program,
            (workspace, _) => Self::Of(workspace),
        }
    }

    /// Its name in storage.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Of(workspace) => workspace.name(),
            Self::Program => "program",
        }
    }

    /// Where its panels stand before the user moves them.
    pub fn default_layout(self, room: Room) -> Tree<PanelKind> {
        let mut tiles = Tiles::default();
        let root = match (self, room) {
            (Self::Of(workspace), Room::Wide) => workspace.wide_layout(&mut tiles),
            (Self::Of(workspace), Room::Narrow) => workspace.narrow_layout(&mut tiles),
            (Self::Program, Room::Narrow) => {
                use PanelKind::{Automaton, Editor, Outline, Problems};
                tabs(&mut tiles, &[Automaton, Editor, Outline, Problems])
            }
            (Self::Program, Room::Wide) => {
                let text = tabs(&mut tiles, &[PanelKind::Editor, PanelKind::Outline, PanelKind::Problems]);
                let automaton = tabs(&mut tiles, &[PanelKind::Automaton]);
                split(&mut tiles, LinearDir::Horizontal, &[(text, 0.29), (automaton, 0.71)])
            }
        };
        Tree::new(egui::Id::unique(("workspace", self.name())), root, tiles)
    }
}

impl Workspace {
    /// All of them, as the tabs stand.
    pub const ALL: [Self; 4] = [Self::Author, Self::Teach, Self::Review, Self::Execute];

    /// Its name on screen.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Author => "Author",
            Self::Teach => "Teach",
            Self::Review => "Review",
            Self::Execute => "Execute",
        }
    }

    /// Its name in addresses, commands and storage.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Author => "author",
            Self::Teach => "teach",
            Self::Review => "review",
            Self::Execute => "execute",
        }
    }

    /// The workspace of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|workspace| workspace.name() == name)
    }

    fn wide_layout(self, tiles: &mut Tiles<PanelKind>) -> TileId {
        use LinearDir::{Horizontal, Vertical};
        use PanelKind::{
            Automaton, Compare, Distances, Editor, Execution, Network, Outline, Plan, Problems, Review,
            Robustness, Search, Terrain, Timeline,
        };
        match self {
            Self::Author => {
                let text = tabs(tiles, &[Editor, Outline]);
                let problems = tabs(tiles, &[Problems]);
                let left = split(tiles, Vertical, &[(text, 0.78), (problems, 0.22)]);
                let network = tabs(tiles, &[Network]);
                let plan = tabs(tiles, &[Plan]);
                let terrain = tabs(tiles, &[Terrain]);
                let lower = split(tiles, Horizontal, &[(plan, 0.5), (terrain, 0.5)]);
                let timeline = tabs(tiles, &[Timeline]);
                let right = split(tiles, Vertical, &[(network, 0.40), (lower, 0.32), (timeline, 0.28)]);
                split(tiles, Horizontal, &[(left, 0.36), (right, 0.64)])
            }
            Self::Teach => {
                let text = tabs(tiles, &[Editor, Outline]);
                let plan = tabs(tiles, &[Plan, Problems]);
                let left = split(tiles, Vertical, &[(text, 0.58), (plan, 0.42)]);
                let network = tabs(tiles, &[Network, Distances, Terrain]);
                let timeline = tabs(tiles, &[Timeline]);
                let middle = split(tiles, Vertical, &[(network, 0.68), (timeline, 0.32)]);
                let search = tabs(tiles, &[Search]);
                split(tiles, Horizontal, &[(left, 0.25), (middle, 0.40), (search, 0.35)])
            }
            Self::Review => {
                let review = tabs(tiles, &[Review, Plan]);
                let timeline = tabs(tiles, &[Timeline, Compare]);
                let network = tabs(tiles, &[Network]);
                let terrain = tabs(tiles, &[Terrain]);
                let text = tabs(tiles, &[Editor, Problems, Outline]);
                let middle = split(tiles, Horizontal, &[(network, 0.5), (terrain, 0.5)]);
                let right = split(tiles, Vertical, &[(timeline, 0.36), (middle, 0.34), (text, 0.30)]);
                split(tiles, Horizontal, &[(review, 0.38), (right, 0.62)])
            }
            Self::Execute => {
                let left = tabs(tiles, &[Editor, Execution, Robustness, Problems]);
                let network = tabs(tiles, &[Network, Automaton]);
                let timeline = tabs(tiles, &[Timeline]);
                let terrain = tabs(tiles, &[Terrain, Plan]);
                let lower = split(tiles, Horizontal, &[(timeline, 0.55), (terrain, 0.45)]);
                let right = split(tiles, Vertical, &[(network, 0.5), (lower, 0.5)]);
                split(tiles, Horizontal, &[(left, 0.3), (right, 0.7)])
            }
        }
    }

    /// Fewer panels at a time, the others behind tabs.
    fn narrow_layout(self, tiles: &mut Tiles<PanelKind>) -> TileId {
        use LinearDir::{Horizontal, Vertical};
        use PanelKind::{
            Automaton, Compare, Distances, Editor, Execution, Network, Outline, Plan, Problems, Review,
            Robustness, Search, Terrain, Timeline,
        };
        let (left, right, share) = match self {
            Self::Author => {
                let text = tabs(tiles, &[Editor, Outline, Problems]);
                let network = tabs(tiles, &[Network, Terrain]);
                let plan = tabs(tiles, &[Timeline, Plan]);
                let right = split(tiles, Vertical, &[(network, 0.52), (plan, 0.48)]);
                (text, right, 0.42)
            }
            Self::Teach => {
                let network = tabs(tiles, &[Network, Distances, Timeline, Terrain]);
                let text = tabs(tiles, &[Editor, Plan, Problems]);
                let left = split(tiles, Vertical, &[(network, 0.58), (text, 0.42)]);
                let search = tabs(tiles, &[Search]);
                (left, search, 0.52)
            }
            Self::Review => {
                let review = tabs(tiles, &[Review, Plan]);
                let timeline = tabs(tiles, &[Timeline, Compare, Network, Terrain]);
                let text = tabs(tiles, &[Editor, Problems]);
                let right = split(tiles, Vertical, &[(timeline, 0.6), (text, 0.4)]);
                (review, right, 0.48)
            }
            Self::Execute => {
                let left = tabs(tiles, &[Editor, Execution, Robustness, Problems]);
                let network = tabs(tiles, &[Network, Automaton, Terrain]);
                let timeline = tabs(tiles, &[Timeline, Plan]);
                let right = split(tiles, Vertical, &[(network, 0.55), (timeline, 0.45)]);
                (left, right, 0.4)
            }
        };
        split(tiles, Horizontal, &[(left, share), (right, 1.0 - share)])
    }
}

/// How much room there is for panels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Room {
    /// Enough for five or six at a time.
    #[default]
    Wide,
    /// Enough for two or three.
    Narrow,
}

impl Room {
    /// That of a window of this size in points.
    pub fn of(size: egui::Vec2) -> Self {
        if size.x < 1_160.0 || size.y < 640.0 { Self::Narrow } else { Self::Wide }
    }
}

/// Brings a panel to the front, wherever it stands; a closed panel comes back beside the others.
pub fn show_panel(tree: &mut Tree<PanelKind>, panel: PanelKind) {
    if tree.tiles.find_pane(&panel).is_none() {
        let pane = tree.tiles.insert_pane(panel);
        let neighbours = largest_tabs(tree);
        match (neighbours, tree.root()) {
            (Some(container), _) => tree.move_tile_to_container(pane, container, usize::MAX, false),
            (None, Some(root)) => {
                let both = split(&mut tree.tiles, LinearDir::Horizontal, &[(root, 0.7), (pane, 0.3)]);
                tree.root = Some(both);
            }
            (None, None) => tree.root = Some(tabs_of(&mut tree.tiles, vec![pane])),
        }
    }
    tree.make_active(|_, tile| *tile == Tile::Pane(panel));
}

/// Closes a panel.
pub fn close_panel(tree: &mut Tree<PanelKind>, panel: PanelKind) {
    if let Some(tile) = tree.tiles.find_pane(&panel) {
        tree.remove_recursively(tile);
    }
}

/// The layout as text, to be remembered.
pub fn to_text(tree: &Tree<PanelKind>) -> Option<String> {
    serde_json::to_string(tree).ok()
}

/// A remembered layout; `None` if it cannot be used any more.
pub fn from_text(text: &str) -> Option<Tree<PanelKind>> {
    let tree: Tree<PanelKind> = serde_json::from_str(text).ok()?;
    (!tree.is_empty()).then_some(tree)
}

/// The tab container on screen with the most room.
fn largest_tabs(tree: &Tree<PanelKind>) -> Option<TileId> {
    tree.tiles
        .iter()
        .filter(|(_, tile)| matches!(tile, Tile::Container(Container::Tabs(_))))
        .max_by(|(left, _), (right, _)| {
            let area = |id| tree.tiles.rect(id).map_or(0.0, |rect| rect.area());
            area(**left).total_cmp(&area(**right)).then(right.0.cmp(&left.0))
        })
        .map(|(id, _)| *id)
}

fn tabs(tiles: &mut Tiles<PanelKind>, panels: &[PanelKind]) -> TileId {
    let panes = panels.iter().map(|&panel| tiles.insert_pane(panel)).collect();
    tabs_of(tiles, panes)
}

fn tabs_of(tiles: &mut Tiles<PanelKind>, panes: Vec<TileId>) -> TileId {
    tiles.insert_tab_tile(panes)
}

/// A row or column of tiles with their shares of the room.
fn split(tiles: &mut Tiles<PanelKind>, direction: LinearDir, parts: &[(TileId, f32)]) -> TileId {
    let mut linear = Linear::new(direction, parts.iter().map(|&(tile, _)| tile).collect());
    for &(tile, share) in parts {
        linear.shares.set_share(tile, share);
    }
    tiles.insert_container(linear)
}
