//! Stepping through searches: by keys, by links, side by side, with every panel at the step; and the one selection.

use crate::support;
use egui::{Key, Modifiers, Rect, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::json;
use workbench::PanelKind;
use workbench::command::Command;
use workbench::host_io::Remote as _;
use workbench::state::window::WindowCommand;

use crate::support::App;

/// The app at this address, in a window of this size, worked out.
fn opened(fragment: &str, size: [f32; 2]) -> App {
    let world = std::rc::Rc::<support::World>::default();
    fragment.clone_into(&mut world.fragment.borrow_mut());
    let mut app = support::start_in(world, |builder| builder.with_size(size));
    app.settle();
    app
}

/// The same with every step of the search, and not key steps only.
fn lesson(fragment: &str) -> App {
    let mut app = opened(&format!("mission=backjump&workspace=teach{fragment}"), [1440.0, 900.0]);
    dispatch(&mut app, "search.keySteps", &json!(null));
    app
}

fn press(app: &mut App, key: Key) {
    press_with(app, Modifiers::NONE, key);
}

fn press_with(app: &mut App, modifiers: Modifiers, key: Key) {
    app.harness.key_press_modifiers(modifiers, key);
    app.settle();
}

fn step(app: &App) -> u64 {
    app.json()["search"]["step"].as_u64().expect("a number")
}

fn dispatch(app: &mut App, command: &str, arguments: &serde_json::Value) {
    app.harness.state_mut().dispatch(command, arguments).expect("a command that can be used");
    app.settle();
}

/// Returns where the search tree is drawn.
fn tree(app: &App) -> Rect {
    let is_tree = |node: &egui_kittest::kittest::AccessKitNode<'_>| {
        node.label().is_some_and(|label| label.contains("search tree of"))
    };
    app.harness.get_by(|node| is_tree(node)).rect()
}

#[test]
fn keys_step_the_search_back_and_forth_and_the_state_says_so() {
    let mut app = lesson("");
    assert_eq!(step(&app), 0);
    let steps = app.json()["search"]["steps"].as_u64().expect("a number");
    assert!(steps > 100);
    for expected in 1..=3 {
        press(&mut app, Key::Period);
        assert_eq!(step(&app), expected);
    }
    press(&mut app, Key::Comma);
    assert_eq!(step(&app), 2);
    press(&mut app, Key::End);
    assert_eq!(step(&app), steps);
    assert_eq!(app.json()["search"]["known"]["event"], "solution");
    press(&mut app, Key::Home);
    assert_eq!(step(&app), 1);
    press(&mut app, Key::Escape);
    assert_eq!(step(&app), 0);
}

#[test]
fn the_last_step_knows_what_the_plan_says() {
    let mut app = lesson("");
    press(&mut app, Key::End);
    let state = app.json();
    assert_eq!(state["search"]["known"]["windows"], state["plan"]["windows"]);
    assert_eq!(state["search"]["known"]["choices"], state["plan"]["choices"]);
}

#[test]
fn stepping_back_leads_to_the_same_states_as_stepping_forth() {
    let mut app = lesson("");
    let mut forth = Vec::new();
    for step in 1..=40 {
        press(&mut app, Key::Period);
        forth.push((step, app.json()["search"]["known"].clone()));
    }
    for (expected, known) in forth.iter().rev() {
        assert_eq!(step(&app), *expected);
        assert_eq!(app.json()["search"]["known"], *known);
        press(&mut app, Key::Comma);
    }
}

#[test]
fn a_link_leads_to_its_step_and_a_step_into_the_link() {
    let mut app = lesson("&step=60");
    assert_eq!(step(&app), 60);
    app.harness.state_mut().run(Command::Window(WindowCommand::CopyLink));
    app.settle();
    press(&mut app, Key::Period);
    let fragment = workbench::host_io::fragment(app.harness.state().app_state());
    assert!(fragment.contains("&step=61"), "{fragment}");
    press(&mut app, Key::Escape);
    let fragment = workbench::host_io::fragment(app.harness.state().app_state());
    assert!(!fragment.contains("step="), "{fragment}");
}

