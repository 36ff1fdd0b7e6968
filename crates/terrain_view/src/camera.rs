//! The camera over the ground: an orbit around a target, in meters east, north and up.

use glam::camera::rh::proj::directx;
use glam::camera::rh::view;
use glam::{Mat4, Vec2, Vec3, Vec4};

use crate::ground::Ground;

const FIELD_OF_VIEW_RAD: f32 = 0.8;
/// How far ahead a mounted camera looks at something.
const MOUNTED_M: f32 = 12.0;
const PITCH_MIN_RAD: f32 = 0.06;
const PITCH_MAX_RAD: f32 = std::f32::consts::FRAC_PI_2 - 0.001;

/// Where the viewer is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// What the camera looks at.
    pub target_m: Vec3,
    /// Direction of view in the plane, counter-clockwise from east.
    pub yaw_rad: f32,
    /// Angle of view below the horizon.
    pub pitch_rad: f32,
    /// From the target to the eye.
    pub distance_m: f32,
}

impl Camera {
    /// A view of the whole square of `size_m` around `center_m`, from the south.
    pub fn overview(center_m: Vec3, size_m: f32) -> Self {
        Self {
            target_m: center_m,
            yaw_rad: std::f32::consts::FRAC_PI_2,
            pitch_rad: 0.95,
            distance_m: size_m * 1.32,
        }
    }

    /// The same direction of view, near enough to `target_m` to see what is there.
    pub fn close_up(self, target_m: Vec3, distance_m: f32) -> Self {
        let pitch_rad = self.pitch_rad.clamp(0.45, 1.1);
        Self { target_m, distance_m: distance_m.min(self.distance_m), pitch_rad, ..self }
    }

    /// A camera at a place that looks ahead, and a little down.
    pub fn mounted(eye_m: Vec3, heading_rad: f32) -> Self {
        let camera = Self { target_m: eye_m, yaw_rad: heading_rad, pitch_rad: 0.12, distance_m: MOUNTED_M };
        Self { target_m: eye_m + camera.forward() * MOUNTED_M, ..camera }
    }

    /// The camera with its eye over the ground: raised around its target where a hill is in the way.
    pub fn above(self, ground: &Ground) -> Self {
        let margin_m = (self.distance_m * 0.04).max(1.0);
        let is_clear = |pitch_rad: f32| {
            let eye = Self { pitch_rad, ..self }.eye_m();
            eye.z >= ground.height_at(eye.truncate()) + margin_m
        };
        let steps = 48_u16;
        let step_rad = (PITCH_MAX_RAD - self.pitch_rad) / f32::from(steps);
        let pitches = (0..=steps).map(|step| self.pitch_rad + step_rad * f32::from(step));
        let pitch_rad = pitches.into_iter().find(|&pitch| is_clear(pitch)).unwrap_or(PITCH_MAX_RAD);
        Self { pitch_rad, ..self }
    }

    /// The same target from straight above, north up.
    pub fn top_view(self) -> Self {
        Self { yaw_rad: std::f32::consts::FRAC_PI_2, pitch_rad: PITCH_MAX_RAD, ..self }
    }

    /// The direction of view, a unit vector.
    pub fn forward(&self) -> Vec3 {
        let flat = self.pitch_rad.cos();
        Vec3::new(self.yaw_rad.cos() * flat, self.yaw_rad.sin() * flat, -self.pitch_rad.sin())
    }

    /// Returns where the eye is.
    pub fn eye_m(&self) -> Vec3 {
        self.target_m - self.forward() * self.distance_m
    }

    fn right(&self) -> Vec3 {
        Vec3::new(self.yaw_rad.sin(), -self.yaw_rad.cos(), 0.0)
    }

    fn up(&self) -> Vec3 {
        self.right().cross(self.forward())
    }

    /// No farther away than `ground` is worth looking at.
    pub fn not_lost_above(self, ground: &Ground) -> Self {
        let farthest_m = (ground.size_m().max_element() * 4.0).max(20_000.0);
        Self { distance_m: self.distance_m.min(farthest_m), ..self }
    }

    /// Nothing nearer than this is drawn.
    pub fn near_m(&self) -> f32 {
        (self.distance_m * 0.02).max(0.1)
    }

