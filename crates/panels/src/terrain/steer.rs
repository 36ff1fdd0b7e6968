//! Where the camera goes by itself: view actions, flights, and vehicles that it follows.

use egui::Response;
use glam::{Vec2, Vec3};
use snapshot::Snapshot;
use terrain_view::camera::Camera;
use terrain_view::flight::Flight;
use terrain_view::ground::Ground;
use terrain_view::tour::{self, Shot};
use terrain_view::{pick, scene};
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::state::Selection;

use super::{Mount, TerrainPanel, clearance};
use crate::Context;

/// How near the camera comes to a place that it flies to, in meters.
const NEAR_M: f32 = 45.0;

/// How high over the ground a rover's camera is, in meters.
const MAST_M: f32 = 1.3;

/// From how far two places are seen that are so far apart, with some ground around them.
const AROUND: f32 = 1.6;

impl TerrainPanel {
    /// Follows view actions, flights and vehicles, and keeps the eye over the ground.
    pub(super) fn move_camera(&mut self, response: &Response, context: &Context<'_>, snapshot: &Snapshot) {
        self.tour(response.rect.aspect_ratio(), context, snapshot);
        if let Some(action) = context.view_action(PanelKind::Terrain) {
            self.follow_action(action, response.rect.aspect_ratio(), context, snapshot);
        }
        let (Some(mut camera), Some(shown)) = (self.camera, &self.ground) else { return };
        let ground = &shown.ground;
        let time = context.state.playback.time;
        if let Mount::OnBoard(index) = self.mount
            && let Some(camera) = onboard(ground, snapshot, index, time)
        {
            (self.camera, self.drawn, self.flight) = (Some(camera), Some(camera), None);
            return;
        }
        let followed = self.mount.followed().and_then(|index| {
            let world = &snapshot.program.world;
            let vehicle = world.vehicles.get(index)?;
            let (place, _) = scene::vehicle_pose(snapshot, index, time)?;
            Some(ground.drape(place, scene::flight_height_m(ground, world, vehicle, place).unwrap_or(0.5)))
        });
        if let Some(flight) = self.flight {
            let flight = followed.map_or(flight, |target| flight.toward(target));
            let (now, is_over) = flight.at(context.now_secs);
            camera = now;
            self.flight = (!is_over).then_some(flight);
            response.ctx.request_repaint();
        } else if let Some(target) = followed {
            camera.target_m = target;
        } else {
            let inside = ground.nearest(camera.target_m.truncate());
            camera.target_m = ground.drape(inside, 0.0);
        }
        let camera = camera.not_lost_above(ground);
        self.camera = Some(camera);
        self.drawn = Some(camera.above(ground));
    }

    fn follow_action(&mut self, action: ViewAction, aspect: f32, context: &Context<'_>, snapshot: &Snapshot) {
        let (Some(camera), Some(map_view)) = (self.camera, self.map_view(aspect)) else { return };
        match action {
            ViewAction::ZoomIn | ViewAction::ZoomOut => {
                let mut nearer = camera;
                nearer.zoom(if action == ViewAction::ZoomIn { 0.7 } else { 1.0 / 0.7 });
                self.fly(camera, nearer, context);
            }
            ViewAction::ZoomReset | ViewAction::Fit => {
                self.mount = Mount::Free;
                self.fly(camera, map_view, context);
            }
            ViewAction::TopView => self.fly(camera, camera.top_view(), context),
            ViewAction::FitSelection => {
                self.mount = Mount::Free;
                match &*context.state.selection {
                    Selection::None => self.fly_to_sample(context),
                    selection => self.fly_to(context, snapshot, selection, None),
                }
            }
            ViewAction::Follow if self.mount.followed().is_some() => self.mount = Mount::Free,
            ViewAction::Follow => {
                let vehicle = clearance::vehicle(snapshot, &context.state.selection);
                self.mount = vehicle.map_or(Mount::Free, Mount::Follow);
                self.fly_to_followed(context, snapshot);
            }
            ViewAction::Tour => {
                let playback = &context.state.playback;
                self.toured_rad = tour::turn_rad(playback.time, playback.end);
                self.go_on_tour(aspect, context, snapshot);
            }
        }
    }

    /// The view of the whole map.
    fn map_view(&self, aspect: f32) -> Option<Camera> {
        self.ground.as_ref().map(|shown| Camera::fitting(&shown.ground, aspect))
    }

