//! The whole course, walked through: every lesson reads, its mission comes to what it says, every stop finds its step and
//! its selection, every value in its prose is known, and every question has one right answer, which the planner gives.

use kirk::{Event, TreeChoice};
use serde_json::{Value, json};
use test_support::{App, start};
use workbench::command::Command;
use workbench::description::Description;
use workbench::host_io::Remote as _;
use workbench::lesson::{Answer, COURSE, CourseLesson, Expectation, Forecast, Glossary, Lesson, Stop, TOUR};
use workbench::registry::read_lesson;
use workbench::state::lesson::LessonCommand;
use workbench::state::search::SearchCommand;
use workbench::state::search::focus::is_failure;
use workbench::state::search::wording::choice;

fn lessons() -> impl Iterator<Item = (&'static CourseLesson, Lesson)> {
    std::iter::once(&TOUR).chain(COURSE.iter().flat_map(|chapter| chapter.lessons)).map(|lesson| {
        let (read, errors) = read_lesson(lesson.name, lesson.text);
        assert_eq!(errors, [], "{}", lesson.name);
        (lesson, read)
    })
}

fn open(app: &mut App, lesson: &str, stop: usize) {
    app.run(Command::Lesson(LessonCommand::Open(lesson.into(), stop)));
    app.settle();
    assert!(!app.session.state().lesson.is_due(), "{lesson}, stop {}: nothing is shown", stop + 1);
}

fn at(app: &App) -> Value {
    app.json()["lesson"]["open"].clone()
}

/// Walks through a lesson, and gives what is wrong with it.
fn walk(app: &mut App, name: &str, lesson: &Lesson) -> Vec<String> {
    let mut wrong = Vec::new();
    for (number, stop) in lesson.stops.iter().enumerate() {
        open(app, name, number);
        let place = format!("{name}, stop {} ({})", number + 1, stop.title);
        let state = app.json();
        let complaints = state["toasts"].as_array().into_iter().flatten().filter_map(Value::as_str);
        wrong.extend(
            complaints
                .filter(|it| it.contains("of the lesson") || it.contains("`expects`"))
                .map(|it| format!("{place}: {it}")),
        );
        let prose = at(app)["prose"].as_str().unwrap_or_default().to_owned();
        if prose.contains('…') && !stop.prose.iter().any(|block| block.plain().contains('…')) {
            wrong.push(format!("{place}: a value is not known: {prose}"));
        }
        if let Some((_, name)) = &stop.show.select
            && app.session.state().selection.is_none()
        {
            wrong.push(format!("{place}: {name} is not selected"));
        }
        let Some(ask) = &stop.ask else { continue };
        if let Answer::Prediction(forecast) = &ask.answer {
            wrong.extend(predict(app, name, number, forecast).into_iter().map(|it| format!("{place}: {it}")));
        }
        for text in [&ask.text, &ask.hint] {
            if app.session.state().lesson_line(text).contains('…') && !text.contains('…') {
                wrong.push(format!(
                    "{place}: a value is not known: {}",
                    app.session.state().lesson_line(text)
                ));
            }
        }
        wrong.extend(
            answer(app, &ask.answer, !ask.solution.is_empty()).into_iter().map(|it| format!("{place}: {it}")),
        );
        // What is said once the answer is right is true then.
        if app.session.state().lesson_line(&ask.because).contains('…') && !ask.because.contains('…') {
            wrong.push(format!(
                "{place}: a value is not known: {}",
                app.session.state().lesson_line(&ask.because)
            ));
        }
    }
    wrong
}

