//! The terrain without a graphics card: picking, measuring, placing, dragging, and the growth of search trees.

use crate::support;
use egui::{Pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use serde_json::json;
use workbench::command::Command;
use workbench::host::{FileKind, HostEvent};
use workbench::host_io::Remote as _;

/// Two places 80 m apart on level ground, and a rover that drives to one and from there to the other.
const MISSION: &str = "\
terrain \"flat\";
location DEPOT (60, 60);
location HERE (100, 150);
location THERE (180, 150);
obstacle Block circle (140, 200, 8);
vehicle Rover1 : ATRV at DEPOT;
primitive Go(first, second) moves Rover1;
Run()[l,u] = { Go(HERE, THERE) }
scenario S[0,60] = { Run()[0,60] }
";

/// The app with that mission, showing the terrain from straight above and nothing else.
fn above() -> support::App {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().run(Command::OpenSource { name: "test".into(), source: MISSION.to_owned() });
    dispatch(&mut app, "view.workspace", &json!("review"));
    for panel in ["review", "compare", "timeline", "network", "plan", "editor", "problems", "outline"] {
        dispatch(&mut app, "view.closePanel", &json!(panel));
    }
    dispatch(&mut app, "terrain.top", &json!(null));
    for _ in 0..20 {
        app.settle();
    }
    assert_eq!(app.json()["status"], "plan", "{}", app.json()["diagnostics"]);
    app
}

fn dispatch(app: &mut support::App, command: &str, arguments: &serde_json::Value) {
    app.harness.state_mut().dispatch(command, arguments).expect("a command that can be used");
    app.settle();
}

/// Returns where a place is in the window. From straight above, a name stands right over the place it names.
fn place(app: &support::App, name: &str) -> Pos2 {
    let plate = app.harness.get_by_label(&format!("{name} on the map")).rect();
    plate.center_bottom() + vec2(0.0, 3.0)
}

fn click(app: &mut support::App, at: Pos2) {
    press(app, at, true);
    press(app, at, false);
    app.settle();
}

fn press(app: &mut support::App, pos: Pos2, pressed: bool) {
    app.harness.event(egui::Event::PointerMoved(pos));
    app.harness.step();
    let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
    app.harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
    app.harness.step();
}

/// Between places, on the path.
fn on_path(app: &support::App) -> Pos2 {
    place(app, "HERE").lerp(place(app, "THERE"), 0.5)
}

#[test]
fn a_click_on_a_path_selects_it_everywhere_and_says_what_is_known_of_it() {
    let mut app = above();
    let at = on_path(&app);
    click(&mut app, at);
    assert_eq!(app.json()["selection"]["name"], "Go#1");
    app.harness.get_by_label("Length");
    // The first leg is as long as 40 by 90 m are.
    app.harness.get_by_label("178 m");
    app.harness.get_by_label("to THERE, 80.0 m");
    app.harness.get_by_label("Duration");
    app.harness.get_by_label("Steepest slope");
    app.harness.get_by_label("Leg clearance");
    app.harness.get_by_label("Close Go(HERE, THERE)").click();
    app.settle();
    assert_eq!(app.json()["selection"], json!(null));
    assert!(app.harness.query_by_label("Length").is_none());
}

#[test]
fn two_clicks_measure_and_a_third_begins_anew() {
    let mut app = above();
    dispatch(&mut app, "terrain.measure", &json!(null));
    let (here, there) = (place(&app, "HERE"), place(&app, "THERE"));
    click(&mut app, here);
    app.harness.get_by_label("Click the end point");
    click(&mut app, there);
    let found = std::cell::RefCell::new(String::new());
    app.harness.get_by(|node| {
        let label = node.label().unwrap_or_default();
        let is_measured = label.starts_with("Terrain.") && label.contains("Measured");
        if is_measured {
            label.clone_into(&mut found.borrow_mut());
        }
        is_measured
    });
    let label = found.into_inner();
    let ground = label.split("Surface distance ").nth(1).and_then(|rest| rest.split(" m").next());
    let meters: f64 = ground.and_then(|text| text.parse().ok()).expect("a distance");
    assert!((meters - 80.0).abs() < 2.5, "{label}");
    app.harness.get_by_label("Line of sight");
    app.harness.get_by_label("clear");
    click(&mut app, here);
    assert_eq!(app.json()["terrain"]["points"].as_array().map(Vec::len), Some(1));
    dispatch(&mut app, "go.leave", &json!(null));
    dispatch(&mut app, "go.leave", &json!(null));
    assert_eq!(app.json()["terrain"]["tool"], "look");
}

#[test]
fn a_click_places_a_location_in_the_text_and_one_step_back_takes_it_away() {
    let mut app = above();
    let middle = on_path(&app) + vec2(0.0, 60.0);
    dispatch(&mut app, "terrain.location", &json!(null));
    click(&mut app, middle);
    let source = app.harness.state().source();
    let line = source.lines().find(|line| line.starts_with("location P1 (")).expect("a declaration");
    let numbers = line.trim_start_matches("location P1 (").trim_end_matches(");");
    let (east, north) = numbers.split_once(", ").expect("two numbers");
    let (east, north): (f64, f64) = (east.parse().expect("meters"), north.parse().expect("meters"));
    assert!((east - 140.0).abs() < 3.0 && north < 150.0, "{line}");
    assert_eq!(source.replace(&format!("{line}\n"), ""), MISSION);
    assert_eq!(app.json()["selection"]["name"], "P1");
    assert_eq!(app.json()["terrain"]["tool"], "look");
    dispatch(&mut app, "edit.undo", &json!(null));
    assert_eq!(app.harness.state().source(), MISSION);
}

#[test]
fn a_drag_places_a_round_obstacle_and_clicks_place_one_with_corners() {
    let mut app = above();
    let middle = on_path(&app) + vec2(0.0, 90.0);
    let (here, there) = (place(&app, "HERE"), place(&app, "THERE"));
    let ten_meters = (there.x - here.x) / 8.0;
    dispatch(&mut app, "terrain.circle", &json!(null));
    press(&mut app, middle, true);
    for part in 1..=4 {
        app.harness.event(egui::Event::PointerMoved(middle + vec2(ten_meters * part as f32 / 4.0, 0.0)));
        app.harness.step();
    }
    press(&mut app, middle + vec2(ten_meters, 0.0), false);
    app.settle();
    let source = app.harness.state().source();
    let line =
        source.lines().find(|line| line.starts_with("obstacle Rock1 circle (")).expect("a declaration");
    let radius = line.trim_end_matches(");").rsplit(", ").next().and_then(|text| text.parse::<f64>().ok());
    assert!((radius.expect("a radius") - 10.0).abs() < 0.6, "{line}");
    dispatch(&mut app, "terrain.polygon", &json!(null));
    for corner in [vec2(-90.0, 0.0), vec2(-60.0, 0.0), vec2(-60.0, 40.0)] {
        click(&mut app, middle + corner);
    }
    app.harness.key_press(egui::Key::Enter);
    app.settle();
    let source = app.harness.state().source();
    let line =
        source.lines().find(|line| line.starts_with("obstacle Area1 polygon (")).expect("a declaration");
    assert_eq!(line.split(", ").count(), 6, "{line}");
    for _ in 0..2 {
        dispatch(&mut app, "edit.undo", &json!(null));
    }
    assert_eq!(app.harness.state().source(), MISSION);
}

#[test]
fn a_drag_draws_a_wall_while_a_tree_is_shown_and_a_click_none() {
    let mut app = above();
    dispatch(&mut app, "terrain.growth", &json!(null));
    dispatch(&mut app, "terrain.growBy", &json!({ "planner": "rrt" }));
    dispatch(&mut app, "terrain.growTo", &json!({ "samples": 3 }));
    assert_eq!(app.json()["terrain"]["growth"]["samples"], 3);
    let (here, there) = (place(&app, "HERE"), place(&app, "THERE"));
    let ten_meters = (there.x - here.x) / 8.0;
    let from = on_path(&app) + vec2(0.0, 90.0);
    dispatch(&mut app, "terrain.wall", &json!(null));
    app.harness.get_by_label("Drag from one end of the wall to the other · Shift for several");
    click(&mut app, from);
    assert_eq!(app.harness.state().source(), MISSION, "a click is no wall");
    press(&mut app, from, true);
    for part in 1..=4 {
        app.harness.event(egui::Event::PointerMoved(from + vec2(ten_meters * part as f32 / 2.0, 0.0)));
        app.harness.step();
    }
    press(&mut app, from + vec2(2.0 * ten_meters, 0.0), false);
    app.settle();
    let source = app.harness.state().source();
    let line =
        source.lines().find(|line| line.starts_with("obstacle Wall1 polygon (")).expect("a declaration");
    let numbers = line.trim_start_matches("obstacle Wall1 polygon (").trim_end_matches(");").split(", ");
    let corners: Vec<f64> = numbers.map(|number| number.parse().expect("a number")).collect();
    let extent = |axis: usize| {
        let along = corners.iter().skip(axis).step_by(2);
        along.clone().copied().fold(f64::MIN, f64::max) - along.copied().fold(f64::MAX, f64::min)
    };
    assert!((extent(0) - 20.0).abs() < 1.0 && (2.9..4.5).contains(&extent(1)), "{line}");
    assert_eq!(app.json()["terrain"]["growth"]["samples"], 3, "the tree is looked at where it was");
    dispatch(&mut app, "edit.undo", &json!(null));
    assert_eq!(app.harness.state().source(), MISSION);
}

#[test]
fn a_race_is_a_table_and_a_click_shows_one_of_its_planners_alone() {
    let mut app = above();
    dispatch(&mut app, "terrain.growth", &json!(null));
    dispatch(&mut app, "terrain.growBy", &json!({ "planner": "race" }));
    dispatch(&mut app, "terrain.growTo", &json!({ "samples": 1_000_000 }));
    for name in ["Planner", "Vertices", "Checks", "Path", "Search time"] {
        app.harness.get_by_label(name);
    }
    let searches = app.json()["terrain"]["growth"]["searches"].clone();
    assert_eq!(searches.as_array().map(Vec::len), Some(4));
    let checks = searches[3]["checks"].to_string();
    app.harness.get_by_label(&checks);
    app.harness.get_by_label("RRT*").click();
    app.settle();
    assert_eq!(app.json()["terrain"]["growth"]["planner"], "RRT*");
    assert!(app.harness.query_by_label("Search time").is_none());
    app.harness.get_by_label("Before the first sample.");
}

#[test]
fn a_vehicle_starts_at_the_location_that_is_clicked() {
    let mut app = above();
    dispatch(&mut app, "terrain.vehicle", &json!(null));
    let there = place(&app, "THERE");
    click(&mut app, there);
    let expected = MISSION.replace("at DEPOT;\n", "at DEPOT;\nvehicle Rover2 : ATRV at THERE;\n");
    assert_eq!(app.harness.state().source(), expected);
}

#[test]
fn a_dragged_location_moves_plan_and_path_and_is_put_back_in_one_step() {
    let mut app = above();
    let there = place(&app, "THERE");
    let before = app.json()["plan"].clone();
    press(&mut app, there, true);
    let mut lengths = Vec::new();
    for step in 1..=6 {
        app.harness.event(egui::Event::PointerMoved(there + vec2(0.0, -12.0 * step as f32)));
        app.harness.step();
        app.settle();
        let shown = app.harness.state().app_state().shown().cloned().expect("a snapshot");
        lengths.push(shown.traverses.first().expect("a traverse").length_m);
    }
    assert!(lengths.windows(2).all(|pair| pair[1] > pair[0]), "paths follow while dragging: {lengths:?}");
    press(&mut app, there + vec2(0.0, -72.0), false);
    app.settle();
    assert_ne!(app.json()["plan"], before);
    assert_ne!(app.harness.state().source(), MISSION);
    dispatch(&mut app, "edit.undo", &json!(null));
    assert_eq!(app.harness.state().source(), MISSION);
    assert_eq!(app.json()["plan"], before);
}

#[test]
fn a_drag_that_begins_on_a_name_turns_the_view_until_the_thing_is_selected() {
    let mut app = above();
    let drag = |app: &mut support::App| {
        let plate = app.harness.get_by_label("THERE on the map").rect();
        let from = plate.left_center() + vec2(4.0, 0.0);
        press(app, from, true);
        for step in 1..=4 {
            app.harness.event(egui::Event::PointerMoved(from + vec2(0.0, -10.0 * step as f32)));
            app.harness.step();
            app.settle();
        }
        press(app, from + vec2(0.0, -40.0), false);
        app.settle();
    };
    drag(&mut app);
    assert_eq!(app.harness.state().source(), MISSION, "turning the view moves nothing");
    assert_eq!(app.json()["selection"], json!(null));
    dispatch(&mut app, "terrain.top", &json!(null));
    for _ in 0..20 {
        app.settle();
    }
    let plate = app.harness.get_by_label("THERE on the map").rect();
    click(&mut app, plate.left_center() + vec2(4.0, 0.0));
    assert_eq!(app.json()["selection"]["name"], json!("THERE"));
    drag(&mut app);
    assert_ne!(app.harness.state().source(), MISSION, "what is selected follows the pointer");
}

#[test]
fn the_search_tree_grows_by_samples_and_goes_back() {
    let mut app = above();
    dispatch(&mut app, "terrain.growth", &json!(null));
    let growth = |app: &support::App| app.json()["terrain"]["growth"].clone();
    assert_eq!(growth(&app)["samples"], 0);
    let total = growth(&app)["total"].as_u64().expect("a number");
    assert!(total > 0);
    dispatch(&mut app, "terrain.growTo", &json!(total));
    let whole = growth(&app);
    let length = whole["length"].as_f64().expect("a path is found");
    assert!((80.0..400.0).contains(&length), "{length}");
    dispatch(&mut app, "play.back", &json!(null));
    assert_eq!(growth(&app)["samples"], total - 1);
    assert_eq!(growth(&app)["length"], json!(null));
    dispatch(&mut app, "play.forward", &json!(null));
    assert_eq!(growth(&app), whole, "the same sample gives the same tree");
    dispatch(&mut app, "play.toggle", &json!(null));
    for _ in 0..20 {
        app.settle();
    }
    assert!(growth(&app)["samples"].as_u64() > Some(0));
    app.harness.get_by_label("Hide search tree").click();
    app.settle();
    assert_eq!(growth(&app), json!(null));
}

#[test]
fn a_mission_without_places_gets_a_world_by_a_click() {
    let mut app = support::start();
    app.settle();
    dispatch(&mut app, "view.workspace", &json!("review"));
    let source = "scenario S[0,60] = { Wait()[0,10] }\n";
    app.harness.state_mut().run(Command::OpenSource { name: "bare".into(), source: source.to_owned() });
    app.settle();
    app.harness.get_by_label("Add terrain and location").click();
    app.settle();
    app.settle();
    assert!(app.harness.state().source().starts_with("terrain \"tai-plain\";\nlocation BASE"));
    assert!(app.harness.query_by_label("Add terrain and location").is_none());
    dispatch(&mut app, "edit.undo", &json!(null));
    assert_eq!(app.harness.state().source(), source);
}

#[test]
fn an_imported_map_is_found_by_the_text_that_names_it_and_a_broken_one_is_explained() {
    let mut app = support::start();
    app.settle();
    let open = |app: &mut support::App, name: &str, bytes: &[u8]| {
        let event = HostEvent::FileOpened {
            kind: FileKind::of_name(name),
            name: name.into(),
            bytes: bytes.to_vec(),
            token: None,
        };
        app.world.news.borrow_mut().push_back(event);
        app.settle();
        app.settle();
    };
    let source = MISSION.replace("\"flat\"", "\"hill.pgm\" cell 10");
    app.harness.state_mut().run(Command::OpenSource { name: "test".into(), source });
    app.settle();
    assert_eq!(app.json()["diagnostics"][0]["code"], "E-UNDEF");
    open(&mut app, "broken.pgm", b"P5 3 3 255\n..");
    let toasts = app.json()["toasts"].to_string();
    assert!(toasts.contains("import map broken.pgm"), "{toasts}");
    let mut map = b"P5 30 30 255\n".to_vec();
    map.extend([7; 900]);
    open(&mut app, "hill.pgm", &map);
    let toasts = app.json()["toasts"].to_string();
    assert!(toasts.contains("30 × 30 cells"), "{toasts}");
    assert_eq!(app.json()["status"], "plan", "{}", app.json()["diagnostics"]);
}

#[test]
fn the_panel_is_usable_at_a_width_of_300_points() {
    let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size([300.0, 420.0]));
    app.settle();
    app.harness.state_mut().run(Command::OpenSource { name: "test".into(), source: MISSION.to_owned() });
    dispatch(&mut app, "view.workspace", &json!("review"));
    for panel in ["review", "compare", "timeline", "network", "plan", "editor", "problems", "outline"] {
        dispatch(&mut app, "view.closePanel", &json!(panel));
    }
    dispatch(&mut app, "terrain.growth", &json!(null));
    dispatch(&mut app, "go.select", &json!("Go#1"));
    for name in ["Measure", "Place", "Camera", "Hide search tree", "Close Go(HERE, THERE)"] {
        let rect = app.harness.get_by_label(name).rect();
        assert!(rect.left() >= 0.0 && rect.right() <= 300.0 && rect.bottom() <= 420.0, "{name} at {rect:?}");
    }
}

