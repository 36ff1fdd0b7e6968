//! The timeline as a user meets it: dragging events and bounds, grouping, ranges, and missions of any size.

use crate::support;
use egui::{Key, Modifiers, Pos2, Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use layout::timeline::Grouping;
use serde_json::{Value, json};
use workbench::command::Command;
use workbench::host_io::Remote as _;

fn reviewing() -> support::App {
    // High enough for all rows, whatever else the workspace shows.
    let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size([1440.0, 1500.0]));
    app.settle();
    app.harness.state_mut().dispatch("view.workspace", &json!("review")).expect("a workspace");
    // What stands left of the timeline would be taken for its names.
    for panel in ["review", "plan"] {
        app.harness.state_mut().dispatch("view.closePanel", &json!(panel)).expect("a panel");
    }
    app.settle();
    app
}

/// Returns where the handle of an event is; the bar it belongs to is selected first, as a user would find it.
fn handle(app: &support::App, event: &str) -> Pos2 {
    let label = format!("Move {event} on the timeline");
    app.harness.get_by_label(&label).rect().center()
}

/// Points of the screen per mission unit on the time axis, found by looking at it.
fn points_per_unit(app: &mut support::App) -> f32 {
    let axis = app.harness.get_by_label("Time axis").rect();
    let mut time_at = |x: f32| {
        app.harness.drag_at(Pos2::new(x, axis.center().y));
        app.settle();
        app.harness.drop_at(Pos2::new(x, axis.center().y));
        app.settle();
        app.json()["time"].as_f64().expect("a time")
    };
    let (left, right) = (axis.left() + 100.0, axis.left() + 200.0);
    let (early, late) = (time_at(left), time_at(right));
    ((f64::from(right - left)) / (late - early)) as f32
}

fn drag(app: &mut support::App, from: Pos2, to: Pos2) {
    hold(app, from, to);
    app.harness.drop_at(to);
    app.settle();
}

/// Presses at one place and moves to another without letting go.
fn hold(app: &mut support::App, from: Pos2, to: Pos2) {
    app.harness.hover_at(from);
    app.settle();
    app.harness.drag_at(from);
    app.settle();
    for part in [0.3, 0.7, 1.0] {
        app.harness.hover_at(from + (to - from) * part);
        app.settle();
    }
}

fn window(state: &Value, event: &str) -> [f64; 2] {
    let window = &state["windows"][event];
    [window[0].as_f64().expect("a time"), window[1].as_f64().expect("a time")]
}

#[test]
fn dragging_an_event_narrows_the_windows_of_the_others_and_escape_gives_them_back() {
    let mut app = reviewing();
    let scale = points_per_unit(&mut app);
    let source = app.harness.state().source();
    let free = app.json()["plan"].clone();
    // SPEC 3.6: the mission's own slack of 45.
    assert_eq!(window(&free, "Group-Enroute#1.start"), [10.0, 55.0]);
    assert_eq!(app.json()["pinned"], Value::Null);

    let from = handle(&app, "Group-Enroute#1.start");
    hold(&mut app, from, from + vec2(20.0 * scale, 0.0));
    let pinned = app.json()["pinned"].clone();
    let time = pinned["events"]["Group-Enroute#1.start"].as_f64().expect("it is pinned");
    assert!((25.0..=35.0).contains(&time), "{time}");
    assert_eq!(window(&pinned, "Group-Enroute#1.start"), [time, time]);
    // The activity lasts 450 to 540, and the drive in it ends by 460, when the path closes.
    assert_eq!(window(&pinned, "Group-Enroute#1.end")[0], time + 450.0);
    assert_eq!(window(&pinned, "Group-Traverse-Path#1.end"), [time + 405.0, 460.0]);

    // Escape while dragging puts the event back.
    app.harness.key_press(Key::Escape);
    app.settle();
    assert_eq!(app.json()["pinned"], Value::Null);
    app.harness.drop_at(from);
    app.settle();

    // Beyond its window it stays at the window's end; Escape afterwards releases it.
    drag(&mut app, from, from + vec2(300.0 * scale, 0.0));
    let pinned = app.json()["pinned"].clone();
    assert_eq!(window(&pinned, "Group-Enroute#1.start"), [55.0, 55.0]);
    assert_eq!(window(&pinned, "Group-Traverse-Path#1.end"), [460.0, 460.0]);
    assert!(app.harness.query_by_label("1 event pinned").is_some());
    app.harness.key_press(Key::Escape);
    app.settle();
    assert_eq!(app.json()["pinned"], Value::Null);
    assert_eq!(app.json()["plan"], free);
    assert_eq!(app.harness.state().source(), source, "the text was left alone");
}

