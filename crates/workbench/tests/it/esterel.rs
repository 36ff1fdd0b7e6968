//! Each Esterel idiom that a lesson runs, in the page's own hands: the lesson's program is the one of `docs/esterel.md`,
//! stepping it with what is known there marks what the table of that idiom says, and the idiom means what Esterel says of
//! it (SPEC 8.2). That the compiled automaton follows the tables is tested in `hca`; here the lesson, its variables and
//! the inputs of single steps are.

use serde_json::{Value, json};
use test_support::{App, start};
use workbench::command::Command;
use workbench::host_io::Remote as _;
use workbench::lesson::{COURSE, Lesson};
use workbench::state::lesson::LessonCommand;

const MANUAL: &str = include_str!("../../../../docs/esterel.md");

/// An idiom of the manual: its program, and for each step what is marked and what is known at its end.
#[derive(Debug)]
struct Idiom {
    heading: &'static str,
    program: String,
    steps: Vec<Tick>,
}

/// What is marked after a step, and what is known at its end.
type Tick = (Vec<&'static str>, Vec<(&'static str, &'static str)>);

/// The first example of every section of the manual.
fn idioms() -> Vec<Idiom> {
    let sections = MANUAL.split("\n## ").skip(1);
    let idioms = sections.map(|section| {
        let heading = section.lines().next().expect("a heading");
        let (_, rest) = section.split_once("```rmpl\n").expect("a program");
        let (program, rest) = rest.split_once("```").expect("the end of the program");
        let table = rest.split("```").next().expect("a table");
        let rows = table.lines().map(|line| line.trim_matches('|').split('|').map(str::trim));
        let steps = rows.filter_map(|cells| match cells.collect::<Vec<_>>()[..] {
            [step, marked, known] if step.parse::<u32>().is_ok() => Some((
                marked.split(", ").filter(|it| !it.is_empty()).collect(),
                known.split_whitespace().map(|pair| pair.split_once('=').expect("a value")).collect(),
            )),
            _ => None,
        });
        Idiom { heading, program: program.to_owned(), steps: steps.collect() }
    });
    idioms.collect()
}

/// The text without the places where lines end.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ").replace("( ", "(").replace(" )", ")")
}

fn marked(app: &App) -> Vec<String> {
    let all = app.json()["hca"]["marked"].clone();
    let mut all: Vec<String> =
        all.as_array().expect("a program").iter().filter_map(|it| it.as_str().map(str::to_owned)).collect();
    all.sort();
    all
}

/// Says what is known at the end of the step that comes, and nothing else, and takes the step.
fn step(app: &mut App, known: &[(&str, &str)]) {
    let variables: Vec<String> = {
        let program = app.session.state().automaton.program().expect("a program");
        program.automaton().expect("it compiles").variables.iter().map(|it| it.name.to_string()).collect()
    };
    for variable in &variables {
        app.dispatch("program.know", &json!({ "variable": variable }));
    }
    for (variable, value) in known {
        let told = app.session.dispatch("program.know", &json!({ "variable": variable, "value": value }));
        // A value that the program does not speak of is none that it could tell from not knowing.
        assert!(told.is_ok() || *value == "off", "{variable}={value}: {told:?}");
        app.settle();
    }
    let next = app.json()["hca"]["step"].as_u64().expect("a step") + 1;
    app.dispatch("program.goTo", &json!({ "moment": next }));
    assert_eq!(app.json()["hca"]["step"], next, "the step is taken");
}

/// The stops of the Esterel lessons: the lesson, the number of the stop and its title.
fn stops() -> Vec<(&'static str, usize, String)> {
    let lessons = COURSE.iter().flat_map(|chapter| chapter.lessons);
    let esterel = lessons.filter(|lesson| lesson.name.starts_with("esterel"));
    let stops = esterel.flat_map(|lesson| {
        let (read, _) = Lesson::read(lesson.name, lesson.text);
        read.stops.into_iter().enumerate().map(|(at, stop)| (lesson.name, at, stop.title))
    });
    stops.collect()
}

/// The stop whose program is that of an idiom, opened and brought back to its first step.
fn open(app: &mut App, idiom: &Idiom) {
    let mut programs = Vec::new();
    for (lesson, at, title) in stops() {
        app.run(Command::Lesson(LessonCommand::Open(lesson.into(), at)));
        app.settle();
        let source = words(&app.session.source());
        if source == words(&idiom.program) {
            app.dispatch("program.goTo", &json!({ "moment": 0 }));
            app.dispatch("program.reset", &Value::Null);
            assert_eq!(app.json()["status"], "program", "{title}");
            return;
        }
        programs.push((title, source));
    }
    panic!("no lesson runs {}: {programs:#?}", idiom.heading);
}