/// Two fingers on the ground, from some places to others.
fn two_fingers(app: &mut support::App, from: [Pos2; 2], to: [Pos2; 2]) {
    let mut touch = |phase: egui::TouchPhase, places: [Pos2; 2]| {
        app.harness.event(egui::Event::PointerMoved(places[0]));
        if phase != egui::TouchPhase::Move {
            app.harness.event(egui::Event::PointerButton {
                pos: places[0],
                button: egui::PointerButton::Primary,
                pressed: phase == egui::TouchPhase::Start,
                modifiers: egui::Modifiers::NONE,
            });
        }
        for (id, pos) in (0..).zip(places) {
            let event = egui::Event::Touch {
                device_id: egui::TouchDeviceId(0),
                id: egui::TouchId(id),
                phase,
                pos,
                force: None,
            };
            app.harness.event(event);
        }
        app.harness.step();
    };
    // A browser takes the first finger for the pointer, too.
    touch(egui::TouchPhase::Start, from);
    for part in [0.25, 0.5, 0.75, 1.0] {
        touch(egui::TouchPhase::Move, [from[0].lerp(to[0], part), from[1].lerp(to[1], part)]);
    }
    touch(egui::TouchPhase::End, to);
    app.settle();
}

#[test]
fn two_fingers_move_the_ground_and_zoom_it() {
    let mut app = above();
    let names = |app: &support::App| ["HERE", "THERE"].map(|name| place(app, name));
    let before = names(&app);
    let away = vec2(40.0, 30.0);
    let fingers = [before[0] + vec2(0.0, 60.0), before[1] + vec2(0.0, 60.0)];
    two_fingers(&mut app, fingers, fingers.map(|at| at + away));
    let moved = names(&app);
    assert!((moved[0] - before[0] - away).length() < 6.0, "{before:?} {moved:?}");
    assert!((moved[1] - before[1] - away).length() < 6.0, "{before:?} {moved:?}");
    let apart = vec2(25.0, 0.0);
    two_fingers(&mut app, fingers, [fingers[0] - apart, fingers[1] + apart]);
    let zoomed = names(&app);
    assert!(zoomed[0].distance(zoomed[1]) > 1.1 * moved[0].distance(moved[1]), "{moved:?} {zoomed:?}");
}

