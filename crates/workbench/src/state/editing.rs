//! How the editor's commands change the state: typing, finding, going to places.
//!
//! Completion, fixes and renaming are in [`super::services`].

use rmpl::editor;
use rmpl::{Edit, Span};
use smol_str::SmolStr;
use text_editing::{Caret, Document, EditKind, Find, TextCommand};

use crate::effect::Effect;
use crate::panel_kind::PanelKind;
use crate::state::editor::{EditorCommand, EditorState};
use crate::state::folding::Folding;
use crate::state::language::Language;
use crate::state::maps::Maps;
use crate::state::part::Part;
use crate::state::selection::Selection;
use crate::state::snapshots::Snapshots;
use crate::state::window::Window;

/// The text with what its commands read and change of other parts.
pub(crate) struct Writing<'a> {
    pub(crate) document: &'a mut Part<Document>,
    pub(crate) language: &'a mut Language,
    pub(crate) editor: &'a mut EditorState,
    pub(crate) selection: &'a mut Part<Selection>,
    pub(crate) window: &'a mut Window,
    pub(crate) snapshots: &'a Snapshots,
    pub(crate) maps: &'a Maps,
    /// The name of the mission.
    pub(crate) mission: &'a str,
    /// The name of its main text, as a file.
    pub(crate) main_text: SmolStr,
    pub(crate) now_secs: f64,
}

