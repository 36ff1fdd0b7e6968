//! A mission of several files in the page: one text below the other, that is edited, planned, kept and saved as files.

use std::rc::Rc;

use text_editing::TextCommand;
use workbench::command::Command;
use workbench::host::{FileKind, HostEvent, Save};
use workbench::library::LibraryCommand;
use workbench::state::editor::EditorCommand;
use workbench::state::files::FileCommand;

use test_support::{App, World, start_in};

const MAIN: &str =
    "// A day.\nimport \"world/places.rmpl\";\n\nprimitive Rest()[1,2];\nscenario Day = { Rest() }\n";
const PLACES: &str = "location BASE (0, 0);\nvehicle Rover1 : ATRV at BASE;\n";

fn text(app: &App) -> &str {
    app.session.state().document.text()
}

fn apply(app: &mut App, commands: Vec<Command>) {
    app.session.apply(commands);
    app.settle();
}

fn problems(app: &App) -> Vec<String> {
    app.session.state().snapshots.problems().iter().map(|problem| problem.message.clone()).collect()
}

fn files(app: &App) -> Vec<String> {
    app.session.state().file_names().iter().map(ToString::to_string).collect()
}

fn put_caret(app: &mut App, at: &str) {
    let offset = text(app).find(at).expect("it is there");
    apply(app, vec![Command::Text(TextCommand::Select { anchor: offset, head: offset })]);
}

fn type_text(app: &mut App, typed: &str) {
    apply(app, vec![Command::Text(TextCommand::Insert(typed.to_owned()))]);
}

#[test]
fn a_file_that_is_imported_is_added_by_a_fix_written_planned_and_there_in_the_next_run() {
    let world = Rc::new(World::default());
    let mut app = start_in(Rc::clone(&world));
    apply(&mut app, vec![Command::SetSource(MAIN.to_owned())]);
    assert_eq!(problems(&app), ["the mission has no file `world/places.rmpl`"]);
    let fix = app.session.state().snapshots.problems()[0].fixes[0].clone();
    assert_eq!(fix.label, "Add file world/places.rmpl");
    apply(&mut app, vec![Command::Edit { edits: fix.edits, kind: text_editing::EditKind::Single }]);
    assert_eq!(files(&app)[1..], ["world/places.rmpl"]);
    let end = text(&app).len();
    app.session.apply(vec![Command::Text(TextCommand::Select { anchor: end, head: end })]);
    type_text(&mut app, PLACES);
    let unexpected = problems(&app).into_iter().find(|message| message.contains("no file"));
    assert_eq!(unexpected, None);
    let shown = app.session.state().snapshots.shown().expect("it is planned");
    assert!(shown.plan().is_some());
    assert_eq!(shown.program.world.vehicles.len(), 1);
    let whole = text(&app).to_owned();
    drop(app);
    let again = start_in(world);
    assert_eq!(text(&again), whole);
    let mission = again.session.state().library.open_mission().expect("it is kept");
    let kept: Vec<(&str, &str)> =
        mission.texts.iter().map(|file| (file.name.as_str(), file.text.as_str())).collect();
    assert_eq!(kept, [("mission.rmpl", MAIN), ("world/places.rmpl", PLACES)]);
}

