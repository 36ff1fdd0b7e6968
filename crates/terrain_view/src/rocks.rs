//! The rocks of a map near what the camera looks at: those that vehicles must keep away from, mapped or not.

use glam::{Vec2, Vec3};
use motion::RangeSensor;
use terrain::{Rock, Terrain};

use crate::camera::Camera;
use crate::ground::Ground;
use crate::scene::place;
use crate::shapes::Shapes;

/// Rocks are drawn when the camera is no farther away, in meters.
const SHOWN_WITHIN_M: f32 = 160.0;
/// Rocks farther from the camera's target are left out, in meters; and so are smaller ones, and all beyond this many.
const AROUND_M: f32 = 70.0;
const MIN_M: f64 = 0.35;
const MAX_ROCKS: usize = 300;
const SIDES: u16 = 7;
const STONE: [f32; 4] = [0.53, 0.38, 0.29, 1.0];

/// Draws the rocks around the camera's target, the largest if there are too many, and their shadows if there is a sun.
pub(crate) fn draw(shapes: &mut Shapes, ground: &Ground, map: &Terrain, camera: &Camera, sun: Option<Vec3>) {
    let around_m = AROUND_M.max(RangeSensor::SICK.range_m as f32);
    if camera.distance_m > SHOWN_WITHIN_M {
        return;
    }
    let target = camera.target_m.truncate();
    let is_near = |rock: &&Rock| {
        rock.diameter_m >= MIN_M && place(rock.center_m).distance_squared(target) < around_m * around_m
    };
    let mut near: Vec<&Rock> = map.rocks().iter().filter(is_near).collect();
    if near.len() > MAX_ROCKS {
        near.sort_by(|left, right| right.diameter_m.total_cmp(&left.diameter_m));
        near.truncate(MAX_ROCKS);
    }
    for rock in near {
        if let Some(sun) = sun {
            shadow(shapes, ground, rock, sun);
        }
        stone(shapes, ground, rock);
    }
}

/// The shadow of a rock: what a disc sweeps on its way from the foot to where the top throws its shadow.
fn shadow(shapes: &mut Shapes, ground: &Ground, rock: &Rock, sun: Vec3) {
    let center = place(rock.center_m);
    let radius = rock.diameter_m as f32 / 2.0;
    let along = -sun.truncate() / sun.z.max(0.05) * radius * 0.8;
    let aside = along.perp().normalize_or(Vec2::X);
    let direction = along.normalize_or(Vec2::Y);
    let outline = [
        center + aside * radius * 0.85,
        center - aside * radius * 0.85,
        center + along - aside * radius * 0.65,
        center + along + direction * radius * 0.4,
        center + along + aside * radius * 0.65,
    ];
    let on_ground = outline.map(|at| ground.drape(at, ground.cell_m * 0.1));
    for pair in on_ground[1..].windows(2) {
        shapes.triangle([on_ground[0], pair[0], pair[1]], crate::shadow::COLOR);
    }
}

/// A rock half as high as it is wide, with a flat top and a rim that its place makes uneven.
fn stone(shapes: &mut Shapes, ground: &Ground, rock: &Rock) {
    let center = place(rock.center_m);
    let radius = rock.diameter_m as f32 / 2.0;
    let foot_m = ground.height_at(center);
    let phase = (center.x * 12.9 + center.y * 78.2).fract();
    let corner = |side: u16, share: f32, up: f32| {
        let turn = f32::from(side % SIDES) / f32::from(SIDES);
        let uneven = 0.82 + 0.18 * ((turn + phase) * 31.4).sin();
        let around = Vec2::from_angle((turn + phase) * std::f32::consts::TAU);
        (center + around * radius * share * uneven).extend(foot_m + up * radius)
    };
    let top = Vec3::new(center.x, center.y, foot_m + radius);
    for side in 0..SIDES {
        let (low, low_next) = (corner(side, 1.0, -0.3), corner(side + 1, 1.0, -0.3));
        let (high, high_next) = (corner(side, 0.72, 0.72), corner(side + 1, 0.72, 0.72));
        shapes.quad([low, low_next, high_next, high], STONE);
        shapes.triangle([high, high_next, top], STONE);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;
    use terrain::GridFrame;

    use super::*;

    #[test]
    fn rocks_are_drawn_around_the_target_of_a_near_camera_only() {
        let frame = GridFrame::new(400, 400, 1.0);
        let rock = |east, diameter_m| Rock { center_m: Point2::new(east, 200.0), diameter_m };
        let rocks = vec![rock(200.0, 1.0), rock(220.0, 0.1), rock(390.0, 2.0)];
        let map = Terrain::flat(frame).with_rocks(rocks);
        let ground = Ground::new(400, 400, 1.0, Vec2::splat(0.5), &vec![0.0; 160_000]);
        let count = |distance_m, sun| {
            let mut shapes = Shapes::default();
            let camera = Camera { distance_m, ..Camera::overview(Vec3::new(200.0, 200.0, 0.0), 10.0) };
            draw(&mut shapes, &ground, &map, &camera, sun);
            shapes.triangles.len() / 3
        };
        let stone = 3 * usize::from(SIDES);
        assert_eq!([count(40.0, None), count(400.0, None)], [stone, 0]);
        assert_eq!([count(40.0, Some(Vec3::ONE)), count(400.0, Some(Vec3::ONE))], [stone + 3, 0]);
    }
}