fn named(heading: &str) -> Idiom {
    idioms().into_iter().find(|it| it.heading == heading).unwrap_or_else(|| panic!("no {heading}"))
}

#[test]
fn each_idiom_of_the_manual_runs_in_a_lesson_as_its_table_says() {
    let mut app = start();
    let idioms = idioms();
    assert_eq!(idioms.len(), 9, "the rows of SPEC 8.2");
    for idiom in &idioms {
        open(&mut app, idiom);
        for (number, (expected, known)) in idiom.steps.iter().enumerate() {
            assert_eq!(marked(&app), *expected, "{}, step {}", idiom.heading, number + 1);
            if number + 1 < idiom.steps.len() {
                step(&mut app, known);
            }
        }
    }
    assert_eq!(stops().len(), idioms.len(), "every stop has an idiom of its own");
}

/// Returns what is marked after these steps, one after the other, from the start.
fn run(app: &mut App, idiom: &str, known: &[&[(&str, &str)]]) -> Vec<String> {
    open(app, &named(idiom));
    for now in known {
        step(app, now);
    }
    marked(app)
}

const S: &[(&str, &str)] = &[("s", "on")];
const NOTHING: &[(&str, &str)] = &[];

#[test]
fn each_idiom_means_what_esterel_says_of_it() {
    let app = &mut start();
    let has = |marked: &[String], label: &str| marked.iter().any(|it| it == label);
    // pause lasts one step, whatever is known.
    for known in [NOTHING, &[("x", "a")]] {
        assert_eq!(run(app, "pause", &[known]), ["assert x=a"]);
    }
    // halt never ends.
    let long = vec![NOTHING; 12];
    assert!(!run(app, "halt", &long).is_empty());
    // await ends with the step in which the signal comes, whichever that is, and not before.
    for wait in 0..4 {
        let mut known = vec![NOTHING; wait];
        assert!(!has(&run(app, "await S", &known), "assert x=a"), "after {wait} steps without it");
        assert!(!has(&run(app, "await S do", &known), "assert x=a"), "after {wait} steps without it");
        known.push(S);
        assert_eq!(run(app, "await S", &known), ["assert x=a"], "after {wait} steps");
        assert_eq!(run(app, "await S do", &known), ["assert x=a"], "after {wait} steps");
    }
    // A trap ends by its exit alone, and in the step of the exit: the other branch has no step more.
    let trap = "trap T in … exit T";
    assert!(has(&run(app, trap, &[NOTHING; 5]), "assert y=b"));
    let x: &[(&str, &str)] = &[("x", "a")];
    let exiting = run(app, trap, &[NOTHING, x]);
    assert!(has(&exiting, "assert exit=true") && has(&exiting, "assert y=b"), "{exiting:?}");
    assert_eq!(run(app, trap, &[NOTHING, x, NOTHING]), ["assert z=c"]);
    // A weak abort leaves the body the step after the signal; an abort does not.
    let weak = "weak abort … when S";
    assert!(has(&run(app, weak, &[S]), "assert y=b"));
    assert!(run(app, weak, &[S, NOTHING]).is_empty());
    let abort = "abort … when S do …";
    assert_eq!(run(app, abort, &[S]), ["assert y=b"], "the handler without the body");
    assert!(has(&run(app, abort, &[NOTHING; 3]), "assert x=a"), "no signal, no abort");
    assert!(!has(&run(app, abort, &[NOTHING; 3]), "assert y=b"), "no signal, no handler");
    // every: again at each signal, where the body stands or has ended, and not ended by the signal that began it.
    let every = "every S do …";
    assert!(has(&run(app, every, &[S]), "assert x=a"));
    let second = run(app, every, &[S, x]);
    assert!(has(&second, "assert y=b") && !has(&second, "assert x=a"), "{second:?}");
    let anew = run(app, every, &[S, x, S]);
    assert!(has(&anew, "assert x=a") && !has(&anew, "assert y=b"), "{anew:?}");
    let ended = run(app, every, &[S, x, &[("y", "b")]]);
    assert_eq!(ended, ["whenever s=on"], "it waits for the next signal");
    assert!(has(&run(app, every, &[S, x, &[("y", "b")], S]), "assert x=a"));
    // do … maintaining: as long as it is known, and not a step longer than known.
    let maintaining = "do … maintaining c";
    let c: &[(&str, &str)] = &[("c", "on")];
    assert!(has(&run(app, maintaining, &[c, c, c]), "assert x=a"));
    assert_eq!(run(app, maintaining, &[c, c, NOTHING]), ["assert y=b"]);
    assert_eq!(run(app, maintaining, &[NOTHING]), ["assert y=b"]);
}
