//! The library of missions: nothing that was typed is ever lost, whatever happens to the tab or to the storage.

use std::rc::Rc;

use serde_json::{Value, json};
use text_editing::TextCommand;
use workbench::command::Command;
use workbench::host::{FileKind, HostEvent, ShelfRequest};
use workbench::host_io::Remote as _;
use workbench::library::LibraryCommand;
use workbench::library::{Keeping, Mission};

use test_support::host::Shelf;
use test_support::{App, World, start_in};

const EDITED: &str = "Sortie()[l,u] = { Scan()[1,2] }\n";
const OTHER: &str = "Other()[l,u] = { Wait()[1,2] }\n";

fn text_of(app: &App) -> String {
    app.session.state().document.text().to_owned()
}

/// Edits in one frame, a moment later.
fn edit(app: &mut App, text: &str) {
    app.world.now_secs.set(app.world.now_secs.get() + 0.01);
    app.session.apply(vec![Command::SetSource(text.to_owned())]);
    app.step();
}

/// Lets so much time go by that everything is written.
fn wait(app: &mut App) {
    for _ in 0..10 {
        app.world.now_secs.set(app.world.now_secs.get() + 1.0);
        app.step();
    }
}

fn names(app: &App) -> Vec<String> {
    app.session.state().library.missions().iter().map(|mission| mission.name.to_string()).collect()
}

fn toasts(app: &App) -> String {
    app.json()["toasts"].to_string()
}

fn drop_file(app: &mut App, name: &str, bytes: &[u8]) {
    let kind = FileKind::of_name(name);
    app.world.news.borrow_mut().push_back(HostEvent::FileOpened {
        kind,
        name: name.to_owned(),
        bytes: bytes.to_vec(),
        token: None,
    });
    app.settle();
}

#[test]
fn an_edited_example_is_a_mission_of_its_own_and_there_again_in_the_next_run() {
    let world = Rc::new(World::default());
    let mut first = start_in(Rc::clone(&world));
    let original = text_of(&first);
    edit(&mut first, EDITED);
    assert_eq!(first.session.state().mission, "Enroute (copy)");
    drop(first);
    let mut second = start_in(world);
    assert_eq!(text_of(&second), EDITED);
    assert_eq!(second.session.state().mission, "Enroute (copy)");
    // The example is what it was, and choosing it overwrites nothing.
    second.session.apply(vec![Command::OpenExample("enroute".into())]);
    second.step();
    assert_eq!(text_of(&second), original);
    edit(&mut second, OTHER);
    assert_eq!(names(&second), ["Enroute (copy 2)", "Enroute (copy)"]);
}

#[test]
fn each_key_is_kept_in_the_frame_that_takes_it_however_slow_the_shelf_is() {
    for shelf in [Shelf::Works, Shelf::Slow, Shelf::Full, Shelf::Forbidden] {
        let world = Rc::new(World::default());
        world.shelf_does.set(shelf);
        let mut typed = String::new();
        let mut app = start_in(Rc::clone(&world));
        for letter in "abcdefghijklmnopqrstuvwxyz".chars() {
            typed.push(letter);
            edit(&mut app, &typed);
            // The tab dies here, before anything slow is done.
            drop(app);
            app = start_in(Rc::clone(&world));
            assert_eq!(text_of(&app), typed, "{shelf:?}");
        }
        assert_eq!(names(&app), ["Enroute (copy)"], "{shelf:?}");
    }
}

#[test]
fn random_disturbances_lose_no_key() {
    for seed in 1..=20_u64 {
        let mut random = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut next = |below: u64| {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            random % below
        };
        let world = Rc::new(World::default());
        let mut typed = String::from("x");
        let mut app = start_in(Rc::clone(&world));
        edit(&mut app, &typed);
        for step in 0..50 {
            match next(8) {
                0 => {
                    drop(app);
                    app = start_in(Rc::clone(&world));
                }
                1 => world.shelf_does.set(Shelf::Slow),
                2 => world.let_shelf_answer(),
                3 => world.shelf_does.set(Shelf::Full),
                4 => world.shelf_does.set(Shelf::Forbidden),
                5 => wait(&mut app),
                _ => {}
            }
            typed.push(char::from(b'a' + next(26) as u8));
            edit(&mut app, &typed);
            assert_eq!(text_of(&app), typed, "seed {seed}, step {step}");
        }
        drop(app);
        assert_eq!(text_of(&start_in(world)), typed, "seed {seed}");
    }
}

