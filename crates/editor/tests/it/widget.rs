//! The editor by itself: a text of no language at all, shown, pointed at and typed into.

use std::cell::RefCell;
use std::ops::Range;
use std::rc::Rc;

use editor::{
    Diagnostic, Editor, EditorAction, EditorView, Highlight, Keyboard, LanguageService, Popup, PopupItem,
    Reveal, Severity, Signature, typed,
};
use egui::{Event, Id, Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use text_editing::{Caret, Document, Find, Motion, Rows, TextCommand};

/// A language of which only this is known.
#[derive(Default)]
struct Known {
    foldable: Vec<usize>,
    signature: Option<Signature>,
    /// What was asked to be colored.
    asked: Vec<Range<usize>>,
}

impl LanguageService for Known {
    fn highlights(&mut self, bytes: Range<usize>) -> Vec<Highlight> {
        self.asked.push(bytes);
        Vec::new()
    }

    fn hover(&mut self, offset: usize) -> Option<String> {
        Some(format!("byte {offset}"))
    }

    fn signature(&mut self, _: usize) -> Option<Signature> {
        self.signature.clone()
    }

    fn foldable_lines(&mut self) -> &[usize] {
        &self.foldable
    }
}

/// What the editor is told in every frame.
struct Told {
    document: Document,
    rows: Rows,
    find: Option<Find>,
    wraps: bool,
    reveal: Option<Reveal>,
    completions: Vec<&'static str>,
    diagnostics: Vec<Diagnostic<'static>>,
    known: Known,
}

impl Told {
    fn new(text: &str) -> Self {
        Self {
            document: Document::new(text),
            rows: Rows::default(),
            find: None,
            wraps: false,
            reveal: None,
            completions: Vec::new(),
            diagnostics: Vec::new(),
            known: Known::default(),
        }
    }
}

/// An editor in a window, which takes the keyboard, with what it is told and all that its user wanted.
struct Window {
    harness: Harness<'static>,
    told: Rc<RefCell<Told>>,
    actions: Rc<RefCell<Vec<EditorAction>>>,
}

fn open(told: Told) -> Window {
    let told = Rc::new(RefCell::new(told));
    let actions = Rc::<RefCell<Vec<EditorAction>>>::default();
    let (inner_told, inner_actions) = (Rc::clone(&told), Rc::clone(&actions));
    let mut editor = Editor::default();
    let mut frames = 0;
    let harness = Harness::builder().with_size([600.0, 400.0]).build_ui(move |ui| {
        frames += 1;
        if frames == 1 {
            // Fonts are there from the next frame on.
            theme::install_fonts(ui.ctx());
            theme::apply(ui.ctx(), &theme::DARK, 1.0, false);
            return;
        }
        let told = &mut *inner_told.borrow_mut();
        let id = Id::unique("the editor");
        let keyboard = Keyboard {
            id,
            is_composing: false,
            has_popup: !told.completions.is_empty(),
            can_take_focus: true,
        };
        inner_actions.borrow_mut().extend(typed(ui.ctx(), &keyboard));
        let items = told.completions.iter().map(|label| PopupItem { label, detail: "", sign: None });
        let popup = Popup { items: items.collect(), chosen: 0, is_code: true, prefix: "Take: " };
        let view = EditorView {
            menu: &[],
            manual_keys: Some("F10"),
            id,
            name: "Some text",
            document: &told.document,
            rows: &told.rows,
            composition: "",
            find: told.find.as_ref(),
            popup: (!told.completions.is_empty()).then_some(&popup),
            diagnostics: &told.diagnostics,
            marks: &[],
            wraps: told.wraps,
            reveal: told.reveal.take(),
            takes_focus: frames == 2,
            active_secs: 0.0,
            now_secs: 100.0,
            tokens: &theme::DARK,
        };
        inner_actions.borrow_mut().extend(editor.show(ui, &view, &mut told.known));
    });
    let mut window = Window { harness, told, actions };
    window.settle();
    window
}

impl Window {
    fn settle(&mut self) {
        self.harness.run_steps(6);
    }

    /// Presses the primary button at a place of the text area, and lets it go.
    fn click(&mut self, pos: egui::Pos2) {
        for pressed in [true, false] {
            let button = egui::PointerButton::Primary;
            self.harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        }
        self.settle();
    }

    /// The width and height of a character's place, and the left top corner of the first one.
    fn grid(&mut self) -> (egui::Vec2, egui::Pos2) {
        let font = egui::FontId::monospace(theme::size::CODE);
        let (width, height) = self
            .harness
            .ctx
            .fonts_mut(|fonts| (fonts.glyph_width(&font, '0'), (fonts.row_height(&font) * 1.18).round()));
        let area = self.harness.get_by_role(Role::MultilineTextInput).rect();
        (egui::vec2(width, height), area.min + egui::vec2(6.0 * width, 0.0))
    }

    fn wanted(&self) -> Vec<EditorAction> {
        std::mem::take(&mut *self.actions.borrow_mut())
    }
}

#[test]
fn keys_become_edits_and_motions_and_the_text_itself_stays() {
    let mut window = open(Told::new("one\ntwo"));
    window.harness.event(Event::Text("x".to_owned()));
    window.harness.key_press_modifiers(Modifiers::SHIFT, Key::End);
    window.settle();
    let insert = EditorAction::Text(TextCommand::Insert("x".to_owned()));
    let select = EditorAction::Text(TextCommand::Move { motion: Motion::LineEnd, select: true });
    assert_eq!(window.wanted(), [insert, select]);
    let text = window.harness.get_by_role_and_label(Role::MultilineTextInput, "Some text");
    assert_eq!(text.value().as_deref(), Some("one\ntwo"));
}

#[test]
fn keys_go_to_an_open_list_and_only_the_first_of_a_frame_takes_from_it() {
    let mut told = Told::new("");
    told.completions = vec!["alpha", "beta"];
    let mut window = open(told);
    window.harness.get_by_role_and_label(Role::ListBoxOption, "Take: alpha");
    // All in one frame: the owner of the text has not closed the list in between.
    for key in [Key::ArrowDown, Key::Enter, Key::Enter] {
        window.harness.input_mut().events.push(Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        });
    }
    window.settle();
    let wanted = window.wanted();
    assert_eq!(
        wanted,
        [
            EditorAction::MoveInPopup(1),
            EditorAction::TakeFromPopup(None),
            EditorAction::Text(TextCommand::NewLine),
        ]
    );
    window.harness.get_by_role_and_label(Role::ListBoxOption, "Take: beta").click();
    window.settle();
    let wanted = window.wanted();
    assert!(wanted.contains(&EditorAction::TakeFromPopup(Some(1))), "{wanted:?}");
}