    /// The whole of `ground` from the south, as large as an image of this width over height allows.
    pub fn fitting(ground: &Ground, aspect: f32) -> Self {
        let size = ground.size_m();
        let mut camera = Self::overview(ground.center_m(), size.max_element());
        let low = ground.origin_m;
        let corners = [low, low + Vec2::new(size.x, 0.0), low + size, low + Vec2::new(0.0, size.y)];
        // Each round brings the middle to the middle and the farthest corner to the border; a few are enough.
        for _ in 0..6 {
            let projector = camera.projector(Vec2::new(aspect, 1.0));
            let seen = corners.map(|corner| projector.project(ground.drape(corner, 0.0)).unwrap_or_default());
            let first = seen.into_iter().reduce(Vec2::min).unwrap_or_default();
            let last = seen.into_iter().reduce(Vec2::max).unwrap_or_default();
            let center = (first + last) / 2.0 - Vec2::new(aspect, 1.0) / 2.0;
            camera.pan(-center, 1.0);
            let filled = ((last - first) / Vec2::new(aspect * 0.94, 0.86)).max_element();
            camera.zoom(filled.clamp(0.5, 2.0));
        }
        camera
    }

    /// From mission coordinates to clip space, for an image of this width over height.
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        let near = self.near_m();
        let far = self.distance_m * 4.0 + 4000.0;
        let eye = self.eye_m();
        let view = view::look_to_mat4(eye, self.forward(), self.up());
        directx::perspective(FIELD_OF_VIEW_RAD, aspect.max(0.01), near, far) * view
    }

    /// Turns around the target by a drag of so many points.
    pub fn orbit(&mut self, drag: Vec2) {
        self.yaw_rad -= drag.x * 0.006;
        self.pitch_rad = (self.pitch_rad + drag.y * 0.006).clamp(PITCH_MIN_RAD, PITCH_MAX_RAD);
    }

    /// Moves the target so that the ground follows a drag of so many points in an image of this height.
    pub fn pan(&mut self, drag: Vec2, image_height: f32) {
        let meters_per_point =
            2.0 * self.distance_m * (FIELD_OF_VIEW_RAD / 2.0).tan() / image_height.max(1.0);
        let ahead = Vec3::new(self.yaw_rad.cos(), self.yaw_rad.sin(), 0.0);
        let slant = self.pitch_rad.sin().max(0.25);
        self.target_m -= self.right() * drag.x * meters_per_point;
        self.target_m += ahead * drag.y * meters_per_point / slant;
    }

    /// Comes nearer (`factor` below 1) or goes away.
    pub fn zoom(&mut self, factor: f32) {
        self.distance_m = (self.distance_m * factor).max(2.0);
    }

    /// Comes nearer or goes away while `point_m` stays where it is in the image.
    pub fn zoom_at(&mut self, factor: f32, point_m: Vec3) {
        let before = self.distance_m;
        self.zoom(factor);
        self.target_m = point_m + (self.target_m - point_m) * (self.distance_m / before);
    }

    /// Returns what tells where points appear in an image of `size` points.
    pub fn projector(&self, size: Vec2) -> Projector {
        Projector { clip_from_world: self.clip_from_world(size.x / size.y.max(1.0)), size }
    }

    /// Returns where `point_m` appears in an image of `size` points; `None` behind the eye.
    pub fn project(&self, point_m: Vec3, size: Vec2) -> Option<Vec2> {
        self.projector(size).project(point_m)
    }

    /// The ray of view through a point of an image of `size` points: its origin and its unit direction.
    pub fn ray(&self, point: Vec2, size: Vec2) -> (Vec3, Vec3) {
        let inverse = self.clip_from_world(size.x / size.y.max(1.0)).inverse();
        let clip = Vec2::new(point.x / size.x.max(1.0) * 2.0 - 1.0, 1.0 - point.y / size.y.max(1.0) * 2.0);
        let far: Vec4 = inverse * clip.extend(0.99).extend(1.0);
        let origin = self.eye_m();
        (origin, (far.truncate() / far.w - origin).normalize_or_zero())
    }
}

/// Tells where points appear in one image.
#[derive(Clone, Copy, Debug)]
pub struct Projector {
    clip_from_world: Mat4,
    size: Vec2,
}