#[test]
fn a_shelf_that_does_not_open_is_said_to_fail_and_taken_in_when_it_opens_after_all() {
    for is_named_by_address in [true, false] {
        let world = Rc::new(World::default());
        let mut app = start_in(Rc::clone(&world));
        edit(&mut app, EDITED);
        wait(&mut app);
        drop(app);
        world.storage.borrow_mut().clear();
        if !is_named_by_address {
            world.fragment.borrow_mut().clear();
        }
        let address = world.fragment.borrow().clone();
        world.shelf_does.set(Shelf::Slow);
        let mut app = start_in(Rc::clone(&world));
        wait(&mut app);
        assert_eq!(app.session.state().library.keeping, Keeping::Opening);
        wait(&mut app);
        let reason = "storage is not available: the browser's database doesn't respond";
        assert_eq!(app.session.state().library.keeping, Keeping::LatestOnly(reason.to_owned()));
        assert!(toasts(&app).contains(reason), "{}", toasts(&app));
        assert_eq!(*world.fragment.borrow(), address);
        world.let_shelf_answer();
        wait(&mut app);
        assert_eq!(app.session.state().library.keeping, Keeping::Kept);
        assert_eq!(text_of(&app), EDITED);
    }
}

#[test]
fn what_is_opened_while_the_shelf_opens_stays_open() {
    let world = Rc::new(World::default());
    let mut app = start_in(Rc::clone(&world));
    edit(&mut app, EDITED);
    wait(&mut app);
    drop(app);
    world.storage.borrow_mut().clear();
    world.shelf_does.set(Shelf::Slow);
    let mut app = start_in(Rc::clone(&world));
    wait(&mut app);
    app.session.apply(vec![Command::OpenExample("backjump".into())]);
    app.step();
    assert_eq!(*world.fragment.borrow(), "mission=backjump");
    world.let_shelf_answer();
    wait(&mut app);
    assert_eq!(app.session.state().mission, "backjump");
    assert_eq!(names(&app), ["Enroute (copy)"]);
}

#[test]
fn without_the_small_place_the_shelf_keeps_what_is_typed() {
    let world = Rc::new(World::default());
    let mut app = start_in(Rc::clone(&world));
    edit(&mut app, EDITED);
    wait(&mut app);
    world.storage.borrow_mut().clear();
    drop(app);
    world.fragment.borrow_mut().clear();
    let app = start_in(Rc::clone(&world));
    assert_eq!(names(&app), ["Enroute (copy)"]);
    assert_eq!(text_of(&app), EDITED);
    assert!(toasts(&app).contains("Restored “Enroute (copy)”"), "{}", toasts(&app));
}

/// A browser writes the small place to its disk seconds later, and a kill takes what it has not written.
#[test]
fn a_killed_browser_finds_each_key_and_the_open_mission_on_the_shelf() {
    let world = Rc::new(World::default());
    let mut typed = String::new();
    let mut app = start_in(Rc::clone(&world));
    for letter in "abcdefghij".chars() {
        typed.push(letter);
        edit(&mut app, &typed);
        world.storage.borrow_mut().clear();
        drop(app);
        app = start_in(Rc::clone(&world));
        assert_eq!(text_of(&app), typed);
    }
    assert_eq!(names(&app), ["Enroute (copy)"]);
}

/// A browser may put a page away, and open another one, before there is a frame.
#[test]
fn what_is_asked_from_outside_is_kept_without_a_frame() {
    let world = Rc::new(World::default());
    let mut app = start_in(Rc::clone(&world));
    app.session.set_source("one");
    assert_eq!(text_of(&start_in(Rc::clone(&world))), "one");
    app.session.dispatch("edit.undo", &json!({})).expect("a command");
    let undone = text_of(&app);
    assert_ne!(undone, "one");
    assert_eq!(text_of(&start_in(world)), undone);
}

