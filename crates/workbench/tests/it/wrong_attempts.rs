//! Tasks of lessons tried wrongly: each has an attempt that a student may make and that does not do it.

use serde_json::Value;
use test_support::{App, start};
use workbench::command::Command;
use workbench::host_io::Remote as _;
use workbench::lesson::{Action, Answer, COURSE, TOUR};
use workbench::registry::read_lesson;
use workbench::state::lesson::LessonCommand;

/// What someone does that does not do the task.
enum Wrong {
    /// In the text, these words become those.
    Edit(&'static str, &'static str),
    /// A command with its arguments, in JSON.
    Do(&'static str, &'static str),
}

use Wrong::{Do, Edit};

/// By lesson and step; several steps one after the other make one attempt.
const ATTEMPTS: &[(&str, &str, &[Wrong])] = &[
    ("tour", "A tour of Enroute", &[Do("play.seek", r#"{"time": 4}"#)]),
    ("tour", "One selection in all panels", &[Do("go.select", r#"{"name": "D1"}"#)]),
    ("tour", "The ground changes", &[Edit("circle (166, 86, 4)", "circle (120, 120, 4)")]),
    ("tour", "A mission without a plan", &[Edit("[0,22]", "[0,21]")]),
    ("tour", "Draw an activity", &[Do("draw.paste", r#"{"text": "delay"}"#)]),
    ("tour", "What can go wrong", &[Do("play.seek", r#"{"time": 6}"#)]),
    ("first-line", "Your first change", &[Edit("[20,30]", "[25,30]")]),
    ("first-line", "Errors in the text", &[Edit("Drive()\n", "Drive(\n")]),
    ("sequence-and-parallel", "Waiting with delay", &[Edit("delay;", "delay[19,inf];")]),
    ("bounds", "One more bound", &[Edit("[18,25]", "[80,90]")]),
    ("negative-cycle", "Room for drilling", &[Edit("[10,20]", "[10,25]")]),
    ("choices", "First plan found, not best plan", &[Edit("[0,22]", "[0,19]")]),
    ("causal-links", "How the link narrows the window", &[Edit("LIGHT [10,10]", "LIGHT [15,15]")]),
    ("threats", "All threats resolved", &[Edit("[0,20]", "[0,19]")]),
    ("learning", "One more decision", &[Edit("  MODE=B [80,80],", "  MODE=B [80,80],\n  Pass(),")]),
    ("dispatching", "Pin an event to a time", &[Do("plan.pin", r#"{"event": "Drive#1.end", "time": 29}"#)]),
    ("states", "Where a vehicle is", &[Edit("delay; Dig(); delay; Stow()", "delay; Stow()")]),
    ("resources", "More in the battery", &[Edit("10..100 = 70", "10..100 = 80")]),
    ("order", "Another start, another order", &[Edit("0..10 = 0", "0..10 = 5")]),
    ("order", "A sequence within an instant", &[Edit("Look(); Open-Lid()", "Look(); delay; Open-Lid()")]),
    ("objectives", "More time", &[Edit("Round[0,45]", "Round[0,50]")]),
    ("controllability", "If the planner could choose", &[Edit("contingent [20,40]", "contingent [20,25]")]),
    ("controllability", "Fix it", &[Edit("contingent [20,40]", "[20,40]")]),
    ("rrt", "Sample, nearest, steer", &[Do("terrain.growTo", r#"{"samples": 3}"#)]),
    ("rrt", "Rapid exploration", &[Do("terrain.growTo", r#"{"samples": 61}"#)]),
    (
        "rrt",
        "Walls",
        &[Edit("obstacle Scarp", "obstacle Wall1 polygon (10, 10, 14, 10, 14, 45, 10, 45); obstacle Scarp")],
    ),
    ("rrt", "A blocked path", &[Edit("circle (166, 86, 4)", "circle (120, 120, 4)")]),
    ("automata", "Parallel branches", &[Do("program.goTo", r#"{"moment": 4}"#)]),
    ("esterel-pause", "Esterel: waiting", &[Do("program.know", r#"{"variable": "x", "value": "a"}"#)]),
    ("esterel-pause", "await S", &[Do("program.goTo", r#"{"moment": 9}"#)]),
    ("esterel-preempt", "Esterel: preemption", &[Do("program.goTo", r#"{"moment": 2}"#)]),
    ("esterel-preempt", "weak abort", &[Do("program.goTo", r#"{"moment": 0}"#)]),
    ("esterel-preempt", "abort, with a handler", &[Do("program.goTo", r#"{"moment": 2}"#)]),
    ("esterel-preempt", "do … maintaining", &[Do("program.goTo", r#"{"moment": 3}"#)]),
    ("estimation", "Switching to the other engine", &[Do("program.goTo", r#"{"moment": 5}"#)]),
    ("estimation", "Build the hitting-set tree", &[Do("program.diagnose", "{}")]),
    (
        "review",
        "Change the cause",
        &[Edit("{ Brush(), Image() }", "{ Image(), Brush() }"), Do("review.run", "{}")],
    ),
    ("verified", "Say what you mean", &[Edit("Image()[2,3]", "Image()[2,3] requires Rover.at=CAMP")]),
    (
        "verified",
        "The bounds are assumptions",
        &[Do("execute.disturb", r#"{"kind": "duration", "activity": "Image#1", "duration": "4"}"#)],
    ),
    ("verified", "External events", &[Edit("delay[5,20]", "delay[5,5]")]),
    ("proof", "A program that ends in every run", &[Do("program.prove", "{}")]),
    ("timeouts", "Timeouts and watchdogs", &[Do("program.goTo", r#"{"moment": 2}"#)]),
    ("timeouts", "A watchdog", &[Do("program.goTo", r#"{"moment": 4}"#)]),
    (
        "timeouts",
        "A limit for a wait",
        &[
            Edit("(Antenna = Deployed)", "(TIMEOUT 9 (Antenna = Deployed))"),
            Do("program.goTo", r#"{"moment": 3}"#),
        ],
    ),
    ("locks", "Locks", &[Do("program.goTo", r#"{"moment": 0}"#)]),
    ("locks", "Locks in one order", &[Do("program.goTo", r#"{"moment": 12}"#)]),
];

fn open(app: &mut App, lesson: &str, stop: usize) {
    app.run(Command::Lesson(LessonCommand::Open(lesson.into(), stop)));
    app.settle();
}

fn edit(app: &mut App, before: &str, after: &str) {
    let text = app.session.state().document.text().to_owned();
    assert!(text.contains(before), "{before:?} is not in {text}");
    app.session.set_source(&text.replacen(before, after, 1));
    app.settle();
}

fn run(app: &mut App, command: &str, arguments: &Value) {
    app.dispatch(command, arguments);
    app.settle();
}

fn is_done(app: &App) -> bool {
    app.json()["lesson"]["open"]["question"]["isRight"] == true
}

#[test]
fn a_wrong_attempt_at_a_task_does_not_count() {
    let mut app = start();
    let mut wrong = Vec::new();
    let mut tasks = 0;
    for course in std::iter::once(&TOUR).chain(COURSE.iter().flat_map(|chapter| chapter.lessons)) {
        let (lesson, _) = read_lesson(course.name, course.text);
        for (number, stop) in lesson.stops.iter().enumerate() {
            let Some(ask) = stop.ask.as_ref().filter(|ask| matches!(ask.answer, Answer::Task(_))) else {
                continue;
            };
            tasks += 1;
            let place = format!("{}, {}", course.name, stop.title);
            let Some((_, _, attempt)) = ATTEMPTS
                .iter()
                .find(|(name, title, _)| (*name, *title) == (course.name, stop.title.as_str()))
            else {
                wrong.push(format!("{place}: no wrong attempt"));
                continue;
            };
            open(&mut app, course.name, number);
            for step in *attempt {
                match step {
                    Edit(before, after) => edit(&mut app, before, after),
                    Do(command, arguments) => {
                        let arguments = serde_json::from_str(arguments).expect("JSON");
                        run(&mut app, command, &arguments);
                    }
                }
            }
            if is_done(&app) {
                wrong.push(format!("{place}: the wrong attempt counts"));
            }
            // Of a solution of several parts, what is before the last one does not do it.
            if ask.solution.len() < 2 {
                continue;
            }
            open(&mut app, course.name, number);
            for action in &ask.solution[..ask.solution.len() - 1] {
                match action {
                    Action::Replace(before, after) => edit(&mut app, before, after),
                    Action::Command(_, command, arguments) => run(&mut app, command, arguments),
                }
                if is_done(&app) {
                    wrong.push(format!("{place}: a part of the solution counts"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(tasks, ATTEMPTS.len(), "each attempt is at a task");
}
