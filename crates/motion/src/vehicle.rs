//! The vehicle models that a mission can name (SPEC 1.8, 7.1). Every field can be changed by whoever makes a model.

use serde::Serialize;
use terrain::{ConfigurationSpace, Obstacle, Occupancy, Terrain, Traversability};

/// What a vehicle is and can do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VehicleModel {
    /// The name in a `vehicle` declaration; of a model that a mission declares, that of the one which it is made from.
    pub name: &'static str,
    /// From front to back in meters.
    pub length_m: f64,
    /// From side to side in meters.
    pub width_m: f64,
    /// From the ground to the top, or for a blimp of its hull, in meters.
    pub height_m: f64,
    /// Height of the antenna over the ground in meters, or for a blimp over its hull (SPEC 10.5).
    pub mast_m: f64,
    /// Radius in meters of the least disc around the vehicle's center that holds it in every heading.
    pub circumradius_m: f64,
    /// What is kept free around that disc, in meters.
    pub margin_m: f64,
    /// Least speed in meters per second; at 0 the vehicle may stop on its way.
    pub min_speed_mps: f64,
    /// Greatest speed in meters per second.
    pub speed_mps: f64,
    /// Greatest turning rate in radians per second.
    pub turn_rate_rps: f64,
    /// Greatest acceleration and deceleration in meters per second squared.
    pub acceleration_mps2: f64,
    /// Greatest change of the turning rate in radians per second squared.
    pub turn_acceleration_rps2: f64,
    pub drive: Drive,
}

/// How a vehicle moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Drive {
    /// Wheels that turn the vehicle by running at different speeds.
    SkidSteer {
        /// Between the left and right wheels in meters.
        track_m: f64,
        /// Effective track over geometric track: wheels slip sideways in a turn (SPEC 7.2).
        slip: f64,
        /// Wheel radius in meters.
        wheel_radius_m: f64,
        /// Greatest climb, in meters up for each meter forward.
        max_grade: f64,
        /// Least diameter of a rock that it can't pass over, in meters.
        rock_diameter_m: f64,
    },
    /// Flight in a band of altitudes over the lowest ground of the map.
    Flight {
        /// Least and greatest altitude over the map's lowest ground, in meters.
        altitude_band_m: [f64; 2],
        /// Least height over the ground below, in meters.
        ground_clearance_m: f64,
        /// Greatest speed up or down in meters per second.
        climb_mps: f64,
    },
}

/// The models of the paper's mission. Dimensions and speeds of the rovers are those of SPEC 7.1; grades, rock sizes,
/// margins masts and the whole blimp (about the size of outdoor research blimps of those years) are this project's choice.
pub const VEHICLE_MODELS: [VehicleModel; 3] = [
    VehicleModel {
        name: "ATRV",
        length_m: 1.02,
        width_m: 0.84,
        height_m: 0.65,
        mast_m: 1.5,
        circumradius_m: 0.661,
        margin_m: 0.1,
        min_speed_mps: 0.0,
        speed_mps: 0.8,
        turn_rate_rps: 0.4,
        acceleration_mps2: 0.5,
        turn_acceleration_rps2: 1.0,
        drive: Drive::SkidSteer {
            track_m: 0.62,
            slip: 1.75,
            wheel_radius_m: 0.2,
            max_grade: 0.364,
            rock_diameter_m: 0.5,
        },
    },
    VehicleModel {
        name: "ATRV-Jr",
        length_m: 0.80,
        width_m: 0.65,
        height_m: 0.55,
        mast_m: 1.5,
        circumradius_m: 0.515,
        margin_m: 0.1,
        min_speed_mps: 0.0,
        speed_mps: 1.0,
        turn_rate_rps: 0.5,
        acceleration_mps2: 0.6,
        turn_acceleration_rps2: 2.6,
        drive: Drive::SkidSteer {
            track_m: 0.50,
            slip: 1.75,
            wheel_radius_m: 0.155,
            max_grade: 0.364,
            rock_diameter_m: 0.4,
        },
    },
    VehicleModel {
        name: "Blimp",
        length_m: 8.0,
        width_m: 2.0,
        height_m: 2.4,
        mast_m: 0.0,
        circumradius_m: 4.124,
        margin_m: 0.5,
        min_speed_mps: 0.0,
        speed_mps: 4.0,
        turn_rate_rps: 0.3,
        acceleration_mps2: 0.4,
        turn_acceleration_rps2: 0.2,
        drive: Drive::Flight { altitude_band_m: [10.0, 40.0], ground_clearance_m: 5.0, climb_mps: 0.8 },
    },
];

/// The model of this name.
pub fn vehicle_model(name: &str) -> Option<&'static VehicleModel> {
    VEHICLE_MODELS.iter().find(|model| model.name == name)
}

impl VehicleModel {
    /// The same with another body, whose wheels stand as far apart in proportion.
    #[must_use]
    pub fn with_body(mut self, length_m: f64, width_m: f64) -> Self {
        if let Drive::SkidSteer { track_m, .. } = &mut self.drive {
            *track_m *= width_m / self.width_m;
        }
        let circumradius_m = 0.5 * (length_m * length_m + width_m * width_m).sqrt();
        Self { length_m, width_m, circumradius_m, ..self }
    }

    /// The same with another steepest slope, in radians; what flies has none.
    #[must_use]
    pub fn with_slope(mut self, angle_rad: f64) -> Self {
        if let Drive::SkidSteer { max_grade, .. } = &mut self.drive {
            *max_grade = libm::tan(angle_rad);
        }
        self
    }

