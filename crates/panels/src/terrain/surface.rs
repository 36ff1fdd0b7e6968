//! Bringing the ground, and what lies flat on it, to the graphics card when it has changed.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use rmpl::program::ObstacleShape;
use snapshot::{MapKey, Snapshot};
use terrain::Terrain;
use terrain_view::decal::{ClearanceMap, Decal};
use terrain_view::gpu::TerrainImage;
use terrain_view::ground::Ground;
use terrain_view::shapes::Shapes;
use terrain_view::sunlight::Relief;
use terrain_view::volume::Volume;
use terrain_view::{frame, scene};
use workbench::state::settings::TerrainView;

use super::clearance::Clearance;
use super::{Mount, TerrainPanel};
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

/// What stands on the ground in the light, and from where the light was found that is on the graphics card.
pub(super) struct Light {
    volumes: Vec<Volume>,
    relief: Relief,
    toward_sun: Option<Vec3>,
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
                self.mount = Mount::Free;
            }
            if let (Some(state), Some(image)) = (context.render_state, &mut self.image) {
                image.set_ground(state, &ground);
            }
            self.ground = Some(Shown { key, height_scale: view.height_scale, ground });
            (self.decal, self.light) = (None, None);
        }
        if let (Some(state), None, Some(shown)) = (context.render_state, &self.image, &self.ground) {
            let mut image = TerrainImage::new(state);
            image.set_ground(state, &shown.ground);
            self.image = Some(image);
            (self.decal, self.light) = (None, None);
        }
    }

    /// Puts the volumes of obstacles on the ground, and finds which ground the sun reaches, when they have changed. Where
    /// only data is shown, there is nothing of that.
    pub(super) fn lay_light(&mut self, context: &Context<'_>, snapshot: &Snapshot, view: &TerrainView) {
        let (Some(state), Some(image), Some(shown)) = (context.render_state, &mut self.image, &self.ground)
        else {
            return;
        };
        if view.data_only {
            return;
        }
        let volumes = if view.obstacles { scene::volumes(&snapshot.program.world) } else { Vec::new() };
        if self.light.as_ref().is_none_or(|light| light.volumes != volumes) {
            let mut shapes = Shapes::default();
            for volume in &volumes {
                volume.draw(&mut shapes, &shown.ground, frame::STONE);
            }
            image.set_volumes(state, &shapes);
            let relief = Relief::new(&shown.ground, &volumes);
            self.light = Some(Light { volumes, relief, toward_sun: None });
        }
        let toward_sun = super::sun(context, view).stepped().toward;
        if let Some(light) = &mut self.light
            && light.toward_sun != Some(toward_sun)
        {
            image.set_sunlight(state, &light.relief.lit_from(toward_sun));
            light.toward_sun = Some(toward_sun);
        }
    }

    /// Lays the clearance map on the ground, and obstacles where they are no volumes, when they have changed.
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
        let obstacles = obstacles.filter(|_| view.data_only);
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
