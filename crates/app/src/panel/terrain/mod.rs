//! The terrain: the ground in three dimensions with the mission's places, obstacles, paths and vehicles.
//!
//! Left drag turns, right drag or Shift moves, the wheel zooms. Dragging a place, an obstacle or a vehicle that has not
//! moved yet rewrites its declaration in the text.

mod camera;
mod detail;
mod drag;
mod gpu;
mod ground;
mod hud;
mod scene;
mod shapes;

use std::sync::Arc;

use egui::{PointerButton, Sense};
use glam::{Vec2, Vec3};
use mission::{MapKey, Snapshot};
use terrain::Terrain;

use crate::command::{Command, CommandSender, ViewAction};
use crate::panel::{Context, Panel, PanelKind};
use crate::state::Selection;
use crate::state::settings::{Coloring, TerrainView};
use crate::theme::space;
use camera::Camera;
use drag::Drag;
use gpu::{Frame, TerrainImage, ViewUniform};
use ground::Ground;
use scene::{SceneOptions, ScenePalette};

/// The panel, with what concerns only it: the camera and what is on the graphics card.
#[derive(Default)]
pub struct TerrainPanel {
    image: Option<TerrainImage>,
    ground: Option<Shown>,
    camera: Option<Camera>,
    /// The vehicle that the camera follows, as an index into the program's world.
    follow: Option<usize>,
    drag: Option<Drag>,
    /// How many drags there were: each is one step of the history.
    drag_count: u64,
    followed_action: u64,
}

/// The ground that is on the graphics card.
struct Shown {
    key: Option<MapKey>,
    height_scale: f32,
    ground: Ground,
}

/// Metres of height between contour lines, by the relief of the map.
const CONTOUR_STEPS_M: [f32; 8] = [0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 50.0, 500.0];
const WHEEL_ZOOM: f32 = 0.0018;
/// Patches are split until they are this many side lengths away.
const REFINEMENT: f32 = 1.3;

impl Panel for TerrainPanel {
    fn show(&mut self, ui: &mut egui::Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let Some(snapshot) = context.snapshot else {
            hud::message(ui, context.tokens, "The ground appears when the mission has been read.");
            return;
        };
        if snapshot.map.is_none() {
            hud::message(
                ui,
                context.tokens,
                "This mission has no places. Declare a terrain and a location to see its world here:\n\
                 terrain \"tai-plain\";  location BASE (40, 40);",
            );
            return;
        }
        let views = &context.state.settings.views;
        let mut view = views.terrain.clone();
        hud::toolbar(ui, &mut view, self.camera.as_mut(), &mut self.follow, snapshot);
        if view != views.terrain {
            commands.send(Command::SetViews(Box::new(crate::state::Views {
                terrain: view.clone(),
                ..views.clone()
            })));
        }
        let map = snapshot.map.as_ref().and_then(|key| context.state.maps.get(key));
        self.show_ground(context, snapshot, map, &view);
        self.show_image(ui, context, snapshot, &view, commands);
    }
}

impl TerrainPanel {
    /// Brings the ground of the mission to the graphics card, when it is not there yet.
    fn show_ground(
        &mut self,
        context: &Context<'_>,
        snapshot: &Snapshot,
        map: Option<&Arc<Terrain>>,
        view: &TerrainView,
    ) {
        let key = map.and(snapshot.map.clone());
        let is_shown =
            self.ground.as_ref().is_some_and(|it| it.key == key && it.height_scale == view.height_scale);
        if !is_shown {
            let ground =
                map.map_or_else(|| Ground::flat(Vec2::ZERO, 300.0), |map| from_map(map, view.height_scale));
            let is_new_place = self.ground.as_ref().is_none_or(|before| before.key != key);
            if is_new_place || self.camera.is_none() {
                self.camera = Some(Camera::overview(ground.center_m(), ground.size_m().max_element()));
            }
            if let (Some(state), Some(image)) = (context.render_state, &mut self.image) {
                image.set_ground(state, &ground, None);
            }
            self.ground = Some(Shown { key, height_scale: view.height_scale, ground });
        }
        if let (Some(state), None, Some(shown)) = (context.render_state, &self.image, &self.ground) {
            let mut image = TerrainImage::new(state);
            image.set_ground(state, &shown.ground, None);
            self.image = Some(image);
        }
    }