/// Answers the question of a stop wrongly and rightly, and gives what is wrong with it.
fn answer(app: &mut App, answer: &Answer, has_solution: bool) -> Vec<String> {
    let mut wrong = Vec::new();
    if let Answer::Task(_) = answer {
        if at(app)["question"]["isRight"] == true {
            wrong.push("the task is done before anybody does it".to_owned());
        }
        if !has_solution {
            return vec!["the task has no solution".to_owned()];
        }
        app.dispatch("learn.solve", &json!({}));
        app.settle();
        if at(app)["question"]["isRight"] != true {
            wrong.push(format!(
                "its solution does not do the task; status {}, {}",
                app.json()["status"],
                app.json()["toasts"]
            ));
        }
        return wrong;
    }
    if let Answer::Prediction(_) = answer {
        return wrong;
    }
    let Some(right) = answer.right_now(&Description::of(app.session.state())) else {
        return vec!["what is right cannot be computed".to_owned()];
    };
    if let Answer::Choice(choices) = answer {
        let verdicts: Vec<Option<bool>> = choices
            .iter()
            .map(|choice| choice.is_right.holds(&Description::of(app.session.state())))
            .collect();
        if verdicts.iter().filter(|it| **it == Some(true)).count() != 1 || verdicts.contains(&None) {
            wrong.push(format!("exactly one choice is right, not {verdicts:?}"));
        }
    }
    let others: Vec<String> = match answer {
        Answer::Choice(choices) => {
            (0..choices.len()).map(|at| at.to_string()).filter(|at| *at != right).collect()
        }
        Answer::Number(..) => {
            let number: f64 = right.parse().unwrap_or(1.0);
            vec!["-12345".to_owned(), format!("{}", number + 1.5), "many".to_owned()]
        }
        Answer::Word(_) | Answer::Task(_) | Answer::Prediction(_) => vec!["something else".to_owned()],
    };
    assert!(!others.is_empty(), "there is a wrong answer");
    let wrong_ones = others.into_iter().map(|it| (it, false));
    for (given, is_right) in wrong_ones.chain([(right, true)]) {
        app.dispatch("learn.answer", &json!({ "answer": given }));
        if at(app)["question"]["isRight"] != is_right {
            wrong.push(format!("{given:?} should be judged {is_right}"));
        }
    }
    wrong
}

/// Returns what comes at a stop that has it predicted, read from the recorded search or from the run, and not from what
/// the lesson computes.
fn outcomes(app: &mut App, name: &str, stop: usize, forecast: &Forecast) -> Vec<String> {
    open(app, name, stop);
    let state = app.session.state();
    let mut outcomes = Vec::new();
    match forecast {
        Forecast::Decision | Forecast::Failure => {
            let recording = state.search.recordings(state.shown())[state.search.side()].clone();
            let (network, trace) = (recording.network(), recording.trace());
            let from = state.search.step().expect("a step is shown").step + 1;
            for entry in &trace.events[from..] {
                let made = match (&entry.event, forecast) {
                    (Event::Decide { decision, alternative }, Forecast::Decision) => {
                        Some(TreeChoice::Decision { decision: *decision, alternative: *alternative })
                    }
                    (event, Forecast::Failure) if is_failure(event) => {
                        trace.tree[entry.tree_node as usize].choice
                    }
                    _ => continue,
                };
                outcomes.push(choice(network, made));
            }
            outcomes.extend(forecast.nothing().map(str::to_owned));
        }
        Forecast::Estimate(component) => {
            for moment in state.automaton.at() + 1.. {
                app.dispatch("program.goTo", &json!({ "moment": moment }));
                app.settle();
                if app.session.state().automaton.at() < moment {
                    break;
                }
                let belief = &app.json()["hca"]["plant"]["belief"][0]["state"];
                outcomes.push(belief[component].as_str().unwrap_or_default().to_owned());
            }
        }
    }
    outcomes
}

