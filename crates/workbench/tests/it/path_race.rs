//! Searches for a path that are looked at sample by sample: told in words, side by side, and past walls that are drawn.

use nalgebra::Point2;
use serde_json::{Value, json};
use test_support::{App, start};
use workbench::command::Command;
use workbench::lesson::{Lesson, course_lesson};
use workbench::state::growth::{GrowthCommand, Planners, Shown};
use workbench::state::placing::NewThing;
use workbench::state::terrain::TerrainCommand;

/// A gap between two obstacles, and room around them.
const MISSION: &str = r#"terrain "flat" cell 1 origin (0, 0);
location CAMP (30, 50);
location CRATER (90, 50);
obstacle South polygon (58, 10, 62, 10, 62, 40, 58, 40);
obstacle North polygon (58, 60, 62, 60, 62, 90, 58, 90);
vehicle Rover : ATRV at CAMP;
primitive Drive(to)[5,500] moves Rover speed (0.02, 0.2);
scenario Sol[0,500] = { Drive(CRATER) }
"#;

fn grow(app: &mut App, command: GrowthCommand) {
    app.run(Command::Terrain(TerrainCommand::Growth(command)));
    app.settle();
}

fn growing(planners: Planners) -> App {
    growing_on(MISSION, planners)
}

fn growing_on(mission: &str, planners: Planners) -> App {
    let mut app = start();
    app.run(Command::OpenSource { name: "gap".into(), source: mission.to_owned() });
    app.settle();
    grow(&mut app, GrowthCommand::Toggle);
    grow(&mut app, GrowthCommand::Choose(planners));
    grow(&mut app, GrowthCommand::GoTo(u32::MAX));
    app
}

fn shown(app: &App) -> &Shown {
    app.session.state().terrain.growth.shown().expect("a growth is shown")
}

fn searches(app: &App) -> Vec<Value> {
    app.json()["terrain"]["growth"]["searches"].as_array().cloned().unwrap_or_default()
}

fn wall(app: &mut App, ends_m: [[f64; 2]; 2]) {
    let thing = NewThing::Wall { ends_m: ends_m.map(Point2::from), thickness_m: 3.0 };
    app.run(Command::Terrain(TerrainCommand::Place { thing, again: false }));
    app.settle();
}

#[test]
fn all_planners_race_and_each_is_counted() {
    let mut app = growing(Planners::Race);
    let whole = searches(&app);
    let names: Vec<_> = whole.iter().map(|search| search["planner"].as_str().unwrap_or_default()).collect();
    assert_eq!(names, ["RRT", "RRT-Connect", "RRT*", "Kinodynamic RRT"]);
    for search in &whole {
        assert_eq!(search["complete"], true, "{search}");
        assert!(search["length"].as_f64().is_some_and(|length| (60.0..300.0).contains(&length)), "{search}");
        assert!(search["checks"].as_u64() >= search["vertices"].as_u64().map(|it| it - 2), "{search}");
    }
    let length = |at: usize| whole[at]["length"].as_f64().unwrap_or(f64::INFINITY);
    assert!(length(2) <= length(0), "RRT* shortens its path: {whole:?}");
    // Side by side: at a sample each has drawn as many, or is done.
    let few = whole.iter().filter_map(|it| it["samples"].as_u64()).min().expect("four") - 1;
    app.dispatch("terrain.growTo", &json!({ "samples": few }));
    app.settle();
    for search in searches(&app) {
        assert_eq!(search["samples"], few, "{search}");
        assert_eq!(search["length"], Value::Null, "nobody has a path before the first one is done");
    }
    // What one did alone is what it did in the race.
    grow(&mut app, GrowthCommand::Choose(Planners::One(motion::PlannerKind::Rrt)));
    grow(&mut app, GrowthCommand::GoTo(u32::MAX));
    assert_eq!(searches(&app), whole[..1]);
}

#[test]
fn on_the_map_of_the_lesson_the_path_of_rrt_star_is_the_shortest_and_near_the_planned_one() {
    let course = course_lesson("rrt").expect("a lesson");
    let (lesson, _) = Lesson::read(course.name, course.text);
    let app = growing_on(lesson.mission.source(), Planners::Race);
    let found = searches(&app);
    let length = |at: usize| found[at]["length"].as_f64().expect("it found a path");
    for other in [0, 1, 3] {
        assert!(length(2) < length(other), "RRT* shortens its path: {found:?}");
    }
    let planned = app.session.state().shown().expect("a plan").traverses[0].length_m;
    assert!((0.99..1.05).contains(&(length(2) / planned)), "{} m, planned {planned} m", length(2));
}

