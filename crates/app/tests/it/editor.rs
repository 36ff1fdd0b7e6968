//! The editor as an author meets it: typing, undoing, finding, completing, fixing, renaming.

use crate::support;
use egui::{Event, ImeEvent, Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use serde_json::json;
use text_editing::TextCommand;
use workbench::command::Command;
use workbench::host_io::Remote as _;

use crate::support::App;

const TEXT: Role = egui::Role::MultilineTextInput;
type Role = egui::Role;

/// The app with `text` in the focused editor, and the caret where `$0` stands.
fn editing(text: &str) -> App {
    let mut app = support::start();
    app.settle();
    let caret = text.find("$0");
    let source = text.replacen("$0", "", 1);
    app.harness.state_mut().run(Command::OpenSource { name: "test".into(), source });
    app.harness.get_by_role_and_label(TEXT, "Mission text").focus();
    app.settle();
    if let Some(caret) = caret {
        app.harness.state_mut().run(Command::Text(TextCommand::Select { anchor: caret, head: caret }));
        app.settle();
    }
    app
}

impl Typing for App {
    fn type_text(&mut self, text: &str) {
        for character in text.chars() {
            if character == '\n' {
                self.harness.key_press(Key::Enter);
            } else {
                self.harness.event(Event::Text(character.to_string()));
            }
            self.settle();
        }
    }

    /// The text with `$0` at the caret.
    fn text(&self) -> String {
        let mut text = self.harness.state().source();
        let head = self.json()["caret"]["head"].as_u64().expect("an offset") as usize;
        text.insert_str(head, "$0");
        text
    }

    fn press(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.settle();
    }
}

trait Typing {
    fn type_text(&mut self, text: &str);
    fn text(&self) -> String;
    fn press(&mut self, modifiers: Modifiers, key: Key);
}

const NONE: Modifiers = Modifiers::NONE;
const CTRL: Modifiers = Modifiers::COMMAND;
const SHIFT: Modifiers = Modifiers::SHIFT;

#[test]
fn typed_characters_go_where_the_caret_is_even_several_in_one_frame() {
    let mut app = editing("var X : {A$0};");
    for character in [",", " ", "B"] {
        app.harness.event(Event::Text(character.to_owned()));
    }
    app.settle();
    assert_eq!(app.text(), "var X : {A, B$0};");
}

#[test]
fn a_press_and_release_within_one_frame_places_the_caret_and_takes_the_keys() {
    let mut app = editing("$0first\nsecond\nthird");
    let area = app.harness.get_by_role_and_label(TEXT, "Mission text").rect();
    app.harness.ctx.memory_mut(egui::Memory::stop_text_input);
    app.settle();
    let pos = egui::pos2(area.center().x, area.top() + 30.0);
    for pressed in [true, false] {
        let button = egui::PointerButton::Primary;
        app.harness.event(Event::PointerButton { pos, button, pressed, modifiers: NONE });
    }
    app.settle();
    app.type_text("!");
    assert_eq!(app.text(), "first\nsecond!$0\nthird");
}

#[test]
fn undo_takes_back_a_word_and_redo_brings_it_again() {
    let mut app = editing("$0");
    app.type_text("one two");
    app.press(CTRL, Key::Z);
    assert_eq!(app.text(), "one $0");
    app.press(CTRL, Key::Z);
    assert_eq!(app.text(), "$0");
    app.press(CTRL | SHIFT, Key::Z);
    app.press(CTRL | SHIFT, Key::Z);
    assert_eq!(app.text(), "one two$0");
}

#[test]
fn a_new_line_behind_a_brace_is_indented() {
    let mut app = editing("scenario S = {$0}");
    app.press(NONE, Key::Enter);
    assert_eq!(app.text(), "scenario S = {\n  $0\n}");
}

#[test]
fn lines_are_commented_out_and_in_again() {
    let mut app = editing("scenario S = {\n  $0A();\n}");
    app.press(CTRL, Key::Slash);
    assert_eq!(app.harness.state().source(), "scenario S = {\n  // A();\n}");
    app.press(CTRL, Key::Slash);
    assert_eq!(app.harness.state().source(), "scenario S = {\n  A();\n}");
}

#[test]
fn the_clipboard_cuts_and_pastes_the_selection() {
    let mut app = editing("$0one two");
    app.press(SHIFT | CTRL, Key::ArrowRight);
    app.harness.event(Event::Cut);
    app.settle();
    assert_eq!(app.text(), "$0 two");
    app.harness.event(Event::Paste("three".to_owned()));
    app.settle();
    assert_eq!(app.text(), "three$0 two");
}

#[test]
fn text_being_composed_is_no_part_of_the_document_until_it_is_committed() {
    let mut app = editing("// $0");
    let preedit =
        |text: &str| Event::Ime(ImeEvent::Preedit { text: text.to_owned(), active_range_chars: None });
    app.harness.event(preedit("´"));
    app.settle();
    assert_eq!(app.text(), "// $0");
    app.harness.event(Event::Ime(ImeEvent::Commit("é".to_owned())));
    app.settle();
    assert_eq!(app.text(), "// é$0");
}

#[test]
fn completion_offers_the_values_of_a_variable_and_tab_takes_the_chosen_one() {
    let mut app = editing("var LAMP : {ON, OFF};\nscenario S = { LAMP$0 }");
    app.type_text("=");
    app.harness.get_by_role_and_label(Role::ListBoxOption, "ON");
    app.harness.get_by_role_and_label(Role::ListBoxOption, "OFF");
    app.press(NONE, Key::ArrowDown);
    app.press(NONE, Key::Tab);
    let text = app.harness.state().source();
    assert!(text.contains("LAMP=ON }") || text.contains("LAMP=OFF }"), "{text}");
    assert!(app.harness.query_by_role_and_label(Role::ListBoxOption, "ON").is_none());
}

#[test]
fn a_click_on_a_completion_takes_it_and_the_text_keeps_the_keyboard() {
    let mut app = editing("var LAMP : {ON, OFF};\nscenario S = { LAMP$0 }");
    app.type_text("=");
    app.harness.get_by_role_and_label(Role::ListBoxOption, "OFF").click();
    app.settle();
    assert_eq!(app.text(), "var LAMP : {ON, OFF};\nscenario S = { LAMP=OFF$0 }");
    app.type_text("!");
    assert_eq!(app.text(), "var LAMP : {ON, OFF};\nscenario S = { LAMP=OFF!$0 }");
}

#[test]
fn escape_closes_the_completions_and_leaves_the_text() {
    let mut app = editing("primitive Drive(to);\nscenario S = { $0 }");
    app.press(CTRL, Key::Space);
    app.harness.get_by_role_and_label(Role::ListBoxOption, "Drive");
    app.press(NONE, Key::Escape);
    assert!(app.harness.query_by_role_and_label(Role::ListBoxOption, "Drive").is_none());
    assert_eq!(app.text(), "primitive Drive(to);\nscenario S = { $0 }");
}

#[test]
fn escape_leaves_the_keyboard_in_the_text() {
    let mut app = editing("primitive Drive(to);\nscenario S = { $0 }");
    app.press(NONE, Key::Escape);
    app.press(NONE, Key::Escape);
    // A letter that would be a command elsewhere.
    app.harness.key_press(Key::M);
    app.type_text("m");
    assert_eq!(app.text(), "primitive Drive(to);\nscenario S = { m$0 }");
    assert_eq!(app.json()["terrain"]["tool"], "look");
}

#[test]
fn a_name_is_renamed_everywhere() {
    let mut app = editing("primitive Dr$0ive(to);\nscenario S = { Drive(A); Drive(B) }");
    app.press(NONE, Key::F2);
    app.harness.get_by_role_and_label(Role::TextInput, "New name");
    assert_eq!(app.json()["dialog"], "rename");
    app.harness.state_mut().dispatch("edit.renameTo", &json!({ "name": "Go" })).expect("a name");
    app.settle();
    assert_eq!(app.harness.state().source(), "primitive Go(to);\nscenario S = { Go(A); Go(B) }");
}

#[test]
fn the_old_name_is_selected_for_renaming_so_that_typing_replaces_it() {
    let mut app = editing("primitive Dr$0ive(to);\nscenario S = { Drive(A) }");
    app.press(NONE, Key::F2);
    app.type_text("Go\n");
    app.settle();
    assert_eq!(app.harness.state().source(), "primitive Go(to);\nscenario S = { Go(A) }");
}

#[test]
fn definition_leads_from_a_call_to_its_declaration() {
    let mut app = editing("primitive Drive(to);\nscenario S = { Dri$0ve(A) }");
    app.press(NONE, Key::F12);
    assert_eq!(app.json()["caret"], json!({ "anchor": 10, "head": 15 }));
}

#[test]
fn a_quick_fix_is_offered_at_the_problem_and_mends_it() {
    let mut app = editing("primitive Drive(to);\nscenario S = { Driv$0(A) }");
    app.press(CTRL, Key::Period);
    app.press(NONE, Key::Enter);
    assert!(app.harness.state().source().contains("Drive(A)"), "{}", app.harness.state().source());
}

#[test]
fn find_goes_from_match_to_match_and_replaces_all() {
    let mut app = editing("$0delay; delay; Delay");
    app.press(CTRL, Key::F);
    app.harness.get_by_role_and_label(Role::TextInput, "Find");
    app.harness.event(Event::Text("delay".to_owned()));
    app.settle();
    app.harness.get_by_label("1 of 3");
    assert_eq!(app.json()["caret"], json!({ "anchor": 0, "head": 5 }), "shown while it is typed");
    app.press(NONE, Key::Enter);
    assert_eq!(app.json()["caret"], json!({ "anchor": 7, "head": 12 }));
    app.harness.get_by_label("Match case").click();
    app.settle();
    app.harness.get_by_label("2 of 2");
    app.harness.get_by_label("Toggle replace").click();
    app.settle();
    app.harness.get_by_role_and_label(Role::TextInput, "Replace with").focus();
    app.settle();
    app.harness.event(Event::Text("wait".to_owned()));
    app.settle();
    app.harness.get_by_label("Replace all").click();
    app.settle();
    assert_eq!(app.harness.state().source(), "wait; wait; Delay");
}

#[test]
fn the_caret_selects_in_all_panels_and_a_bar_of_the_timeline_selects_too() {
    let mut app = support::start();
    app.settle();
    let source = app.harness.state().source();
    let at = source.rfind("Group-Enroute").expect("a call") + 2;
    app.harness.state_mut().run(Command::Text(TextCommand::Select { anchor: at, head: at }));
    app.settle();
    assert_eq!(app.json()["selection"]["name"], "Group-Enroute#1");
    app.harness
        .get_by(|node| {
            node.label().is_some_and(|it| it.starts_with("Group-Traverse-Path(PATH1_1, …, TAI_POS): starts"))
        })
        .click();
    app.settle();
    assert_eq!(app.json()["selection"]["name"], "Group-Traverse-Path#1");
}

#[test]
fn assistive_technologies_read_and_replace_the_whole_text() {
    let mut app = editing("scenario S = { }");
    let node = app.harness.get_by_role_and_label(TEXT, "Mission text");
    assert_eq!(node.value().as_deref(), Some("scenario S = { }"));
    node.set_text_value_accesskit("scenario T = { }");
    app.settle();
    assert_eq!(app.harness.state().source(), "scenario T = { }");
}

#[test]
fn next_problem_goes_round_the_problems_of_the_text() {
    let mut app = editing("$0scenario S = { A(; }\nvar X : {B, };\n");
    app.press(NONE, Key::F8);
    let first = app.json()["caret"].clone();
    app.press(NONE, Key::F8);
    let second = app.json()["caret"].clone();
    assert_ne!(first, second);
}

#[test]
fn a_plain_key_types_in_the_editor_and_commands_elsewhere() {
    let mut app = editing("$0");
    app.type_text("f");
    assert_eq!(app.text(), "f$0");
    assert_eq!(app.json()["dialog"], serde_json::Value::Null);
}

#[test]
fn a_block_folds_at_the_caret_and_its_lines_take_no_rows() {
    let mut app = editing("primitive Drive(to);\nscenario S = {\n    Drive(A);$0\n    Drive(B)\n};\n");
    let rows = |app: &App| {
        let state = app.harness.state().app_state();
        state.editor.folding.rows().count(state.document.line_count())
    };
    assert_eq!(rows(&app), 6);
    app.press(CTRL | Modifiers::SHIFT, Key::OpenBracket);
    assert_eq!(rows(&app), 4);
    // The caret is at the end of the line that stays, and steps over what is gone.
    assert_eq!(app.text(), "primitive Drive(to);\nscenario S = {$0\n    Drive(A);\n    Drive(B)\n};\n");
    app.press(NONE, Key::ArrowDown);
    assert_eq!(app.text(), "primitive Drive(to);\nscenario S = {\n    Drive(A);\n    Drive(B)\n};$0\n");
    app.harness.state_mut().dispatch("edit.unfoldAll", &json!({})).expect("always possible");
    app.settle();
    assert_eq!(rows(&app), 6);
}

#[test]
fn a_key_let_go_in_the_same_frame_does_not_take_the_list_away_from_enter() {
    let mut app = editing("primitive Drive(to);\nscenario S = { Driv$0(A) }");
    app.press(CTRL, Key::Period);
    let released =
        Event::Key { key: Key::Period, physical_key: None, pressed: false, repeat: false, modifiers: CTRL };
    app.harness.event(released);
    app.press(NONE, Key::Enter);
    assert!(app.harness.state().source().contains("Drive(A)"), "{}", app.harness.state().source());
}

#[test]
fn long_lines_are_wrapped_at_the_panel_s_width_and_the_caret_goes_by_their_rows() {
    let comment = format!("// {}", "word ".repeat(60).trim_end());
    let mut app = editing(&format!("$0{comment}\nscenario S = {{ Drive(A) }}\n"));
    let line = |app: &App| {
        let state = app.harness.state().app_state();
        state.document.line_at(state.document.caret().head)
    };
    app.press(NONE, Key::ArrowDown);
    assert_eq!(line(&app), 1);
    app.press(NONE, Key::ArrowUp);
    app.press(Modifiers::ALT, Key::Z);
    app.settle();
    let rows = app.harness.state().app_state().document.rows_of_line(0).len();
    assert!(rows > 2, "{rows} rows");
    for row in 1..rows {
        app.press(NONE, Key::ArrowDown);
        assert_eq!(line(&app), 0, "row {row}");
    }
    app.press(NONE, Key::ArrowDown);
    assert_eq!(line(&app), 1);
    app.press(NONE, Key::ArrowUp);
    app.press(NONE, Key::End);
    assert_eq!(app.text(), format!("{comment}$0\nscenario S = {{ Drive(A) }}\n"), "the end of the last row");
    // Another mission is wrapped, too, and the setting ends it.
    app.harness.state_mut().run(Command::OpenSource { name: "other".into(), source: comment.clone() });
    app.settle();
    assert_eq!(app.harness.state().app_state().document.rows_of_line(0).len(), rows);
    app.press(Modifiers::ALT, Key::Z);
    app.settle();
    assert_eq!(app.harness.state().app_state().document.rows_of_line(0).len(), 1);
}

/// The middle of the first place on screen that says `word`.
fn place_of(app: &App, word: &str) -> egui::Pos2 {
    let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(1440.0, 900.0));
    let rows = app.texts(screen);
    let (row, rect) = rows.iter().find(|(text, _)| text.contains(word)).expect("the word is drawn");
    let width = rect.width() / row.chars().count() as f32;
    let start = row[..row.find(word).expect("the word")].chars().count();
    rect.left_center() + egui::vec2((start as f32 + word.chars().count() as f32 / 2.0) * width, 0.0)
}