    /// The same with another size of what passes below: a rock, or for what flies the height over the ground.
    #[must_use]
    pub const fn with_clearance(mut self, size_m: f64) -> Self {
        match &mut self.drive {
            Drive::SkidSteer { rock_diameter_m, .. } => *rock_diameter_m = size_m,
            Drive::Flight { ground_clearance_m, .. } => *ground_clearance_m = size_m,
        }
        self
    }

    /// The same with another band of altitudes; what drives has none.
    #[must_use]
    pub const fn with_altitude_band(mut self, band_m: [f64; 2]) -> Self {
        if let Drive::Flight { altitude_band_m, .. } = &mut self.drive {
            *altitude_band_m = band_m;
        }
        self
    }

    /// The same with another radius of the tightest turn at the greatest speed, in meters.
    #[must_use]
    pub const fn with_turning_radius(mut self, radius_m: f64) -> Self {
        self.turn_rate_rps = self.speed_mps / radius_m;
        self
    }

    /// The radius by which obstacles are grown: circumradius and margin, in meters.
    pub fn radius_m(&self) -> f64 {
        self.circumradius_m + self.margin_m
    }

    /// Returns how high the antenna is over the ground where that is `ground_m` high, in meters: a blimp cruises in the
    /// middle of its band.
    pub fn antenna_m(&self, terrain: &Terrain, ground_m: f64) -> f64 {
        match self.drive {
            Drive::SkidSteer { .. } => self.mast_m,
            Drive::Flight { altitude_band_m: [low, high], ground_clearance_m, .. } => {
                let lowest = terrain.height_range_m().map_or(0.0, |[low, _]| f64::from(low));
                (lowest + f64::midpoint(low, high) - ground_m).max(ground_clearance_m) + self.mast_m
            }
        }
    }

    /// Returns what the vehicle asks of the ground of a map.
    pub fn traversability(&self, terrain: &Terrain) -> Traversability {
        match self.drive {
            Drive::SkidSteer { max_grade, rock_diameter_m, .. } => {
                Traversability::Ground { max_grade, rock_diameter_m }
            }
            Drive::Flight { altitude_band_m, ground_clearance_m, .. } => {
                let lowest = terrain.height_range_m().map_or(0.0, |[low, _]| f64::from(low));
                Traversability::Air { max_ground_m: lowest + altitude_band_m[1] - ground_clearance_m }
            }
        }
    }

    /// Returns where the vehicle can be on a map if `obstacles` are closed to it. Linear in the number of cells (about
    /// 10 ms for half a million): keep it while neither changes.
    pub fn configuration_space(&self, terrain: &Terrain, obstacles: &[Obstacle]) -> ConfigurationSpace {
        let occupancy = Occupancy::of_terrain(terrain, obstacles, &self.traversability(terrain));
        ConfigurationSpace::new(occupancy, self.radius_m())
    }

    /// The greatest speed in meters per second on ground that rises `grade` meters for each meter along the way. It
    /// falls to half at the greatest grade, and a descent is driven as slowly as the climb.
    pub fn speed_on_grade_mps(&self, grade: f64) -> f64 {
        match self.drive {
            Drive::SkidSteer { max_grade, .. } => {
                self.speed_mps * (1.0 - 0.5 * (grade.abs() / max_grade).min(1.0))
            }
            Drive::Flight { .. } => self.speed_mps,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_circumradius_holds_the_vehicle_in_every_heading() {
        for model in &VEHICLE_MODELS {
            let half_diagonal =
                0.5 * (model.length_m * model.length_m + model.width_m * model.width_m).sqrt();
            assert!((model.circumradius_m - half_diagonal).abs() < 0.001, "{}", model.name);
        }
    }

    #[test]
    fn a_model_made_from_another_one_differs_in_what_it_says() {
        let rover = *vehicle_model("ATRV").unwrap();
        let small = rover.with_body(0.6, 0.42).with_slope(0.1).with_clearance(0.2).with_turning_radius(0.5);
        assert!((small.circumradius_m - 0.366).abs() < 0.001);
        let Drive::SkidSteer { track_m, max_grade, rock_diameter_m, .. } = small.drive else { panic!() };
        assert_eq!((track_m, rock_diameter_m), (0.31, 0.2));
        assert!((max_grade - 0.1003).abs() < 0.0001);
        assert_eq!(small.turn_rate_rps, 1.6);
        assert_eq!(small.with_altitude_band([1.0, 2.0]), small);
        let blimp = vehicle_model("Blimp").unwrap().with_altitude_band([20.0, 30.0]).with_clearance(9.0);
        let Drive::Flight { altitude_band_m, ground_clearance_m, .. } = blimp.drive else { panic!() };
        assert_eq!((altitude_band_m, ground_clearance_m), ([20.0, 30.0], 9.0));
        assert_eq!(blimp.with_slope(0.1), blimp);
    }

    #[test]
    fn a_rover_climbs_slower_and_a_blimp_does_not_care() {
        let rover = vehicle_model("ATRV").unwrap();
        assert_eq!(rover.speed_on_grade_mps(0.0), 0.8);
        assert!((rover.speed_on_grade_mps(-0.182) - 0.6).abs() < 1e-9);
        assert_eq!(rover.speed_on_grade_mps(2.0), 0.4);
        assert_eq!(vehicle_model("Blimp").unwrap().speed_on_grade_mps(2.0), 4.0);
        assert_eq!(vehicle_model("Tank"), None);
    }
}