#[test]
fn arrows_walk_the_tree_and_select_what_was_chosen_there() {
    let mut app = lesson("");
    press(&mut app, Key::R);
    assert_eq!(step(&app), 1);
    press(&mut app, Key::ArrowDown);
    assert_eq!(app.json()["selection"]["name"], "D1=0");
    press(&mut app, Key::ArrowDown);
    assert_eq!(app.json()["selection"]["name"], "D2=0");
    press(&mut app, Key::ArrowUp);
    press(&mut app, Key::ArrowRight);
    assert_eq!(app.json()["selection"]["name"], "D1=1");
    press_with(&mut app, Modifiers::SHIFT, Key::ArrowLeft);
    assert_ne!(app.json()["selection"]["name"], "D1=1");
    assert!(step(&app) > 1);
}

#[test]
fn arrows_walk_the_tree_that_has_the_keyboard() {
    let mut app = lesson("");
    let is_tree = |node: &egui_kittest::kittest::AccessKitNode<'_>| {
        node.label().is_some_and(|label| label.contains("search tree of"))
    };
    app.harness.get_by(|node| is_tree(node)).focus();
    app.settle();
    for (key, chosen) in [(Key::R, None), (Key::ArrowDown, Some("D1=0")), (Key::ArrowRight, Some("D1=1"))] {
        press(&mut app, key);
        if let Some(chosen) = chosen {
            assert_eq!(app.json()["selection"]["name"], chosen);
        }
        assert!(app.harness.get_by(|node| is_tree(node)).is_focused(), "{key:?}");
    }
}

#[test]
fn running_stops_at_failures_only_and_then_at_the_end() {
    let mut app = lesson("");
    dispatch(&mut app, "search.breakpoints", &json!({ "failure": true }));
    let mut stops = 0;
    loop {
        press(&mut app, Key::CloseBracket);
        let event = app.json()["search"]["known"]["event"].as_str().expect("a name").to_owned();
        if event == "solution" {
            break;
        }
        assert!(
            matches!(event.as_str(), "inconsistent" | "unclosable" | "unresolvable" | "known"),
            "{event}"
        );
        stops += 1;
    }
    assert!(stops >= 2);
    press(&mut app, Key::OpenBracket);
    assert_ne!(app.json()["search"]["known"]["event"], "solution");
}

#[test]
fn playing_goes_on_by_itself_at_the_chosen_speed_and_stops_at_a_breakpoint() {
    let mut app = lesson("");
    dispatch(&mut app, "search.speed", &json!(600));
    dispatch(&mut app, "search.breakpoints", &json!({ "failure": true }));
    press(&mut app, Key::Space);
    for _ in 0..20 {
        app.settle();
    }
    let state = app.json();
    assert_eq!(state["search"]["isPlaying"], false);
    assert_eq!(state["search"]["known"]["event"], "inconsistent");
    press(&mut app, Key::Space);
    for _ in 0..40 {
        app.settle();
    }
    assert!(step(&app) > state["search"]["step"].as_u64().expect("a number"));
}

#[test]
fn a_failure_shows_its_negative_cycle_in_every_panel() {
    let mut app = lesson("");
    dispatch(&mut app, "search.breakpoints", &json!({ "failure": true }));
    dispatch(&mut app, "view.panel", &json!("distances"));
    dispatch(&mut app, "view.panel", &json!("search"));
    press(&mut app, Key::CloseBracket);
    let state = app.json();
    assert_eq!(state["search"]["known"]["event"], "inconsistent");
    assert!(state["search"]["known"]["cycle"].as_array().is_some_and(|cycle| cycle.len() >= 2));
    let is_graph = |label: &str| label.starts_with("Distance graph") && label.contains("negative cycle");
    app.harness.get_by(|node| node.label().is_some_and(|label| is_graph(&label)));
    let screen = Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1440.0, 900.0));
    let shown = app.texts(screen);
    let step = state["search"]["step"].as_u64().expect("a number");
    let says = |what: &str| shown.iter().any(|(text, _)| text.contains(what));
    assert!(says("✗ Negative cycle"), "the distances name it");
    assert!(says(&format!("Step {step} / ")), "the plan's panel says that it shows a step");
    // What is selected then is on the timeline, and what is not is not.
    let windows = state["search"]["known"]["windows"].as_object().expect("windows");
    assert!(windows.contains_key("Pass#1.start") && !windows.contains_key("Wait#1.start"));
    app.harness.get_by(|node| node.label().is_some_and(|label| label.starts_with("Pass#1:")));
    assert!(
        app.harness.query_by(|node| node.label().is_some_and(|label| label.starts_with("Wait#1:"))).is_none()
    );
}