impl Writing<'_> {
    pub(crate) fn type_text(&mut self, command: &TextCommand) {
        let is_one = self.document.other_carets().is_empty();
        match (command, self.language.parse().filter(|_| is_one)) {
            (TextCommand::NewLine, Some(parse)) => {
                let range = self.document.caret().range();
                let (edit, caret) = editor::new_line(parse, span_of(&range));
                self.document.edit(&[edit], EditKind::Typing, Some(Caret::at(caret as usize)));
            }
            (TextCommand::ToggleComment, Some(parse)) => {
                let edits = editor::toggle_comment(parse.text(), span_of(&self.document.caret().range()));
                self.document.edit(&edits, EditKind::Single, None);
            }
            (TextCommand::Paste(text), _) if is_one && self.is_copied_line(text) => {
                // A line that was copied as one stays one: it goes above the caret's line.
                let line = self.document.line_at(self.document.caret().head);
                let start = self.document.line_range(line).start as u32;
                let edit = Edit { span: Span::new(start, start), text: text.clone() };
                self.document.edit(&[edit], EditKind::Single, None);
            }
            _ => command.apply(self.document),
        }
        self.language.follow(self.document);
        self.follow_popup(command);
        self.editor.active_secs = self.now_secs;
        self.editor.composition.clear();
        let head = self.document.caret().head as u32;
        self.window.scroll_to(Span::new(head, head), false);
        if matches!(
            command,
            TextCommand::Move { .. } | TextCommand::Select { .. } | TextCommand::SelectWord(_)
        ) {
            self.select_at_caret();
        }
    }

    /// Returns whether a text that is pasted, with nothing selected, is the line that was copied last.
    fn is_copied_line(&self, text: &str) -> bool {
        let is_it = |line: &String| line.ends_with('\n') && *line == text.replace("\r\n", "\n");
        self.document.caret().is_empty() && self.editor.copied_line.as_ref().is_some_and(is_it)
    }

    /// Selects in all panels what is at the caret, as long as the drawings belong to this text.
    fn select_at_caret(&mut self) {
        self.select_at(self.document.caret().head as u32);
    }

    /// Selects in all panels what is at a byte of the text, as long as the drawings belong to this text.
    pub(crate) fn select_at(&mut self, offset: u32) {
        if self.snapshots.is_stale(self.document.revision()) {
            return;
        }
        let Some(shown) = self.snapshots.shown() else { return };
        let found = Selection::at_offset(shown, offset, self.selection);
        **self.selection = found;
    }

    /// Selects something in all panels; the editor shows its text, and the caret stays where it is.
    pub(crate) fn select(&mut self, selection: Selection) {
        let is_current = !self.snapshots.is_stale(self.document.revision());
        let span = self.snapshots.shown().filter(|_| is_current).and_then(|shown| selection.span(shown));
        **self.selection = selection;
        if let Some(span) = span {
            self.window.scroll_to(span, true);
        }
    }

    /// Selects something in all panels, and puts the caret at its text.
    pub(crate) fn select_and_reveal(&mut self, selection: Selection) {
        let is_current = !self.snapshots.is_stale(self.document.revision());
        let span = self.snapshots.shown().and_then(|shown| selection.span(shown)).filter(|_| is_current);
        **self.selection = selection;
        if let Some(span) = span {
            self.reveal(span);
        }
    }

    pub(crate) fn reveal(&mut self, span: Span) {
        let (from, to) = (self.document.caret().head, span.start as usize);
        if self.document.line_at(from) != self.document.line_at(to) {
            self.editor.places.leave(from);
        }
        self.go_to(span);
    }

    fn go_to(&mut self, span: Span) {
        self.document.set_caret(Caret::selecting(span.start as usize, span.end as usize));
        self.window.scroll_to(span, true);
        self.editor.active_secs = self.now_secs;
        self.window.show(PanelKind::Editor);
    }

    /// Does what a command of the editor asks for.
    pub(crate) fn apply(&mut self, command: EditorCommand) {
        match command {
            EditorCommand::Focus => {
                self.window.show(PanelKind::Editor);
                self.window.focus_editor();
            }
            EditorCommand::Hover(place) => self.editor.hovered = place,
            EditorCommand::Compose(text) => self.editor.composition = text,
            EditorCommand::Find { replacing } => self.open_find(replacing),
            EditorCommand::SetFind(find) => self.find_as_typed(find),
            EditorCommand::CloseFind => {
                self.editor.find = None;
                self.window.focus_editor();
            }
            EditorCommand::FindNext => self.go_to_match(true),
            EditorCommand::FindPrevious => self.go_to_match(false),
            EditorCommand::ReplaceOne => self.replace_one(),
            EditorCommand::ReplaceAll => self.replace_every_match(),
            EditorCommand::GoToLine(line) => {
                let range =
                    self.document.line_range(line.saturating_sub(1).min(self.document.line_count() - 1));
                self.reveal(Span::new(range.start as u32, range.start as u32));
                self.window.focus_editor();
            }
            EditorCommand::GoToProblem { forwards } => self.go_to_problem(forwards),
            EditorCommand::CopySelection { cut } => self.copy_selection(cut),
            EditorCommand::Complete => self.complete(true),
            EditorCommand::QuickFix => self.list_fixes(),
            EditorCommand::FindReferences => self.list_references(),
            EditorCommand::GoToDefinition => self.go_to_definition(),
            EditorCommand::GoToBracket => {
                let head = self.document.caret().head as u32;
                let pair = self.language.parse().and_then(|parse| editor::matching_bracket(parse, head));
                if let Some((_, other)) = pair {
                    self.reveal(Span::new(other.start, other.start));
                    self.window.focus_editor();
                }
            }
            EditorCommand::GoToPlace { forwards } => {
                let here = self.document.caret().head;
                if let Some(place) = self.editor.places.step(here, forwards) {
                    let place = self.document.boundary_before(place) as u32;
                    self.go_to(Span::new(place, place));
                    self.window.focus_editor();
                }
            }
            EditorCommand::MoveInPopup(steps) => {
                if let Some(popup) = &mut self.editor.popup {
                    let last = popup.items.len().saturating_sub(1);
                    popup.chosen = popup.chosen.saturating_add_signed(steps).min(last);
                }
            }
            EditorCommand::TakeFromPopup(index) => self.take_from_popup(index),
            EditorCommand::ClosePopup => self.editor.popup = None,
            EditorCommand::Rename => self.ask_for_name(),
            EditorCommand::RenameTo(name) => self.rename_to(&name),
            EditorCommand::Format => self.format(),
            EditorCommand::WrapAt(columns) => self.document.wrap_at(columns),
            EditorCommand::ToggleFold(line) => self.fold(|folding, document, parse| {
                folding.toggle(line, document, parse);
            }),
            EditorCommand::FoldAtCaret(folds) => self.fold_at_caret(folds),
            EditorCommand::FoldAll(false) => self.editor.folding.unfold_all(),
            EditorCommand::FoldAll(true) => self.fold(Folding::fold_all),
            EditorCommand::ExpandSelection => self.expand_selection(),
        }
    }

    fn open_find(&mut self, replacing: bool) {
        let mut find = self.editor.find.take().unwrap_or_default();
        let selected = self.document.selected_text();
        if !selected.is_empty() && !selected.contains('\n') {
            find = Find { query: selected.to_owned(), is_regex: false, ..find };
        }
        find.replacing |= replacing;
        find.wants_focus = true;
        self.editor.find = Some(find);
        self.window.show(PanelKind::Editor);
    }

    /// Takes what the find bar says now, and shows the match at or after the caret if it looks for something else.
    fn find_as_typed(&mut self, find: Find) {
        let looks_for =
            |find: &Find| (find.query.clone(), find.is_regex, find.case_sensitive, find.whole_words);
        let is_changed = self.editor.find.as_ref().map(looks_for) != Some(looks_for(&find));
        let pattern = find.pattern().ok().filter(|_| is_changed);
        let from = self.document.caret().range().start;
        let found = pattern.and_then(|pattern| pattern.find_after(self.document.text(), from));
        self.editor.find = Some(find);
        if let Some(found) = found {
            self.reveal(Span::new(found.start as u32, found.end as u32));
        }
    }

    fn go_to_match(&mut self, forwards: bool) {
        let Some(find) = &self.editor.find else { return };
        let Ok(pattern) = find.pattern() else { return };
        let range = self.document.caret().range();
        let text = self.document.text();
        let found = if forwards {
            pattern.find_after(text, range.end)
        } else {
            pattern.find_before(text, range.start)
        };
        if let Some(found) = found {
            self.reveal(Span::new(found.start as u32, found.end as u32));
        }
    }

    fn replace_one(&mut self) {
        let Some(find) = self.editor.find.clone() else { return };
        let Ok(pattern) = find.pattern() else { return };
        let range = self.document.caret().range();
        if let Some(text) = pattern.replacement(self.document.text(), range.clone(), &find.replacement) {
            let span = Span::new(range.start as u32, range.end as u32);
            self.document.replace(span, &text, EditKind::Single);
        }
        self.go_to_match(true);
    }

    fn replace_every_match(&mut self) {
        let Some(find) = self.editor.find.clone() else { return };
        let Ok(pattern) = find.pattern() else { return };
        let edits = pattern.replacements(self.document.text(), &find.replacement);
        let count = edits.len();
        self.document.edit(&edits, EditKind::Single, None);
        let matches = if count == 1 { "match" } else { "matches" };
        self.window.done(format!("Replaced {count} {matches}"));
    }

    fn go_to_problem(&mut self, forwards: bool) {
        let caret = self.document.caret().range();
        let spans: Vec<Span> = self.snapshots.problems().iter().map(|problem| problem.span).collect();
        let next = if forwards {
            spans.iter().find(|span| span.start as usize > caret.start).or(spans.first())
        } else {
            spans.iter().rev().find(|span| (span.start as usize) < caret.start).or(spans.last())
        };
        if let Some(&span) = next {
            self.reveal(span);
            self.select_at(span.start);
            self.window.focus_editor();
        }
    }

    fn copy_selection(&mut self, cut: bool) {
        let caret = self.document.caret();
        if !self.document.other_carets().is_empty() {
            self.window.ask(Effect::Copy(self.document.all_selected_text()));
            if cut && self.document.carets().iter().any(|caret| !caret.is_empty()) {
                TextCommand::Insert(String::new()).apply(self.document);
            }
            return;
        }
        self.editor.copied_line = None;
        if caret.is_empty() {
            // Without a selection, copy and cut mean the line, as in other editors.
            TextCommand::SelectLine(caret.head).apply(self.document);
            self.editor.copied_line = Some(self.document.selected_text().to_owned());
        }
        self.window.ask(Effect::Copy(self.document.selected_text().to_owned()));
        if cut {
            let range = self.document.caret().range();
            let span = Span::new(range.start as u32, range.end as u32);
            self.document.replace(span, "", EditKind::Single);
        } else {
            self.document.set_caret(caret);
        }
    }
}

/// A range of bytes as a span.
pub(crate) fn span_of(range: &std::ops::Range<usize>) -> Span {
    Span::new(range.start as u32, range.end as u32)
}
