//! The editor's help while someone types: lists that stay, templates, carets, places gone back to.

use test_support::App;
use text_editing::{Motion, TextCommand};
use workbench::PanelKind;
use workbench::command::Command;
use workbench::host_io::Remote as _;
use workbench::state::editor::EditorCommand;
use workbench::state::manual::ManualCommand;

fn showing(source: &str) -> App {
    let mut app = test_support::start();
    app.run(Command::SetSource(source.replace('|', "")));
    let at = source.find('|').unwrap_or(source.len());
    app.run(Command::Text(TextCommand::Select { anchor: at, head: at }));
    app
}

fn type_text(app: &mut App, text: &str) {
    for character in text.chars() {
        app.run(Command::Text(match character {
            '\n' => TextCommand::NewLine,
            '\t' => TextCommand::Indent,
            other => TextCommand::Insert(other.to_string()),
        }));
    }
}

fn listed(app: &App) -> Vec<String> {
    let popup = app.session.state().editor.popup.as_ref();
    popup.map(|popup| popup.items.iter().map(|item| item.label.clone()).collect()).unwrap_or_default()
}

fn take(app: &mut App, label: &str) {
    let at = listed(app).iter().position(|item| item == label);
    let at = at.unwrap_or_else(|| panic!("{label} is not in {:?}", listed(app)));
    app.run(Command::Editor(EditorCommand::TakeFromPopup(Some(at))));
}

#[test]
fn a_list_that_was_asked_for_stays_while_it_is_narrowed() {
    let mut app = showing("primitive Drive()[1,2];\nprimitive Drill()[1,2];\nscenario S = { | }\n");
    app.run(Command::Editor(EditorCommand::Complete));
    assert!(listed(&app).contains(&"choose".to_owned()));
    type_text(&mut app, "D");
    assert_eq!(listed(&app)[..2], ["Drill", "Drive"]);
    for letter in ["r", "i"] {
        type_text(&mut app, letter);
        assert_eq!(listed(&app), ["Drill", "Drive"], "after {letter}");
    }
    app.run(Command::Text(TextCommand::Delete(Motion::Left)));
    assert_eq!(listed(&app), ["Drill", "Drive"]);
    type_text(&mut app, "iv");
    assert_eq!(listed(&app), ["Drive"]);
}

#[test]
fn a_text_in_quotes_lists_the_maps() {
    let mut app = showing("");
    type_text(&mut app, "terrain \"");
    assert!(listed(&app).contains(&"tai-plain".to_owned()), "{:?}", listed(&app));
    type_text(&mut app, "tai");
    take(&mut app, "tai-plain");
    assert_eq!(app.session.source(), "terrain \"tai-plain\"");
}

#[test]
fn a_template_is_filled_in_from_stop_to_stop_with_what_fits_each() {
    let mut app = showing("location BASE (0, 0);\n");
    type_text(&mut app, "vehi");
    take(&mut app, "vehicle");
    type_text(&mut app, "Rover\t");
    assert!(listed(&app).contains(&"ATRV".to_owned()), "{:?}", listed(&app));
    type_text(&mut app, "AT");
    take(&mut app, "ATRV");
    assert!(listed(&app).is_empty(), "what was taken is also the beginning of ATRV-Jr");
    type_text(&mut app, "\t");
    take(&mut app, "BASE");
    type_text(&mut app, "\t");
    assert_eq!(app.session.source(), "location BASE (0, 0);\nvehicle Rover : ATRV at BASE;");
}

#[test]
fn escape_leaves_the_list_then_the_carets_and_nothing_else() {
    let mut app = showing("primitive Drive()[1,2];\nscenario S = { Drive(); Dr| }\n");
    app.run(Command::Editor(EditorCommand::Complete));
    app.run(Command::Text(TextCommand::ToggleCaret(0)));
    app.run(Command::Editor(EditorCommand::Complete));
    assert!(!listed(&app).is_empty());
    app.run(Command::Escape);
    assert!(listed(&app).is_empty());
    assert_eq!(app.session.state().document.carets().len(), 2);
    app.run(Command::Escape);
    assert_eq!(app.session.state().document.carets().len(), 1);
}

#[test]
fn what_is_gone_to_is_gone_back_from_and_forward_again() {
    let mut app = showing("primitive Drive()[1,2];\n\nscenario S = { Dri|ve() }\n");
    let head = |app: &App| app.session.state().document.caret().head;
    let used = head(&app);
    app.run(Command::Editor(EditorCommand::GoToDefinition));
    let declared = head(&app);
    assert!(declared < 20, "{declared}");
    app.run(Command::Editor(EditorCommand::GoToPlace { forwards: false }));
    assert_eq!(head(&app), used);
    app.run(Command::Editor(EditorCommand::GoToPlace { forwards: true }));
    assert_eq!(head(&app), declared);
    app.run(Command::Editor(EditorCommand::GoToPlace { forwards: true }));
    assert_eq!(head(&app), declared, "there is nothing beyond");
}

#[test]
fn a_bracket_leads_to_its_partner_and_back() {
    let mut app = showing("scenario S = |{ delay[1,2] }");
    let head = |app: &App| app.session.state().document.caret().head;
    app.run(Command::Editor(EditorCommand::GoToBracket));
    assert_eq!(&app.session.source()[head(&app)..], "}");
    app.run(Command::Editor(EditorCommand::GoToBracket));
    assert_eq!(head(&app), 13);
}

