//! The ground of missions: named or imported maps, and the free space of each kind of vehicle on them.

use std::collections::BTreeMap;
use std::sync::Arc;

use motion::VehicleModel;
use nalgebra::{Point2, Vector2};
use rmpl::diagnostics::map;
use rmpl::program::{ObstacleShape, Program, TerrainDecl, World};
use rmpl::{Code, Diagnostic};
use sha2::{Digest as _, Sha256};
use smol_str::SmolStr;
use snapshot::{MapKey, standing, vehicle};
use terrain::format::ImportOptions;
use terrain::{ConfigurationSpace, GridFrame, Obstacle, Terrain};

use crate::simulation::nearest_free;
use crate::spots::ON_THE_WAY;
use crate::traverse::Waypoint;

/// How many free spaces are kept. Vehicle models have one each, and one more for each set of areas that are closed to them.
const MAX_SPACES: usize = 8;
/// Cells along the side of the flat ground of a mission that names no terrain.
const FLAT_CELLS: u32 = 256;

/// The maps that missions may name, and what was computed from them.
#[derive(Default)]
pub struct Grounds {
    imported: BTreeMap<SmolStr, Imported>,
    maps: BTreeMap<MapKey, Arc<Terrain>>,
    spaces: Vec<(SpaceKey, FreeSpace)>,
}

/// Where a kind of vehicle can be.
#[derive(Clone, Debug)]
pub struct FreeSpace {
    /// With circumradius and margin, as SPEC 7.1 says.
    pub exact: Arc<ConfigurationSpace>,
    /// With more room around the vehicle, most room first: where paths are looked for first.
    pub roomy: Vec<Arc<ConfigurationSpace>>,
}

/// Where all vehicles that drive, or all that fly, can stand beside a location: in the spaces of their models.
#[derive(Clone)]
pub(crate) struct StandingGround(Vec<Arc<ConfigurationSpace>>);

/// Where there is room for the vehicles of a route at its ends.
pub(crate) struct EndGround {
    pub(crate) standing: StandingGround,
    /// Where the route can be.
    pub(crate) space: Arc<ConfigurationSpace>,
}

impl EndGround {
    /// The place itself, or the nearest one with room if it is beside its location: the same for a drive that leads there and
    /// for the next one from there. A vehicle that has stopped on its way, or behind another one, needs room for this route
    /// only.
    pub(crate) fn free_m(&self, place: &Waypoint) -> Point2<f64> {
        let place_m = place.position_m;
        let free_m = match place.slot {
            0 if !place.is_behind => None,
            _ if place.is_behind || place.slot == ON_THE_WAY => {
                nearest_free(|place_m| self.space.is_free(place_m), place_m)
            }
            _ => nearest_free(|place_m| self.standing.0.iter().all(|space| space.is_free(place_m)), place_m),
        };
        free_m.unwrap_or(place_m)
    }
}

/// Meters of room beyond the margin that a path keeps where that makes it little longer.
const ROOM_M: [f64; 2] = [1.5, 0.5];

struct Imported {
    version: [u8; 32],
    map: Terrain,
    /// Cells whose gray level means neither free nor occupied.
    num_unclear: usize,
}

#[derive(Clone, PartialEq)]
struct SpaceKey {
    map: MapKey,
    model: VehicleModel,
    obstacles: Vec<ObstacleShape>,
}

impl Grounds {
    /// Reads a map file so that `terrain "name"` finds it, and answers the map; says why when it can't be read.
    pub fn import(&mut self, name: &str, bytes: &[u8]) -> Result<&Terrain, String> {
        let raster = terrain::format::read_raster(bytes, &ImportOptions::default())
            .map_err(|error| error.to_string())?;
        let num_unclear = raster.num_unclear;
        let map = raster.into_terrain();
        let version = Sha256::digest(bytes).into();
        self.maps.retain(|key, _| key.asset != name);
        let name = SmolStr::new(name);
        self.imported.insert(name.clone(), Imported { version, map, num_unclear });
        self.imported.get(&name).map(|imported| &imported.map).ok_or_else(String::new)
    }

    /// The map of a mission: the one that it names, or flat ground around the places where its vehicles may stand. `None`, with a diagnostic, when
    /// the name is unknown, and without one when the mission has no world.
    pub fn resolve(&mut self, program: &Program) -> (Option<(MapKey, Arc<Terrain>)>, Vec<Diagnostic>) {
        let Some(declared) = &program.world.terrain else {
            return (self.flat(program), Vec::new());
        };
        let imported = self.imported.get(&declared.asset);
        let version = imported.map(|imported| imported.version);
        // A map of a file has its own scale and place, unless the mission says others.
        let of_file = imported.map(|imported| imported.map.frame());
        let cell_m = declared.cell_m.or(of_file.map(|frame| frame.cell_size_m));
        let cell_m = cell_m.unwrap_or(terrain::format::DEFAULT_CELL_SIZE_M);
        let origin_m = declared.origin_m.or(of_file.map(|frame| frame.origin_m.into())).unwrap_or_default();
        let millimeters = |meters: f64| (meters * 1000.0).round();
        let key = MapKey {
            asset: declared.asset.clone(),
            cell_mm: millimeters(cell_m) as u32,
            origin_mm: origin_m.map(|meters| millimeters(meters) as i64),
            version,
        };
        if let Some(map) = self.maps.get(&key) {
            return (Some((key, Arc::clone(map))), Vec::new());
        }
        let made = match self.imported.get(&declared.asset) {
            Some(imported) => Some(imported.map.clone()),
            None => terrain::asset(&declared.asset),
        };
        let Some(made) = made else {
            return (None, vec![self.unknown_terrain(declared)]);
        };
        let map = Arc::new(made.placed(cell_m, origin_m.into()));
        self.maps.retain(|other, _| other.asset == key.asset);
        self.maps.insert(key.clone(), Arc::clone(&map));
        (Some((key, map)), Vec::new())
    }