    fn show_image(
        &mut self,
        ui: &mut egui::Ui,
        context: &Context<'_>,
        snapshot: &Snapshot,
        view: &TerrainView,
        commands: &mut CommandSender,
    ) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let described = describe(snapshot, context.state.playback.time);
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Terrain. {described}"))
        });
        let (Some(camera), Some(shown)) = (self.camera, &self.ground) else { return };
        let mut moved = camera;
        let size = Vec2::new(rect.width(), rect.height());
        self.drag = drag::update(
            self.drag.take(),
            &mut self.drag_count,
            &response,
            &drag::Scene { rect, camera: &camera, ground: &shown.ground, snapshot, context },
            commands,
        );
        if self.drag.is_none() {
            navigate(&response, &mut moved, size);
        }
        if let Some(action) = context.view_action(PanelKind::Terrain, &mut self.followed_action) {
            follow_action(action, &mut moved, &shown.ground, snapshot, &context.state.selection);
        }
        let time = context.state.playback.time;
        if let Some((place, _)) = self.follow.and_then(|vehicle| scene::vehicle_pose(snapshot, vehicle, time))
        {
            moved.target_m = shown.ground.drape(place, 0.5);
        } else {
            moved.target_m.z = shown.ground.height_at(moved.target_m.truncate());
        }
        self.camera = Some(moved);
        let pixels_per_point = ui.ctx().pixels_per_point();
        let pixels = [rect.width() * pixels_per_point, rect.height() * pixels_per_point];
        let frame = frame(context, snapshot, view, &moved, &shown.ground, pixels);
        let painter = ui.painter_at(rect);
        if let (Some(state), Some(image)) = (context.render_state, &mut self.image) {
            let texture = image.draw(state, pixels.map(|side| side.round() as u32), frame);
            let uv = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
            painter.image(texture, rect, uv, egui::Color32::WHITE);
        } else {
            painter.rect_filled(rect, 0.0, context.tokens.sunken);
        }
        let overlay = hud::Overlay {
            painter: &painter,
            rect,
            camera: &moved,
            ground: &shown.ground,
            snapshot,
            context,
            view,
        };
        overlay.paint(response.hover_pos());
        if response.clicked()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            let hit =
                drag::Scene { rect, camera: &moved, ground: &shown.ground, snapshot, context }.pick(pointer);
            commands.send(Command::SelectAndReveal(hit));
        }
        if response.double_clicked()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            let (origin, direction) =
                moved.ray(Vec2::new(pointer.x - rect.min.x, pointer.y - rect.min.y), size);
            if let Some(hit) = shown.ground.hit(origin, direction) {
                moved.target_m = hit;
                moved.zoom(0.5);
                self.camera = Some(moved);
                self.follow = None;
            }
        }
    }
}

/// What a screen reader says of the image.
fn describe(snapshot: &Snapshot, time: f64) -> String {
    let mut text = format!("Time {time:.0}.");
    for (index, vehicle) in snapshot.program.world.vehicles.iter().enumerate() {
        if let Some((place, _)) = scene::vehicle_pose(snapshot, index, time) {
            text.push_str(&format!(" {} at {:.0}, {:.0}.", vehicle.name.text, place.x, place.y));
        }
    }
    text
}

fn from_map(map: &Terrain, height_scale: f32) -> Ground {
    let frame = map.frame();
    let half = frame.cell_size_m / 2.0;
    let origin = Vec2::new((frame.origin_m[0] + half) as f32, (frame.origin_m[1] + half) as f32);
    let heights: Vec<f32> = map.heights_m().iter().map(|height| height * height_scale).collect();
    Ground::new(frame.width, frame.height, frame.cell_size_m as f32, origin, &heights)
}

