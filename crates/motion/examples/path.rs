//! A path around an obstacle, and how long each of its segments takes: `cargo run -p motion --example path`.
#![expect(clippy::print_stdout, reason = "an example shows what it does")]

use terrain::{CellState, ConfigurationSpace, GridFrame, Obstacle, Occupancy};

fn main() -> Result<(), String> {
    // 40 × 40 meters with something round in the middle.
    let mut ground = Occupancy::free(GridFrame::new(40, 40, 1.0));
    ground.mark(&Obstacle::Circle { center_m: point(20.0, 20.0), radius_m: 8.0 }, CellState::Obstacle);
    // The vehicle becomes a point and the obstacle grows by its radius.
    let space = ConfigurationSpace::new(ground, 0.5);
    let query = motion::Query { start_m: point(2.0, 20.0), goal_m: point(38.0, 20.0) };

    // The closure is asked whether to stop; the seed alone decides which path is found.
    let leg = motion::plan_leg(&space, query, 1, &mut |_| false).map_err(|failure| failure.to_string())?;
    println!("{:.1} m after {} samples", leg.path.length_m(), leg.statistics.samples);
    for (from, to) in leg.path.segments() {
        println!("{from:?} to {to:?}");
    }
    Ok(())
}

/// A place in meters east and north.
fn point<P: From<[f64; 2]>>(east_m: f64, north_m: f64) -> P {
    P::from([east_m, north_m])
}