#[test]
fn a_search_that_fails_can_be_stepped_through_as_well() {
    let mut app = lesson("");
    let source = "primitive Long()[30,40];\nprimitive Later()[25,50];\n\
                  scenario S[0,20] = { choose { Long(), Later() } }";
    app.harness.state_mut().run(Command::SetSource(source.to_owned()));
    app.settle();
    assert_eq!(app.json()["status"], "no-plan");
    press(&mut app, Key::End);
    assert!(step(&app) > 0);
    assert_eq!(app.json()["search"]["known"]["event"], "exhausted");
}

#[test]
fn both_searches_step_together_or_apart_and_tell_their_work() {
    let mut app = lesson("");
    dispatch(&mut app, "plan.compare", &json!(null));
    app.settle();
    let state = app.json();
    let compared = &state["search"]["compare"];
    let [chronological, directed] = [&compared["searches"][0], &compared["searches"][1]];
    assert_eq!(chronological["search"], "chronological");
    assert_eq!(directed["search"], "conflict-directed");
    // The lesson of this mission.
    assert!(chronological["backtracks"].as_u64() > directed["backtracks"].as_u64());
    assert!(chronological["propagations"].as_u64() > directed["propagations"].as_u64());
    press(&mut app, Key::Period);
    press(&mut app, Key::Period);
    let steps = |app: &App| {
        let compared = app.json()["search"]["compare"]["searches"].clone();
        [compared[0]["step"].as_u64(), compared[1]["step"].as_u64()]
    };
    assert_eq!(steps(&app), [Some(2), Some(2)]);
    // The shorter one waits at its end.
    press(&mut app, Key::End);
    assert_eq!(steps(&app), [chronological["steps"].as_u64(), directed["steps"].as_u64()]);
    dispatch(&mut app, "search.link", &json!(null));
    press(&mut app, Key::Home);
    let apart = steps(&app);
    assert_eq!(apart.iter().filter(|&&step| step == Some(1)).count(), 1);
    let side = app.json()["search"]["compare"]["side"].clone();
    dispatch(&mut app, "search.turn", &json!(null));
    assert_ne!(app.json()["search"]["compare"]["side"], side);
    dispatch(&mut app, "plan.compare", &json!(null));
    assert_eq!(app.json()["search"]["compare"], json!(null));
}

#[test]
fn two_searches_are_one_tree_with_the_share_of_each_and_apart_where_that_is_wanted() {
    let mut app = lesson("");
    dispatch(&mut app, "plan.compare", &json!(null));
    app.settle();
    let states = |app: &App, side: usize| {
        let searches = app.json()["search"]["compare"]["searches"].clone();
        searches[side]["states"].as_u64().expect("a number")
    };
    let shown = app.texts(Rect::EVERYTHING);
    let count = |words: &str| {
        let text = shown.iter().find_map(|(text, _)| text.strip_prefix(words));
        text.and_then(|count| count.parse::<u64>().ok()).unwrap_or_else(|| panic!("no {words} in {shown:?}"))
    };
    let both = count("both: ");
    assert_eq!(both + count("Chronological only: "), states(&app, 0));
    assert_eq!(both + count("Conflict-directed only: "), states(&app, 1));
    let trees = |app: &App| {
        let names = std::cell::RefCell::new(std::collections::BTreeSet::new());
        let found = app.harness.get_all_by(|node| {
            let label = node.label().filter(|label| label.contains("search tree of"));
            names.borrow_mut().extend(label.iter().map(ToString::to_string));
            label.is_some()
        });
        assert_eq!(found.count(), names.borrow().len());
        names.into_inner().into_iter().collect::<Vec<String>>()
    };
    assert_eq!(trees(&app).len(), 1);
    assert!(trees(&app)[0].starts_with("Both searches: search tree of"), "{:?}", trees(&app));
    for (index, (one, place)) in app.texts(tree(&app)).iter().enumerate() {
        for (other, at) in &app.texts(tree(&app))[index + 1..] {
            assert!(!place.intersects(*at), "{one} covers {other}");
        }
    }
    let columns = tree(&app).x_range();
    let menus = app.harness.query_all_by_role_and_label(egui::Role::Button, "Show");
    let menus = menus.filter(|menu| columns.contains(menu.rect().center().x));
    menus.min_by(|one, other| one.rect().top().total_cmp(&other.rect().top())).expect("a menu").click();
    app.settle();
    app.harness.get_by_label("Merge trees").click();
    app.settle();
    assert_eq!(trees(&app).len(), 2, "{:?}", trees(&app));
}

