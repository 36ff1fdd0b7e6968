//! The terrain: the ground in three dimensions with the mission's places, obstacles, paths and vehicles.
//!
//! Left drag turns, right drag or Shift moves, the wheel zooms. Dragging a place, an obstacle or a vehicle that has not
//! moved yet rewrites its declaration in the text. A click on a path shows what is known of it.

mod card;
mod clearance;
mod drag;
mod hud;
mod labels;
mod measure;
mod steer;
mod surface;
mod tool;
mod toolbar;
mod tree;

use std::sync::Arc;

use egui::{CursorIcon, Rect, Response, RichText, Sense};
use glam::Vec2;
use snapshot::Snapshot;
use terrain::Terrain;
use terrain_view::camera::Camera;
use terrain_view::flight::Flight;
use terrain_view::gpu::TerrainImage;
use terrain_view::pace::{Pace, Savings};
use terrain_view::pick::Scene;
use terrain_view::sun::Sun;
use terrain_view::tour::Shot;
use terrain_view::{driving, frame, navigate, scene};
use text_editing::EditKind;
use theme::space;
use tpn::OccurrenceId;
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::settings::{Effects, SettingsCommand, SunView, TerrainView};
use workbench::state::terrain::{Film, TerrainCommand, Tool};

use crate::{Context, Panel, draw_menu, show_empty};
use clearance::Clearance;
use drag::Drag;
use measure::Measurement;
use surface::{DecalKey, Light, Shown};

/// The panel, with what concerns only it: the camera and what is on the graphics card.
#[derive(Default)]
pub struct TerrainPanel {
    image: Option<TerrainImage>,
    ground: Option<Shown>,
    decal: Option<DecalKey>,
    clearance: Option<Clearance>,
    /// Where the user wants to look from.
    camera: Option<Camera>,
    /// Where the last frame looked from: over the ground.
    drawn: Option<Camera>,
    /// The view of the whole map, and the shape of the panel that it was made for.
    fitted: Option<(Camera, f32)>,
    flight: Option<Flight>,
    mount: Mount,
    /// How far the camera of a tour had turned in the last frame.
    toured_rad: f32,
    /// What the light of the last frame was made from.
    light: Option<Light>,
    pace: Pace,
    drag: Option<Drag>,
    /// Where a tool's drag began.
    pressed_m: Option<Vec2>,
    /// How many drags there were: each is one step of the history.
    drag_count: u64,
    /// The path that was clicked last: its traverse, its leg and the place.
    clicked: Option<(OccurrenceId, usize, Vec2)>,
    /// The plates with names in the last frame.
    plates: Vec<(Rect, Selection)>,
    told_hover: Selection,
    /// The ground under the last right click.
    menu_m: Option<nalgebra::Point2<f64>>,
}

/// What moves the camera besides its user. Vehicles are indices into the program's world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Mount {
    #[default]
    Free,
    /// It keeps a vehicle in the middle.
    Follow(usize),
    /// It is on a vehicle, and looks ahead.
    OnBoard(usize),
    /// It goes to where something moves.
    Tour(Shot),
}

impl Mount {
    /// The vehicle that is kept in the middle.
    const fn followed(self) -> Option<usize> {
        match self {
            Self::Follow(vehicle) | Self::Tour(Shot::Vehicle(vehicle)) => Some(vehicle),
            _ => None,
        }
    }
}

/// The margin between the image's border and what is written on it.
const MARGIN: f32 = space::M;

impl Panel for TerrainPanel {
    fn show(&mut self, ui: &mut egui::Ui, context: &Context<'_>, commands: &mut CommandSender) {
        if context.state.automaton.program().is_some() {
            show_empty(ui, context, "A control program has no terrain. Open a mission to see one.");
            return;
        }
        let Some(snapshot) = context.snapshot else {
            show_empty(ui, context, "Loading the terrain…");
            return;
        };
        if snapshot.map.is_none() {
            show_without_world(ui, context, commands);
            return;
        }
        let views = &context.state.settings.views;
        let mut view = views.terrain.clone();
        let before = self.mount;
        let savings = self.savings(&view);
        toolbar::show(ui, context, snapshot, &mut view, (&mut self.mount, savings), commands);
        if view != views.terrain {
            commands.send(Command::Settings(SettingsCommand::SetViews(Box::new(workbench::state::Views {
                terrain: view.clone(),
                ..views.clone()
            }))));
        }
        if self.mount != before && matches!(self.mount, Mount::Follow(_)) {
            self.fly_to_followed(context, snapshot);
        }
        let map = context.state.maps.of(snapshot);
        self.show_ground(context, map, snapshot, &view);
        self.lay_decal(context, snapshot, map, &view);
        self.lay_light(context, snapshot, &view);
        self.show_image(ui, context, snapshot, map, &view, commands);
    }
}

