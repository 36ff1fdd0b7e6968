//! What commands leave to be done by panels, by the window and by the host: each thing once, in order.

use rmpl::Span;
use test_support::App;
use text_editing::{Find, TextCommand};
use workbench::command::Command;
use workbench::host::FileKind;
use workbench::host_io::Remote as _;
use workbench::state::editor::EditorCommand;
use workbench::state::editor::Reveal;
use workbench::state::settings::SettingsCommand;
use workbench::state::settings::ThemeChoice;
use workbench::state::window::WindowCommand;
use workbench::{Dialog, PanelEffect, PanelKind, WindowEffect};
use workbench::{PictureFormat, ViewAction};

/// A session with a short text, whose first effects no one waits for any more.
fn opened(source: &str) -> App {
    let mut app = test_support::start();
    app.run(Command::OpenSource { name: "errand".into(), source: source.to_owned() });
    left(&mut app);
    app.session.take_window_effects();
    app
}

/// Returns what panels and their layout are to do now.
fn left(app: &mut App) -> Vec<PanelEffect> {
    app.session.state_mut().window.panel_effects.take(Some)
}

/// Returns what a command leaves for them.
fn leaves(app: &mut App, command: Command) -> Vec<PanelEffect> {
    app.session.apply(vec![command]);
    left(app)
}

fn caret(app: &App) -> [usize; 2] {
    let caret = app.session.state().document.caret();
    [caret.anchor, caret.head]
}

#[test]
fn panels_are_shown_closed_and_put_back_by_the_layout() {
    let mut app = opened("scenario S = { }");
    let shown = leaves(&mut app, Command::Window(WindowCommand::ShowPanel(PanelKind::Distances)));
    assert_eq!(shown, [PanelEffect::Show(PanelKind::Distances)]);
    assert_eq!(app.session.state().window.active_panel, PanelKind::Distances);
    let closed = leaves(&mut app, Command::Window(WindowCommand::ClosePanel(PanelKind::Distances)));
    assert_eq!(closed, [PanelEffect::Close(PanelKind::Distances)]);
    assert_eq!(leaves(&mut app, Command::Window(WindowCommand::ResetWorkspace)), [PanelEffect::ResetLayout]);
    let saved = leaves(&mut app, Command::Window(WindowCommand::SaveNetwork(PictureFormat::Png)));
    let expected = [PanelEffect::SaveDrawing(PictureFormat::Png), PanelEffect::Show(PanelKind::Network)];
    assert_eq!(saved, expected);
}

#[test]
fn a_view_action_goes_to_the_panel_used_last_if_that_has_a_view() {
    let mut app = opened("scenario S = { }");
    for (used, moved) in [
        (PanelKind::Timeline, PanelKind::Timeline),
        (PanelKind::Terrain, PanelKind::Terrain),
        (PanelKind::Editor, PanelKind::Network),
        (PanelKind::Problems, PanelKind::Network),
    ] {
        app.run(Command::Window(WindowCommand::Activate(used)));
        let left = leaves(&mut app, Command::Window(WindowCommand::View(ViewAction::ZoomIn)));
        assert_eq!(left, [PanelEffect::View(moved, ViewAction::ZoomIn)], "{used:?}");
    }
}

#[test]
fn turning_goes_round_the_panels_on_screen_and_the_keyboard_goes_along() {
    let mut app = opened("scenario S = { }");
    let on_screen = vec![PanelKind::Editor, PanelKind::Network, PanelKind::Timeline];
    app.session.state_mut().window.panels_on_screen = on_screen;
    app.run(Command::Window(WindowCommand::Activate(PanelKind::Network)));
    for (forwards, panel, keyboard) in [
        (true, PanelKind::Timeline, PanelEffect::FocusPanel(PanelKind::Timeline)),
        (true, PanelKind::Editor, PanelEffect::FocusEditor),
        (false, PanelKind::Timeline, PanelEffect::FocusPanel(PanelKind::Timeline)),
        (false, PanelKind::Network, PanelEffect::FocusPanel(PanelKind::Network)),
    ] {
        let left = leaves(&mut app, Command::Window(WindowCommand::TurnPanel(forwards)));
        assert_eq!((app.session.state().window.active_panel, left), (panel, vec![keyboard]));
    }
    // A panel that is gone leads to the first one.
    app.run(Command::Window(WindowCommand::Activate(PanelKind::Search)));
    leaves(&mut app, Command::Window(WindowCommand::TurnPanel(true)));
    assert_eq!(app.session.state().window.active_panel, PanelKind::Editor);
}

#[test]
fn the_editor_follows_the_caret_and_centers_only_where_it_was_sent() {
    let mut app = opened("one\ntwo\nthree");
    let select = Command::Text(TextCommand::Select { anchor: 4, head: 7 });
    let typed = leaves(&mut app, select);
    assert_eq!(typed, [PanelEffect::Reveal(Reveal { span: Span::new(7, 7), center: false })]);
    let sent = leaves(&mut app, Command::Reveal(Span::new(8, 13)));
    let place = PanelEffect::Reveal(Reveal { span: Span::new(8, 13), center: true });
    assert_eq!(sent, [place, PanelEffect::Show(PanelKind::Editor)]);
    assert_eq!(caret(&app), [8, 13]);
    let line = leaves(&mut app, Command::Editor(EditorCommand::GoToLine(2)));
    let start = PanelEffect::Reveal(Reveal { span: Span::new(4, 4), center: true });
    assert_eq!(line, [start, PanelEffect::Show(PanelKind::Editor), PanelEffect::FocusEditor]);
    // Behind the last line there is nothing to go to.
    app.run(Command::Editor(EditorCommand::GoToLine(99)));
    assert_eq!(caret(&app), [8, 8]);
}

