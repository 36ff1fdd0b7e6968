//! The altitude of a flight along a path: inside the vehicle's band, clear of the ground, and no steeper than it climbs.

use terrain::Terrain;

use crate::path::Path;
use crate::vehicle::{Drive, VehicleModel};

/// Points (east, north, up) of a flight along a path at the vehicle's greatest speed, as low as its band, its ground
/// clearance and its rate of climb allow. Over places where the vehicle can be ([`VehicleModel::configuration_space`])
/// this is never above the band. For a vehicle that drives, the ground under the path.
pub fn path_in_space(path: &Path, terrain: &Terrain, model: &VehicleModel) -> Vec<[f64; 3]> {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for (from, to) in path.segments() {
        let skip = usize::from(!points.is_empty());
        points.extend(terrain.drape(from, to).into_iter().skip(skip));
    }
    if let (true, Some(&[east, north])) = (points.is_empty(), path.points_m.first()) {
        points.push([east, north, terrain.height_at([east, north]).unwrap_or(0.0)]);
    }
    if let Drive::Flight { altitude_band_m, ground_clearance_m, climb_mps } = model.drive {
        let lowest = terrain.height_range_m().map_or(0.0, |[low, _]| f64::from(low));
        for point in &mut points {
            point[2] = (point[2] + ground_clearance_m).max(lowest + altitude_band_m[0]);
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
fn limit_climb(points: &mut [[f64; 3]], grade: f64) {
    for index in 1..points.len() {
        let (before, point) = (points[index - 1], &mut points[index]);
        let (east, north) = (point[0] - before[0], point[1] - before[1]);
        point[2] = point[2].max(before[2] - grade * (east * east + north * north).sqrt());
    }
}

#[cfg(test)]
mod tests {
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
        let path = Path::new(vec![[5.0, 3.0], [120.0, 3.5], [235.0, 3.0]]);
        let flight = path_in_space(&path, &terrain, model);
        assert_eq!([flight[0][0], flight[0][1]], [5.0, 3.0]);
        assert!(flight.iter().any(|point| point[2] >= 30.0));
        for point in &flight {
            let ground = terrain.height_at([point[0], point[1]]).unwrap();
            assert!(point[2] >= ground + 5.0 - 1e-9 && point[2] >= 10.0 && point[2] <= 40.0, "{point:?}");
        }
        for pair in flight.windows(2) {
            let ahead = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            assert!((pair[1][2] - pair[0][2]).abs() <= 0.2 * ahead + 1e-9);
        }
    }
}