/// The texts on screen, as one.
fn said(app: &App) -> String {
    app.texts(Rect::EVERYTHING).into_iter().map(|(text, _)| text + "\n").collect()
}

#[test]
fn what_a_failure_teaches_is_told_in_its_step_and_listed() {
    let mut app = opened("lesson=learning&stop=3", [1280.0, 800.0]);
    let jump = app.json()["search"]["known"]["event"].clone();
    assert_eq!(jump, "backjump", "the stop shows where the search goes back to");
    assert!(said(&app).contains("Learned conflicts: 1"));
    press(&mut app, Key::Comma);
    assert!(said(&app).contains("Learned: never Tell(MODE=A)#1 in D1."));
    press(&mut app, Key::Comma);
    assert!(!said(&app).contains("Learned conflicts: 1"), "nothing has been learned yet");
}

#[test]
fn the_figures_of_a_search_and_the_list_of_what_it_learned_agree_at_each_step() {
    let mut app = lesson("");
    dispatch(&mut app, "plan.compare", &json!(null));
    let steps = app.json()["search"]["compare"]["searches"][1]["steps"].as_u64().expect("a number");
    if app.json()["search"]["compare"]["side"] == 0 {
        dispatch(&mut app, "search.turn", &json!(null));
    }
    let mut learned = 0;
    for step in (1..=steps).step_by(7).chain([steps]) {
        dispatch(&mut app, "search.goTo", &json!({ "step": step }));
        let told = said(&app);
        let figure = |name: &str| {
            let own = told.lines().filter_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
            // Those of the second search, which is turned to, come last.
            let mut numbers = own.filter_map(|own| own.split(' ').next()?.parse::<u64>().ok());
            numbers.next_back().unwrap_or_else(|| panic!("step {step}: no {name} in {told}"))
        };
        assert_eq!(figure("steps"), step);
        assert!(told.contains(&format!("{step} / {steps}")), "beside the tree: {told}");
        let listed = told.lines().find_map(|line| line.strip_prefix("Learned conflicts: "));
        assert_eq!(listed.map_or(0, |count| count.parse::<u64>().expect("a number")), figure("learned"));
        learned = figure("learned");
    }
    assert_eq!(learned, 1);
}

#[test]
fn labels_of_the_tree_never_overlap_at_any_size() {
    for size in [[1440.0, 900.0], [1024.0, 700.0], [800.0, 600.0]] {
        for mission in ["backjump", "threats", "causal-links", "enroute"] {
            let mut app = opened(&format!("mission={mission}&workspace=teach"), size);
            for zooms in 0..3 {
                let shown = app.texts(tree(&app));
                for (index, (one, place)) in shown.iter().enumerate() {
                    for (other, at) in &shown[index + 1..] {
                        assert!(!place.intersects(*at), "{mission} {size:?} {zooms}: {one} covers {other}");
                    }
                }
                dispatch(&mut app, "view.zoomIn", &json!(null));
            }
        }
    }
}

/// A mission on which the chronological search tries every combination of many choices.
fn many_choices(count: usize) -> String {
    let choices = "choose { Pass(), Wait() },\n".repeat(count);
    format!(
        "var MODE : {{A, B}};\nprimitive Pass()[1,1];\nprimitive Wait()[2,2];\n\
         scenario Lesson[0,100] = {{ choose {{ MODE=A [80,80], MODE=B [5,5] }}, {choices} MODE=B [80,80] }}"
    )
}

#[test]
fn a_search_of_a_hundred_thousand_steps_is_painted_with_bounded_work() {
    let mut app = lesson("");
    dispatch(&mut app, "plan.chronological", &json!(null));
    app.harness.state_mut().run(Command::SetSource(many_choices(12)));
    app.settle();
    let steps = app.json()["search"]["steps"].as_u64().expect("a number");
    assert!(steps > 100_000, "{steps}");
    for fraction in [0, 1, 7, 19] {
        dispatch(&mut app, "search.goTo", &json!(1 + steps * fraction / 20));
        let place = tree(&app);
        let shapes = app
            .harness
            .output()
            .shapes
            .iter()
            .filter(|shape| place.expand(2.0).contains_rect(shape.clip_rect))
            .count();
        assert!((2..20_000).contains(&shapes), "{shapes} shapes at {fraction}");
    }
    // The solution is found at the end, with all failures before it folded.
    press(&mut app, Key::End);
    assert_eq!(app.json()["search"]["known"]["event"], "solution");
    let folded = app.texts(tree(&app));
    assert!(folded.iter().any(|(text, _)| text.contains('+')), "counts of folded subtrees: {folded:?}");
}