/// Predicts all that comes at a stop: rightly, wrongly, and every other one rightly. Gives what is wrong with that.
fn predict(app: &mut App, name: &str, stop: usize, forecast: &Forecast) -> Vec<String> {
    let outcomes = outcomes(app, name, stop, forecast);
    let mut wrong = Vec::new();
    if outcomes.len() < 2 {
        wrong.push(format!("there is little to predict: {outcomes:?}"));
    }
    for (how, is_right) in
        [("rightly", [true, true]), ("wrongly", [false, false]), ("by turns", [true, false])]
    {
        open(app, name, stop);
        let mut right = 0;
        for (at, outcome) in outcomes.iter().enumerate() {
            let question = at_question(app);
            let choices: Vec<&str> =
                question["choices"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
            if !choices.contains(&outcome.as_str()) {
                wrong.push(format!("{outcome} cannot be predicted, but {choices:?}"));
                break;
            }
            let is_right = is_right[at % 2];
            let given = if is_right {
                outcome.clone()
            } else {
                choices.iter().find(|it| *it != outcome).expect("another one").to_string()
            };
            app.dispatch("learn.answer", &json!({ "answer": given }));
            app.settle();
            right += usize::from(is_right);
            let question = at_question(app);
            let counts = [&question["predictions"]["made"], &question["predictions"]["right"]];
            if counts != [&json!(at + 1), &json!(right)] || question["isRight"] != is_right {
                wrong.push(format!("{how}, {outcome}: {question}"));
            }
        }
        let question = at_question(app);
        if question["predictions"]["isOver"] != true || question["choices"] != json!([]) {
            wrong.push(format!("{how}: it is not over: {question}"));
        }
    }
    wrong
}

fn at_question(app: &App) -> Value {
    at(app)["question"].clone()
}

#[test]
fn nobody_predicts_what_was_shown() {
    let mut app = start();
    let (course, lesson) = lessons().find(|(course, _)| course.name == "choices").expect("a lesson");
    let is_asked =
        |stop: &Stop| matches!(stop.ask.as_ref().map(|it| &it.answer), Some(Answer::Prediction(_)));
    let stop = lesson.stops.iter().position(is_asked).expect("a prediction");
    let all = outcomes(&mut app, course.name, stop, &Forecast::Decision);
    open(&mut app, course.name, stop);
    // Someone looks ahead to the next decision and back: now the one after it is to be predicted.
    let here = app.session.state().search.step().expect("a step").step;
    while app.json()["search"]["known"]["event"] != "decide" || app.json()["search"]["step"] == here + 1 {
        app.run(Command::Search(SearchCommand::Step(1)));
    }
    app.run(Command::Search(SearchCommand::GoTo(here)));
    app.dispatch("learn.answer", &json!({ "answer": all[1] }));
    assert_eq!(at_question(&app)["isRight"], true, "{all:?}");
    // Where everything is shown, nothing is left, until the stop begins again.
    app.run(Command::Search(SearchCommand::Close));
    assert_eq!(at_question(&app)["choices"], json!([]));
    app.dispatch("learn.answer", &json!({ "answer": all[2] }));
    assert_eq!(at_question(&app)["predictions"]["made"], 1);
    app.run(Command::Lesson(LessonCommand::ShowAgain));
    app.settle();
    app.dispatch("learn.answer", &json!({ "answer": all[0] }));
    assert_eq!(at_question(&app)["predictions"], json!({ "made": 1, "right": 1, "isOver": false }));
    assert_eq!(app.session.state().settings.predictions, [2, 2]);
}

#[test]
fn every_stop_of_every_lesson_is_true() {
    let mut app = start();
    let mut wrong = Vec::new();
    let only = std::env::var("LESSON").ok();
    for (course, lesson) in lessons() {
        if only.as_ref().is_none_or(|only| only == course.name) {
            wrong.extend(walk(&mut app, course.name, &lesson));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_mission_of_every_lesson_comes_to_what_the_lesson_says() {
    let mut app = start();
    for (course, lesson) in lessons() {
        open(&mut app, course.name, 0);
        let status = app.json()["status"].as_str().unwrap_or_default().to_owned();
        let expected = match lesson.expects {
            Expectation::Plan => "plan",
            Expectation::NoPlan => "no-plan",
            Expectation::Errors => "broken",
            Expectation::Program => "program",
        };
        assert_eq!(status, expected, "{}", course.name);
        assert!(!lesson.about.is_empty(), "{} says what it is about", course.name);
        assert!(lesson.stops.iter().any(|stop| stop.ask.is_some()), "{} asks something", course.name);
    }
}

#[test]
fn every_lesson_opens_with_what_its_reader_will_be_able_to_do() {
    for (course, lesson) in lessons().skip(1) {
        let first = lesson.stops[0].prose.first().map(markdown::Block::plain).unwrap_or_default();
        let words = first.split_whitespace().count();
        let is_sentence =
            first.starts_with("You will ") && first.ends_with('.') && first.matches(". ").count() == 0;
        assert!(is_sentence && words <= 25, "{}, {words} words: {first}", course.name);
    }
}

#[test]
fn what_lessons_say_of_their_missions_is_computed_and_follows_an_edit() {
    let mut app = start();
    let because = |app: &App, lesson: &str, stop: usize| {
        let course = lessons().find(|(it, _)| it.name == lesson).expect("it is in the course").1;
        let ask = course.stops[stop].ask.as_ref().expect("it asks something");
        app.session.state().lesson_line(&ask.because)
    };
    let prose = |app: &App| at(app)["prose"].as_str().unwrap_or_default().to_owned();
    open(&mut app, "choices", 1);
    assert_eq!(because(&app, "choices", 1), "D2 was decided last, and has 2 alternatives left.");
    let failures = because(&app, "choices", 2);
    assert!(failures.starts_with("3 after the long way, and 1 more after the short way."), "{failures}");
    open(&mut app, "order", 1);
    assert!(
        prose(&app)
            .contains("Send consumes 6 at its start. The image produces 6 at its end, and the spectrum 4.")
    );
    let text = app.session.state().document.text().replacen("Memory 4", "Memory 3", 1);
    app.session.set_source(&text);
    app.settle();
    assert!(prose(&app).contains("the spectrum 3."), "{}", prose(&app));
    open(&mut app, "estimation", 1);
    assert!(
        prose(&app)
            .contains("the first is 99.748%. Both engines work with probability 99.748% · 99.748% = 99.497%")
    );
    open(&mut app, "objectives", 3);
    assert_eq!(because(&app, "objectives", 3), "It is 9. That of the other one is 10.");
}

#[test]
fn next_and_previous_lead_through_the_course_and_back() {
    let mut app = start();
    // The tour is before the course.
    let all: Vec<(String, usize)> = lessons()
        .skip(1)
        .flat_map(|(course, lesson)| (1..=lesson.stops.len()).map(move |stop| (course.name.to_owned(), stop)))
        .collect();
    let place = |app: &App| {
        let open = at(app);
        let stop = open["stop"].as_u64().unwrap_or_default() as usize;
        (open["name"].as_str().unwrap_or_default().to_owned(), stop)
    };
    app.session.apply(vec![Command::Lesson(LessonCommand::Open(all[0].0.as_str().into(), 0))]);
    for expected in &all {
        assert_eq!(place(&app), *expected);
        app.session.apply(vec![Command::Lesson(LessonCommand::Turn(true))]);
    }
    assert_eq!(place(&app), *all.last().expect("a course"), "the end is the end");
    for expected in all.iter().rev().skip(1) {
        app.session.apply(vec![Command::Lesson(LessonCommand::Turn(false))]);
        assert_eq!(place(&app), *expected);
    }
}

#[test]
fn every_lesson_marks_terms_that_the_glossary_knows() {
    let mut is_used = 0;
    for (_, lesson) in lessons() {
        for stop in &lesson.stops {
            is_used += usize::from(Glossary::get().marked(&stop.prose) != stop.prose);
        }
    }
    assert!(is_used > 40, "{is_used} stops");
}

#[test]
fn a_task_is_not_done_by_something_else() {
    let mut app = start();
    let mut is_done = |lesson: &str, title: &str, from: &str, to: &str| {
        let course = lessons().find(|(it, _)| it.name == lesson).expect("it is in the course").1;
        let stop = course.stops.iter().position(|stop| stop.title == title).expect("it has this stop");
        open(&mut app, lesson, stop);
        let text = app.session.state().document.text().to_owned();
        assert!(text.contains(from), "{text}");
        app.session.set_source(&text.replacen(from, to, 1));
        app.settle();
        at(&app)["question"]["isRight"] == true
    };
    let wall = |x: f64, y: f64| {
        let (right, top) = (x + 4.0, y + 35.0);
        format!("obstacle Wall1 polygon ({x}, {y}, {right}, {y}, {right}, {top}, {x}, {top}); obstacle Scarp")
    };
    assert!(!is_done("rrt", "Walls", "obstacle Scarp", &wall(10.0, 10.0)), "the gap is open");
    assert!(is_done("rrt", "Walls", "obstacle Scarp", &wall(122.0, 145.0)));
    assert!(!is_done("bounds", "One more bound", "[0,70]", "[0,70"), "a broken text proves nothing");
    assert!(!is_done("threats", "All threats resolved", "DIG [5,5]", "DIG [50,50]"), "the day is as long");
    assert!(is_done("threats", "All threats resolved", "[0,20]", "[0, 14]"));
}

#[test]
fn the_text_is_wrapped_beside_prose_and_as_it_was_after_the_lesson() {
    let mut app = start();
    let wraps = |app: &App| app.session.state().settings.views.editor.wraps;
    for before in [false, true] {
        app.session.state_mut().settings.views.editor.wraps = before;
        open(&mut app, "states", 0);
        assert!(wraps(&app));
        open(&mut app, "resources", 1);
        assert!(wraps(&app));
        app.run(Command::OpenExample("enroute".into()));
        assert_eq!(wraps(&app), before);
    }
}