#[test]
fn escape_takes_back_the_top_thing_first_and_the_find_bar_gives_the_keyboard_back() {
    let mut app = opened("primitive Drive(to);\nscenario S = { Drive(A) }");
    app.run(Command::Editor(EditorCommand::Find { replacing: false }));
    app.run(Command::Editor(EditorCommand::Complete));
    app.run(Command::Window(WindowCommand::ShowDialog(Dialog::Explain("E-PARSE".into()))));
    left(&mut app);
    let open = |app: &App| {
        let state = app.session.state();
        [state.window.dialog.is_some(), state.editor.popup.is_some(), state.editor.find.is_some()]
    };
    assert_eq!(open(&app), [true; 3]);
    assert_eq!(leaves(&mut app, Command::Escape), []);
    assert_eq!(open(&app), [false, true, true]);
    assert_eq!(leaves(&mut app, Command::Escape), []);
    assert_eq!(open(&app), [false, false, true]);
    assert_eq!(leaves(&mut app, Command::Escape), [PanelEffect::FocusEditor]);
    assert_eq!(open(&app), [false; 3]);
}

#[test]
fn what_only_the_window_can_do_is_left_to_it_once() {
    let mut app = opened("one\ntwo");
    app.session.apply(vec![
        Command::Window(WindowCommand::Copy("words".into())),
        Command::Settings(SettingsCommand::SetTheme(ThemeChoice::Light)),
        Command::Editor(EditorCommand::CopySelection { cut: true }),
    ]);
    let copy = |text: &str| WindowEffect::Copy(text.to_owned());
    // Without a selection the line is cut.
    assert_eq!(app.session.take_window_effects(), [copy("words"), WindowEffect::Restyle, copy("one\n")]);
    assert_eq!(app.session.state().document.text(), "two");
    assert_eq!(app.session.take_window_effects(), []);
    app.session.apply(vec![Command::Settings(SettingsCommand::SetTextScale(99.0))]);
    assert_eq!(app.session.state().settings.text_scale, 2.5);
    assert_eq!(app.session.take_window_effects(), [WindowEffect::Restyle]);
}

#[test]
fn files_are_asked_of_the_host_and_saving_ends_what_is_unsaved() {
    let mut app = opened("one");
    app.run(Command::Window(WindowCommand::OpenFile(FileKind::Map)));
    assert_eq!(*app.world.asked.borrow(), [FileKind::Map]);
    app.run(Command::SetSource("two".into()));
    assert!(app.session.state().document.is_modified());
    app.run(Command::SaveMission);
    assert!(!app.session.state().document.is_modified());
    assert_eq!(*app.world.saved.borrow(), [("errand.rmpl".to_owned(), b"two".to_vec())]);
}

#[test]
fn matches_are_found_round_the_text_and_all_replaced_as_one_step() {
    let mut app = opened("delay; Delay; delay");
    let find =
        Find { query: "delay".into(), replacement: "wait".into(), case_sensitive: true, ..Find::default() };
    app.run(Command::Editor(EditorCommand::SetFind(find)));
    assert_eq!(caret(&app), [0, 5], "what is looked for is shown while it is typed");
    for (command, place) in [
        (EditorCommand::FindNext, [14, 19]),
        (EditorCommand::FindNext, [0, 5]),
        (EditorCommand::FindPrevious, [14, 19]),
    ] {
        app.run(Command::Editor(command.clone()));
        assert_eq!(caret(&app), place, "{command:?}");
    }
    app.run(Command::Editor(EditorCommand::ReplaceAll));
    assert_eq!(app.session.source(), "wait; Delay; wait");
    app.run(Command::Text(TextCommand::Undo));
    assert_eq!(app.session.source(), "delay; Delay; delay");
}

#[test]
fn an_entry_of_the_list_replaces_the_word_and_the_caret_goes_behind_it() {
    let mut app = opened("primitive Drive(to);\nscenario S = { Dri }");
    let end = app.session.source().find(" }").expect("the end of the word");
    app.run(Command::Text(TextCommand::Select { anchor: end, head: end }));
    app.run(Command::Editor(EditorCommand::Complete));
    let popup = app.session.state().editor.popup.clone().expect("there is a list");
    let drive = popup.items.iter().position(|item| item.label == "Drive").expect("it is offered");
    app.run(Command::Editor(EditorCommand::MoveInPopup(-99)));
    app.run(Command::Editor(EditorCommand::MoveInPopup(drive as isize)));
    app.run(Command::Editor(EditorCommand::TakeFromPopup(None)));
    assert_eq!(app.session.source(), "primitive Drive(to);\nscenario S = { Drive() }");
    assert!(app.session.state().editor.popup.is_none());
    // Between the parentheses, where its argument goes.
    assert_eq!(caret(&app), [end + 3; 2]);
}