#[test]
fn panels_take_the_keyboard_in_turn() {
    let mut app = lesson("");
    let panels = app.json()["panels"].as_array().expect("panels").clone();
    assert!(panels.len() >= 4, "{panels:?}");
    let mut seen = Vec::new();
    for _ in 0..panels.len() {
        press(&mut app, Key::F6);
        seen.push(app.json()["activePanel"].clone());
    }
    seen.sort_by_key(ToString::to_string);
    seen.dedup();
    assert_eq!(seen.len(), panels.len(), "{seen:?}");
    let before = app.json()["activePanel"].clone();
    press(&mut app, Key::F6);
    press_with(&mut app, Modifiers::SHIFT, Key::F6);
    assert_eq!(app.json()["activePanel"], before);
}

#[test]
fn what_is_selected_in_one_panel_is_selected_in_the_others() {
    let mut app = opened("mission=enroute&workspace=author", [1600.0, 5200.0]);
    let selected = |app: &App| app.json()["selection"]["name"].as_str().unwrap_or_default().to_owned();
    let is_selected = |app: &App, starts: &str| {
        let node = app.harness.get_by(|node| {
            node.role() == Role::Button
                && node
                    .label()
                    .is_some_and(|label| label.starts_with(starts) || label.contains(&format!(", {starts}")))
        });
        node.accesskit_node().aria_current() == Some(egui::accesskit::AriaCurrent::True)
    };
    // From the timeline.
    app.harness
        .get_by(|node| {
            node.role() == Role::Button
                && node.label().is_some_and(|it| it.starts_with("Group-Wait(TAI_HOLD1, TAI_HOLD2):"))
        })
        .click();
    app.settle();
    assert_eq!(selected(&app), "Group-Wait#1");
    assert!(is_selected(&app, "Group-Wait(TAI_HOLD1, TAI_HOLD2).start ["), "in the windows of the plan");
    // From the text.
    let source = app.harness.state().source();
    let at = source.rfind("Group-Transmit").expect("a call");
    dispatch(&mut app, "edit.select", &json!({ "start": at + 3 }));
    assert_eq!(selected(&app), "Group-Transmit#1");
    assert!(is_selected(&app, "Group-Transmit(MCC, ARRIVED_TAI):"), "on the timeline");
    assert!(!is_selected(&app, "Group-Wait(TAI_HOLD1, TAI_HOLD2):"));
    // From the plan.
    app.harness
        .get_by(|node| {
            node.role() == Role::Button
                && node.label().is_some_and(|it| it.starts_with("Group-Enroute#1.end ["))
        })
        .click();
    app.settle();
    assert_eq!(app.json()["selection"]["kind"], "node");
    assert!(is_selected(&app, "Group-Enroute#1:"), "on the timeline");
}

#[test]
fn a_problem_selects_what_it_is_about() {
    let mut app = support::start();
    app.settle();
    let source = "primitive Drive()[5,9];\nscenario S[0,3] = { Drive(), UNUSED=OK [1,1] }";
    app.harness.state_mut().run(Command::OpenSource { name: "test".into(), source: source.to_owned() });
    app.settle();
    let problems = app.json()["diagnostics"].as_array().expect("a list").len();
    assert!(problems > 0, "a mission without a plan has problems");
    app.harness.state_mut().run(Command::Window(WindowCommand::ShowPanel(PanelKind::Problems)));
    app.settle();
    app.harness
        .get_by(|node| {
            let is_warning = |label: String| label.starts_with("Line ") && !label.contains("E-NOPLAN");
            node.role() == Role::Button && node.label().is_some_and(is_warning)
        })
        .click();
    app.settle();
    assert_ne!(app.json()["selection"], json!(null));
}

