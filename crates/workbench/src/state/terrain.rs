//! What is done on the terrain: the tool in hand, what it has measured or placed so far, and where the camera is to go.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::Point2;
use rmpl::Span;
use smol_str::SmolStr;
use snapshot::MapKey;
use terrain::Terrain;
use text_editing::{Caret, EditKind};

use crate::PanelKind;
use crate::command::ViewAction;
use crate::state::growth::{Growth, GrowthCommand, GrowthInput};
use crate::state::placing::{self, NewThing, VehicleStart};
use crate::state::{AppState, Selection, Snapshots, ToastKind};

/// What clicks on the ground do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Clicks select things.
    #[default]
    Look,
    /// They measure from place to place.
    Measure,
    /// They declare a location.
    Location,
    /// They declare a round obstacle; a drag gives its radius.
    Circle,
    /// They make a round obstacle appear in the run that is watched; a drag gives its radius.
    Appear,
    /// They add a corner of an obstacle.
    Polygon,
    /// A drag declares a wall from where it begins to where it ends.
    Wall,
    /// They declare a vehicle of this model.
    Vehicle(SmolStr),
}

impl Tool {
    /// Its name for programs.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Look => "look",
            Self::Measure => "measure",
            Self::Location => "location",
            Self::Circle => "circle",
            Self::Appear => "appear",
            Self::Polygon => "polygon",
            Self::Wall => "wall",
            Self::Vehicle(_) => "vehicle",
        }
    }
}

/// The tool in hand and what it has so far.
#[derive(Clone, Debug, Default)]
pub struct TerrainState {
    /// What clicks do.
    pub tool: Tool,
    /// The places clicked so far, in metres east and north: ends of a measurement, corners of an obstacle.
    pub points_m: Vec<Point2<f64>>,
    /// The growth of search trees.
    pub growth: Growth,
}

/// What can be asked of the terrain.
#[derive(Clone, Debug, PartialEq)]
pub enum TerrainCommand {
    /// Takes a tool in hand; the one that is already there is put away.
    Take(Tool),
    /// A click of a tool that collects places.
    Point(Point2<f64>),
    /// Takes the last place back.
    TakeBack,
    /// The corners so far are an obstacle.
    Finish,
    /// Declares something in the text.
    Place {
        thing: NewThing,
        /// Whether the tool stays in hand.
        again: bool,
    },
    /// Makes a vehicle start elsewhere.
    MoveStart { vehicle: SmolStr, start: VehicleStart },
    /// Moves the camera, and brings the terrain to the front.
    View(ViewAction),
    /// Shows the clearance map, or hides it.
    ToggleClearance,
    /// Something that concerns the growth of search trees.
    Growth(GrowthCommand),
}

impl AppState {
    pub(crate) fn apply_to_terrain(&mut self, command: TerrainCommand) {
        match command {
            TerrainCommand::Take(tool) => {
                let is_in_hand = self.terrain.tool == tool;
                self.terrain.tool = if is_in_hand { Tool::Look } else { tool };
                self.terrain.points_m.clear();
                self.turn_to_terrain();
            }
            TerrainCommand::Point(at_m) => {
                if self.terrain.tool == Tool::Measure && self.terrain.points_m.len() >= 2 {
                    self.terrain.points_m.clear();
                }
                self.terrain.points_m.push(at_m);
            }
            TerrainCommand::TakeBack => {
                self.terrain.points_m.pop();
            }
            TerrainCommand::Finish => {
                let corners_m = std::mem::take(&mut self.terrain.points_m);
                if corners_m.len() >= 3 {
                    self.place(&NewThing::Polygon(corners_m), false);
                }
            }
            TerrainCommand::Place { thing, again } => self.place(&thing, again),
            TerrainCommand::MoveStart { vehicle, start } => {
                let Some(program) = self.language.parse().map(rmpl::Parse::program) else { return };
                if let Some(edits) = placing::move_start(self.document.text(), &program, &vehicle, &start) {
                    self.document.edit(&edits, EditKind::Single, None);
                    self.selection = Selection::Vehicle(vehicle);
                }
            }
            TerrainCommand::View(action) => {
                self.turn_to_terrain();
                self.request_view(PanelKind::Terrain, action);
            }
            TerrainCommand::ToggleClearance => {
                let view = &mut self.settings.views.terrain;
                view.clearance = !view.clearance;
                self.turn_to_terrain();
            }
            TerrainCommand::Growth(command) => {
                let input = growth_input(&self.snapshots, &self.maps, &self.selection);
                self.terrain.growth.apply(command, input);
                if command == GrowthCommand::Toggle {
                    self.turn_to_terrain();
                }
            }
        }
    }

    /// A map was imported: texts that name it are worked out anew.
    pub(super) fn take_map(&mut self, name: &str, [width, height]: [u32; 2], no_data_cells: u64) {
        let holes = match no_data_cells {
            0 => String::new(),
            1 => ", one without data".to_owned(),
            count => format!(", {count} without data"),
        };
        let use_it = format!("A mission uses it by: terrain \"{name}\";");
        self.toasts
            .add(ToastKind::Done, format!("{name} is a map of {width} × {height} cells{holes}. {use_it}"));
    }

    /// Adapts what the terrain shows to the snapshot that is shown now.
    pub(super) fn follow_with_terrain(&mut self) {
        let input = growth_input(&self.snapshots, &self.maps, &self.selection);
        self.terrain.growth.follow(input);
    }

    /// Leaves what is under way on the terrain; whether there was something.
    pub(super) fn escape_from_terrain(&mut self) -> bool {
        let had_points = !self.terrain.points_m.is_empty();
        let had_tool = self.terrain.tool != Tool::Look;
        self.terrain.points_m.clear();
        if !had_points {
            self.terrain.tool = Tool::Look;
        }
        had_points || had_tool
    }

    fn turn_to_terrain(&mut self) {
        self.show_panel(PanelKind::Terrain);
        self.active_panel = PanelKind::Terrain;
    }

    /// Declares `thing`, selects it, and shows its name in the text.
    fn place(&mut self, thing: &NewThing, again: bool) {
        let Some(program) = self.language.parse().map(rmpl::Parse::program) else {
            self.toasts.add(ToastKind::Failed, "A control program has no places");
            return;
        };
        let declared = placing::declare(self.document.text(), &program, thing);
        self.document.edit(&declared.edits, EditKind::Single, None);
        if let Some(start) = self.document.text().find(&declared.text) {
            let name = name_span(start, &declared.text);
            self.document.set_caret(Caret::selecting(name.start as usize, name.end as usize));
            self.scroll_to(name, true);
        }
        self.selection = declared.selection;
        if !again {
            self.terrain.tool = Tool::Look;
        }
    }
}

/// What the growth of a search tree is made from, if the mission and its ground are there.
fn growth_input<'a>(
    snapshots: &'a Snapshots,
    maps: &'a BTreeMap<MapKey, Arc<Terrain>>,
    selection: &'a Selection,
) -> Option<GrowthInput<'a>> {
    let snapshot = snapshots.shown()?;
    maps.get(snapshot.map.as_ref()?)?;
    Some(GrowthInput { snapshot, selection })
}

/// The second word of a declaration that begins at `start`: its name.
fn name_span(start: usize, declaration: &str) -> Span {
    let before = declaration.find(' ').map_or(0, |space| space + 1);
    let rest = declaration.get(before..).unwrap_or_default();
    let length = rest.find(' ').unwrap_or(rest.len());
    let from = start + before;
    Span::new(from as u32, (from + length) as u32)
}
