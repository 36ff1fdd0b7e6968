//! Lessons as a student meets them, and the manual: by roles and names, without a graphics adapter.

use crate::support;
use egui::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::{Value, json};
use workbench::command::Command;
use workbench::host::FileKind;
use workbench::host_io::Remote as _;
use workbench::lesson::COURSE;
use workbench::state::lesson::LessonCommand;

use crate::support::App;

fn opened(fragment: &str, size: [f32; 2]) -> App {
    let world = std::rc::Rc::<support::World>::default();
    fragment.clone_into(&mut world.fragment.borrow_mut());
    let mut app = support::start_in(world, |builder| builder.with_size(size));
    app.settle();
    app
}

fn click(app: &mut App, role: Role, name: &str) {
    app.harness.get_by_role_and_label(role, name).click();
    app.settle();
}

fn lesson(app: &App) -> Value {
    app.json()["lesson"]["open"].clone()
}

#[test]
fn next_and_previous_bring_step_and_selection_along_and_answers_are_judged() {
    let mut app = opened("lesson=negative-cycle&stop=2", [1280.0, 800.0]);
    assert_eq!(lesson(&app)["stopTitle"], "A choice is made");
    assert_eq!(app.json()["selection"]["name"], "D1");
    let decided = app.json()["search"]["step"].clone();
    click(&mut app, Role::Button, "Next");
    assert_eq!(lesson(&app)["stop"], 3);
    assert_eq!(app.json()["search"]["known"]["event"], "inconsistent");
    assert_eq!(app.json()["selection"], Value::Null, "nothing is left of the stop before");
    assert_eq!(*app.world.fragment.borrow(), "lesson=negative-cycle&stop=3", "a link leads to the stop");
    // The answer is what the planner computes: 15, and not 30.
    for (typed, is_right) in [("30", false), ("15", true)] {
        app.harness.state_mut().dispatch("learn.answer", &json!({ "answer": typed })).expect("a question");
        app.settle();
        assert_eq!(lesson(&app)["question"]["isRight"], is_right, "{typed}");
    }
    app.harness.get_by_label("Correct.");
    assert_eq!(app.json()["lesson"]["learned"], json!(["negative-cycle/3"]));
    click(&mut app, Role::Button, "Previous");
    assert_eq!(app.json()["search"]["step"], decided);
    assert_eq!(app.json()["selection"]["name"], "D1");
}

#[test]
fn an_answer_is_typed_and_a_choice_is_clicked() {
    let mut app = opened("lesson=first-line&stop=1", [1280.0, 800.0]);
    click(&mut app, Role::Button, "One");
    app.harness.get_by_label("Incorrect. Try again.");
    click(&mut app, Role::Button, "Two: its start and its end");
    app.harness.get_by_label("Correct.");
    click(&mut app, Role::Button, "Next");
    app.harness.get_by_role_and_label(Role::TextInput, "Number").focus();
    app.harness.step();
    app.harness.get_by_role_and_label(Role::TextInput, "Number").type_text("20");
    app.settle();
    click(&mut app, Role::Button, "Check");
    assert_eq!(lesson(&app)["question"]["isRight"], true);
}

#[test]
fn a_task_is_seen_to_be_done_and_the_text_can_be_taken_back() {
    let mut app = opened("lesson=bounds&stop=4", [1280.0, 800.0]);
    assert_eq!(lesson(&app)["question"]["isRight"], Value::Null);
    let before = app.harness.state().source();
    app.harness.state_mut().set_source(&before.replace("[0,70]", "[0,40]"));
    app.settle();
    assert_eq!(app.json()["status"], "no-plan");
    assert_eq!(lesson(&app)["question"]["isRight"], true);
    click(&mut app, Role::Button, "Reset text");
    assert_eq!((app.harness.state().source(), app.json()["status"].clone()), (before, json!("plan")));
}

#[test]
fn a_lesson_sets_planning_for_itself_and_leaves_it_as_it_was() {
    let mut app = opened("", [1280.0, 800.0]);
    let search = |app: &App| app.harness.state().app_state().settings.plan.search;
    let before = search(&app);
    app.harness.state_mut().run(Command::Lesson(LessonCommand::Open("threats".into(), 0)));
    app.settle();
    assert_ne!(search(&app), before);
    let kept = app.world.storage.borrow().get("enroute/settings-1").cloned().unwrap_or_default();
    assert!(!kept.contains("\"chronological\""), "what is remembered is the user's: {kept}");
    click(&mut app, Role::Button, "Contents");
    assert_eq!((search(&app), lesson(&app)), (before, Value::Null));
    click(&mut app, Role::Button, "Author");
    assert!(!app.json()["panels"].as_array().expect("panels").contains(&json!("lesson")));
}