fn navigate(response: &egui::Response, camera: &mut Camera, size: Vec2) {
    let drag = Vec2::new(response.drag_delta().x, response.drag_delta().y);
    let shift = response.ctx.input(|input| input.modifiers.shift);
    if response.dragged_by(PointerButton::Secondary)
        || response.dragged_by(PointerButton::Middle)
        || (response.dragged_by(PointerButton::Primary) && shift)
    {
        camera.pan(drag, size.y);
    } else if response.dragged_by(PointerButton::Primary) {
        camera.orbit(drag);
    }
    if response.hovered() {
        let (scroll, pinch) = response.ctx.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        if scroll != 0.0 {
            camera.zoom((-scroll * WHEEL_ZOOM).exp());
        }
        if pinch != 1.0 {
            camera.zoom(1.0 / pinch);
        }
    }
    if response.has_focus() {
        let step = 24.0;
        response.ctx.input(|input| {
            let pressed = |key| f32::from(u8::from(input.key_pressed(key)));
            let across = pressed(egui::Key::ArrowLeft) - pressed(egui::Key::ArrowRight);
            let along = pressed(egui::Key::ArrowUp) - pressed(egui::Key::ArrowDown);
            if input.modifiers.shift {
                camera.orbit(Vec2::new(across, along) * step);
            } else {
                camera.pan(Vec2::new(across, along) * step, size.y);
            }
        });
    }
}

fn follow_action(
    action: ViewAction,
    camera: &mut Camera,
    ground: &Ground,
    snapshot: &Snapshot,
    selection: &Selection,
) {
    let overview = Camera::overview(ground.center_m(), ground.size_m().max_element());
    match action {
        ViewAction::ZoomIn => camera.zoom(0.75),
        ViewAction::ZoomOut => camera.zoom(1.0 / 0.75),
        ViewAction::ZoomReset | ViewAction::Fit => *camera = overview,
        ViewAction::FitSelection => {
            if let Some(place) = drag::place_of(snapshot, selection) {
                camera.target_m = ground.drape(place, 0.0);
                camera.distance_m = 60.0_f32.min(overview.distance_m);
            }
        }
    }
}

fn frame(
    context: &Context<'_>,
    snapshot: &Snapshot,
    view: &TerrainView,
    camera: &Camera,
    ground: &Ground,
    pixels: [f32; 2],
) -> Frame {
    let tokens = context.tokens;
    let clip_from_world = camera.clip_from_world(pixels[0] / pixels[1].max(1.0));
    let eye = camera.eye_m();
    let relief = (ground.range_m[1] - ground.range_m[0]) / view.height_scale;
    let contour = CONTOUR_STEPS_M.into_iter().find(|step| relief / step < 24.0).unwrap_or(1000.0);
    let sun = Vec3::new(-0.55, 0.45, 0.70).normalize();
    let horizon = hud::rgba(tokens.sunken);
    let scale = hud::vehicle_scale(camera.distance_m);
    let options = SceneOptions {
        trees: view.trees,
        paths: view.paths,
        obstacles: view.obstacles,
        vehicle_scale: scale,
    };
    let selection = &context.state.selection;
    let palette = palette(context);
    let time = context.state.playback.time;
    Frame {
        view: ViewUniform {
            clip_from_world: clip_from_world.to_cols_array_2d(),
            eye: eye.extend(camera.distance_m * 2.5 + 600.0).to_array(),
            sun: sun.extend(0.38).to_array(),
            origin_cell: [ground.origin_m.x, ground.origin_m.y, ground.cell_m, view.height_scale],
            range: [
                ground.range_m[0],
                ground.range_m[1],
                if view.contours { contour } else { 0.0 },
                if view.grid { hud::grid_spacing_m(camera.distance_m) } else { 0.0 },
            ],
            image: [
                pixels[0],
                pixels[1],
                match view.coloring {
                    Coloring::Natural => 0.0,
                    Coloring::Height => 1.0,
                    Coloring::Slope => 2.0,
                },
                0.0,
            ],
            horizon,
        },
        patches: detail::patches(ground, eye, &clip_from_world, REFINEMENT),
        shapes: scene::build(snapshot, ground, time, selection, &palette, &options),
        background: [horizon[0], horizon[1], horizon[2]],
    }
}

fn palette(context: &Context<'_>) -> ScenePalette {
    let tokens = context.tokens;
    let color = |color, opacity| {
        let [r, g, b, _] = hud::rgba(color);
        [r, g, b, opacity]
    };
    ScenePalette {
        obstacle: color(tokens.text_muted, 0.92),
        location: color(tokens.text_on_accent, 1.0),
        selected: color(tokens.accent, 1.0),
        tree: color(tokens.text_on_accent, 0.35),
        path: color(tokens.path, 0.95),
        warning: color(tokens.warning, 1.0),
        vehicles: std::array::from_fn(|index| color(tokens.series(index), 1.0)),
    }
}

/// The margin between the image's border and what is written on it.
const MARGIN: f32 = space::M;