#[test]
fn only_what_is_on_screen_is_asked_about_and_what_is_folded_has_no_row() {
    let lines = "0123456789\n".repeat(1000);
    let mut told = Told::new(&lines);
    told.rows = Rows::new(vec![Range { start: 1, end: 900 }]);
    let mut window = open(told);
    window.told.borrow_mut().known.asked.clear();
    window.harness.step();
    let asked = window.told.borrow().known.asked.clone();
    let [bytes] = asked.as_slice() else { panic!("asked {asked:?}") };
    // From the first line, which stays, to some line behind the 899 that are folded, and not to the end.
    assert_eq!(bytes.start, 0);
    assert!(bytes.end > 900 * 11 && bytes.end < 950 * 11, "{bytes:?}");
}

#[test]
fn a_press_in_the_gutter_folds_only_where_something_can_be_folded() {
    let mut told = Told::new("a {\n}\nb {\n}\n");
    told.known.foldable = vec![0];
    let mut window = open(told);
    let area = window.harness.get_by_role(Role::MultilineTextInput).rect();
    let press_at = |window: &mut Window, y: f32| {
        // Just left of the text, where folds have their signs: the gutter is six characters wide.
        let character = window
            .harness
            .ctx
            .fonts_mut(|fonts| fonts.glyph_width(&egui::FontId::monospace(theme::size::CODE), '0'));
        let pos = egui::pos2(area.left() + 5.5 * character, y);
        for pressed in [true, false] {
            let button = egui::PointerButton::Primary;
            window.harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        }
        window.settle();
        window.wanted()
    };
    let top = area.top();
    let above = press_at(&mut window, top + 5.0);
    assert!(above.contains(&EditorAction::ToggleFold(0)), "{above:?}");
    assert!(!above.iter().any(|action| matches!(action, EditorAction::Text(_))), "{above:?}");
    let below = press_at(&mut window, top + 45.0);
    assert!(below.contains(&EditorAction::Press), "{below:?}");
    assert!(!below.iter().any(|action| matches!(action, EditorAction::ToggleFold(_))), "{below:?}");
}

#[test]
fn what_is_wrong_is_told_under_the_pointer_with_what_the_language_says() {
    let mut told = Told::new("wrong");
    told.diagnostics = vec![Diagnostic {
        bytes: 0..5,
        severity: Severity::Error,
        code: "E-WRONG",
        message: "This is wrong",
        hint: Some("Make it right"),
        fix_keys: Some("F9"),
    }];
    let mut window = open(told);
    let area = window.harness.get_by_role(Role::MultilineTextInput).rect();
    assert!(window.harness.query_by_label("This is wrong").is_none());
    window.harness.event(Event::PointerMoved(egui::pos2(area.left() + 60.0, area.top() + 8.0)));
    window.harness.run_steps(60);
    window.harness.get_by_label("This is wrong");
    window.harness.get_by_label("Make it right");
    window.harness.get_by_label("E-WRONG   F9 to fix");
    window.harness.get_by_label("F10: open manual");
    assert!(window.harness.query_by_label_contains("byte ").is_some());
}