#[test]
fn the_view_of_a_lesson_does_not_leak_into_the_next_one() {
    let mut fresh = opened("lesson=causal-links&stop=1", [1280.0, 800.0]);
    let mut used = opened("lesson=negative-cycle&stop=1", [1280.0, 800.0]);
    for command in ["view.zoomIn", "view.zoomIn", "search.run"] {
        used.harness.state_mut().dispatch("view.panel", &json!("network")).expect("a panel");
        used.harness.state_mut().dispatch(command, &json!({})).expect("a command");
        used.settle();
    }
    used.harness.state_mut().dispatch("learn.open", &json!("causal-links")).expect("a lesson");
    used.settle();
    fresh.settle();
    // Every landmark of the drawing is where it is without what was done before.
    let landmarks = |app: &App| -> Vec<String> {
        let nodes = app.harness.root().children_recursive();
        let named = nodes.into_iter().filter_map(|node| {
            let node = node.accesskit_node();
            let area = node.bounding_box()?;
            Some(format!("{:?} {:?} {:.0} {:.0}", node.role(), node.label()?, area.x0, area.y0))
        });
        named.filter(|line| !line.contains("revision") && !line.contains(" ms")).collect()
    };
    assert_eq!(landmarks(&used), landmarks(&fresh));
}

#[test]
fn a_file_becomes_the_lesson_and_its_mistakes_are_told_by_line() {
    let mut app = opened("", [1280.0, 800.0]);
    let text = "# Mine\n\n```rmpl\nprimitive A()[1,2];\nscenario S[0,9] = { A() }\n```\n\nIt ends at {{end}}, and {{ends}}.\n";
    app.world.open_file(FileKind::of_name("mine.md"), "mine.md", text.as_bytes());
    app.settle();
    assert_eq!(lesson(&app)["title"], "Mine");
    assert_eq!(app.json()["status"], "plan");
    assert!(
        lesson(&app)["prose"].as_str().is_some_and(|prose| prose.contains("It ends at 1,")),
        "{}",
        lesson(&app)
    );
    assert_eq!(lesson(&app)["errors"][0]["line"], 8);
    app.harness.get_by_label_contains("Line 8: in `{{ends}}`");
}

#[test]
fn the_manual_is_searched_and_a_panel_leads_to_its_page() {
    let mut app = opened("mission=enroute&workspace=author", [1280.0, 800.0]);
    click(&mut app, Role::Button, "Help: Timeline");
    assert_eq!(app.json()["manual"]["page"], "timeline-panel");
    app.harness.get_by_role_and_label(Role::Heading, "Timeline panel");
    app.harness.state_mut().dispatch("help.search", &json!({ "words": "negative cycle" })).expect("a search");
    app.settle();
    let found = app.json()["manual"]["found"][0].as_str().unwrap_or_default().to_owned();
    assert!(found.starts_with("glossary#negative-cycle"), "{}", app.json()["manual"]["found"]);
    app.harness.state_mut().dispatch("help.page", &json!({ "page": "diagnostics" })).expect("a page");
    app.settle();
    app.harness.get_by_role_and_label(Role::Heading, "Diagnostics");
    click(&mut app, Role::Button, "Back");
    assert_eq!(app.json()["manual"]["page"], "timeline-panel");
    // The harness panics over a sign that the fonts lack.
    for page in workbench::manual::pages() {
        app.harness.state_mut().dispatch("help.page", &json!({ "page": page.name })).expect("a page");
        app.settle();
        app.harness.get_by_role_and_label(Role::Heading, &page.title);
    }
}

#[test]
fn the_hover_of_a_term_has_a_link_that_leads_into_the_manual() {
    let mut app = opened("lesson=first-line&stop=1", [1280.0, 800.0]);
    let hover = |app: &mut App, link: &str| {
        let place = app.harness.get_by_role_and_label(Role::Link, link).rect().center();
        app.harness.hover_at(place);
        // A hover shows once the pointer has rested a while.
        (0..8).for_each(|_| app.settle());
        place
    };
    hover(&mut app, "mission");
    let place = hover(&mut app, "The language");
    for pressed in [true, false] {
        let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
        app.harness.event(egui::Event::PointerButton { pos: place, button, pressed, modifiers });
        app.settle();
    }
    assert_eq!(app.json()["manual"]["page"], "language");
    app.harness.get_by_role_and_label(Role::Heading, "A first mission");
}