#[test]
fn the_keyboard_moves_and_releases_events() {
    let mut app = reviewing();
    app.harness.get_by_label("Move Group-Wait(TAI_HOLD1, TAI_HOLD2).end on the timeline").focus();
    app.settle();
    app.harness.key_press(Key::ArrowRight);
    app.settle();
    let pinned = app.json()["pinned"]["events"]["Group-Wait#1.end"].as_f64().expect("it is pinned");
    assert!(pinned > 415.0, "{pinned}");
    app.harness.key_press(Key::Delete);
    app.settle();
    assert_eq!(app.json()["pinned"], Value::Null);
}

#[test]
fn dragging_a_bound_rewrites_its_number_as_one_step_of_the_history() {
    let mut app = reviewing();
    let scale = points_per_unit(&mut app);
    let source = app.harness.state().source();
    app.harness.state_mut().dispatch("go.select", &json!("Group-Enroute#1")).expect("an occurrence");
    app.settle();
    let from = app.harness.get_by_label("Change the maximum duration of Group-Enroute#1").rect().center();
    drag(&mut app, from, from + vec2(-40.0 * scale, 0.0));
    let changed = app.harness.state().source();
    let at = changed.find("Group-Enroute()[450,").expect("the call") + "Group-Enroute()[450,".len();
    let number: f64 = changed[at..].split(']').next().and_then(|it| it.parse().ok()).expect("a number");
    assert!((490.0..=510.0).contains(&number), "{number}");
    assert_eq!(changed.replace(&format!("[450,{number}]"), "[450,540]"), source);
    assert_eq!(window(&app.json()["plan"], "Group-Enroute#1.end")[1], (55.0 + number).min(595.0));

    app.harness.state_mut().dispatch("edit.undo", &Value::Null).expect("an edit");
    app.settle();
    assert_eq!(app.harness.state().source(), source);
}

#[test]
fn a_drag_with_shift_selects_a_range_and_escape_clears_it() {
    let mut app = reviewing();
    let axis = app.harness.get_by_label("Time axis").rect();
    let (from, to) = (axis.left_center() + vec2(60.0, 0.0), axis.left_center() + vec2(220.0, 0.0));
    app.harness.event(egui::Event::ModifiersChanged(Modifiers::SHIFT));
    drag(&mut app, from, to);
    app.harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    let range = app.json()["timeRange"].clone();
    assert!(range[0].as_f64() < range[1].as_f64(), "{range}");
    assert_eq!(app.json()["time"], 0.0, "the time shown stays");
    app.harness.key_press(Key::Escape);
    app.settle();
    assert_eq!(app.json()["timeRange"], Value::Null);
}

fn group(app: &mut support::App, grouping: Grouping) {
    app.harness.state_mut().dispatch("view.grouping", &json!(grouping.name())).expect("a grouping");
    app.settle();
}

#[test]
fn bars_are_in_lanes_by_vehicle_or_by_thread_and_lanes_close() {
    let mut app = reviewing();
    let drives = |app: &support::App| {
        let is_drive = |it: &egui_kittest::Node<'_>| {
            it.accesskit_node().label().is_some_and(|it| {
                it.contains("Group-Traverse-Path(PATH1_1, …, TAI_POS): starts") && !it.contains(" of ")
            })
        };
        app.harness.query_all_by_role(Role::Button).filter(is_drive).count()
    };
    for lane in ["Mission", "Conditions"] {
        app.harness.get_by_label(&format!("Collapse {lane} on the timeline"));
    }
    assert_eq!(drives(&app), 1, "both rovers drive, in a lane of their own");
    let screen = egui::Rect::from_min_size(Pos2::ZERO, vec2(1440.0, 1500.0));
    let shown = |app: &support::App, what: &str| app.texts(screen).iter().any(|(text, _)| text == what);
    assert!(shown(&app, "Rover1, Rover2"));
    assert!(shown(&app, "Group-Traverse-Path(PATH1_1, PATH1_2, PATH1_3, TAI_POS)"), "with its arguments");
    group(&mut app, Grouping::Thread);
    assert!(shown(&app, "Thread 1 · Group-Enroute") && shown(&app, "Thread 1.2 · Group-Wait"));
    assert_eq!(drives(&app), 1);
    group(&mut app, Grouping::Structure);
    app.harness.get_by_label("Collapse Group-Enroute on the timeline").click();
    app.settle();
    app.harness.get_by_label("Expand Group-Enroute on the timeline");
    assert_eq!(drives(&app), 1, "what is collapsed shows its bars in its own row");
}

