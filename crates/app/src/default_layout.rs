//! Where the panels of each workspace stand at first, and how panels are brought back and closed.

use std::collections::BTreeSet;

use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
use workbench::PanelKind;
use workbench::workspace::{Arrangement, Workspace};

/// The size class of a window: how many panels it has room for at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SizeClass {
    /// Enough for five or six at a time.
    #[default]
    Wide,
    /// Enough for two or three.
    Narrow,
}

impl SizeClass {
    /// That of a window of this size in points.
    pub fn of(size: egui::Vec2) -> Self {
        if size.x < 1_160.0 || size.y < 640.0 { Self::Narrow } else { Self::Wide }
    }
}

/// The layout of a lesson, whose stop wants these panels beside it: rows of columns of tabs.
pub fn lesson_layout(rows: &[Vec<Vec<PanelKind>>], size: SizeClass) -> Tree<PanelKind> {
    let mut tiles = Tiles::default();
    let root = lesson_tiles(&mut tiles, rows, size);
    Tree::new(egui::Id::unique(("workspace", Arrangement::Lesson.name())), root, tiles)
}

fn lesson_tiles(tiles: &mut Tiles<PanelKind>, rows: &[Vec<Vec<PanelKind>>], size: SizeClass) -> TileId {
    let lesson = tabs(tiles, &[PanelKind::Lesson, PanelKind::Manual]);
    let parts_of_rows: Vec<(TileId, f32)> = rows
        .iter()
        .enumerate()
        .map(|(at, columns)| {
            let parts: Vec<(TileId, f32)> = columns.iter().map(|panels| (tabs(tiles, panels), 1.0)).collect();
            // What is above is the figure, what is below it explains it; a timeline is cut where it ends.
            let share = match at {
                0 if columns.first().and_then(|tabs| tabs.first()) == Some(&PanelKind::Timeline) => 1.7,
                0 => 1.3,
                _ => 1.0,
            };
            (split(tiles, LinearDir::Horizontal, &parts), share)
        })
        .collect();
    let figures = split(tiles, LinearDir::Vertical, &parts_of_rows);
    let share = if size == SizeClass::Wide { 0.33 } else { 0.38 };
    split(tiles, LinearDir::Horizontal, &[(lesson, share), (figures, 1.0 - share)])
}

/// Returns where its panels stand before the user moves them.
pub fn default_layout(arrangement: Arrangement, size: SizeClass) -> Tree<PanelKind> {
    let mut tiles = Tiles::default();
    let root = match (arrangement, size) {
        (Arrangement::Lesson, size) => {
            use PanelKind::{Editor, Network, Timeline};
            lesson_tiles(&mut tiles, &[vec![vec![Network]], vec![vec![Editor, Timeline]]], size)
        }
        (Arrangement::Of(workspace), SizeClass::Wide) => wide_layout(workspace, &mut tiles),
        (Arrangement::Of(workspace), SizeClass::Narrow) => narrow_layout(workspace, &mut tiles),
        (Arrangement::Program, SizeClass::Narrow) => {
            use PanelKind::{Automaton, Editor, Outline, Problems};
            tabs(&mut tiles, &[Automaton, Editor, Outline, Problems])
        }
        (Arrangement::Program, SizeClass::Wide) => {
            let text = tabs(&mut tiles, &[PanelKind::Editor, PanelKind::Outline, PanelKind::Problems]);
            let automaton = tabs(&mut tiles, &[PanelKind::Automaton]);
            split(&mut tiles, LinearDir::Horizontal, &[(text, 0.29), (automaton, 0.71)])
        }
    };
    Tree::new(egui::Id::unique(("workspace", arrangement.name())), root, tiles)
}