#[test]
fn the_find_bar_counts_matches_and_tells_what_is_typed_into_it() {
    let mut told = Told::new("delay; delay");
    told.document.set_caret(Caret::selecting(7, 12));
    told.find = Some(Find { query: "delay".to_owned(), wants_focus: true, ..Find::default() });
    let mut window = open(told);
    window.harness.get_by_label("2 of 2");
    window.harness.get_by_label("Match case").click();
    window.settle();
    let wanted = window.wanted();
    let is_changed = |action: &EditorAction| matches!(action, EditorAction::SetFind(find) if find.case_sensitive && find.query == "delay");
    assert!(wanted.iter().any(is_changed), "{wanted:?}");
    window.harness.get_by_label("Next match").click();
    window.settle();
    assert!(window.wanted().contains(&EditorAction::FindNext));
}

#[test]
fn a_signature_stands_above_the_caret_until_text_is_selected() {
    let mut told = Told::new("f(x)");
    told.known.signature =
        Some(Signature { label: "f(a, b)".into(), active: Some(2..3), documentation: "Does it.".into() });
    let mut window = open(told);
    window.harness.get_by_label("f(a, b)");
    window.harness.get_by_label("Does it.");
    window.told.borrow_mut().document.set_caret(Caret::selecting(0, 4));
    window.settle();
    assert!(window.harness.query_by_label("f(a, b)").is_none());
}

#[test]
fn long_lines_are_broken_into_rows_of_the_view_s_width_once_its_owner_knows_it() {
    let line = "word ".repeat(60);
    let mut told = Told::new(&format!("{line}\nlast"));
    told.wraps = true;
    let mut window = open(told);
    let columns = window.wanted().into_iter().find_map(|action| match action {
        EditorAction::WrapAt(columns) => columns,
        _ => None,
    });
    let columns = columns.expect("the view says how much room it has");
    window.told.borrow_mut().document.wrap_at(Some(columns));
    window.settle();
    assert!(!window.wanted().iter().any(|action| matches!(action, EditorAction::WrapAt(_))), "and only once");
    let (character, origin) = window.grid();
    assert!(origin.x + columns as f32 * character.x < 600.0, "{columns} columns fit");
    // A press in the second row is behind the end of the first, and one in the last row in the last line.
    let rows = window.told.borrow().document.rows_of_line(0);
    window.click(origin + egui::vec2(3.2 * character.x, 1.5 * character.y));
    let at = rows[1].start + 1;
    let select = |at| EditorAction::Text(TextCommand::Select { anchor: at, head: at });
    let wanted = window.wanted();
    assert!(wanted.contains(&select(at)), "{at}: {wanted:?}");
    window.click(origin + egui::vec2(0.2 * character.x, (rows.len() as f32 + 0.5) * character.y));
    let wanted = window.wanted();
    assert!(wanted.contains(&select(line.len() + 1)), "{wanted:?}");
    // Right of a row is in front of the blank that ends it: behind that the next row begins.
    window.click(origin + egui::vec2(columns as f32 * character.x, 0.5 * character.y));
    let wanted = window.wanted();
    assert!(wanted.contains(&select(rows[0].end - 1)), "{wanted:?}");
    window.told.borrow_mut().wraps = false;
    window.settle();
    assert!(window.wanted().contains(&EditorAction::WrapAt(None)));
}

#[test]
fn the_text_moves_sideways_only_where_it_must_and_back_as_soon_as_it_can() {
    let long = "x".repeat(200);
    let mut told = Told::new(&format!("{long}\nshort\n{}", "y".repeat(70)));
    told.document.set_caret(Caret::at(0));
    let mut window = open(told);
    let (character, origin) = window.grid();
    let columns = ((600.0 - origin.x) / character.x) as usize;
    // What is at the left edge of the text: the column that a press there selects.
    let mut left_column = |offset: usize| {
        window.told.borrow_mut().reveal = Some(Reveal { offset, center: false });
        window.settle();
        window.wanted();
        window.click(origin + egui::vec2(0.1, 0.5 * character.y));
        let wanted = window.wanted();
        let pressed = wanted.iter().find_map(|action| match action {
            EditorAction::Text(TextCommand::Select { head, .. }) => Some(*head),
            _ => None,
        });
        pressed.expect("a press places the caret")
    };
    assert_eq!(left_column(0), 0);
    assert_eq!(left_column(columns - 3), 0, "what can be seen need not be scrolled to");
    let end = left_column(200);
    assert!(end > 200 - columns && end < 200, "{end}");
    assert_eq!(left_column(end + 5), end, "what can be seen leaves the view as it is");
    assert_eq!(left_column(203), 0, "a line that fits is shown whole");
    assert!(left_column(200) > 0);
    assert_eq!(left_column(10), 0, "so is what fits of a longer one");
}
