//! The altitude of a flight along a path: inside the vehicle's band, clear of the ground, and no steeper than it climbs.

use nalgebra::{Point3, distance};
use terrain::Terrain;

use crate::path::Path;
use crate::vehicle::{Drive, VehicleModel};

/// Points (east, north, up) of a flight along a path at the vehicle's greatest speed, as low as its band, its ground
/// clearance and its rate of climb allow. Over places where the vehicle can be ([`VehicleModel::configuration_space`])
/// this is never above the band. For a vehicle that drives, the ground under the path.
pub fn path_in_space(path: &Path, terrain: &Terrain, model: &VehicleModel) -> Vec<Point3<f64>> {
    let mut points: Vec<Point3<f64>> = Vec::new();
    for (from, to) in path.segments() {
        let skip = usize::from(!points.is_empty());
        points.extend(terrain.drape(from, to).into_iter().skip(skip));
    }
    if let (true, Some(&place)) = (points.is_empty(), path.points_m.first()) {
        points.push(Point3::new(place.x, place.y, terrain.height_at(place).unwrap_or(0.0)));
    }
    if let Drive::Flight { altitude_band_m, ground_clearance_m, climb_mps } = model.drive {
        let lowest = terrain.height_range_m().map_or(0.0, |[low, _]| f64::from(low));
        for point in &mut points {
            point.z = (point.z + ground_clearance_m).max(lowest + altitude_band_m[0]);
        }
        let grade = climb_mps / model.speed_mps;
        limit_climb(&mut points, grade);
        points.reverse();
        limit_climb(&mut points, grade);
        points.reverse();
    }
    points
}

/// Raises points so that none lies more below the one before than the grade allows.
fn limit_climb(points: &mut [Point3<f64>], grade: f64) {
    for index in 1..points.len() {
        let (before, point) = (points[index - 1], &mut points[index]);
        point.z = point.z.max(before.z - grade * distance(&point.xy(), &before.xy()));
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::vehicle::vehicle_model;
    use terrain::GridFrame;

    #[test]
    fn a_blimp_rises_in_time_for_a_ridge_and_stays_in_its_band() {
        let frame = GridFrame::new(400, 12, 0.6);
        let heights = (0..frame.cell_count())
            .map(|index| if (200..220).contains(&(index % 400)) { 25.0 } else { 0.0 })
            .collect();
        let terrain = Terrain::new(frame, heights);
        let model = vehicle_model("Blimp").unwrap();
        let path = Path::new(vec![Point2::new(5.0, 3.0), Point2::new(120.0, 3.5), Point2::new(235.0, 3.0)]);
        let flight = path_in_space(&path, &terrain, model);
        assert_eq!(flight[0].xy(), Point2::new(5.0, 3.0));
        assert!(flight.iter().any(|point| point.z >= 30.0));
        for point in &flight {
            let ground = terrain.height_at(point.xy()).unwrap();
            assert!(point.z >= ground + 5.0 - 1e-9 && point.z >= 10.0 && point.z <= 40.0, "{point:?}");
        }
        for pair in flight.windows(2) {
            let ahead = (pair[1].x - pair[0].x).hypot(pair[1].y - pair[0].y);
            assert!((pair[1].z - pair[0].z).abs() <= 0.2 * ahead + 1e-9);
        }
    }
}