fn wide_layout(workspace: Workspace, tiles: &mut Tiles<PanelKind>) -> TileId {
    use LinearDir::{Horizontal, Vertical};
    use PanelKind::{
        Automaton, Compare, Distances, Editor, Execution, Network, Outline, Plan, Problems, Review,
        Robustness, Search, Strategy, Terrain, Timeline,
    };
    match workspace {
        Workspace::Author => {
            let text = tabs(tiles, &[Editor, Outline]);
            let plan = tabs(tiles, &[Plan, Problems]);
            let left = split(tiles, Vertical, &[(text, 0.66), (plan, 0.34)]);
            let timeline = tabs(tiles, &[Timeline]);
            let network = tabs(tiles, &[Network]);
            let terrain = tabs(tiles, &[Terrain]);
            let lower = split(tiles, Horizontal, &[(network, 0.6), (terrain, 0.4)]);
            let right = split(tiles, Vertical, &[(timeline, 0.46), (lower, 0.54)]);
            split(tiles, Horizontal, &[(left, 0.31), (right, 0.69)])
        }
        Workspace::Teach => {
            let text = tabs(tiles, &[Editor, Outline]);
            let plan = tabs(tiles, &[Plan, Strategy, Problems]);
            let left = split(tiles, Vertical, &[(text, 0.58), (plan, 0.42)]);
            let network = tabs(tiles, &[Network, Distances, Terrain]);
            let timeline = tabs(tiles, &[Timeline]);
            let middle = split(tiles, Vertical, &[(network, 0.68), (timeline, 0.32)]);
            let search = tabs(tiles, &[Search]);
            split(tiles, Horizontal, &[(left, 0.25), (middle, 0.40), (search, 0.35)])
        }
        Workspace::Review => {
            let review = tabs(tiles, &[Review, Plan]);
            let timeline = tabs(tiles, &[Timeline, Compare]);
            let network = tabs(tiles, &[Network]);
            let terrain = tabs(tiles, &[Terrain]);
            let text = tabs(tiles, &[Editor, Problems, Outline]);
            let middle = split(tiles, Horizontal, &[(network, 0.5), (terrain, 0.5)]);
            let right = split(tiles, Vertical, &[(timeline, 0.36), (middle, 0.34), (text, 0.30)]);
            split(tiles, Horizontal, &[(review, 0.38), (right, 0.62)])
        }
        Workspace::Execute => {
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
fn narrow_layout(workspace: Workspace, tiles: &mut Tiles<PanelKind>) -> TileId {
    use LinearDir::{Horizontal, Vertical};
    use PanelKind::{
        Automaton, Compare, Distances, Editor, Execution, Network, Outline, Plan, Problems, Review,
        Robustness, Search, Strategy, Terrain, Timeline,
    };
    let (left, right, share) = match workspace {
        Workspace::Author => {
            let text = tabs(tiles, &[Editor, Outline, Problems]);
            let network = tabs(tiles, &[Network, Terrain]);
            let plan = tabs(tiles, &[Timeline, Plan]);
            let right = split(tiles, Vertical, &[(plan, 0.62), (network, 0.38)]);
            (text, right, 0.36)
        }
        Workspace::Teach => {
            let network = tabs(tiles, &[Network, Distances, Timeline, Terrain]);
            let text = tabs(tiles, &[Editor, Plan, Strategy, Problems]);
            let left = split(tiles, Vertical, &[(network, 0.58), (text, 0.42)]);
            let search = tabs(tiles, &[Search]);
            (left, search, 0.52)
        }
        Workspace::Review => {
            let review = tabs(tiles, &[Review, Plan]);
            let timeline = tabs(tiles, &[Timeline, Compare, Network, Terrain]);
            let text = tabs(tiles, &[Editor, Problems]);
            let right = split(tiles, Vertical, &[(timeline, 0.6), (text, 0.4)]);
            (review, right, 0.48)
        }
        Workspace::Execute => {
            let left = tabs(tiles, &[Editor, Execution, Robustness, Problems]);
            let network = tabs(tiles, &[Network, Automaton, Terrain]);
            let timeline = tabs(tiles, &[Timeline, Plan]);
            let right = split(tiles, Vertical, &[(network, 0.55), (timeline, 0.45)]);
            (left, right, 0.4)
        }
    };
    split(tiles, Horizontal, &[(left, share), (right, 1.0 - share)])
}

/// Makes `tree` the layout `after` if it differs from `before` only in its active tabs. Tabs that the user turned to stay
/// active. Returns whether it did.
pub fn refit(tree: &mut Tree<PanelKind>, before: &Tree<PanelKind>, after: Tree<PanelKind>) -> bool {
    if unturned(tree) != unturned(before) {
        return false;
    }
    let in_front = |tree: &Tree<PanelKind>| -> BTreeSet<PanelKind> {
        let active = tree.active_tiles().into_iter();
        active.filter_map(|id| tree.tiles.get_pane(&id).copied()).collect()
    };
    let turned_to: Vec<PanelKind> = in_front(tree).difference(&in_front(before)).copied().collect();
    *tree = after;
    for panel in turned_to {
        tree.make_active(|_, tile| *tile == Tile::Pane(panel));
    }
    true
}

/// A layout with the first tabs in front.
fn unturned(tree: &Tree<PanelKind>) -> Tree<PanelKind> {
    let mut tree = tree.clone();
    for tile in tree.tiles.tiles_mut() {
        if let Tile::Container(Container::Tabs(tabs)) = tile {
            tabs.active = tabs.children.first().copied();
        }
    }
    tree
}

/// Brings a panel to the front, wherever it stands; a closed panel comes back beside the others.
pub fn show_panel(tree: &mut Tree<PanelKind>, panel: PanelKind) {
    if tree.tiles.find_pane(&panel).is_none() {
        let pane = tree.tiles.insert_pane(panel);
        let neighbors = largest_tabs(tree);
        match (neighbors, tree.root()) {
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
    is_sound(&tree).then_some(tree)
}

/// The shares of the room that tiles may have.
const SHARES: std::ops::RangeInclusive<f32> = 1e-6..=1e6;

/// Returns whether a layout that was kept is a tree whose tiles have room: it may have been damaged.
fn is_sound(tree: &Tree<PanelKind>) -> bool {
    let Some(root) = tree.root() else { return false };
    let mut waiting = vec![root];
    let mut seen = BTreeSet::new();
    while let Some(id) = waiting.pop() {
        let Some(tile) = tree.tiles.get(id).filter(|_| seen.insert(id.0)) else { return false };
        if let Tile::Container(container) = tile {
            let is_roomy = match container {
                Container::Linear(linear) => linear.shares.iter().all(|(_, share)| SHARES.contains(share)),
                Container::Tabs(_) => true,
                // No layout of ours has one.
                Container::Grid(_) => false,
            };
            if !is_roomy {
                return false;
            }
            waiting.extend(container.children());
        }
    }
    true
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_of_another_size_has_its_own_layout_whichever_tab_is_in_front() {
        use PanelKind::{Execution, Network};
        let of = |size| default_layout(Arrangement::Of(Workspace::Execute), size);
        let (wide, narrow) = (of(SizeClass::Wide), of(SizeClass::Narrow));
        let mut tree = wide.clone();
        show_panel(&mut tree, Execution);
        assert!(refit(&mut tree, &wide, narrow.clone()));
        let mut expected = narrow.clone();
        show_panel(&mut expected, Execution);
        assert_eq!(tree, expected, "it stays in front");
        // What the user closed or moved stays so.
        close_panel(&mut tree, Network);
        let moved = tree.clone();
        assert!(!refit(&mut tree, &narrow, wide));
        assert_eq!(tree, moved);
    }

    #[test]
    fn every_panel_has_a_place_in_a_default_layout_of_each_size() {
        for size in [SizeClass::Wide, SizeClass::Narrow] {
            let layouts = Arrangement::ALL.map(|arrangement| default_layout(arrangement, size));
            for panel in PanelKind::ALL {
                let has_place = layouts.iter().any(|layout| layout.tiles.find_pane(&panel).is_some());
                assert!(has_place, "{panel:?} is in no default layout, {size:?}");
            }
        }
    }

    /// The part of the window that each panel in front has.
    fn areas(tree: &Tree<PanelKind>) -> Vec<(f32, PanelKind)> {
        let mut areas = Vec::new();
        let mut waiting: Vec<(TileId, f32)> = tree.root().map(|root| (root, 1.0)).into_iter().collect();
        while let Some((id, area)) = waiting.pop() {
            match tree.tiles.get(id) {
                Some(Tile::Container(Container::Linear(linear))) => {
                    let sum: f32 = linear.children.iter().map(|&child| linear.shares[child]).sum();
                    waiting.extend(
                        linear.children.iter().map(|&child| (child, area * linear.shares[child] / sum)),
                    );
                }
                Some(Tile::Container(container)) => {
                    waiting.extend(container.children().next().map(|&it| (it, area)));
                }
                Some(Tile::Pane(panel)) => areas.push((area, *panel)),
                None => {}
            }
        }
        areas
    }

    #[test]
    fn the_timeline_is_the_largest_panel_of_the_author() {
        for size in [SizeClass::Wide, SizeClass::Narrow] {
            let areas = areas(&default_layout(Arrangement::Of(Workspace::Author), size));
            let largest = areas.iter().max_by(|left, right| left.0.total_cmp(&right.0));
            assert_eq!(largest.map(|it| it.1), Some(PanelKind::Timeline), "{size:?}: {areas:?}");
        }
    }

    #[test]
    fn a_kept_layout_that_is_no_tree_or_leaves_no_room_is_not_used() {
        let tree = default_layout(Arrangement::ALL[0], SizeClass::Wide);
        let text = to_text(&tree).expect("a layout has a text");
        assert!(from_text(&text).is_some());
        let kept: serde_json::Value = serde_json::from_str(&text).expect("it is JSON");
        let damaged = |share: &str| {
            let at = text.rfind("\"shares\":{").expect("there are shares");
            let colon = at + text[at + 11..].find(':').expect("a share") + 12;
            let end = colon + text[colon..].find([',', '}']).expect("it ends");
            format!("{}{share}{}", &text[..colon], &text[end..])
        };
        assert!(from_text(&damaged("1.0")).is_some());
        for share in ["1e30", "-1", "0"] {
            assert!(from_text(&damaged(share)).is_none(), "{share}");
        }
        let root = kept["root"].as_u64().expect("a root");
        let cyclic = text.replacen("\"children\":[", &format!("\"children\":[{root},"), 1);
        assert!(from_text(&cyclic).is_none());
        assert!(from_text("{}").is_none());
    }
}