fn click_with(app: &mut App, button: egui::PointerButton, pos: egui::Pos2) {
    app.harness.event(Event::PointerMoved(pos));
    app.settle();
    for pressed in [true, false] {
        app.harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        app.settle();
    }
}

#[test]
fn a_right_click_opens_a_menu_about_what_is_under_the_pointer() {
    let mut app = editing("$0primitive Survey()[1,2];\nscenario S[0,9] = { Survey() }\n");
    let at = place_of(&app, "primitive Survey") + egui::vec2(40.0, 0.0);
    click_with(&mut app, egui::PointerButton::Secondary, at);
    for entry in ["Cut", "Copy", "Paste", "Go to definition", "Rename", "Show quick fixes"] {
        assert!(app.harness.query_all_by_label_contains(entry).next().is_some(), "{entry}");
    }
    app.harness.get_by_label_contains("Rename").click();
    app.settle();
    assert_eq!(app.json()["dialog"], "rename");
}

#[test]
fn paste_in_the_menu_brings_the_clipboard_or_says_what_to_press() {
    let mut app = editing("$0// first\n// second\n");
    app.harness.state_mut().dispatch("edit.paste", &json!(null)).expect("it can be tried");
    app.settle();
    assert!(app.json()["toasts"].to_string().contains("Ctrl+V"));
    *app.world.clipboard.borrow_mut() = Some("// pasted\r\n".to_owned());
    app.harness.state_mut().dispatch("edit.paste", &json!(null)).expect("it can be used");
    app.settle();
    assert_eq!(app.text(), "// pasted\n$0// first\n// second\n");
}

#[test]
fn the_middle_button_pastes_at_the_pointer() {
    let mut app = editing("$0// first line\n// second line\n");
    let at = place_of(&app, "// second line");
    click_with(&mut app, egui::PointerButton::Middle, at);
    app.harness.event(Event::Paste("X".to_owned()));
    app.settle();
    let text = app.harness.state().source();
    assert!(text.starts_with("// first line\n// ") && text.contains('X'), "{text}");
}
