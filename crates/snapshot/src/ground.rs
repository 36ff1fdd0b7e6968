//! The ground of a mission: declared obstacles.

use nalgebra::Point2;
use rmpl::program::ObstacleShape;
use terrain::Obstacle;

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