#[test]
fn names_are_found_and_changed_across_files_and_undo_takes_all_of_it_back() {
    let mut app = start_in(Rc::new(World::default()));
    let source = MAIN.replace("Rest() }", "Rest(BASE) }").replace("Rest()[", "Rest(place)[");
    apply(
        &mut app,
        vec![Command::SetSource(rmpl::files::joined([("", &*source), ("world/places.rmpl", PLACES)]))],
    );
    let before = text(&app).to_owned();
    put_caret(&mut app, "BASE) }");
    apply(&mut app, vec![Command::Editor(EditorCommand::GoToDefinition)]);
    let declared = before.find("BASE (0, 0)").expect("it is declared");
    assert_eq!(app.session.state().document.caret().range().start, declared);
    assert_eq!(app.session.state().file_at_caret(), 1);
    let line = app.session.state().document.line_at(declared);
    assert_eq!(app.session.state().document.line_in_file(line), 1);
    apply(&mut app, vec![Command::Editor(EditorCommand::RenameTo("HOME".to_owned()))]);
    assert_eq!(text(&app), before.replace("BASE", "HOME"));
    apply(&mut app, vec![Command::Text(TextCommand::Undo)]);
    assert_eq!(text(&app), before);
    // The file itself has another name where it is imported, too.
    put_caret(&mut app, "vehicle");
    apply(&mut app, vec![Command::Files(FileCommand::Rename("ground".to_owned()))]);
    assert_eq!(text(&app), before.replace("world/places.rmpl", "ground.rmpl"));
    assert_eq!(problems(&app), Vec::<String>::new());
    apply(&mut app, vec![Command::Files(FileCommand::Remove)]);
    assert_eq!(text(&app), source.replace("import \"world/places.rmpl\";\n", ""));
    apply(&mut app, vec![Command::Text(TextCommand::Undo), Command::Text(TextCommand::Undo)]);
    assert_eq!(text(&app), before);
}

#[test]
fn no_key_removes_the_name_of_a_file_or_mixes_two() {
    let mut app = start_in(Rc::new(World::default()));
    let whole = rmpl::files::joined([("", "import \"b.rmpl\";"), ("b.rmpl", "location B (1, 1);")]);
    apply(&mut app, vec![Command::SetSource(whole.clone())]);
    let heading = whole.find('\u{1c}').expect("there is one");
    for at in [heading - 1, heading, heading + 1, heading + 3, whole.find("location").expect("it is there")] {
        for key in [TextCommand::Insert("x".into()), TextCommand::NewLine] {
            let caret = Command::Text(TextCommand::Select { anchor: at, head: at });
            apply(&mut app, vec![caret, Command::Text(key)]);
            assert_eq!(files(&app)[1..], ["b.rmpl"], "{:?}", text(&app));
            apply(&mut app, vec![Command::SetSource(whole.clone())]);
        }
    }
    // What reaches over two files stays in neither: Delete and Backspace at their ends, and what is typed over both.
    for (anchor, head) in [(heading - 1, heading), (2, whole.len()), (heading, heading + 2)] {
        let caret = Command::Text(TextCommand::Select { anchor, head });
        apply(&mut app, vec![caret, Command::Text(TextCommand::Insert(String::new()))]);
        assert_eq!(text(&app), whole);
    }
    // Everything is everything of the file.
    put_caret(&mut app, "location");
    apply(&mut app, vec![Command::Text(TextCommand::SelectAll)]);
    type_text(&mut app, "location C (2, 2);");
    assert_eq!(text(&app), whole.replace("location B (1, 1);", "location C (2, 2);"));
    // A mark that is pasted means nothing.
    type_text(&mut app, "\u{1c}c.rmpl\n");
    assert_eq!(files(&app)[1..], ["b.rmpl"]);
}

#[test]
fn a_dropped_file_that_is_imported_joins_the_mission_and_each_is_saved_as_itself() {
    let mut app = start_in(Rc::new(World::default()));
    apply(&mut app, vec![Command::SetSource(MAIN.to_owned())]);
    app.world.news.borrow_mut().push_back(HostEvent::FileOpened {
        kind: FileKind::Mission,
        name: "places.rmpl".to_owned(),
        bytes: PLACES.as_bytes().to_vec(),
        token: None,
    });
    app.settle();
    assert_eq!(text(&app), rmpl::files::joined([("", MAIN), ("world/places.rmpl", PLACES)]));
    apply(&mut app, vec![Command::SaveMission]);
    let saved = app.world.saved.borrow();
    let saved: Vec<(&str, &[u8])> =
        saved.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())).collect();
    assert_eq!(saved[1], ("world/places.rmpl", PLACES.as_bytes()));
    assert_eq!(saved[0].1, MAIN.as_bytes());
}