#[test]
fn a_line_that_was_copied_without_selecting_is_pasted_as_a_line_above() {
    let mut app = showing("one\ntw|o\nthree\n");
    let text = |app: &App| {
        let mut text = app.session.source();
        text.insert(app.session.state().document.caret().head, '|');
        text
    };
    let paste = |text: &str| Command::Text(TextCommand::Paste(text.to_owned()));
    app.run(Command::Editor(EditorCommand::CopySelection { cut: false }));
    assert_eq!(text(&app), "one\ntw|o\nthree\n", "the caret stays");
    app.run(paste("two\r\n"));
    assert_eq!(text(&app), "one\ntwo\ntw|o\nthree\n");
    app.run(paste("other\n"));
    assert_eq!(text(&app), "one\ntwo\ntwother\n|o\nthree\n", "what comes from elsewhere goes to the caret");
    // What is selected is not a line, whatever it holds.
    app.run(Command::Text(TextCommand::Select { anchor: 0, head: 4 }));
    app.run(Command::Editor(EditorCommand::CopySelection { cut: false }));
    app.run(Command::Text(TextCommand::Select { anchor: 1, head: 1 }));
    app.run(paste("one\n"));
    assert_eq!(text(&app), "oone\n|ne\ntwo\ntwother\no\nthree\n");
}

#[test]
fn the_manual_is_asked_about_the_word_at_the_caret_and_about_the_place_under_the_pointer() {
    let source = "var C : {ON, OFF};\nstate S : {A, B} = A;\nresource R capacity 2;\nprimitive P()[2,1] requires S=A uses R;\n\
        scenario S1[0,2*10] = { choose { P(), delay }; do { delay } maintaining C=ON }\n";
    let mut app = test_support::start();
    app.run(Command::OpenSource { name: "test".into(), source: source.to_owned() });
    app.settle();
    let place = |app: &App| {
        let manual = app.json()["manual"].clone();
        format!(
            "{}#{}",
            manual["page"].as_str().unwrap_or_default(),
            manual["section"].as_str().unwrap_or_default()
        )
    };
    let at = |word: &str| source.find(word).expect("a word") + 1;
    for (word, expected) in [
        ("maintaining", "language#conditions"),
        ("S : {A", "language#state-variables"),
        ("capacity", "language#resources"),
        ("choose", "language#statements"),
        ("2*10", "language#bounds"),
        ("2,1]", "diagnostics#e-bounds"),
    ] {
        // By the caret, and by the pointer, wherever the caret is then.
        for hovered in [None, Some(at(word))] {
            let caret = if hovered.is_some() { 0 } else { at(word) };
            app.run(Command::Text(TextCommand::Select { anchor: caret, head: caret }));
            app.run(Command::Editor(EditorCommand::Hover(hovered)));
            app.run(Command::Manual(ManualCommand::About(PanelKind::Editor)));
            let shown = place(&app);
            assert!(shown.starts_with(expected), "{word}, {hovered:?}: {shown}");
        }
    }
    app.run(Command::Editor(EditorCommand::Hover(None)));
    app.run(Command::Manual(ManualCommand::About(PanelKind::Timeline)));
    assert_eq!(place(&app), "timeline-panel#");
}

#[test]
fn what_an_edit_takes_away_is_selected_again_when_it_is_back() {
    let mut app = showing("primitive Dig()[1,2];\nprimitive Rest()[1,2];\nscenario S = { Dig(); Rest() }\n");
    app.dispatch("go.select", &serde_json::json!("Rest#1"));
    let name = |app: &App| app.json()["selection"]["name"].clone();
    app.run(Command::SetSource("primitive Dig()[1,2];\nscenario S = { Dig() }\n".to_owned()));
    assert_eq!(name(&app), serde_json::Value::Null);
    app.run(Command::Text(TextCommand::Undo));
    assert_eq!(name(&app), "Rest#1");
}

#[test]
fn saving_without_a_file_of_its_own_says_what_was_saved() {
    let mut app = test_support::start();
    app.run(Command::SaveMission);
    assert!(app.json()["toasts"].to_string().contains("Saved enroute.rmpl"), "{}", app.json()["toasts"]);
}

#[test]
fn a_file_that_is_added_is_shown_and_typed_into() {
    let mut app = showing("scenario S = { delay[1,2] }\n");
    app.dispatch("file.addFileNamed", &serde_json::json!({ "name": "world" }));
    assert_eq!(app.session.state().file_at_caret(), 1);
    let reveals = app.session.state().window.panel_effects.waiting().iter();
    let end = app.session.state().document.text().len() as u32;
    let shows_it = |effect: &&workbench::PanelEffect| matches!(effect, workbench::PanelEffect::Reveal(reveal) if reveal.span.start == end && reveal.center);
    assert_eq!(reveals.filter(shows_it).count(), 1);
    type_text(&mut app, "// places");
    assert!(app.session.source().ends_with("world.rmpl\n// places"), "{}", app.session.source());
}

#[test]
fn the_name_of_a_placed_location_is_typed_over_it() {
    let mut app = showing("location BASE (0, 0);\n");
    app.session.state_mut().window.panels_on_screen = vec![PanelKind::Editor, PanelKind::Terrain];
    app.session.state_mut().window.active_panel = PanelKind::Terrain;
    let thing = workbench::state::placing::NewThing::Location(nalgebra::Point2::new(3.0, 4.0));
    let place = workbench::state::terrain::TerrainCommand::Place { thing, again: false };
    app.run(Command::Terrain(place));
    assert_eq!(app.session.state().window.active_panel, PanelKind::Editor);
    let focus = workbench::PanelEffect::FocusEditor;
    assert!(app.session.state().window.panel_effects.waiting().contains(&focus));
    type_text(&mut app, "CRATER");
    assert!(app.session.source().contains("location CRATER (3, 4);"), "{}", app.session.source());
}