#[test]
fn arrows_walk_the_network_the_timeline_and_the_windows() {
    let mut app = opened("mission=enroute&workspace=author", [1440.0, 900.0]);
    for panel in ["network", "timeline", "plan", "terrain"] {
        dispatch(&mut app, "go.select", &json!(""));
        for _ in 0..10 {
            if app.json()["activePanel"] == panel {
                break;
            }
            press(&mut app, Key::F6);
        }
        assert_eq!(app.json()["activePanel"], panel);
        let mut seen = Vec::new();
        for _ in 0..3 {
            let key = if panel == "network" { Key::ArrowRight } else { Key::ArrowDown };
            press(&mut app, key);
            seen.push(app.json()["selection"]["name"].clone());
        }
        seen.dedup();
        assert_eq!(seen.len(), 3, "{panel}: {seen:?}");
        assert!(seen.iter().all(serde_json::Value::is_string), "{panel}: {seen:?}");
    }
}

#[test]
fn small_windows_show_fewer_panels_and_large_ones_more() {
    for workspace in ["author", "teach", "review"] {
        let shown = |size| {
            let app = opened(&format!("mission=enroute&workspace={workspace}"), size);
            app.json()["panels"].as_array().map_or(0, Vec::len)
        };
        let (wide, narrow) = (shown([1440.0, 900.0]), shown([800.0, 600.0]));
        assert!((2..=3).contains(&narrow) && wide > narrow, "{workspace}: {wide} and {narrow}");
    }
}

#[test]
fn a_closed_panel_stays_closed_in_the_next_run_until_it_is_brought_back() {
    let world = std::rc::Rc::<support::World>::default();
    let has = |app: &App, panel: &str| {
        app.json()["panels"].as_array().is_some_and(|panels| panels.iter().any(|it| it == panel))
    };
    let mut app = support::start_in(std::rc::Rc::clone(&world), |builder| builder);
    app.settle();
    dispatch(&mut app, "view.closePanel", &json!("terrain"));
    assert!(!has(&app, "terrain"));
    let mut again = support::start_in(world, |builder| builder);
    again.settle();
    assert!(!has(&again, "terrain"));
    dispatch(&mut again, "view.panel", &json!("terrain"));
    assert!(has(&again, "terrain"));
}

/// The items of the search tree as assistive technology meets them: name, level, whether each is the state of the step, and
/// its place among those beside it.
fn items(app: &App) -> Vec<(String, usize, bool, [usize; 2])> {
    let nodes = app.harness.query_all_by_role(egui::Role::TreeItem);
    let item = |node: egui_kittest::Node<'_>| {
        let node = node.accesskit_node();
        let place = [node.position_in_set().expect("a place"), node.size_of_set().expect("a size")];
        (
            node.label().unwrap_or_default(),
            node.level().expect("a level"),
            node.is_selected() == Some(true),
            place,
        )
    };
    nodes.map(item).collect()
}

#[test]
fn the_search_is_a_tree_for_who_does_not_see_it() {
    let mut app = opened("lesson=choices&stop=2", [1440.0, 900.0]);
    // Only what the search has reached by the first failure is there.
    let known = items(&app);
    let names: Vec<&str> = known.iter().map(|(name, ..)| name.as_str()).collect();
    assert_eq!(known[0].0, "Initial state, explored");
    assert_eq!((known[0].1, known[0].3), (1, [0, 1]));
    assert!(names.iter().any(|it| it.starts_with("D1: Long-Way#1, explored")), "{names:?}");
    let failed = known.iter().find(|(name, ..)| name.starts_with("D2: Core#1, failed: ")).expect("it failed");
    assert_eq!((failed.1, failed.2, failed.3), (3, true, [0, 3]));
    assert!(names.contains(&"D2: Scoop#1, not explored"), "{names:?}");
    // The whole search, with its plan; a click goes to the state.
    dispatch(&mut app, "search.close", &json!({}));
    let plan = items(&app).into_iter().find(|(name, ..)| name.ends_with(", plan")).expect("a plan").0;
    let node = app.harness.get_by_role_and_label(egui::Role::TreeItem, &plan);
    assert!(node.accesskit_node().data().is_expanded().is_none(), "nothing is below a plan");
    node.click_accesskit();
    app.settle();
    let chosen = plan.strip_suffix(", plan").expect("it ends so");
    let selected = items(&app).into_iter().find(|&(_, _, is_selected, _)| is_selected).expect("a state");
    assert!(selected.0.starts_with(chosen), "{selected:?}, not {plan}");
    assert!(step(&app) > 0);
}
