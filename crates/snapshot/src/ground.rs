//! The ground of a mission as it is drawn: declared obstacles, and how far vehicles are from them.

use motion::VehicleModel;
use nalgebra::Point2;
use rmpl::program::{ObstacleShape, World};
use terrain::{GridFrame, Obstacle, Terrain};

/// The clearance of a map for one kind of vehicle, as a picture over the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct ClearanceOverlay {
    /// Where the cells lie.
    pub frame: GridFrame,
    /// Metres from a vehicle's rim and margin to the nearest obstacle, row by row from the south; negative where it
    /// can't be, infinite on a map without obstacles.
    pub clearance_m: Vec<f32>,
}

impl ClearanceOverlay {
    /// For vehicles of `model` among the obstacles of `world`. Linear in the number of cells: keep it while the map,
    /// the obstacles and the model stay the same.
    pub fn new(map: &Terrain, world: &World, model: &VehicleModel) -> Self {
        let shapes: Vec<Obstacle> = world.obstacles.iter().map(|it| obstacle(&it.shape)).collect();
        let space = model.configuration_space(map, &shapes);
        Self { frame: *space.frame(), clearance_m: space.clearance_map_m() }
    }
}

/// A declared obstacle as the terrain knows it.
pub fn obstacle(shape: &ObstacleShape) -> Obstacle {
    match shape {
        ObstacleShape::Circle { center_m, radius_m } => {
            Obstacle::Circle { center_m: (*center_m).into(), radius_m: *radius_m }
        }
        ObstacleShape::Polygon { corners_m } => {
            Obstacle::Polygon { corners_m: corners_m.iter().copied().map(Point2::from).collect() }
        }
    }
}