#[test]
fn the_camera_is_there_at_once_where_nothing_is_to_move_by_itself() {
    let mut app = above();
    app.world.reduces_motion.set(true);
    app.settle();
    let before = place(&app, "HERE").distance(place(&app, "THERE"));
    app.harness.state_mut().dispatch("view.panel", &json!("terrain")).expect("a panel");
    app.harness.state_mut().dispatch("view.zoomIn", &json!(null)).expect("a command");
    // Two frames: one does it, and the names follow what is drawn. No time goes by.
    app.harness.step();
    app.harness.step();
    let at_once = place(&app, "HERE").distance(place(&app, "THERE"));
    for _ in 0..10 {
        app.settle();
    }
    let later = place(&app, "HERE").distance(place(&app, "THERE"));
    assert!(at_once > 1.2 * before && (at_once - later).abs() < 0.5, "{before} {at_once} {later}");
}

#[test]
fn a_video_is_of_the_terrain_from_the_start_of_the_run_to_its_end() {
    let mut app = above();
    app.harness.state_mut().run(Command::Seek(30.0));
    dispatch(&mut app, "terrain.video", &json!(null));
    assert_eq!(app.json()["terrain"]["recording"], true);
    let filmed = app.world.filmed.borrow().clone();
    let window = app.harness.ctx.content_rect().size();
    let image = app.harness.get_by(|node| node.label().is_some_and(|it| it.starts_with("Terrain. "))).rect();
    let [left, top, width, height] = *filmed.first().expect("it is recorded");
    let shown = egui::Rect::from_min_size(
        egui::pos2(left * window.x, top * window.y),
        vec2(width * window.x, height * window.y),
    );
    assert!(shown.min.distance(image.min) < 1.0 && shown.max.distance(image.max) < 1.0, "{shown} {image}");
    let playback = &app.harness.state().app_state().playback;
    assert!(playback.is_playing && playback.time < 5.0, "{playback:?}");
    app.harness.get_by_label("Stop recording");
    app.harness.state_mut().run(Command::Seek(f64::MAX));
    app.settle();
    assert_eq!(app.json()["terrain"]["recording"], false);
    let saved: Vec<String> = app.world.saved.borrow().iter().map(|(name, _)| name.clone()).collect();
    assert_eq!(saved, ["test.webm"]);
    assert!(app.harness.query_by_label("Stop recording").is_none());
}