#[test]
fn what_no_frame_has_taken_in_is_written_ahead_of_it_and_given_up_for_what_the_frame_has() {
    let typing = |world: &Rc<World>| {
        let mut app = start_in(Rc::clone(world));
        edit(&mut app, "one ");
        wait(&mut app);
        app.dispatch("edit.select", &json!({ "start": 4 }));
        app.step();
        app.session.keep_ahead(&[TextCommand::Insert("tw".to_owned()), TextCommand::Insert("o".to_owned())]);
        app
    };
    // Nothing but the shelf is left of it.
    let world = Rc::new(World::default());
    assert_eq!(text_of(&typing(&world)), "one ");
    assert_eq!(text_of(&start_in(world)), "one two");
    // The frame finds that the keys went elsewhere.
    let world = Rc::new(World::default());
    let mut app = typing(&world);
    wait(&mut app);
    assert_eq!(text_of(&start_in(world)), "one ");
}

#[test]
fn what_is_typed_waits_for_the_shelf_only_a_moment() {
    let world = Rc::new(World::default());
    let mut app = start_in(Rc::clone(&world));
    edit(&mut app, "a");
    wait(&mut app);
    world.shelf_does.set(Shelf::Slow);
    let asked = || {
        let waits = world.shelf_waits.borrow();
        let keys = waits.iter().filter_map(|(_, request)| match request {
            Some(ShelfRequest::Write { key, .. }) => Some(key.clone()),
            _ => None,
        });
        keys.filter(|key| key.starts_with("typed/")).count()
    };
    // The first key at once, those after it not while it is being written.
    edit(&mut app, "ab");
    assert_eq!(asked(), 1);
    edit(&mut app, "abc");
    edit(&mut app, "abcd");
    assert_eq!(asked(), 1);
    world.now_secs.set(world.now_secs.get() + 0.1);
    app.step();
    assert_eq!(asked(), 2);
    // As soon as the shelf has answered, the next one.
    edit(&mut app, "abcde");
    assert_eq!(asked(), 2);
    world.let_shelf_answer();
    app.step();
    let kept = world.shelf.borrow();
    let (_, typed) = kept.iter().find(|(key, _)| key.starts_with("typed/")).expect("the texts");
    assert!(String::from_utf8_lossy(typed).contains("\"abcde\""));
}

#[test]
fn damage_is_noticed_and_another_copy_leaves_it_aside() {
    let world = Rc::new(World::default());
    let mut app = start_in(Rc::clone(&world));
    edit(&mut app, EDITED);
    wait(&mut app);
    drop(app);
    world.storage.borrow_mut().clear();
    let key =
        world.shelf.borrow().keys().find(|key| key.starts_with("mission/")).cloned().expect("a mission");
    let whole = world.shelf.borrow()[&key].clone();
    // One letter of the text is another one; the JSON is as good as before.
    let damaged = String::from_utf8_lossy(&whole).replace("Sortie", "Sortje").into_bytes();
    assert_ne!(damaged, whole);
    world.shelf.borrow_mut().insert(key.clone(), damaged.clone());
    let app = start_in(Rc::clone(&world));
    assert_eq!(names(&app), Vec::<String>::new());
    assert!(app.session.state().library.unreadable[0].reason.contains("checksum"));
    drop(app);
    // With its texts elsewhere the mission is there, and what was damaged is not written over.
    world.shelf.borrow_mut().insert(key.replace("mission/", "typed/"), whole);
    let mut app = start_in(Rc::clone(&world));
    assert_eq!(text_of(&app), EDITED);
    wait(&mut app);
    assert_eq!(world.shelf.borrow()[&format!("aside/{key}")], damaged);
    assert_eq!(app.json()["library"]["unreadable"], 1);
    drop(app);
    assert_eq!(text_of(&start_in(world)), EDITED);
}

#[test]
fn a_private_window_says_that_missions_are_not_kept() {
    let world = Rc::new(World::default());
    let mut app = start_in(Rc::clone(&world));
    world.news.borrow_mut().push_back(HostEvent::PrivateWindow);
    app.step();
    assert_eq!(app.json()["library"]["keeping"], "until-closed");
    assert!(toasts(&app).contains("Private window"), "{}", toasts(&app));
}

