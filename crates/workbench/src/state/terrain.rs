//! What is done on the terrain: the tool in hand, what it has measured or placed so far, and where the camera is to go.

use nalgebra::Point2;
use rmpl::Span;
use smol_str::SmolStr;
use text_editing::{Caret, EditKind};

use crate::area::Area;
use crate::effect::Effect;
use crate::panel_effect::ViewAction;
use crate::panel_kind::PanelKind;
use crate::state::editing::Writing;
use crate::state::files;
use crate::state::growth::{Growth, GrowthCommand};
use crate::state::part::Part;
use crate::state::placing::{self, NewThing, VehicleStart};
use crate::state::selection::Selection;
use crate::state::settings::Settings;

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
    /// The places clicked so far, in meters east and north: ends of a measurement, corners of an obstacle.
    pub points_m: Vec<Point2<f64>>,
    /// The growth of search trees.
    pub growth: Growth,
    /// The video that is recorded, if one is.
    pub film: Option<Film>,
}

/// A video of the terrain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Film {
    /// It begins when the terrain is on screen.
    Wanted,
    /// What is drawn in this part of the window is recorded.
    Rolling(Area),
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
    /// Records a video of the plan or the run from its start to its end, or ends it and saves what there is.
    ToggleVideo,
    /// The video that is wanted or recorded is of this part of the window.
    FilmArea(Area),
}

impl TerrainState {
    /// Does what a command asks for; what is declared is declared in `text`.
    pub(crate) fn apply(
        &mut self,
        command: TerrainCommand,
        settings: &mut Part<Settings>,
        text: &mut Writing<'_>,
    ) {
        match command {
            TerrainCommand::Take(tool) => {
                self.tool = if self.tool == tool { Tool::Look } else { tool };
                self.points_m.clear();
                text.window.turn_to(PanelKind::Terrain);
            }
            TerrainCommand::Point(at_m) => {
                if self.tool == Tool::Measure && self.points_m.len() >= 2 {
                    self.points_m.clear();
                }
                self.points_m.push(at_m);
            }
            TerrainCommand::TakeBack => {
                self.points_m.pop();
            }
            TerrainCommand::Finish => {
                let corners_m = std::mem::take(&mut self.points_m);
                if corners_m.len() >= 3 {
                    self.place(&NewThing::Polygon(corners_m), false, text);
                }
            }
            TerrainCommand::Place { thing, again } => self.place(&thing, again, text),
            TerrainCommand::MoveStart { vehicle, start } => text.move_start(vehicle, &start),
            TerrainCommand::View(action) => {
                text.window.turn_to(PanelKind::Terrain);
                text.window.view(PanelKind::Terrain, action);
            }
            TerrainCommand::ToggleClearance => {
                let view = &mut settings.views.terrain;
                view.clearance = !view.clearance;
                text.window.turn_to(PanelKind::Terrain);
            }
            TerrainCommand::Growth(command) => {
                self.growth.apply(command, text.maps.growth_input(text.snapshots, text.selection));
                if command == GrowthCommand::Toggle {
                    text.window.turn_to(PanelKind::Terrain);
                }
            }
            TerrainCommand::ToggleVideo => {
                self.film = Some(Film::Wanted);
                text.window.turn_to(PanelKind::Terrain);
            }
            TerrainCommand::FilmArea(area) => {
                if self.film.is_some() {
                    self.film = Some(Film::Rolling(area));
                    text.window.ask(Effect::Film(area));
                }
            }
        }
    }

    /// Declares `thing`, and puts the tool away unless it is wanted again.
    fn place(&mut self, thing: &NewThing, again: bool, text: &mut Writing<'_>) {
        if text.place(thing) && !again {
            self.tool = Tool::Look;
            // What is typed next is its name.
            if text.window.panels_on_screen.contains(&PanelKind::Editor) {
                text.window.focus_panel(PanelKind::Editor);
            }
        }
    }

    /// Leaves what is under way on the terrain; whether there was something.
    pub(crate) fn escape(&mut self) -> bool {
        let had_points = !self.points_m.is_empty();
        let had_tool = self.tool != Tool::Look;
        self.points_m.clear();
        if !had_points {
            self.tool = Tool::Look;
        }
        had_points || had_tool
    }
}

impl Writing<'_> {
    /// Makes a vehicle start elsewhere, and selects it.
    fn move_start(&mut self, vehicle: SmolStr, start: &VehicleStart) {
        let Some(program) = self.language.parse().map(rmpl::Parse::program) else { return };
        if let Some(edits) =
            placing::move_start(self.document.text(), files::shown(self.document), &program, &vehicle, start)
        {
            self.document.edit(&edits, EditKind::Single, None);
            **self.selection = Selection::Vehicle(vehicle);
        }
    }

    /// Declares `thing`, selects it, and shows its name in the text; false where nothing can be declared.
    fn place(&mut self, thing: &NewThing) -> bool {
        let Some(program) = self.language.parse().map(rmpl::Parse::program) else {
            self.window.failed("Control programs have no map. Open a mission first.");
            return false;
        };
        let declared = placing::declare(self.document.text(), files::shown(self.document), &program, thing);
        self.document.edit(&declared.edits, EditKind::Single, None);
        if let Some(start) = self.document.text().find(&declared.text) {
            let name = name_span(start, &declared.text);
            self.document.set_caret(Caret::selecting(name.start as usize, name.end as usize));
            self.window.scroll_to(name, true);
        }
        **self.selection = declared.selection;
        true
    }
}

/// The second word of a declaration that begins at `start`: its name.
fn name_span(start: usize, declaration: &str) -> Span {
    let before = declaration.find(' ').map_or(0, |space| space + 1);
    let rest = declaration.get(before..).unwrap_or_default();
    let length = rest.find(' ').unwrap_or(rest.len());
    let from = start + before;
    Span::new(from as u32, (from + length) as u32)
}
