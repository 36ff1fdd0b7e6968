//! One image of the terrain: everything it depends on, and its way to the screen.

use std::sync::Arc;

use eframe::egui_wgpu::RenderState;
use egui::{Color32, Painter, Rect};
use snapshot::Snapshot;
use terrain::Terrain;
use theme::Tokens;
use workbench::state::AppState;
use workbench::state::settings::{Coloring, TerrainView};

use crate::camera::Camera;
use crate::detail;
use crate::gpu::{Frame, TerrainImage, ViewUniform};
use crate::ground::Ground;
use crate::pace::Savings;
use crate::rocks;
use crate::scale::{grid_spacing_m, vehicle_scale};
use crate::scene::{self, SceneInput, SceneOptions, ScenePalette, Sketch};
use crate::sun::Sun;

/// What an image shows.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    pub state: &'a AppState,
    /// The colors around the ground.
    pub tokens: &'a Tokens,
    pub snapshot: &'a Snapshot,
    /// Its map, once it is there.
    pub map: Option<&'a Arc<Terrain>>,
    /// What is shown.
    pub view: &'a TerrainView,
    pub camera: &'a Camera,
    pub ground: &'a Ground,
    /// What a tool has.
    pub sketch: &'a Sketch,
    pub sun: Sun,
    /// What is left out where frames are slow.
    pub savings: Savings,
}

/// Meters of height between contour lines, by the relief of the map.
const CONTOUR_STEPS_M: [f32; 12] = [0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0];
/// Patches are split until they are this many side lengths away.
const REFINEMENT: f32 = 1.3;

/// Draws the image and puts it into `rect`.
pub fn paint(
    painter: &Painter,
    rect: Rect,
    pixels_per_point: f32,
    state: &RenderState,
    image: &mut TerrainImage,
    input: &Input<'_>,
) {
    let pixels_per_point = pixels_per_point * input.savings.resolution();
    let pixels = [rect.width() * pixels_per_point, rect.height() * pixels_per_point];
    let frame = frame(input, pixels, pixels_per_point);
    let texture = image.draw(state, pixels.map(|side| side.round() as u32), frame);
    let uv = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
    painter.image(texture, rect, uv, Color32::WHITE);
}

fn frame(input: &Input<'_>, pixels: [f32; 2], pixels_per_point: f32) -> Frame {
    let Input { state, tokens, snapshot, map, view, camera, ground, sketch, sun, savings } = *input;
    let clip_from_world = camera.clip_from_world(pixels[0] / pixels[1].max(1.0));
    let eye = camera.eye_m();
    let relief = (ground.range_m[1] - ground.range_m[0]) / view.height_scale;
    let contour = CONTOUR_STEPS_M.into_iter().find(|step| relief / step < 20.0).unwrap_or(5000.0);
    let has_grain = !view.data_only && view.coloring == Coloring::Natural && savings == Savings::None;
    let has_shadows = !view.data_only;
    let horizon = rgba(tokens.sunken);
    let options = SceneOptions {
        trees: view.trees,
        paths: view.paths,
        obstacles: view.obstacles,
        rays: view.rays,
        sights: view.sights,
        sun: has_shadows.then_some(sun.toward),
        vehicle_scale: vehicle_scale(camera.distance_m),
    };
    let appeared: Vec<_> = if state.is_executing() {
        state.execution.appeared(state.playback.time).collect()
    } else {
        Vec::new()
    };
    let mut shapes = scene::build(&SceneInput {
        snapshot,
        ground,
        time: state.playback.time,
        run: state.run_shown(),
        selection: &state.selection,
        hovered: &state.hovered,
        growth: &state.terrain.growth,
        palette: &palette(),
        options: &options,
        sketch,
        appeared: &appeared,
    });
    if let Some(map) = map {
        rocks::draw(&mut shapes, ground, map, camera, options.sun.filter(|_| savings == Savings::None));
    }
    shapes.scale_widths(pixels_per_point);
    Frame {
        view: ViewUniform {
            clip_from_world: clip_from_world.to_cols_array_2d(),
            eye: eye.extend(camera.distance_m * 2.5 + 600.0).to_array(),
            sun: sun.toward.extend(0.38).to_array(),
            origin_cell: [ground.origin_m.x, ground.origin_m.y, ground.cell_m, view.height_scale],
            range: [
                ground.range_m[0],
                ground.range_m[1],
                if view.contours { contour } else { 0.0 },
                if view.grid { grid_spacing_m(camera.distance_m) } else { 0.0 },
            ],
            image: [
                pixels[0],
                pixels[1],
                match view.coloring {
                    Coloring::Natural => 0.0,
                    Coloring::Height => 1.0,
                    Coloring::Slope => 2.0,
                },
                1.0,
            ],
            horizon: [horizon[0], horizon[1], horizon[2], camera.near_m()],
            world_from_clip: clip_from_world.inverse().to_cols_array_2d(),
            look: [flag(has_grain), flag(!view.data_only), flag(has_shadows), sun.daylight],
        },
        has_volumes: has_shadows && view.obstacles,
        patches: detail::patches(ground, eye, &clip_from_world, REFINEMENT),
        shapes,
        background: [horizon[0], horizon[1], horizon[2]],
    }
}

fn flag(is_set: bool) -> f32 {
    f32::from(u8::from(is_set))
}

/// Obstacles that are volumes: grayer than the ground, so that they stand out from it.
pub const STONE: [f32; 4] = [0.50, 0.38, 0.32, 1.0];

/// The colors of the scene: those of the dark theme, because the ground is as dark in both.
fn palette() -> ScenePalette {
    let tokens = &theme::DARK;
    let color = |color, opacity| {
        let [red, green, blue, _] = rgba(color);
        [red, green, blue, opacity]
    };
    ScenePalette {
        light: color(Tokens::ON_GROUND, 1.0),
        under: color(Tokens::UNDER_LINES, 0.62),
        fence: color(Tokens::OBSTACLE, 0.45),
        stone: STONE,
        selected: color(tokens.accent, 1.0),
        trees: [color(tokens.series(0), 1.0), color(tokens.series(4), 1.0)],
        warning: color(tokens.now, 1.0),
        vehicles: std::array::from_fn(|index| color(tokens.series(index), 1.0)),
    }
}

/// A color as the shaders want it.
fn rgba(color: Color32) -> [f32; 4] {
    color.to_array().map(|channel| f32::from(channel) / 255.0)
}