#[test]
fn an_address_of_before_the_edit_leads_to_the_mission_all_the_same() {
    let world = Rc::new(World::default());
    let mut app = start_in(Rc::clone(&world));
    edit(&mut app, EDITED);
    drop(app);
    // The browser was killed before it wrote the address down.
    "mission=enroute".clone_into(&mut world.fragment.borrow_mut());
    let app = start_in(Rc::clone(&world));
    assert!(toasts(&app).contains("“Enroute (copy)”, which you edited last"), "{}", toasts(&app));
    drop(app);
    // A mission of long ago is not what was lost.
    world.now_secs.set(world.now_secs.get() + 3600.0);
    assert!(!toasts(&start_in(world)).contains("which you edited last"));
}

#[test]
fn a_byte_order_mark_is_removed_and_another_encoding_is_named() {
    let mut app = test_support::start();
    drop_file(&mut app, "marked.rmpl", format!("\u{feff}{EDITED}").as_bytes());
    assert_eq!(text_of(&app), EDITED);
    drop_file(&mut app, "latin.rmpl", b"// one\n// M\xfcnchen\nA()[l,u] = { Scan()[1,2] }\n");
    assert_eq!(text_of(&app), EDITED);
    let told = toasts(&app);
    assert!(told.contains("line 2 is not UTF-8") && told.contains("Latin-1"), "{told}");
    let wide: Vec<u8> = "\u{feff}A()".encode_utf16().flat_map(u16::to_le_bytes).collect();
    drop_file(&mut app, "wide.rmpl", &wide);
    assert!(toasts(&app).contains("UTF-16"), "{}", toasts(&app));
}

#[test]
fn what_the_shelf_has_is_not_kept_twice() {
    let world = Rc::new(World::default());
    let mut app = start_in(Rc::clone(&world));
    edit(&mut app, EDITED);
    let small = || world.storage.borrow().keys().filter(|key| key.contains("writing")).count();
    assert_eq!(small(), 1);
    wait(&mut app);
    assert_eq!(small(), 0);
    let shelf = world.shelf.borrow();
    let keys: Vec<&str> = shelf.keys().map(|key| key.split('/').next().unwrap_or_default()).collect();
    assert_eq!(keys, ["mission", "open"]);
}

#[test]
fn an_address_that_names_a_mission_wins_and_the_other_one_stays_in_the_library() {
    let world = Rc::new(World::default());
    let mut first = start_in(Rc::clone(&world));
    edit(&mut first, EDITED);
    drop(first);
    "mission=threats&workspace=review".clone_into(&mut world.fragment.borrow_mut());
    let mut second = start_in(Rc::clone(&world));
    assert_ne!(text_of(&second), EDITED);
    edit(&mut second, OTHER);
    // Loading the page again with the address as it is now brings the edited text, not the example.
    assert!(world.fragment.borrow().starts_with("open="), "{}", world.fragment.borrow());
    assert!(world.fragment.borrow().ends_with("workspace=review"), "{}", world.fragment.borrow());
    drop(second);
    let third = start_in(world);
    assert_eq!(text_of(&third), OTHER);
    assert_eq!(names(&third), ["Threats (copy)", "Enroute (copy)"]);
}

#[test]
fn a_second_link_leaves_what_was_made_of_the_first() {
    let world = Rc::new(World::default());
    let link = |text: &str| {
        let mut app = start_in(Rc::default());
        app.run(Command::OpenSource { name: "any".into(), source: text.to_owned() });
        workbench::host_io::fragment(app.session.state())
    };
    for (number, text) in ["A()[l,u] = { Scan()[1,2] }\n", "B()[l,u] = { Scan()[1,2] }\n"].iter().enumerate()
    {
        link(text).clone_into(&mut world.fragment.borrow_mut());
        let mut app = start_in(Rc::clone(&world));
        assert_eq!(text_of(&app), *text);
        edit(&mut app, &format!("// {number}\n{text}"));
        drop(app);
        assert!(text_of(&start_in(Rc::clone(&world))).starts_with(&format!("// {number}\n")));
    }
    let app = start_in(world);
    assert_eq!(names(&app), ["shared 2", "shared"]);
}