#[test]
fn a_dropped_event_moves_its_bar_and_rows_still_have_no_overlap() {
    let mut app = reviewing();
    app.harness.get_by_label("Move Group-Wait(TAI_HOLD1, TAI_HOLD2).end on the timeline").focus();
    app.settle();
    for _ in 0..3 {
        app.harness.key_press(Key::ArrowRight);
        app.settle();
    }
    // The handle keeps the keyboard though its bar may be in another row now.
    let end = app.json()["pinned"]["events"]["Group-Wait#1.end"].as_f64().expect("it is pinned");
    assert!(end > 416.0, "{end}");
    let bars: Vec<egui::Rect> = ["Group-Transmit(MCC, ARRIVED_TAI): ", "Group-Wait(TAI_HOLD1, TAI_HOLD2): "]
        .map(|start| app.harness.get_by(|node| node.label().is_some_and(|it| it.starts_with(start))).rect())
        .into();
    assert!(!bars[0].shrink(3.0).intersects(bars[1].shrink(3.0)), "{bars:?}");
}

#[test]
fn conditions_are_tracks_with_what_is_asserted_and_what_is_required() {
    let mut app = reviewing();
    for label in [
        "Tell(PATH1=OK)#1: starts [10, 10], ends [460, 460]",
        "PATH1=OK of Group-Traverse-Path(PATH1_1, …, TAI_POS): starts [10, 55], ends [415, 460]",
    ] {
        let shown = app.harness.query_all_by_role(Role::Button).any(|node| {
            node.accesskit_node()
                .label()
                .is_some_and(|it| it == label || it.ends_with(&label["Tell(".len()..]))
        });
        assert!(shown, "{label}");
    }
    app.harness
        .get_by(|node| {
            node.label()
                .is_some_and(|it| it.starts_with("PATH1=OK of Group-Traverse-Path(PATH1_1, …, TAI_POS)"))
        })
        .click();
    app.settle();
    assert_eq!(app.json()["selection"]["name"], "Ask(PATH1=OK)@Group-Traverse-Path#1");
}

fn generated(nodes: usize) -> support::App {
    let recipe = tpn::generate::Recipe { nodes, tightness: tpn::generate::Tightness::Feasible, seed: 1 };
    let source = tpn::generate::mission(recipe);
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().run(Command::OpenSource { name: "generated".into(), source });
    app.settle();
    app.harness.state_mut().dispatch("view.workspace", &json!("review")).expect("a workspace");
    // What stands left of the timeline would be taken for its names.
    for panel in ["review", "plan"] {
        app.harness.state_mut().dispatch("view.closePanel", &json!(panel)).expect("a panel");
    }
    app.settle();
    app
}

/// Returns where the timeline ends in the workspace for reviews: the network is below it.
fn bottom(app: &support::App) -> f32 {
    app.harness.get_by_label("Close Network").rect().top()
}

#[test]
fn a_large_mission_draws_what_is_in_view() {
    let mut app = generated(1_000);
    assert_eq!(app.json()["status"], "plan");
    let axis = app.harness.get_by_label("Time axis").rect();
    let bars = |app: &support::App| {
        let is_bar = |it: &egui_kittest::Node<'_>| {
            it.accesskit_node().label().is_some_and(|it| it.contains(": starts ["))
        };
        let all: Vec<_> =
            app.harness.query_all_by_role(Role::Button).filter(is_bar).map(|it| it.rect()).collect();
        all.iter().filter(|it| it.top() > axis.bottom() && it.bottom() < bottom(app)).count()
    };
    let all = bars(&app);
    assert!(all > 20, "{all}");
    app.harness.state_mut().dispatch("view.selectTimes", &json!({ "from": 0, "to": 5 })).expect("a range");
    app.settle();
    app.harness.get_by_role_and_label(Role::Button, "Zoom").click();
    app.settle();
    let near = bars(&app);
    assert!(0 < near && near < all, "{near} of {all}");
}