#[test]
fn a_wall_becomes_text_and_the_trees_go_around_it_until_it_is_taken_back() {
    let mut app = growing(Planners::Race);
    let before = searches(&app);
    grow(&mut app, GrowthCommand::GoTo(5));
    wall(&mut app, [[60.0, 36.0], [60.0, 64.0]]);
    let text = app.session.state().document.text().to_owned();
    assert!(text.contains("obstacle Wall1 polygon (61.5, 36, 61.5, 64, 58.5, 64, 58.5, 36);"), "{text}");
    assert_eq!(shown(&app).samples(), 5, "the trees are looked at where they were");
    grow(&mut app, GrowthCommand::GoTo(u32::MAX));
    for standing in shown(&app).standings() {
        let path = standing.path_m.expect("there is a way around");
        let crosses = |pair: &[Point2<f64>]| {
            let [a, b] = [pair[0], pair[1]];
            let share = (60.0 - a.x) / (b.x - a.x);
            (0.0..=1.0).contains(&share) && (10.0..=90.0).contains(&(a.y + share * (b.y - a.y)))
        };
        assert!(!path.windows(2).any(crosses), "a path goes through the wall: {path:?}");
    }
    app.dispatch("edit.undo", &json!(null));
    app.settle();
    grow(&mut app, GrowthCommand::GoTo(u32::MAX));
    assert_eq!(app.session.state().document.text(), MISSION);
    assert_eq!(searches(&app), before, "without the wall everything is as it was");
}

#[test]
fn walls_that_close_every_way_are_said_to_and_the_tree_is_back_without_them() {
    let mut app = growing(Planners::One(motion::PlannerKind::Rrt));
    let before = searches(&app);
    grow(&mut app, GrowthCommand::GoTo(7));
    for ends in [[[20.0, 40.0], [40.0, 40.0]], [[40.0, 40.0], [40.0, 60.0]], [[40.0, 60.0], [20.0, 60.0]]] {
        wall(&mut app, ends);
        assert_eq!(app.json()["status"], "plan");
    }
    wall(&mut app, [[20.0, 60.0], [20.0, 40.0]]);
    assert_eq!(app.json()["status"], "no-plan");
    assert_eq!(shown(&app).words(), "Drive#1 has no planned path. The Plan panel explains why.");
    app.dispatch("edit.undo", &json!(null));
    app.settle();
    assert_eq!(shown(&app).samples(), 7);
    for _ in 0..3 {
        app.dispatch("edit.undo", &json!(null));
        app.settle();
    }
    grow(&mut app, GrowthCommand::GoTo(u32::MAX));
    assert_eq!(searches(&app), before);
}

#[test]
fn every_sample_is_told_by_what_it_did() {
    let mut app = growing(Planners::One(motion::PlannerKind::Rrt));
    wall(&mut app, [[60.0, 36.0], [60.0, 64.0]]);
    let place = |point: Point2<f64>| format!("({:.1}, {:.1})", point.x, point.y);
    let (mut grown, mut blocked) = (0, 0);
    for sample in 1..=shown(&app).total() {
        grow(&mut app, GrowthCommand::GoTo(sample));
        let shown = shown(&app);
        let (sentence, step) = (shown.sentence().expect("a sentence"), shown.last().expect("a step"));
        let begin = format!(
            "Sample {sample} is {}. Nearest vertex: {}.",
            place(step.sample_m),
            place(step.nearest_m)
        );
        assert!(sentence.starts_with(&begin), "{sentence}");
        if let Some(added) = step.added.first() {
            grown += 1;
            let stride = (added.point_m - step.nearest_m).norm();
            let end = format!(" Steered {stride:.1} m toward the sample, to {}.", place(added.point_m));
            assert!(sentence[begin.len()..].starts_with(&end), "{sentence}");
        } else {
            blocked += 1;
            assert!(sentence.ends_with("Blocked by an obstacle; nothing added."), "{sentence}");
        }
        assert_eq!(sentence.contains("Path found:"), step.path_m.is_some(), "{sentence}");
    }
    assert!(grown > 5 && blocked > 0, "{grown} grown, {blocked} blocked");
}