#[test]
fn an_example_that_was_not_edited_is_no_mission_of_the_library() {
    let world = Rc::new(World::default());
    let mut first = start_in(Rc::clone(&world));
    first.session.apply(vec![Command::OpenExample("backjump".into())]);
    first.settle();
    assert!(names(&first).is_empty());
    drop(first);
    world.fragment.borrow_mut().clear();
    let again = start_in(world);
    assert!(names(&again).is_empty());
    assert_eq!(again.session.state().mission, "backjump", "it was open last");
}

#[test]
fn a_full_storage_is_said_once_and_the_text_stays() {
    let world = Rc::new(World::default());
    world.is_full.set(true);
    let mut app = start_in(Rc::clone(&world));
    edit(&mut app, EDITED);
    wait(&mut app);
    assert!(matches!(app.session.state().library.keeping, Keeping::Nothing(_)));
    assert_eq!(app.json()["library"]["keeping"], "nothing");
    edit(&mut app, OTHER);
    assert_eq!(text_of(&app), OTHER);
    // As soon as there is room, everything is kept again.
    world.is_full.set(false);
    wait(&mut app);
    assert_eq!(app.session.state().library.keeping, Keeping::Kept);
    drop(app);
    assert_eq!(text_of(&start_in(world)), OTHER);
}

#[test]
fn a_full_storage_is_told() {
    let world = Rc::new(World::default());
    world.is_full.set(true);
    let mut app = start_in(world);
    edit(&mut app, EDITED);
    app.settle();
    let state = app.json();
    let toasts = state["toasts"].as_array().cloned().unwrap_or_default();
    assert_eq!(
        toasts.iter().filter(|it| it.to_string().contains("mission to a file")).count(),
        1,
        "{toasts:?}"
    );
}

#[test]
fn what_cannot_be_read_stays_where_it_is_and_can_be_saved() {
    let world = Rc::new(World::default());
    let later = br#"{"format": "enroute-mission/9", "id": "7", "soul": 1}"#.to_vec();
    world.shelf.borrow_mut().insert("mission/7".to_owned(), later.clone());
    world.shelf.borrow_mut().insert("mission/8".to_owned(), b"{\"format\":\"enroute-mission/1\",".to_vec());
    world.storage.borrow_mut().insert("enroute/writing-1/9/1".to_owned(), "torn".to_owned());
    let mut app = start_in(Rc::clone(&world));
    assert_eq!(app.json()["library"]["unreadable"], 3);
    edit(&mut app, EDITED);
    wait(&mut app);
    assert_eq!(world.shelf.borrow()["mission/7"], later);
    assert_eq!(world.storage.borrow()["enroute/writing-1/9/1"], "torn");
    let at = app.session.state().library.unreadable.iter().position(|it| it.key == "mission/7");
    app.run(Command::Library(LibraryCommand::SaveUnreadable(at.expect("it was found"))));
    assert_eq!(world.saved.borrow()[0], ("mission-7.json".to_owned(), later));
}

#[test]
fn settings_that_cannot_be_read_are_kept_aside() {
    let world = Rc::new(World::default());
    let later = r#"{"text_scale": "huge"}"#;
    world.storage.borrow_mut().insert("enroute/settings-1".to_owned(), later.to_owned());
    let mut app = start_in(Rc::clone(&world));
    app.dispatch("view.workspace", &json!({ "name": "teach" }));
    app.dispatch("view.textLarger", &Value::Null);
    assert_ne!(world.storage.borrow()["enroute/settings-1"], later);
    assert_eq!(world.storage.borrow()["enroute/settings-1/aside"], later);
}

#[test]
fn missions_are_begun_named_copied_deleted_and_brought_back() {
    let mut app = test_support::start();
    app.dispatch("file.new", &Value::Null);
    assert_eq!(text_of(&app), "");
    edit(&mut app, EDITED);
    app.dispatch("file.renameTo", &json!({ "name": "  Sol 12  " }));
    assert_eq!(names(&app), ["Sol 12"]);
    app.dispatch("file.duplicate", &Value::Null);
    edit(&mut app, OTHER);
    assert_eq!(names(&app), ["Sol 12 (copy)", "Sol 12"]);
    app.dispatch("file.delete", &Value::Null);
    // What was before it is open again.
    assert_eq!((names(&app), text_of(&app)), (vec!["Sol 12".to_owned()], EDITED.to_owned()));
    app.dispatch("file.delete", &Value::Null);
    assert_eq!(app.session.state().mission, "both-paths");
    app.dispatch("file.restore", &Value::Null);
    app.dispatch("file.restore", &Value::Null);
    assert_eq!(names(&app).len(), 2);
    assert!(app.session.dispatch("file.restore", &Value::Null).is_err());
    // A deleted one is still there after the tab was closed.
    app.dispatch("file.delete", &Value::Null);
    let world = Rc::clone(&app.world);
    drop(app);
    let mut app = start_in(world);
    app.dispatch("file.restore", &Value::Null);
    assert_eq!(names(&app).len(), 2);
}