#[test]
fn a_video_ends_when_another_mission_is_opened() {
    let mut app = above();
    dispatch(&mut app, "terrain.video", &json!(null));
    app.harness.state_mut().open("enroute").expect("an example");
    app.settle();
    assert_eq!(app.json()["terrain"]["recording"], false);
    let saved: Vec<String> = app.world.saved.borrow().iter().map(|(name, _)| name.clone()).collect();
    assert_eq!(saved, ["test.webm"]);
}

#[test]
fn where_there_is_no_recorder_the_command_says_so() {
    let mut app = above();
    app.world.cannot_film.set(true);
    dispatch(&mut app, "terrain.video", &json!(null));
    assert_eq!(app.json()["terrain"]["recording"], false);
    let toasts = app.json()["toasts"].to_string();
    assert!(toasts.contains("no recorder here"), "{toasts}");
    assert!(app.world.saved.borrow().is_empty());
}

#[test]
fn the_camera_tours_the_run_and_shows_the_whole_map_when_nothing_moves() {
    let mut app = above();
    app.world.reduces_motion.set(true);
    app.settle();
    let apart = |app: &support::App| place(app, "HERE").distance(place(app, "THERE"));
    let whole = apart(&app);
    dispatch(&mut app, "terrain.tour", &json!(null));
    assert!(app.harness.state().app_state().playback.is_playing, "the tour plays");
    dispatch(&mut app, "play.toggle", &json!(null));
    let drive = app.harness.state().app_state().shown().expect("a plan").motions[0].keyframes.clone();
    let moves: Vec<f64> = drive.iter().map(|frame| frame.time.to_f64()).collect();
    app.harness.state_mut().run(Command::Seek(f64::midpoint(moves[0], moves[moves.len() - 1])));
    app.settle();
    assert!(app.harness.query_by_label("Rover1 on the map").is_some(), "the camera is on the rover");
    assert!(app.harness.query_by_label("DEPOT on the map").is_none(), "the camera is near");
    app.harness.state_mut().run(Command::Seek(f64::MAX));
    app.settle();
    assert!((apart(&app) / whole - 1.0).abs() < 0.5, "{} {whole}", apart(&app));
}
