//! Key steps only: stepping and playing go from what the search does to what it does next, as a student follows it.

use serde_json::json;
use test_support::{App, start};
use workbench::ViewAction;
use workbench::command::Command;
use workbench::state::lesson::LessonCommand;
use workbench::state::search::focus::is_key;
use workbench::state::search::{Recording, SearchCommand};
use workbench::{PanelEffect, PanelKind};

/// The lesson on choices and backtracking, with its search.
fn lesson() -> (App, Recording) {
    let mut app = start();
    app.run(Command::Lesson(LessonCommand::Open("choices".into(), 0)));
    app.settle();
    let state = app.session.state();
    let recording = state.search.recordings(state.shown()).into_iter().next().expect("it is recorded");
    (app, recording)
}

fn step(app: &App) -> Option<usize> {
    app.session.state().search.step().map(|step| step.step)
}

#[test]
fn without_being_asked_steps_go_from_key_step_to_key_step_and_back() {
    let (mut app, recording) = lesson();
    let events = &recording.trace().events;
    let keys: Vec<usize> = (0..events.len()).filter(|&at| is_key(&events[at].event)).collect();
    assert!(
        2 * keys.len() < events.len(),
        "most steps only prepare others: {} of {}",
        keys.len(),
        events.len()
    );
    app.run(Command::Search(SearchCommand::Close));
    let walk = |app: &mut App, by: i64| {
        let mut way = Vec::new();
        for _ in 0..keys.len() {
            app.run(Command::Search(SearchCommand::Step(by)));
            way.extend(step(app));
        }
        way
    };
    assert_eq!(walk(&mut app, 1), keys);
    app.run(Command::Search(SearchCommand::Close));
    assert_eq!(walk(&mut app, -1), keys.iter().rev().copied().collect::<Vec<_>>());
    // A step is still called by its own number, in every panel.
    app.run(Command::Search(SearchCommand::GoTo(keys[2])));
    assert_eq!(app.json()["search"]["step"], keys[2] + 1);
    assert_eq!(app.json()["search"]["steps"], events.len());
}

#[test]
fn all_steps_are_there_for_who_asks_for_them() {
    let (mut app, recording) = lesson();
    assert_eq!(app.json()["search"]["onlyKeySteps"], true);
    app.dispatch("search.keySteps", &json!(null));
    assert_eq!(app.json()["search"]["onlyKeySteps"], false);
    app.run(Command::Search(SearchCommand::GoTo(0)));
    for expected in 1..recording.steps() {
        app.run(Command::Search(SearchCommand::Step(1)));
        assert_eq!(step(&app), Some(expected));
    }
}

#[test]
fn what_plays_plays_key_steps() {
    let (mut app, recording) = lesson();
    let events = &recording.trace().events;
    app.run(Command::Search(SearchCommand::GoTo(0)));
    app.session.apply(vec![Command::Search(SearchCommand::TogglePlaying)]);
    let mut seen = Vec::new();
    for _ in 0..400 {
        app.world.now_secs.set(app.world.now_secs.get() + 0.25);
        app.session.begin_frame();
        if seen.last() != step(&app).as_ref() {
            seen.extend(step(&app));
        }
    }
    assert_eq!(seen.last(), Some(&(events.len() - 1)), "it plays to the end");
    assert!(seen[1..].iter().all(|&at| is_key(&events[at].event)), "{seen:?}");
}

#[test]
fn each_stop_shows_every_drawing_from_where_its_step_is_whatever_was_zoomed_before() {
    let (mut app, _) = lesson();
    for (lesson, stop) in [("choices", 1), ("learning", 0), ("learning", 1)] {
        app.session.state_mut().window.panel_effects.take(Some);
        app.run(Command::Lesson(LessonCommand::Open(lesson.into(), stop)));
        app.settle();
        let effects: Vec<PanelEffect> = app.session.state_mut().window.panel_effects.take(Some);
        for panel in [PanelKind::Search, PanelKind::Network, PanelKind::Timeline, PanelKind::Distances] {
            let is_view = |it: &&PanelEffect| matches!(it, PanelEffect::View(moved, _) if *moved == panel);
            let last = effects.iter().rfind(is_view).unwrap_or_else(|| panic!("{lesson}, {stop}: {panel:?}"));
            let is_anew = matches!(last, PanelEffect::View(_, ViewAction::Fit | ViewAction::FitSelection));
            assert!(is_anew, "{lesson}, {stop}: {last:?}");
        }
    }
}