#[test]
fn an_example_cannot_be_deleted_and_a_name_makes_it_a_mission_of_its_own() {
    let mut app = test_support::start();
    assert!(app.session.dispatch("file.delete", &Value::Null).is_err());
    app.dispatch("file.renameTo", &json!({ "name": "Mine" }));
    assert_eq!(names(&app), ["Mine"]);
    assert_eq!(app.json()["mission"], "Mine");
}

#[test]
fn every_template_reads_without_errors_and_has_a_plan() {
    let mut app = test_support::start();
    for template in workbench::library::TEMPLATES {
        app.dispatch("file.newFrom", &json!({ "name": template.name }));
        let state = app.json();
        let is_empty = template.source.is_empty();
        assert!(is_empty || state["diagnostics"] == json!([]), "{}: {}", template.name, state["diagnostics"]);
        let wanted = if is_empty { "empty" } else { "plan" };
        assert_eq!(state["status"], wanted, "{}: {}", template.name, state["failure"]);
    }
    app.dispatch("file.newFrom", &json!({ "name": "threats" }));
    assert_eq!(app.json()["mission"], "Threats (copy)");
}

#[test]
fn the_history_of_a_mission_stays_while_another_one_is_open() {
    let mut app = test_support::start();
    app.dispatch("file.new", &Value::Null);
    edit(&mut app, EDITED);
    edit(&mut app, OTHER);
    let id = app.json()["library"]["open"].clone();
    app.session.apply(vec![Command::OpenExample("threats".into())]);
    app.settle();
    app.dispatch("file.openMission", &json!({ "id": id }));
    assert_eq!(text_of(&app), OTHER);
    app.dispatch("edit.undo", &Value::Null);
    assert_eq!(text_of(&app), EDITED);
    assert_eq!(app.json()["answeredRevision"], app.json()["revision"]);
}

#[test]
fn versions_are_kept_and_brought_back_as_an_edit() {
    let mut app = test_support::start();
    edit(&mut app, EDITED);
    app.dispatch("file.keepVersionAs", &json!({ "name": "before the storm" }));
    edit(&mut app, OTHER);
    wait(&mut app);
    let world = Rc::clone(&app.world);
    drop(app);
    let mut app = start_in(world);
    assert_eq!(app.json()["library"]["missions"][0]["versions"], json!(["before the storm"]));
    app.run(Command::Library(LibraryCommand::RestoreVersion(0)));
    assert_eq!(text_of(&app), EDITED);
    app.dispatch("edit.undo", &Value::Null);
    assert_eq!(text_of(&app), OTHER);
}

#[test]
fn two_tabs_on_one_mission_agree() {
    let world = Rc::new(World::default());
    let mut first = start_in(Rc::clone(&world));
    edit(&mut first, EDITED);
    let mut second = start_in(Rc::clone(&world));
    assert_eq!(text_of(&second), EDITED);
    for number in 0..4 {
        edit(&mut first, &format!("// {number}\n{EDITED}"));
        second.step();
        assert_eq!(text_of(&second), text_of(&first));
        edit(&mut second, &format!("// {number}, and more\n{EDITED}"));
        first.step();
        assert_eq!(text_of(&first), text_of(&second));
    }
    second.dispatch("file.renameTo", &json!({ "name": "Ours" }));
    first.step();
    assert_eq!(first.session.state().mission, "Ours");
    wait(&mut first);
    assert!(!toasts(&first).contains("another tab"), "{}", toasts(&first));
}

