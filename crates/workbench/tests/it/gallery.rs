//! How a mission starts: the examples with their pictures and sentences, templates without problems, and an empty mission.

use std::collections::BTreeMap;

use test_support::{App, start};
use text_editing::TextCommand;
use workbench::command::Command;
use workbench::library::{self, LibraryCommand, TEMPLATES};
use workbench::mission_file::{EXAMPLES, PICTURES};
use workbench::state::Status;

fn open(app: &mut App, name: &str) {
    app.run(Command::OpenExample(name.into()));
}

#[test]
fn the_pictures_of_the_examples_are_their_plans() {
    let mut app = start();
    let mut pictures = BTreeMap::new();
    for example in EXAMPLES {
        open(&mut app, example.name);
        let picture = app.session.state().shown().and_then(|shown| library::picture(shown));
        pictures.insert(example.name, picture.unwrap_or_default());
    }
    let lines = pictures.iter().map(|(name, bars)| {
        let bars = serde_json::to_string(bars).expect("plain data");
        format!("  \"{name}\": {bars}")
    });
    let written = format!("{{\n{}\n}}\n", lines.collect::<Vec<_>>().join(",\n"));
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/missions/pictures.json");
        std::fs::write(path, written).expect("the pictures can be written");
        return;
    }
    assert!(written == PICTURES, "run with UPDATE_SNAPSHOTS=1 to write the pictures again");
}

#[test]
fn each_example_says_in_one_sentence_what_it_shows() {
    for example in EXAMPLES {
        let sentences = example.about.matches('.').count();
        assert!(example.about.ends_with('.') && sentences == 1, "{}: {}", example.name, example.about);
        assert!(example.about.split_whitespace().count() <= 25, "{}", example.name);
    }
}

#[test]
fn templates_open_with_a_plan_and_without_a_warning() {
    let mut app = start();
    for template in TEMPLATES.iter().filter(|template| !template.source.is_empty()) {
        app.run(Command::Library(LibraryCommand::New(template)));
        let problems = app.session.state().snapshots.problems();
        assert_eq!(problems, [], "{}", template.name);
        assert_eq!(app.session.state().status(), Status::Plan, "{}", template.name);
    }
}

#[test]
fn what_a_mission_that_is_being_written_lacks_is_no_error() {
    let mut app = start();
    app.run(Command::Library(LibraryCommand::New(&TEMPLATES[0])));
    let graver = |app: &App| {
        let problems = app.session.state().snapshots.problems().iter();
        problems.filter(|problem| problem.severity != rmpl::Severity::Note).count()
    };
    assert_eq!(graver(&app), 0, "an empty text");
    app.run(Command::Text(TextCommand::Insert("location A (1, 2);\n".to_owned())));
    assert_eq!(graver(&app), 0, "a place and nothing to do");
    assert_eq!(app.session.state().status(), Status::Empty);
}
