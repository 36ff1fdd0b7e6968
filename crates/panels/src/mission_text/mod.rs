//! The mission text: the code editor, told what the workbench knows of the text.

mod files;
mod keyboard;
mod language;
mod menu;

use editor::{Diagnostic, Editor, EditorView, Mark, Popup, PopupItem, Reveal};
use egui::Ui;
use rmpl::{Shift, Span};
use workbench::PanelEffect;
use workbench::command::CommandSender;
use workbench::state::editor::PopupKind;

use crate::problems::severity;
use crate::{Context, Panel};

pub use keyboard::{editor_id, typed_ahead, typed_text};

#[derive(Default)]
pub struct EditorPanel {
    editor: Editor,
    answers: language::Answers,
}

impl Panel for EditorPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let state = context.state;
        if !state.document.headings().is_empty() {
            files::show(ui, context, commands);
        }
        let shift = shift(context);
        let popup = popup(context);
        let reveal = context.take_last(|effect| match effect {
            PanelEffect::Reveal(reveal) => Some(reveal),
            _ => None,
        });
        let takes_focus = context.take_last(|effect| {
            (effect == PanelEffect::FocusEditor && state.window.dialog.is_none()).then_some(())
        });
        let entries = menu::entries(state);
        let (clipboard, place) = entries.split_at(menu::CLIPBOARD.min(entries.len()));
        let view = EditorView {
            menu: &[clipboard, place],
            manual_keys: Some("Shift+F1"),
            id: editor_id(),
            name: "Mission text",
            document: &state.document,
            rows: state.editor.folding.rows(),
            wraps: state.settings.views.editor.wraps,
            composition: &state.editor.composition,
            find: state.editor.find.as_ref(),
            popup: popup.as_ref(),
            diagnostics: &diagnostics(context, shift),
            marks: &marks(context, shift),
            reveal: reveal.map(|reveal| Reveal { offset: reveal.span.start as usize, center: reveal.center }),
            takes_focus: takes_focus.is_some(),
            active_secs: state.editor.active_secs,
            now_secs: context.now_secs,
            tokens: context.tokens,
        };
        let mut language = language::Language { context, answers: &mut self.answers };
        for action in self.editor.show(ui, &view, &mut language) {
            if let Some(command) = keyboard::command(state, action) {
                commands.send(command);
            }
        }
    }
}

/// Returns how the text of the last answer became the present one.
fn shift(context: &Context<'_>) -> Shift {
    let Some(latest) = context.state.snapshots.latest() else { return Shift::default() };
    let document = &context.state.document;
    let edits = document.edits_since(latest.revision);
    edits.map_or_else(|| Shift::between(&latest.source, document.text()), Shift::of)
}

/// The problems of the last answer, at their places in the present text.
fn diagnostics<'a>(context: &Context<'a>, shift: Shift) -> Vec<Diagnostic<'a>> {
    let problems = context.state.snapshots.problems();
    let here = problems.iter().filter_map(|problem| Some((problem, shift.surviving(problem.span)?)));
    here.map(|(problem, span)| Diagnostic {
        bytes: span.range(),
        severity: severity(problem.severity),
        code: &problem.code,
        message: &problem.message,
        hint: problem.hint.as_deref(),
        fix_keys: (!problem.fixes.is_empty()).then_some("Ctrl+."),
    })
    .collect()
}

/// Returns what the step of the search that is looked at is about, and what is selected in the other panels.
fn marks(context: &Context<'_>, shift: Shift) -> Vec<Mark> {
    let tokens = context.tokens;
    let mut marks = Vec::new();
    let mut mark = |span: Span, fill, underline| {
        marks.extend(shift.surviving(span).map(|span| Mark { bytes: span.range(), fill, underline }));
    };
    if let Some(focus) = context.focus().filter(|_| !context.is_stale) {
        let color = if focus.is_failure { tokens.failure } else { tokens.decision };
        for &span in &focus.spans {
            mark(span, color.gamma_multiply(0.16), Some(color.gamma_multiply(0.8)));
        }
    }
    if let Some(snapshot) = context.snapshot.filter(|_| !context.is_stale)
        && let Some(span) = context.state.selection.span(snapshot)
    {
        mark(span, tokens.accent_soft, None);
    }
    marks
}

fn popup<'a>(context: &Context<'a>) -> Option<Popup<'a>> {
    let popup = context.state.editor.popup.as_ref()?;
    let is_fixes = popup.kind == PopupKind::Fixes;
    let items = popup.items.iter().map(|item| PopupItem {
        label: &item.label,
        detail: &item.detail,
        sign: item.kind.map(|kind| language::completion_sign(context.tokens, kind)),
    });
    Some(Popup {
        items: items.collect(),
        chosen: popup.chosen,
        is_code: !is_fixes,
        prefix: if is_fixes { "Fix: " } else { "" },
    })
}