#[test]
fn two_tabs_that_do_not_agree_say_so_and_keep_both() {
    let world = Rc::new(World::default());
    let mut first = start_in(Rc::clone(&world));
    edit(&mut first, EDITED);
    let mut second = start_in(Rc::clone(&world));
    second.step();
    // Both are edited before one has heard of the other.
    first.session.apply(vec![Command::SetSource("// one".to_owned())]);
    second.session.apply(vec![Command::SetSource("// two".to_owned())]);
    first.session.end_frame(None);
    second.session.end_frame(None);
    first.step();
    second.step();
    assert_eq!((text_of(&first).as_str(), text_of(&second).as_str()), ("// one", "// two"));
    assert!(toasts(&first).contains("another tab"), "{}", toasts(&first));
    let versions = |app: &App| -> Vec<String> {
        let library = &app.session.state().library;
        let mission = library.open_mission().expect("it is open");
        mission.versions.iter().map(|version| version.texts[0].text.clone()).collect()
    };
    assert!(versions(&first).contains(&"// two".to_owned()));
    assert!(versions(&second).contains(&"// one".to_owned()));
}

#[test]
fn a_slow_shelf_brings_the_missions_later_and_the_last_one_opens_if_nobody_typed() {
    let world = Rc::new(World::default());
    let mut first = start_in(Rc::clone(&world));
    edit(&mut first, EDITED);
    wait(&mut first);
    drop(first);
    world.fragment.borrow_mut().clear();
    world.shelf_does.set(Shelf::Slow);
    let mut second = start_in(Rc::clone(&world));
    assert_eq!(second.session.state().mission, "both-paths");
    world.let_shelf_answer();
    second.step();
    assert_eq!(text_of(&second), EDITED);
    drop(second);
    world.fragment.borrow_mut().clear();
    world.shelf_does.set(Shelf::Slow);
    let mut third = start_in(Rc::clone(&world));
    edit(&mut third, OTHER);
    world.let_shelf_answer();
    third.step();
    assert_eq!(text_of(&third), OTHER);
    assert_eq!(names(&third).len(), 2);
}

#[test]
fn a_file_that_is_no_mission_opens_nothing() {
    let mut app = test_support::start();
    edit(&mut app, EDITED);
    for (name, bytes) in [
        ("notes.txt", b"Buy milk.".as_slice()),
        ("README", b"# A program"),
        ("photo.rmpl", b"\xff\xfe\x00"),
        ("torn.enroute", b"{\"format\":\"enroute-mission/1\",\"id\":"),
    ] {
        drop_file(&mut app, name, bytes);
        assert_eq!(text_of(&app), EDITED, "{name}");
        assert!(toasts(&app).contains(name), "{name}: {}", toasts(&app));
    }
    assert_eq!(names(&app).len(), 1);
    // One that reads as a mission opens as one of its own.
    drop_file(&mut app, "other.txt", OTHER.as_bytes());
    assert_eq!(text_of(&app), OTHER);
    assert_eq!(names(&app), ["other", "Enroute (copy)"]);
}

#[test]
fn one_file_holds_a_whole_mission_with_its_map_its_versions_and_its_review() {
    let map = b"P2 2 2 255 0 0 0 0".as_slice();
    let mut app = test_support::start();
    drop_file(&mut app, "yard.pgm", map);
    edit(&mut app, "terrain \"yard.pgm\" cell 1;\nprimitive A()[1,2];\nscenario S[0,9] = { A() }\n");
    app.settle();
    app.dispatch("file.keepVersionAs", &json!({ "name": "first" }));
    app.dispatch("review.createKey", &json!({ "name": "Ada" }));
    app.dispatch("review.comment", &json!({ "author": "Ada", "text": "Why so late?" }));
    app.dispatch("file.renameTo", &json!({ "name": "Yard" }));
    app.dispatch("file.saveAs", &Value::Null);
    let (name, bytes) = app.world.saved.borrow()[0].clone();
    assert_eq!(name, "Yard.enroute");

    let mut elsewhere = test_support::start();
    drop_file(&mut elsewhere, &name, &bytes);
    let state = elsewhere.json();
    assert_eq!(state["mission"], "Yard");
    assert_eq!((&state["status"], &state["diagnostics"]), (&json!("plan"), &json!([])));
    assert_eq!(state["library"]["missions"][0]["maps"], json!(["yard.pgm"]));
    assert_eq!(state["library"]["missions"][0]["versions"], json!(["first"]));
    assert!(elsewhere.session.state().review.record().to_json().contains("Why so late?"));
    let whole = Mission::from_json(&String::from_utf8(bytes).expect("text")).expect("a mission");
    assert_eq!(whole.maps[0].bytes.as_deref(), Some(map));
}