#[test]
fn a_file_that_is_added_is_imported_and_one_that_nothing_imports_is_an_error() {
    let mut app = start_in(Rc::new(World::default()));
    let source = "// A day.\n\nprimitive Rest()[1,2];\nscenario Day = { Rest() }\n";
    apply(&mut app, vec![Command::SetSource(source.to_owned())]);
    apply(&mut app, vec![Command::Files(FileCommand::Add("world".to_owned()))]);
    let with_import = source.replace("primitive", "import \"world.rmpl\";\n\nprimitive");
    assert_eq!(text(&app), rmpl::files::joined([("", &*with_import), ("world.rmpl", "")]));
    assert_eq!(app.session.state().file_at_caret(), 1);
    assert_eq!(problems(&app), Vec::<String>::new());
    for refused in ["world", "../out", "/etc/passwd", ""] {
        let before = text(&app).to_owned();
        apply(&mut app, vec![Command::Files(FileCommand::Add(refused.to_owned()))]);
        assert_eq!(text(&app), before, "{refused}");
    }
    let alone = text(&app).replace("import \"world.rmpl\";\n", "");
    apply(&mut app, vec![Command::SetSource(alone)]);
    assert_eq!(problems(&app), ["the file `world.rmpl` is never imported"]);
    apply(&mut app, vec![Command::Editor(EditorCommand::Format)]);
    assert_eq!(files(&app)[1..], ["world.rmpl"]);
}

fn forms(save: &Save) -> Vec<(&str, String)> {
    let form = |(name, bytes): &(String, Vec<u8>)| {
        let text = String::from_utf8(bytes.clone()).expect("missions are text");
        (
            name.rsplit_once('.')
                .map_or("", |(_, extension)| if extension == "rmpl" { "text" } else { "whole" }),
            text,
        )
    };
    save.forms.iter().map(form).collect()
}

#[test]
fn a_mission_goes_to_its_file_as_text_or_as_a_whole_where_the_host_can_write_files() {
    let mut app = start_in(Rc::new(World::default()));
    app.world.saves_in_place.set(true);
    let source = "// A day.\nscenario Day = { delay[1,2] }\n";
    apply(&mut app, vec![Command::SetSource(source.to_owned())]);
    apply(&mut app, vec![Command::SaveMission, Command::Library(LibraryCommand::SaveMissionFile)]);
    assert!(app.world.saved.borrow().is_empty(), "nothing is downloaded");
    let [save, save_as] = <[Save; 2]>::try_from(app.world.saved_in_place.take()).expect("two were asked for");
    let id = app.session.state().library.open_id().expect("it is a mission of its own").0.to_string();
    assert_eq!((save.mission.as_str(), save.asks), (id.as_str(), false));
    assert_eq!((save_as.mission.as_str(), save_as.asks), (id.as_str(), true));
    let [text, whole] = &forms(&save)[..] else { panic!("as text or as a whole") };
    assert_eq!(*text, ("text", source.to_owned()));
    assert!(whole.0 == "whole" && whole.1.contains("enroute-mission/1"), "{whole:?}");
    assert_eq!(forms(&save_as).iter().map(|form| form.0).collect::<Vec<_>>(), ["whole", "text"]);

    // It is saved when the file is written, and only as far as the text was written.
    assert!(app.session.state().document.is_modified());
    let saved = |revision| HostEvent::FileSaved { name: "day.rmpl".to_owned(), revision };
    type_text(&mut app, " ");
    app.world.news.borrow_mut().push_back(saved(save.revision));
    app.settle();
    assert!(app.session.state().document.is_modified(), "what was typed since is not in the file");
    apply(&mut app, vec![Command::SaveMission]);
    let again = app.world.saved_in_place.borrow_mut().pop().expect("it is saved again");
    app.world.news.borrow_mut().push_back(HostEvent::FileFailed {
        name: "day.rmpl".to_owned(),
        reason: "the browser was not allowed to write it".to_owned(),
    });
    app.settle();
    assert!(app.session.state().document.is_modified(), "what could not be written is not saved");
    assert!(app.json()["toasts"].to_string().contains("day.rmpl: the browser was not allowed to write it"));
    app.world.news.borrow_mut().push_back(saved(again.revision));
    app.settle();
    assert!(!app.session.state().document.is_modified());
    assert!(app.json()["toasts"].to_string().contains("Saved to day.rmpl"));

    // The text of several files is none.
    apply(&mut app, vec![Command::Files(FileCommand::Add("world".to_owned())), Command::SaveMission]);
    let several = app.world.saved_in_place.borrow_mut().pop().expect("it is saved");
    assert_eq!(forms(&several).iter().map(|form| form.0).collect::<Vec<_>>(), ["whole"]);
}

