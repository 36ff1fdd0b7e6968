//! The editor's language services: completion, quick fixes, definitions, references, renaming, formatting.

use std::collections::BTreeSet;

use rmpl::{Parse, editor};
use text_editing::{Caret, Document, EditKind, TextCommand, is_name_character};

use crate::dialog::Dialog;
use crate::sentence;
use crate::state::editing::{Writing, span_of};
use crate::state::editor::{Popup, PopupAction, PopupItem, PopupKind};
use crate::state::folding::Folding;

/// Characters that begin a place where something known can be written.
const OPENERS: [char; 5] = ['=', '(', '[', ':', '"'];

/// Entries that a list shows at most; the rest is reached by typing on.
const MAX_ITEMS: usize = 100;

impl Writing<'_> {
    /// Opens, narrows or closes the list at the caret after a key.
    pub(crate) fn follow_popup(&mut self, command: &TextCommand) {
        let is_completing = self.editor.popup.as_ref().is_some_and(|it| it.kind == PopupKind::Completion);
        match command {
            TextCommand::Insert(text) => {
                let last = text.chars().next_back();
                if last.is_some_and(|c| is_name_character(c) && (is_completing || c.is_alphabetic()))
                    || last.is_some_and(|c| OPENERS.contains(&c)) && self.document.other_carets().is_empty()
                {
                    self.complete(false);
                } else {
                    self.editor.popup = None;
                }
            }
            TextCommand::Delete(_) if is_completing => self.complete(false),
            // What may stand at the next stop of a template is listed there.
            TextCommand::Indent => self.offer(),
            _ => self.editor.popup = None,
        }
    }

    /// Lists what can be written at the caret. Unless the author asked for it, or a list is open, only where it helps: in
    /// a word of at least two letters, or right after a sign that asks for something.
    pub(crate) fn complete(&mut self, is_asked: bool) {
        let is_open = self.editor.popup.take().is_some_and(|popup| popup.kind == PopupKind::Completion);
        let Some(found) = self.completions() else { return };
        let head = self.document.caret().head;
        let typed = self.document.text().get(found.span.start as usize..head).unwrap_or_default();
        let behind_opener = self.document.text()[..head].ends_with(OPENERS);
        let is_wanted = behind_opener || typed.chars().count() >= if is_open { 1 } else { 2 };
        let is_finished = match found.items.as_slice() {
            [only] => only.label == typed,
            items => !is_open && items.iter().any(|item| item.label == typed),
        };
        if !is_asked && (!is_wanted || is_finished) {
            return;
        }
        if !found.items.is_empty() {
            self.editor.popup = Some(found);
        } else if is_asked {
            self.window.info("No suggestions");
        }
    }

    /// Lists what can be written at a stop of a template, unless something complete is written there already.
    fn offer(&mut self) {
        let is_at_stop = self.document.has_stops();
        let caret = self.document.caret();
        let is_written = |found: &Popup| {
            let typed = self.document.text().get(found.span.start as usize..caret.head);
            caret.is_empty() && found.items.iter().any(|item| Some(item.label.as_str()) == typed)
        };
        let found = self.completions().filter(|found| is_at_stop && !found.items.is_empty());
        self.editor.popup = found.filter(|found| !is_written(found));
    }

    /// Returns what can be written at the caret, as a list.
    fn completions(&self) -> Option<Popup> {
        let head = self.document.caret().head;
        let found = editor::complete(self.language.parse()?, head as u32);
        let mut items: Vec<PopupItem> = found
            .items
            .into_iter()
            .take(MAX_ITEMS)
            .map(|item| PopupItem {
                label: item.label,
                detail: item.detail,
                kind: Some(item.kind),
                action: PopupAction::Insert(item.insert),
            })
            .collect();
        if found.wants == Some(editor::Wanted::Map) {
            let typed = self.document.text().get(found.replaces.start as usize..head).unwrap_or_default();
            let built_in = ::terrain::asset_names().map(|name| (name, "built in"));
            let own = self.maps.keys().map(|key| (key.asset.as_str(), "your map"));
            let mut known: BTreeSet<&str> = BTreeSet::new();
            items.extend(
                built_in.chain(own).filter(|(name, _)| name.contains(typed) && known.insert(name)).map(
                    |(name, detail)| PopupItem {
                        label: name.to_owned(),
                        detail: detail.to_owned(),
                        kind: Some(editor::CompletionKind::Value),
                        action: PopupAction::Insert(name.to_owned()),
                    },
                ),
            );
        }
        Some(Popup { kind: PopupKind::Completion, items, chosen: 0, span: found.replaces })
    }

    /// Lists what fixes the problems at the caret, in its line if there are none right there.
    pub(crate) fn list_fixes(&mut self) {
        self.editor.popup = None;
        let revision = self.document.revision();
        if self.snapshots.latest().is_none_or(|latest| latest.revision != revision) {
            self.window.info("The text is still loading");
            return;
        }
        let caret = span_of(&self.document.caret().range());
        let line = span_of(&self.document.line_range(self.document.line_at(self.document.caret().head)));
        let fixes_in = |place: rmpl::Span| -> Vec<PopupItem> {
            let problems = self.snapshots.problems().iter();
            let touching = problems.filter(|it| it.span.start <= place.end && place.start <= it.span.end);
            touching
                .flat_map(|problem| problem.fixes.iter().map(move |fix| (problem, fix)))
                .map(|(problem, fix)| PopupItem {
                    label: sentence(&fix.label.replace('`', "")),
                    detail: problem.code.to_string(),
                    kind: None,
                    action: PopupAction::Edit(fix.edits.clone()),
                })
                .collect()
        };
        let mut items = fixes_in(caret);
        if items.is_empty() {
            items = fixes_in(line);
        }
        // What fixes several problems at once is listed once.
        let mut seen = BTreeSet::new();
        items.retain(|item| seen.insert(item.label.clone()));
        if items.is_empty() {
            self.window.info("No quick fixes available");
            return;
        }
        self.editor.popup = Some(Popup { kind: PopupKind::Fixes, items, chosen: 0, span: caret });
        self.window.focus_editor();
    }

    pub(crate) fn list_references(&mut self) {
        let Some(parse) = self.language.parse() else { return };
        let caret = span_of(&self.document.caret().range());
        let items: Vec<PopupItem> = editor::references(parse, caret.start)
            .into_iter()
            .map(|found| {
                let line = self.document.line_at(found.span.start as usize);
                PopupItem {
                    label: self.document.line_text(line).trim().to_owned(),
                    detail: format!(
                        "{}{}",
                        if found.is_definition { "declaration, line " } else { "line " },
                        self.document.line_in_file(line)
                    ),
                    kind: None,
                    action: PopupAction::Reveal(found.span),
                }
            })
            .collect();
        if items.is_empty() {
            self.window.info("No references found");
            return;
        }
        self.editor.popup = Some(Popup { kind: PopupKind::References, items, chosen: 0, span: caret });
        self.window.focus_editor();
    }

    pub(crate) fn go_to_definition(&mut self) {
        let head = self.document.caret().head as u32;
        match self.language.parse().and_then(|parse| editor::definition(parse, head)) {
            Some(span) => {
                self.reveal(span);
                self.window.focus_editor();
            }
            None => self.window.info("No definition found"),
        }
    }

    pub(crate) fn take_from_popup(&mut self, index: Option<usize>) {
        let Some(popup) = self.editor.popup.take() else { return };
        let Some(item) = popup.items.into_iter().nth(index.unwrap_or(popup.chosen)) else { return };
        match item.action {
            PopupAction::Insert(text) => {
                let end = self.document.caret().head.max(popup.span.end as usize);
                self.document.insert_template(rmpl::Span::new(popup.span.start, end as u32), &text);
                self.language.follow(self.document);
                self.offer();
            }
            PopupAction::Edit(edits) => self.document.edit(&edits, EditKind::Single, None),
            PopupAction::Reveal(span) => self.reveal(span),
        }
        self.window.focus_editor();
    }

    pub(crate) fn ask_for_name(&mut self) {
        let head = self.document.caret().head as u32;
        let Some(parse) = self.language.parse() else { return };
        match editor::prepare_rename(parse, head) {
            Ok((span, name)) => {
                self.document.set_caret(Caret::selecting(span.start as usize, span.end as usize));
                self.window.dialog = Some(Dialog::Rename { old: name.clone(), name });
            }
            Err(problem) => self.window.failed(format!("Couldn't rename: {problem}")),
        }
    }

    pub(crate) fn rename_to(&mut self, name: &str) {
        let start = self.document.caret().range().start as u32;
        let Some(parse) = self.language.parse() else { return };
        match editor::rename(parse, start, name) {
            Ok(edits) => {
                let count = edits.len();
                self.document.edit(&edits, EditKind::Single, None);
                let places = if count == 1 { "place" } else { "places" };
                self.window.done(format!("Renamed in {count} {places}"));
            }
            Err(problem) => self.window.failed(format!("Couldn't rename: {problem}")),
        }
        self.window.focus_editor();
    }

    pub(crate) fn format(&mut self) {
        match self.language.formatted() {
            Some(text) => {
                self.document.replace_all(&text);
                self.window.done("Formatted");
            }
            None => self.window.info("Already formatted"),
        }
    }

    /// Folds the innermost open piece around the caret, or opens what is folded at its line.
    pub(crate) fn fold_at_caret(&mut self, folds: bool) {
        let line = self.document.line_at(self.document.caret().head);
        if !folds && !self.editor.folding.rows().is_folded_at(line) {
            return;
        }
        self.fold(|folding, document, parse| {
            if folds {
                folding.fold_around(line, document, parse);
            } else {
                folding.toggle(line, document, parse);
            }
        });
    }

    /// Folds and unfolds; a caret in what disappears goes to the end of the line that stays.
    pub(crate) fn fold(&mut self, change: impl FnOnce(&mut Folding, &Document, &Parse)) {
        let Some(parse) = self.language.parse() else { return };
        change(&mut self.editor.folding, self.document, parse);
        let line = self.document.line_at(self.document.caret().head);
        if let Some(hidden) = self.editor.folding.rows().hiding(line) {
            let end = self.document.line_range(hidden.start.saturating_sub(1)).end;
            self.document.set_caret(Caret::at(end));
        }
    }

    pub(crate) fn expand_selection(&mut self) {
        let caret = span_of(&self.document.caret().range());
        let wider = self.language.parse().and_then(|parse| editor::wider_selection(parse, caret));
        if let Some(span) = wider {
            self.document.set_caret(Caret::selecting(span.start as usize, span.end as usize));
        }
    }
}