#[test]
fn imported_maps_are_there_again_in_the_next_run() {
    let world = Rc::new(World::default());
    let mut app = start_in(Rc::clone(&world));
    drop_file(&mut app, "yard.pgm", b"P2 2 2 255 0 0 0 0");
    edit(&mut app, "terrain \"yard.pgm\" cell 1;\nprimitive A()[1,2];\nscenario S[0,9] = { A() }\n");
    wait(&mut app);
    assert_eq!(app.json()["status"], "plan", "{}", app.json()["diagnostics"]);
    drop(app);
    let mut app = start_in(world);
    app.settle();
    assert_eq!(app.json()["status"], "plan", "{}", app.json()["diagnostics"]);
}

#[test]
fn what_an_earlier_version_kept_becomes_a_mission() {
    let world = Rc::new(World::default());
    let draft = json!({ "name": "enroute", "source": EDITED }).to_string();
    world.storage.borrow_mut().insert("enroute/draft-1".to_owned(), draft);
    let app = start_in(Rc::clone(&world));
    assert_eq!((names(&app), text_of(&app)), (vec!["Enroute (copy)".to_owned()], EDITED.to_owned()));
    drop(app);
    assert_eq!(names(&start_in(world)), ["Enroute (copy)"]);
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

/// A new tab has no address.
fn new_tab(world: &Rc<World>) -> App {
    world.fragment.borrow_mut().clear();
    world.now_secs.set(world.now_secs.get() + 60.0);
    let mut app = start_in(Rc::clone(world));
    wait(&mut app);
    app
}

#[test]
fn a_new_tab_opens_what_was_open_last_be_it_a_mission_or_an_example() {
    let world = Rc::new(World::default());
    let mut app = new_tab(&world);
    assert_eq!(app.json()["mission"], "enroute", "nothing was open before");
    app.run(Command::OpenExample("storm".into()));
    wait(&mut app);
    let app = new_tab(&world);
    assert_eq!(app.json()["mission"], "storm");
    drop(app);
    let mut app = new_tab(&world);
    edit(&mut app, EDITED);
    wait(&mut app);
    drop(app);
    let mut app = new_tab(&world);
    assert_eq!(text_of(&app), EDITED, "the mission was open later");
    // A slow shelf brings the mission after the start.
    app.run(Command::OpenExample("sol".into()));
    wait(&mut app);
    drop(app);
    world.shelf_does.set(Shelf::Slow);
    let mut app = new_tab(&world);
    assert_eq!(app.json()["mission"], "sol");
    world.let_shelf_answer();
    wait(&mut app);
    assert_eq!(app.json()["mission"], "sol", "what came from the shelf is older");
    app.run(Command::Library(LibraryCommand::Open(app.session.state().library.missions()[0].id.clone())));
    wait(&mut app);
    drop(app);
    world.shelf_does.set(Shelf::Slow);
    let mut app = new_tab(&world);
    world.let_shelf_answer();
    wait(&mut app);
    assert_eq!(text_of(&app), EDITED);
}

#[test]
fn a_layout_has_a_name_and_is_of_no_lesson() {
    let mut app = start_in(Rc::new(World::default()));
    app.session.dispatch("view.saveLayout", &json!("  ")).expect_err("it has no name");
    app.run(Command::Library(LibraryCommand::SaveLayout(" ".to_owned())));
    assert!(toasts(&app).contains("A layout needs a name"), "{}", toasts(&app));
    app.dispatch("learn.open", &json!("first-line"));
    app.dispatch("view.saveLayout", &json!("Mine"));
    assert!(toasts(&app).contains("Close the lesson to save a layout"), "{}", toasts(&app));
    assert!(app.session.state().library.missions().is_empty(), "the lesson's text is not in the library");
}
