//! The camera over the ground: an orbit around a target, in metres east, north and up.

use glam::camera::rh::proj::directx;
use glam::camera::rh::view;
use glam::{Mat4, Vec2, Vec3, Vec4};

const FIELD_OF_VIEW_RAD: f32 = 0.8;
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

    /// The same target from straight above, north up.
    pub fn top_view(self) -> Self {
        Self { yaw_rad: std::f32::consts::FRAC_PI_2, pitch_rad: PITCH_MAX_RAD, ..self }
    }

    /// The direction of view, a unit vector.
    pub fn forward(&self) -> Vec3 {
        let flat = self.pitch_rad.cos();
        Vec3::new(self.yaw_rad.cos() * flat, self.yaw_rad.sin() * flat, -self.pitch_rad.sin())
    }

    /// Where the eye is.
    pub fn eye_m(&self) -> Vec3 {
        self.target_m - self.forward() * self.distance_m
    }

    fn right(&self) -> Vec3 {
        Vec3::new(self.yaw_rad.sin(), -self.yaw_rad.cos(), 0.0)
    }

    fn up(&self) -> Vec3 {
        self.right().cross(self.forward())
    }

    /// From mission coordinates to clip space, for an image of this width over height.
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        let near = (self.distance_m * 0.02).max(0.1);
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
        let metres_per_point =
            2.0 * self.distance_m * (FIELD_OF_VIEW_RAD / 2.0).tan() / image_height.max(1.0);
        let ahead = Vec3::new(self.yaw_rad.cos(), self.yaw_rad.sin(), 0.0);
        let slant = self.pitch_rad.sin().max(0.25);
        self.target_m -= self.right() * drag.x * metres_per_point;
        self.target_m += ahead * drag.y * metres_per_point / slant;
    }

    /// Comes nearer (`factor` below 1) or goes away.
    pub fn zoom(&mut self, factor: f32) {
        self.distance_m = (self.distance_m * factor).clamp(2.0, 20_000.0);
    }

    /// Where `point_m` appears in an image of `size` points; `None` behind the eye.
    pub fn project(&self, point_m: Vec3, size: Vec2) -> Option<Vec2> {
        let clip = self.clip_from_world(size.x / size.y.max(1.0)) * point_m.extend(1.0);
        if clip.w <= 0.01 {
            return None;
        }
        Some(Vec2::new((clip.x / clip.w + 1.0) * 0.5 * size.x, (1.0 - clip.y / clip.w) * 0.5 * size.y))
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

#[cfg(test)]
mod tests {
    use super::*;

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