#[test]
fn nothing_of_a_lesson_is_wider_than_its_panel() {
    for size in [[1280.0, 800.0], [1024.0, 700.0]] {
        let mut app = opened("lesson=first-line&stop=1", size);
        for lesson in COURSE.iter().flat_map(|chapter| chapter.lessons) {
            app.harness.state_mut().dispatch("learn.open", &json!(lesson.name)).expect("a lesson");
            app.settle();
            let right = panel_right(&app);
            for node in app.harness.root().children_recursive() {
                let node = node.accesskit_node();
                let Some(area) = node.bounding_box() else { continue };
                let is_prose = matches!(node.role(), Role::Label | Role::Heading | Role::Link);
                let is_in_panel = area.x0 < right - 20.0 && area.y0 > 110.0;
                let is_clipped = is_prose && is_in_panel && area.x1 > right + 1.0;
                assert!(!is_clipped, "{} at {size:?}: {:?} {area:?}, {right}", lesson.name, node.label());
            }
        }
    }
}

/// Returns where the lesson's panel ends: the button at its right edge is there at every stop.
fn panel_right(app: &App) -> f64 {
    let button = app.harness.get_by_role_and_label(Role::Button, "Reset text");
    f64::from(button.rect().right()) + 14.0
}

/// The sizes of the letters of a text on screen.
fn sizes(galley: &egui::Galley) -> impl Iterator<Item = f32> {
    galley.job.sections.iter().map(|section| section.format.font_id.size)
}

/// Texts on screen with letters that are smaller than `least` points.
fn smaller(app: &App, least: f32) -> Vec<(f32, String)> {
    let mut found = Vec::new();
    app.each_text(&mut |text, clip| {
        let smallest = sizes(&text.galley).fold(f32::INFINITY, f32::min);
        if smallest < least && clip.intersects(text.visual_bounding_rect()) {
            found.push((smallest, text.galley.text().to_owned()));
        }
    });
    found
}

#[test]
fn no_stop_of_any_lesson_shows_letters_below_11_points() {
    let mut app = opened("", [1280.0, 800.0]);
    let mut small = Vec::new();
    for lesson in COURSE.iter().flat_map(|chapter| chapter.lessons) {
        let (read, _) = workbench::lesson::Lesson::read(lesson.name, lesson.text);
        for stop in 0..read.stops.len() {
            app.harness.state_mut().run(Command::Lesson(LessonCommand::Open(lesson.name.into(), stop)));
            app.settle();
            let place = format!("{}, stop {}", lesson.name, stop + 1);
            small.extend(smaller(&app, 10.99).into_iter().map(|it| format!("{place}: {it:?}")));
        }
    }
    assert!(small.is_empty(), "{}", small.join("\n"));
}

#[test]
fn a_best_first_search_shows_what_each_state_may_lead_to() {
    let shown = |stop: u32, words: &str| {
        let app = opened(&format!("lesson=objectives&stop={stop}"), [1280.0, 800.0]);
        app.texts(egui::Rect::EVERYTHING).iter().any(|(text, _)| text.contains(words))
    };
    assert!(shown(2, "start · 4") && !shown(2, "Crater_fast#1 · 9"), "nothing is opened below the start");
    assert!(shown(3, "Crater_slowly#1 · 10") && !shown(3, "Ridge_fast#1 · 12"));
    assert!(
        shown(5, "Crater_fast#1 · 9") && shown(5, "Ridge_fast#1 · 12") && shown(5, "2 other states are open")
    );
    // A step of the search is not worth anything yet.
    assert!(shown(6, "3 of 3 decisions made") && !shown(6, "cost 10"));
    assert!(shown(7, "cost 10"));
}

/// Texts on screen that are smaller than 11 points, or end before their end.
fn illegible(app: &App) -> Vec<String> {
    let mut found = Vec::new();
    app.each_text(&mut |text, clip| {
        let is_small = text.galley.job.sections.iter().any(|section| section.format.font_id.size < 11.0);
        if (is_small || text.galley.elided) && clip.intersects(text.visual_bounding_rect()) {
            found.push(text.galley.text().to_owned());
        }
    });
    found
}

/// Texts on screen that are cut off at the left or at the right, where nothing scrolls; rows of lists come and go at the
/// top and at the bottom. Each with the part of the screen that cuts it.
fn cut_off(app: &App) -> Vec<(String, egui::Rect)> {
    let screen = app.harness.ctx.content_rect();
    let mut found = Vec::new();
    app.each_text(&mut |text, clip| {
        let (area, clip) = (text.visual_bounding_rect(), clip.intersect(screen));
        // A point more or less of what is around letters is not lost.
        let is_complete = clip.x_range().expand(1.5).contains(area.left())
            && clip.x_range().expand(1.5).contains(area.right());
        if clip.shrink(1.0).intersects(area) && !is_complete {
            found.push((text.galley.text().to_owned(), clip));
        }
    });
    found
}