impl TerrainPanel {
    /// Returns what is left out of the image.
    const fn savings(&self, view: &TerrainView) -> Savings {
        match view.effects {
            Effects::Automatic => self.pace.savings(),
            Effects::Full => Savings::None,
            Effects::Reduced => Savings::Most,
        }
    }

    fn show_image(
        &mut self,
        ui: &mut egui::Ui,
        context: &Context<'_>,
        snapshot: &Snapshot,
        map: Option<&Arc<Terrain>>,
        view: &TerrainView,
        commands: &mut CommandSender,
    ) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        crate::note_drawing(&response);
        let measured = map.and_then(|map| measurement(context, map));
        let described = describe(context, snapshot, measured.as_ref());
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::Role::Image, true, format!("Terrain. {described}"))
        });
        if rect.width() < 2.0 || rect.height() < 2.0 {
            return;
        }
        // As long as the user has not moved the camera, it shows the whole map, whatever the panel's shape.
        if let Some(shown) = &self.ground
            && (self.camera.is_none()
                || self.fitted.is_some_and(|(camera, shape)| {
                    self.camera == Some(camera) && shape != rect.aspect_ratio()
                }))
        {
            let camera = Camera::fitting(&shown.ground, rect.aspect_ratio());
            (self.camera, self.fitted) = (Some(camera), None);
        }
        tell_film_area(ui, context, rect, commands);
        self.handle_input(&response, rect, context, snapshot, commands);
        self.move_camera(&response, context, snapshot);
        let is_moving = context.state.playback.is_playing
            || context.state.terrain.growth.is_playing
            || self.flight.is_some()
            || response.dragged();
        self.pace.note(context.now_secs, is_moving);
        if let (None, Some(camera)) = (self.fitted, self.camera) {
            self.fitted = Some((camera, rect.aspect_ratio()));
        }
        let (Some(camera), Some(shown)) = (self.drawn, &self.ground) else { return };
        let ground = &shown.ground;
        let scene =
            Scene { rect, camera: &camera, ground, snapshot, state: context.state, plates: &self.plates };
        let mut sketch = tool::sketch(&response, &scene, self.pressed_m, measured.as_ref());
        if let Some(drag) = self.drag.as_ref().filter(|drag| drag.is_start()) {
            sketch.marks.push(drag.last_m);
        }
        let painter = ui.painter_at(rect);
        let pixels_per_point = ui.ctx().pixels_per_point();
        let input = frame::Input {
            state: context.state,
            tokens: context.tokens,
            snapshot,
            map,
            view,
            camera: &camera,
            ground,
            sketch: &sketch,
            sun: sun(context, view),
            savings: self.savings(view),
        };
        match (context.render_state, &mut self.image) {
            (Some(state), Some(_)) if !TerrainImage::holds(state, ground) => {
                painter.rect_filled(rect, 0.0, context.tokens.sunken);
                let words = format!(
                    "The map has {} × {} cells, more than this browser's graphics can show. The plan is unaffected.",
                    ground.width, ground.height
                );
                let font = egui::TextStyle::Body.resolve(ui.style());
                let galley =
                    painter.layout(words, font, context.tokens.text_muted, rect.width() - 2.0 * space::L);
                painter.galley(rect.center() - galley.size() / 2.0, galley, context.tokens.text_muted);
            }
            (Some(state), Some(image)) => {
                frame::paint(&painter, rect, pixels_per_point, state, image, &input);
            }
            _ => {
                painter.rect_filled(rect, 0.0, context.tokens.sunken);
            }
        }
        let overlay =
            hud::Overlay { painter: &painter, rect, camera: &camera, ground, snapshot, context, view };
        let terrain = &context.state.terrain;
        let hint = tool::hint(&terrain.tool, terrain.points_m.len());
        let clearance_of = self.clearance.as_ref().map(|it| it.model.as_str());
        let plates = overlay.paint(response.hover_pos(), hint.as_deref(), clearance_of);
        if let Some(hint) = &hint {
            let top = Rect::from_min_size(rect.min, egui::vec2(rect.width(), space::BAR));
            let node = ui.interact(top, response.id.with("hint"), Sense::hover());
            node.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, hint));
        }
        for (plate, names) in &plates {
            let name = format!("{} on the map", names.name(None));
            let node = ui.interact(*plate, response.id.with(&name), Sense::hover());
            node.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
        }
        self.show_cards(ui, context, snapshot, &overlay, measured.as_ref(), commands);
        self.plates = plates;
    }

    /// What clicks, drags and the pointer do.
    fn handle_input(
        &mut self,
        response: &Response,
        rect: Rect,
        context: &Context<'_>,
        snapshot: &Snapshot,
        commands: &mut CommandSender,
    ) {
        let (Some(wanted), Some(shown)) = (self.camera, &self.ground) else { return };
        let camera = self.drawn.unwrap_or(wanted);
        let ground = &shown.ground;
        let scene =
            Scene { rect, camera: &camera, ground, snapshot, state: context.state, plates: &self.plates };
        let tool = &context.state.terrain.tool;
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if *tool == Tool::Look {
            self.drag = drag::update(self.drag.take(), &mut self.drag_count, response, &scene, commands);
        } else {
            self.drag = None;
            tool::update(response, &scene, &mut self.pressed_m, commands);
        }
        let is_drawing = matches!(tool, Tool::Circle | Tool::Appear | Tool::Wall)
            && response.dragged_by(egui::PointerButton::Primary);
        if self.drag.is_none() && !is_drawing {
            let mut moved = wanted;
            let under = response.hover_pos().and_then(|pointer| scene.hit(pointer));
            navigate::update(response, &mut moved, scene.size(), under);
            if moved != wanted {
                self.flight = None;
                let stays = moved.target_m == wanted.target_m || is_zoomed(&wanted, &moved);
                self.mount = self.mount.followed().filter(|_| stays).map_or(Mount::Free, Mount::Follow);
                self.camera = Some(moved);
            }
        }
        if *tool != Tool::Look {
            if response.hovered() {
                response.ctx.set_cursor_icon(CursorIcon::Crosshair);
            }
            return;
        }
        let pointed = response.hover_pos().map(|pointer| scene.pick(pointer)).unwrap_or_default();
        if response.hovered() && self.drag.is_none() {
            let icon = match () {
                () if response.hover_pos().is_some_and(|at| drag::is_draggable(at, &scene)) => {
                    Some(CursorIcon::Grab)
                }
                () if !pointed.is_none() => Some(CursorIcon::PointingHand),
                () => None,
            };
            if let Some(icon) = icon {
                response.ctx.set_cursor_icon(icon);
            }
        }
        let mut clicked = None;
        let mut flies_to = None;
        if let Some(pointer) = response.interact_pointer_pos() {
            if response.clicked() {
                let on_path = scene.pick_path(pointer);
                let selection = scene.pick(pointer);
                let occurrence = selection.occurrence_of_path(snapshot);
                clicked = on_path.zip(occurrence).map(|(on, occurrence)| (occurrence, on.leg, on.place_m));
                commands.send(Command::Select(selection));
            }
            if response.double_clicked() {
                let selection = scene.pick(pointer);
                flies_to = Some((selection, scene.hit(pointer)));
            }
        }
        if response.clicked() {
            self.clicked = clicked;
        }
        if response.secondary_clicked()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            self.menu_m = scene.ground_at(pointer).map(tool::meters);
            commands.send(Command::Select(scene.pick(pointer)));
        }
        draw_menu::terrain(response, context, self.menu_m, commands);
        self.tell_hover(context, pointed, commands);
        if let Some((selection, hit)) = flies_to {
            self.fly_to(context, snapshot, &selection, hit);
        }
    }

    /// Tells the other panels what the pointer is over, when that has changed.
    fn tell_hover(&mut self, context: &Context<'_>, pointed: Selection, commands: &mut CommandSender) {
        if pointed == self.told_hover {
            return;
        }
        if !pointed.is_none() || context.state.hovered == self.told_hover {
            commands.send(Command::Hover(pointed.clone()));
        }
        self.told_hover = pointed;
    }

    /// The card of the selected path, and the one of a measurement.
    fn show_cards(
        &self,
        ui: &mut egui::Ui,
        context: &Context<'_>,
        snapshot: &Snapshot,
        overlay: &hud::Overlay<'_>,
        measured: Option<&Measurement>,
        commands: &mut CommandSender,
    ) {
        let anchor = |place: Vec2| overlay.at(overlay.ground.drape(place, 0.0));
        if let Some(measured) = measured {
            let at = anchor(scene::place(measured.ends_m[1])).unwrap_or(overlay.rect.center());
            if card::show_measurement(ui, context, overlay.rect, at, measured) {
                commands.send(Command::Terrain(TerrainCommand::Take(Tool::Measure)));
            }
            return;
        }
        if context.state.terrain.tool != Tool::Look || !overlay.view.paths {
            return;
        }
        let Some(traverse) = card::selected_traverse(snapshot, &context.state.selection) else { return };
        let clicked = self.clicked.filter(|(occurrence, ..)| *occurrence == traverse.occurrence);
        let place = card::path_anchor(traverse, clicked.map(|(.., place)| place));
        let Some(at) = place.and_then(anchor) else { return };
        let leg = clicked.map(|(_, leg, _)| leg);
        let path: Vec<egui::Pos2> = card::path_points(traverse).filter_map(anchor).collect();
        card::show_path(ui, context, overlay.rect, (at, &path), (traverse, leg), commands);
    }
}

