//! Vehicles under way in a run: what their range sensors see, and where they mean to drive next.

use glam::{Vec2, Vec3};
use motion::RangeSensor;
use nalgebra::Point2;
use snapshot::{DriveFrame, Execution};

use crate::scene::{self, SceneInput, cased_line, faded, place};
use crate::shapes::Shapes;

/// How high over the ground a range sensor looks, in meters.
const SENSOR_M: f32 = 0.5;
/// The height of marks where a ray meets something, in meters.
const MARK_M: f32 = 0.3;

/// Draws what belongs to the time shown.
pub(crate) fn draw(shapes: &mut Shapes, input: &SceneInput<'_>) {
    let Some(run) = input.run else { return };
    for (vehicle, frame) in under_way(run, input.time) {
        let pose = scene::vehicle_pose(input.snapshot, vehicle as usize, input.time);
        let origin = pose.map_or(place(frame.position_m), |(place, _)| place);
        let palette = input.palette;
        let color = palette.vehicles[vehicle as usize % palette.vehicles.len()];
        way_ahead(shapes, input, origin, frame, color);
        if input.options.rays {
            let declared = input.snapshot.program.world.vehicles.get(vehicle as usize);
            let model = declared
                .and_then(|it| snapshot::vehicle::model(&input.snapshot.program.world, &it.model.text));
            let length_m = model.map_or(1.0, |model| model.length_m as f32);
            let body_m = 0.5 * length_m * input.options.vehicle_scale;
            rays(shapes, input, (origin, body_m), frame, color);
        }
    }
}

/// The vehicles that drive at `time`, with what each of them was doing last.
pub fn under_way(run: &Execution, time: f64) -> impl Iterator<Item = (u32, &DriveFrame)> {
    run.drives.iter().flat_map(|drive| &drive.vehicles).filter_map(move |it| {
        let is_over = it.frames.last().is_none_or(|last| last.time <= time);
        it.at(time).filter(|_| !is_over).map(|frame| (it.vehicle, frame))
    })
}

/// The distance from a vehicle to the nearest thing that its range sensor sees, in meters.
pub fn nearest_seen_m(frame: &DriveFrame) -> Option<f32> {
    let from = place(frame.position_m);
    let away = frame.rays_m.iter().map(|&point| from.distance(single(point)));
    away.min_by(f32::total_cmp)
}

fn single(point_m: Point2<f32>) -> Vec2 {
    Vec2::new(point_m.x, point_m.y)
}

/// The local plan: along the path, or around what was seen.
fn way_ahead(shapes: &mut Shapes, input: &SceneInput<'_>, origin: Vec2, frame: &DriveFrame, color: [f32; 4]) {
    // The plan begins where the vehicle was when it was made: what it has passed since is left out.
    let points: Vec<Vec2> = frame.plan_m.iter().map(|&point| single(point)).collect();
    let passed = origin.distance(place(frame.position_m));
    let ahead = points.into_iter().filter(|point| point.distance(place(frame.position_m)) > passed);
    let mut before = origin;
    for next in ahead {
        cased_line(shapes, input.ground, [before, next], 2.2, color, input.palette.under);
        before = next;
    }
}

/// The sector that the range sensor sweeps, its rays that meet something, and a mark where they do.
fn rays(
    shapes: &mut Shapes,
    input: &SceneInput<'_>,
    (origin, body_m): (Vec2, f32),
    frame: &DriveFrame,
    color: [f32; 4],
) {
    const ARC_PIECES: u16 = 24;
    let model = RangeSensor::SICK;
    let (reach, heading) = (model.range_m as f32, frame.heading_rad as f32);
    let half = (model.field_of_view_rad / 2.0) as f32;
    let rim = |piece: u16| {
        let part = f32::from(piece) / f32::from(ARC_PIECES);
        origin + Vec2::from_angle(heading + half * (2.0 * part - 1.0)) * reach
    };
    let edge = faded(color, 0.55);
    for piece in 0..ARC_PIECES {
        shapes.draped_line(input.ground, [rim(piece), rim(piece + 1)], 1.0, edge);
    }
    for end in [rim(0), rim(ARC_PIECES)] {
        shapes.draped_line(input.ground, [origin, end], 1.0, edge);
    }
    for &point in &frame.rays_m {
        let point = single(point);
        let met = input.ground.drape(point, SENSOR_M);
        // A ray begins where it leaves the body, which is drawn larger from afar.
        if let Some(from) = outside_of_body(origin, point, body_m) {
            shapes.air_line(input.ground.drape(from, SENSOR_M), met, 1.0, faded(color, 0.5));
        }
        shapes.line(met, met + Vec3::Z * MARK_M, 1.4, input.palette.light);
    }
}

/// Returns where a ray from the middle of a body with this radius leaves it; `None` if it ends before.
fn outside_of_body(origin: Vec2, end: Vec2, radius_m: f32) -> Option<Vec2> {
    let length_m = origin.distance(end);
    (length_m > radius_m).then(|| origin.lerp(end, radius_m / length_m))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_begins_at_the_rim_of_the_body_and_one_inside_it_is_not_drawn() {
        let end = Vec2::new(13.0, 4.0);
        assert_eq!(outside_of_body(Vec2::new(10.0, 0.0), end, 2.5), Some(Vec2::new(11.5, 2.0)));
        assert_eq!(outside_of_body(Vec2::new(10.0, 0.0), end, 6.0), None);
    }

    #[test]
    fn the_nearest_thing_seen_is_measured_from_the_vehicle() {
        let frame = DriveFrame {
            time: 0.0,
            position_m: [10.0, 10.0].into(),
            heading_rad: 0.0,
            speed_mps: 0.5,
            rays_m: [[16.0, 10.0], [13.0, 14.0]].map(Point2::from).to_vec(),
            plan_m: Vec::new(),
        };
        assert_eq!(nearest_seen_m(&frame), Some(5.0));
        assert_eq!(nearest_seen_m(&DriveFrame { rays_m: Vec::new(), ..frame }), None);
    }
}