/// The names of the bars of the timeline, by what it says of each: `Drive(RIDGE), Drive1#2: starts …`.
fn bar_names(labels: &[(String, egui::Rect)]) -> Vec<String> {
    let whole = labels.iter().filter_map(|(label, _)| Some(label.split_once(": starts")?.0));
    let name = |whole: &str| whole.rsplit_once(", ").map_or(whole, |(name, _)| name).to_owned();
    whole.flat_map(|whole| [name(whole), whole.split('#').next().unwrap_or(whole).to_owned()]).collect()
}

/// Nouns that the panels count, in the plural.
const COUNTED: [&str; 18] = [
    "alternatives",
    "choices",
    "components",
    "decisions",
    "diagnoses",
    "entries",
    "errors",
    "events",
    "failures",
    "items",
    "lines",
    "orderings",
    "places",
    "samples",
    "states",
    "steps",
    "vertices",
    "warnings",
];

/// Returns whether a text says “1 decisions”, or has code in raw backticks.
fn is_badly_put(text: &str) -> bool {
    let words: Vec<&str> = text.split_whitespace().collect();
    let is_wrong =
        |pair: &[&str]| pair[0] == "1" && COUNTED.contains(&pair[1].trim_end_matches([',', '.', ':']));
    text.contains('`') || words.windows(2).any(is_wrong)
}

#[test]
fn numbers_agree_with_nouns_and_code_is_rendered() {
    assert!(is_badly_put("D1 has 1 alternatives.") && is_badly_put("the delay `delay`"));
    assert!(!is_badly_put("1 alternative, 21 alternatives, step 1"));
}

#[test]
fn no_stop_of_any_lesson_cuts_off_what_is_to_be_read_or_makes_it_small() {
    let mut app = opened("", [1280.0, 800.0]);
    let mut cut = Vec::new();
    for lesson in COURSE.iter().flat_map(|chapter| chapter.lessons) {
        let (read, _) = workbench::lesson::Lesson::read(lesson.name, lesson.text);
        for stop in 0..read.stops.len() {
            app.harness.state_mut().run(Command::Lesson(LessonCommand::Open(lesson.name.into(), stop)));
            app.settle();
            let place = format!("{}, stop {}", lesson.name, stop + 1);
            let nodes = app.harness.root().children_recursive();
            let labels: Vec<(String, egui::Rect)> =
                nodes.filter_map(|node| Some((node.accesskit_node().label()?, node.rect()))).collect();
            let with = |is_such: fn(&str) -> bool| {
                labels.iter().filter(move |(label, _)| is_such(label)).map(|&(_, rect)| rect).collect()
            };
            let badly_put = labels.iter().filter(|(label, _)| is_badly_put(label));
            cut.extend(badly_put.map(|(label, _)| format!("{place}: {label}")));
            let drawn: Vec<egui::Rect> = with(|label| label.ends_with(" in the network"));
            // Of a network that is larger than its panel, what the stop is about has to be there.
            let json = app.json();
            let selected = json["selection"]["name"].as_str().unwrap_or("nothing");
            // A bar of the timeline may be too short for its name, which is beside its times when one points at it.
            let bars: Vec<String> = bar_names(&labels);
            let small = illegible(&app).into_iter().filter(|text| !bars.contains(text));
            cut.extend(small.map(|text| format!("{place}: {text}")));
            let selected = selected.split('#').next().unwrap_or(selected);
            let bar_bottom =
                app.harness.get_by_role_and_label(Role::TextInput, "Mission name").rect().bottom();
            for (text, clip) in cut_off(&app).into_iter().filter(|(_, clip)| clip.bottom() > bar_bottom) {
                let is_of_network = drawn.iter().any(|node| clip.contains(node.center()));
                if !is_of_network || text.contains(selected) {
                    cut.push(format!("{place}: {text}"));
                }
            }
        }
    }
    assert!(cut.is_empty(), "{}", cut.join("\n"));
}

#[test]
fn the_conflicts_of_estimation_are_in_view() {
    let is_in_view = |app: &App| {
        let found = app.texts(egui::Rect::EVERYTHING);
        ["Conflicts", "Build hitting-set tree"]
            .iter()
            .all(|words| found.iter().any(|(text, _)| text == words))
    };
    for stop in [6, 7] {
        let app = opened(&format!("lesson=estimation&stop={stop}"), [1280.0, 800.0]);
        assert!(is_in_view(&app), "step {stop}");
    }
    // On the way there, the panel was scrolled elsewhere.
    let mut app = opened("lesson=estimation&stop=5", [1280.0, 800.0]);
    for stop in [6, 7, 6] {
        let button = if stop == 6 && lesson(&app)["stop"] == 7 { "Previous" } else { "Next" };
        click(&mut app, Role::Button, button);
        assert_eq!(lesson(&app)["stop"], stop);
        assert!(is_in_view(&app), "step {stop}");
    }
}