impl Projector {
    /// Returns where `point_m` appears, in points from the top left; `None` behind the eye.
    pub fn project(&self, point_m: Vec3) -> Option<Vec2> {
        let clip = self.clip_from_world * point_m.extend(1.0);
        if clip.w <= 0.01 {
            return None;
        }
        let (right, up) = (clip.x / clip.w, clip.y / clip.w);
        Some(Vec2::new((right + 1.0) * 0.5 * self.size.x, (1.0 - up) * 0.5 * self.size.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_eye_is_over_the_ground_wherever_the_camera_turns() {
        // A crest 40 m high along the middle of 200 m.
        let height = |column: usize| 40.0 - (column as f32 - 100.0).abs() * 0.8;
        let heights: Vec<f32> = (0..200 * 200).map(|cell| height(cell % 200).max(0.0)).collect();
        let ground = Ground::new(200, 200, 1.0, Vec2::ZERO, &heights);
        for yaw in 0..12_u8 {
            for distance_m in [2.0, 20.0, 80.0, 400.0] {
                let camera = Camera {
                    target_m: ground.drape(Vec2::new(60.0, 100.0), 0.0),
                    yaw_rad: f32::from(yaw) * 0.52,
                    pitch_rad: PITCH_MIN_RAD,
                    distance_m,
                };
                let eye = camera.above(&ground).eye_m();
                assert!(eye.z > ground.height_at(eye.truncate()) + 0.9, "{yaw} {distance_m} {eye}");
            }
        }
    }

    #[test]
    fn a_mounted_camera_is_where_it_is_mounted_and_looks_ahead() {
        let eye_m = Vec3::new(10.0, 20.0, 3.0);
        let camera = Camera::mounted(eye_m, 0.0);
        assert!((camera.eye_m() - eye_m).length() < 1e-4);
        assert!(camera.forward().x > 0.9 && camera.forward().z < 0.0);
    }

    #[test]
    fn the_whole_ground_fills_images_of_any_shape_and_is_not_cut() {
        let ground = Ground::new(100, 100, 3.0, Vec2::new(40.0, -70.0), &vec![0.0; 100 * 100]);
        let low = ground.origin_m;
        for aspect in [0.5, 1.0, 1.7, 3.0] {
            let size = Vec2::new(600.0 * aspect, 600.0);
            let projector = Camera::fitting(&ground, aspect).projector(size);
            let mut extent = (size, Vec2::ZERO);
            for corner in
                [low, low + ground.size_m(), low + Vec2::new(297.0, 0.0), low + Vec2::new(0.0, 297.0)]
            {
                let at = projector.project(ground.drape(corner, 0.0)).expect("in front of the eye");
                assert!(at.cmpge(Vec2::ZERO).all() && at.cmple(size).all(), "{aspect} {at}");
                extent = (extent.0.min(at), extent.1.max(at));
            }
            let filled = ((extent.1 - extent.0) / size).max_element();
            assert!(filled > 0.8, "{aspect} {filled}");
        }
    }

    #[test]
    fn zooming_keeps_the_ground_under_the_pointer() {
        let mut camera = Camera::overview(Vec3::ZERO, 100.0);
        let size = Vec2::new(800.0, 500.0);
        let point = Vec3::new(20.0, 30.0, 0.0);
        let before = camera.project(point, size).expect("in front of the eye");
        camera.zoom_at(0.5, point);
        let after = camera.project(point, size).expect("in front of the eye");
        assert!((after - before).length() < 0.5, "{before} {after}");
    }

    #[test]
    fn the_target_appears_in_the_middle_and_its_ray_leads_back_to_it() {
        let camera = Camera::overview(Vec3::new(150.0, 150.0, 3.0), 300.0);
        let size = Vec2::new(800.0, 500.0);
        let middle = camera.project(camera.target_m, size).expect("in front of the eye");
        assert!((middle - size / 2.0).length() < 0.1, "{middle}");
        let (origin, direction) = camera.ray(middle, size);
        let nearest = origin + direction * camera.distance_m;
        assert!((nearest - camera.target_m).length() < 0.5, "{nearest}");
    }

    #[test]
    fn from_above_north_is_up_and_east_is_right() {
        let camera = Camera::overview(Vec3::ZERO, 100.0).top_view();
        let size = Vec2::splat(400.0);
        let at = |x: f32, y: f32| camera.project(Vec3::new(x, y, 0.0), size).expect("in front of the eye");
        assert!(at(0.0, 10.0).y < at(0.0, 0.0).y);
        assert!(at(10.0, 0.0).x > at(0.0, 0.0).x);
    }

    #[test]
    fn panning_moves_the_ground_with_the_pointer() {
        let mut camera = Camera::overview(Vec3::ZERO, 100.0).top_view();
        let size = Vec2::splat(400.0);
        let before = camera.project(Vec3::ZERO, size).expect("in front of the eye");
        camera.pan(Vec2::new(30.0, -20.0), size.y);
        let after = camera.project(Vec3::ZERO, size).expect("in front of the eye");
        assert!(((after - before) - Vec2::new(30.0, -20.0)).length() < 1.0, "{}", after - before);
    }
}
