//! The text under work is kept beyond the end of a run.

mod support;

use std::rc::Rc;

use workbench::command::Command;

use support::{World, start_in};

const EDITED: &str = "Sortie()[l,u] = { Scan()[1,2] }\n";

fn text_of(app: &support::App) -> String {
    app.session.state().document.text().to_owned()
}

fn edit(app: &mut support::App, text: &str) {
    app.session.apply(vec![Command::SetSource(text.to_owned())]);
    app.world.now_secs.set(app.world.now_secs.get() + 1.0);
    app.settle();
}

#[test]
fn an_edited_text_is_there_again_in_the_next_run() {
    let world = Rc::new(World::default());
    let mut first = start_in(Rc::clone(&world));
    edit(&mut first, EDITED);
    drop(first);
    let second = start_in(world);
    assert_eq!(text_of(&second), EDITED);
    assert_eq!(second.session.state().mission, "enroute");
}

#[test]
fn an_address_that_names_a_mission_wins_and_the_draft_can_be_brought_back() {
    let world = Rc::new(World::default());
    let mut first = start_in(Rc::clone(&world));
    edit(&mut first, EDITED);
    drop(first);
    "mission=threats".clone_into(&mut world.fragment.borrow_mut());
    let mut second = start_in(Rc::clone(&world));
    assert_ne!(text_of(&second), EDITED);
    // Even when the other mission was edited, and the page closed on it.
    edit(&mut second, "Other()[l,u] = { Wait()[1,2] }\n");
    drop(second);
    world.fragment.borrow_mut().clear();
    let mut third = start_in(world);
    third.session.apply(vec![Command::OpenEarlierDraft]);
    assert_eq!(text_of(&third), EDITED);
}

#[test]
fn an_example_that_was_not_edited_is_no_draft() {
    let world = Rc::new(World::default());
    let mut first = start_in(Rc::clone(&world));
    first.session.apply(vec![Command::OpenExample("backjump".into())]);
    first.settle();
    drop(first);
    assert_eq!(start_in(world).session.state().mission, "enroute");
}

#[test]
fn a_full_storage_is_said_once_and_the_text_stays() {
    let world = Rc::new(World::default());
    world.is_full.set(true);
    let mut app = start_in(world);
    edit(&mut app, EDITED);
    let state = app.json();
    let toasts = state["toasts"].as_array().cloned().unwrap_or_default();
    assert_eq!(toasts.iter().filter(|it| it.to_string().contains("is not kept")).count(), 1, "{toasts:?}");
    assert_eq!(text_of(&app), EDITED);
}

#[test]
fn kept_settings_that_cannot_be_used_are_brought_within_reason() {
    for (kept, scale) in [("1e30", 2.5), ("-4", 0.6), ("1.5", 1.5)] {
        let world = Rc::new(World::default());
        let text = format!(r#"{{"text_scale": {kept}, "views": {{"terrain": {{"height_scale": 1e30}}}}}}"#);
        world.storage.borrow_mut().insert("enroute/settings-1".to_owned(), text);
        let app = start_in(world);
        let settings = &app.session.state().settings;
        assert_eq!(settings.text_scale, scale, "{kept}");
        assert_eq!(settings.views.terrain.height_scale, 5.0);
    }
}