/// Returns whether a camera has only come nearer or gone away, which following a vehicle survives.
fn is_zoomed(before: &Camera, after: &Camera) -> bool {
    before.distance_m != after.distance_m
}

/// Tells which part of the window a video is of, when that has changed.
fn tell_film_area(ui: &egui::Ui, context: &Context<'_>, rect: Rect, commands: &mut CommandSender) {
    let Some(film) = context.state.terrain.film else { return };
    let window = ui.ctx().content_rect();
    let (corner, size) = (rect.min - window.min, window.size());
    let area = [corner.x / size.x, corner.y / size.y, rect.width() / size.x, rect.height() / size.y];
    if film != Film::Rolling(area) {
        commands.send(Command::Terrain(TerrainCommand::FilmArea(area)));
    }
}

/// The light: that of the mission's clock, or as it is set. What shows data only is lit as maps are.
fn sun(context: &Context<'_>, view: &TerrainView) -> Sun {
    let fixed = if view.data_only { SunView::default() } else { view.sun };
    let time_of_day_secs =
        context.state.time_of_day_secs().filter(|_| view.sun.follows_clock && !view.data_only);
    time_of_day_secs.map_or_else(|| Sun::fixed(fixed.azimuth_deg, fixed.height_deg), Sun::at_time_of_day)
}

