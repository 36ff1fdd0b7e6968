//! Bringing the ground, and what lies flat on it, to the graphics card when it has changed.

use std::sync::Arc;

use glam::Vec2;
use rmpl::program::ObstacleShape;
use snapshot::{MapKey, Snapshot};
use terrain::Terrain;
use terrain_view::decal::{ClearanceMap, Decal};
use terrain_view::gpu::TerrainImage;
use terrain_view::ground::Ground;
use workbench::state::settings::TerrainView;

use super::TerrainPanel;
use super::clearance::Clearance;
use crate::Context;

/// The ground that is on the graphics card.
pub(super) struct Shown {
    key: Option<MapKey>,
    height_scale: f32,
    pub(super) ground: Ground,
}

/// What the image on the ground was painted from.
#[derive(PartialEq)]
pub(super) struct DecalKey {
    map: Option<MapKey>,
    obstacles: Vec<ObstacleShape>,
    clearance: Option<Clearance>,
}

impl TerrainPanel {
    /// Brings the ground of the mission to the graphics card, when it is not there yet.
    pub(super) fn show_ground(
        &mut self,
        context: &Context<'_>,
        map: Option<&Arc<Terrain>>,
        snapshot: &Snapshot,
        view: &TerrainView,
    ) {
        let key = map.and(snapshot.map.clone());
        let is_shown =
            self.ground.as_ref().is_some_and(|it| it.key == key && it.height_scale == view.height_scale);
        if !is_shown {
            let ground =
                map.map_or_else(|| Ground::flat(Vec2::ZERO, 300.0), |map| from_map(map, view.height_scale));
            let is_new_place = self.ground.as_ref().is_none_or(|before| before.key != key);
            if is_new_place {
                (self.camera, self.flight) = (None, None);
                (self.follow, self.onboard) = (None, None);
            }
            if let (Some(state), Some(image)) = (context.render_state, &mut self.image) {
                image.set_ground(state, &ground);
            }
            self.ground = Some(Shown { key, height_scale: view.height_scale, ground });
            self.decal = None;
        }
        if let (Some(state), None, Some(shown)) = (context.render_state, &self.image, &self.ground) {
            let mut image = TerrainImage::new(state);
            image.set_ground(state, &shown.ground);
            self.image = Some(image);
            self.decal = None;
        }
    }

    /// Lays obstacles and the clearance map on the ground, when they have changed.
    pub(super) fn lay_decal(
        &mut self,
        context: &Context<'_>,
        snapshot: &Snapshot,
        map: Option<&Arc<Terrain>>,
        view: &TerrainView,
    ) {
        let wanted = map.zip(snapshot.map.as_ref()).filter(|_| view.clearance);
        let before = self.clearance.take();
        self.clearance = wanted
            .and_then(|(map, key)| Clearance::updated(before, key, map, snapshot, &context.state.selection));
        let (Some(state), Some(image), Some(shown)) = (context.render_state, &mut self.image, &self.ground)
        else {
            return;
        };
        let obstacles = snapshot.program.world.obstacles.iter().filter(|it| view.obstacles && it.is_solid());
        let key = DecalKey {
            map: shown.key.clone(),
            obstacles: obstacles.map(|it| it.shape.clone()).collect(),
            clearance: self.clearance.clone(),
        };
        if self.decal.as_ref() != Some(&key) {
            let clearance = key.clearance.as_ref().map(|it| ClearanceMap { clearance_m: &it.room_m });
            let decal = Decal::paint(&shown.ground, &key.obstacles, clearance);
            image.set_decal(state, decal.as_ref());
            self.decal = Some(key);
        }
    }
}

fn from_map(map: &Terrain, height_scale: f32) -> Ground {
    let frame = map.frame();
    let half = frame.cell_size_m / 2.0;
    let origin = Vec2::new((frame.origin_m[0] + half) as f32, (frame.origin_m[1] + half) as f32);
    let heights: Vec<f32> = map.heights_m().iter().map(|height| height * height_scale).collect();
    Ground::new(frame.width, frame.height, frame.cell_size_m as f32, origin, &heights)
}