#[test]
fn a_mission_file_whose_review_says_two_things_is_refused() {
    let mut app = start_in(Rc::new(World::default()));
    app.world.saves_in_place.set(true);
    apply(&mut app, vec![Command::SetSource("scenario Day = { delay[1,2] }\n".to_owned())]);
    apply(&mut app, vec![Command::SaveMission]);
    let save = app.world.saved_in_place.borrow_mut().pop().expect("it is saved");
    let forms = forms(&save);
    let whole = forms[1].1.strip_suffix('}').expect("an object");
    let mut open = |name: &str, text: String| {
        app.world.news.borrow_mut().push_back(HostEvent::FileOpened {
            kind: FileKind::Mission,
            name: name.to_owned(),
            bytes: text.into_bytes(),
            token: None,
        });
        app.settle();
        app.json()["toasts"].to_string()
    };
    let with = |review: &str| format!("{whole},\"review\":{review}}}");
    let told = open("once.enroute", with("{\"entries\":[]}"));
    assert!(!told.contains("damaged"), "{told}");
    let told = open("twice.enroute", with("{\"entries\":[],\"entries\":[]}"));
    assert!(told.contains("duplicate member `entries`"), "{told}");
}

#[test]
fn a_mission_that_was_opened_from_a_file_keeps_it_and_no_other_mission_does() {
    let mut app = start_in(Rc::new(World::default()));
    app.world.saves_in_place.set(true);
    let mut open = |name: &str, text: &str, token| {
        app.world.news.borrow_mut().push_back(HostEvent::FileOpened {
            kind: FileKind::Mission,
            name: name.to_owned(),
            bytes: text.as_bytes().to_vec(),
            token,
        });
        app.settle();
        let id = app.session.state().library.open_id().map(|id| id.0.to_string()).unwrap_or_default();
        (id, app.world.kept_files.take())
    };
    let (first, kept) = open("day.rmpl", MAIN, Some(3));
    assert_eq!(kept, [(first.clone(), 3)]);
    let (still, kept) = open("places.rmpl", PLACES, Some(4));
    assert_eq!((still, kept), (first.clone(), Vec::new()), "a file that joined a mission is not its own");
    let (second, kept) = open("other.rmpl", "scenario Other = { delay[1,2] }\n", Some(5));
    assert_ne!(second, first);
    assert_eq!(kept, [(second, 5)]);
    let (_, kept) = open("noise.txt", "no mission at all", Some(6));
    assert!(kept.is_empty(), "what is not opened is kept by nobody");
}

#[test]
fn an_error_in_another_file_is_announced_with_the_name_and_the_line_of_that_file() {
    let mut app = start_in(Rc::new(World::default()));
    let broken = PLACES.replace("vehicle", "vehicel");
    apply(
        &mut app,
        vec![Command::SetSource(rmpl::files::joined([("", MAIN), ("world/places.rmpl", &*broken)]))],
    );
    let announced = workbench::host_io::announcement(app.session.state());
    assert!(announced.contains("world/places.rmpl, line 2: "), "{announced}");
    let broken = MAIN.replace("primitive", "primitiv");
    apply(
        &mut app,
        vec![Command::SetSource(rmpl::files::joined([("", &*broken), ("world/places.rmpl", PLACES)]))],
    );
    let announced = workbench::host_io::announcement(app.session.state());
    assert!(announced.contains("Line 4: "), "{announced}");
}
