//! The ground of a mission: declared obstacles and keep-out areas.

use nalgebra::Point2;
use rmpl::fleet::is_of;
use rmpl::program::{Name, ObstacleDecl, ObstacleKind, ObstacleShape, World};
use terrain::Obstacle;

use crate::vehicle::flies;

/// Returns what vehicles, by their indices, may not enter while `activity` moves them: obstacles unless all of them
/// fly, and the keep-out areas that are closed to one of them, to its model, or to the activity.
pub fn closed_to<'a>(
    world: &'a World,
    vehicles: &'a [usize],
    activity: &'a str,
) -> impl Iterator<Item = &'a ObstacleDecl> {
    let is_named = move |name: &Name| {
        let mut moved = vehicles.iter().filter_map(|&vehicle| world.vehicles.get(vehicle));
        name.text == activity
            || moved.any(|it| it.name.text == name.text || is_of(world, &it.model.text, &name.text))
    };
    world.obstacles.iter().filter(move |obstacle| match &obstacle.kind {
        ObstacleKind::Solid => {
            vehicles.is_empty() || vehicles.iter().any(|&vehicle| !flies(world, vehicle as u32))
        }
        ObstacleKind::KeepOut { closed_to } => closed_to.is_empty() || closed_to.iter().any(is_named),
    })
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