    /// Goes where something moves, if the camera is on a tour, and turns it slowly there.
    fn tour(&mut self, aspect: f32, context: &Context<'_>, snapshot: &Snapshot) {
        let Mount::Tour(before) = self.mount else { return };
        let playback = &context.state.playback;
        let turned_rad = tour::turn_rad(playback.time, playback.end);
        if before != tour::shot(&snapshot.motions, playback.time, playback.end) {
            self.go_on_tour(aspect, context, snapshot);
        } else if let Some(camera) = &mut self.camera
            && self.flight.is_none()
            && !context.state.system.reduces_motion
        {
            camera.yaw_rad += turned_rad - self.toured_rad;
        }
        self.toured_rad = turned_rad;
    }

    /// Flies to what a tour is on at the time shown.
    fn go_on_tour(&mut self, aspect: f32, context: &Context<'_>, snapshot: &Snapshot) {
        let playback = &context.state.playback;
        let shot = tour::shot(&snapshot.motions, playback.time, playback.end);
        self.mount = Mount::Tour(shot);
        match (shot, self.camera, self.map_view(aspect)) {
            (Shot::Map, Some(camera), Some(map_view)) => self.fly(camera, map_view, context),
            (Shot::Vehicle(_), ..) => self.fly_to_followed(context, snapshot),
            _ => {}
        }
    }

    /// Flies to what the last sample of a growing tree did: the sample and the vertex nearest to it are both in view.
    fn fly_to_sample(&mut self, context: &Context<'_>) {
        let (Some(camera), Some(shown)) = (self.camera, &self.ground) else { return };
        let Some(last) = context.state.terrain.growth.last_sample() else { return };
        let [from, to] = [last.nearest_m, last.sample_m].map(|at| glam::DVec2::new(at.x, at.y).as_vec2());
        let middle = shown.ground.nearest((from + to) / 2.0);
        let target = camera.close_up(shown.ground.drape(middle, 0.0), NEAR_M.max(AROUND * from.distance(to)));
        self.fly(camera, target, context);
    }

    /// Flies to what is selected, or nearer to a bare place.
    pub(super) fn fly_to(
        &mut self,
        context: &Context<'_>,
        snapshot: &Snapshot,
        selection: &Selection,
        bare: Option<Vec3>,
    ) {
        let (Some(camera), Some(shown)) = (self.camera, &self.ground) else { return };
        let place = pick::place_of(snapshot, selection, context.state.playback.time);
        let target = match place {
            Some(place) => {
                let distance_m = NEAR_M.max(1.5 * pick::extent_of(snapshot, selection));
                camera.close_up(shown.ground.drape(place, 0.0), distance_m)
            }
            None => match bare {
                Some(hit) => camera.close_up(hit, camera.distance_m * 0.5),
                None => return,
            },
        };
        self.mount = Mount::Free;
        self.fly(camera, target, context);
    }

    pub(super) fn fly_to_followed(&mut self, context: &Context<'_>, snapshot: &Snapshot) {
        let (Some(camera), Some(shown)) = (self.camera, &self.ground) else { return };
        let time = context.state.playback.time;
        let pose = self.mount.followed().and_then(|index| scene::vehicle_pose(snapshot, index, time));
        if let Some((place, _)) = pose {
            self.fly(camera, camera.close_up(shown.ground.drape(place, 0.5), NEAR_M * 0.6), context);
        }
    }

    fn fly(&mut self, from: Camera, to: Camera, context: &Context<'_>) {
        if matches!(self.mount, Mount::OnBoard(_)) {
            self.mount = Mount::Free;
        }
        if context.state.system.reduces_motion {
            (self.camera, self.flight) = (Some(to), None);
        } else {
            self.flight = Some(Flight::new(from, to, context.now_secs));
        }
    }
}

/// Returns what a camera on the mast of a vehicle sees ahead.
fn onboard(ground: &Ground, snapshot: &Snapshot, index: usize, time: f64) -> Option<Camera> {
    let world = &snapshot.program.world;
    let vehicle = world.vehicles.get(index)?;
    let (place, heading_rad) = scene::vehicle_pose(snapshot, index, time)?;
    let model = snapshot::vehicle::model(world, &vehicle.model.text);
    let length_m = model.map_or(1.0, |model| model.length_m as f32);
    let height_m = scene::flight_height_m(ground, world, vehicle, place).unwrap_or(MAST_M);
    let nose = place + Vec2::from_angle(heading_rad) * length_m * 0.6;
    Some(Camera::mounted(ground.drape(nose, height_m), heading_rad))
}