    /// That the map of a mission has gray levels between free and occupied, if it does.
    pub(crate) fn unclear_cells(&self, program: &Program) -> Option<Diagnostic> {
        let declared = program.world.terrain.as_ref()?;
        let imported = self.imported.get(&declared.asset).filter(|imported| imported.num_unclear > 0)?;
        let frame = imported.map.frame();
        let all = frame.width as usize * frame.height as usize;
        Some(map::unclear((imported.num_unclear, all), &declared.asset, declared.asset_span))
    }

    /// The free space of vehicles of `model` among `obstacles`.
    pub fn space(
        &mut self,
        key: &MapKey,
        map: &Terrain,
        model: &VehicleModel,
        obstacles: Vec<ObstacleShape>,
    ) -> FreeSpace {
        let wanted = SpaceKey { map: key.clone(), model: *model, obstacles };
        if let Some(at) = self.spaces.iter().position(|(known, _)| *known == wanted) {
            let found = self.spaces.remove(at);
            let space = found.1.clone();
            self.spaces.push(found);
            return space;
        }
        let shapes: Vec<Obstacle> = wanted.obstacles.iter().map(snapshot::ground::obstacle).collect();
        let exact = model.configuration_space(map, &shapes);
        let wider = |room_m: f64| Arc::new(exact.with_radius_m(exact.radius_m() + room_m));
        let space = FreeSpace { roomy: ROOM_M.map(wider).into(), exact: Arc::new(exact) };
        if self.spaces.len() >= MAX_SPACES {
            self.spaces.remove(0);
        }
        self.spaces.push((wanted, space.clone()));
        space
    }

    /// Returns where every vehicle can stand that flies, or that drives, whatever moves it there and away again.
    pub(crate) fn standing(
        &mut self,
        (key, map): (&MapKey, &Arc<Terrain>),
        world: &World,
        flies: bool,
    ) -> StandingGround {
        let closed = world.obstacles.iter().filter(|obstacle| !(flies && obstacle.is_solid()));
        let closed: Vec<ObstacleShape> = closed.map(|obstacle| obstacle.shape.clone()).collect();
        let all = (0..world.vehicles.len()).filter(|&it| vehicle::flies(world, it as u32) == flies);
        let mut models: Vec<VehicleModel> = Vec::new();
        for model in all.filter_map(|it| vehicle::model_of(world, it)) {
            if !models.contains(&model) {
                models.push(model);
            }
        }
        let space = |model: &VehicleModel| self.space(key, map, model, closed.clone()).exact;
        StandingGround(models.iter().map(space).collect())
    }

    fn flat(&mut self, program: &Program) -> Option<(MapKey, Arc<Terrain>)> {
        let (low, high) = extent(&program.world)?;
        let extent_m = (high - low).max();
        let side_m = (extent_m.max(20.0) * 1.2).max(extent_m + 2.0 * standing::reach_m(program));
        let cell_m = (side_m / f64::from(FLAT_CELLS)).max(0.1);
        let origin_m = nalgebra::center(&low, &high) - Vector2::repeat(side_m / 2.0);
        let key = MapKey {
            asset: SmolStr::default(),
            cell_mm: (cell_m * 1000.0).ceil() as u32,
            origin_mm: origin_m.map(|meters| (meters * 1000.0).floor() as i64).into(),
            version: None,
        };
        let frame = GridFrame {
            width: FLAT_CELLS,
            height: FLAT_CELLS,
            cell_size_m: f64::from(key.cell_mm) / 1000.0,
            origin_m: key.origin_mm.map(|millimeters| millimeters as f64 / 1000.0).into(),
        };
        let map = self.maps.entry(key.clone()).or_insert_with(|| Arc::new(Terrain::flat(frame)));
        Some((key, Arc::clone(map)))
    }

    fn unknown_terrain(&self, declared: &TerrainDecl) -> Diagnostic {
        let imported = self.imported.keys().map(SmolStr::to_string);
        let known: Vec<String> = terrain::asset_names().map(str::to_owned).chain(imported).collect();
        let message = format!("unknown terrain \"{}\"", declared.asset);
        Diagnostic::error(Code("E-UNDEF"), declared.asset_span, message)
            .with_hint(format!("import a map file with this name, or use one of: {}", known.join(", ")))
    }
}

/// The least and greatest coordinates of the places of a world.
fn extent(world: &World) -> Option<(Point2<f64>, Point2<f64>)> {
    let mut places = world.locations.iter().map(|location| Point2::from(location.position_m));
    let first = places.next()?;
    Some(places.fold((first, first), |(low, high), place| (low.inf(&place), high.sup(&place))))
}
