//! The whole course, walked through: every lesson reads, its mission comes to what it says, every stop finds its step and
//! its selection, every value in its prose is known, and every question has one right answer, which the planner gives.

use serde_json::{Value, json};
use test_support::{App, start};
use workbench::command::Command;
use workbench::description::Description;
use workbench::lesson::{Answer, COURSE, CourseLesson, Expectation, Glossary, Lesson};
use workbench::outside::Remote as _;
use workbench::registry::read_lesson;
use workbench::state::lesson::LessonCommand;

fn lessons() -> impl Iterator<Item = (&'static CourseLesson, Lesson)> {
    COURSE.iter().flat_map(|chapter| chapter.lessons).map(|lesson| {
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
    let other = match answer {
        Answer::Choice(choices) => (0..choices.len()).map(|at| at.to_string()).find(|at| *at != right),
        Answer::Number(..) => Some("-12345".to_owned()),
        Answer::Word(_) | Answer::Task(_) => Some("something else".to_owned()),
    };
    for (given, is_right) in [(other.unwrap_or_default(), false), (right, true)] {
        app.dispatch("learn.answer", &json!({ "answer": given }));
        if at(app)["question"]["isRight"] != is_right {
            wrong.push(format!("{given:?} should be judged {is_right}"));
        }
    }
    wrong
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
fn next_and_previous_lead_through_the_course_and_back() {
    let mut app = start();
    let all: Vec<(String, usize)> = lessons()
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