/// Returns what the measuring tool has measured, if it has two places.
fn measurement(context: &Context<'_>, map: &Terrain) -> Option<Measurement> {
    let terrain = &context.state.terrain;
    let [from, to] = terrain.points_m.as_slice() else { return None };
    (terrain.tool == Tool::Measure).then(|| Measurement::new(map, [*from, *to])).flatten()
}

/// Returns what a screen reader says of the image.
fn describe(context: &Context<'_>, snapshot: &Snapshot, measured: Option<&Measurement>) -> String {
    let time = context.state.playback.time;
    let mut text = format!("Time {time:.0}.");
    for (index, vehicle) in snapshot.program.world.vehicles.iter().enumerate() {
        if let Some((place, _)) = scene::vehicle_pose(snapshot, index, time) {
            text.push_str(&format!(" {} at {:.0}, {:.0}.", vehicle.name.text, place.x, place.y));
        }
    }
    for sight in snapshot.network.iter().flat_map(|network| &network.sights) {
        text.push_str(&sight_words(snapshot, sight));
    }
    if let Some(run) = context.state.run_shown() {
        for (vehicle, frame) in driving::under_way(run, time) {
            let vehicle = snapshot.program.world.vehicles.get(vehicle as usize);
            if let Some((vehicle, away_m)) = vehicle.zip(driving::nearest_seen_m(frame)) {
                text.push_str(&format!(" {} detects an obstacle {away_m:.1} m away.", vehicle.name.text));
            }
        }
    }
    if let Some(shown) = context.state.terrain.growth.shown() {
        text.push_str(&format!(" Search tree: {}.", shown.words()));
    }
    if let Some(measured) = measured {
        let rows = measured.rows().into_iter().map(|(what, how_much)| format!("{what} {how_much}"));
        text.push_str(&format!(" Measured: {}.", rows.collect::<Vec<_>>().join(", ")));
    }
    text
}

/// Returns what a vehicle sees of a location.
fn sight_words(snapshot: &Snapshot, sight: &tpn::Sight) -> String {
    let variable = snapshot.network.as_ref().and_then(|it| it.variables.get(sight.variable.index()));
    let vehicle = variable.map_or("A vehicle", |it| it.name.trim_end_matches(".at"));
    if sight.hidden.is_empty() {
        return format!(" {vehicle} sees {} from every location.", sight.location);
    }
    let reasons: Vec<String> = sight.hidden.iter().map(tpn::Hidden::reason).collect();
    format!(" {vehicle} does not see {} from every location: {}.", sight.location, reasons.join(", "))
}

/// A mission without places: what to write, and a button that writes it.
fn show_without_world(ui: &mut egui::Ui, context: &Context<'_>, commands: &mut CommandSender) {
    const WORLD: &str = "terrain \"tai-plain\";\nlocation BASE (40, 40);\n\n";
    ui.vertical_centered(|ui| {
        ui.add_space((ui.available_height() * 0.3).max(space::L));
        ui.set_max_width((ui.available_width() - 2.0 * space::L).min(380.0));
        let text = "This mission has no places. Add a terrain and a location to see its map.";
        ui.label(RichText::new(text).color(context.tokens.text_muted));
        ui.add_space(space::M);
        if ui.button("Add terrain and location").clicked() {
            let offset = workbench::state::placing::first_code(context.state.document.text()) as u32;
            let edit = rmpl::Edit { span: rmpl::Span::new(offset, offset), text: WORLD.to_owned() };
            commands.send(Command::Edit { edits: vec![edit], kind: EditKind::Single });
        }
    });
}
